// The linear cut against Floquet theory, which shares no code with it.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "robomill/simulation/verdict.hpp"
#include "robomill/stability/surface_error.hpp"
#include "testing/simulation/cuts.hpp"

namespace robomill::simulation {
namespace growth_test {

struct Case {
  const char* name;
  stability::LobesProblem problem;
  double speed_rpm, depth_m, radius;
};

// Source: converged values of these cuts by two methods of the stability stage and by collocation.
TEST(Growth, IsThatOfConvergedFloquetTheory) {
  const auto benchmark = [](double ratio) { return stability::testing::benchmark(ratio); };
  for (const Case& c :
       {Case{"a/D 0.05", benchmark(0.05), 5000, 0.2e-3, 0.70098118},
        Case{"a/D 0.05", benchmark(0.05), 5000, 1e-3, 0.84047032},
        Case{"a/D 0.1", benchmark(0.1), 5000, 1e-3, 1.03111539}, Case{"slot", benchmark(1.0), 5000, 0.2e-3, 2.13659148},
        Case{"slot", stability::testing::benchmark(1.0, 1), 5000, 0.2e-3, 0.81974278},
        Case{"robot", stability::testing::robot(), 6500, 0.6e-3, 1.10584684},
        Case{"robot", stability::testing::robot(), 8000, 1.2e-3, 1.07595981},
        Case{"robot", stability::testing::robot(), 15000, 1.1e-3, 1.11946237}}) {
    const SmallVibration s = small_vibration(testing::cut_of(c.problem, c.speed_rpm, c.depth_m));
    ASSERT_EQ(s.status, SmallVibration::Status::found) << c.name;
    EXPECT_NEAR(s.spectral_radius, c.radius, 1e-5 * c.radius) << c.name;
    EXPECT_LT(s.error_estimate, 1e-3 * c.radius) << c.name;
  }
}

stability::PointResult judged(const stability::LobesProblem& problem, double speed_rpm, double depth_m, int intervals) {
  return stability::evaluate_point(problem, {.intervals = intervals}, {speed_rpm * testing::rpm, depth_m});
}

TEST(Growth, AgreesWithHelixUnequalPitchComplianceAndWorkpiece) {
  stability::LobesProblem helix = stability::testing::benchmark(0.3);
  helix.milling.tool.helix_rad = 0.6;
  stability::LobesProblem pitch = stability::testing::benchmark(0.3);
  pitch.milling.tool.pitch_rad = {3.0, 2.0 * std::numbers::pi - 3.0};
  stability::LobesProblem compliant = stability::testing::benchmark(0.3);
  compliant.dynamics.residuals = {{.name = modal::parse_frf_name("xx"), .stiffness = 3e-8},
                                  {.name = modal::parse_frf_name("xy"), .stiffness = 1e-8}};
  compliant.feed_direction_rad = 0.4;
  stability::LobesProblem workpiece = stability::testing::benchmark(0.3);
  workpiece.workpiece_dynamics = stability::testing::plane_model({stability::testing::mass_mode(1, 610.0, 0.02, 0.2)});
  for (const Case& c :
       {Case{"helix", helix, 7000, 1.5e-3, 0}, Case{"pitch", pitch, 7000, 0.5e-3, 0},
        Case{"compliance", compliant, 7000, 0.5e-3, 0}, Case{"workpiece", workpiece, 7000, 0.5e-3, 0}}) {
    const SmallVibration s = small_vibration(testing::cut_of(c.problem, c.speed_rpm, c.depth_m));
    const double expected = judged(c.problem, c.speed_rpm, c.depth_m, 400).spectral_radius;
    ASSERT_EQ(s.status, SmallVibration::Status::found) << c.name;
    EXPECT_NEAR(s.spectral_radius, expected, 1e-3 * expected) << c.name;
  }
}

// The full simulation grows at first as the multiplier says, and chatters at its frequency.
TEST(Growth, TheSpectrumShowsTheMultipliersFrequency) {
  const stability::LobesProblem problem = stability::testing::benchmark(0.1);
  const stability::PointResult expected = judged(problem, 5000, 1.1e-3, 200);
  const Simulation s = simulate(testing::cut_of(problem, 5000, 1.1e-3), {.seconds = 2.0});
  EXPECT_EQ(s.verdict, Verdict::chatter);
  EXPECT_NEAR(s.chatter_frequency_hz, expected.chatter_frequency_hz, 5.0);
}

// Source: a swing of the speed whose amplitude goes to nothing changes nothing; the period is then the swing's.
TEST(Growth, ASwingOfNoAmplitudeIsNoSwing) {
  stability::LobesProblem problem = stability::testing::benchmark(0.1);
  const MillingCut steady = testing::cut_of(problem, 5000, 0.5e-3);
  MillingCut swinging = steady;
  swinging.milling.speed_variation = {.amplitude_ratio = 1e-7, .frequency_ratio = 0.5};
  const SmallVibration a = small_vibration(steady), b = small_vibration(swinging);
  ASSERT_EQ(b.status, SmallVibration::Status::found);
  EXPECT_NEAR(b.period_s, 4.0 * a.period_s, 1e-12);
  EXPECT_NEAR(b.spectral_radius, std::pow(a.spectral_radius, 4.0), 1e-4);
  swinging.milling.speed_variation.frequency_ratio = 0.5 * std::numbers::sqrt2;
  EXPECT_EQ(small_vibration(swinging).status, SmallVibration::Status::not_periodic);
}

// With runout above half the feed one tooth of two cuts: the same as a cutter with one tooth and its feed.
TEST(Growth, ACutterWhoseOtherToothMissesIsOneOfOneTooth) {
  MillingCut two = testing::cut_of(stability::testing::benchmark(0.3), 9000, 0.5e-3, 5e-5);
  two.milling.tool.runout_m = 4e-5;
  MillingCut one = two;
  one.milling.tool.runout_m = 0.0;
  one.milling.tool.teeth = 1;
  one.milling.feed_per_tooth_m = 1e-4;
  const SmallVibration a = small_vibration(two), b = small_vibration(one);
  ASSERT_EQ(a.status, SmallVibration::Status::found);
  EXPECT_DOUBLE_EQ(a.period_s, b.period_s);
  EXPECT_NEAR(a.spectral_radius, b.spectral_radius, 1e-3);
}

// The orbit of the same collocation as the lobes; scallops come on top, a third of f²/8R' on average.
TEST(Growth, TheWallIsWhereThePeriodicOrbitLeavesIt) {
  stability::LobesProblem up = stability::testing::robot();
  stability::LobesProblem down = stability::testing::benchmark(0.1);
  for (stability::LobesProblem* problem : {&up, &down}) {
    problem->milling.feed_per_tooth_m = 2e-5;
    const double speed_rpm = problem == &up ? 7000.0 : 5000.0, depth_m = problem == &up ? 0.1e-3 : 0.4e-3;
    const stability::SurfacePoint orbit = stability::surface_point(*problem, {speed_rpm * testing::rpm, depth_m});
    ASSERT_TRUE(orbit.stable);
    const Simulation s = simulate(testing::cut_of(*problem, speed_rpm, depth_m), {.seconds = 4.0, .tolerance = 5e-4});
    ASSERT_EQ(s.walls.size(), 1U);
    const double scallop = 4e-10 / (4.0 * problem->milling.tool.diameter_m);
    EXPECT_NEAR(s.walls[0].location_error_m, orbit.surface_location_error_m + scallop / 3.0,
                0.01 * orbit.peak_to_peak_y_m);
  }
}

// Source: snapshots that are a sum of known modes.
TEST(Growth, FindsTheLargestMultiplierOfKnownSnapshots) {
  const std::complex<double> a = std::polar(1.03, 2.1), b = std::polar(0.98, 0.4), c = 0.6;
  Eigen::MatrixXd snapshots(12, 14);
  for (Eigen::Index i = 0; i < 14; ++i) {
    for (Eigen::Index r = 0; r < 12; ++r) {
      const double n = static_cast<double>(i), s = static_cast<double>(r);
      snapshots(r, i) = (std::pow(a, n) * std::polar(1.0, 0.3 * s)).real() +
                        (std::pow(b, n) * std::polar(2.0, s)).real() + std::pow(c, n).real() * std::cos(0.7 * s * s);
    }
  }
  const std::complex<double> found = detail::dominant_multiplier(snapshots);
  EXPECT_NEAR(std::abs(found - a), 0.0, 1e-9);
  EXPECT_EQ(detail::dominant_multiplier(Eigen::MatrixXd::Zero(4, 5)), 0.0);
}

// Source: known sequences of once-a-period samples.
TEST(Growth, JudgesKnownSequences) {
  const SmallVibration unknown = {.status = SmallVibration::Status::not_converged};
  const auto sequence = [](double start, double growth, double angle, double most, Eigen::Index n) {
    Eigen::MatrixXd samples(2, n);
    double size = start;
    for (Eigen::Index i = 0; i < n; ++i) {
      const double phase = angle * static_cast<double>(i);
      samples.col(i) << 1.0 + size * std::cos(phase), -2.0 + size * std::sin(phase);
      size = std::min(size * growth, most);
    }
    return samples;
  };
  const auto verdict = [&](const Eigen::MatrixXd& samples) { return detail::judge(samples, unknown).verdict; };
  EXPECT_EQ(verdict(sequence(1.0, 0.98, 2.0, 1.0, 200)), Verdict::stable);
  EXPECT_EQ(verdict(sequence(1e-6, 1.02, 2.0, 1.0, 200)), Verdict::chatter);
  EXPECT_EQ(verdict(sequence(1e-6, 1.5, 2.0, 0.5, 200)), Verdict::chatter);
  EXPECT_EQ(verdict(sequence(1e-3, 1.0001, 2.0, 1.0, 200)), Verdict::undecided);
  EXPECT_EQ(verdict(sequence(0.0, 1.0, 2.0, 1.0, 200)), Verdict::stable);
  EXPECT_NEAR(detail::judge(sequence(1.0, 0.98, 2.0, 1.0, 200), unknown).growth_per_period, 0.98, 1e-3);
}

}  // namespace growth_test
}  // namespace robomill::simulation
