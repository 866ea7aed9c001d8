#include "robomill/robot/redundancy.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "robomill/base/random.hpp"
#include "robomill/robot/kinematics/choose.hpp"
#include "testing/robot/arms.hpp"
#include "testing/support.hpp"

namespace robomill::robot {
namespace redundancy_test {

using robomill::test::field_of;

/// The arm before a table; the tool stands upright on it.
Cell table_cell() {
  Cell cell{.arm = testing::with_limits(testing::kr210()), .tool_length_m = 0.25};
  cell.workpiece = Eigen::Translation3d(1.6, 0.2, 0.7) * Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitZ());
  return cell;
}

ToolPose tilted() {
  return {.tip_m = {0.05, -0.03, 0.1}, .axis = Eigen::Vector3d(0.3, -0.2, 1.0).normalized()};
}

RedundancyOptions milling() {
  return {.force_n = {300.0, -200.0, 100.0}, .normal = Eigen::Vector3d::UnitX()};
}

TEST(Redundancy, EverySampleHoldsTheToolAndItsErrorIsThatOfTheLoadedArm) {
  const Cell cell = table_cell();
  const SphericalWristInverse inverse(cell.arm);
  const Redundancy over = redundancy(cell, inverse, tilted(), milling());
  EXPECT_EQ(over.status, Redundancy::Status::found);
  ASSERT_EQ(over.samples.size(), 72U);
  int found = 0;
  for (const RedundancySample& sample : over.samples) {
    if (sample.status != Reach::Status::found) continue;
    ++found;
    const ToolPose pose = tool_pose(cell, forward(cell.arm, sample.position_rad));
    EXPECT_LT((pose.tip_m - tilted().tip_m).norm(), 1e-9);
    EXPECT_LT((pose.axis - tilted().axis).norm(), 1e-9);
    EXPECT_NEAR(std::remainder(pose.gamma_rad - sample.gamma_rad, 2.0 * testing::pi), 0.0, 1e-9);
    EXPECT_TRUE(within_limits(cell.arm, sample.position_rad).inside);
    const Eigen::Vector3d force = cell.workpiece.linear() * milling().force_n;
    const LoadedPosture loaded = loaded_posture(cell.arm, sample.position_rad, tip_point(cell), {.force_n = force});
    const Eigen::Vector3d moved = cell.workpiece.linear().transpose() * loaded.displacement_m;
    // The compliance is taken at the posture asked for, not at the loaded one: the difference is of second order.
    EXPECT_LT((moved - sample.error_m).norm(), 3e-3 * moved.norm());
    EXPECT_NEAR(sample.error_along_normal_m, sample.error_m.x(), 1e-15);
  }
  EXPECT_GT(found, 30);
}

TEST(Redundancy, NoGammaIsBetterThanTheBest) {
  const Cell cell = table_cell();
  const SphericalWristInverse inverse(cell.arm);
  RedundancyOptions options = milling();
  const Redundancy over = redundancy(cell, inverse, tilted(), options);
  ASSERT_EQ(over.status, Redundancy::Status::found);
  options.samples = 2000;
  const Redundancy fine = redundancy(cell, inverse, tilted(), options);
  for (const RedundancySample& sample : fine.samples) {
    if (sample.status != Reach::Status::found) continue;
    EXPECT_LE(over.best.error_m.norm(), sample.error_m.norm() * (1.0 + 1e-6) + 1e-9);
  }
  const ToolPose pose = tool_pose(cell, forward(cell.arm, over.best.position_rad));
  EXPECT_LT((pose.tip_m - tilted().tip_m).norm(), 1e-9);
  for (const RedundancySample& sample : over.samples) {
    if (sample.status == Reach::Status::found) {
      EXPECT_LE(over.best.error_m.norm(), sample.error_m.norm());
    }
  }
}

TEST(Redundancy, KeepsToTheBranchOfThePreviousPosture) {
  const Cell cell = table_cell();
  const SphericalWristInverse inverse(cell.arm);
  RedundancyOptions options = milling();
  const InverseSolutions all = inverse.solve(flange_pose(cell, tilted()));
  ASSERT_GT(all.count, 0);
  const Choice first = choose(cell.arm, all, Position6::Zero());
  options.previous = first.position_rad;
  const Redundancy over = redundancy(cell, inverse, tilted(), options);
  ASSERT_EQ(over.status, Redundancy::Status::found);
  // Gamma = 0 stands in the middle of the samples: the posture itself.
  EXPECT_LT((over.samples[36].position_rad - first.position_rad).norm(), 1e-9);
}

TEST(Redundancy, ReportsThatThereIsNone) {
  const Cell cell = table_cell();
  const SphericalWristInverse inverse(cell.arm);
  ToolPose far = tilted();
  far.tip_m.x() += 5.0;
  const Redundancy over = redundancy(cell, inverse, far, milling());
  EXPECT_EQ(over.status, Redundancy::Status::none);
  for (const RedundancySample& sample : over.samples) EXPECT_EQ(sample.status, Reach::Status::out_of_reach);
}

// A posture that cannot hold the force has a compliance of the wrong sign, which the size of an error does not show.
TEST(Redundancy, TakesNoPostureThatBuckles) {
  const Cell cell = table_cell();
  const SphericalWristInverse inverse(cell.arm);
  RedundancyOptions huge = milling();
  huge.force_n *= 1e6;
  const Redundancy over = redundancy(cell, inverse, tilted(), huge);
  const Wrench wrench{.force_n = cell.workpiece.linear() * huge.force_n};
  int buckled = 0;
  double least = std::numeric_limits<double>::infinity();
  for (const RedundancySample& sample : over.samples) {
    if (sample.status != Reach::Status::found) continue;
    const Stiffness there = stiffness(cell.arm, sample.position_rad, tip_point(cell), wrench, huge.singularity);
    EXPECT_EQ(sample.buckled, there.status == Stiffness::Status::buckled);
    buckled += sample.buckled ? 1 : 0;
    if (!sample.buckled) least = std::min(least, sample.error_m.norm());
  }
  EXPECT_GT(buckled, 10);
  EXPECT_EQ(over.status == Redundancy::Status::found, std::isfinite(least));
  EXPECT_FALSE(over.best.buckled);
  if (std::isfinite(least)) {
    EXPECT_LE(over.best.error_m.norm(), least);
  }
}

TEST(Redundancy, RejectsWhatMakesNoSense) {
  const Cell cell = table_cell();
  const SphericalWristInverse inverse(cell.arm);
  const auto field = [&](auto&& spoil) {
    Cell c = cell;
    ToolPose tool = tilted();
    RedundancyOptions options = milling();
    spoil(c, tool, options);
    return field_of([&] { (void)redundancy(c, inverse, tool, options); });
  };
  EXPECT_EQ(field([](auto&, auto&, auto& o) { o.samples = 3; }), "samples");
  EXPECT_EQ(field([](auto&, auto&, auto& o) { o.tolerance_rad = 0.0; }), "tolerance_rad");
  EXPECT_EQ(field([](auto&, auto&, auto& o) { o.normal *= 2.0; }), "normal");
  EXPECT_EQ(field([](auto&, auto&, auto& o) { o.force_n.setZero(); }), "force_n");
  EXPECT_EQ(field([](auto&, auto&, auto& o) { o.force_n.x() = std::nan(""); }), "force_n");
  EXPECT_EQ(field([](auto&, auto&, auto& o) { o.singularity.max_condition_number = 0.0; }),
            "singularity.max_condition_number");
  EXPECT_EQ(field([](auto&, auto& t, auto&) { t.axis *= 2.0; }), "tool.axis");
  EXPECT_EQ(field([](auto&, auto& t, auto&) { t.tip_m.x() = std::nan(""); }), "tool.tip_m");
  EXPECT_EQ(field([](auto& c, auto&, auto&) { c.tool_length_m = -1.0; }), "tool_length_m");
  EXPECT_EQ(field([](auto& c, auto&, auto&) { c.arm.joints[2].stiffness = 0.0; }), "joints[3].stiffness");
}

}  // namespace redundancy_test
}  // namespace robomill::robot
