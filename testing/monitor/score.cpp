#include "testing/monitor/score.hpp"

#include <algorithm>
#include <boost/math/distributions/binomial.hpp>
#include <cmath>
#include <deque>
#include <limits>
#include <numbers>
#include <utility>

namespace robomill::monitor::testing {
namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
constexpr double hop_s = 0.025, window_s = 0.05;

/// Mean square of all channels over [from, to) frames.
double mean_square(const std::vector<float>& samples, std::size_t channels, std::size_t from, std::size_t to) {
  double sum = 0.0;
  for (std::size_t i = channels * from; i < channels * to; ++i) sum += static_cast<double>(samples[i]) * samples[i];
  return sum / static_cast<double>(channels * (to - from));
}

std::size_t channels_of(const RecordedCut& cut) {
  return static_cast<std::size_t>(cut.channels);
}

/// Ends of windows, in frames.
std::vector<std::size_t> window_ends(const RecordedCut& cut) {
  std::vector<std::size_t> ends;
  const auto window = static_cast<std::size_t>(window_s * cut.sample_rate_hz);
  const auto hop = static_cast<std::size_t>(hop_s * cut.sample_rate_hz);
  for (std::size_t end = window; end <= cut.samples.size() / channels_of(cut); end += hop) ends.push_back(end);
  return ends;
}

/// What the comb leaves: each frame less the mean of the same angle in four earlier revolutions.
std::vector<float> combed(const RecordedCut& cut) {
  std::vector<float> out = cut.samples;
  const std::size_t channels = channels_of(cut);
  const auto at = [&](double frame, std::size_t channel) {
    if (frame < 0.0) return 0.0;
    const auto k = static_cast<std::size_t>(frame);
    const double f = frame - static_cast<double>(k);
    const double a = cut.samples[channels * k + channel], b = cut.samples[channels * (k + 1) + channel];
    return a + f * (b - a);
  };
  for (std::size_t i = 0; i < out.size() / channels; ++i) {
    if (!(cut.truth.speed_rad_per_s[i] > 0.0F)) continue;
    const double turn = 2.0 * std::numbers::pi / cut.truth.speed_rad_per_s[i] * cut.sample_rate_hz;
    for (std::size_t c = 0; c < channels; ++c) {
      double mean = 0.0;
      for (int k = 1; k <= 4; ++k) mean += 0.25 * at(static_cast<double>(i) - k * turn, c);
      out[channels * i + c] -= static_cast<float>(mean);
    }
  }
  return out;
}

/// From the nearest line and from the strongest one [Hz]: of a frequency that moves, where it was in the last 0.2 s,
/// over which the detectors measure.
std::pair<double, double> line_errors(const RecordedCut& cut, const DetectorDecision& decision) {
  const Truth& truth = cut.truth;
  double least = std::numeric_limits<double>::infinity(), main = least;
  const auto compare = [&](double frequency_hz) {
    main = std::min(main, std::abs(frequency_hz - decision.frequency_hz));
    for (const double line : truth.lines_hz) {
      least = std::min(least, std::abs(line + frequency_hz - truth.frequency_hz - decision.frequency_hz));
    }
  };
  if (truth.course_hz.empty()) {
    compare(truth.frequency_hz);
    return {least, main};
  }
  const double step_s = 0.005;
  for (double t = std::max(truth.start_s, decision.time_s - 0.2); t <= decision.time_s; t += step_s) {
    const auto frame = static_cast<std::size_t>(t * cut.sample_rate_hz);
    compare(static_cast<double>(truth.course_hz[std::min(frame, truth.course_hz.size() - 1)]));
  }
  return {least, main};
}

}  // namespace

double quantile(std::vector<double> values, double share) {
  std::erase_if(values, [](double v) { return std::isnan(v); });
  if (values.empty()) return unknown;
  std::ranges::sort(values);
  const double place = share * static_cast<double>(values.size() - 1);
  const auto k = static_cast<std::size_t>(place);
  const double next = values[std::min(k + 1, values.size() - 1)];
  return values[k] + (place - static_cast<double>(k)) * (next - values[k]);
}

CutScore score(const RecordedCut& cut, std::span<const DetectorDecision> decisions) {
  const Truth& truth = cut.truth;
  CutScore out = {.kind = cut.kind, .course = cut.course, .noise = cut.noise, .chatter = truth.chatter};
  out.delay_s = out.recovery_s = unknown;
  std::vector<double> nearest, strongest;
  bool before = false;
  for (const DetectorDecision& h : decisions) {
    const bool in_chatter = truth.chatter && h.time_s >= truth.start_s && h.time_s < truth.end_s;
    const bool ringing = truth.chatter && h.time_s >= truth.end_s && h.time_s < truth.end_s + 0.1;
    if (h.chatter && !before && !in_chatter && !ringing) ++out.false_alarms;
    if (h.chatter && in_chatter && !out.found) {
      out.found = true;
      out.delay_s = h.time_s - truth.t10_s;
    }
    before = h.chatter;
    ++out.decisions;
    out.blind += h.blind ? 1 : 0;
    const auto frame =
        std::min(static_cast<std::size_t>(h.time_s * cut.sample_rate_hz), truth.amplitude_m_per_s2.size() - 1);
    if (h.chatter && in_chatter && h.frequency_hz > 0.0 &&
        truth.amplitude_m_per_s2[frame] > 0.5 * truth.final_m_per_s2) {
      const auto [least, main] = line_errors(cut, h);
      nearest.push_back(least);
      strongest.push_back(main);
    }
    const bool may_recover = truth.chatter && truth.ends && cut.seconds() - truth.end_s > 0.5;
    if (may_recover && out.found && std::isnan(out.recovery_s) && h.time_s >= truth.end_s && h.stable) {
      out.recovery_s = h.time_s - truth.end_s;
    }
  }
  out.frequency_error_hz = quantile(nearest, 0.5);
  out.strongest_error_hz = quantile(strongest, 0.5);
  return out;
}

RateInterval rate_interval(int events, int trials) {
  using Binomial = boost::math::binomial_distribution<double>;
  if (trials <= 0) return {};
  return {.low = events == 0 ? 0.0 : Binomial::find_lower_bound_on_p(trials, events, 0.025),
          .high = events == trials ? 1.0 : Binomial::find_upper_bound_on_p(trials, events, 0.025)};
}

Summary summarise(std::span<const CutScore> scores) {
  Summary out;
  std::vector<double> delay, frequency, recovery;
  int decisions = 0;
  int blind = 0;
  for (const CutScore& s : scores) {
    ++out.cuts;
    out.chatter += s.chatter ? 1 : 0;
    out.found += s.found ? 1 : 0;
    out.false_alarms += s.false_alarms;
    out.with_false_alarms += s.false_alarms > 0 ? 1 : 0;
    delay.push_back(s.delay_s);
    if (s.found) frequency.push_back(s.frequency_error_hz);
    recovery.push_back(s.recovery_s);
    decisions += s.decisions;
    blind += s.blind;
  }
  out.blind_share = decisions > 0 ? static_cast<double>(blind) / decisions : 0.0;
  out.delay_median_s = quantile(delay, 0.5);
  out.delay_95_s = quantile(delay, 0.95);
  out.frequency_median_hz = quantile(frequency, 0.5);
  out.frequency_95_hz = quantile(frequency, 0.95);
  out.recovery_median_s = quantile(recovery, 0.5);
  out.recovery_95_s = quantile(recovery, 0.95);
  return out;
}

MonitorOptions monitor_options(const RecordedCut& cut) {
  MonitorOptions options;
  options.sample_rate_hz = cut.sample_rate_hz;
  options.channels = cut.channels;
  options.sensors = cut.sensors;
  options.tachometer_channel = cut.tachometer_channel;
  options.pulses_per_revolution = cut.pulses_per_revolution;
  options.spindle_speed_rad_per_s = cut.hint_rad_per_s;
  options.teeth = cut.teeth;
  return options;
}

std::vector<DetectorDecision> monitor_decisions(const RecordedCut& cut) {
  return decisions_with(monitor_options(cut), cut);
}

std::vector<DetectorDecision> decisions_with(const MonitorOptions& options, const RecordedCut& cut) {
  ChatterMonitor monitor(options);
  std::vector<DetectorDecision> out;
  std::span<const float> rest = cut.samples;
  const auto channels = static_cast<std::size_t>(cut.channels);
  std::uint64_t hop = 0;
  while (!rest.empty()) {
    const std::size_t take = std::min(rest.size(), monitor.frames_to_next_decision() * channels);
    const Decision d = monitor.push(rest.first(take));
    rest = rest.subspan(take);
    if (d.hop == hop) continue;
    hop = d.hop;
    out.push_back({.time_s = d.time_s,
                   .chatter = d.state == State::chatter,
                   .stable = d.state == State::stable,
                   .blind = d.state == State::blind,
                   .frequency_hz = d.chatter_frequency_hz});
  }
  return out;
}

RecordedCut without_tachometer(const RecordedCut& cut) {
  if (cut.tachometer_channel < 0) return cut;
  RecordedCut out = cut;
  out.tachometer_channel = -1;
  out.pulses_per_revolution = 1;
  --out.channels;
  out.samples.clear();
  for (std::size_t i = 0; i < cut.samples.size(); ++i) {
    if (i % channels_of(cut) != static_cast<std::size_t>(cut.tachometer_channel)) out.samples.push_back(cut.samples[i]);
  }
  return out;
}

std::vector<DetectorDecision> monitor_decisions_without_tachometer(const RecordedCut& cut) {
  return monitor_decisions(without_tachometer(cut));
}

std::vector<DetectorDecision> rms_five_sigma(const RecordedCut& recorded) {
  const RecordedCut cut = without_tachometer(recorded);
  constexpr std::size_t learnt = 40;  // hops: a second
  std::vector<DetectorDecision> out;
  std::deque<double> past;
  for (const std::size_t end : window_ends(cut)) {
    const auto window = static_cast<std::size_t>(window_s * cut.sample_rate_hz);
    const double rms = std::sqrt(mean_square(cut.samples, channels_of(cut), end - window, end));
    double mean = 0.0, square = 0.0;
    for (const double v : past) mean += v / static_cast<double>(past.size());
    for (const double v : past) square += (v - mean) * (v - mean) / static_cast<double>(past.size());
    const bool chatter = past.size() >= 8 && rms > mean + 5.0 * std::sqrt(square);
    out.push_back({.time_s = static_cast<double>(end) / cut.sample_rate_hz, .chatter = chatter, .stable = !chatter});
    if (!chatter) past.push_back(rms);
    if (past.size() > learnt) past.pop_front();
  }
  return out;
}

std::vector<DetectorDecision> comb_rms_ratio(const RecordedCut& recorded) {
  const RecordedCut cut = without_tachometer(recorded);
  const std::vector<float> left = combed(cut);
  std::vector<DetectorDecision> out;
  int above = 0;
  for (const std::size_t end : window_ends(cut)) {
    const auto window = static_cast<std::size_t>(window_s * cut.sample_rate_hz);
    const double ratio = std::sqrt(mean_square(left, channels_of(cut), end - window, end) /
                                   std::max(1e-30, mean_square(cut.samples, channels_of(cut), end - window, end)));
    above = ratio > 0.6 ? above + 1 : 0;
    const bool chatter = above >= 2;
    out.push_back({.time_s = static_cast<double>(end) / cut.sample_rate_hz, .chatter = chatter, .stable = !chatter});
  }
  return out;
}

}  // namespace robomill::monitor::testing
