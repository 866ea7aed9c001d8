#include "robomill/program/machine.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>

#include "robomill/base/random.hpp"

namespace robomill::program {
namespace {

using Eigen::AngleAxisd;
using Eigen::Vector3d;

Vector3d turned(double first_rad, const Vector3d& first, double second_rad) {
  return AngleAxisd(second_rad, Vector3d::UnitZ()) * (AngleAxisd(first_rad, first) * Vector3d::UnitZ());
}

// A head turns the tool by A or B, then by C. On tables that turn the other way round the part sees the inverse:
// LinuxCNC's tables turn the part by Rx(A) Rz(C), so that the tool stands at Rz(-C) Rx(-A) e_z in the part.
TEST(Machine, AxisIsTheRotationsOfItsJoints) {
  Random random(5);
  for (int i = 0; i < 100; ++i) {
    const double a = random.uniform(-4.0, 4.0);
    const double b = random.uniform(-4.0, 4.0);
    const double c = random.uniform(-8.0, 8.0);
    EXPECT_LT((tool_axis(Machine::xyzac_head, a, b, c) - turned(a, Vector3d::UnitX(), c)).norm(), 1e-15);
    EXPECT_LT((tool_axis(Machine::xyzbc_head, a, b, c) - turned(b, Vector3d::UnitY(), c)).norm(), 1e-15);
    EXPECT_LT((tool_axis(Machine::xyzac_trt, a, b, c) - turned(-a, Vector3d::UnitX(), -c)).norm(), 1e-15);
    EXPECT_LT((tool_axis(Machine::xyzbc_trt, a, b, c) - turned(-b, Vector3d::UnitY(), -c)).norm(), 1e-15);
  }
}

TEST(Machine, LeansTheToolAsTheTableTips) {
  const double quarter = 0.5 * std::numbers::pi;
  EXPECT_LT((tool_axis(Machine::xyzac_trt, quarter, 0.0, 0.0) - Vector3d::UnitY()).norm(), 1e-15);
  EXPECT_LT((tool_axis(Machine::xyzac_head, quarter, 0.0, 0.0) + Vector3d::UnitY()).norm(), 1e-15);
  EXPECT_LT((tool_axis(Machine::xyzbc_trt, 0.0, quarter, 0.0) + Vector3d::UnitX()).norm(), 1e-15);
  EXPECT_LT((tool_axis(Machine::xyzbc_head, 0.0, quarter, 0.0) - Vector3d::UnitX()).norm(), 1e-15);
}

}  // namespace
}  // namespace robomill::program
