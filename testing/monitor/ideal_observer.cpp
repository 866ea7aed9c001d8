#include "testing/monitor/ideal_observer.hpp"

#include <algorithm>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>
#include <complex>
#include <numbers>

namespace robomill::monitor::testing {
namespace {

using std::numbers::pi;

constexpr double step_hz = 0.5, apart_hz = 40.0;

/// Power per hertz of the noise, two-sided, from 0 in steps of step_hz.
std::vector<double> densities(const IdealObservation& observed, std::size_t channel) {
  std::vector<double> out;
  const double scale = 0.5 * observed.noise_m_per_s2 * observed.noise_m_per_s2;
  for (double f = 0.0; f <= 0.5 * corpus_rate_hz; f += step_hz) {
    out.push_back(scale * noise_density_per_hz(observed.resonances.at(channel), f));
  }
  return out;
}

/// E|Y|² in noise alone, Y_n = ρ Y_{n-1} + r_n e^{-iω n}.
double variance(const std::vector<double>& density, double line_hz, double keep) {
  double sum = 0.0;
  const auto last = static_cast<long>(density.size()) - 1;
  for (long k = -last; k < last; ++k) {
    const double sine = std::sin(pi * (static_cast<double>(k) * step_hz - line_hz) / corpus_rate_hz);
    sum += density[static_cast<std::size_t>(std::abs(k))] * step_hz /
           ((1.0 - keep) * (1.0 - keep) + 4.0 * keep * sine * sine);
  }
  return sum;
}

}  // namespace

IdealObservation observe(const DrawnCut& cut) {
  IdealObservation out;
  const Truth& truth = cut.recorded.truth;
  CleanCut chatter = cut.clean;
  chatter.acceleration_m_per_s2 = chatter_of(cut.plan, cut.clean, truth);
  const auto start = static_cast<Eigen::Index>(truth.start_s * corpus_rate_hz);
  const auto end = static_cast<Eigen::Index>(truth.end_s * corpus_rate_hz);
  chatter.acceleration_m_per_s2.topRows(start).setZero();
  chatter.acceleration_m_per_s2.bottomRows(chatter.acceleration_m_per_s2.rows() - end).setZero();
  const Disturbance noise = {
      .noise = cut.disturbance.noise, .hum = 0.0, .unbalance = 0.0, .gain_swing = 0.0, .knocks_per_s = 1e-12};
  Random random = cut.random;
  const std::vector<float> samples = disturbed(cut.plan, chatter, noise, random, &out.resonances);
  out.residual_m_per_s2.resize(static_cast<Eigen::Index>(samples.size() / 2), 2);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    out.residual_m_per_s2(static_cast<Eigen::Index>(i / 2), static_cast<Eigen::Index>(i % 2)) =
        static_cast<double>(samples[i]);
  }
  out.noise_m_per_s2 = cut.disturbance.noise * reference_level(cut.plan, cut.clean);
  for (const double line : truth.lines_hz) {
    const auto near = [&](double kept) { return std::abs(kept - line) < apart_hz; };
    if (std::ranges::none_of(out.lines_hz, near)) out.lines_hz.push_back(line);
  }
  return out;
}

std::vector<double> ideal_log_likelihood(const IdealObservation& observed, double growth_per_s, double look_s) {
  const auto hop = static_cast<Eigen::Index>(look_s * corpus_rate_hz);
  std::vector<double> out(static_cast<std::size_t>(observed.residual_m_per_s2.rows() / hop), 0.0);
  const double keep = std::exp(-growth_per_s / corpus_rate_hz);
  for (std::size_t c = 0; c < 2; ++c) {
    const std::vector<double> density = densities(observed, c);
    for (const double line_hz : observed.lines_hz) {
      const double noise = variance(density, line_hz, keep);
      const std::complex<double> turn = std::polar(keep, 2.0 * pi * line_hz / corpus_rate_hz);
      std::complex<double> y = 0.0;  // of size |Y|
      for (std::size_t look = 0; look < out.size(); ++look) {
        const Eigen::Index from = static_cast<Eigen::Index>(look) * hop;
        for (Eigen::Index i = from; i < from + hop; ++i) {
          y = turn * y + observed.residual_m_per_s2(i, static_cast<Eigen::Index>(c));
        }
        out[look] += std::norm(y) / noise;
      }
    }
  }
  return out;
}

double ideal_threshold(std::size_t amplitudes, const IdealOptions& options) {
  const double looks_per_hour = 3600.0 / options.look_s * static_cast<double>(options.growths_per_s.size());
  const double share = std::min(1.0, options.false_alarms_per_hour / looks_per_hour);
  return boost::math::gamma_q_inv(static_cast<double>(amplitudes), share);
}

std::vector<DetectorDecision> ideal_decisions(const IdealObservation& observed, const IdealOptions& options) {
  std::vector<double> best;
  for (const double growth : options.growths_per_s) {
    const std::vector<double> here = ideal_log_likelihood(observed, growth, options.look_s);
    if (best.empty()) best.resize(here.size(), 0.0);
    std::ranges::transform(best, here, best.begin(), [](double a, double b) { return std::max(a, b); });
  }
  const double threshold = ideal_threshold(2 * observed.lines_hz.size(), options);
  const double hop = std::floor(options.look_s * corpus_rate_hz);
  std::vector<DetectorDecision> out;
  bool chatter = false;
  for (std::size_t k = 0; k < best.size(); ++k) {
    chatter = best[k] > (chatter ? 0.5 * threshold : threshold);
    out.push_back({.time_s = (static_cast<double>(k + 1) * hop - 1.0) / corpus_rate_hz,
                   .chatter = chatter,
                   .stable = !chatter,
                   .frequency_hz = chatter ? observed.lines_hz.front() : 0.0});
  }
  return out;
}

}  // namespace robomill::monitor::testing
