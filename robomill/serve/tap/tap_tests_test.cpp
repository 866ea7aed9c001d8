#include "robomill/serve/tap/tap_tests.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/random.hpp"
#include "robomill/io/system/confinement.hpp"
#include "robomill/jobs/frf.hpp"
#include "robomill/modal/files/frf_files.hpp"
#include "robomill/serve/error_json.hpp"
#include "testing/serve/hammer.hpp"
#include "testing/support.hpp"

namespace robomill::serve {
namespace tap_tests_test {

using nlohmann::json;
using test::HammerRecord;

constexpr double volt_per_n = -2.5e-3, volt_per_m_per_s2 = 10e-3;

// The force's sensor is wired the other way round. Channels of the stream: ay, force, ax.
constexpr const char* settings = R"([acquisition]
response = "acceleration"
sample_rate_hz = 8192
max_frequency_hz = 1000
frequency_resolution_hz = 2
force_mv_per_n = -2.5
response_mv_per_m_per_s2 = 10
[[hits]]
force = 2
force_direction = "x"
responses = { x = 3, y = 1 }
)";

/// A broker as far as a tap test sees one: who opens a stream gets what is sent.
class FakeBroker {
 public:
  OpenStream opener() {
    return [this](const monitor::MonitorFile& file, const StreamSink& sink,
                  const std::atomic<bool>&) -> std::shared_ptr<void> {
      if (file.mqtt.topic == "nobody") throw InvalidInput("mqtt://127.0.0.1:1883", "no connection within 10 s");
      EXPECT_EQ(file.columns.channels, (std::vector<std::string>{"2", "3", "1"}));
      EXPECT_EQ(file.options.channels, 3);
      const std::lock_guard lock(mutex_);
      queue_ = &sink.queue;
      return {nullptr, [this, own = queue_](void*) {
                const std::lock_guard closing(mutex_);
                if (queue_ == own) queue_ = nullptr;
              }};
    };
  }
  [[nodiscard]] bool is_open() {
    const std::lock_guard lock(mutex_);
    return queue_ != nullptr;
  }
  /// Channels picked as asked for: force, ax, ay, in volts.
  void send(const HammerRecord& record, Random& random) {
    live::Hop hop;
    for (std::size_t i = 0; i < record.force_n.size();) {
      const std::size_t end = std::min(record.force_n.size(), i + 1 + random.index(700));
      hop.samples.clear();
      for (; i < end; ++i) {
        hop.samples.push_back(static_cast<float>(volt_per_n * record.force_n[i]));
        hop.samples.push_back(static_cast<float>(volt_per_m_per_s2 * record.ax_m_per_s2[i]));
        hop.samples.push_back(static_cast<float>(volt_per_m_per_s2 * record.ay_m_per_s2[i]));
      }
      push(hop);
    }
  }
  void lose(std::uint64_t frames) {
    live::Hop hop;
    hop.frames_before = frames;
    push(hop);
  }

 private:
  void push(const live::Hop& hop) {
    const std::lock_guard lock(mutex_);
    if (queue_ != nullptr) queue_->push(live::Hop(hop));
  }
  std::mutex mutex_;
  live::HopQueue* queue_ = nullptr;
};

class TapTestsTest : public ::testing::Test {
 protected:
  TapTestsTest() {
    place_.file("hits.toml", settings);
    open(broker_.opener());
  }
  void open(OpenStream open_stream) {
    tests_ = std::make_unique<TapTests>(folder_, std::move(open_stream),
                                        [this](std::string_view event, std::string_view data) {
                                          const std::lock_guard lock(mutex_);
                                          published_.emplace_back(event, data);
                                        });
  }
  json ask(const char* method, const std::string& path, const json& body = nullptr, int status = 200) {
    const HttpResponse answer = answer_of(folder_.root(), [&] {
      return tests_->answer({.method = method, .path = path, .query = {}, .headers = {}, .body = body.dump()});
    });
    EXPECT_EQ(answer.status, status) << method << path << body << answer.body;
    EXPECT_EQ(answer.body.find(place_.path().string()), std::string::npos) << answer.body;
    return json::parse(answer.body, nullptr, false);
  }
  std::string error(const char* method, const std::string& path, const json& body, int status = 400) {
    return ask(method, path, body, status)["error"]["text"];
  }
  template <class Condition>
  json wait(const Condition& condition) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(1);
    for (;;) {
      json state = ask("GET", "/api/tap");
      if (condition(state)) return state;
      if (std::chrono::steady_clock::now() > end) {
        ADD_FAILURE() << "never was: " << state["taken"] << state["stream"];
        return state;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }
  json wait_for_hits(std::size_t taken) {
    return wait([&](const json& state) { return state["taken"].size() >= taken; });
  }
  json start(const json& more = json::object()) {
    json body = {{"hits", "hits.toml"}, {"stream", "mqtt://127.0.0.1/hammer"}};
    body.update(more);
    json state = ask("POST", "/api/tap", body)["state"];
    wait([&](const json&) { return broker_.is_open(); });
    return state;
  }
  void hit(double peak_n, double second_n = 0.0) {
    std::vector<test::Push> pushes = {{.at_s = 0.2, .peak_n = peak_n}};
    if (second_n > 0.0) pushes.push_back({.at_s = 0.24, .peak_n = second_n});
    broker_.send(HammerRecord(8192, pushes, ++seed_), random_);
  }

  test::Folder place_;
  Folder folder_{place_.path()};
  FakeBroker broker_;
  std::mutex mutex_;
  std::vector<std::pair<std::string, std::string>> published_;
  Random random_{3};
  std::uint64_t seed_ = 0;
  std::unique_ptr<TapTests> tests_;
};

TEST_F(TapTestsTest, TakesHitsOutOfAStream) {
  json state = start();
  EXPECT_EQ(state["force_direction"], "x");
  EXPECT_EQ(state["wanted"], 5);
  EXPECT_EQ(state["stream"]["record_s"], 0.5);
  hit(100.0);
  hit(140.0, 60.0);
  hit(80.0);
  state = wait_for_hits(3);
  EXPECT_EQ(state["good"], 2) << state["taken"];
  EXPECT_FALSE(state["taken"][1]["accepted"]);
  EXPECT_NE(state["taken"][1]["reasons"][0].get<std::string>().find("double hit"), std::string::npos);
  EXPECT_NEAR(state["taken"][0]["peak_force_n"], 100.0, 3.0);  // between two samples
  EXPECT_FALSE(state["frf"]["coherence"]["xx"].empty());
  const auto is_mode = [](const json& peak) {
    return peak["name"] == "xx" && std::abs(peak["frequency_hz"].get<double>() - HammerRecord::mode_hz) < 3.0;
  };
  EXPECT_TRUE(std::any_of(state["peaks"].begin(), state["peaks"].end(), is_mode)) << state["peaks"];
  // From now on in y, against the axis.
  EXPECT_EQ(ask("PUT", "/api/tap", {{"force_direction", "-y"}})["force_direction"], "-y");
  hit(120.0);
  state = wait_for_hits(4);
  EXPECT_EQ(state["taken"][3]["force_direction"], "-y");
  EXPECT_TRUE(state["taken"][3]["accepted"]) << state["taken"][3];
  EXPECT_TRUE(state["frf"]["receptance_m_per_n"].contains("xy"));
  // Samples that were lost take the record with them, and are counted.
  broker_.send(HammerRecord(3000, {{.at_s = 0.2, .peak_n = 90.0}}, 9), random_);
  broker_.lose(100);
  broker_.send(HammerRecord(4096, {}, 10), random_);  // while the structure may still move nothing is taken
  hit(110.0);
  state = wait_for_hits(5);
  state = wait([](const json& now) { return !now["stream"]["discarded"].empty(); });
  EXPECT_EQ(state["stream"]["discarded"][0]["count"], 1);
  EXPECT_EQ(state["stream"]["triggered"], 6);
  EXPECT_EQ(state["stream"]["status"], "receiving");
  ask("DELETE", "/api/tap");
  wait([&](const json& now) { return now.is_null() && !broker_.is_open(); });
  const std::lock_guard lock(mutex_);
  EXPECT_TRUE(
      std::any_of(published_.begin(), published_.end(), [](const auto& said) { return said.first == "tap-stream"; }));
}

TEST_F(TapTestsTest, ShowsEachHit) {
  start();
  hit(100.0);
  hit(100.0, 40.0);
  wait_for_hits(2);
  const json good = ask("GET", "/api/tap/1"), bad = ask("GET", "/api/tap/2");
  EXPECT_EQ(good["number"], 1);
  EXPECT_EQ(good["force"]["time_s"].size(), good["force"]["values"].size());
  EXPECT_LE(good["force"]["values"].size(), 420u);
  EXPECT_LE(good["responses"]["x"]["values"].size(), 420u);
  EXPECT_LE(good["frf"]["frequency_hz"].size(), 420u);
  EXPECT_LT(good.dump().size(), 60'000u);
  // What is drawn keeps the highest: the pulse's peak at time zero, the resonance.
  const std::vector<double> force = good["force"]["values"], time_s = good["force"]["time_s"];
  const auto peak = std::max_element(force.begin(), force.end());
  EXPECT_NEAR(*peak, 100.0, 3.0);
  EXPECT_EQ(time_s[static_cast<std::size_t>(peak - force.begin())], 0.0);
  const std::vector<double> size = good["frf"]["magnitude_m_per_n"]["xx"], lines = good["frf"]["frequency_hz"];
  const auto low = static_cast<std::ptrdiff_t>(std::lower_bound(lines.begin(), lines.end(), 100.0) - lines.begin());
  const auto top = std::max_element(size.begin() + low, size.end());
  EXPECT_NEAR(lines[static_cast<std::size_t>(top - size.begin())], HammerRecord::mode_hz, 4.0);
  // The second push of a double hit is drawn too; what was rejected has no FRF.
  double second = 0.0;
  for (std::size_t i = 0; i < bad["force"]["values"].size(); ++i) {
    if (bad["force"]["time_s"][i] > 0.02) second = std::max(second, bad["force"]["values"][i].get<double>());
  }
  EXPECT_NEAR(second, 40.0, 2.0);
  EXPECT_TRUE(bad["frf"].is_null());
  for (const char* none : {"/api/tap/0", "/api/tap/3", "/api/tap/x", "/api/tap/1x", "/api/tap/x/1", "/api/tap/1/1",
                           "/api/tap//1", "/api/tap/01", "/api/tap/save", "/api/tap/99999999999999999999999"}) {
    ask("GET", none, nullptr, 404);
  }
}

// Without a hit the average is that of the others; with it again it is what it was.
TEST_F(TapTestsTest, ExcludesAHitByHand) {
  start();
  hit(100.0);
  hit(70.0);
  hit(100.0, 40.0);
  const json three = wait_for_hits(3);
  EXPECT_EQ(three["good"], 2);
  EXPECT_TRUE(ask("PUT", "/api/tap/1", {{"accepted", false}})["excluded"]);
  const json one =
      wait([](const json& now) { return now["frf"]["coherence"].empty() || !now["frf"].contains("coherence"); });
  EXPECT_EQ(one["good"], 1);
  EXPECT_TRUE(one["taken"][0]["excluded"]);
  EXPECT_FALSE(one["taken"][0]["accepted"]);
  EXPECT_GT(one["revision"], three["revision"]);
  ask("PUT", "/api/tap/2", {{"accepted", false}});
  EXPECT_TRUE(wait([](const json& now) { return now["frf"].is_null(); })["peaks"].empty());
  EXPECT_NE(error("POST", "/api/tap/save", {{"path", "tip.json"}}).find("no accepted hit"), std::string::npos);
  ask("PUT", "/api/tap/1", {{"accepted", true}});
  ask("PUT", "/api/tap/2", {{"accepted", true}});
  EXPECT_TRUE(wait([&](const json& now) { return now["frf"] == three["frf"]; })["good"] == 2);
  // One that is rejected by itself stays so.
  EXPECT_NE(error("PUT", "/api/tap/3", {{"accepted", true}}).find("double hit"), std::string::npos);
  ask("PUT", "/api/tap/4", {{"accepted", true}}, 404);
}

/// The same numbers, to the last digit that a file holds.
void expect_same(const modal::FrfSet& one, const modal::FrfSet& other) {
  ASSERT_EQ(one.frequency_hz.size(), other.frequency_hz.size());
  EXPECT_LT((one.frequency_hz - other.frequency_hz).cwiseAbs().maxCoeff(), 1e-9);
  ASSERT_EQ(one.frfs.size(), other.frfs.size());
  for (const modal::Frf& frf : one.frfs) {
    const modal::Frf* const same = other.find(frf.name);
    ASSERT_NE(same, nullptr);
    EXPECT_LT((frf.receptance - same->receptance).norm(), 1e-12 * frf.receptance.norm());
    EXPECT_LT((frf.coherence - same->coherence).cwiseAbs().maxCoeff(), 1e-12);
  }
}

TEST_F(TapTestsTest, SavesWhatRobomillFrfReads) {
  start();
  hit(100.0);
  hit(70.0);
  hit(90.0, 40.0);
  hit(95.0);
  wait_for_hits(4);
  ask("PUT", "/api/tap", {{"force_direction", "-y"}});
  hit(80.0);
  hit(85.0);
  wait_for_hits(6);
  ask("PUT", "/api/tap/2", {{"accepted", false}});
  json files = ask("POST", "/api/tap/save", {{"path", "tapped/hits.toml"}})["files"];
  EXPECT_EQ(files, (json{"tapped/hits_x_1.csv", "tapped/hits_x_4.csv", "tapped/hits_y_5.csv", "tapped/hits_y_6.csv",
                         "tapped/hits.toml"}));
  ask("POST", "/api/tap/save", {{"path", "tip.json"}});
  const jobs::FrfJobResult read = jobs::run_frf({place_.at("tapped/hits.toml")});
  EXPECT_EQ(read.file.hits.size(), 4u);
  EXPECT_TRUE(read.file.hits[3].against_axis);
  expect_same(read.frfs.set, modal::read_frfs({place_.at("tip.json")}).set);
  for (const char* name : {"tip.uff", "tip.csv"}) {
    ask("POST", "/api/tap/save", {{"path", name}});
    EXPECT_EQ(modal::read_frfs({place_.at(name)}).set.frfs.size(), 4u);
  }
  // Nothing is overwritten unasked, and then nothing at all is written.
  const std::string before = Folder::read(place_.at("tip.json"));
  EXPECT_NE(error("POST", "/api/tap/save", {{"path", "tip.json"}}, 409).find("tip.json is there already"),
            std::string::npos);
  std::filesystem::remove(place_.at("tapped/hits.toml"));
  EXPECT_NE(error("POST", "/api/tap/save", {{"path", "tapped/hits.toml"}}, 409).find("hits_x_1.csv"),
            std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(place_.at("tapped/hits.toml")));
  ask("PUT", "/api/tap/1", {{"accepted", false}});
  ask("POST", "/api/tap/save", {{"path", "tip.json"}, {"replace", true}});
  EXPECT_NE(Folder::read(place_.at("tip.json")), before);
  for (const char* wrong : {"", "../tip.json", "/tmp/tip.json", ".tip.json", "tip", "tip.exe"}) {
    error("POST", "/api/tap/save", {{"path", wrong}});
  }
}

// Of files the document names them where they are; what the test writes into the folder is no hit.
TEST_F(TapTestsTest, SavesAFoldersHits) {
  place_.file("files.toml",
              "[acquisition]\nmax_frequency_hz = 1000\n[[hits]]\nfile = \"x_1.csv\"\nforce = \"force_n\"\n"
              "force_direction = \"x\"\nresponses = { x = \"ax_m_per_s2\", y = \"ay_m_per_s2\" }\n");
  ask("POST", "/api/tap", {{"hits", "files.toml"}});
  for (const char* name : {"x_1.csv", "x_2.csv"}) {
    test::appear(place_, name, HammerRecord(8192, {{.at_s = 0.05, .peak_n = 50.0}}, ++seed_).csv());
  }
  wait_for_hits(2);
  ask("POST", "/api/tap/save", {{"path", "tip.csv"}});
  ask("POST", "/api/tap/save", {{"path", "saved/hits.toml"}});
  ask("POST", "/api/tap/save", {{"path", "tip.json"}});
  expect_same(jobs::run_frf({place_.at("saved/hits.toml")}).frfs.set, modal::read_frfs({place_.at("tip.json")}).set);
  test::appear(place_, "x_3.csv", HammerRecord(8192, {{.at_s = 0.05, .peak_n = 50.0}}, ++seed_).csv());
  const json state = wait_for_hits(3);
  EXPECT_EQ(state["taken"].size(), 3u);
  EXPECT_EQ(state["taken"][2]["file"], "x_3.csv");
  EXPECT_TRUE(state["stream"].is_null());
  EXPECT_NE(error("PUT", "/api/tap", {{"force_direction", "y"}}).find("out of a stream"), std::string::npos);
}

TEST_F(TapTestsTest, RejectsWhatCannotBe) {
  const auto begin = [this](const json& more) {
    json body = {{"hits", "hits.toml"}, {"stream", "mqtt://127.0.0.1/hammer"}};
    body.update(more);
    return error("POST", "/api/tap", body);
  };
  EXPECT_NE(begin({{"stream", "http://x/y"}}).find("mqtt://HOST"), std::string::npos);
  EXPECT_NE(begin({{"stream", "mqtt://x"}}).find("names no topic"), std::string::npos);
  EXPECT_NE(begin({{"watch", "folder"}}).find("watch"), std::string::npos);
  EXPECT_NE(begin({{"force_direction", "rx"}}).find("is no direction"), std::string::npos);
  EXPECT_NE(begin({{"force_direction", std::string(100000, 'x')}}).find("is no direction"), std::string::npos);
  EXPECT_NE(begin({{"trigger_level_n", -1}}).find("trigger_level_n"), std::string::npos);
  EXPECT_NE(begin({{"wanted", 1e30}}).find("wanted"), std::string::npos);
  EXPECT_NE(begin({{"record_s", 1e-3}}).find("at least 512"), std::string::npos);
  EXPECT_NE(begin({{"record_s", 900}}).find("values may be in a record"), std::string::npos);
  begin({{"trigger_level_n", "loud"}});
  std::string text = settings;
  place_.file("hits.toml", text.replace(text.find("sample_rate_hz = 8192"), 21, ""));
  EXPECT_EQ(begin(json::object()), "hits.toml: acquisition.sample_rate_hz: must be given for a stream");
  place_.file("hits.toml",
              std::string(settings) + "[[hits]]\nforce = 4\nforce_direction = \"y\"\nresponses = { x = 3 }\n");
  EXPECT_NE(begin(json::object()).find("one hammer"), std::string::npos);
  // Without a test there is nothing to change.
  error("PUT", "/api/tap", {{"force_direction", "y"}}, 404);
  error("PUT", "/api/tap/1", {{"accepted", false}}, 404);
  error("POST", "/api/tap/save", {{"path", "tip.json"}}, 404);
  place_.file("hits.toml", settings);
  start();
  for (const json& body : {json(nullptr), json(1), json::array(), json::object(), json{{"force_direction", 7}}}) {
    error("PUT", "/api/tap", body);
    error("POST", "/api/tap/save", body);
  }
  EXPECT_NE(error("PUT", "/api/tap", {{"force_direction", ""}}).find("is no direction"), std::string::npos);
  open({});
  EXPECT_NE(begin(json::object()).find("this server takes none"), std::string::npos);
}

// What cannot begin does not end what is there, whose hits may not be saved yet.
TEST_F(TapTestsTest, KeepsItsTestWhereAnotherCannotBegin) {
  const int id = start()["id"];
  hit(100.0);
  wait_for_hits(1);
  for (const json& more : {json{{"stream", "http://x/y"}}, json{{"stream", ""}, {"watch", "none"}},
                           json{{"force_direction", "rx"}}, json{{"record_s", 1e-3}}}) {
    json body = {{"hits", "hits.toml"}, {"stream", "mqtt://127.0.0.1/hammer"}};
    body.update(more);
    error("POST", "/api/tap", body);
  }
  place_.file("wrong.toml", "[acquisition]\n");
  error("POST", "/api/tap", {{"hits", "wrong.toml"}});
  hit(80.0);
  const json state = wait_for_hits(2);
  EXPECT_EQ(state["id"], id);
  EXPECT_EQ(state["good"], 2);
  // One that can takes its place, and an event says so.
  EXPECT_EQ(start()["id"], id + 1);
  const std::lock_guard lock(mutex_);
  const auto last =
      std::find_if(published_.rbegin(), published_.rend(), [](const auto& said) { return said.first == "tap"; });
  ASSERT_NE(last, published_.rend());
  EXPECT_EQ(json::parse(last->second)["id"], id + 1);
}

// Nor does it say whether the file is there.
TEST_F(TapTestsTest, RejectsRowsThatNameFilesElsewhere) {
  const io::Confinement confinement(place_.path());
  for (const char* file : {"../none.csv", "/etc/hostname", "/none.csv"}) {
    place_.file("hits.toml", std::string(settings) + "file = \"" + file + "\"\n");
    EXPECT_NE(error("POST", "/api/tap", {{"hits", "hits.toml"}}).find("outside the folder"), std::string::npos);
  }
}

TEST_F(TapTestsTest, RejectsJsonThatNestsDeeply) {
  start();
  const std::string deep = std::string(500'000, '[') + std::string(500'000, ']');
  for (const auto& [method, path] :
       {std::pair("POST", "/api/tap"), std::pair("PUT", "/api/tap"), std::pair("PUT", "/api/tap/1")}) {
    const HttpResponse answer = answer_of(folder_.root(), [&, method = method, path = path] {
      return tests_->answer({.method = method, .path = path, .query = {}, .headers = {}, .body = deep});
    });
    EXPECT_EQ(answer.status, 400);
    EXPECT_NE(answer.body.find("nests"), std::string::npos) << answer.body;
  }
}

TEST_F(TapTestsTest, SaysThatThereIsNoConnection) {
  ask("POST", "/api/tap", {{"hits", "hits.toml"}, {"stream", "mqtt://127.0.0.1/nobody"}});
  const json state = wait([](const json& now) { return now["stream"]["status"] == "failed"; });
  EXPECT_EQ(state["stream"]["error"].size(), 8U) << state["stream"]["error"];
  EXPECT_NE(state["stream"]["error"]["text"].get<std::string>().find("no connection"), std::string::npos);
  EXPECT_TRUE(state["taken"].empty());
}

}  // namespace tap_tests_test
}  // namespace robomill::serve
