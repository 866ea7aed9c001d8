// Records as rows of hits.toml name them freely, and records of more hits than a test may have: over the requests.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "robomill/jobs/frf.hpp"
#include "robomill/modal/files/frf_files.hpp"
#include "robomill/serve/error_json.hpp"
#include "robomill/serve/tap/tap_tests.hpp"
#include "testing/serve/hammer.hpp"
#include "testing/support.hpp"

namespace robomill::serve {
namespace tap_records_test {

using nlohmann::json;
using test::HammerRecord;

class TapRecords : public ::testing::Test {
 protected:
  TapRecords() {
    tests_ = std::make_unique<TapTests>(folder_, OpenStream(), [](std::string_view, std::string_view) {});
  }

  json ask(const char* method, const std::string& path, const json& body = nullptr) {
    const HttpResponse answer = answer_of(folder_.root(), [&] {
      return tests_->answer({.method = method, .path = path, .query = {}, .headers = {}, .body = body.dump()});
    });
    EXPECT_EQ(answer.status, 200) << method << path << body << answer.body;
    EXPECT_EQ(answer.body.find(place_.path().string()), std::string::npos) << answer.body;
    return json::parse(answer.body, nullptr, false);
  }
  template <class Condition>
  json wait(const Condition& condition) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(1);
    for (;;) {
      json state = ask("GET", "/api/tap");
      if (condition(state)) return state;
      if (std::chrono::steady_clock::now() > end) {
        ADD_FAILURE() << "never was: " << state["taken"].size() << " taken, waiting for " << state["waiting"];
        return state;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  }
  json wait_for_hits(std::size_t taken) {
    return wait([&](const json& state) { return state["taken"].size() >= taken; });
  }
  void start(const std::string& hits) {
    place_.file("hits.toml", hits);
    ask("POST", "/api/tap", {{"hits", "hits.toml"}});
  }

  test::Folder place_;
  Folder folder_{place_.path()};
  std::unique_ptr<TapTests> tests_;
};

/// A record of so many hits, at 1,024 Hz: pulses of three samples, a decay after each.
std::string many_hits(int hits) {
  constexpr int apart = 320;
  std::string text = "time_s,force_n,ax_m_per_s2\n";
  for (int i = 0; i < hits * apart; ++i) {
    const int since = i % apart - 64;
    const double force_n = since == 0 || since == 2 ? 50.0 : since == 1 ? 100.0 : 0.001 * (i % 7 - 3);
    const double s = since / 1024.0;
    const double a = since < 0 ? 0.0 : 20.0 * std::exp(-60.0 * s) * std::sin(2.0 * 3.14159265358979 * 150.0 * s);
    text += std::to_string(i / 1024.0) + "," + std::to_string(force_n) + "," + std::to_string(a) + "\n";
  }
  return text;
}

constexpr const char* one_row =
    "[acquisition]\nmax_frequency_hz = 300\nhit_spacing_s = 0.1\n[[hits]]\nfile = \"x_1.csv\"\nforce = \"force_n\"\n"
    "force_direction = \"x\"\nresponses = { x = \"ax_m_per_s2\" }\n";

// None of it is taken: half of a record would be a test that nobody made.
TEST_F(TapRecords, OneOfMoreHitsThanATestMayHaveIsNamed) {
  start(one_row);
  test::appear(place_, "x_1.csv", many_hits(201));
  json state = wait_for_hits(1);
  ASSERT_EQ(state["taken"].size(), 1U);
  EXPECT_EQ(state["taken"][0]["file"], "x_1.csv");
  EXPECT_FALSE(state["taken"][0]["accepted"]);
  EXPECT_EQ(state["taken"][0]["reasons"], json::array({"holds 201 hits, and the test has 0 of the 200 that it may"}));
  EXPECT_TRUE(state["frf"].is_null());
  EXPECT_EQ(state["good"], 0);
  // The test goes on, and one of as many as are left is taken whole.
  test::appear(place_, "x_2.csv", many_hits(199));
  state = wait_for_hits(200);
  ASSERT_EQ(state["taken"].size(), 200U);
  EXPECT_EQ(state["taken"][199]["file"], "x_2.csv, hit 199 of 199 at 61.94 s");
  EXPECT_GT(state["good"], 150) << state["taken"][1];
  EXPECT_FALSE(state["frf"].is_null());
}

// A record that comes to a full test is named too, once.
TEST_F(TapRecords, OneThatComesToAFullTestIsNamed) {
  start(one_row);
  test::appear(place_, "x_1.csv", many_hits(200));
  EXPECT_EQ(wait_for_hits(200)["taken"].size(), 200U);
  test::appear(place_, "x_2.csv", many_hits(2));
  test::appear(place_, "x_3.csv", many_hits(2));
  json state = wait_for_hits(201);
  ASSERT_EQ(state["taken"].size(), 201U);
  EXPECT_EQ(state["taken"][200]["file"], "x_2.csv");
  EXPECT_EQ(
      state["taken"][200]["reasons"],
      json::array({"the test has 200 hits, which is as many as it may: this record and later ones are not read"}));
  EXPECT_FALSE(ask("GET", "/api/tap/201")["accepted"]);
}

std::string column_of(const std::string& name, const std::vector<double>& values) {
  std::string text = "time_s," + name + "\n";
  for (std::size_t i = 0; i < values.size(); ++i) {
    text += std::to_string(static_cast<double>(i) / HammerRecord::rate_hz) + "," + std::to_string(values[i]) + "\n";
  }
  return text;
}

// A row a record, its files named as the recorder numbers them: no name says a direction, or what is within.
constexpr const char* freely_named = R"([acquisition]
max_frequency_hz = 1000
[[hits]]
file = ["Ch1_0007.csv", "Ch2_0007.csv"]
force = "load"
force_direction = "x"
responses = { x = "tip" }
[[hits]]
file = ["monday/b.csv", "monday/a.csv"]
force = "load"
force_direction = "-y"
responses = { y = "tip" }
[[hits]]
file = ["Ch1_0009.csv", "Ch2_0009.csv"]
force = "load"
force_direction = "x"
responses = { x = "tip" }
)";

TEST_F(TapRecords, AreTakenByTheRowsThatNameThemFreely) {
  start(freely_named);
  std::filesystem::create_directory(place_.at("monday"));
  const auto load = [](std::uint64_t seed) {
    return column_of("load", HammerRecord(8192, {{.at_s = 0.1, .peak_n = 90.0}}, seed).force_n);
  };
  const auto tip = [](std::uint64_t seed) {
    return column_of("tip", HammerRecord(8192, {{.at_s = 0.1, .peak_n = 90.0}}, seed).ax_m_per_s2);
  };
  const auto waits_for = [&](const json& files) {
    EXPECT_EQ(wait([&](const json& state) { return state["waiting"] == files; })["waiting"], files);
  };
  // Each file waits for the other one of its own row, in whatever order they come.
  test::appear(place_, "Ch2_0009.csv", tip(3));
  waits_for({"Ch2_0009.csv"});
  test::appear(place_, "Ch1_0007.csv", load(1));
  wait([](const json& state) { return state["waiting"].size() == 2; });
  test::appear(place_, "Ch2_0007.csv", tip(1));
  json state = wait_for_hits(1);
  EXPECT_EQ(state["taken"][0]["file"], "Ch1_0007.csv + Ch2_0007.csv");
  EXPECT_EQ(state["taken"][0]["force_direction"], "x");
  EXPECT_TRUE(state["taken"][0]["accepted"]) << state["taken"][0];
  place_.file("monday/.a.csv", tip(2));
  place_.file("monday/.b.csv", load(2));
  std::filesystem::rename(place_.at("monday/.a.csv"), place_.at("monday/a.csv"));
  waits_for({"a.csv", "Ch2_0009.csv"});  // by their rows
  std::filesystem::rename(place_.at("monday/.b.csv"), place_.at("monday/b.csv"));
  state = wait_for_hits(2);
  EXPECT_EQ(state["taken"][1]["file"], "b.csv + a.csv");
  EXPECT_EQ(state["taken"][1]["force_direction"], "-y");
  EXPECT_TRUE(state["taken"][1]["accepted"]) << state["taken"][1];
  test::appear(place_, "Ch1_0009.csv", load(3));
  state = wait_for_hits(3);
  EXPECT_EQ(state["taken"][2]["file"], "Ch1_0009.csv + Ch2_0009.csv");
  EXPECT_TRUE(state["waiting"].empty());
  EXPECT_EQ(state["good"], 3) << state["taken"];
  EXPECT_TRUE(state["frf"]["receptance_m_per_n"].contains("xx"));
  EXPECT_TRUE(state["frf"]["receptance_m_per_n"].contains("yy"));
  // frf makes the same of the document itself as of what the test saves.
  ask("POST", "/api/tap/save", {{"path", "saved/hits.toml"}});
  ask("POST", "/api/tap/save", {{"path", "tip.json"}});
  const modal::FrfSet kept = modal::read_frfs({place_.at("tip.json")}).set;
  for (const char* name : {"hits.toml", "saved/hits.toml"}) {
    const jobs::FrfJobResult read = jobs::run_frf({place_.at(name)});
    ASSERT_EQ(read.file.hits.size(), 3U) << name;
    ASSERT_EQ(read.frfs.set.frfs.size(), 2U) << name;
    for (const modal::Frf& frf : read.frfs.set.frfs) {
      const modal::Frf* const same = kept.find(frf.name);
      ASSERT_NE(same, nullptr) << name;
      EXPECT_LT((frf.receptance - same->receptance).norm(), 1e-12 * frf.receptance.norm()) << name;
    }
  }
}

}  // namespace tap_records_test
}  // namespace robomill::serve
