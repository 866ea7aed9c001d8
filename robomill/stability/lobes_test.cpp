#include "robomill/stability/lobes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/parallel.hpp"
#include "robomill/base/random.hpp"
#include "testing/stability/problems.hpp"
#include "testing/support.hpp"

namespace robomill::stability {
namespace lobes_test {

using std::numbers::pi;
using test::field_of;
using testing::benchmark;
using testing::chart;
using testing::robot;
using testing::rpm;

PointResult at(const LobesProblem& problem, double speed_rpm, double depth_m, int intervals = 40) {
  LobesOptions options;
  options.method = Method::semi_discretization;
  options.intervals = intervals;
  return evaluate_point(problem, options, {speed_rpm * rpm, depth_m});
}
double radius(const LobesProblem& problem, double speed_rpm, double depth_m, int intervals = 40) {
  return at(problem, speed_rpm, depth_m, intervals).spectral_radius;
}

Eigen::Matrix2d rotation(double angle) {
  Eigen::Matrix2d r;
  r << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
  return r;
}

// Without a cut each mode fades on its own: |μ| = exp(-ζ ω T) of the one that fades slowest.
TEST(Lobes, WithoutDepthTheSlowestModeDecides) {
  for (const double speed_rpm : {2000.0, 6500.0, 30000.0}) {
    const PointResult p = at(robot(), speed_rpm, 0.0);
    const double period_s = 60.0 / speed_rpm / 3.0;
    EXPECT_NEAR(p.spectral_radius, std::exp(-0.0127 * 2.0 * pi * 17.40 * period_s), 1e-12);
    EXPECT_EQ(p.mode.number, 1);
    EXPECT_NEAR(p.chatter_frequency_hz, 17.40 * std::sqrt(1.0 - 0.0127 * 0.0127), 1e-9);
    EXPECT_TRUE(p.stable);
  }
}

TEST(Lobes, TurningTheStructureAndTheFeedTogetherChangesNothing) {
  const double expected = radius(robot(), 6500, 1e-3);
  for (const double angle : {0.3, 1.7, -2.2}) {
    LobesProblem turned = robot();
    turned.feed_direction_rad = angle;
    EXPECT_GT(std::abs(radius(turned, 6500, 1e-3) - expected), 1e-4);
    for (modal::Mode& mode : turned.dynamics.modes) {
      mode.left = (rotation(angle) * mode.left).eval();
      mode.right = (rotation(angle) * mode.right).eval();
    }
    EXPECT_NEAR(radius(turned, 6500, 1e-3), expected, 1e-10);
  }
}

TEST(Lobes, FeedingBackwardsChangesNothing) {
  LobesProblem forth = robot(), back = robot();
  forth.feed_direction_rad = 0.4;
  back.feed_direction_rad = 0.4 + pi;
  EXPECT_NEAR(radius(forth, 7000, 1e-3), radius(back, 7000, 1e-3), 1e-10);
}

// Half immersion: the arc that an up-milling cutter cuts is that of a down-milling one with the feed a quarter turn on.
TEST(Lobes, UpMillingIsDownMillingWithTheFeedTurned) {
  LobesProblem up = robot(), down = robot();
  up.milling.tool.teeth = down.milling.tool.teeth = 2;
  up.milling.immersion = {.entry_rad = 0.0, .exit_rad = pi / 2.0};
  down.milling.immersion = {.entry_rad = pi / 2.0, .exit_rad = pi};
  down.feed_direction_rad = pi / 2.0;
  EXPECT_NEAR(radius(up, 9000, 0.7e-3), radius(down, 9000, 0.7e-3), 1e-10);
  down.feed_direction_rad = 0.0;
  EXPECT_GT(std::abs(radius(up, 9000, 0.7e-3) - radius(down, 9000, 0.7e-3)), 1e-3);
}

TEST(Lobes, OrderAndScaleOfTheModesDoNotMatter) {
  const double expected = radius(robot(), 6500, 1e-3);
  LobesProblem other = robot();
  std::ranges::reverse(other.dynamics.modes);
  Random random(3);
  for (modal::Mode& mode : other.dynamics.modes) {
    const std::complex<double> c = std::polar(std::exp(3.0 * random.normal()), random.uniform(0.0, 6.0));
    mode.left *= c;
    mode.right /= c;
  }
  EXPECT_NEAR(radius(other, 6500, 1e-3), expected, 1e-10);
  EXPECT_EQ(at(other, 6500, 1e-3).mode.number, 9 - at(robot(), 6500, 1e-3).mode.number);
}

TEST(Lobes, KeptModesAreTheOnlyModes) {
  LobesProblem kept = robot(), only = robot();
  kept.keep_modes = {8, 7};
  only.dynamics.modes.erase(only.dynamics.modes.begin(), only.dynamics.modes.begin() + 6);
  EXPECT_NEAR(radius(kept, 6500, 1e-3), radius(only, 6500, 1e-3), 1e-12);
  EXPECT_EQ(at(kept, 6500, 1e-3).mode.number, 8);
  EXPECT_EQ(at(only, 6500, 1e-3).mode.number, 2);
  kept.keep_modes = {1, 2, 3, 4, 5, 6, 7, 8};
  EXPECT_NEAR(radius(kept, 6500, 1e-3), radius(robot(), 6500, 1e-3), 1e-12);
}

// A structure of one direction, said by leaving y out or by leaving y at rest.
TEST(Lobes, OneDirectionNeedsNoOther) {
  LobesProblem x = benchmark(1.0, 1);
  x.dynamics.excitations = x.dynamics.responses = {{.axis = modal::Axis::x}};
  x.dynamics.modes[0].left.conservativeResize(1);
  x.dynamics.modes[0].right.conservativeResize(1);
  EXPECT_NEAR(radius(x, 5000, 0.5e-3), radius(benchmark(1.0, 1), 5000, 0.5e-3), 1e-12);
}

TEST(Lobes, OtherAxesAndPointsAreNotTheTips) {
  LobesProblem more = robot();
  more.dynamics.responses.push_back({.axis = modal::Axis::z});
  more.dynamics.responses.push_back({.point = 4, .axis = modal::Axis::x});
  for (modal::Mode& mode : more.dynamics.modes) {
    mode.right.conservativeResize(4);
    mode.right.tail(2).setConstant(1.0);
  }
  EXPECT_NEAR(radius(more, 6500, 1e-3), radius(robot(), 6500, 1e-3), 1e-12);
}

// What stands far above the band and is known by its stiffness alone acts as the mode that it is.
TEST(Lobes, StiffnessResidualIsAModeFarAbove) {
  const double stiffness_n_per_m = 5e6, frequency_hz = 60000.0;
  const double omega = 2.0 * pi * frequency_hz;
  LobesProblem whole = benchmark(0.3);
  for (const Eigen::Index axis : {0, 1}) {
    whole.dynamics.modes.push_back(testing::mass_mode(axis, frequency_hz, 0.5, stiffness_n_per_m / (omega * omega)));
  }
  LobesProblem rest = benchmark(0.3);
  for (const char* name : {"xx", "yy"}) {
    rest.dynamics.residuals.push_back(
        {.name = modal::parse_frf_name(name), .mass = 0.5, .stiffness = 1.0 / stiffness_n_per_m});
  }
  const double with = radius(rest, 9000, 2e-3, 320);
  EXPECT_NEAR(with, radius(whole, 9000, 2e-3, 320), 4e-3);
  EXPECT_GT(std::abs(with - radius(benchmark(0.3), 9000, 2e-3, 320)), 0.03);
  // It turns with the feed as the modes do.
  LobesProblem turned = rest;
  turned.feed_direction_rad = pi / 2.0;
  EXPECT_NEAR(radius(turned, 9000, 2e-3, 320), with, 1e-9);
}

TEST(Lobes, EqualPitchMayBeWrittenOut) {
  LobesProblem written = robot();
  written.milling.tool.pitch_rad.assign(3, 2.0 * pi / 3.0);
  EXPECT_EQ(radius(written, 6500, 1e-3), radius(robot(), 6500, 1e-3));
  LobesOptions options = chart(6000, 7000, 1e-3, 2, 2);
  EXPECT_EQ(compute_lobes(written, options).period, Period::tooth);
}

// A pitch that is hardly unequal makes one revolution of N tooth periods.
TEST(Lobes, RevolutionIsTheToothPeriodsOneAfterTheOther) {
  LobesProblem unequal = robot();
  const double equal = 2.0 * pi / 3.0;
  unequal.milling.tool.pitch_rad = {equal + 1e-7, equal - 1e-7, equal};
  const double tooth = radius(robot(), 6500, 1e-3);
  EXPECT_NEAR(radius(unequal, 6500, 1e-3), tooth * tooth * tooth, 1e-5);
  LobesOptions options = chart(6000, 7000, 1e-3, 2, 2);
  EXPECT_EQ(compute_lobes(unequal, options).period, Period::revolution);
  // A pitch that is plainly unequal is another matter.
  unequal.milling.tool.pitch_rad = {equal + 0.2, equal - 0.2, equal};
  EXPECT_GT(std::abs(radius(unequal, 6500, 1e-3) - tooth * tooth * tooth), 0.01);
}

// Source: the same cuts computed for the published robot; its model chatters there at 543 to 568 Hz.
TEST(Lobes, RobotChattersInItsHighestModes) {
  for (const auto& [speed_rpm, depth_m] :
       {std::pair{6500.0, 0.6e-3}, {8000.0, 1.2e-3}, {15000.0, 1.1e-3}, {6500.0, 0.8e-3}, {8000.0, 1.5e-3}}) {
    const PointResult p = at(robot(), speed_rpm, depth_m);
    EXPECT_FALSE(p.stable);
    EXPECT_EQ(p.kind, BifurcationType::hopf);
    EXPECT_EQ(p.mode.number, 8);
    EXPECT_GT(p.chatter_frequency_hz, 542.0);
    EXPECT_LT(p.chatter_frequency_hz, 569.0);
    // The frequency is the multiplier's, and harmonics of tooth passing away from it.
    const double passing_hz = 3.0 * speed_rpm / 60.0;
    const double base_hz = std::arg(p.multiplier) / (2.0 * pi) * passing_hz;
    const double harmonics = std::min(std::abs(std::remainder(p.chatter_frequency_hz - base_hz, passing_hz)),
                                      std::abs(std::remainder(p.chatter_frequency_hz + base_hz, passing_hz)));
    EXPECT_NEAR(harmonics, 0.0, 1e-6);
  }
}

// At low immersion and high speed the benchmark has flip lobes: the chatter frequency is an odd multiple of half the
// tooth passing frequency.
TEST(Lobes, FlipChattersAtHalfTheToothPassing) {
  const LobesResult result = compute_lobes(benchmark(0.05), chart(15000, 25000, 8e-3, 60, 40));
  int flips = 0;
  for (const BoundaryPoint& b : result.boundary) {
    if (b.kind != BifurcationType::flip) continue;
    ++flips;
    const double passing_hz = 2.0 * b.spindle_speed_rad_per_s / (2.0 * pi);
    const double halves = b.chatter_frequency_hz / (0.5 * passing_hz);
    EXPECT_NEAR(halves, std::round(halves), 1e-9);
    EXPECT_EQ(std::lround(halves) % 2, 1);
    EXPECT_NEAR(b.chatter_frequency_hz, 922.0, 250.0);
  }
  EXPECT_GT(flips, 20);
}

TEST(Lobes, BoundaryAndLimitLieWhereTheRadiusIsOne) {
  const LobesProblem problem = robot();
  LobesOptions options = chart(4000, 16000, 3e-3, 30, 24);
  options.tolerance = 1e-8;
  options.output = Output::both;
  const LobesResult result = compute_lobes(problem, options);
  EXPECT_EQ(result.unsettled, 0);
  ASSERT_GT(result.boundary.size(), 40U);
  for (std::size_t i = 0; i < result.boundary.size(); ++i) {
    const BoundaryPoint& b = result.boundary[i];
    EXPECT_NEAR(radius(problem, b.spindle_speed_rad_per_s / rpm, b.axial_depth_m), 1.0, 1.1e-8);
    const BoundaryPoint& before = result.boundary[i > 0 ? i - 1 : 0];
    EXPECT_GE(b.curve, before.curve);
    if (b.curve == before.curve) {
      EXPECT_NEAR(b.spindle_speed_rad_per_s, before.spindle_speed_rad_per_s, 12000.0 / 29.0 * rpm * 1.0001);
      EXPECT_NEAR(b.axial_depth_m, before.axial_depth_m, 3e-3 / 23.0 * 1.0001);
    }
    EXPECT_GT(b.mode.number, 0);
  }
  ASSERT_EQ(result.limit.size(), 30U);
  for (Eigen::Index i = 0; i < 30; ++i) {
    const Limit& limit = result.limit[static_cast<std::size_t>(i)];
    EXPECT_EQ(limit.spindle_speed_rad_per_s, result.spindle_speed_rad_per_s(i));
    for (Eigen::Index j = 0; j < 24; ++j) {
      const bool all = limit.status == Limit::Status::stable_in_range;
      if (!all && result.axial_depth_m(j) >= limit.axial_depth_m) continue;
      EXPECT_LT(result.spectral_radius(j, i), 1.0);
    }
    if (limit.status == Limit::Status::found) {
      EXPECT_NEAR(radius(problem, limit.spindle_speed_rad_per_s / rpm, limit.axial_depth_m), 1.0, 1.1e-8);
    }
  }
}

TEST(Lobes, MapBoundaryPointsAndLimitsAgree) {
  LobesOptions options = chart(4000, 16000, 3e-3, 12, 10);
  options.points = {{4000 * rpm, 3e-3}, {20000 * rpm, 4e-3}};
  const LobesResult boundary = compute_lobes(robot(), options);
  options.output = Output::map;
  const LobesResult map = compute_lobes(robot(), options);
  EXPECT_TRUE(map.boundary.empty());
  EXPECT_EQ(boundary.spectral_radius.size(), 0);
  ASSERT_EQ(map.points.size(), 2U);
  EXPECT_NEAR(map.points[0].spectral_radius, map.spectral_radius(9, 0), 1e-10);
  EXPECT_EQ(map.points[1].axial_depth_m, 4e-3);
  std::vector<double> speeds(map.spindle_speed_rad_per_s.begin(), map.spindle_speed_rad_per_s.end());
  const std::vector<Limit> limits = limit_depths(robot(), options, speeds);
  for (std::size_t i = 0; i < 12; ++i) {
    EXPECT_EQ(limits[i].status, map.limit[i].status);
    EXPECT_NEAR(limits[i].axial_depth_m, map.limit[i].axial_depth_m, 1e-12);
    EXPECT_EQ(boundary.limit[i].mode, map.limit[i].mode);
    EXPECT_NEAR(boundary.limit[i].axial_depth_m, map.limit[i].axial_depth_m, 1e-8);
  }
}

TEST(Lobes, LimitIsTheLeastDepthWhereThatIsUnstableAlready) {
  LobesOptions options = chart(6400, 6600, 3e-3, 3, 8);
  options.axial_depth_m = {1e-3, 3e-3};
  for (const Output output : {Output::map, Output::boundary}) {
    options.output = output;
    const LobesResult result = compute_lobes(robot(), options);
    for (const Limit& limit : result.limit) {
      EXPECT_EQ(limit.status, Limit::Status::found);
      EXPECT_EQ(limit.axial_depth_m, 1e-3);
      EXPECT_EQ(limit.mode.number, 8);
    }
  }
}

TEST(Lobes, NoLimitIsAnAnswer) {
  const LobesResult result = compute_lobes(robot(), chart(6000, 7000, 0.1e-3, 5, 5));
  for (const Limit& limit : result.limit) EXPECT_EQ(limit.status, Limit::Status::stable_in_range);
  EXPECT_TRUE(result.boundary.empty());
}

TEST(Lobes, SameBitsAtAnyNumberOfThreads) {
  LobesProblem problem = robot();
  problem.milling.tool.helix_rad = 0.5;
  LobesOptions options = chart(4000, 16000, 3e-3, 11, 10);
  options.output = Output::both;
  set_thread_count(1);
  const LobesResult one = compute_lobes(problem, options);
  for (const int threads : {2, 8}) {
    set_thread_count(threads);
    const LobesResult many = compute_lobes(problem, options);
    EXPECT_EQ(many.spectral_radius, one.spectral_radius);
    ASSERT_EQ(many.boundary.size(), one.boundary.size());
    for (std::size_t i = 0; i < one.boundary.size(); ++i) {
      EXPECT_EQ(many.boundary[i].axial_depth_m, one.boundary[i].axial_depth_m);
      EXPECT_EQ(many.boundary[i].chatter_frequency_hz, one.boundary[i].chatter_frequency_hz);
    }
    EXPECT_EQ(many.evaluations, one.evaluations);
  }
  set_thread_count(0);
}

TEST(Lobes, StopsWhenAsked) {
  std::atomic<bool> stop = true;
  Progress progress({}, &stop);
  EXPECT_THROW(static_cast<void>(compute_lobes(robot(), chart(4000, 16000, 3e-3, 20, 20), progress)), Interrupted);
}

TEST(Lobes, AbsurdCutsGiveNumbersAndNoNan) {
  for (const double radial : {9e11, -9e11}) {
    LobesProblem absurd = benchmark(1.0);
    absurd.milling.coefficients = {.tangential_n_per_m2 = 9e11, .radial_n_per_m2 = radial};
    const PointResult p = at(absurd, 50, 0.5, 8);
    EXPECT_TRUE(std::isfinite(p.spectral_radius));
    EXPECT_TRUE(std::isfinite(std::abs(p.multiplier)));
    EXPECT_TRUE(std::isfinite(p.error_estimate));
    EXPECT_TRUE(std::isfinite(p.chatter_frequency_hz));
    // A negative radial coefficient pulls the tool in: it runs away.
    if (radial < 0.0) {
      EXPECT_FALSE(p.stable);
      EXPECT_EQ(p.spectral_radius, 1e100);
    }
  }
  LobesProblem absurd = benchmark(1.0);
  absurd.milling.coefficients = {.tangential_n_per_m2 = 9e11, .radial_n_per_m2 = -9e11};
  LobesOptions options = chart(50, 100, 0.5, 3, 4);
  options.output = Output::map;
  const LobesResult result = compute_lobes(absurd, options);
  EXPECT_TRUE(result.spectral_radius.allFinite());
  EXPECT_GT(result.unsettled, 0);
  for (const Limit& limit : result.limit) EXPECT_EQ(limit.status, Limit::Status::found);
}

TEST(LobesOptions, RejectsWhatCannotBe) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto rejected = [](auto change) {
    LobesOptions o = chart(4000, 16000, 3e-3, 20, 20);
    change(o);
    return field_of([&] { o.validate(); });
  };
  EXPECT_EQ(rejected([](LobesOptions&) {}), "accepted");
  EXPECT_EQ(field_of([] { LobesOptions{}.validate(); }), "spindle_speed_rad_per_s");
  EXPECT_EQ(rejected([](LobesOptions& o) { o.spindle_speed_rad_per_s = {500.0, 400.0}; }), "spindle_speed_rad_per_s");
  EXPECT_EQ(rejected([&](LobesOptions& o) { o.spindle_speed_rad_per_s[1] = nan; }), "spindle_speed_rad_per_s");
  EXPECT_EQ(rejected([](LobesOptions& o) { o.axial_depth_m = {0.0, 1.0}; }), "axial_depth_m");
  EXPECT_EQ(rejected([](LobesOptions& o) { o.axial_depth_m = {-1e-3, 1e-3}; }), "axial_depth_m");
  EXPECT_EQ(rejected([](LobesOptions& o) { o.grid = {1, 20}; }), "grid");
  EXPECT_EQ(rejected([](LobesOptions& o) { o.grid = {20001, 20}; }), "grid");
  EXPECT_EQ(rejected([](LobesOptions& o) { o.intervals = 3; }), "intervals");
  EXPECT_EQ(rejected([](LobesOptions& o) { o.intervals = 1 << 20; }), "intervals");
  EXPECT_EQ(rejected([](LobesOptions& o) { o.tolerance = 0.0; }), "tolerance");
  EXPECT_EQ(rejected([&](LobesOptions& o) { o.tolerance = nan; }), "tolerance");
  EXPECT_EQ(rejected([](LobesOptions& o) { o.points = {{0.0, 1e-3}}; }), "points.spindle_speed_rad_per_s");
  EXPECT_EQ(rejected([](LobesOptions& o) { o.points = {{400.0, 1.0}}; }), "points.axial_depth_m");
}

TEST(LobesProblem, RejectsWhatCannotBe) {
  const auto rejected = [](auto change) {
    LobesProblem p = robot();
    change(p);
    return field_of([&] { p.validate(); });
  };
  EXPECT_EQ(rejected([](LobesProblem&) {}), "accepted");
  EXPECT_EQ(rejected([](LobesProblem& p) { p.milling.tool.teeth = 0; }), "teeth");
  EXPECT_EQ(rejected([](LobesProblem& p) { p.keep_modes = {0}; }), "keep_modes");
  EXPECT_EQ(rejected([](LobesProblem& p) { p.keep_modes = {9}; }), "keep_modes");
  EXPECT_EQ(rejected([](LobesProblem& p) { p.keep_modes = {2, 2}; }), "keep_modes");
  EXPECT_EQ(rejected([](LobesProblem& p) { p.dynamics.modes.clear(); }), "modes");
  EXPECT_EQ(rejected([](LobesProblem& p) { p.dynamics.modes[3].damping_ratio = -0.1; }), "modes[4].damping_ratio");
  EXPECT_EQ(rejected([](LobesProblem& p) { p.feed_direction_rad = std::nan(""); }), "feed_direction_rad");
  const auto on_z = [](LobesProblem& p) {
    p.dynamics.excitations = p.dynamics.responses = {{.axis = modal::Axis::z}, {.axis = modal::Axis::rx}};
  };
  EXPECT_EQ(rejected(on_z), "modes");
  const auto elsewhere = [](LobesProblem& p) {
    p.dynamics.excitations = p.dynamics.responses = {{1, modal::Axis::x}, {2, modal::Axis::y}};
  };
  EXPECT_EQ(rejected(elsewhere), "modes");
  LobesProblem tight = robot();
  tight.milling.tool.pitch_rad = {0.02, 3.0, 2.0 * pi - 3.02};
  EXPECT_EQ(field_of([&] { static_cast<void>(at(tight, 6000, 1e-3)); }), "intervals");
}

}  // namespace lobes_test
}  // namespace robomill::stability
