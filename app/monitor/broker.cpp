#include "broker.hpp"

#include <fmt/format.h>

#include <chrono>
#include <string_view>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/live/files/command_json.hpp"

namespace robomill::app {
namespace {

constexpr std::chrono::milliseconds publish_wait{2000}, connection_wait{50};

}  // namespace

Broker::Broker(const monitor::MonitorFile& file, bool stream, live::HopQueue& queue, live::Notices& notices,
               live::MetricValues& metrics)
    : address_(fmt::format("{}:{}", file.mqtt.host, file.mqtt.port_or_default())),
      events_topic_(file.mqtt.events_topic),
      commands_topic_(file.mqtt.commands_topic),
      connect_timeout_s_(file.mqtt.connect_timeout_s),
      has_file_(!file.path.empty()),
      notices_(&notices),
      metrics_(&metrics) {
  if (stream) stream_.emplace(file, queue, notices, metrics);
  client_ = std::make_unique<MqttClient>(
      file.mqtt, stream ? file.mqtt.topic : std::string(),
      MqttClient::Calls{.message =
                            [this](std::span<const std::byte> payload) {
                              const std::scoped_lock lock(mutex_);
                              if (stream_) stream_->message(payload);
                            },
                        .connection = [this](bool connected, const std::string& why) { connection(connected, why); }});
  client_->start();
}

Broker::~Broker() {
  if (!events_topic_.empty() || !commands_topic_.empty()) client_->flush(publish_wait);
}

void Broker::require_connection(const std::atomic<bool>& stop, const std::function<void()>& waiting) {
  const auto begin = std::chrono::steady_clock::now();
  while (!stop && !client_->wait_until_connected(connection_wait)) {
    if (waiting) waiting();
    const std::chrono::duration<double> waited = std::chrono::steady_clock::now() - begin;
    if (connect_timeout_s_ == 0.0 || waited.count() < connect_timeout_s_) continue;
    const std::scoped_lock lock(mutex_);
    throw InvalidInput("mqtt://" + address_,
                       fmt::format("no connection within {:.6g} s: {}", connect_timeout_s_,
                                   why_.empty() ? "the broker does not answer" : why_),
                       has_file_ ? "Does the broker run, and is its address right? mqtt.connect_timeout_s of "
                                   "monitor.toml waits longer, 0 for ever"
                                 : "Does the broker run, and is its address right?");
  }
}

void Broker::wait_a_little() const {
  client_->wait_until_connected(publish_wait);
}

void Broker::connection(bool connected, const std::string& why) {
  if (connected && !why.empty()) {
    notices_->add("subscription-refused", fmt::format("{}: {}", address_, why));
    return;
  }
  const bool was = metrics_->connected.exchange(connected);
  if (connected) {
    notices_->add("broker-connected", address_);
    return;
  }
  notices_->add(was ? "broker-lost" : "broker-unreachable", fmt::format("{}: {}; trying again", address_, why));
  const std::scoped_lock lock(mutex_);
  why_ = why;
  if (stream_) stream_->give_up();
}

void Broker::send(const std::string& topic, const std::string& line, const char* failure, bool report) {
  if (topic.empty()) return;
  const std::string_view text = std::string_view(line).substr(0, line.size() - 1);
  if (!client_->publish(topic, text) && report) {
    notices_->add(failure, fmt::format("{} has no connection or does not take them", address_));
  }
}

void Broker::publish(const monitor::MonitorEvent& event, const std::string& line) {
  // A failure to publish this notice itself is not reported again.
  send(events_topic_, line, "events-not-published", event.what != "events-not-published");
}

void Broker::publish(const live::Command& command) {
  const std::chrono::duration<double> now = std::chrono::system_clock::now().time_since_epoch();
  send(commands_topic_, live::command_line(command, now.count()), "commands-not-published", true);
}

}  // namespace robomill::app
