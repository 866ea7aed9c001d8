#include "metrics.hpp"

// Plain HTTP on loopback needs neither TLS nor compression.
#define CPPHTTPLIB_KEEPALIVE_MAX_COUNT 100
#include <fmt/format.h>
#include <httplib.h>

#include <cmath>
#include <iterator>
#include <string_view>
#include <thread>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"

namespace robomill::app {
namespace {

constexpr std::size_t max_request_bytes = 4096;

void row(std::string& out, std::string_view name, std::string_view type, std::string_view help, double value) {
  if (!std::isfinite(value)) return;
  fmt::format_to(std::back_inserter(out), "# HELP robomill_{0} {1}\n# TYPE robomill_{0} {2}\nrobomill_{0} {3}\n", name,
                 help, type, value);
}

}  // namespace

void MetricValues::set(const monitor::Decision& decision) {
  state = static_cast<int>(decision.state);
  score = decision.score;
  threshold = decision.threshold;
  energy_entropy = decision.energy_entropy;
  level = decision.level;
  chatter_frequency_hz = decision.chatter_frequency_hz;
  spindle_speed_rpm = decision.spindle_speed_rad_per_s / units::rpm;
  faults = decision.faults;
  ++decisions;
}

std::string MetricValues::text() const {
  std::string out;
  const auto gauge = [&out](std::string_view name, std::string_view help, double value) {
    row(out, name, "gauge", help, value);
  };
  const auto counter = [&out](std::string_view name, std::string_view help, const std::atomic<std::uint64_t>& value) {
    row(out, name, "counter", help, static_cast<double>(value.load()));
  };
  gauge("state", "0 stable, 1 transition, 2 chatter", state);
  gauge("score", "of the detector", score);
  gauge("threshold", "that the score is held against", threshold);
  gauge("energy_entropy", "of the bands", energy_entropy);
  gauge("level", "rms of all channels, in the unit of the input", level);
  gauge("chatter_frequency_hz", "0 where there is none", chatter_frequency_hz);
  gauge("spindle_speed_rpm", "as tracked, 0 where it is unknown", spindle_speed_rpm);
  gauge("faults", "bits of what is wrong with the input", static_cast<double>(faults.load()));
  gauge("stream_seconds", "time of the stream heard so far", stream_s);
  gauge("compute_seconds", "that the last decision took", compute_s);
  gauge("queued_hops", "waiting for the detector", static_cast<double>(queued_hops.load()));
  gauge("connected", "1 while a broker is", connected ? 1.0 : 0.0);
  counter("decisions_total", "hops decided", decisions);
  counter("alarms_total", "times that the state became chatter", alarms);
  counter("events_total", "written", events);
  counter("dropped_hops_total", "left out since input was faster than the detector", dropped_hops);
  counter("lost_blocks_total", "that never came", lost_blocks);
  counter("refused_messages_total", "that were no blocks of samples", refused_messages);
  return out;
}

struct MetricsServer::Parts {
  httplib::Server server;
  std::jthread thread;
};

MetricsServer::MetricsServer(const MetricValues& values, const std::string& host, int port)
    : parts_(std::make_unique<Parts>()) {
  httplib::Server& server = parts_->server;
  server.new_task_queue = [] { return new httplib::ThreadPool(2); };  // NOLINT: httplib takes it over
  // Not shared with another server, as httplib would have it.
  server.set_socket_options([](socket_t socket) {
    const int yes = 1;
    ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
  });
  server.set_payload_max_length(max_request_bytes);
  server.set_read_timeout(2);
  server.set_write_timeout(2);
  server.set_keep_alive_timeout(2);
  server.Get("/metrics", [&values](const httplib::Request&, httplib::Response& response) {
    response.set_content(values.text(), "text/plain; version=0.0.4");
  });
  port_ = port == 0 ? server.bind_to_any_port(host) : (server.bind_to_port(host, port) ? port : -1);
  if (port_ <= 0) {
    throw InvalidInput("metrics", fmt::format("cannot listen at {}:{}", host, port), "Is the port taken?");
  }
  parts_->thread = std::jthread([&server] { server.listen_after_bind(); });
  // stop() before listen_after_bind has begun would be forgotten.
  while (!server.is_running()) std::this_thread::yield();
}

MetricsServer::~MetricsServer() {
  parts_->server.stop();
}

}  // namespace robomill::app
