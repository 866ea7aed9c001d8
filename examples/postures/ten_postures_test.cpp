#include "examples/postures/ten_postures.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <numbers>

#include "robomill/cell/dynamics.hpp"
#include "robomill/cell/files/cell_toml.hpp"
#include "robomill/modal/files/frf_files.hpp"
#include "robomill/robot/dynamics.hpp"
#include "testing/support.hpp"

namespace robomill::examples {
namespace ten_postures_test {

constexpr double degree = std::numbers::pi / 180.0;

TEST(TenPostures, StandWhereTheTableSays) {
  const modal::testing::SimulatedArm arm(arm_seed);
  const std::vector<Eigen::VectorXd> joints = joints_of_poses(arm);
  ASSERT_EQ(joints.size(), 10U);
  for (std::size_t p = 0; p < joints.size(); ++p) {
    EXPECT_TRUE(robot::within_limits(arm.told().arm, joints[p]).inside);
    const Eigen::Isometry3d flange = robot::forward(arm.told().arm, joints[p]);
    const Eigen::Vector3d tip_mm = 1e3 * (flange * robot::tip_point(arm.told()));
    EXPECT_LT((tip_mm - Eigen::Vector3d(ten_poses[p].x_mm, ten_poses[p].y_mm, ten_poses[p].z_mm)).norm(), 1e-6);
    EXPECT_LT((flange.linear().col(2) + Eigen::Vector3d::UnitZ()).norm(), 1e-9);
    const double turn = (ten_poses[p].alpha_deg + ten_poses[p].gamma_deg) * degree;
    EXPECT_LT((flange.linear().col(0) - Eigen::Vector3d(std::cos(turn), std::sin(turn), 0.0)).norm(), 1e-9);
  }
}

TEST(TenPostures, HaveACellThatReadsBackAsWhatIsTold) {
  const test::Folder folder;
  const modal::testing::SimulatedArm arm(arm_seed);
  const std::vector<Eigen::VectorXd> joints = joints_of_poses(arm);
  const cell::CellFile read = cell::read_cell(folder.file("cell.toml", cell_toml(arm, joints)));
  ASSERT_EQ(read.postures.size(), 10U);
  for (std::size_t p = 0; p < joints.size(); ++p) {
    for (std::size_t k = 0; k < 6; ++k) {
      EXPECT_NEAR(read.postures[p].joints[k], joints[p](static_cast<Eigen::Index>(k)), 1e-8);
    }
    const Eigen::Isometry3d expected = robot::forward(arm.told().arm, joints[p]);
    EXPECT_LT((robot::forward(read.robot.arm, joints[p]).matrix() - expected.matrix()).norm(), 1e-9);
    const Eigen::MatrixXd mass = robot::mass_matrix(arm.told().arm, joints[p]);
    EXPECT_LT((robot::mass_matrix(read.robot.arm, joints[p]) - mass).norm(), 1e-4 * mass.norm());
  }
  EXPECT_NEAR(read.robot.tool_length_m, arm.told().tool_length_m, 1e-12);
  for (std::size_t k = 0; k < 6; ++k) {
    EXPECT_NEAR(read.robot.arm.joints[k].stiffness / arm.told().arm.joints[k].stiffness, 1.0, 1e-5);
    EXPECT_NEAR(read.robot.arm.joints[k].damping / arm.told().arm.joints[k].damping, 1.0, 1e-5);
  }
}

// Each measurement in its place: nothing to say. Two of them swapped, or one in another unit: said which.
TEST(TenPostures, AreNamedWhereAMeasurementDoesNotBelong) {
  const test::Folder folder;
  const modal::testing::SimulatedArm arm(arm_seed);
  const std::vector<Eigen::VectorXd> all = joints_of_poses(arm);
  const std::vector<Eigen::VectorXd> joints = {all[0], all[2], all[4], all[6], all[8], all[9]};
  for (std::size_t p = 0; p < joints.size(); ++p) {
    modal::write_frfs(folder.at(fmt::format("posture_{}.uff", p + 1)),
                      arm.measure(joints[p], p + 1, {.line_spacing_hz = 3.0}));
  }
  const auto warnings = [&] {
    return cell::cell_dynamics(cell::read_cell(folder.file("cell.toml", cell_toml(arm, joints)))).warnings;
  };
  EXPECT_TRUE(warnings().empty()) << testing::PrintToString(warnings());
  std::filesystem::rename(folder.at("posture_2.uff"), folder.at("swapped.uff"));
  std::filesystem::rename(folder.at("posture_5.uff"), folder.at("posture_2.uff"));
  std::filesystem::rename(folder.at("swapped.uff"), folder.at("posture_5.uff"));
  const std::string said = testing::PrintToString(warnings());
  EXPECT_NE(said.find("posture 2 (posture_2.uff) does not belong to the others"), std::string::npos) << said;
  EXPECT_NE(said.find("posture 5 (posture_5.uff) does not belong to the others"), std::string::npos) << said;
  for (const int other : {1, 3, 4, 6}) {
    EXPECT_EQ(said.find(fmt::format("posture {} (", other)), std::string::npos) << said;
  }
  std::filesystem::rename(folder.at("posture_2.uff"), folder.at("posture_5.uff"));
  modal::FrfSet wrong = arm.measure(joints[1], 2, {.line_spacing_hz = 3.0});
  for (modal::Frf& frf : wrong.frfs) frf.receptance *= 1e3;
  modal::write_frfs(folder.at("posture_2.uff"), wrong);
  const std::string unit = testing::PrintToString(warnings());
  EXPECT_NE(unit.find("do not use what follows from it"), std::string::npos) << unit;
}

// [RobotMillingChatter] section 4.5.4 and fig. 4-14: below 15,000 rpm x, y and z matter little for the lobes, γ much.
// It took the modes at 500 to 600 Hz alone. Of those it is so for this arm too: they are the tool's, which do not know
// where the arm stands but turn with γ. Of all modes it is not: the arm's own modes come and go with its reach.
TEST(TenPostures, HaveLobesThatFollowTheTurnOfTheToolOnlyWhereTheModesAreTheTools) {
  const modal::testing::SimulatedArm arm(arm_seed);
  const std::vector<Eigen::VectorXd> joints = joints_of_poses(arm);
  std::vector<double> speeds;
  for (double rpm = 3000.0; rpm <= 15000.0; rpm += 400.0) speeds.push_back(rpm);
  std::vector<double> of_all, of_few;
  for (const Direction& direction : directions()) {
    std::vector<std::vector<double>> all, few;
    for (const std::size_t p : direction.postures) {
      const modal::ModalModel modes = arm.modes(joints[p]);
      all.push_back(limit_curve(modes, speeds));
      few.push_back(limit_curve(modes_between(modes, 500.0, 600.0), speeds));
    }
    of_all.push_back(spread(all));
    of_few.push_back(spread(few));
  }
  for (const std::size_t way : {0U, 1U, 2U}) {  // x, y, z
    EXPECT_LT(of_few[way], 0.02) << directions()[way].name;
    EXPECT_LT(of_few[way], 0.2 * of_few[3]) << directions()[way].name;
  }
  EXPECT_GT(of_few[3], 0.1);
  EXPECT_GT(of_all[0], 0.2);
  EXPECT_GT(of_all[0], 2.0 * of_all[3]);
  for (const std::size_t way : {1U, 2U, 3U}) {
    EXPECT_GT(of_all[way], 0.04) << directions()[way].name;
    EXPECT_LT(of_all[way], 0.2) << directions()[way].name;
  }
}

}  // namespace ten_postures_test
}  // namespace robomill::examples
