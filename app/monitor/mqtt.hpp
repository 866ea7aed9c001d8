#pragma once
#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "robomill/monitor/files/monitor_toml.hpp"

namespace robomill::app {

/// A connection to an MQTT broker that comes back by itself: after a quarter of a second, then twice as long each time,
/// at most 30 s.
class MqttClient {
 public:
  /// Called by the library's threads; must not wait.
  struct Calls {
    std::function<void(std::span<const std::byte> payload)> message = {};
    /// why: empty once connected, else what went wrong. A rejected subscription: connected, and why is not empty.
    std::function<void(bool connected, const std::string& why)> connection = {};
  };
  /// Subscribes to `subscription` at each connection, unless it is empty.
  /// @throws InvalidInput if a certificate, key or password cannot be read, or the address is none
  MqttClient(const monitor::MqttSettings& settings, std::string subscription, Calls calls);
  ~MqttClient();
  MqttClient(const MqttClient&) = delete;
  MqttClient& operator=(const MqttClient&) = delete;

  /// Begins to connect; returns at once.
  void start();
  [[nodiscard]] bool connected() const;
  bool wait_until_connected(std::chrono::milliseconds time) const;
  /// Does not wait. False where there is no connection, or 1,000 messages are still on their way.
  bool publish(const std::string& topic, std::string_view payload);
  /// Waits until what was published has reached the broker. False where the time was over before.
  bool flush(std::chrono::milliseconds time) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace robomill::app
