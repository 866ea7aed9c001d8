#include "examples/papers/energy-entropy/holes_again.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "robomill/base/parallel.hpp"
#include "robomill/base/statistics.hpp"
#include "robomill/monitor/entropy.hpp"

namespace robomill::examples {
namespace {

constexpr double window_s = 0.05;

double value_at(const EntropyCourse& course, double time_s) {
  const auto at = std::lower_bound(course.time_s.begin(), course.time_s.end(), time_s) - course.time_s.begin();
  const auto last = static_cast<std::ptrdiff_t>(course.both.size()) - 1;
  return course.both[static_cast<std::size_t>(std::min(at, last))];
}

double quantile(const std::vector<double>& sorted, double share) {
  return sorted[static_cast<std::size_t>(std::lround(share * static_cast<double>(sorted.size() - 1)))];
}

}  // namespace

const std::array<NamedHole, 5>& named_holes() {
  static const std::array<NamedHole, 5> holes = {{
      {"1", "AL6061", 6.0, 120.0, 3000.0, 3.5, true, 0.255, 0.289},
      {"2", "AL6061", 6.0, 120.0, 3000.0, 6.0, true, 0.311, 0.391},
      {"3", "AL7075", 5.0, 130.0, 3000.0, 6.0, true, 0.162, 0.216},
      {"4", "AL7075", 5.0, 130.0, 4500.0, 3.2, true, 0.257, 0.279},
      {"stable", "AL7075", 5.0, 130.0, 1800.0, 5.7, false, monitor::unknown_s, monitor::unknown_s},
  }};
  return holes;
}

HoleConditions conditions_of(const NamedHole& hole) {
  constexpr double deg = std::numbers::pi / 180.0, rpm = std::numbers::pi / 30.0;
  return {.diameter_m = 1e-3 * hole.diameter_mm,
          .point_angle_rad = hole.point_angle_deg * deg,
          .spindle_speed_rad_per_s = hole.spindle_speed_rpm * rpm,
          .feed_m_per_s = 1e-3 * hole.feed_mm_per_s};
}

monitor::MonitorOptions entropy_options(monitor::Entropy entropy) {
  return {.kind = monitor::Kind::energy_entropy,
          .sample_rate_hz = hole_rate_hz,
          .channels = 2,
          .teeth = 2,
          .window_s = window_s,
          .hop_s = 0.025,
          .bands = 16,
          .entropy = entropy,
          .threshold = 0.0};
}

EntropyCourse entropy_course(const Hole& hole, monitor::Entropy entropy) {
  const monitor::MonitorOptions options = entropy_options(entropy);
  const std::size_t hop = options.hop_samples();
  EntropyCourse out;
  for (Eigen::Index axis = 0; axis < 2; ++axis) {
    const Eigen::VectorXd x = hole.record.acceleration_m_per_s2.col(axis);
    monitor::EnergyEntropy feature(options);
    std::size_t at = 0;
    for (std::size_t end = hop; end <= static_cast<std::size_t>(x.size()); end += hop) {
      const double value = feature.push({x.data() + end - hop, hop});
      if (end < feature.warm_up()) continue;
      if (axis == 0) {
        out.time_s.push_back(static_cast<double>(end - 1) / hole_rate_hz);
        out.one.push_back(value);
        out.both.push_back(0.0);
      }
      out.both[at++] += value;
    }
  }
  return out;
}

double passed_s(const std::vector<double>& time_s, const std::vector<double>& values, double threshold, bool below) {
  for (std::size_t m = 0; m < values.size(); ++m) {
    if (below ? values[m] < threshold : values[m] > threshold) return time_s[m];
  }
  return monitor::unknown_s;
}

Passed count_passed(const std::vector<JudgedHole>& holes, double threshold, bool both) {
  Passed out;
  std::vector<double> delays;
  for (const JudgedHole& hole : holes) {
    const double at_s = passed_s(hole.energy.time_s, both ? hole.energy.both : hole.energy.one, threshold);
    if (!hole.chatter) {
      ++(std::isfinite(at_s) ? out.stable_passes : out.stable_never);
    } else if (!std::isfinite(at_s)) {
      ++out.chatter_never;
    } else if (at_s < hole.onset_s - window_s) {
      ++out.chatter_before;
    } else {
      ++out.chatter_in;
      delays.push_back(at_s - hole.onset_s);
    }
  }
  if (!delays.empty()) out.median_delay_s = median(std::move(delays));
  return out;
}

OnsetThreshold onset_threshold(const std::vector<JudgedHole>& holes, double JudgedHole::*when) {
  std::vector<double> at_onset;
  std::vector<JudgedHole> others;
  bool sets = false;
  for (const JudgedHole& hole : holes) {
    const bool known = hole.chatter && std::isfinite(hole.*when);
    if (known) sets = !sets;
    if (known && sets) {
      at_onset.push_back(value_at(hole.energy, hole.*when));
    } else {
      others.push_back(hole);
    }
  }
  if (at_onset.empty()) return {};
  std::sort(at_onset.begin(), at_onset.end());
  OnsetThreshold out = {quantile(at_onset, 0.5), quantile(at_onset, 0.1), quantile(at_onset, 0.9), {}};
  out.verified = count_passed(others, out.threshold, true);
  return out;
}

Growth growth_of(const Hole& hole, const EntropyCourse& energy) {
  Growth out;
  const std::vector<double>& h = energy.both;
  const auto greatest = static_cast<std::size_t>(std::max_element(h.begin(), h.end()) - h.begin());
  for (std::size_t m = 0; m < greatest; ++m) {
    if (h[m] < 0.05 * h[greatest]) out.rises_s = energy.time_s[m];
  }
  const auto settled = std::find_if(h.begin(), h.end(), [&](double value) { return value >= 0.95 * h[greatest]; });
  out.settles_s = energy.time_s[static_cast<std::size_t>(settled - h.begin())];
  constexpr Eigen::Index part = 102;  // 10 ms
  const auto& a = hole.record.acceleration_m_per_s2;
  Eigen::VectorXd rms(a.rows() / part);
  for (Eigen::Index k = 0; k < rms.size(); ++k) rms(k) = a.block(k * part, 0, part, 2).norm();
  for (Eigen::Index k = 0; k < rms.size(); ++k) {
    if (rms(k) < 0.1 * rms.maxCoeff()) continue;
    out.amplitude_s = static_cast<double>((k + 1) * part - 1) / hole_rate_hz;
    break;
  }
  return out;
}

double default_alarm_s(const Hole& hole) {
  monitor::ChatterMonitor monitor({.sample_rate_hz = hole_rate_hz,
                                   .channels = 2,
                                   .spindle_speed_rad_per_s = hole.cut.spindle_speed_rad_per_s,
                                   .teeth = 2});
  const std::vector<float> samples = recording_of(hole, {}).samples;
  std::size_t at = 0;
  while (true) {
    const std::size_t next = 2 * monitor.frames_to_next_decision();
    if (at + next > samples.size()) return monitor::unknown_s;
    const monitor::Decision decision = monitor.push({samples.data() + at, next});
    if (decision.state == monitor::State::chatter) return decision.time_s;
    at += next;
  }
}

std::vector<Hole> simulate_holes(std::uint64_t count, std::uint64_t seed) {
  std::vector<Hole> out(count);
  parallel_for(count, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) out[k] = simulate_hole(seed, k);
  });
  return out;
}

monitor::Recording recording_of(const Hole& hole, std::string_view name) {
  monitor::Recording out = {.name = std::string(name), .chatter = hole.chatter, .samples = {}, .onset_s = hole.onset_s};
  if (!hole.chatter) out.onset_s = monitor::unknown_s;
  const auto& a = hole.record.acceleration_m_per_s2;
  out.samples.reserve(2 * static_cast<std::size_t>(a.rows()));
  for (Eigen::Index m = 0; m < a.rows(); ++m) {
    for (Eigen::Index axis = 0; axis < 2; ++axis) out.samples.push_back(static_cast<float>(a(m, axis)));
  }
  return out;
}

}  // namespace robomill::examples
