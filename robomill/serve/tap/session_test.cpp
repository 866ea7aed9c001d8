#include "robomill/serve/tap/session.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "robomill/modal/files/hits_toml.hpp"
#include "testing/serve/hammer.hpp"
#include "testing/support.hpp"

namespace robomill::serve {
namespace tap_session_test {

namespace fs = std::filesystem;
using nlohmann::json;
using test::rejection;

constexpr double mode_hz = test::HammerRecord::mode_hz;

/// @param second  a second push, as a double hit has it
std::string hit_csv(double force_n, bool second, std::uint64_t seed) {
  std::vector<test::Push> pushes = {{.at_s = 0.01, .peak_n = force_n}};
  if (second) pushes.push_back({.at_s = 0.03, .peak_n = 0.6 * force_n});
  return test::HammerRecord(8192, pushes, seed).csv();
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
  const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(1);
  for (;;) {
    json state = json::parse(session.state());
    if (state["taken"].size() >= taken) return state;
    if (std::chrono::steady_clock::now() > end) {
      ADD_FAILURE() << "never were " << taken << ": " << state["taken"];
      return state;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

TEST(TapSession, TakesWhatAppears) {
  const test::Folder folder;
  test::appear(folder, "before.csv", hit_csv(100.0, false, 1));  // there before the test: not of it
  TapSession session(
      {.hits = folder.at("hits.toml"), .text = hits, .name = "hits.toml", .watch = folder.path(), .wanted = 0},
      [](std::string_view, std::string_view) {});
  json state = json::parse(session.state());
  EXPECT_EQ(state["wanted"], 10);
  EXPECT_TRUE(state["frf"].is_null());
  test::appear(folder, "x_1.csv", hit_csv(100.0, false, 2));
  state = wait_for(session, 1);
  EXPECT_EQ(state["good"], 1) << state["taken"];
  test::appear(folder, "tap_x_2.csv", hit_csv(120.0, true, 3));
  state = wait_for(session, 2);
  EXPECT_EQ(state["good"], 1);
  EXPECT_FALSE(state["taken"][1]["accepted"]);
  EXPECT_NE(state["taken"][1]["reasons"][0].get<std::string>().find("double"), std::string::npos) << state["taken"];
  test::appear(folder, "x_3.csv", hit_csv(80.0, false, 4));
  test::appear(folder, "broken.csv", "time_s,force_n\n1,x\n");
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
  test::appear(folder, "y_1.csv", hit_csv(90.0, false, 5));
  state = wait_for(session, 5);
  EXPECT_EQ(state["taken"].back()["force_direction"], "-y");
}

// Whatever fails while a hit is taken, the test goes on.
TEST(TapSession, GoesOnAfterAnError) {
  const test::Folder folder;
  std::atomic<int> events{0};
  TapSession session(
      {.hits = folder.at("hits.toml"), .text = hits, .name = "hits.toml", .watch = folder.path(), .wanted = 0},
      [&](std::string_view, std::string_view) {
        if (++events == 1) throw std::runtime_error("an error");
      });
  test::appear(folder, "x_1.csv", hit_csv(100.0, false, 2));
  EXPECT_EQ(wait_for(session, 1)["good"], 1);
  test::appear(folder, "x_2.csv", hit_csv(90.0, false, 3));
  EXPECT_EQ(wait_for(session, 2)["good"], 2);
}

/// What was taken, by name.
std::vector<std::string> names_of(const json& state) {
  std::vector<std::string> out;
  for (const json& taken : state["taken"]) out.push_back(taken["file"]);
  return out;
}

// A record may hold several hits. A saved document names it once, without those that were excluded.
TEST(TapSession, TakesEveryHitOfARecord) {
  const test::Folder folder;
  TapSession session(
      {.hits = folder.at("hits.toml"), .text = hits, .name = "hits.toml", .watch = folder.path(), .wanted = 0},
      [](std::string_view, std::string_view) {});
  const std::vector<test::Push> pushes = {{.at_s = 0.1, .peak_n = 100.0},
                                          {.at_s = 1.1, .peak_n = 80.0},
                                          {.at_s = 2.1, .peak_n = 120.0},
                                          {.at_s = 3.1, .peak_n = 90.0}};
  test::appear(folder, "x_1.csv", test::HammerRecord(4 * 8192, pushes, 7).csv());
  const json state = wait_for(session, 4);
  EXPECT_EQ(state["good"], 4) << state["taken"];
  EXPECT_EQ(names_of(state)[2], "x_1.csv, hit 3 of 4 at 2.10 s");
  ASSERT_TRUE(session.set_accepted(2, false));
  static_cast<void>(session.save(folder.at("saved.toml"), false));
  const modal::HitsFile saved = modal::read_hits(folder.at("saved.toml"));
  ASSERT_EQ(saved.hits.size(), 3U);
  EXPECT_EQ(saved.hits[1].file, folder.at("x_1.csv").string() + ", hit 3 of 4 at 2.10 s");
}

// Force and responses apart: the first file waits for the other one, whichever comes first.
TEST(TapSession, WaitsForTheOtherFileOfARecord) {
  const test::Folder folder;
  constexpr const char* apart = R"([acquisition]
max_frequency_hz = 1000
[[hits]]
file = ["force_x_1.csv", "acc_x_1.csv"]
force = "force_n"
force_direction = "x"
responses = { x = "ax_m_per_s2" }
)";
  TapSession session(
      {.hits = folder.at("hits.toml"), .text = apart, .name = "hits.toml", .watch = folder.path(), .wanted = 0},
      [](std::string_view, std::string_view) {});
  const auto column = [](const std::string& name, const std::vector<double>& values) {
    std::string text = "time_s," + name + "\n";
    for (std::size_t i = 0; i < values.size(); ++i) {
      text +=
          std::to_string(static_cast<double>(i) / test::HammerRecord::rate_hz) + "," + std::to_string(values[i]) + "\n";
    }
    return text;
  };
  for (const std::string number : {"1", "2"}) {
    const test::HammerRecord record(8192, {{.at_s = 0.1, .peak_n = 100.0}}, number == "1" ? 3 : 4);
    test::appear(folder, "acc_x_" + number + ".csv", column("ax_m_per_s2", record.ax_m_per_s2));
    const auto waits = [&] { return json::parse(session.state())["waiting"]; };
    const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(1);
    while (waits().empty() && std::chrono::steady_clock::now() < end) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    EXPECT_EQ(waits(), json::array({"acc_x_" + number + ".csv"}));
    test::appear(folder, "force_x_" + number + ".csv", column("force_n", record.force_n));
    const json state = wait_for(session, number == "1" ? 1 : 2);
    EXPECT_EQ(names_of(state).back(), "force_x_" + number + ".csv + acc_x_" + number + ".csv");
    EXPECT_TRUE(state["waiting"].empty());
  }
  EXPECT_EQ(json::parse(session.state())["good"], 2);
  static_cast<void>(session.save(folder.at("saved.toml"), false));
  EXPECT_EQ(modal::read_hits(folder.at("saved.toml")).hits.size(), 2U);
}

TEST(TapSession, SettingsMustBeHits) {
  const test::Folder folder;
  const auto start = [&](const char* text, const fs::path& watch) {
    const TapSession session(
        {.hits = folder.at("hits.toml"), .text = text, .name = "hits.toml", .watch = watch, .wanted = 3},
        [](std::string_view, std::string_view) {});
  };
  EXPECT_NE(rejection([&] { start("[acquisition]\n", folder.path()); }).find("has no [[hits]]"), std::string::npos);
  EXPECT_NE(rejection([&] { start("[", folder.path()); }).find("hits.toml:1"), std::string::npos);
  EXPECT_NE(rejection([&] { start(hits, folder.at("none")); }).find("no folder none"), std::string::npos);
}

}  // namespace tap_session_test
}  // namespace robomill::serve
