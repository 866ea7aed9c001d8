#include "robomill/report/smooth_recorder.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/report/smooth_outline.hpp"
#include "robomill/report/smooth_sample.hpp"

namespace robomill::report {
namespace {

double largest(const signal::Band& band) {
  return std::max(band.high.maxCoeff(), -band.low.minCoeff());
}

// Differences of a motion whose derivatives are known.
TEST(MotionRecorder, DifferencesAreTheDerivatives) {
  const SampleMachine machine;
  const std::vector<ProgramCorner> none;
  MotionRecorder recorder(machine, {true, true, true, false, false, false}, 0.001, none);
  recorder.restart({});
  std::vector<path::Sample> samples(5000);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    samples[i].time_s = 0.001 * static_cast<double>(i);
    samples[i].joints[1] = 0.3 * (samples[i].time_s - 0.2 * std::sin(5.0 * samples[i].time_s));
    samples[i].tip_m.y() = samples[i].joints[1];
    samples[i].axis = Eigen::Vector3d(0.0, -std::sin(0.2 * samples[i].time_s), std::cos(0.2 * samples[i].time_s));
  }
  recorder.add(samples);
  const Motion motion = recorder.motion();
  EXPECT_NEAR(largest(motion.joints[1].velocity), 0.6, 1e-5);
  EXPECT_NEAR(largest(motion.joints[1].acceleration), 1.5, 1e-4);
  EXPECT_NEAR(largest(motion.joints[1].jerk), 7.5, 1e-2);
  EXPECT_NEAR(largest(motion.tip_speed_m_per_s), 0.6, 1e-5);
  EXPECT_NEAR(largest(motion.axis_speed_rad_per_s), 0.2, 1e-9);
  EXPECT_EQ(largest(motion.joints[0].velocity), 0.0);
  EXPECT_EQ(motion.joints[1].max_jerk, 40.0);
  EXPECT_TRUE(motion.joints[1].prismatic);
  EXPECT_EQ(motion.joints[1].tracking_error.low.size(), 0);
  EXPECT_NEAR(motion.run_s * static_cast<double>(motion.tip_speed_m_per_s.low.size()), 5.0, motion.run_s);
}

TEST(MotionRecorder, BegunAnewForgets) {
  const SampleMachine machine;
  const program::Program program = sample_program();
  program::ProgramSource source(program);
  const ProgramOutline outlined = outline(source, 0.05e-3);
  MotionRecorder recorder(machine, {}, 0.001, outlined.corners);
  const auto slow = sample_motion(program, machine, 0.02, {0.03, 0.03});
  recorder.restart([](const path::Sample&) { return robot::Position6::Constant(3.0); });
  recorder.add(sample_motion(program, machine, 0.05, {0.005, 0.005}));
  recorder.restart({});
  recorder.add(slow);
  MotionRecorder fresh(machine, {}, 0.001, outlined.corners);
  fresh.restart({});
  fresh.add(slow);
  EXPECT_EQ(recorder.motion().joints[0].jerk.high, fresh.motion().joints[0].jerk.high);
  EXPECT_EQ(recorder.motion().tip_m, fresh.motion().tip_m);
  EXPECT_EQ(recorder.corner_paths(), fresh.corner_paths());
  EXPECT_EQ(recorder.motion().joints[0].tracking_error.low.size(), 0);
}

// The same moving averages round every corner of the zigzag by the same way; the corner's own point is left by a third
// of what the tip runs in an average's time, nearly.
TEST(MotionRecorder, SeesTheWayRoundACorner) {
  const SampleMachine machine;
  const program::Program program = sample_program();
  program::ProgramSource source(program);
  const ProgramOutline outlined = outline(source, 0.05e-3);
  ASSERT_EQ(outlined.corners.size(), 6U);
  MotionRecorder recorder(machine, {}, 0.001, outlined.corners);
  recorder.restart({});
  recorder.add(sample_motion(program, machine, 0.01, {0.02, 0.02}));
  const std::vector<Eigen::Matrix2Xd> ways = recorder.corner_paths();
  for (std::size_t i = 0; i < ways.size(); ++i) {
    ASSERT_GT(ways[i].cols(), 20);
    const double nearest = ways[i].colwise().norm().minCoeff();
    EXPECT_GT(nearest, 0.0);
    EXPECT_LT(nearest, 0.01 * 0.02);
    // It lies to the inside, and turns round on both sides of the middle.
    EXPECT_GT(ways[i].row(1).minCoeff(), 0.0);
    EXPECT_LT(ways[i](0, 0) * ways[i](0, ways[i].cols() - 1), 0.0);
    EXPECT_LT(ways[i].colwise().norm().maxCoeff(), 2.0 * outlined.corners[i].radius_m + 1e-12);
  }
}

TEST(Outline, FindsTheSharpestCorners) {
  program::Program program;
  const auto go = [&](double x, double y, double z = 0.0) {
    program::Block block;
    block.line = program.blocks.size() + 1;
    block.end.tip_m = Eigen::Vector3d(x, y, z);
    program.blocks.push_back(block);
  };
  go(0.1, 0.0);
  go(0.2, 0.03);  // a little
  go(0.2, 0.1);   // nearly a right angle
  program.blocks.push_back({.kind = program::Block::Kind::dwell, .line = 4, .end = program.blocks.back().end});
  go(0.2, 0.0);  // back
  go(0.2, 0.1);  // … and forth, to where there was one before
  go(0.3, 0.1);  // a right angle there
  program::ProgramSource source(program);
  const ProgramOutline found = outline(source, 1e-3, 4);
  EXPECT_EQ(found.blocks, 7U);
  ASSERT_EQ(found.corners.size(), 4U);
  EXPECT_EQ(found.corners[0].line, 1U);
  EXPECT_EQ(found.corners[1].line, 2U);
  EXPECT_EQ(found.corners[2].line, 3U) << "of two at one place the sharper";
  EXPECT_EQ(found.corners[3].line, 5U);
  EXPECT_NEAR(found.corners[2].turn_rad, std::numbers::pi, 1e-12);
  for (const ProgramCorner& corner : found.corners) {
    EXPECT_TRUE((corner.plane * corner.plane.transpose()).isIdentity(1e-12));
    EXPECT_GE(corner.vertices_m.row(1).minCoeff(), -0.1);
    const Eigen::VectorXd from = corner.vertices_m.colwise().norm();
    EXPECT_EQ(from.minCoeff(), 0.0) << "the corner itself is among its vertices";
  }
  EXPECT_EQ(found.path_m.cols(), 7);
  // Read to its end, and ready to be read again.
  program::Block first;
  ASSERT_TRUE(source.next(first));
  EXPECT_EQ(first.line, 1U);
}

// Twenty reversals do not hide the one right angle.
TEST(Outline, ShowsCornersOfEachKind) {
  program::Program program;
  for (int i = 0; i < 20; ++i) {
    program::Block block;
    block.line = static_cast<std::size_t>(i + 1);
    block.end.tip_m = Eigen::Vector3d(i % 2 == 0 ? 0.1 : 0.0, 1e-3 * i, 0.0);
    program.blocks.push_back(block);
  }
  program.blocks.push_back({.line = 21, .end = {.tip_m = Eigen::Vector3d(0.0, 0.1, 0.0)}});
  program.blocks.push_back({.line = 22, .end = {.tip_m = Eigen::Vector3d(0.002, 0.1, 0.0)}});
  program::ProgramSource source(program);
  const ProgramOutline found = outline(source, 2e-5);
  ASSERT_EQ(found.corners.size(), 6U);
  EXPECT_EQ(found.corners.back().line, 21U);
  EXPECT_NEAR(found.corners.back().turn_rad, std::numbers::pi / 2.0, 1e-9);
}

TEST(Outline, KeepsALongProgramShort) {
  program::Program program;
  Random random(2);
  for (int i = 0; i < 50000; ++i) {
    program::Block block;
    block.line = static_cast<std::size_t>(i + 1);
    block.end.tip_m = Eigen::Vector3d(1e-4 * i, 1e-4 * random.normal(), 0.0);
    program.blocks.push_back(block);
  }
  program::ProgramSource source(program);
  const ProgramOutline found = outline(source, 2e-5);
  EXPECT_EQ(found.blocks, 50000U);
  EXPECT_GE(found.path_m.cols(), 2000);
  EXPECT_LE(found.path_m.cols(), 4001);
  EXPECT_EQ(found.path_m.col(found.path_m.cols() - 1), program.blocks.back().end.tip_m);
  EXPECT_EQ(found.corners.size(), 6U);
}

TEST(Outline, OfNoMoveHasOnePoint) {
  const program::Program program;
  program::ProgramSource source(program);
  const ProgramOutline found = outline(source, 2e-5);
  EXPECT_EQ(found.path_m.cols(), 1);
  EXPECT_TRUE(found.corners.empty());
}

}  // namespace
}  // namespace robomill::report
