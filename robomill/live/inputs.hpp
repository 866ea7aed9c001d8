#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/io/sample_source.hpp"
#include "robomill/live/block_order.hpp"
#include "robomill/live/health/arrival_rate.hpp"
#include "robomill/live/health/metrics.hpp"
#include "robomill/live/intake.hpp"
#include "robomill/live/notices.hpp"
#include "robomill/monitor/files/monitor_toml.hpp"

namespace robomill::live {

/// Adds each hop that is left out to the notices and the metrics.
[[nodiscard]] std::function<void(std::uint64_t)> report_dropped(Notices& notices, MetricValues& metrics);

/// Reads a recording or a pipe on a thread of its own; closes the queue at the end. Reports rows that cannot be read,
/// raw samples that are misaligned, and of what cannot wait a rate that is off.
class ROBOMILL_API SourceInput {
 public:
  /// @param can_wait  whether the source may be kept waiting; else hops are left out
  SourceInput(std::unique_ptr<io::SampleSource> source, const monitor::MonitorFile& file, HopQueue& queue,
              Notices& notices, MetricValues& metrics, bool can_wait);
  /// Needs a closed queue, or a source that has been asked to stop.
  ~SourceInput() = default;

 private:
  void read();
  void report_faults();

  std::unique_ptr<io::SampleSource> source_;
  HopQueue* queue_;
  Notices* notices_;
  Intake intake_;
  std::size_t hop_frames_, channels_;
  std::optional<ArrivalRate> rate_;  ///< of what cannot wait
  std::uint64_t reported_rows_ = 0, reported_misaligned_ = 0;
  std::jthread thread_;
};

/// What a stream's messages go through on their way to the queue: rejected where they are no blocks of these channels
/// at this rate, put in order, gaps filled, their rate compared with the clock. Used by one thread.
class ROBOMILL_API StreamIntake {
 public:
  StreamIntake(const monitor::MonitorFile& file, HopQueue& queue, Notices& notices, MetricValues& metrics);
  void message(std::span<const std::byte> payload);
  /// What waits for missing blocks goes on its way.
  void give_up();

 private:
  void reject(const std::string& why);
  /// Where the wanted channels stand in blocks of so many.
  bool pick(int channels);
  void give();
  void report_counts();

  io::SampleColumns columns_;
  double sample_rate_hz_;
  Notices* notices_;
  MetricValues* metrics_;
  Intake intake_;
  ArrivalRate rate_;
  BlockOrder order_;
  OrderCounts reported_;
  std::vector<BlockOrder::Given> given_;
  int picked_channels_ = 0;
  std::vector<std::size_t> pick_;
  std::vector<float> picked_;
};

}  // namespace robomill::live
