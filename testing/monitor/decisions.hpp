#pragma once
#include <algorithm>
#include <numbers>
#include <span>
#include <vector>

#include "robomill/monitor/monitor.hpp"
#include "testing/monitor/signal.hpp"

namespace robomill::monitor::testing {

/// For a cut whose teeth are given, and whose speed is, but off by a ratio; -1: it is not.
inline MonitorOptions options_for(const SyntheticCut& cut, double hint_off = 0.02) {
  return {.sample_rate_hz = cut.sample_rate_hz,
          .channels = cut.channels,
          .spindle_speed_rad_per_s = 2.0 * std::numbers::pi * cut.rotation_hz * (1.0 + hint_off),
          .teeth = cut.teeth};
}

/// Of all hops.
inline std::vector<Decision> decisions_of(const MonitorOptions& options, std::span<const float> samples) {
  ChatterMonitor monitor(options);
  const std::size_t block = options.hop_samples() * static_cast<std::size_t>(options.channels);
  std::vector<Decision> out;
  for (std::size_t at = 0; at + block <= samples.size(); at += block) {
    out.push_back(monitor.push(samples.subspan(at, block)));
  }
  return out;
}

/// -1: none.
inline double first_alarm_s(const std::vector<Decision>& decisions) {
  const auto found = std::ranges::find(decisions, State::chatter, &Decision::state);
  return found == decisions.end() ? -1.0 : found->time_s;
}

}  // namespace robomill::monitor::testing
