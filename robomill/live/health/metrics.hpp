#pragma once
#include <array>
#include <atomic>
#include <cstdint>
#include <iterator>
#include <string>

#include "robomill/base/export.hpp"
#include "robomill/monitor/monitor.hpp"

namespace robomill::live {

/// What /metrics reports; written by the monitor, read by the server.
struct ROBOMILL_API MetricValues {
  std::atomic<int> state{3};  ///< 0 stable, 1 transition, 2 chatter, 3 blind, as before the first decision
  std::atomic<double> score{0.0}, threshold{0.0}, energy_entropy{0.0}, level{0.0};
  std::atomic<double> chatter_frequency_hz{0.0}, spindle_speed_rpm{0.0}, stream_s{0.0}, compute_s{0.0}, behind_s{0.0};
  std::atomic<std::uint64_t> decisions{0}, alarms{0}, events{0}, dropped_hops{0}, lost_blocks{0}, faults{0};
  std::atomic<std::uint64_t> rejected_messages{0}, queued_hops{0};
  std::atomic<std::uint64_t> unsaved_events{0}, lost_events{0}, log_failures{0};
  std::atomic<bool> connected{false};

  /// By monitor::BlindReason, how long nothing could be said of the cut: of the stream, and of the clock where no
  /// samples came or none were processed.
  std::array<std::atomic<double>, std::size(monitor::blind_reasons) + 1> blind_s = {};

  void set(const monitor::Decision& decision);
  /// State and frequency alone, where no decision was made.
  void set_state(const monitor::Decision& decision);
  void add_blind(monitor::BlindReason reason, double seconds);
  [[nodiscard]] double blind_for_s(monitor::BlindReason reason) const;
  /// In the text format of Prometheus.
  [[nodiscard]] std::string text() const;
};

}  // namespace robomill::live
