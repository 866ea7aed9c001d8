#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/path/check.hpp"
#include "robomill/path/check/check_window.hpp"
#include "testing/path/trajectory.hpp"

namespace robomill::path {
namespace check_path_test {

using Eigen::Vector3d;
using program::Block;
using program::Pose;
using test::Fixture;
using test::options;
using test::quarters;

// A smooth bulge aside of the line, of tip or axis, named by its block.
TEST(Checker, ReportsTheErrorOfTipAndAxis) {
  Fixture f;
  for (int i = 1; i <= 40; ++i) f.move({0.01 * i, 0.0, 0.0}, {0.001 * i, 0.0, 1.0}, 0.01);
  const std::vector<Sample> line = f.stop_and_go(std::vector<double>(40, 0.5));
  const auto bulge = [&](double tip_m, double axis_rad) {
    std::vector<Sample> samples = line;
    for (std::size_t i = 10000; i < 11000; ++i) {
      const double s = std::pow(std::sin(std::numbers::pi * static_cast<double>(i - 10000) / 1000.0), 4);
      Sample& x = samples[i];
      x = f.sample(x.time_s,
                   {.tip_m = x.tip_m + tip_m * s * Vector3d::UnitY(),
                    .axis = Eigen::AngleAxisd(axis_rad * s, x.axis.cross(Vector3d::UnitY()).normalized()) * x.axis},
                   x.block);
    }
    return f.check(samples);
  };
  const CheckResult none = bulge(0.0, 0.0);
  EXPECT_EQ(none.tip_error_m.violations + none.axis_error_rad.violations, 0U);
  EXPECT_LT(none.tip_error_m.max, 1e-15);
  EXPECT_LT(none.axis_error_rad.max, 1e-15);
  EXPECT_LT(none.synchrony_rad.max, 1e-14);
  const CheckResult tip = bulge(2.5e-5, 0.0);
  EXPECT_NEAR(tip.tip_error_m.max, 2.5e-5, 1e-10);
  EXPECT_EQ(tip.tip_error_m.block, 20U);
  EXPECT_GT(tip.tip_error_m.violations, 100U);
  EXPECT_LT(tip.tip_error_m.violations, 1000U);
  EXPECT_EQ(tip.axis_error_rad.violations, 0U);
  const CheckResult axis = bulge(0.0, 4e-4);
  EXPECT_NEAR(axis.axis_error_rad.max, 4e-4, 1e-8);
  EXPECT_GT(axis.axis_error_rad.violations, 100U);
  EXPECT_EQ(axis.tip_error_m.violations, 0U);
}

// Samples of a run along the polyline through `points` at 20 mm/s, naming the block of the line they are on.
std::vector<Sample> along(const Fixture& f, const std::vector<Pose>& points, const std::vector<std::size_t>& names) {
  std::vector<Sample> samples;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const double size = (points[i + 1].tip_m - points[i].tip_m).norm() +
                        0.1 * program::angle_between(points[i].axis, points[i + 1].axis);
    const int steps = std::max(1, static_cast<int>(size / 2e-5));
    for (int k = i == 0 ? 0 : 1; k <= steps; ++k) {
      samples.push_back(f.sample(static_cast<double>(samples.size()) * 1e-3,
                                 program::between(points[i], points[i + 1], static_cast<double>(k) / steps), names[i]));
    }
  }
  return samples;
}

// Every sample of a cut corner lies near the path; only the corner itself knows that it was missed.
TEST(Checker, KnowsACornerThatWasCutOrLeftOut) {
  Fixture f;
  const Vector3d up(0.0, 0.0, 1.0);
  f.move({0.01, 0.0, 0.0}, up, 0.5)
      .move({0.01, 0.0003, 0.0}, up, 0.1)
      .move({0.01, 0.0, 0.0}, up, 0.1)
      .move({0.02, 0.0, 0.0}, up, 0.5);
  const CheckResult spike = f.check(along(f, {{}, {.tip_m = {0.01, 0.0, 0.0}}, {.tip_m = {0.02, 0.0, 0.0}}}, {0, 3}));
  EXPECT_NEAR(spike.tip_error_m.max, 0.0003, 1e-12);
  EXPECT_EQ(spike.tip_error_m.violations, 1U);
  EXPECT_EQ(spike.tip_error_m.block, 1U);
  EXPECT_NEAR(spike.tip_error_m.at_s, 0.5, 0.002);

  Fixture g;  // a right angle cut by a chord: the corner is a share of √½ of the cut's leg away
  g.move({0.01, 0.0, 0.0}, up, 0.5).move({0.01, 0.01, 0.0}, up, 0.5);
  const double leg = 2.4e-5;
  const CheckResult cut = g.check(
      along(g, {{}, {.tip_m = {0.01 - leg, 0.0, 0.0}}, {.tip_m = {0.01, leg, 0.0}}, {.tip_m = {0.01, 0.01, 0.0}}},
            {0, 1, 1}));
  EXPECT_NEAR(cut.tip_error_m.max, leg * std::sqrt(0.5), 1e-12);
  EXPECT_EQ(cut.tip_error_m.violations, 0U);
  EXPECT_EQ(cut.tip_error_m.block, 0U);

  Fixture a;  // the axis goes there and back
  a.move({0.01, 0.0, 0.0}, {0.0, 0.01, 1.0}, 0.5).move({0.02, 0.0, 0.0}, up, 0.5);
  const CheckResult axis = a.check(along(a, {{}, {.tip_m = {0.02, 0.0, 0.0}}}, {0}));
  EXPECT_NEAR(axis.axis_error_rad.max, std::atan(0.01), 1e-9);
  EXPECT_EQ(axis.tip_error_m.violations, 0U);
}

TEST(Checker, KnowsAProgramThatIsNotFinished) {
  Fixture f;
  const Vector3d up(0.0, 0.0, 1.0);
  for (int i = 1; i <= 3000; ++i) f.move({1e-4 * i, 0.0, 0.0}, up, 0.005);
  const CheckResult all = f.check(along(f, {{}, {.tip_m = {0.3, 0.0, 0.0}}}, {0}));
  EXPECT_GT(all.tip_error_m.violations, 0U);  // all samples name block 0
  std::vector<Sample> samples;
  for (int i = 0; i <= 10000; ++i) {
    samples.push_back(f.sample(i * 1e-3, {.tip_m = {2e-5 * i, 0.0, 0.0}},
                               std::min<std::size_t>(2999, static_cast<std::size_t>(i / 5))));
  }
  const CheckResult part = f.check(samples);
  EXPECT_EQ(part.tip_error_m.violations, 1001U);  // the corners never reached, and the end
  EXPECT_NEAR(part.tip_error_m.max, 0.1, 1e-9);
  EXPECT_EQ(part.tip_error_m.block, 2999U);
  const CheckResult none = f.check({});
  EXPECT_EQ(none.samples, 0U);
  EXPECT_EQ(none.tip_error_m.violations, 3001U);
  EXPECT_EQ(none.violations(), 3001U);
}

// Blocks far shorter than a sample's step: found by the window that grows with the tolerance.
TEST(Checker, FollowsBlocksShorterThanSteps) {
  Fixture f;
  const Vector3d up(0.0, 0.0, 1.0);
  for (int i = 1; i <= 20000; ++i) f.move({1e-6 * i, 0.0, 0.0}, up, 2e-5);
  std::vector<Sample> samples;
  const double seconds = 0.8;
  for (int i = 0; i <= 800; ++i) {
    const double way = quarters(i * 1e-3 / seconds, 0.02);
    // named ten blocks late or early, as a smoother may that counts along its own path
    const double named = way / 1e-6 + 10.0 * std::sin(0.3 * i);
    samples.push_back(
        f.sample(i * 1e-3, {.tip_m = {way, 0.0, 0.0}}, static_cast<std::size_t>(std::clamp(named, 0.0, 19999.0))));
  }
  const CheckResult r = f.check(samples);
  EXPECT_EQ(r.violations(), 0U);
  EXPECT_LT(r.tip_error_m.max, 2.001e-6);  // within the tolerance no more than eight blocks are looked at
}

TEST(Checker, KnowsADwellThatWasTooShort) {
  Fixture f;
  const Vector3d up(0.0, 0.0, 1.0), there(0.01, 0.0, 0.0);
  f.move(there, up, 0.2)
      .move(there, up, 0.3, Block::Kind::dwell)
      .move(there, up, 0.2, Block::Kind::dwell)
      .move({0.02, 0.0, 0.0}, up, 0.2);
  EXPECT_EQ(f.check(f.stop_and_go({0.4, 0.3, 0.2, 0.4})).violations(), 0U);
  const CheckResult r = f.check(f.stop_and_go({0.4, 0.3, 0.1, 0.4}));
  EXPECT_EQ(r.dwell_s.violations, 1U);
  EXPECT_EQ(r.violations(), 1U);
  EXPECT_NEAR(r.dwell_s.max, 0.1, 0.02);
  EXPECT_EQ(r.dwell_s.block, 2U);
  ASSERT_EQ(r.worst_violations.size(), 1U);
  EXPECT_EQ(r.worst_violations[0].block, 2U);
}

TEST(Checker, KnowsJointsThatAreNotWhereTheToolIs) {
  Fixture f;
  f.move({0.01, 0.0, 0.0}, {0.0, 0.0, 1.0}, 0.2);
  std::vector<Sample> samples = f.stop_and_go({0.4});
  for (Sample& sample : samples) sample.joints[2] += 2e-7;
  const CheckResult r = f.check(samples);
  EXPECT_NEAR(r.pose_error.max, 2e-7, 1e-15);
  EXPECT_EQ(r.pose_error.violations, samples.size());
  EXPECT_EQ(r.violations(), samples.size());
}

TEST(Checker, CountsHostileSamplesAndStaysFinite) {
  Fixture f;
  const Vector3d up(0.0, 0.0, 1.0);
  f.move({0.01, 0.0, 0.0}, up, 0.2).move({0.02, 0.0, 0.0}, {0.1, 0.0, 1.0}, 0.2);
  const std::vector<Sample> good = f.stop_and_go({0.4, 0.4});
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  const std::vector<std::function<void(Sample&)>> harms = {
      [&](Sample& s) { s.tip_m.x() = nan; }, [&](Sample& s) { s.axis.z() = nan; },
      [&](Sample& s) { s.joints[4] = nan; }, [&](Sample& s) { s.time_s = nan; },
      [&](Sample& s) { s.tip_m.y() = inf; }, [&](Sample& s) { s.joints[0] = -1e300; },
      [&](Sample& s) { s.block = 1000000; }, [&](Sample& s) { s.time_s += 1e-5; }};
  for (std::size_t h = 0; h < harms.size(); ++h) {
    for (const std::size_t at : {std::size_t{0}, std::size_t{300}, good.size() - 1}) {
      std::vector<Sample> samples = good;
      harms[h](samples[at]);
      const CheckResult r = f.check(samples);
      if (h != 7 || at > 0) {
        EXPECT_GE(r.faulty, 1U) << h << " " << at;
      }
      EXPECT_LE(r.faulty, 2U);  // a late sample is off the grid, and the next one early
      EXPECT_TRUE(std::isfinite(r.duration_s));
      for (const Usage* u : {&r.tip_velocity, &r.tip_jerk, &r.axis_jerk, &r.feed, &r.tip_error_m, &r.axis_error_rad,
                             &r.pose_error, &r.joints[4].jerk}) {
        EXPECT_TRUE(std::isfinite(u->max)) << h;
      }
      for (const Violation& violation : r.worst_violations)
        EXPECT_TRUE(std::isfinite(violation.ratio) && std::isfinite(violation.time_s));
    }
  }
  std::vector<Sample> nothing(100);
  for (Sample& sample : nothing) sample.tip_m.setConstant(nan);
  EXPECT_GE(f.check(nothing).violations(), 100U);
}

// No half turn, no zero block and no program at all makes a number that is none.
TEST(Checker, NeverReportsANumberThatIsNone) {
  Fixture f;
  f.program.blocks.push_back({.end = {.axis = -Vector3d::UnitZ()}, .duration_s = 1.0});
  f.program.blocks.push_back({.end = {.axis = -Vector3d::UnitZ()}, .duration_s = 0.0});
  std::vector<Sample> samples;
  for (int i = 0; i <= 100; ++i) {
    Sample s;
    s.time_s = i * 1e-3;
    const double angle = std::numbers::pi * i / 100.0;
    s.axis = {std::sin(angle), 0.0, std::cos(angle)};
    samples.push_back(s);
  }
  const CheckResult r = f.check(samples);
  for (const Usage* u : {&r.feed, &r.axis_error_rad, &r.axis_jerk, &r.synchrony_rad})
    EXPECT_TRUE(std::isfinite(u->max));
  Fixture empty;
  EXPECT_EQ(empty.check({}).violations(), 0U);
  Sample still;
  still.joints[2] = 0.15;
  EXPECT_EQ(empty.check({still}).violations(), 0U);
}

// A book holds no more than it has room for, and reports the violations in order of time.
TEST(Checker, BoundsItsViolations) {
  Fixture f;
  const Vector3d up(0.0, 0.0, 1.0);
  const int blocks = 110000;
  for (int i = 1; i <= blocks; ++i) f.move({1e-6 * i, 0.0, 0.0}, up, 1.0);
  const CheckResult r = f.check({});
  EXPECT_EQ(r.worst_violations.size(), 100000U);
  EXPECT_TRUE(std::is_sorted(r.worst_violations.begin(), r.worst_violations.end(),
                             [](const Violation& a, const Violation& b) { return a.time_s < b.time_s; }));
}

// The distances by which everything is judged, against brute force along the arc.
TEST(BlockWindow, DistancesAgreeWithBruteForce) {
  Random random(7);
  const auto direction = [&] { return Vector3d(random.normal(), random.normal(), random.normal()).normalized(); };
  for (int round = 0; round < 200; ++round) {
    program::Program p;
    p.start = {.tip_m = direction(), .axis = direction()};
    p.blocks.push_back({.end = {.tip_m = direction(), .axis = direction()}, .duration_s = 1.0});
    program::ProgramSource source(p);
    BlockWindow window(source);
    ASSERT_TRUE(window.read());
    const CheckedBlock& segment = window.segment(0);
    const Vector3d tip = direction(), axis = direction();
    double tip_m = 1e9, axis_rad = 1e9;
    for (int i = 0; i <= 2000; ++i) {
      const Pose pose = program::between(p.start, p.blocks[0].end, i / 2000.0);
      tip_m = std::min(tip_m, (pose.tip_m - tip).norm());
      axis_rad = std::min(axis_rad, program::angle_between(pose.axis, axis));
    }
    EXPECT_NEAR(segment.tip_distance_m(tip), tip_m, 1e-6 / std::max(0.01, tip_m));
    EXPECT_NEAR(segment.axis_distance_rad(axis), axis_rad, 1e-5 / std::max(0.01, axis_rad));
    EXPECT_LE(segment.axis_distance_rad(axis), axis_rad + 1e-12);
  }
}

}  // namespace check_path_test
}  // namespace robomill::path
