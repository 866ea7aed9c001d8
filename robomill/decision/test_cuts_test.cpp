#include "robomill/decision/test_cuts.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "testing/robot_modes.hpp"

namespace robomill::decision {
namespace test_cuts_test {

/// Two teeth and the robot's eight modes.
stability::LobesProblem robot_cut() {
  stability::LobesProblem problem;
  problem.milling.tool.teeth = 2;
  problem.dynamics = data::robot_modes();
  return problem;
}

using Kind = stability::Explanation::Kind;

Peak explain(double frequency_hz, double rpm) {
  return name_peaks({frequency_hz}, rpm * units::rpm, robot_cut(), 1.0).front();
}

// Source: the peaks of the published cuts in data/robot-cuts.toml, read with two teeth; 324.99 Hz is 3 × 108.33 Hz,
// 3866.9 Hz is 29 × 133.33 Hz, and 666.98 Hz lies 17 Hz above 6 × 108.33 Hz.
TEST(ExplainPeak, NamesThePeaksOfThePublishedCuts) {
  EXPECT_EQ(explain(324.99, 6500).kind, Kind::rotation);
  EXPECT_EQ(explain(324.99, 6500).text, "3 × rotation");
  EXPECT_EQ(explain(3866.9, 8000).kind, Kind::rotation);
  EXPECT_EQ(explain(3866.9, 8000).text, "29 × rotation");
  for (const double peak : {666.98, 991.98, 1966.95}) {
    EXPECT_EQ(explain(peak, 6500).kind, Kind::chatter) << peak;
    EXPECT_NE(explain(peak, 6500).text.find("rotation + mode 1"), std::string::npos) << explain(peak, 6500).text;
  }
  EXPECT_EQ(explain(550.0, 7900).text, "mode 8");
  EXPECT_EQ(explain(200.0, 6000).kind, Kind::tooth_passing);
  EXPECT_EQ(explain(390.0, 6000).kind, Kind::unexplained);
}

// 543.67 Hz is the frequency of mode 8 and within the width of mode 7; 540.9 Hz is near five rotations, too.
TEST(ExplainPeak, NamesNoReadingWhereAnotherIsAboutAsGood) {
  const Peak either = explain(543.67, 7000);
  EXPECT_EQ(either.kind, Kind::chatter);
  EXPECT_EQ(either.text, "mode 8 or mode 7: ambiguous");
  const Peak open = explain(540.9, 6500);
  EXPECT_EQ(open.kind, Kind::cut_or_chatter);
  EXPECT_EQ(open.text.find("5 × rotation or mode 7"), 0U) << open.text;
}

TEST(ExplainPeak, KnowsTheModesOfTheWorkpiece) {
  stability::LobesProblem problem = robot_cut();
  problem.workpiece_dynamics = data::robot_modes();
  problem.workpiece_dynamics.modes.resize(1);
  problem.workpiece_dynamics.modes[0].frequency_hz = 446.0;
  problem.workpiece_dynamics.modes[0].damping_ratio = 0.005;
  const Peak peak = name_peaks({446.5}, 6500 * units::rpm, problem, 1.0).front();
  EXPECT_EQ(peak.text, "mode 1 of the workpiece");
}

class RecordedCut : public ::testing::Test {
 protected:
  // 6,000 rpm, three teeth: tooth passing at 300 Hz with amplitude 1, and something else at 1,234.5 Hz.
  Recording record(double chatter_amplitude, double length_s = 1.0, double chatter_hz = 1234.5) {
    CutSignal recorded = {.acceleration = {}, .sample_rate_hz = 8192.0, .notes = {}};
    recorded.acceleration.resize(static_cast<Eigen::Index>(length_s * recorded.sample_rate_hz));
    for (Eigen::Index i = 0; i < recorded.acceleration.size(); ++i) {
      const double t = static_cast<double>(i) / recorded.sample_rate_hz;
      recorded.acceleration(i) = std::cos(2 * std::numbers::pi * 300.0 * t) +
                                 0.2 * std::cos(2 * std::numbers::pi * 100.0 * t) +
                                 chatter_amplitude * std::cos(2 * std::numbers::pi * chatter_hz * t);
    }
    return judge_recording({.spindle_speed_rad_per_s = 6000 * units::rpm, .axial_depth_m = 1e-3}, recorded, problem_);
  }

  stability::LobesProblem problem_ = [] {
    stability::LobesProblem problem = robot_cut();
    problem.milling.tool.teeth = 3;
    return problem;
  }();
};

TEST_F(RecordedCut, DistinguishesStableFromChatter) {
  EXPECT_EQ(record(0.0).verdict, Verdict::stable);
  EXPECT_EQ(record(0.35).verdict, Verdict::borderline);
  const Recording loud = record(0.8);
  EXPECT_EQ(loud.verdict, Verdict::chatter);
  EXPECT_NE(loud.reason.find("1234.5 Hz"), std::string::npos) << loud.reason;
  ASSERT_GE(loud.peaks.size(), 3U);
  EXPECT_EQ(loud.peaks[0].kind, Kind::tooth_passing);
  EXPECT_NEAR(loud.peaks[0].amplitude, 1.0, 1e-3);
}

// 1,201 Hz is a second multiple of tooth passing plus 1 Hz and a mode's frequency at once: as the cut it makes the
// recording stable, as chatter the loudest peak.
TEST_F(RecordedCut, GivesNoVerdictOnAPeakThatMayBeEither) {
  problem_.dynamics.modes.resize(1);
  problem_.dynamics.modes[0].frequency_hz = 1201.0;
  problem_.dynamics.modes[0].damping_ratio = 1e-4;
  const Recording open = record(0.8, 1.0, 1201.0);
  EXPECT_EQ(open.verdict, Verdict::unknown);
  EXPECT_NE(open.reason.find("1201.0 Hz may be the cut or chatter"), std::string::npos) << open.reason;
  EXPECT_EQ(record(0.1, 1.0, 1201.0).verdict, Verdict::stable);  // too low to matter
}

TEST_F(RecordedCut, RejectsTooLittle) {
  EXPECT_THROW(static_cast<void>(record(0.0, 0.1)), InvalidInput);
}

// One mode in x and y and a slot: far below the limit is predicted stable, far above chatter; the comparison counts
// both.
TEST(CompareCuts, ComparesWithThePrediction) {
  modal::ModalModel model;
  for (const modal::Axis axis : {modal::Axis::x, modal::Axis::y}) {
    model.excitations.push_back({.axis = axis});
    model.responses.push_back({.axis = axis});
  }
  for (Eigen::Index i = 0; i < 2; ++i) {
    // R L = 1 / (2 i m ω_d) gives a mode of modal mass m.
    const double omega_d = 2 * std::numbers::pi * 922.0;
    const std::complex<double> residue = 1.0 / (std::complex<double>(0.0, 2.0) * 0.04 * omega_d);
    modal::Mode mode;
    mode.frequency_hz = 922.0;
    mode.damping_ratio = 0.011;
    mode.left = Eigen::Vector2cd::Unit(i) * std::sqrt(std::abs(residue));
    mode.right = Eigen::Vector2cd::Unit(i) * (residue / std::sqrt(std::abs(residue)));
    model.modes.push_back(mode);
  }
  stability::LobesProblem problem;
  problem.dynamics = model;
  problem.milling.tool = {.teeth = 2, .diameter_m = 12e-3};
  problem.milling.immersion = {.entry_rad = 0.0, .exit_rad = std::numbers::pi};
  problem.milling.coefficients = {.tangential_n_per_m2 = 6e8, .radial_n_per_m2 = 2e8};
  stability::LobesOptions options;
  options.spindle_speed_rad_per_s = {4000 * units::rpm, 16000 * units::rpm};
  options.axial_depth_m = {0.0, 3e-3};
  std::vector<TestCut> cuts(3);
  for (TestCut& cut : cuts) cut.spindle_speed_rad_per_s = 5000 * units::rpm;
  cuts[0].axial_depth_m = 0.01e-3;
  cuts[0].result = Verdict::stable;
  cuts[1].axial_depth_m = 2e-3;
  cuts[1].result = Verdict::stable;
  cuts[2].axial_depth_m = 2e-3;
  const std::vector<ComparedCut> rows = compare_cuts(cuts, problem, options, Progress::none());
  EXPECT_EQ(rows[0].predicted, Verdict::stable);
  EXPECT_EQ(rows[0].agrees, std::optional<bool>(true));
  EXPECT_EQ(rows[1].predicted, Verdict::chatter);
  EXPECT_EQ(rows[1].agrees, std::optional<bool>(false));
  EXPECT_FALSE(rows[2].agrees.has_value());
  EXPECT_GT(rows[2].limit_depth_m, 0.01e-3);
  EXPECT_LT(rows[2].limit_depth_m, 2e-3);
}

TEST(Agreement, CountsEveryCutOnce) {
  const Agreement counts = agreement({{.agrees = true}, {.agrees = false}, {}, {.agrees = true}});
  EXPECT_EQ(counts.agree, 2U);
  EXPECT_EQ(counts.disagree, 1U);
  EXPECT_EQ(counts.not_compared, 1U);
}

}  // namespace test_cuts_test
}  // namespace robomill::decision
