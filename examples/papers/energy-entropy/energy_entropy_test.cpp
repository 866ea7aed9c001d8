// What the comparison with [EnergyEntropyChatter] stands on.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "examples/papers/energy-entropy/drilled_wall.hpp"
#include "examples/papers/energy-entropy/holes_again.hpp"
#include "examples/papers/energy-entropy/squeezed_visibility.hpp"

namespace robomill::examples {
namespace energy_entropy_test {

using std::numbers::pi;

/// A record of zeros.
Hole hole_of(Eigen::Index samples) {
  Hole hole;
  hole.chatter = true;
  hole.record.sample_rate_hz = hole_rate_hz;
  hole.record.acceleration_m_per_s2 = simulation::Simulation::Columns::Zero(samples, 3);
  return hole;
}

double noise(Eigen::Index m) {  // the same numbers everywhere
  const double x = std::sin(12.9898 * static_cast<double>(m)) * 43758.5453;
  return 2.0 * (x - std::floor(x)) - 1.0;
}

// A sine on a line has its amplitude squared as the power of that line.
TEST(SqueezedPower, OfASineIsItsAmplitudeSquared) {
  Hole hole = hole_of(4096);
  for (Eigen::Index m = 0; m < 4096; ++m) {
    hole.record.acceleration_m_per_s2(m, 0) = 3.0 * std::sin(2.0 * pi * 600.0 * static_cast<double>(m) / hole_rate_hz);
  }
  const SqueezedPower squeezed = squeezed_power(hole);
  EXPECT_EQ(squeezed.frequency_hz(30), 600.0);
  EXPECT_NEAR(squeezed.power(30, 200), 9.0, 1e-3);
  EXPECT_LT(squeezed.power.col(200).sum() - squeezed.power(30, 200), 1e-3);
}

// A line that begins at a known time in noise is seen there, within half of the window that reaches beyond it.
TEST(SqueezedVisibility, OfALineThatBeginsIsWhenItBegins) {
  Hole hole = hole_of(16384);
  constexpr double begins_s = 0.8;
  for (Eigen::Index m = 0; m < 16384; ++m) {
    const double t = static_cast<double>(m) / hole_rate_hz;
    hole.record.acceleration_m_per_s2(m, 0) = noise(m) + (t < begins_s ? 0.0 : 20.0 * std::sin(2.0 * pi * 540.0 * t));
    hole.record.acceleration_m_per_s2(m, 1) = noise(m + 100000);
  }
  const SqueezedVisibility seen = squeezed_visibility(squeezed_power(hole), begins_s);
  EXPECT_EQ(seen.line_hz, 540.0);
  EXPECT_NEAR(seen.visible_s, begins_s, 0.038);
  EXPECT_NEAR(seen.tenth_s(), begins_s, 0.038);
  EXPECT_LE(seen.visible_s, seen.tenth_s());
  for (std::size_t k = 1; k < seen.share_s.size(); ++k) EXPECT_LE(seen.share_s[k - 1], seen.share_s[k]);
}

TEST(SqueezedVisibility, IsNoneInNoise) {
  Hole hole = hole_of(16384);
  for (Eigen::Index m = 0; m < 16384; ++m) {
    hole.record.acceleration_m_per_s2(m, 0) = noise(m);
    hole.record.acceleration_m_per_s2(m, 1) = noise(m + 100000);
  }
  EXPECT_TRUE(std::isnan(squeezed_visibility(squeezed_power(hole), 0.8).visible_s));
}

// Each hole is counted once, and by its own onset.
TEST(CountPassed, CountsEveryHoleOnce) {
  const EntropyCourse rises = {{0.1, 0.2, 0.3, 0.4}, {1, 2, 3, 4}, {1, 2, 3, 4}};
  const std::vector<JudgedHole> holes = {
      {true, 0.2, {}, rises}, {true, 0.4, {}, rises}, {true, 0.26, {}, rises}, {false, {}, {}, rises}};
  const Passed low = count_passed(holes, 1.5, true);
  EXPECT_EQ(low.chatter_before, 2);  // 0.2 is more than 50 ms before 0.4 and 0.26
  EXPECT_EQ(low.chatter_in, 1);
  EXPECT_EQ(low.stable_passes, 1);
  const Passed high = count_passed(holes, 4.0, true);
  EXPECT_EQ(high.chatter_never, 3);
  EXPECT_EQ(high.stable_never, 1);
}

// Of entropies at known times: the median of every second hole sets it, and the others are counted against it.
TEST(OnsetThreshold, IsTheMedianOfEverySecondHole) {
  const EntropyCourse rises = {{0.1, 0.2, 0.3, 0.4}, {1, 2, 3, 4}, {1, 2, 3, 4}};
  std::vector<JudgedHole> holes;
  for (const double onset_s : {0.1, 0.4, 0.3, 0.4, 0.4, 0.4}) holes.push_back({true, onset_s, 0.2, rises});
  const OnsetThreshold onset = onset_threshold(holes, &JudgedHole::onset_s);
  EXPECT_EQ(onset.threshold, 3.0);  // of 1, 3, 4
  EXPECT_EQ(onset.low_decile, 1.0);
  EXPECT_EQ(onset.high_decile, 4.0);
  EXPECT_EQ(onset.verified.chatter_in, 3);
  const OnsetThreshold tenth = onset_threshold(holes, &JudgedHole::tenth_s);
  EXPECT_EQ(tenth.threshold, 2.0);
  EXPECT_EQ(tenth.verified.chatter_before, 3);  // 0.3 is more than 50 ms before 0.4
}

// A tone that grows linearly from 0.5 to 1.5 s, then stays.
TEST(Growth, IsThatOfARamp) {
  Hole hole = hole_of(20480);
  EntropyCourse energy;
  for (Eigen::Index m = 0; m < 20480; ++m) {
    const double t = static_cast<double>(m) / hole_rate_hz, ramp = std::clamp(t - 0.5, 0.0, 1.0);
    hole.record.acceleration_m_per_s2(m, 0) = ramp * std::sin(2.0 * pi * 540.0 * t);
    if (m % 256 != 0) continue;
    energy.time_s.push_back(t);
    energy.one.push_back(ramp * ramp);
    energy.both.push_back(ramp * ramp);
  }
  const Growth growth = growth_of(hole, energy);
  EXPECT_NEAR(growth.rises_s, 0.5 + std::sqrt(0.05), 0.025);
  EXPECT_NEAR(growth.settles_s, 0.5 + std::sqrt(0.95), 0.025);
  EXPECT_NEAR(growth.amplitude_s, 0.6, 0.02);
}

/// Turns 16 times a second: 640 samples a turn.
Hole turning_drill() {
  Hole hole = hole_of(20480);
  hole.cut.diameter_m = 5e-3;
  hole.cut.spindle_speed_rad_per_s = 32.0 * pi;
  hole.cut.schedule.depth = {{0.02, 0.0}, {0.52, 1.0}, {1.02, 1.0}, {1.12, 0.0}};
  return hole;
}

// A drill that is moved aside cuts a round hole aside: out = 10 µm times the cosine to that side.
TEST(DrilledWall, OfADrillMovedAsideIsRound) {
  const Hole hole = turning_drill();
  Eigen::MatrixXd path_m = Eigen::MatrixXd::Zero(20480, 2);
  path_m.col(0).setConstant(1e-5);
  const Eigen::MatrixXd wall_m = drilled_wall(hole, path_m, 36);
  ASSERT_EQ(wall_m.cols(), 8);
  for (Eigen::Index k = 0; k < 36; ++k) {
    EXPECT_NEAR(wall_m(k, 3), 1e-5 * std::sin((10.0 * static_cast<double>(k) + 5.0) * pi / 180.0), 1e-6) << k;
  }
}

// One that swings three times a turn leaves three waves, and runout a wider hole: the longer lip cuts it.
TEST(DrilledWall, HasTheWavesOfTheSwing) {
  Hole hole = turning_drill();
  hole.cut.lips = 1;
  hole.cut.runout_m = 2e-6;
  Eigen::MatrixXd path_m = Eigen::MatrixXd::Ones(20480, 3);  // with the drill's own axis, as records have it
  const double begin_s = hole_contact_s + 0.5;
  for (Eigen::Index m = 0; m < 20480; ++m) {
    const double rotation = hole.cut.spindle_speed_rad_per_s * (static_cast<double>(m) / hole_rate_hz - begin_s);
    path_m(m, 0) = 1e-5 * std::cos(3.0 * rotation) * std::sin(rotation);
    path_m(m, 1) = 1e-5 * std::cos(3.0 * rotation) * std::cos(rotation);
  }
  const Eigen::MatrixXd wall_m = drilled_wall(hole, path_m, 360);
  for (Eigen::Index k = 0; k < 360; k += 7) {
    const double angle = (static_cast<double>(k) + 0.5) * pi / 180.0;
    EXPECT_NEAR(wall_m(k, 5), 2e-6 + 1e-5 * std::cos(3.0 * angle), 5e-7) << k;
  }
}

// The stand-ins cut under the printed conditions, and do what the source says of them.
TEST(NamedHoles, AreDrilledAsPrinted) {
  for (const NamedHole& named : named_holes()) {
    const Hole hole = simulate_hole(conditions_of(named), named.chatter, 1, 0);
    EXPECT_EQ(hole.chatter, named.chatter) << named.name;
    EXPECT_NEAR(hole.cut.diameter_m, 1e-3 * named.diameter_mm, 1e-12);
    EXPECT_NEAR(hole.cut.point_angle_rad * 180.0 / pi, named.point_angle_deg, 1e-9);
    EXPECT_NEAR(hole.cut.feed_per_revolution_m * named.spindle_speed_rpm / 60.0, 1e-3 * named.feed_mm_per_s, 1e-12);
  }
}

// No sample before the drill's contact tells of chatter to come: in air there is the spindle's noise and hum alone.
TEST(NamedHoles, AreQuietInAir) {
  for (std::uint64_t k = 0; k < 4; ++k) {
    const Hole hole = simulate_hole(conditions_of(named_holes()[0]), true, 1, k);
    const auto air = static_cast<Eigen::Index>((hole_contact_s - 0.02) * hole_rate_hz);
    EXPECT_LT(hole.record.acceleration_m_per_s2.topRows(air).leftCols<2>().cwiseAbs().maxCoeff(),
              1.1 * (6.0 * 2.0 + 1.0));
  }
}

}  // namespace energy_entropy_test
}  // namespace robomill::examples
