#include "robomill/robot/pose.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "robomill/base/random.hpp"
#include "testing/robot/arms.hpp"

namespace robomill::robot {
namespace pose_test {

Cell random_cell(Random& random) {
  return {.arm = testing::kr210(), .workpiece = testing::random_pose(random, 1.0), .tool_length_m = 0.25};
}

ToolPose random_tool(Random& random) {
  return {.tip_m = testing::random_vector(random),
          .axis = testing::random_vector(random).normalized(),
          .gamma_rad = random.uniform(-testing::pi, testing::pi)};
}

TEST(Pose, PutsTipAndAxisWhereAskedWhateverGamma) {
  Random random(21);
  for (int k = 0; k < 200; ++k) {
    const Cell cell = random_cell(random);
    const ToolPose tool = random_tool(random);
    const Eigen::Isometry3d flange = flange_pose(cell, tool);
    EXPECT_TRUE((flange.linear().transpose() * flange.linear()).isIdentity(1e-13));
    EXPECT_NEAR(flange.linear().determinant(), 1.0, 1e-13);
    EXPECT_LT((flange * tip_point(cell) - cell.workpiece * tool.tip_m).norm(), 1e-13);
    EXPECT_LT((flange.linear().col(2) + cell.workpiece.linear() * tool.axis).norm(), 1e-14);
    const ToolPose back = tool_pose(cell, flange);
    EXPECT_LT((back.tip_m - tool.tip_m).norm(), 1e-13);
    EXPECT_LT((back.axis - tool.axis).norm(), 1e-13);
    EXPECT_NEAR(std::remainder(back.gamma_rad - tool.gamma_rad, 2.0 * testing::pi), 0.0, 1e-12);
  }
}

// What the shortest rotation does, by Eigen's quaternions.
TEST(Pose, CountsGammaFromTheShortestTurn) {
  Random random(22);
  for (int k = 0; k < 200; ++k) {
    const Eigen::Vector3d axis = testing::random_vector(random).normalized();
    const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), axis);
    EXPECT_LT((gamma_reference(axis) - turn * Eigen::Vector3d::UnitX()).norm(), 1e-12);
  }
  EXPECT_EQ(gamma_reference(Eigen::Vector3d::UnitZ()), Eigen::Vector3d(Eigen::Vector3d::UnitX()));
  EXPECT_EQ(gamma_reference(-Eigen::Vector3d::UnitZ()), Eigen::Vector3d(-Eigen::Vector3d::UnitX()));
}

TEST(Pose, GammaTurnsAboutTheAxis) {
  Random random(23);
  const Cell cell = random_cell(random);
  ToolPose tool = random_tool(random);
  const Eigen::Matrix3d before = flange_pose(cell, tool).linear();
  tool.gamma_rad += 0.3;
  const Eigen::Matrix3d turn = flange_pose(cell, tool).linear() * before.transpose();
  const Eigen::Vector3d axis = cell.workpiece.linear() * tool.axis;
  EXPECT_LT((turn - Eigen::AngleAxisd(0.3, axis).toRotationMatrix()).norm(), 1e-13);
}

}  // namespace pose_test
}  // namespace robomill::robot
