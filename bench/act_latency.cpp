// From a decision of chatter to the command of the rule `speed` at whoever listens, through a broker: advice (modes of
// the robot and its chart), rule, JSON, MQTT there and back.
//   act_latency [port 1883] [rounds 1000]      with a broker on loopback: mosquitto -p PORT
#include <fmt/core.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <numbers>
#include <span>
#include <thread>
#include <vector>

#include "app/monitor/broker.hpp"
#include "app/monitor/mqtt.hpp"
#include "robomill/live/advisor.hpp"
#include "robomill/live/hop_queue.hpp"
#include "testing/stability/problems.hpp"

namespace {

using namespace robomill;
using Clock = std::chrono::steady_clock;

double milliseconds(Clock::time_point from, Clock::time_point to) {
  return std::chrono::duration<double, std::milli>(to - from).count();
}

void print(const char* what, std::vector<double> ms) {
  if (ms.empty()) return;
  std::sort(ms.begin(), ms.end());
  const auto at = [&](double share) {
    return ms[static_cast<std::size_t>(share * static_cast<double>(ms.size() - 1))];
  };
  fmt::print("{:<28} median {:.3f} ms, 99 % {:.3f} ms, longest {:.3f} ms\n", what, at(0.5), at(0.99), at(1.0));
}

}  // namespace

int main(int argc, char** argv) {
  monitor::MonitorFile file;
  file.mqtt.port = argc > 1 ? std::atoi(argv[1]) : 1883;
  file.mqtt.commands_topic = "robomill/act_latency";
  const int rounds = argc > 2 ? std::atoi(argv[2]) : 1000;
  constexpr double rpm = stability::testing::rpm, speed = 6700.0 * rpm;
  const stability::LobesProblem problem = stability::testing::robot();
  const live::Advisor advisor(
      {.teeth = 3,
       .modes = problem.dynamics,
       .lobes = stability::compute_lobes(problem, stability::testing::chart(4500, 7500, 2e-3, 200, 100))});

  std::atomic<int> received{0};
  std::atomic<Clock::time_point> received_at{};
  app::MqttClient listener(file.mqtt, file.mqtt.commands_topic, {.message = [&](std::span<const std::byte>) {
                             received_at = Clock::now();
                             ++received;
                           }});
  live::HopQueue queue(1);
  live::Notices notices;
  live::MetricValues metrics;
  listener.start();
  app::Broker broker(file, false, queue, notices, metrics);
  broker.wait_a_little();
  if (!listener.wait_until_connected(std::chrono::seconds(5))) {
    fmt::print(stderr, "act_latency: no broker at port {}\n", file.mqtt.port);
    return 1;
  }
  while (received == 0) {  // until the subscription counts
    broker.publish(live::Command{});
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(200));

  monitor::ActSettings settings;
  settings.rule = monitor::ActRule::speed;
  std::vector<double> decided, whole;
  for (int i = 0; i < rounds; ++i) {
    live::Actor actor(settings, speed);
    monitor::MonitorEvent event;
    event.decision.state = monitor::State::chatter;
    event.decision.changed = true;
    event.decision.chatter_frequency_hz = 544.0 + 0.01 * (i % 100);
    event.decision.chatter_frequency_std_hz = 0.2;
    event.decision.spindle_speed_rad_per_s = speed;
    const int before = received;
    const Clock::time_point begin = Clock::now();
    static_cast<void>(actor.observe(event.decision, 1.0));
    advisor.advise(event);
    const std::optional<live::Command> command = actor.act(event);
    if (!command) {
      fmt::print(stderr, "act_latency: no command\n");
      return 1;
    }
    broker.publish(*command);
    decided.push_back(milliseconds(begin, Clock::now()));
    while (received == before) {
      if (milliseconds(begin, Clock::now()) > 10'000.0) return 1;
      std::this_thread::yield();
    }
    whole.push_back(milliseconds(begin, received_at));
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  fmt::print("{} rounds\n", rounds);
  print("decision to command sent", decided);
  print("decision to command received", whole);
  return 0;
}
