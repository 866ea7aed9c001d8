// Cuts whose depth and speed change with time.
#include "robomill/simulation/schedule.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "robomill/base/random.hpp"
#include "robomill/simulation/drilling.hpp"
#include "robomill/simulation/engine.hpp"
#include "testing/simulation/cuts.hpp"
#include "testing/support.hpp"

namespace robomill::simulation {
namespace schedule_test {

using detail::CutModel;
using detail::Engine;
using detail::Physics;
using detail::Profile;

MillingCut robot_cut(double speed_rpm, double depth_m) {
  return testing::cut_of(stability::testing::robot(), speed_rpm, depth_m);
}

/// Root mean square of the displacement between two times.
double size_between(const Simulation& s, double from_s, double to_s) {
  const auto from = static_cast<Eigen::Index>(from_s * s.sample_rate_hz);
  const auto rows = static_cast<Eigen::Index>((to_s - from_s) * s.sample_rate_hz);
  return s.displacement_m.middleRows(from, rows).norm() / std::sqrt(static_cast<double>(rows));
}

// Source: the integral of straight lines by the trapezoidal rule on a grid that holds their corners.
TEST(Schedule, ALineAndItsIntegral) {
  const Profile line({{0.25, 0.5}, {0.75, 1.0}, {1.0, 1.0}, {1.0, 0.25}, {2.0, 0.75}});
  EXPECT_DOUBLE_EQ(line.at(0.0), 0.5);
  EXPECT_DOUBLE_EQ(line.at(0.5), 0.75);
  EXPECT_DOUBLE_EQ(line.at(1.0 - 1e-12), 1.0);
  EXPECT_DOUBLE_EQ(line.at(1.0), 0.25);
  EXPECT_DOUBLE_EQ(line.at(9.0), 0.75);
  double sum = 0.0;
  for (int i = 0; i < 3000; ++i) {
    EXPECT_NEAR(line.before(i * 1e-3), sum, 1e-12);
    sum += 0.5e-3 * (line.at(i * 1e-3) + line.at((i + 1) * 1e-3 - 1e-13));
  }
  EXPECT_DOUBLE_EQ(Profile().at(3.0), 1.0);
  EXPECT_DOUBLE_EQ(Profile().before(3.0), 3.0);
}

// The speed's way into the step is another one (angles from the integral), the surface and the force are the same.
TEST(Schedule, AConstantOneChangesNothing) {
  for (const double helix : {0.0, 0.5}) {
    MillingCut plain = robot_cut(6500.0, 0.3e-3);
    plain.milling.tool.helix_rad = helix;
    plain.milling.tool.runout_m = 1e-5;
    MillingCut scheduled = plain;
    scheduled.schedule = {.depth = {{0.0, 1.0}, {0.1, 1.0}}, .speed = {{0.05, 1.0}}};
    const Simulation a = simulate(plain, {.seconds = 0.2}), b = simulate(scheduled, {.seconds = 0.2});
    const double size = a.displacement_m.cwiseAbs().maxCoeff();
    EXPECT_LT((a.displacement_m - b.displacement_m).cwiseAbs().maxCoeff(), 1e-9 * size);
    EXPECT_LT((a.force_n - b.force_n).cwiseAbs().maxCoeff(), 1e-7 * a.force_n.cwiseAbs().maxCoeff());
  }
}

// Half of twice the depth, half of twice the speed: through other slices, nodes and steps.
TEST(Schedule, AShareIsThatShare) {
  MillingCut whole = robot_cut(6500.0, 0.3e-3);
  whole.milling.tool.helix_rad = 0.5;
  MillingCut half = whole;
  half.axial_depth_m *= 2.0;
  half.schedule.depth = {{0.0, 0.5}};
  const Simulation a = simulate(whole, {.seconds = 0.3, .slices = 3});
  const Simulation deep = simulate(half, {.seconds = 0.3, .slices = 6});
  const double size = a.displacement_m.cwiseAbs().maxCoeff();
  EXPECT_LT((a.displacement_m - deep.displacement_m).cwiseAbs().maxCoeff(), 2e-3 * size);

  MillingCut slow = whole;
  slow.spindle_speed_rad_per_s *= 2.0;
  slow.milling.feed_per_tooth_m *= 0.5;
  slow.schedule.speed = {{0.0, 0.5}};
  const Simulation b = simulate(slow, {.seconds = 0.3, .slices = 3});
  EXPECT_LT((a.displacement_m - b.displacement_m).cwiseAbs().maxCoeff(), 5e-3 * size);
}

// A depth between two slices is a slice of a part of the width: no force jumps as it grows.
TEST(Schedule, TheForceFollowsTheDepthEvenly) {
  MillingCut cut = testing::rigid_cut();
  cut.milling.tool.helix_rad = 0.2;
  const CutModel model = detail::milling_model(cut.milling, cut.spindle_speed_rad_per_s, cut.axial_depth_m, {1000, 4});
  CutModel growing = model;
  growing.depth = Profile({{0.0, 0.0}, {0.2, 1.0}});
  Engine<2> full(model, cut.structure, Physics::full), ramp(growing, cut.structure, Physics::full);
  double most = 0.0, sum = 0.0, expected = 0.0;
  for (int i = 0; i < 10000; ++i) {  // ten revolutions, 0.2 s
    full.step();
    ramp.step();
    most = std::max(most, ramp.mean_force().norm());
    sum += ramp.mean_force().norm();
    expected += full.mean_force().norm() * (i + 0.5) / 10000.0;
    ASSERT_LE(ramp.mean_force().norm(), full.mean_force().norm() * 1.1 + 1.0) << i;
  }
  EXPECT_NEAR(sum, expected, 0.03 * expected);
  EXPECT_GT(most, 0.0);
}

TEST(Schedule, ForcesScaleWithTheDepth) {
  MillingCut cut = testing::rigid_cut();
  cut.schedule.depth = {{0.0, 0.25}, {0.1, 0.25}, {0.1, 1.0}};
  const Simulation s = simulate(cut, {.seconds = 0.2});
  MillingCut whole = cut;
  whole.schedule = {};
  const Simulation w = simulate(whole, {.seconds = 0.2});
  EXPECT_NEAR((s.force_n - 0.25 * w.force_n).topRows(1000).norm(), 0.0, 1e-9 * w.force_n.norm());
  EXPECT_NEAR((s.force_n - w.force_n).bottomRows(1000).norm(), 0.0, 1e-9 * w.force_n.norm());
  EXPECT_EQ(s.verdict, Verdict::stable);
}

// A feed that follows the speed: the same thickness a tooth, so the same forces of a rigid cutter, only slower.
TEST(Schedule, AFeedThatFollowsTheSpeedKeepsTheChips) {
  const MillingCut cut = testing::rigid_cut();
  CutModel model = detail::milling_model(cut.milling, cut.spindle_speed_rad_per_s, cut.axial_depth_m, {1000, 1});
  model.spindle.schedule = Profile({{0.0, 1.0}});
  model.feed = Profile({{0.0, 1.0}});
  Engine<2> engine(model, cut.structure, Physics::full);
  const auto greatest = [&](int steps) {
    double most = 0.0;
    for (int i = 0; i < steps; ++i) {
      engine.step();
      most = std::max(most, engine.mean_force().norm());
    }
    return most;
  };
  const double before = greatest(3000);
  // While it runs: from now on, within a revolution.
  const double now_s = engine.time_s(), turn_s = 1000 * engine.step_s();
  model.spindle.schedule = Profile({{0.0, 1.0}, {now_s, 1.0}, {now_s + turn_s, 0.7}});
  model.feed = Profile({{0.0, 1.0}, {now_s, 1.0}, {now_s + turn_s, 0.7}});
  EXPECT_LT(greatest(3000), 1.02 * before);
  EXPECT_NEAR(greatest(3000), before, 2e-3 * before);
  model.feed =
      Profile({{0.0, 1.0}, {now_s, 1.0}, {now_s + turn_s, 0.7}, {engine.time_s(), 0.7}, {engine.time_s(), 1.0}});
  EXPECT_GT(greatest(6000), 1.15 * before);  // thicker by 1/0.7, edge forces stay
}

TEST(Schedule, NothingIsCutAtNoDepth) {
  MillingCut cut = robot_cut(6500.0, 0.6e-3);
  cut.schedule.depth = {{0.1, 0.0}, {0.1, 1.0}, {0.15, 1.0}, {0.15, 0.0}};
  const Simulation s = simulate(cut, {.seconds = 0.3});
  EXPECT_LT(s.force_n.topRows(1000).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_GT(s.force_n.cwiseAbs().maxCoeff(), 1.0);
  EXPECT_LT(s.force_n.bottomRows(1000).cwiseAbs().maxCoeff(), 1e-9);
}

/// Largest multiplier of a tooth period, from the growth of what a small push leaves between two equal engines.
double growth_after_step(const MillingCut& cut, double from_share, double settle_s, int periods) {
  CutModel model = detail::milling_model(cut.milling, cut.spindle_speed_rad_per_s, cut.axial_depth_m, {720, 1});
  model.depth = Profile({{settle_s, from_share}, {settle_s, 1.0}});
  Engine<2> steady(model, cut.structure, Physics::linear), pushed(model, cut.structure, Physics::linear);
  const int to_step = static_cast<int>(std::lround(settle_s / steady.step_s()));
  for (int i = 0; i < to_step; ++i) {
    steady.step();
    pushed.step();
  }
  for (std::size_t k = 0; k < steady.modes(); ++k) {
    steady.set_mode(k, {1e-6, 0.0});
    pushed.set_mode(k, {1.1e-6, 0.0});
  }
  const int period = 720 / cut.milling.tool.teeth;
  double early = 0.0, late = 0.0;
  for (int p = 0; p < periods; ++p) {
    double size = 0.0;
    for (int i = 0; i < period; ++i) {
      steady.step();
      pushed.step();
      size += (steady.displacement() - pushed.displacement()).squaredNorm();
    }
    if (p >= periods / 3 && p < periods / 3 + 10) early += size;
    if (p >= periods - 10) late += size;
  }
  return std::pow(late / early, 0.5 / (periods - 10 - periods / 3));
}

// Source: the multiplier of small_vibration at the depth the step goes to.
TEST(Schedule, AStepIntoChatterGrowsWithTheMultiplier) {
  MillingCut cut = robot_cut(6500.0, 0.6e-3);
  const SmallVibration small = small_vibration(cut);
  ASSERT_GT(small.spectral_radius, 1.05);
  EXPECT_NEAR(growth_after_step(cut, 0.1, 0.3, 60), small.spectral_radius, 0.01);
}

// A ramp crosses the limit at a known time: before it nothing but the forced vibration, chatter after it.
TEST(Schedule, ARampChattersAfterTheLimit) {
  MillingCut cut = robot_cut(6500.0, 0.8e-3);
  const auto radius = [&](double share) {
    MillingCut at = cut;
    at.axial_depth_m *= share;
    return small_vibration(at).spectral_radius;
  };
  double low = 0.05, high = 1.0;
  ASSERT_LT(radius(low), 1.0);
  ASSERT_GT(radius(high), 1.0);
  for (int i = 0; i < 8; ++i) {
    const double middle = 0.5 * (low + high);
    (radius(middle) < 1.0 ? low : high) = middle;
  }
  const double limit_s = low * 2.0;
  cut.schedule.depth = {{0.0, 0.0}, {2.0, 1.0}};
  SimulationOptions forced;
  forced.seconds = 2.0;
  forced.regeneration = false;
  Simulation full = simulate(cut, {.seconds = 2.0});
  full.displacement_m -= simulate(cut, forced).displacement_m;
  EXPECT_EQ(full.verdict, Verdict::undecided);  // nothing stays long enough to judge
  const double end = size_between(full, 1.8, 2.0);
  EXPECT_LT(size_between(full, 0.0, limit_s), 0.05 * end);
  EXPECT_GT(end, 1e-5);
}

TEST(Schedule, TheVerdictIsOfTheLastHalf) {
  MillingCut cut = robot_cut(6500.0, 0.6e-3);
  cut.schedule.depth = {{0.4, 1.0}, {0.5, 0.2}};
  EXPECT_EQ(simulate(cut, {.seconds = 3.0}).verdict, Verdict::stable);
  cut.schedule.depth = {{0.4, 0.2}, {0.5, 1.0}};
  EXPECT_EQ(simulate(cut, {.seconds = 3.0}).verdict, Verdict::chatter);
}

// Source: in steady state what an edge left a tooth before moved as it does now: nothing regenerates, so that the cut
// without regeneration vibrates alike.
TEST(Schedule, TheForcedVibrationIsThatOfAStableCut) {
  MillingCut cut = robot_cut(6500.0, 0.1e-3);
  cut.schedule.depth = {{0.0, 0.0}, {0.1, 1.0}};
  SimulationOptions options;
  options.seconds = 3.0;
  const Simulation full = simulate(cut, options);
  options.regeneration = false;
  const Simulation forced = simulate(cut, options);
  EXPECT_LT((full.displacement_m - forced.displacement_m).bottomRows(2000).norm(),
            0.01 * forced.displacement_m.bottomRows(2000).norm());
}

// Thrust of a rigid drill as its cone goes in.
TEST(Schedule, ADrillGoesIn) {
  DrillingCut cut;
  cut.diameter_m = 0.006;
  cut.radial_width_m = 0.003;
  cut.feed_per_revolution_m = 1e-4;
  cut.coefficients = {.tangential_n_per_m2 = 9e8, .radial_n_per_m2 = 5e8};
  cut.structure = testing::no_modes();
  cut.spindle_speed_rad_per_s = 3000.0 * testing::rpm;
  const Simulation whole = simulate(cut, {.seconds = 0.4});
  cut.schedule = {.depth = {{0.0, 0.0}, {0.4, 1.0}}, .speed = {{0.2, 1.0}, {0.3, 0.8}}};
  const Simulation s = simulate(cut, {.seconds = 0.4});
  const double thrust = whole.force_n(2000, 2);
  EXPECT_NEAR(s.force_n(1024, 2), 0.25 * thrust, 1e-3 * thrust);
  EXPECT_NEAR(s.force_n(3900, 2), 0.25 * 3900.0 / 1024.0 / 0.8 * thrust, 2e-3 * thrust);
}

TEST(Schedule, RejectsWhatIsNone) {
  MillingCut cut = robot_cut(6500.0, 0.6e-3);
  const auto rejected = [&](const Schedule& schedule) {
    cut.schedule = schedule;
    EXPECT_THROW(cut.validate(), InvalidInput);
  };
  rejected({.depth = {{0.0, 1.1}}});
  rejected({.depth = {{0.0, -0.1}}});
  rejected({.depth = {{-1.0, 0.5}}});
  rejected({.depth = {{1.0, 0.5}, {0.5, 1.0}}});
  rejected({.depth = {{std::nan(""), 0.5}}});
  rejected({.depth = {{0.0, std::nan("")}}});
  rejected({.speed = {{0.0, 0.0}}});
  cut.milling.speed_variation = {.amplitude_ratio = 0.1, .frequency_ratio = 0.5};
  rejected({.speed = {{0.0, 0.5}}});
}

}  // namespace schedule_test
}  // namespace robomill::simulation
