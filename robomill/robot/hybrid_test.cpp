#include "robomill/robot/hybrid.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "robomill/base/linear_algebra.hpp"
#include "robomill/base/random.hpp"
#include "testing/robot/kinematics.hpp"
#include "testing/support.hpp"

namespace robomill::robot {
namespace hybrid_test {

using robomill::test::field_of;
using testing::RandomWay;

HybridMachine machine_of(double tool_m = 0.1) {
  HybridMachine out;
  out.tool_length_m = tool_m;
  return out;
}

PlatformPose random_platform(Random& random) {
  const double alpha = random.uniform(-0.9, 0.9), beta = random.uniform(-0.9, 0.9);
  return {.alpha_rad = alpha, .beta_rad = beta, .height_m = random.uniform(0.4, 1.2)};
}

Eigen::Matrix3d turned(const PlatformPose& at) {
  return (Eigen::AngleAxisd(at.alpha_rad, Eigen::Vector3d::UnitX()) *
          Eigen::AngleAxisd(at.beta_rad, Eigen::Vector3d::UnitY()))
      .toRotationMatrix();
}

Eigen::Vector3d origin(const PlatformPose& at) {
  return Eigen::AngleAxisd(at.alpha_rad, Eigen::Vector3d::UnitX()) * Eigen::Vector3d(0.0, 0.0, at.height_m);
}

/// The tool's pose in the machine's frame, by transforms alone.
ToolPose tool_of(const HybridMachine& machine, const PlatformPose& at, double x_m, double y_m) {
  const Eigen::Matrix3d rotation = turned(at);
  const Eigen::Vector3d tip =
      Eigen::Vector3d(x_m, y_m, 0.0) + origin(at) + rotation * Eigen::Vector3d(0.0, 0.0, machine.tool_offset_m());
  return {.tip_m = tip, .axis = -rotation.col(2)};
}

// Every loop base -> leg -> platform closes, and every leg stands as its joints let it: the leg of a U-P-R chain lies
// across the R axis, the platform's y, which the U joint's second axis is parallel to; that of the R-P-U chain across
// its R axis, x, and the U joint's axes x and the platform's y are perpendicular.
TEST(Hybrid, ClosesAllLoopsIn2000Postures) {
  Random random(61);
  const HybridMachine machine = machine_of();
  const HybridKinematics kinematics(machine);
  const double a = machine.base_half_width_m, b = machine.platform_half_width_m, c = machine.platform_offset_m,
               e = machine.base_offset_m;
  const std::array<Eigen::Vector3d, 3> base = {{{a, 0.0, 0.0}, {-a, 0.0, 0.0}, {0.0, e, 0.0}}};
  const std::array<Eigen::Vector3d, 3> platform = {{{b, 0.0, 0.0}, {-b, 0.0, 0.0}, {0.0, c, 0.0}}};
  for (int k = 0; k < 2000; ++k) {
    const PlatformPose at = random_platform(random);
    const double x = random.uniform(-1.0, 1.0), y = random.uniform(-1.0, 1.0);
    const Eigen::Matrix3d rotation = turned(at);
    Position6 position;
    const Reach reach = kinematics.follow(tool_of(machine, at, x, y), Position6::Zero(), position);
    ASSERT_EQ(reach.status, Reach::Status::found);
    for (std::size_t leg = 0; leg < 3; ++leg) {
      const Eigen::Vector3d along = origin(at) + rotation * platform[leg] - base[leg];
      EXPECT_NEAR(position(static_cast<Eigen::Index>(leg)), along.norm(), 1e-13);
      const Eigen::Vector3d across = leg < 2 ? Eigen::Vector3d(rotation.col(1)) : Eigen::Vector3d::UnitX();
      EXPECT_NEAR(along.dot(across), 0.0, 1e-14);
    }
    EXPECT_NEAR(Eigen::Vector3d::UnitX().dot(rotation.col(1)), 0.0, 1e-15);
    EXPECT_NEAR(position(3), x, 1e-13);
    EXPECT_NEAR(position(4), y, 1e-13);
    EXPECT_EQ(position(5), 0.0);
    const PlatformPose back = kinematics.platform(position);
    EXPECT_NEAR(back.alpha_rad, at.alpha_rad, 1e-12);
    EXPECT_NEAR(back.beta_rad, at.beta_rad, 1e-12);
    EXPECT_NEAR(back.height_m, at.height_m, 1e-12);
  }
}

// The formulas as they are stated.
TEST(Hybrid, HasTheStatedLegs) {
  Random random(62);
  const HybridMachine machine = machine_of();
  const HybridKinematics kinematics(machine);
  const double a = 0.30, b = 0.12, c = 0.12, e = 0.30, h = 0.15;
  for (int k = 0; k < 200; ++k) {
    const PlatformPose at = random_platform(random);
    const ToolPose tool = tool_of(machine, at, 0.2, -0.1);
    const Eigen::Vector3d t = -tool.axis, p = tool.tip_m;
    const double alpha = std::atan2(-t.y(), t.z()), beta = std::asin(t.x());
    const double l = p.z() / std::cos(alpha) - h * std::cos(beta);
    Position6 expected = Position6::Zero();
    expected(0) = std::hypot(b * std::cos(beta) - a, l - b * std::sin(beta));
    expected(1) = std::hypot(b * std::cos(beta) - a, l + b * std::sin(beta));
    expected(2) = std::sqrt(c * c + l * l + e * e - 2.0 * e * (c * std::cos(alpha) - l * std::sin(alpha)));
    expected(3) = p.x() - h * std::sin(beta);
    expected(4) = p.y() + p.z() * std::tan(alpha);
    Position6 position;
    (void)kinematics.follow(tool, Position6::Zero(), position);
    EXPECT_LT((position - expected).norm(), 1e-13);
  }
}

TEST(Hybrid, ForwardUndoesInverse) {
  Random random(63);
  HybridMachine machine = machine_of(0.137);
  machine.base_half_width_m = 0.41;
  machine.platform_offset_m = -0.05;
  machine.workpiece =
      Eigen::Translation3d(0.1, -0.2, 0.7) * Eigen::AngleAxisd(2.8, Eigen::Vector3d(1, 2, 3).normalized());
  const HybridKinematics kinematics(machine);
  for (int k = 0; k < 2000; ++k) {
    ToolPose tool = tool_of(machine, random_platform(random), random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0));
    const Eigen::Isometry3d back = machine.workpiece.inverse();
    tool = {.tip_m = back * tool.tip_m, .axis = back.linear() * tool.axis};
    Position6 position;
    ASSERT_EQ(kinematics.follow(tool, Position6::Zero(), position).status, Reach::Status::found);
    const ToolPose again = kinematics.forward(position);
    EXPECT_LT((again.tip_m - tool.tip_m).norm(), 1e-12);
    EXPECT_LT((again.axis - tool.axis).norm(), 1e-12);
    std::array<Position6, 2> ways;
    ASSERT_EQ(kinematics.all(tool, ways.data(), 2), 1);
    EXPECT_EQ(ways[0], position);
  }
}

TEST(Hybrid, DerivativesAreThoseOfThePositions) {
  Random random(64);
  HybridMachine machine = machine_of();
  machine.workpiece =
      Eigen::Translation3d(0.1, -0.2, 0.7) * Eigen::AngleAxisd(3.0, Eigen::Vector3d(1, 0.2, 0.1).normalized());
  const HybridKinematics kinematics(machine);
  for (int k = 0; k < 200; ++k) {
    const ToolPose tool = tool_of(machine, random_platform(random), 0.0, 0.0);
    const Eigen::Isometry3d back = machine.workpiece.inverse();
    const RandomWay way(random, {.tip_m = back * tool.tip_m, .axis = back.linear() * tool.axis}, 0.03, 0.05, 0.0);
    const auto position = [&](double u) {
      Position6 out;
      EXPECT_EQ(kinematics.follow(way.pose(u), Position6::Zero(), out).status, Reach::Status::found);
      return out;
    };
    JointJet jet;
    ASSERT_EQ(kinematics.follow(way.jet(0.3), Position6::Zero(), jet).status, Reach::Status::found);
    const JointJet expected = testing::differences(position, 0.3, 0.02);
    EXPECT_EQ(jet.col(0), expected.col(0));
    EXPECT_LT(testing::jet_error(jet, expected, 1), 1e-10);
    EXPECT_LT(testing::jet_error(jet, expected, 2), 1e-9);
    EXPECT_LT(testing::jet_error(jet, expected, 3), 1e-8);
  }
}

TEST(Hybrid, RatesAreThoseOfItsRegularity) {
  // 1 / condition number from finite differences of the inverse.
  Random random(65);
  const HybridMachine machine = machine_of();
  const HybridKinematics kinematics(machine);
  for (int k = 0; k < 50; ++k) {
    const ToolPose tool = tool_of(machine, random_platform(random), 0.0, 0.0);
    const Eigen::Vector3d across = tool.axis.unitOrthogonal(), other = tool.axis.cross(across);
    Eigen::MatrixXd rates(5, 5);
    for (int i = 0; i < 5; ++i) {
      const double step = 1e-5;
      std::array<Position6, 2> ends;
      for (std::size_t side = 0; side < 2; ++side) {
        ToolPose moved = tool;
        const double by = side == 0 ? -step : step;
        if (i < 3) moved.tip_m(i) += by;
        if (i >= 3) moved.axis = (tool.axis + by * (i == 3 ? across : other)).normalized();
        ASSERT_EQ(kinematics.follow(moved, Position6::Zero(), ends[side]).status, Reach::Status::found);
      }
      rates.col(i) = ((ends[1] - ends[0]) / (2.0 * step)).head<5>();
    }
    const Eigen::VectorXd singular = linear_algebra::thin_svd(rates).values;
    Position6 position;
    (void)kinematics.follow(tool, Position6::Zero(), position);
    EXPECT_NEAR(kinematics.regularity(position), singular(4) / singular(0), 1e-8);
  }
}

TEST(Hybrid, ReportsWhyAPoseCannotBeTaken) {
  HybridMachine machine = machine_of();
  machine.limits.min_position.head<3>().setConstant(0.5);
  machine.limits.max_position.head<3>().setConstant(1.0);
  const HybridKinematics kinematics(machine, {.singularity = {.max_condition_number = 200.0}, .max_travel_m = 0.1});
  Position6 position, near;
  const auto status = [&](const PlatformPose& at) {
    return kinematics.follow(tool_of(machine, at, 0.0, 0.0), near, position);
  };
  near << 0.75, 0.75, 0.75, 0.0, 0.0, 0.0;
  EXPECT_EQ(status({.height_m = 0.7}).status, Reach::Status::found);
  const Reach longer = status({.beta_rad = 0.5, .height_m = 0.99});
  EXPECT_EQ(longer.status, Reach::Status::outside_limits);
  EXPECT_EQ(longer.joint, 1);
  EXPECT_NEAR(longer.beyond, position(1) - 1.0, 1e-15);
  EXPECT_GT(longer.beyond, 0.01);
  EXPECT_EQ(status({.height_m = 0.88}).status, Reach::Status::jump);
  // Towards t_z = 0 a small turn takes a long slide.
  EXPECT_EQ(HybridKinematics(machine_of(), {.singularity = {.max_condition_number = 200.0}})
                .follow(tool_of(machine, {.alpha_rad = 1.55, .height_m = 0.7}, 0.0, 0.0), near, position)
                .status,
            Reach::Status::singular);
  const ToolPose upward{.tip_m = Eigen::Vector3d(0.0, 0.0, 1.0), .axis = Eigen::Vector3d::UnitZ()};
  EXPECT_EQ(kinematics.follow(upward, near, position).status, Reach::Status::out_of_reach);
  const ToolPose above{.tip_m = Eigen::Vector3d(0.0, 0.0, 0.1), .axis = -Eigen::Vector3d::UnitZ()};
  const Reach low = kinematics.follow(above, near, position);
  EXPECT_EQ(low.status, Reach::Status::out_of_reach);
  EXPECT_NEAR(low.beyond, 0.05, 1e-15);
  // Below the height where the platform on legs 1 and 2 is singular: ℓ² cos β = a b sin² β.
  const double give_way = std::sqrt(0.3 * 0.12 / std::cos(0.8)) * std::sin(0.8);
  const Reach flat = status({.beta_rad = 0.8, .height_m = give_way - 0.01});
  EXPECT_EQ(flat.status, Reach::Status::out_of_reach);
  EXPECT_NEAR(flat.beyond, 0.01, 1e-12);
  std::array<Position6, 1> ways;
  EXPECT_EQ(kinematics.all(upward, ways.data(), 1), 0);
}

TEST(Hybrid, RegularityVanishesWhereTheLegsGiveWay) {
  const HybridMachine machine = machine_of();
  const HybridKinematics kinematics(machine);
  const double beta = 0.8, give_way = std::sqrt(0.3 * 0.12 / std::cos(beta)) * std::sin(beta);
  double before = 1.0;
  for (const double over : {0.1, 1e-2, 1e-3, 1e-4}) {
    Position6 position;
    (void)kinematics.follow(tool_of(machine, {.beta_rad = beta, .height_m = give_way + over}, 0.0, 0.0),
                            Position6::Zero(), position);
    const double regularity = kinematics.regularity(position);
    EXPECT_LT(regularity, before);
    EXPECT_GT(regularity, 0.0);
    before = regularity;
  }
  EXPECT_LT(before, 1e-3);
}

// What follow() finds singular lies where regularity() says so: the bound that spares it the singular values is one.
TEST(Hybrid, FollowsUpToTheConditionNumberAllowed) {
  Random random(55);
  for (int i = 0; i < 500; ++i) {
    const PlatformPose at = random_platform(random);
    const ToolPose pose = tool_of(machine_of(), at, random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3));
    Position6 position;
    const HybridKinematics kinematics(machine_of());
    if (kinematics.follow(pose, Position6::Zero(), position).status != Reach::Status::found) continue;
    const double condition = 1.0 / kinematics.regularity(position);
    for (const double share : {0.99, 1.01}) {
      const HybridKinematics narrow(machine_of(), {.singularity = {.max_condition_number = share * condition}});
      EXPECT_EQ(narrow.follow(pose, Position6::Zero(), position).status,
                share < 1.0 ? Reach::Status::singular : Reach::Status::found)
          << i;
    }
  }
}

TEST(Hybrid, RejectsMachinesThatCannotBe) {
  const auto rejected = [](auto&& change) {
    HybridMachine machine = machine_of();
    change(machine);
    return field_of([&] { (void)HybridKinematics(machine); });
  };
  EXPECT_EQ(rejected([](HybridMachine& m) { m.base_half_width_m = 0.0; }), "base_half_width_m");
  EXPECT_EQ(rejected([](HybridMachine& m) { m.platform_half_width_m = -1.0; }), "platform_half_width_m");
  EXPECT_EQ(rejected([](HybridMachine& m) { m.platform_offset_m = NAN; }), "platform_offset_m");
  EXPECT_EQ(rejected([](HybridMachine& m) { m.base_offset_m = 0.0; }), "base_offset_m");
  EXPECT_EQ(rejected([](HybridMachine& m) { m.platform_to_flange_m = -0.1; }), "platform_to_flange_m");
  EXPECT_EQ(rejected([](HybridMachine& m) { m.tool_length_m = -0.1; }), "tool_length_m");
  EXPECT_EQ(rejected([](HybridMachine& m) { m.workpiece.linear() *= 2.0; }), "workpiece");
  EXPECT_EQ(rejected([](HybridMachine& m) { m.limits.min_position(4) = 1e301; }), "limits.min_position[5]");
  EXPECT_EQ(field_of([&] { (void)HybridKinematics(machine_of(), {.max_travel_m = 0.0}); }), "max_travel_m");
}

}  // namespace hybrid_test
}  // namespace robomill::robot
