#include "robomill/path/record/motion_recorder.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "testing/path/zigzag.hpp"
#include "testing/support.hpp"

namespace robomill::path {
namespace motion_recorder_test {

double largest(const signal::Band& band) {
  return std::max(band.high.maxCoeff(), -band.low.minCoeff());
}

// Differences of a motion whose derivatives are known.
TEST(MotionRecorder, DifferencesAreTheDerivatives) {
  const std::vector<ProgramCorner> none;
  MotionRecorder recorder(5, {true, true, true, false, false, false}, 0.001, none);
  recorder.restart({});
  std::vector<Sample> samples(5000);
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
  EXPECT_TRUE(motion.joints[1].prismatic);
  EXPECT_EQ(motion.joints[1].tracking_error.low.size(), 0);
  EXPECT_NEAR(motion.run_s * static_cast<double>(motion.tip_speed_m_per_s.low.size()), 5.0, motion.run_s);
}

TEST(MotionRecorder, BegunAnewForgets) {
  const program::Program program = test::zigzag_program();
  program::ProgramSource source(program);
  const ProgramOutline outlined = outline(source, test::zigzag_tolerance_m);
  MotionRecorder recorder(5, {}, 0.001, outlined.corners);
  const auto slow = test::averaged_motion(program, 0.02, {0.03, 0.03});
  recorder.restart([](const Sample&) { return robot::Position6::Constant(3.0); });
  recorder.add(test::averaged_motion(program, 0.05, {0.005, 0.005}));
  recorder.restart({});
  recorder.add(slow);
  MotionRecorder fresh(5, {}, 0.001, outlined.corners);
  fresh.restart({});
  fresh.add(slow);
  EXPECT_EQ(recorder.motion().joints[0].jerk.high, fresh.motion().joints[0].jerk.high);
  EXPECT_EQ(recorder.motion().tip_m, fresh.motion().tip_m);
  EXPECT_EQ(recorder.motion().corner_paths_m, fresh.motion().corner_paths_m);
  EXPECT_EQ(recorder.motion().joints[0].tracking_error.low.size(), 0);
}

// The same moving averages round every corner of the zigzag by the same way; the corner's own point is left by a third
// of what the tip runs in an average's time, nearly.
TEST(MotionRecorder, SeesTheWayRoundACorner) {
  const program::Program program = test::zigzag_program();
  program::ProgramSource source(program);
  const ProgramOutline outlined = outline(source, test::zigzag_tolerance_m);
  ASSERT_EQ(outlined.corners.size(), 6U);
  MotionRecorder recorder(5, {}, 0.001, outlined.corners);
  recorder.restart({});
  recorder.add(test::averaged_motion(program, 0.01, {0.02, 0.02}));
  const std::vector<Eigen::Matrix2Xd> ways = recorder.motion().corner_paths_m;
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

TEST(MotionRecorder, RejectsWhatItCannotHold) {
  const std::vector<ProgramCorner> none;
  EXPECT_EQ(robomill::test::field_of([&] { MotionRecorder(7, {}, 0.001, none); }), "joints");
  EXPECT_EQ(robomill::test::field_of([&] { MotionRecorder(6, {}, 0.0, none); }), "sample_period_s");
}

}  // namespace motion_recorder_test
}  // namespace robomill::path
