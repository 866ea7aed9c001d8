#pragma once
#include <atomic>
#include <cstdint>
#include <string>

#include "robomill/base/export.hpp"
#include "robomill/monitor/monitor.hpp"

// Method: robomill/live/README.md, "Outputs"

namespace robomill::live {

/// What /metrics reports; written by the monitor, read by the server.
struct ROBOMILL_API MetricValues {
  std::atomic<int> state{0};  ///< 0 stable, 1 transition, 2 chatter
  std::atomic<double> score{0.0}, threshold{0.0}, energy_entropy{0.0}, level{0.0};
  std::atomic<double> chatter_frequency_hz{0.0}, spindle_speed_rpm{0.0}, stream_s{0.0}, compute_s{0.0};
  std::atomic<std::uint64_t> decisions{0}, alarms{0}, events{0}, dropped_hops{0}, lost_blocks{0}, faults{0};
  std::atomic<std::uint64_t> rejected_messages{0}, queued_hops{0};
  std::atomic<bool> connected{false};

  void set(const monitor::Decision& decision);
  /// In the text format of Prometheus.
  [[nodiscard]] std::string text() const;
};

}  // namespace robomill::live
