#include "robomill/robot/serial_kinematics.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/robot/hybrid.hpp"
#include "robomill/robot/kinematics/choose.hpp"
#include "testing/allocations.hpp"
#include "testing/robot/arms.hpp"
#include "testing/robot/kinematics.hpp"
#include "testing/support.hpp"

namespace robomill::robot {
namespace serial_kinematics_test {

using robomill::test::field_of;
using robomill::test::seeds;
using testing::RandomWay;
using Status = Reach::Status;

Cell cell_of(const Arm& arm, Random& random) {
  Cell out{.arm = arm, .tool_length_m = 0.25};
  out.workpiece = testing::random_pose(random, 0.5);
  return out;
}

/// A posture away from singularities.
Position6 regular_position(const SerialKinematics& kinematics, Random& random, double least) {
  for (;;) {
    const Position6 position = 0.9 * testing::random_position(random, 6);
    if (kinematics.regularity(position) > least) return position;
  }
}

std::vector<Arm> arms() {
  return {testing::kr210(), testing::irb(), testing::ur5e()};
}

// Joint 3 from where the arm is stretched and joint 5 by their signs; joint 1 by the side of the wrist's centre.
TEST(SerialKinematics, NamesTheConfigurationOfAPosition) {
  Random random(3);
  for (int k = 0; k < seeds(300); ++k) {
    const SerialKinematics machine(cell_of(testing::kr210(), random));
    Position6 a, b;
    for (double& angle : a) angle = random.uniform(-testing::pi, testing::pi);
    b = a;
    b(0) += random.uniform(-3.0, 3.0);
    b(3) += 2.0 * testing::pi;
    b(5) += random.uniform(-6.0, 6.0);
    const Configuration at_a = machine.configuration(a), at_b = machine.configuration(b);
    ASSERT_TRUE(at_a.known && at_b.known);
    EXPECT_EQ(at_a.shoulder_back, at_b.shoulder_back) << "joints 1, 4 and 6 change nothing";
    EXPECT_EQ(at_a.elbow_down, at_b.elbow_down);
    EXPECT_EQ(at_a.wrist_flipped, at_b.wrist_flipped);
    EXPECT_NEAR(at_a.wrist_rad, std::min(std::abs(a(4)), testing::pi - std::abs(a(4))), 1e-7);
    b(4) = -a(4);
    EXPECT_NE(machine.configuration(b).wrist_flipped, at_a.wrist_flipped);
    EXPECT_EQ(machine.configuration(b).elbow_down, at_a.elbow_down);
  }
}

// The three flags are the signs of the factors of det J, and no two ways to a pose have the same.
TEST(SerialKinematics, NamesTheConfigurationOfParallelAxes) {
  Random random(4);
  int ways = 0;
  for (int k = 0; k < seeds(100); ++k) {
    const Cell cell = cell_of(testing::ur5e(), random);
    const SerialKinematics machine(cell);
    Position6 a;
    for (double& angle : a) angle = random.uniform(-testing::pi, testing::pi);
    const auto sign_of = [](const Configuration& c) {
      return (c.shoulder_back ? -1.0 : 1.0) * (c.elbow_down ? -1.0 : 1.0) * (c.wrist_flipped ? -1.0 : 1.0);
    };
    const Configuration at_a = machine.configuration(a);
    ASSERT_TRUE(at_a.known && at_a.parallel_axes);
    EXPECT_NEAR(at_a.wrist_rad, std::min(std::abs(a(4)), testing::pi - std::abs(a(4))), 1e-7);
    EXPECT_NEAR(at_a.elbow_rad, std::min(std::abs(a(2)), testing::pi - std::abs(a(2))), 1e-7);
    const double determinant = jacobian(cell.arm, a, Eigen::Vector3d::Zero()).determinant();
    EXPECT_GT(determinant * sign_of(at_a), 0.0) << a.transpose();
    std::array<Position6, 32> branches;
    const int count = machine.all(machine.forward(a), branches.data(), 32);
    ways += count;
    for (int i = 0; i < count; ++i) {
      for (int j = 0; j < i; ++j) {
        const Position6 &at_i = branches[static_cast<std::size_t>(i)], &at_j = branches[static_cast<std::size_t>(j)];
        double apart = 0.0;
        for (int m = 0; m < 6; ++m)
          apart = std::max(apart, std::abs(std::remainder(at_i(m) - at_j(m), 2.0 * testing::pi)));
        if (apart < 1e-6) continue;  // whole turns
        const Configuration one = machine.configuration(at_i), other = machine.configuration(at_j);
        EXPECT_FALSE(one.shoulder_back == other.shoulder_back && one.elbow_down == other.elbow_down &&
                     one.wrist_flipped == other.wrist_flipped)
            << at_i.transpose() << "\n"
            << at_j.transpose();
      }
    }
  }
  EXPECT_GT(ways, 0);
}

TEST(SerialKinematics, FollowsAsChooseDoes) {
  Random random(71);
  const Cell cell = cell_of(testing::with_limits(testing::kr210()), random);
  const SerialKinematics kinematics(cell);
  ASSERT_TRUE(kinematics.closed_form());
  const SphericalWristInverse inverse(cell.arm);
  std::array<int, 5> met = {};
  for (int k = 0; k < seeds(20000); ++k) {
    const Position6 target = testing::random_position(random, 6);
    const Position6 near = k % 2 == 0 ? Position6(1.5 * testing::random_position(random, 6))
                                      : Position6(target.array() + 0.1 * random.normal());
    ToolPose pose = kinematics.forward(target);
    if (k % 5 == 0) pose.tip_m *= 1.5;
    const Choice expected =
        choose(cell.arm, inverse.solve(flange_pose(cell, pose), near), near, {.point_m = tip_point(cell)});
    Position6 position;
    const Reach reach = kinematics.follow(pose, near, position);
    ASSERT_EQ(static_cast<int>(reach.status), static_cast<int>(expected.status));
    ++met[static_cast<std::size_t>(reach.status)];
    if (reach.status == Status::out_of_reach) continue;
    EXPECT_LT((position - expected.position_rad).norm(), 1e-12);
    if (reach.status != Status::outside_limits) continue;
    EXPECT_EQ(reach.joint, expected.joint);
    EXPECT_EQ(reach.beyond, expected.beyond_rad);
  }
  EXPECT_GT(met[0], 10);
  EXPECT_GT(met[1], 10);
  EXPECT_GT(met[2], 10);
}

TEST(SerialKinematics, NewtonFollowsAnArmWithoutClosedForm) {
  Random random(72);
  const Cell cell = cell_of(testing::ur5e(), random);
  const SerialKinematics kinematics(cell);
  ASSERT_FALSE(kinematics.closed_form());
  for (int k = 0; k < seeds(2000); ++k) {
    const Position6 target = regular_position(kinematics, random, 0.02);
    Position6 near = target, position;
    for (double& angle : near) angle += random.uniform(-0.02, 0.02);
    const Reach reach = kinematics.follow(kinematics.forward(target), near, position);
    ASSERT_EQ(reach.status, Status::found);
    EXPECT_LT((position - target).norm(), 1e-10);
  }
  ToolPose far = kinematics.forward(Position6::Constant(0.5));
  far.tip_m += Eigen::Vector3d(9.0, 0.0, 0.0);
  Position6 position;
  const Reach reach = kinematics.follow(far, Position6::Constant(0.5), position);
  EXPECT_EQ(reach.status, Status::out_of_reach);
  EXPECT_GT(reach.beyond, 5.0);
}

// Central differences of tenth order of follow(ToolPose) are the second method.
TEST(SerialKinematics, DerivativesAreThoseOfThePositions) {
  Random random(73);
  for (const Arm& arm : arms()) {
    for (int k = 0; k < seeds(500); ++k) {
      const SerialKinematics kinematics(cell_of(arm, random));
      const Position6 start = regular_position(kinematics, random, 0.05);
      const ToolPose middle = kinematics.forward(start);
      if (middle.axis.z() < -0.5) continue;  // where gamma's reference turns fast
      const RandomWay way(random, middle, 0.02, 0.02, 0.05);
      Position6 near;
      ASSERT_EQ(kinematics.follow(way.pose(0.3), start, near).status, Status::found);
      JointJet jet;
      ASSERT_EQ(kinematics.follow(way.jet(0.3), near, jet).status, Status::found);
      const auto position = [&](double u) {
        Position6 out;
        EXPECT_EQ(kinematics.follow(way.pose(u), near, out).status, Status::found);
        return out;
      };
      // Of three steps each way has its best, between rounding and what the tenth order leaves.
      std::array<double, 4> error = {HUGE_VAL, HUGE_VAL, HUGE_VAL, HUGE_VAL};
      for (const double step : {0.05, 0.025, 0.0125}) {
        const JointJet expected = testing::differences(position, 0.3, step);
        for (int order = 1; order < 4; ++order) {
          double& least = error.at(static_cast<std::size_t>(order));
          least = std::min(least, testing::jet_error(jet, expected, order));
        }
      }
      EXPECT_LT(error[1], 1e-8);
      EXPECT_LT(error[2], 1e-7);
      EXPECT_LT(error[3], 1e-6);
    }
  }
}

// The other way round: the Taylor polynomial of the joints brings the tool where the way goes, up to O(h⁴).
TEST(SerialKinematics, TaylorPolynomialOfTheJointsKeepsTheToolOnItsWay) {
  Random random(74);
  for (const Arm& arm : arms()) {
    for (int k = 0; k < seeds(200); ++k) {
      const SerialKinematics kinematics(cell_of(arm, random));
      const Position6 start = regular_position(kinematics, random, 0.1);
      const ToolPose middle = kinematics.forward(start);
      if (middle.axis.z() < -0.5) continue;
      const RandomWay way(random, middle, 0.02, 0.02, 0.05);
      JointJet jet;
      ASSERT_EQ(kinematics.follow(way.jet(0.0), start, jet).status, Status::found);
      const auto miss = [&](double h) {
        const Position6 position =
            jet.col(0) + h * jet.col(1) + h * h / 2.0 * jet.col(2) + h * h * h / 6.0 * jet.col(3);
        return (flange_pose(kinematics.cell(), kinematics.forward(position)).matrix() -
                flange_pose(kinematics.cell(), way.pose(h)).matrix())
            .norm();
      };
      const double coarse = miss(0.02), fine = miss(0.01);
      EXPECT_GT(std::log2(coarse / fine), 3.5);
      EXPECT_LT(coarse, 1e-4);
    }
  }
}

TEST(SerialKinematics, AllWaysReachThePoseWithinLimits) {
  Random random(75);
  const SerialKinematics kinematics(cell_of(testing::with_limits(testing::kr210()), random));
  std::array<Position6, 256> ways;
  for (int k = 0; k < 200; ++k) {
    Position6 target = 0.9 * testing::random_position(random, 6);
    target = 0.999 * target.cwiseMin(kinematics.limits().max_position).cwiseMax(kinematics.limits().min_position);
    const ToolPose pose = kinematics.forward(target);
    const int count = kinematics.all(pose, ways.data(), 256);
    ASSERT_GE(count, 1);
    bool own = false;
    for (int way = 0; way < count; ++way) {
      const Position6& position = ways[static_cast<std::size_t>(way)];
      EXPECT_LT((kinematics.forward(position).tip_m - pose.tip_m).norm(), 1e-9);
      EXPECT_TRUE(within_limits(kinematics.cell().arm, position).inside);
      own = own || (position - target).norm() < 1e-6;
      for (int other = 0; other < way; ++other) {
        EXPECT_GT((position - ways[static_cast<std::size_t>(other)]).norm(), 1e-6);
      }
    }
    EXPECT_TRUE(own);
    EXPECT_EQ(kinematics.all(pose, ways.data(), 1), 1);
  }
}

// A UR arm reaches a pose in up to eight ways; the search from seeds finds the one that was planted, and not one twice.
TEST(SerialKinematics, SearchFindsThePlantedWay) {
  Random random(76);
  Arm arm = testing::ur5e();
  for (Joint& joint : arm.joints) {
    joint.min_position = -testing::pi;
    joint.max_position = testing::pi;
  }
  const SerialKinematics kinematics(cell_of(arm, random));
  std::array<Position6, 64> ways;
  int most = 0;
  for (int k = 0; k < 30; ++k) {
    const Position6 target = regular_position(kinematics, random, 0.03);
    const int count = kinematics.all(kinematics.forward(target), ways.data(), 64);
    most = std::max(most, count);
    EXPECT_LE(count, 8);
    EXPECT_TRUE(std::any_of(ways.begin(), ways.begin() + count,
                            [&](const Position6& way) { return (way - target).norm() < 1e-6; }));
  }
  EXPECT_EQ(most, 8);
}

TEST(SerialKinematics, ReportsASingularPostureWithTheJointAtFault) {
  const SerialKinematics kinematics({.arm = testing::with_limits(testing::kr210()), .tool_length_m = 0.25});
  Position6 straight = testing::kr210_posture(), position;
  straight(4) = 1e-4;
  const Reach wrist = kinematics.follow(kinematics.forward(straight), straight, position);
  EXPECT_EQ(wrist.status, Status::singular);
  EXPECT_TRUE(wrist.joint == 3 || wrist.joint == 5) << wrist.joint;
  EXPECT_LT((position - straight).norm(), 1e-6);
  straight(4) = 0.05;
  EXPECT_EQ(kinematics.follow(kinematics.forward(straight), straight, position).status, Status::found);
  const SerialKinematics careful(
      {.arm = testing::with_limits(testing::kr210()), .tool_length_m = 0.25},
      {.singularity = {.max_condition_number = 1.0 / kinematics.regularity(straight) - 0.1}});
  EXPECT_EQ(careful.follow(careful.forward(straight), straight, position).status, Status::singular);
  const SerialKinematics just({.arm = testing::with_limits(testing::kr210()), .tool_length_m = 0.25},
                              {.singularity = {.max_condition_number = 1.0 / kinematics.regularity(straight) + 0.1}});
  EXPECT_EQ(just.follow(just.forward(straight), straight, position).status, Status::found);
  const SerialKinematics slow({.arm = testing::with_limits(testing::kr210()), .tool_length_m = 0.25},
                              {.max_travel_rad = 0.1});
  const Position6 away = straight.array() + 0.11;
  EXPECT_EQ(slow.follow(slow.forward(straight), away, position).status, Status::jump);
  // γ counts from nowhere where the spindle points straight down in W.
  Cell below{.arm = testing::kr210(), .tool_length_m = 0.25};
  below.workpiece.linear() = Eigen::AngleAxisd(testing::pi, Eigen::Vector3d::UnitX()).toRotationMatrix();
  ToolJet jet;
  jet.tip_m.col(0) = below.workpiece.inverse() * Eigen::Vector3d(1.5, 0.0, 1.0);
  jet.axis.col(0) = -Eigen::Vector3d::UnitZ();
  const SerialKinematics upside(below);
  JointJet joints;
  std::array<Position6, 1> way;
  ASSERT_EQ(upside.all({.tip_m = jet.tip_m.col(0), .axis = jet.axis.col(0)}, way.data(), 1), 1);
  const Reach reach = upside.follow(jet, way[0], joints);
  EXPECT_EQ(reach.status, Status::singular);
  EXPECT_EQ(reach.joint, -1);
}

TEST(SerialKinematics, TakesNothingFromTheHeap) {
#if !ROBOMILL_OWN_MALLOC
  GTEST_SKIP() << "a sanitizer has its own heap";
#endif
  // Through a volatile pointer, or the compiler may leave the allocation out.
  std::vector<double> counted;
  double* volatile kept = nullptr;
  EXPECT_EQ(test::allocations([&] {
              counted.resize(1000);
              kept = counted.data();
            }),
            1U);
  Random random(77);
  HybridMachine hybrid;
  hybrid.workpiece = Eigen::Translation3d(0.0, 0.0, 0.8) * Eigen::AngleAxisd(testing::pi, Eigen::Vector3d::UnitX());
  std::vector<std::unique_ptr<Kinematics>> machines;
  for (const Arm& arm : arms()) {
    machines.push_back(std::make_unique<SerialKinematics>(Cell{.arm = arm, .tool_length_m = 0.25}));
  }
  machines.push_back(std::make_unique<HybridKinematics>(hybrid));
  for (const auto& machine : machines) {
    Position6 start = testing::kr210_posture();
    if (machine->joints() == 5) start << 0.7, 0.7, 0.7, 0.0, 0.0, 0.0;
    const RandomWay way(random, machine->forward(start), 0.01, 0.01, 0.01);
    Position6 position;
    JointJet jet;
    std::array<Position6, 64> ways;
    int sum = 0;
    const auto work = [&] {
      for (int k = 0; k < 20; ++k) {
        const double u = 0.05 * k;
        sum += static_cast<int>(machine->follow(way.pose(u), start, position).status);
        sum += static_cast<int>(machine->follow(way.jet(u), start, jet).status);
        sum += machine->forward(start).tip_m.x() > 0.0 ? 1 : 0;
        sum += machine->regularity(start) > 0.0 ? 1 : 0;
      }
      sum += machine->all(way.pose(0.0), ways.data(), 64);
      ToolPose far = way.pose(0.0);
      far.tip_m *= 10.0;
      sum += static_cast<int>(machine->follow(far, start, position).status);
    };
    EXPECT_EQ(test::allocations(work), 0U) << machine->joints();
    EXPECT_GT(sum, 0);
  }
}

TEST(SerialKinematics, RejectsWhatItCannotFollow) {
  Cell cell{.arm = testing::kr210()};
  EXPECT_EQ(field_of([&] { (void)SerialKinematics(cell, {.max_travel_rad = -1.0}); }), "max_travel_rad");
  EXPECT_EQ(field_of([&] { (void)SerialKinematics(cell, {.singularity = {.max_condition_number = 0.5}}); }),
            "singularity.max_condition_number");
  cell.tool_length_m = -1.0;
  EXPECT_EQ(field_of([&] { (void)SerialKinematics(cell); }), "cell.tool_length_m");
  cell = {.arm = testing::kr210()};
  cell.arm.joints.pop_back();
  EXPECT_EQ(field_of([&] { (void)SerialKinematics(cell); }), "cell.arm.joints");
  cell = {.arm = testing::kr210()};
  cell.arm.joints[2].prismatic = true;
  EXPECT_EQ(field_of([&] { (void)SerialKinematics(cell); }), "cell.arm.joints");
}

}  // namespace serial_kinematics_test
}  // namespace robomill::robot
