#include "robomill/stability/peak_classification.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/random.hpp"
#include "testing/stability/problems.hpp"
#include "testing/support.hpp"

namespace robomill::stability {
namespace peak_classification_test {

using std::numbers::pi;
using test::field_of;
using testing::rpm;
using Named = Explanation::Kind;

PeakClassification robot_peaks(std::vector<double> peaks_hz, double speed_rpm) {
  return explain({std::move(peaks_hz), speed_rpm * rpm, 3}, data::robot_modes());
}

// Source: [RobotMillingChatter] cuts at 6,500 rpm, 0.8 and 0.6 mm, and at 8,000 rpm, read with three teeth (it does not
// print how many: docs/errata.md).
TEST(PeakClassification, NamesTheDocumentedPeaks) {
  const PeakClassification found = robot_peaks({324.99, 666.98, 991.98, 1966.95}, 6500);
  ASSERT_EQ(found.peaks.size(), 4U);
  EXPECT_EQ(found.peaks[0].best.kind, Named::tooth_passing);
  EXPECT_EQ(found.peaks[0].best.harmonic, 3);
  const int harmonic[] = {0, 6, 9, 18};
  for (std::size_t i = 1; i < 4; ++i) {
    const Explanation& e = found.peaks[i].best;
    EXPECT_EQ(e.kind, Named::chatter);
    EXPECT_EQ(e.mode.number, 1);
    EXPECT_EQ(e.harmonic, harmonic[i]);
    EXPECT_TRUE(e.of_tooth_passing);
    EXPECT_NEAR(e.difference_hz, -0.42, 0.1);
  }
  EXPECT_EQ(found.mode.number, 1);
  EXPECT_NEAR(found.chatter_frequency_hz, 17.0, 0.05);
  EXPECT_TRUE(found.speed_from_peaks);
  EXPECT_NEAR(found.spindle_speed_rad_per_s / rpm, 6499.8, 0.05);

  const PeakClassification milder = robot_peaks({667.483, 1967.45, 2075.95}, 6500);
  EXPECT_FALSE(milder.speed_from_peaks);
  EXPECT_EQ(milder.peaks[2].best.harmonic, 19);
  EXPECT_FALSE(milder.peaks[2].best.of_tooth_passing);
  for (const ExplainedPeak& peak : milder.peaks) EXPECT_EQ(peak.best.mode.number, 1);

  const PeakClassification faster = robot_peaks({3866.9}, 8000);
  EXPECT_EQ(faster.peaks[0].best.kind, Named::rotation);
  EXPECT_EQ(faster.peaks[0].best.harmonic, 29);
  EXPECT_EQ(faster.mode.number, 0);
}

// A weak mode names no peak; the others keep their numbers.
TEST(PeakClassification, WeakModesNameNothing) {
  modal::ModalModel modes = data::robot_modes();
  const MeasuredPeaks peaks{.frequency_hz = {666.98}, .spindle_speed_rad_per_s = 6500 * rpm, .teeth = 3};
  const int named = explain(peaks, modes).peaks[0].best.mode.number;
  ASSERT_EQ(named, 1);
  modes.modes[0].weak = true;
  const PeakClassification without = explain(peaks, modes);
  EXPECT_NE(without.peaks[0].best.mode.number, 1);
  for (const Explanation& other : without.peaks[0].others) EXPECT_NE(other.mode.number, 1);
  modes.modes[0].weak = false;
  for (std::size_t k = 1; k < modes.modes.size(); ++k) modes.modes[k].weak = true;
  EXPECT_EQ(explain(peaks, modes).peaks[0].best.mode.number, 1);
}

// The spindle runs 0.15 % slow under load: the 30th multiple is 5 Hz off, and still one.
TEST(PeakClassification, FindsTheTrueSpeedInThePeaks) {
  const double rotation_hz = 6500.0 / 60.0 * 0.9985;
  const PeakClassification found =
      robot_peaks({3 * rotation_hz, 18 * rotation_hz, 30 * rotation_hz, 9 * rotation_hz + 17.2}, 6500);
  EXPECT_NEAR(found.spindle_speed_rad_per_s / (2.0 * pi), rotation_hz, 1e-9);
  for (const std::size_t i : {0U, 1U, 2U}) EXPECT_EQ(found.peaks[i].best.kind, Named::tooth_passing);
  EXPECT_EQ(found.peaks[3].best.mode.number, 1);
  // With one peak alone nothing says that the speed is another.
  EXPECT_FALSE(robot_peaks({30 * rotation_hz}, 6500).speed_from_peaks);
}

TEST(PeakClassification, PeaksBelowAMultipleAreItsMirrorImage) {
  const double rotation_hz = 6500.0 / 60.0;
  const PeakClassification found = robot_peaks({6.0 * rotation_hz - 17.4, 12.0 * rotation_hz - 17.0}, 6500);
  EXPECT_EQ(found.peaks[0].best.kind, Named::chatter);
  EXPECT_EQ(found.peaks[0].best.harmonic, -6);
  EXPECT_TRUE(found.peaks[0].best.mirrored);
  EXPECT_EQ(found.peaks[0].best.mode.number, 1);
  EXPECT_NEAR(found.peaks[0].best.difference_hz, 0.0, 1e-9);
  EXPECT_NEAR(found.peaks[1].best.difference_hz, 0.4, 1e-9);
  EXPECT_NEAR(found.chatter_frequency_hz, 17.2, 1e-9);
}

// 540.9 Hz lies within the widths of modes 7 and 8 both; 541.67 Hz is a multiple of rotation as well.
TEST(PeakClassification, NamesNoReadingWhereAnotherIsAboutAsGood) {
  using State = ExplainedPeak::State;
  const PeakClassification found = robot_peaks({540.9, 539.5}, 6500);
  const ExplainedPeak& peak = found.peaks[0];
  EXPECT_EQ(peak.state, State::ambiguous);
  EXPECT_EQ(peak.best.kind, Named::cut_or_chatter);
  EXPECT_FALSE(peak.best.mode.known());
  EXPECT_TRUE(std::isnan(peak.chatter_frequency_hz));
  ASSERT_EQ(peak.others.size(), 5U);  // the cut, both modes, and the mirror images at 10 rotations less each
  EXPECT_EQ(peak.others[0].kind, Named::rotation);
  EXPECT_EQ(peak.others[1].mode.number, 7);
  for (const Explanation& e : peak.others) {
    EXPECT_NEAR(e.likelihood_per_hz, std::exp(-2.0 * std::pow(e.difference_hz / e.tolerance_hz, 2)) / e.tolerance_hz,
                1e-15);
    EXPECT_NEAR(e.tolerance_hz, e.mode.number == 8 ? 0.021 * 543.67 : e.mode.number == 7 ? 0.0068 * 540.08 : 1.0, 1e-9);
  }
  // Of 539.5 Hz both modes are readings, and no multiple: it is chatter, of either.
  EXPECT_EQ(found.peaks[1].state, State::ambiguous);
  EXPECT_EQ(found.peaks[1].best.kind, Named::chatter);
  EXPECT_EQ(found.peaks[1].others[0].mode.number, 7);
  EXPECT_EQ(found.peaks[1].others[1].mode.number, 8);
  EXPECT_EQ(found.state, PeakClassification::State::ambiguous);
  EXPECT_FALSE(found.mode.known());
  EXPECT_TRUE(std::isnan(found.chatter_frequency_hz));
  // Another peak that mode 8 alone explains names it, for the whole.
  const PeakClassification clear = robot_peaks({539.5, 552.0}, 6500);
  EXPECT_EQ(clear.peaks[1].best.mode.number, 8);
  EXPECT_EQ(clear.state, PeakClassification::State::named);
  EXPECT_EQ(clear.mode.number, 8);
  EXPECT_NEAR(clear.chatter_frequency_hz, 552.0, 1e-9);
}

// Equal directions: the frequency says nothing about which of two equal modes chatters, but it is chatter.
TEST(PeakClassification, EqualModesCannotBeDistinguished) {
  const modal::ModalModel modes =
      testing::plane_model({testing::mass_mode(0, 700.0, 0.01, 1.0), testing::mass_mode(1, 700.0, 0.01, 1.0)});
  const PeakClassification found = explain({{702.0}, 5000 * rpm, 3}, modes);
  EXPECT_EQ(found.peaks[0].state, ExplainedPeak::State::ambiguous);
  EXPECT_EQ(found.peaks[0].best.kind, Named::chatter);
  EXPECT_NEAR(found.peaks[0].chatter_frequency_hz, 702.0, 1e-9);
  EXPECT_EQ(found.state, PeakClassification::State::ambiguous);
  // As many peaks for one mode as for another: neither is named.
  const modal::ModalModel apart =
      testing::plane_model({testing::mass_mode(0, 700.0, 0.001, 1.0), testing::mass_mode(1, 730.0, 0.001, 1.0)});
  const PeakClassification both = explain({{700.1, 730.1}, 5000 * rpm, 3}, apart);
  EXPECT_EQ(both.peaks[0].best.mode.number, 1);
  EXPECT_EQ(both.peaks[1].best.mode.number, 2);
  EXPECT_EQ(both.state, PeakClassification::State::ambiguous);
  EXPECT_EQ(explain({{700.1, 730.1, 1200.0}, 5000 * rpm, 3}, apart, {.clear_odds = 1.0}).peaks.size(), 3U);
}

// 1,000 Hz is 700 Hz and three rotations of 100 Hz, or from below 17 rotations less it.
TEST(PeakClassification, CountsSidebandsUpToTheMostRotations) {
  const modal::ModalModel modes = testing::plane_model({testing::mass_mode(0, 700.0, 0.001, 1.0)});
  const auto state = [&](int most) {
    return explain({{1000.0}, 6000 * rpm, 7}, modes, {.multiples_removed = true, .most_rotations = most})
        .peaks[0]
        .state;
  };
  EXPECT_EQ(state(3), ExplainedPeak::State::named);
  EXPECT_EQ(state(2), ExplainedPeak::State::unexplained);
  EXPECT_EQ(state(0), ExplainedPeak::State::unexplained);
  EXPECT_EQ(explain({{700.0}, 6000 * rpm, 7}, modes, {.multiples_removed = true, .most_rotations = 0}).mode.number, 1);
}

TEST(PeakClassification, NamesTheWorkpiecesMode) {
  const modal::ModalModel tool = testing::plane_model({testing::mass_mode(0, 700.0, 0.001, 1.0)});
  const modal::ModalModel part = testing::plane_model({testing::mass_mode(1, 430.0, 0.001, 1.0)});
  const PeakClassification found = explain({{430.3}, 5000 * rpm, 3}, tool, {}, part);
  EXPECT_EQ(found.mode, (modal::ModeId{1, modal::ModeOwner::workpiece}));
  EXPECT_NEAR(found.peaks[0].best.mode_frequency_hz, 430.0, 1e-12);
  EXPECT_EQ(explain({{430.3}, 5000 * rpm, 3}, tool).state, PeakClassification::State::no_chatter);
}

// Peaks made from one mode and the speed are named so, whatever the mode, the speed and the teeth.
TEST(PeakClassification, PropertyNamesWhatWasMade) {
  for (int seed = 0; seed < 200; ++seed) {
    Random random(static_cast<std::uint64_t>(seed), 7);
    const int teeth = 1 + static_cast<int>(random.index(5));
    const double rotation_hz = random.uniform(40.0, 400.0);
    const double mode_hz = random.uniform(30.0, 2000.0);
    const modal::ModalModel modes = testing::plane_model({testing::mass_mode(0, mode_hz, 0.0005, 1.0)});
    const double off = std::abs(std::remainder(mode_hz, rotation_hz));
    if (off < 3.0 || off > 0.5 * rotation_hz - 3.0) continue;  // there two names fit
    std::vector<double> peaks;
    for (const int n : {0, 1, teeth, 3 * teeth, -teeth, -40}) peaks.push_back(std::abs(mode_hz + n * rotation_hz));
    for (const int n : {1, teeth, 2 * teeth}) peaks.push_back(n * rotation_hz);
    const PeakClassification found = explain({peaks, 2.0 * pi * rotation_hz, teeth}, modes);
    const int expected[] = {0, 1, teeth, 3 * teeth, -teeth, -40};
    for (std::size_t i = 0; i < 6; ++i) {
      EXPECT_EQ(found.peaks[i].best.kind, Named::chatter) << seed << ' ' << i;
      EXPECT_EQ(found.peaks[i].best.harmonic, expected[i]) << seed << ' ' << i;
    }
    for (std::size_t i = 6; i < 9; ++i) EXPECT_NE(found.peaks[i].best.kind, Named::chatter) << seed;
    EXPECT_NEAR(found.chatter_frequency_hz, mode_hz, 1e-6) << seed;
  }
}

TEST(PeakClassification, RejectsWhatCannotBe) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto rejected = [](const MeasuredPeaks& peaks, const PeakClassificationOptions& options = {}) {
    return field_of([&] { static_cast<void>(explain(peaks, data::robot_modes(), options)); });
  };
  EXPECT_EQ(rejected({{100.0}, 680.0, 3}), "accepted");
  EXPECT_EQ(rejected({{}, 680.0, 3}), "frequency_hz");
  EXPECT_EQ(rejected({{100.0, -1.0}, 680.0, 3}), "frequency_hz");
  EXPECT_EQ(rejected({{nan}, 680.0, 3}), "frequency_hz");
  EXPECT_EQ(rejected({{1e300}, 680.0, 3}), "frequency_hz");
  EXPECT_EQ(rejected({std::vector<double>(20000, 5.0), 680.0, 3}), "frequency_hz");
  EXPECT_EQ(rejected({{100.0}, 0.0, 3}), "spindle_speed_rad_per_s");
  EXPECT_EQ(rejected({{100.0}, nan, 3}), "spindle_speed_rad_per_s");
  EXPECT_EQ(rejected({{100.0}, 680.0, 0}), "teeth");
  EXPECT_EQ(rejected({{100.0}, 680.0, 3}, {.tolerance_hz = 0.0}), "tolerance_hz");
  EXPECT_EQ(rejected({{100.0}, 680.0, 3}, {.tolerance_hz = 60.0}), "tolerance_hz");
  EXPECT_EQ(rejected({{1e6}, 0.2, 3}), "tolerance_hz");
  EXPECT_EQ(rejected({{100.0}, 680.0, 3}, {.speed_tolerance = 0.3}), "speed_tolerance");
  EXPECT_EQ(rejected({{100.0}, 680.0, 3}, {.clear_odds = 0.5}), "clear_odds");
  EXPECT_EQ(rejected({{100.0}, 680.0, 3}, {.most_rotations = -1}), "most_rotations");
  EXPECT_EQ(robot_peaks({1e6}, 6500).peaks.size(), 1U);
}

// One direction has no second mode to couple with, and milling pushes it back: it needs the delay.
TEST(ChatterMechanism, OneDirectionIsRegenerative) {
  const ChatterMechanism verdict = chatter_mechanism(testing::benchmark(1.0, 1), {5000 * rpm, 0.5e-3});
  EXPECT_EQ(verdict.kind, ChatterMechanism::Kind::regenerative);
  EXPECT_NEAR(verdict.spectral_radius, 1.07397559, 1e-5);
  EXPECT_LT(verdict.without_delay, 1.0);
  EXPECT_EQ(chatter_mechanism(testing::benchmark(1.0, 1), {5000 * rpm, 0.2e-3}).kind, ChatterMechanism::Kind::stable);
}

// No depth: the slowest mode fades, with or without the delay.
TEST(ChatterMechanism, WithoutDepthBothFade) {
  const ChatterMechanism verdict = chatter_mechanism(testing::robot(), {6500 * rpm, 0.0});
  const double expected = std::exp(-0.0127 * 2.0 * pi * 17.40 * 60.0 / 6500.0 / 3.0);
  EXPECT_EQ(verdict.kind, ChatterMechanism::Kind::stable);
  EXPECT_NEAR(verdict.without_delay, expected, 1e-10);
  EXPECT_NEAR(verdict.spectral_radius, expected, 1e-6);
}

// Two equal modes in a slot without radial force: the mean stiffness has opposite signs off its diagonal and turns the
// motion round, which damping bears up to a K̄ = 2 k ζ: mode coupling, at any speed at which the cut is fast.
TEST(ChatterMechanism, OppositeCrossStiffnessCouplesModes) {
  LobesProblem p = testing::benchmark(1.0);
  p.milling.tool.teeth = 8;
  p.milling.coefficients.radial_n_per_m2 = 0.0;
  const double stiffness = 0.03993 * std::pow(2.0 * pi * 922.0, 2);
  const double mean = 8.0 / (2.0 * pi) * 0.5 * pi * p.milling.coefficients.tangential_n_per_m2;
  const double limit_m = 2.0 * stiffness * 0.011 / mean;
  EXPECT_LT(chatter_mechanism(p, {60000 * rpm, 0.97 * limit_m}).without_delay, 1.0);
  EXPECT_GT(chatter_mechanism(p, {60000 * rpm, 1.03 * limit_m}).without_delay, 1.0);
}

}  // namespace peak_classification_test
}  // namespace robomill::stability
