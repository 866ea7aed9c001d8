// Cutters that cannot vibrate: forces, chips and walls in closed form.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "robomill/simulation/engine.hpp"
#include "robomill/simulation/wall.hpp"
#include "testing/simulation/cuts.hpp"

namespace robomill::simulation::detail {
namespace rigid_test {

using std::numbers::pi;

constexpr double revolution = 2.0 * pi;

CutModel model_of(const MillingCut& cut, int steps, int slices = 1) {
  return milling_model(cut.milling, cut.spindle_speed_rad_per_s, cut.axial_depth_m, {steps, slices});
}

/// Force on the tool of one tooth at this angle with this chip.
Eigen::Vector2d tooth_force(const MillingCut& cut, double angle, double chip) {
  const cutting::ForceCoefficients& k = cut.milling.coefficients;
  const Eigen::Vector2d radial(std::sin(angle), std::cos(angle));
  const Eigen::Vector2d along(std::cos(angle), -std::sin(angle));
  return -cut.axial_depth_m * ((k.tangential_n_per_m2 * chip + k.tangential_edge_n_per_m) * along +
                               (k.radial_n_per_m2 * chip + k.radial_edge_n_per_m) * radial);
}

double wrapped(double angle) {
  return angle - revolution * std::floor(angle / revolution);
}

/// Follows the cut after two revolutions for one more and compares each step's mean force with the force in its middle,
/// where every tooth's chip is chip(tooth, angle); steps in which a tooth enters or leaves are left out.
template <class Chip>
void expect_forces(const MillingCut& cut, int steps, const Chip& chip, double tolerance_n) {
  const CutModel model = model_of(cut, steps);
  Engine<2> engine(model, cut.structure, Physics::full);
  const double step = revolution / steps;
  for (int i = 0; i < 3 * steps; ++i) {
    engine.step();
    if (i < 2 * steps) continue;
    Eigen::Vector2d expected = Eigen::Vector2d::Zero();
    bool border = false;
    for (int j = 0; j < cut.milling.tool.teeth; ++j) {
      const double angle = wrapped((i + 0.5) * step + cut.milling.tool.standing_angle(j));
      const double entry = cut.milling.immersion.entry_rad, exit = cut.milling.immersion.exit_rad;
      border = border || std::abs(angle - entry) < step || std::abs(angle - exit) < step;
      if (angle < entry || angle > exit) continue;
      const double h = chip(j, angle);
      if (h > 0.0) expected += tooth_force(cut, angle, h);
    }
    if (border) continue;
    EXPECT_NEAR((engine.mean_force() - expected).norm(), 0.0, tolerance_n) << i;
  }
}

double fed_chip(double feed, double angle) {
  return feed * std::sin(angle);
}

TEST(RigidCut, GivesTheMechanisticForce) {
  const MillingCut cut = testing::rigid_cut();
  const double peak = tooth_force(cut, 0.5 * pi, cut.milling.feed_per_tooth_m).norm();
  expect_forces(
      cut, 2000, [&](int, double angle) { return fed_chip(cut.milling.feed_per_tooth_m, angle); }, 1e-5 * peak);
}

// The impulse of a revolution, entry and exit included, against the integral of the closed form; steps that do not
// meet entry or exit.
TEST(RigidCut, KeepsTheImpulseWhereTeethEnterAndLeave) {
  const MillingCut cut = testing::rigid_cut();
  Eigen::Vector2d expected = Eigen::Vector2d::Zero();
  const int count = 20000;
  const double entry = cut.milling.immersion.entry_rad, range = cut.milling.immersion.exit_rad - entry;
  for (int i = 0; i < count; ++i) {
    const double angle = entry + range * (i + 0.5) / count;
    expected += tooth_force(cut, angle, fed_chip(cut.milling.feed_per_tooth_m, angle)) * (2.0 * range / count);
  }
  double before = 0.0;
  for (const int steps : {62, 124, 248}) {
    const CutModel model = model_of(cut, steps);
    Engine<2> engine(model, cut.structure, Physics::full);
    Eigen::Vector2d impulse = Eigen::Vector2d::Zero();
    for (int i = 0; i < 3 * steps; ++i) {
      engine.step();
      if (i >= 2 * steps) impulse += engine.mean_force() * (revolution / steps);
    }
    const double error = (impulse - expected).norm() / expected.norm();
    EXPECT_LT(error, 6.0 / (steps * steps));
    if (before > 0.0) {
      EXPECT_LT(error, 0.4 * before);
    }
    before = error;
  }
}

// Runout larger than half a feed: one tooth of two cuts everything.
TEST(RigidCut, OneToothCutsForBothWhereRunoutExceedsHalfTheFeed) {
  MillingCut cut = testing::rigid_cut();
  cut.milling.tool.runout_m = 3.1e-5;
  const double feed = cut.milling.feed_per_tooth_m;
  const double peak = tooth_force(cut, 0.5 * pi, 2.0 * feed).norm();
  expect_forces(
      cut, 2000, [&](int tooth, double angle) { return tooth == 0 ? fed_chip(2.0 * feed, angle) : 0.0; }, 1e-4 * peak);
}

TEST(RigidCut, SmallRunoutThickensOneChipAndThinsTheOther) {
  MillingCut cut = testing::rigid_cut();
  cut.milling.immersion = {.entry_rad = 1.0, .exit_rad = 2.0};
  cut.milling.tool.runout_m = 1e-5;
  const double feed = cut.milling.feed_per_tooth_m;
  const double peak = tooth_force(cut, 0.5 * pi, 2.0 * feed).norm();
  expect_forces(
      cut, 2000, [&](int tooth, double angle) { return fed_chip(feed, angle) + (tooth == 0 ? 2e-5 : -2e-5); },
      1e-4 * peak);
}

// Where sin φ is small the shorter tooth misses, further on it cuts: its chip is what neither left.
TEST(RigidCut, AToothMissesOnlyWhereTheFeedIsSmallerThanItLacks) {
  MillingCut cut = testing::rigid_cut();
  cut.milling.immersion = {.entry_rad = 0.0, .exit_rad = pi};
  // The edge forces would jump within a step.
  cut.milling.coefficients.tangential_edge_n_per_m = 0.0;
  cut.milling.coefficients.radial_edge_n_per_m = 0.0;
  cut.milling.tool.runout_m = 2e-5;
  const double feed = cut.milling.feed_per_tooth_m;
  const double peak = tooth_force(cut, 0.5 * pi, 2.0 * feed).norm();
  const auto chip = [&](int tooth, double angle) {
    const double one = fed_chip(feed, angle), two = fed_chip(2.0 * feed, angle);
    return tooth == 0 ? std::min(one + 4e-5, two) : std::min(one - 4e-5, two);
  };
  expect_forces(cut, 4000, chip, 2e-3 * peak);
}

TEST(RigidCut, UnequalPitchSharesTheFeedByPitch) {
  MillingCut cut = testing::rigid_cut();
  cut.milling.tool.teeth = 3;
  cut.milling.tool.pitch_rad = {100.0 * pi / 180.0, 117.3 * pi / 180.0, 142.7 * pi / 180.0};
  cut.milling.immersion = {.entry_rad = 0.3, .exit_rad = 2.0};
  const double peak = tooth_force(cut, 0.5 * pi, 2.0 * cut.milling.feed_per_tooth_m).norm();
  const auto chip = [&](int tooth, double angle) {
    const double feed = 3.0 * cut.milling.feed_per_tooth_m * cut.milling.tool.pitch(tooth) / revolution;
    return fed_chip(feed, angle);
  };
  expect_forces(cut, 3600, chip, 1e-4 * peak);
}

// The table feeds evenly in time, so that a swing of the speed makes the chips swing: h = v (t - t') sin φ with the
// time t' at which the tooth before stood there.
TEST(RigidCut, ASwingOfTheSpeedSwingsTheChip) {
  MillingCut cut = testing::rigid_cut();
  cut.milling.speed_variation = {.amplitude_ratio = 0.3, .frequency_ratio = 0.25};
  const CutModel model = model_of(cut, 4000);
  Engine<2> engine(model, cut.structure, Physics::full);
  const auto time_of = [&](double rotation) {
    double t = rotation / cut.spindle_speed_rad_per_s;
    for (int i = 0; i < 60; ++i) t -= (model.spindle.rotation(t) - rotation) / model.spindle.speed(t);
    return t;
  };
  const double peak = tooth_force(cut, 0.5 * pi, 2.0 * cut.milling.feed_per_tooth_m).norm();
  int compared = 0;
  for (int i = 0; i < 20000; ++i) {
    engine.step();
    if (i < 10000) continue;
    const double middle = engine.time_s() - 0.5 * engine.step_s();
    const double rotation = model.spindle.rotation(middle);
    Eigen::Vector2d expected = Eigen::Vector2d::Zero();
    bool border = false;
    for (int j = 0; j < 2; ++j) {
      const double angle = wrapped(rotation + pi * j);
      border = border || std::abs(angle - 0.7) < 3e-3 || std::abs(angle - 2.5) < 3e-3;
      if (angle < 0.7 || angle > 2.5) continue;
      expected += tooth_force(cut, angle, fed_chip(model.feed_m_per_s * (middle - time_of(rotation - pi)), angle));
      ++compared;
    }
    if (border) continue;
    EXPECT_NEAR((engine.mean_force() - expected).norm(), 0.0, 2e-4 * peak) << i;
  }
  EXPECT_GT(compared, 4000);
}

// Source: [Martellotti1941], scallops f²/8R', R' = R ± N f / π for up- and down-milling, and Ra = 4/(9√3) of a
// parabola.
TEST(RigidCut, LeavesScallopsOfTheClosedForm) {
  for (const bool up : {true, false}) {
    MillingCut cut = testing::rigid_cut();
    cut.milling.feed_per_tooth_m = 3e-4;
    cut.milling.immersion = up ? cutting::Immersion{0.0, 1.2} : cutting::Immersion{2.0, pi};
    const Simulation s = simulate(cut, {.seconds = 1.0, .steps_per_revolution = 640});
    ASSERT_EQ(s.walls.size(), 1U);
    const double f = 3e-4, radius = 0.005 + (up ? 2.0 : -2.0) * f / pi;
    const double scallop = f * f / (8.0 * radius);
    EXPECT_DOUBLE_EQ(s.walls[0].angle_rad, up ? 0.0 : pi);
    EXPECT_NEAR(s.walls[0].rz_m, scallop, 2e-2 * scallop);
    EXPECT_NEAR(s.walls[0].ra_m, 4.0 / (9.0 * std::sqrt(3.0)) * scallop, 2e-2 * scallop);
    EXPECT_NEAR(s.walls[0].location_error_m, scallop / 3.0, 2e-2 * scallop);
    EXPECT_EQ(s.verdict, Verdict::stable);
  }
}

// Only the longer tooth leaves the wall: its scallops are those of twice the feed, and the wall lies by the runout
// further out.
TEST(RigidCut, RunoutCoarsensTheWall) {
  MillingCut cut = testing::rigid_cut();
  cut.milling.feed_per_tooth_m = 1e-4;
  cut.milling.immersion = {0.0, 1.2};
  cut.milling.tool.runout_m = 2e-5;
  const Simulation s = simulate(cut, {.seconds = 1.0, .steps_per_revolution = 640});
  ASSERT_EQ(s.walls.size(), 1U);
  const double scallop = 4e-8 / (8.0 * (0.005 + 2e-4 / pi));
  EXPECT_NEAR(s.walls[0].rz_m, scallop, 2e-2 * scallop);
  EXPECT_NEAR(s.walls[0].location_error_m, scallop / 3.0 - 2e-5, 2e-2 * scallop);
  // Up to where the feed has made up for what the other tooth lacks.
  EXPECT_NEAR(s.missed_share, std::asin(0.4) / revolution, 0.005);
}

// Slices against the integral over the height: a revolution's impulse does not depend on the helix.
TEST(RigidCut, HelixSpreadsTheForceAndKeepsItsImpulse) {
  MillingCut cut = testing::rigid_cut();
  cut.milling.tool.helix_rad = 0.6;
  cut.axial_depth_m = 5e-3;
  Eigen::Vector2d straight = Eigen::Vector2d::Zero();
  for (const double helix : {0.0, 0.6}) {
    cut.milling.tool.helix_rad = helix;
    const CutModel model = model_of(cut, 720, helix == 0.0 ? 1 : 24);
    Engine<2> engine(model, cut.structure, Physics::full);
    Eigen::Vector2d impulse = Eigen::Vector2d::Zero();
    for (int i = 0; i < 3 * 720; ++i) {
      engine.step();
      if (i >= 2 * 720) impulse += engine.mean_force();
    }
    if (helix == 0.0) {
      straight = impulse;
    } else {
      EXPECT_NEAR((impulse - straight).norm(), 0.0, 1e-4 * straight.norm());
    }
  }
}

}  // namespace rigid_test
}  // namespace robomill::simulation::detail
