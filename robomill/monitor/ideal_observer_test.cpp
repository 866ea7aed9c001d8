// The observer that bounds the monitor's delay: its rate of false alarms and its delay are those derived.
#include "testing/monitor/ideal_observer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>
#include <numbers>

#include "testing/support.hpp"

namespace robomill::monitor::testing {
namespace ideal_observer_test {

using std::numbers::pi;

/// A tool that cuts and moves nothing: the noise of the corpus alone.
IdealObservation noise_alone(double seconds, std::uint64_t seed) {
  Random plans(3);
  const CutPlan plan = stable_plan(false, 3.0, plans);
  CleanCut clean;
  const auto rows = static_cast<Eigen::Index>(seconds * corpus_rate_hz);
  clean.acceleration_m_per_s2.setZero(rows, 2);
  clean.forced_m_per_s2.setZero(rows, 2);
  clean.rotation_rad.assign(static_cast<std::size_t>(rows), 0.0);
  clean.depth_share.assign(static_cast<std::size_t>(rows), 1.0F);
  const Disturbance noise = {.noise = 0.4, .hum = 0.0, .unbalance = 0.0, .gain_swing = 0.0, .knocks_per_s = 1e-12};
  IdealObservation out;
  Random random(seed);
  const std::vector<float> samples = disturbed(plan, clean, noise, random, &out.resonances);
  out.residual_m_per_s2.resize(rows, 2);
  for (Eigen::Index i = 0; i < rows; ++i) {
    for (Eigen::Index c = 0; c < 2; ++c) {
      out.residual_m_per_s2(i, c) = static_cast<double>(samples[static_cast<std::size_t>(2 * i + c)]);
    }
  }
  out.noise_m_per_s2 = 0.4 * reference_level(plan, clean);
  return out;
}

// In noise ln Λ is a Gamma variate: it exceeds a level as often as the incomplete gamma function says, near the
// resonance that colours the noise as far from it.
TEST(IdealObserver, LogLikelihoodIsAGammaVariateInNoise) {
  IdealObservation observed = noise_alone(60.0, 4);
  for (const std::vector<double>& lines : {std::vector{545.0}, {300.0, 900.0}, {545.0, 700.0, 1500.0}}) {
    observed.lines_hz = lines;
    const auto degrees = static_cast<double>(2 * lines.size());
    for (const double growth : {20.0, 80.0}) {
      const std::vector<double> looks = ideal_log_likelihood(observed, growth, 0.005);
      for (const double level : {degrees, 1.5 * degrees, 2.0 * degrees}) {
        const double expected = boost::math::gamma_q(degrees, level);
        const double share = static_cast<double>(std::ranges::count_if(looks, [&](double q) { return q > level; })) /
                             static_cast<double>(looks.size());
        // 60 s hold some 60 growth / 1 independent looks.
        const double doubt = std::sqrt(expected * (1.0 - expected) / (60.0 * growth));
        EXPECT_NEAR(share, expected, 4.0 * doubt) << lines.size() << " lines, " << growth << "/s";
      }
    }
  }
}

// At a rate high enough to count: no more false alarms than asked for, and not far fewer.
TEST(IdealObserver, RaisesAsManyFalseAlarmsAsAskedFor) {
  IdealObservation observed = noise_alone(120.0, 5);
  observed.lines_hz = {540.0, 700.0};
  for (const double per_second : {0.5, 2.0}) {
    int alarms = 0;
    bool before = false;
    for (const DetectorDecision& d : ideal_decisions(observed, {.false_alarms_per_hour = 3600.0 * per_second})) {
      alarms += d.chatter && !before ? 1 : 0;
      before = d.chatter;
    }
    const double asked = 120.0 * per_second;
    EXPECT_LT(alarms, asked + 3.0 * std::sqrt(asked));
    EXPECT_GT(alarms, 0.03 * asked);
  }
}

// A line of amplitude A e^{gt} in both channels gives ln Λ = A² e^{2gt} Σ 1/(4 g S₁), S₁ the one-sided density [1/Hz].
TEST(IdealObserver, AlarmsWhereTheGrowingLineReachesTheThreshold) {
  IdealObservation observed = noise_alone(3.0, 6);
  observed.lines_hz = {900.0};
  const IdealOptions options = {.growths_per_s = {20.0}};
  const double g = 20.0, first = 1e-5;
  double information = 0.0;
  for (const NoiseResonances& r : observed.resonances) {
    information += 1.0 / (4.0 * g * noise_density_per_hz(r, 900.0) * observed.noise_m_per_s2 * observed.noise_m_per_s2);
  }
  const double reached_s = std::log(ideal_threshold(2, options) / (first * first * information)) / (2.0 * g);
  for (Eigen::Index i = 0; i < observed.residual_m_per_s2.rows(); ++i) {
    const double t = static_cast<double>(i) / corpus_rate_hz;
    observed.residual_m_per_s2.row(i).array() += first * std::exp(g * t) * std::cos(2.0 * pi * 900.0 * t);
  }
  const std::vector<DetectorDecision> decisions = ideal_decisions(observed, options);
  const auto alarm = std::ranges::find_if(decisions, [](const DetectorDecision& d) { return d.chatter; });
  ASSERT_NE(alarm, decisions.end());
  // The noise moves the amplitude by a third at most (ln Λ is near 20): a third of 1/g.
  EXPECT_NEAR(alarm->time_s, reached_s, 0.35 / g + options.look_s);
}

TEST(IdealObserver, FindsTheCorpusChatterBeforeItIsFull) {
  for (std::uint64_t seed = 2; seed <= 6; seed += 2) {
    const DrawnCut d = draw(seed);
    ASSERT_TRUE(d.recorded.truth.chatter);
    const CutScore s = score(d.recorded, ideal_decisions(observe(d), {}));
    EXPECT_TRUE(s.found) << seed;
    EXPECT_EQ(s.false_alarms, 0) << seed;
    EXPECT_LT(s.delay_s, 0.2) << seed;
  }
}

}  // namespace ideal_observer_test
}  // namespace robomill::monitor::testing
