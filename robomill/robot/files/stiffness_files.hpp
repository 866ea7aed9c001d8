#pragma once
#include <string>

#include "robomill/io/schema.hpp"
#include "robomill/robot/arm.hpp"
#include "robomill/robot/files/loads_csv.hpp"
#include "robomill/robot/identify.hpp"

namespace robomill::robot {

struct StiffnessView {
  const IdentifiedStiffness* found = nullptr;
  const Arm* arm = nullptr;
  const LoadsFile* loads = nullptr;
};
/// stiffness.json: what was found of every joint, its deviation, measured displacements and residuals.
[[nodiscard]] const io::Schema<StiffnessView>& stiffness_table();
[[nodiscard]] std::string stiffness_json(const IdentifiedStiffness& result, const Arm& arm, const LoadsFile& file);

/// A row a joint; cells of one that is not identifiable are empty, and its reason stands there.
[[nodiscard]] std::string stiffness_csv(const IdentifiedStiffness& result, const Arm& arm);

/// The line joint_stiffness_n_m_per_rad of a cell.toml. A joint that the loads say nothing of keeps the arm's own
/// stiffness, and a comment says so.
/// @throws InvalidInput naming the joints that neither the loads nor the arm know
[[nodiscard]] std::string stiffness_toml(const IdentifiedStiffness& result, const Arm& arm);

}  // namespace robomill::robot
