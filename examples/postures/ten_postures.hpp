#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "robomill/modal/modes.hpp"
#include "robomill/robot/pose.hpp"
#include "testing/modal/simulated_arm.hpp"

namespace robomill::examples {

/// The arm of the example: like a KR 210, a straight spindle, tool modes at 517 and 520 Hz.
inline constexpr std::uint64_t arm_seed = 0;

/// Where the tool stands in the ten postures of [RobotMillingChatter] table 4-6: tip in the robot's base, α about its
/// z, β 0, and γ about the tool's axis, which stands upright here.
struct TabulatedPose {
  double x_mm, y_mm, z_mm, alpha_deg, gamma_deg;
};
inline constexpr std::array<TabulatedPose, 10> ten_poses{{{1270, -250, 776, 90, 0},
                                                          {1670, -250, 776, 90, 0},
                                                          {2070, -250, 776, 90, 0},
                                                          {1270, 0, 776, 90, 0},
                                                          {1270, 250, 776, 90, 0},
                                                          {1270, 0, 976, 90, 0},
                                                          {1270, 0, 1176, 90, 0},
                                                          {1470, 0, 776, 90, 60},
                                                          {1470, 0, 776, 90, 120},
                                                          {1470, 0, 776, 90, 180}}};

/// Which postures, from 0, differ in one direction alone, as the source draws them.
struct Direction {
  const char* name;
  std::vector<std::size_t> postures;
};
[[nodiscard]] const std::vector<Direction>& directions();

/// Joints of the arm for each pose, within its limits, each the way of reaching it that is nearest to the one before.
/// @throws std::runtime_error naming the posture that the arm does not reach
[[nodiscard]] std::vector<Eigen::VectorXd> joints_of_poses(const modal::testing::SimulatedArm& arm);

/// cell.toml of a KR210-like arm: what is told of it, and [[postures]] with posture_1.uff …
/// @param drives  further keys of [robot]
[[nodiscard]] std::string cell_toml(const modal::testing::SimulatedArm& arm, const std::vector<Eigen::VectorXd>& joints,
                                    const std::string& drives = {});
/// lobes.toml of the cut below at a posture of cell.toml.
[[nodiscard]] std::string lobes_toml(const Eigen::VectorXd& joints);

/// Limit depths [m] of the cut of lobes.toml at these spindle speeds [rpm]; infinite above 10 mm.
[[nodiscard]] std::vector<double> limit_curve(const modal::ModalModel& modes,
                                              const std::vector<double>& spindle_speed_rpm);
/// Modes between two frequencies alone, without residuals.
[[nodiscard]] modal::ModalModel modes_between(const modal::ModalModel& modes, double low_hz, double high_hz);

/// How far curves lie apart: the mean over the speeds of (greatest - least) / mean; speeds at which one has no limit
/// are left out.
[[nodiscard]] double spread(const std::vector<std::vector<double>>& curves);

}  // namespace robomill::examples
