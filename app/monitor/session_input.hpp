#pragma once
#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "block_order.hpp"
#include "intake.hpp"
#include "metrics.hpp"
#include "mqtt.hpp"
#include "notices.hpp"
#include "robomill/io/sample_source.hpp"
#include "robomill/monitor/files/monitor_events.hpp"
#include "robomill/monitor/files/monitor_toml.hpp"

namespace robomill::app {

/// Tells the notices and the metrics of each hop that is left out.
[[nodiscard]] std::function<void(std::uint64_t)> tell_dropped(Notices& notices, MetricValues& metrics);

/// Reads a recording or a pipe on a thread of its own; closes the queue at the end.
class SourceInput {
 public:
  /// @param can_wait  whether the source may be kept waiting; else hops are left out
  SourceInput(std::unique_ptr<io::SampleSource> source, const monitor::MonitorFile& file, HopQueue& queue,
              Notices& notices, MetricValues& metrics, bool can_wait);
  /// Needs a closed queue, or a source that has been asked to stop.
  ~SourceInput() = default;

 private:
  void read();

  std::unique_ptr<io::SampleSource> source_;
  HopQueue* queue_;
  Notices* notices_;
  Intake intake_;
  std::size_t hop_frames_;
  std::jthread thread_;
};

/// What a stream's messages go through on their way to the queue: refused where they are no blocks of these channels at
/// this rate, put in order, gaps filled. Used by one thread.
class StreamIntake {
 public:
  StreamIntake(const monitor::MonitorFile& file, HopQueue& queue, Notices& notices, MetricValues& metrics);
  void message(std::span<const std::byte> payload);
  /// What waits for missing blocks goes on its way.
  void give_up();

 private:
  void refuse(const std::string& why);
  /// Where the wanted channels stand in blocks of so many.
  bool pick(int channels);
  void give();
  void tell_counts();

  io::SampleColumns columns_;
  double sample_rate_hz_;
  Notices* notices_;
  MetricValues* metrics_;
  Intake intake_;
  BlockOrder order_;
  OrderCounts told_;
  std::vector<BlockOrder::Given> given_;
  int picked_channels_ = 0;
  std::vector<std::size_t> pick_;
  std::vector<float> picked_;
};

/// A broker: samples from it where a topic is named, and events to it.
class Broker {
 public:
  /// @param stream  whether samples come from mqtt.topic
  /// @throws InvalidInput as MqttClient does
  Broker(const monitor::MonitorFile& file, bool stream, HopQueue& queue, Notices& notices, MetricValues& metrics);
  /// Gives up what waits to be published after two seconds.
  ~Broker();
  Broker(const Broker&) = delete;
  Broker& operator=(const Broker&) = delete;

  /// Where it stands, for messages.
  [[nodiscard]] const std::string& address() const { return address_; }
  /// For inputs that do not come from it: their first events should not be lost.
  void wait_a_little() const;
  /// To the topic of the events, where there is one; tells where it cannot.
  void publish(const monitor::MonitorEvent& event, const std::string& line);

 private:
  void connection(bool connected, const std::string& why);

  std::string address_, events_topic_;
  Notices* notices_;
  MetricValues* metrics_;
  std::mutex mutex_;  ///< messages and lost connections come from several threads
  std::optional<StreamIntake> stream_;
  std::unique_ptr<MqttClient> client_;
};

}  // namespace robomill::app
