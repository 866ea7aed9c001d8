#pragma once
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "robomill/io/json.hpp"
#include "robomill/live/health/metrics.hpp"
#include "robomill/live/hop_queue.hpp"
#include "robomill/live/notices.hpp"
#include "robomill/modal/impact/hit_trigger.hpp"
#include "robomill/monitor/files/monitor_toml.hpp"
#include "robomill/serve/serve.hpp"

// Method: robomill/serve/README.md, "Tap test"

namespace robomill::serve {

/// Hits out of a stream: opened and cut on a thread of its own, in memory that does not grow.
class TapStream {
 public:
  struct Options {
    std::string address = {};                ///< "mqtt://HOST[:PORT]/TOPIC"
    std::vector<std::string> channels = {};  ///< names, or numbers from 1
    modal::HitTriggerOptions trigger = {};
    std::string direction = {};         ///< of the hits that come
    monitor::MqttSettings broker = {};  ///< user, TLS and time-out; the address has the rest
    std::filesystem::path config = {};  ///< the monitor.toml that the broker's settings are of; empty: none
    std::filesystem::path root = {};    ///< does not appear in messages
    OpenStream open = {};
  };
  /// A record, and the direction at its trigger.
  struct Cut {
    modal::HitRecord record;
    std::string direction;
  };
  /// @param arrived  a record waits; from another thread
  /// @param changed  is given status() on a change, at most twice a second; from another thread
  /// @throws InvalidInput if there are no streams, or the address is none
  TapStream(Options options, std::function<void()> arrived, std::function<void(const io::Json&)> changed);
  /// Waits until it has ended.
  ~TapStream();
  /// Asks it to end; does not wait.
  void stop();
  TapStream(const TapStream&) = delete;
  TapStream& operator=(const TapStream&) = delete;

  /// The records that wait; at most four do.
  [[nodiscard]] std::vector<Cut> take();
  /// Counts a record that is not taken. @param reason  one of few
  void reject(const std::string& reason);
  void set_direction(const std::string& direction);
  [[nodiscard]] std::string direction() const;
  /// {"address", "status", "error", "sample_rate_hz", "record_s", "level_n", "recording", "triggered", "discarded",
  /// "notices"}
  [[nodiscard]] io::Json status() const;

 private:
  enum class Status { connecting, receiving, silent, failed };
  struct Notice {
    std::uint64_t count = 0;
    std::string message;
  };

  void run(const std::stop_token& stop);
  void receive(const std::stop_token& stop);
  void take_record(const modal::HitRecord& record);
  void gather_notices();
  void publish_changes();

  Options options_;
  monitor::MonitorFile file_;
  std::function<void()> arrived_;
  std::function<void(const io::Json&)> changed_;
  live::HopQueue queue_{64};
  live::Notices notices_;
  live::MetricValues metrics_;
  std::atomic<bool> stop_{false};
  std::string published_;     ///< of the stream's thread alone, as the next
  std::string triggered_by_;  ///< direction when the record began
  mutable std::mutex mutex_;  ///< of the rest
  Status status_ = Status::connecting;
  io::Json error_ = nullptr;
  double level_n_ = 0.0;
  bool recording_ = false;
  std::uint64_t triggered_ = 0;
  std::map<std::string, std::uint64_t> discarded_;
  std::map<std::string, Notice> noticed_;
  std::vector<Cut> waiting_;
  std::jthread thread_;
};

}  // namespace robomill::serve
