#pragma once
// For tests: robomill monitor on a cut that chatters.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/io/sample_source.hpp"
#include "test_program.hpp"

namespace robomill::app {

class MonitorVerb : public ProgramTest {
 protected:
  using json = nlohmann::json;
  static constexpr double rate_hz = 10240.0;
  static constexpr double chatter_hz = 683.0, onset_s = 4.0;

  /// A cut at 3000 rpm with two teeth and noise; from onset_s on chatter grows, until it stands.
  static std::vector<float> cut(double seconds, bool chatters) {
    Random random(42);
    std::vector<float> samples;
    const auto count = static_cast<std::size_t>(seconds * rate_hz);
    for (std::size_t i = 0; i < count; ++i) {
      const double t = static_cast<double>(i) / rate_hz;
      double x = 0.3 * random.normal();
      for (int k = 1; k <= 6; ++k) x += 4.0 / k * std::sin(2.0 * std::numbers::pi * 50.0 * k * t + k);
      if (chatters && t > onset_s) {
        x += std::min(20.0, 0.02 * std::exp((t - onset_s) / 0.05)) * std::sin(2.0 * std::numbers::pi * chatter_hz * t);
      }
      samples.push_back(static_cast<float>(x));
    }
    return samples;
  }

  void SetUp() override { folder_.file("monitor.toml", config_); }
  void wav(const std::string& name, const std::vector<float>& samples) {
    io::write_wav(folder_.at(name), samples, 1, rate_hz);
  }
  [[nodiscard]] std::vector<json> events(const std::string& name = "events.jsonl") const {
    std::vector<json> out;
    std::istringstream lines(slurp(folder_.at(name)));
    for (std::string line; std::getline(lines, line);) {
      out.push_back(json::parse(line, nullptr, false));
      EXPECT_FALSE(out.back().is_discarded()) << line;
    }
    return out;
  }
  /// Of one kind: "state", or faults of a stream.
  [[nodiscard]] std::vector<json> events_of(const std::string& what) const {
    std::vector<json> out;
    for (const json& event : events()) {
      if (event["event"] == what || (event.contains("what") && event["what"] == what)) out.push_back(event);
    }
    return out;
  }
  /// The state in which chatter was first found; null: it was not.
  [[nodiscard]] json first_alarm() const {
    for (json& event : events_of("state")) {
      if (event["state"] == "chatter") return std::move(event);
    }
    return nullptr;
  }
  [[nodiscard]] bool has_event(const std::string& what) const {
    return slurp(folder_.at("events.jsonl")).find("\"" + what + "\"") != std::string::npos;
  }

  /// The configuration with another timeout.
  [[nodiscard]] std::string timed(const std::string& timeout_s) const {
    return "[signal]\ntimeout_s = " + timeout_s + "\n" + config_.substr(config_.find('\n') + 1);
  }

  const std::string config_ =
      "[signal]\nsample_rate_hz = 10240\nchannels = [\"ax_m_per_s2\"]\n[process]\nspindle_speed_rpm = 3000\nteeth = "
      "2\n";
};

}  // namespace robomill::app
