#pragma once
#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "mqtt.hpp"
#include "robomill/live/act.hpp"
#include "robomill/live/inputs.hpp"
#include "robomill/monitor/files/monitor_events.hpp"

namespace robomill::app {

/// A broker: samples from it where a topic is named, events and commands to it.
class Broker {
 public:
  /// @param stream  whether samples come from mqtt.topic
  /// @throws InvalidInput as MqttClient does
  Broker(const monitor::MonitorFile& file, bool stream, live::HopQueue& queue, live::Notices& notices,
         live::MetricValues& metrics);
  /// Gives up what waits to be published after two seconds.
  ~Broker();
  Broker(const Broker&) = delete;
  Broker& operator=(const Broker&) = delete;

  /// Where it stands, for messages.
  [[nodiscard]] const std::string& address() const { return address_; }
  /// Where samples come from it: waits for the first connection, or until `stop` becomes true.
  /// @param waiting  called again and again meanwhile
  /// @throws InvalidInput if there is none within mqtt.connect_timeout_s; 0: without end
  void require_connection(const std::atomic<bool>& stop, const std::function<void()>& waiting = {});
  /// For inputs that do not come from it: their first events should not be lost.
  void wait_a_little() const;
  /// Publishes to the topic of the events, where there is one; adds a notice where it cannot.
  void publish(const monitor::MonitorEvent& event, const std::string& line);
  /// Publishes to the topic of the commands in the same way, with the time of the clock. One that finds no connection
  /// is dropped: it would come too late.
  void publish(const live::Command& command);

 private:
  void send(const std::string& topic, const std::string& line, const char* failure, bool report);
  void connection(bool connected, const std::string& why);

  std::string address_, events_topic_, commands_topic_;
  double connect_timeout_s_;
  bool has_file_;  ///< whose settings could be others
  live::Notices* notices_;
  live::MetricValues* metrics_;
  std::mutex mutex_;  ///< messages and lost connections come from several threads
  std::string why_;   ///< there is no connection
  std::optional<live::StreamIntake> stream_;
  std::unique_ptr<MqttClient> client_;
};

}  // namespace robomill::app
