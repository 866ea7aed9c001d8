#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace robomill::cell {

/// An arm that a cell takes by its name, robot.model.
struct KnownArm {
  std::string name = {};         ///< "kuka-kr210-r2700"
  std::string description = {};  ///< "KUKA KR 210 R2700 extra: 210 kg, 2.7 m"
};

/// The maker of an arm by its name, "kuka-kr210-r2700", "kuka_kr16_2", "irb4600", as path::TrajectoryInfo has it;
/// empty: not known.
[[nodiscard]] std::string maker_of(std::string_view name);

/// All of them, by their names.
[[nodiscard]] std::vector<KnownArm> known_arms();

/// A whole cell.toml with the arm of this name, data/cells/NAME.toml as it was when the library was built; empty where
/// there is none.
[[nodiscard]] std::string_view known_arm_cell(std::string_view name);

}  // namespace robomill::cell
