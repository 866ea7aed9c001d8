#pragma once
#include <array>
#include <span>
#include <vector>

#include "testing/monitor/corpus.hpp"
#include "testing/monitor/score.hpp"

/// A bound for the delay: who knows all that a monitor has to find out. Derivation: testing/monitor/README.md, "The
/// ideal observer".
namespace robomill::monitor::testing {

/// What it observes of a cut: noise, and chatter from truth.start_s to truth.end_s. The forced vibration, what rings
/// before and after chatter by the truth's definition, hum, unbalance, gain and knocks are known to it and taken off.
struct IdealObservation {
  CleanCut::Columns residual_m_per_s2;  ///< rows of corpus_rate_hz
  std::vector<double> lines_hz = {};    ///< of the chatter, known to it; none nearer than 40 Hz to a stronger one
  double noise_m_per_s2 = 0.0;          ///< rms of the noise, known to it, and its colours
  std::array<NoiseResonances, 2> resonances = {};
};
/// Of a cut with chatter.
[[nodiscard]] IdealObservation observe(const DrawnCut& cut);

struct IdealOptions {
  double false_alarms_per_hour = 0.1;
  std::vector<double> growths_per_s = {5.0, 10.0, 20.0, 40.0, 80.0};  ///< that it expects; it takes the best
  double look_s = 0.005;                                              ///< between decisions
};
/// ln Λ at each look, the largest log-likelihood ratio of chatter that grows by this against none: over its complex
/// amplitudes in every line and channel. In noise alone a Gamma variate of as many degrees as there are of these.
[[nodiscard]] std::vector<double> ideal_log_likelihood(const IdealObservation& observed, double growth_per_s,
                                                       double look_s);
/// Above it ln Λ lies as often as the false alarms wanted allow, counting every look and every growth.
[[nodiscard]] double ideal_threshold(std::size_t amplitudes, const IdealOptions& options);
/// Chatter from ln Λ above the threshold, for the best growth, until it is below half of it.
[[nodiscard]] std::vector<DetectorDecision> ideal_decisions(const IdealObservation& observed,
                                                            const IdealOptions& options);

}  // namespace robomill::monitor::testing
