#include "robomill/serve/tap_session.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <thread>

#include "robomill/base/random.hpp"
#include "testing/support.hpp"

namespace robomill::serve {
namespace tap_session_test {

namespace fs = std::filesystem;
using nlohmann::json;
using test::rejection;

constexpr double mode_hz = 200.0;

/// A hit on one mode of 200 Hz, 2 %, 1 kg: half a sine of 1 ms, the acceleration in x by the convolution's closed form.
/// @param second  a second push, as a double hit has it
std::string hit_csv(double force_n, bool second, std::uint64_t seed) {
  constexpr double rate_hz = 8192.0, pulse_s = 1e-3;
  constexpr int samples = 8192;
  const double w = 2.0 * std::numbers::pi * mode_hz;
  const double zeta = 0.02;
  double x = 0.0, v = 0.0;
  Random random(seed);
  std::string out = "time_s,force_n,ax_m_per_s2,ay_m_per_s2\n";
  const auto push = [&](double t) {
    const auto pulse = [&](double start) {
      const double s = t - start;
      return s > 0.0 && s < pulse_s ? force_n * std::sin(std::numbers::pi * s / pulse_s) : 0.0;
    };
    return pulse(0.01) + (second ? 0.6 * pulse(0.03) : 0.0);
  };
  constexpr int steps = 16;
  for (int i = 0; i < samples; ++i) {
    const double t = i / rate_hz;
    const double a = push(t) - 2.0 * zeta * w * v - w * w * x;
    out += std::to_string(t) + "," + std::to_string(push(t) + 1e-3 * random.normal()) + "," +
           std::to_string(a + 1e-2 * random.normal()) + "," + std::to_string(1e-2 * random.normal()) + "\n";
    for (int k = 0; k < steps; ++k) {  // semi-implicit steps, far shorter than the mode's period
      const double dt = 1.0 / rate_hz / steps;
      v += dt * (push(t + k * dt) - 2.0 * zeta * w * v - w * w * x);
      x += dt * v;
    }
  }
  return out;
}

constexpr const char* hits = R"([acquisition]
response = "acceleration"
max_frequency_hz = 1000
[[hits]]
file = "x_1.csv"
force = "force_n"
force_direction = "x"
responses = { x = "ax_m_per_s2", y = "ay_m_per_s2" }
[[hits]]
file = "y_1.csv"
force = "force_n"
force_direction = "-y"
responses = { x = "ax_m_per_s2", y = "ay_m_per_s2" }
)";

json wait_for(const TapSession& session, std::size_t taken) {
  for (;;) {
    json state = json::parse(session.state());
    if (state["taken"].size() >= taken) return state;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

TEST(TapSession, TakesWhatAppears) {
  const test::Folder folder;
  folder.file("before.csv", hit_csv(100.0, false, 1));  // there before the test: not of it
  TapSession session(
      {.hits = folder.at("hits.toml"), .text = hits, .name = "hits.toml", .watch = folder.path(), .wanted = 0},
      [](const std::string&) {});
  json state = json::parse(session.state());
  EXPECT_EQ(state["wanted"], 10);
  EXPECT_TRUE(state["frf"].is_null());
  folder.file("x_1.csv", hit_csv(100.0, false, 2));
  state = wait_for(session, 1);
  EXPECT_EQ(state["good"], 1) << state["taken"];
  folder.file("tap_x_2.csv", hit_csv(120.0, true, 3));
  state = wait_for(session, 2);
  EXPECT_EQ(state["good"], 1);
  EXPECT_FALSE(state["taken"][1]["accepted"]);
  EXPECT_NE(state["taken"][1]["reasons"][0].get<std::string>().find("double"), std::string::npos) << state["taken"];
  folder.file("x_3.csv", hit_csv(80.0, false, 4));
  folder.file("broken.csv", "time_s,force_n\n1,x\n");
  state = wait_for(session, 4);
  EXPECT_EQ(state["good"], 2) << state["taken"];
  for (const json& taken : state["taken"]) {
    EXPECT_EQ(taken["accepted"], taken["file"] == "x_1.csv" || taken["file"] == "x_3.csv") << taken;
    EXPECT_NE(taken["file"], "before.csv");
  }
  // Two hits: there is a coherence, and the mode stands among the peaks.
  EXPECT_FALSE(state["frf"]["coherence"]["xx"].empty());
  EXPECT_LE(state["frf"]["frequency_hz"].size(), 1700u);
  bool found = false;
  for (const json& peak : state["peaks"]) {
    if (peak["name"] != "xx" || std::abs(peak["frequency_hz"].get<double>() - mode_hz) > 2.0) continue;
    found = peak["coherence"] > 0.99 && peak["receptance_m_per_n"] > 0.0;
  }
  EXPECT_TRUE(found) << state["peaks"];
  folder.file("y_1.csv", hit_csv(90.0, false, 5));
  state = wait_for(session, 5);
  EXPECT_EQ(state["taken"].back()["force_direction"], "-y");
}

TEST(TapSession, SettingsMustBeHits) {
  const test::Folder folder;
  const auto start = [&](const char* text, const fs::path& watch) {
    const TapSession session(
        {.hits = folder.at("hits.toml"), .text = text, .name = "hits.toml", .watch = watch, .wanted = 3},
        [](const std::string&) {});
  };
  EXPECT_NE(rejection([&] { start("[acquisition]\n", folder.path()); }).find("has no [[hits]]"), std::string::npos);
  EXPECT_NE(rejection([&] { start("[", folder.path()); }).find("hits.toml:1"), std::string::npos);
  EXPECT_NE(rejection([&] { start(hits, folder.at("none")); }).find("no folder none"), std::string::npos);
}

}  // namespace tap_session_test
}  // namespace robomill::serve
