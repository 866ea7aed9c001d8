#include "robomill/serve/monitor/sessions.hpp"

#include <gtest/gtest.h>
#include <malloc.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/base/units.hpp"
#include "robomill/io/sample_source.hpp"
#include "robomill/live/hop_queue.hpp"
#include "robomill/serve/error_json.hpp"
#include "robomill/serve/monitor/paced_source.hpp"
#include "testing/serve/http_client.hpp"
#include "testing/support.hpp"

namespace robomill::serve {
namespace monitor_sessions_test {

using nlohmann::json;
using test::rejection;

constexpr double rate_hz = 10'240.0, chatter_hz = 683.0;
/// Two minutes of a recording take one and more under ThreadSanitizer; only what hangs takes this long.
constexpr std::chrono::minutes longest_wait{10};
constexpr const char* config =
    "[signal]\nsample_rate_hz = 10240\nchannels = [\"ax_m_per_s2\"]\n[process]\nspindle_speed_rpm = 3000\nteeth = 2\n";

/// A cut at 3000 rpm with two teeth, and noise; it chatters between two times, at an amplitude that grows until it
/// stands.
std::vector<float> cut(double seconds, double from_s, double to_s, double line_hz = chatter_hz,
                       double at_hz = rate_hz) {
  Random random(42);
  std::vector<float> samples;
  const auto count = static_cast<std::size_t>(seconds * at_hz);
  for (std::size_t i = 0; i < count; ++i) {
    const double t = static_cast<double>(i) / at_hz;
    double x = 0.3 * random.normal();
    for (int k = 1; k <= 6; ++k) x += 4.0 / k * std::sin(2.0 * std::numbers::pi * 50.0 * k * t + k);
    if (t > from_s && t < to_s) {
      x += std::min(20.0, 0.02 * std::exp((t - from_s) / 0.05)) * std::sin(2.0 * std::numbers::pi * line_hz * t);
    }
    samples.push_back(static_cast<float>(x));
  }
  return samples;
}

/// Decibels re 1 of a band, as the page reads them.
int level_db(const json& frame, std::size_t band) {
  constexpr std::string_view letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
  const std::string spectrum = frame["spectrum"];
  return frame["peak_db"].get<int>() - 63 + static_cast<int>(letters.find(spectrum[band]));
}

std::size_t band_of(const json& edges_hz, double frequency_hz) {
  std::size_t band = 0;
  while (edges_hz[band + 1] < frequency_hz) ++band;
  return band;
}

/// A folder with a monitor.toml, and sessions that are asked as clients ask them.
class MonitorSessionsTest : public ::testing::Test {
 protected:
  MonitorSessionsTest() {
    place_.file("monitor.toml", config);
    open();
  }
  void open(OpenStream open_stream = {}) {
    sessions_ = std::make_unique<MonitorSessions>(folder_, std::move(open_stream),
                                                  [this](std::string_view event, std::string_view data) {
                                                    const std::lock_guard lock(mutex_);
                                                    published_.emplace_back(event, data);
                                                  });
  }
  json ask(const std::string& method, const std::string& path, const json& body = nullptr, int status = 200) {
    const HttpRequest request = {
        .method = method, .path = path, .query = {}, .headers = {}, .body = body.is_null() ? "" : body.dump()};
    const HttpResponse answer = answer_of(folder_.root(), [&] { return sessions_->answer(request); });
    EXPECT_EQ(answer.status, status) << answer.body;
    return json::parse(answer.body);
  }
  int start(const std::string& input, double speed = 1.0) {
    return ask("POST", "/api/monitors", {{"config", "monitor.toml"}, {"input", input}, {"speed", speed}})["id"];
  }
  [[nodiscard]] std::string error_of(const json& body) {
    return ask("POST", "/api/monitors", body, 400)["error"]["text"];
  }
  /// Until it is so, or the session has ended; fails after the longest wait.
  json wait_for(int id, const std::function<bool(const json&)>& there) {
    const auto end = std::chrono::steady_clock::now() + longest_wait;
    for (;;) {
      json all = ask("GET", "/api/monitors/" + std::to_string(id));
      if (there(all) || all["status"] == "done" || all["status"] == "failed") return all;
      if (std::chrono::steady_clock::now() > end) {
        ADD_FAILURE() << "never was: " << all.dump().substr(0, 2000);
        return all;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }
  static bool wait_until(const std::function<bool()>& there) {
    const auto end = std::chrono::steady_clock::now() + longest_wait;
    while (!there()) {
      if (std::chrono::steady_clock::now() > end) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return true;
  }
  json wait_for_end(int id, const std::string& status) {
    json all = wait_for(id, [](const json&) { return false; });
    EXPECT_EQ(all["status"], status) << all["error"];
    return all;
  }
  [[nodiscard]] std::vector<json> published(const std::string& event) {
    const std::lock_guard lock(mutex_);
    std::vector<json> out;
    for (const auto& [name, data] : published_) {
      if (name == event) out.push_back(json::parse(data));
    }
    return out;
  }

  test::Folder place_;
  Folder folder_{place_.path()};
  std::mutex mutex_;
  std::vector<std::pair<std::string, std::string>> published_;
  std::unique_ptr<MonitorSessions> sessions_;
};

TEST_F(MonitorSessionsTest, FindsTheChatterOfARecording) {
  io::write_wav(place_.at("cut.wav"), cut(120.0, 80.0, 90.0), 1, rate_hz);
  const int id = start("cut.wav", 50.0);
  const json all = wait_for_end(id, "done");
  EXPECT_EQ(all["input"], "cut.wav");
  EXPECT_EQ(all["alarm_count"], 1);
  EXPECT_EQ(all["decision_count"], 120 * 40);
  EXPECT_TRUE(all["error"].is_null());
  // The newest first; at the start nothing calm had been seen yet.
  ASSERT_EQ(all["alarms"].size(), 2U) << all["alarms"];
  EXPECT_EQ(all["alarms"][1]["kind"], "blind");
  EXPECT_EQ(all["alarms"][1]["reason"], "learning");
  EXPECT_LE(all["alarms"][1]["to_s"].get<double>(), 3.0);
  const json& alarm = all["alarms"][0];
  EXPECT_EQ(alarm["kind"], "chatter");
  EXPECT_NEAR(alarm["from_s"], 80.3, 0.3);
  EXPECT_NEAR(alarm["to_s"], 90.4, 0.2);  // the window, and what an alarm outlasts its line by
  EXPECT_NEAR(alarm["chatter_frequency_hz"], chatter_hz, 1.0);
  EXPECT_GT(alarm["score"], 1.0);
  EXPECT_GE(alarm["why"]["hops"].get<int>(), alarm["why"]["of"].get<int>()) << alarm["why"];
  EXPECT_FALSE(all["why"]["conditions"].empty());  // of silence at the end
  // The strongest band of the frames in chatter is that of its frequency, at its amplitude.
  const std::size_t bands = all["edges_hz"].size() - 1;
  EXPECT_LE(bands, LiveSpectrum::most_bands);
  EXPECT_NEAR(all["edges_hz"].back(), rate_hz / 2.0, 20.0);
  const std::size_t there = band_of(all["edges_hz"], chatter_hz);
  int chattering = 0;
  for (const json& message : published("monitor")) {
    const json& frame = message["frame"];
    EXPECT_EQ(message["id"], id);
    EXPECT_TRUE(message.contains("why"));
    // Before, the speed is not known yet ("speed-unknown").
    if (frame["time_s"] > 1.0) {
      EXPECT_NEAR(frame["spindle_speed_rpm"], 3000.0, 3.0);
    }
    if (frame["spectrum"].is_null()) continue;
    ASSERT_EQ(frame["spectrum"].get<std::string>().size(), bands);
    if (frame["state"] != "chatter") {
      // Chatter that has begun is louder before it is detected.
      const double time_s = frame["time_s"];
      if (time_s <= 80.0 || time_s >= 80.6) {
        EXPECT_LE(level_db(frame, there), 0) << time_s;
      }
      continue;
    }
    ++chattering;
    if (frame["time_s"] > 82.0 && frame["time_s"] < 90.0) {
      EXPECT_NEAR(level_db(frame, there), 26, 1);  // 20 m/s²
    }
  }
  EXPECT_GE(chattering, 1);
  EXPECT_LE(all["frames"].size(), FrameRing::most_frames);
  EXPECT_FALSE(all["frames"].empty());
  EXPECT_GE(published("monitors").size(), 3U);  // begun, running, done
}

// The page shows no alarm that lasts after the recording is over.
TEST_F(MonitorSessionsTest, SaysThatTheLastAlarmIsOver) {
  io::write_wav(place_.at("cut.wav"), cut(3.0, 1.0, 9.0), 1, rate_hz);
  const json all = wait_for_end(start("cut.wav", 50.0), "done");
  ASSERT_EQ(all["alarms"].size(), 2U);  // before it the time in which it learnt
  EXPECT_EQ(all["alarms"][0]["kind"], "chatter");
  EXPECT_EQ(all["alarms"][0]["to_s"], 3.0);
  json row;
  for (const json& message : published("monitor")) {
    for (const json& changed : message["alarms"]) {
      if (changed["kind"] == "chatter") row = changed;
    }
  }
  EXPECT_EQ(row, all["alarms"][0]);
}

TEST_F(MonitorSessionsTest, SaysWhatItAssumedAndWhatIsUnusual) {
  io::write_wav(place_.at("cut.wav"), cut(1.0, 9.0, 9.0), 1, rate_hz);
  place_.file("monitor.toml",
              "[signal]\nsample_rate_hz = 10240\nchannels = [\"ax_m_per_s2\"]\n[process]\n"
              "spindle_speed_rpm = 3000  # sample 3000: of the cut\nteeth = 2\n"
              "[detector]\nfalse_alarms_per_hour = 1000\n");
  const json all = wait_for_end(start("cut.wav", 50.0), "done");
  ASSERT_EQ(all["assumed"].size(), 1U) << all["assumed"];
  EXPECT_EQ(all["assumed"][0]["key"], "process.spindle_speed_rpm");
  ASSERT_EQ(all["warnings"].size(), 1U) << all["warnings"];
  const std::string warning = all["warnings"][0];
  EXPECT_TRUE(warning.starts_with("monitor.toml:8: detector.false_alarms_per_hour = 1000 ")) << warning;
}

TEST_F(MonitorSessionsTest, SendsAtMostTenFramesASecond) {
  io::write_wav(place_.at("cut.wav"), cut(60.0, 100.0, 100.0), 1, rate_hz);
  const json all = wait_for_end(start("cut.wav", 50.0), "done");
  const double seconds = all["clock_s"];
  EXPECT_GE(seconds, 60.0 / 50.0 - 0.3);
  EXPECT_LE(static_cast<double>(published("monitor").size()), 10.0 * seconds + 2.0);
}

TEST_F(MonitorSessionsTest, RejectsWhatCannotBegin) {
  place_.file("lobes.toml", "[tool]\nteeth = 2\n");
  place_.file("wrong.toml", "[signal]\nchannels = [\"ax\"]\n[process]\nteeth = -2\n");
  place_.file("text.csv", "time_s,ay\n0,1\n1,2\n");
  io::write_wav(place_.at("slow.wav"), cut(1.0, 9.0, 9.0), 1, 5120.0);
  const auto error = [&](const char* file, const char* input, double speed = 1.0) {
    return error_of({{"config", file}, {"input", input}, {"speed", speed}});
  };
  EXPECT_NE(error("none.toml", "cut.wav").find("none.toml"), std::string::npos);
  EXPECT_NE(error("wrong.toml", "text.csv").find("wrong.toml:4: process.teeth"), std::string::npos);
  EXPECT_NE(error("lobes.toml", "text.csv").find("lobes.toml"), std::string::npos);
  EXPECT_NE(error("monitor.toml", "none.wav").find("none.wav"), std::string::npos);
  EXPECT_NE(error("monitor.toml", "text.csv").find("ax_m_per_s2"), std::string::npos);
  EXPECT_NE(error("monitor.toml", "slow.wav").find("5120"), std::string::npos);
  EXPECT_NE(error("monitor.toml", "").find("mqtt.topic"), std::string::npos);
  EXPECT_NE(error("monitor.toml", "mqtt://127.0.0.1/samples").find("takes none"), std::string::npos);
  EXPECT_NE(error("monitor.toml", "mqtt:///samples").find("mqtt"), std::string::npos);
  EXPECT_NE(error("monitor.toml", "../cut.wav").find("upwards"), std::string::npos);
  EXPECT_NE(error("monitor.toml", "slow.wav", 51.0).find("between 1 and 50"), std::string::npos);
  EXPECT_NE(error("monitor.toml", "slow.wav", 0.0).find("between 1 and 50"), std::string::npos);
  ask("POST", "/api/monitors", json::object(), 400);
  ask("GET", "/api/monitors/1", nullptr, 404);
  ask("DELETE", "/api/monitors/x", nullptr, 404);
  const HttpResponse deep = answer_of(folder_.root(), [&] {
    return sessions_->answer({.method = "POST",
                              .path = "/api/monitors",
                              .query = {},
                              .headers = {},
                              .body = std::string(500'000, '[') + std::string(500'000, ']')});
  });
  EXPECT_EQ(deep.status, 400);
  EXPECT_NE(deep.body.find("nests"), std::string::npos) << deep.body;
  EXPECT_TRUE(ask("GET", "/api/monitors").empty());
}

TEST_F(MonitorSessionsTest, RunsSeveralAndStopsThem) {
  io::write_wav(place_.at("cut.wav"), cut(60.0, 100.0, 100.0), 1, rate_hz);
  io::write_wav(place_.at("short.wav"), cut(2.0, 100.0, 100.0), 1, rate_hz);
  std::vector<int> ids = {start("short.wav", 50.0)};
  for (std::size_t i = 1; i < MonitorSessions::most; ++i) ids.push_back(start("cut.wav"));
  wait_for_end(ids.front(), "done");
  for (std::size_t i = 1; i < ids.size(); ++i) {
    wait_for(ids[i], [](const json& all) { return !all["frame"].is_null(); });
  }
  // One that has ended makes room, one that runs does not.
  ids.push_back(start("cut.wav"));
  ask("GET", "/api/monitors/" + std::to_string(ids.front()), nullptr, 404);
  const json body = {{"config", "monitor.toml"}, {"input", "cut.wav"}};
  ask("POST", "/api/monitors", body, 429);
  EXPECT_EQ(ask("GET", "/api/monitors").size(), MonitorSessions::most);
  for (const char* path : {"x/", "/", "0", ""}) {
    ask("DELETE", "/api/monitors/" + std::string(path) + std::to_string(ids[3]), nullptr,
        std::string(path).empty() ? 200 : 404);
  }
  ids[3] = start("cut.wav");
  EXPECT_EQ(ask("DELETE", "/api/monitors/" + std::to_string(ids[3])).size(), MonitorSessions::most - 1);
  EXPECT_EQ(ask("POST", "/api/monitors", body)["id"], ids[3] + 1);
  sessions_.reset();  // a minute before they would have ended
}

// What a broker does, and what it may fail at.
TEST_F(MonitorSessionsTest, TakesStreams) {
  std::atomic<int> open_streams{0};
  open([&](const monitor::MonitorFile& file, const StreamSink& sink, const std::atomic<bool>&) {
    EXPECT_TRUE(file.mqtt.events_topic.empty() && file.mqtt.commands_topic.empty());
    if (file.mqtt.topic == "nobody") throw InvalidInput("mqtt://127.0.0.1:1883", "no connection within 10 s");
    for (int i = 0; i < 40; ++i) sink.queue.push({.samples = std::vector<float>(256, static_cast<float>(i % 2))});
    ++open_streams;
    return std::shared_ptr<void>(nullptr, [&](void*) { --open_streams; });
  });
  place_.file("monitor.toml",
              std::string(config) + "[mqtt]\ntopic = \"spindle\"\nevents_topic = \"e\"\ncommands_topic = \"c\"\n");
  const int id = start("");
  json all = wait_for(id, [](const json& now) { return now["decision_count"] == 40; });
  EXPECT_EQ(all["input"], "mqtt://127.0.0.1:1883/spindle");
  EXPECT_TRUE(all["speed"].is_null());
  // Nothing comes any more: that is no stable cut.
  all = wait_for(id, [](const json& now) { return !now["frame"].is_null() && now["frame"]["reason"] == "no-signal"; });
  EXPECT_EQ(all["frame"]["state"], "blind");
  EXPECT_EQ(all["alarms"][0]["kind"], "blind");
  EXPECT_EQ(open_streams, 1);
  ask("DELETE", "/api/monitors/" + std::to_string(id));
  EXPECT_TRUE(wait_until([&] { return open_streams == 0; }));
  all = wait_for_end(start("mqtt://127.0.0.1/nobody"), "failed");
  EXPECT_NE(all["error"]["text"].get<std::string>().find("no connection"), std::string::npos);
}

// A gateway pauses right after the last samples, and the time-out is long: what they said is shown all the same.
TEST_F(MonitorSessionsTest, ShowsWhatCameLastBeforeAPause) {
  open([&](const monitor::MonitorFile&, const StreamSink& sink, const std::atomic<bool>&) {
    const std::vector<float> samples = cut(1.0, 0.5, 9.0);
    for (std::size_t at = 0; at + 256 <= samples.size(); at += 256) {
      sink.queue.push({.samples = std::vector<float>(samples.begin() + static_cast<std::ptrdiff_t>(at),
                                                     samples.begin() + static_cast<std::ptrdiff_t>(at + 256))});
    }
    return std::shared_ptr<void>();
  });
  std::string patient = config;
  place_.file("monitor.toml", patient.replace(patient.find("[process]"), 0, "timeout_s = 3600\n"));
  const json all = wait_for(start("mqtt://127.0.0.1/spindle"),
                            [](const json& now) { return !now["frame"].is_null() && now["frame"]["time_s"] == 1.0; });
  EXPECT_EQ(all["frame"]["state"], "chatter");
  EXPECT_EQ(published("monitor").back()["frame"]["time_s"], 1.0);
}

// A broker may keep who leaves it waiting for seconds: nobody else waits with it, and nothing is said of it any more.
TEST_F(MonitorSessionsTest, WaitsForNoneThatEnds) {
  std::promise<void> let_go;
  const std::shared_future<void> gone = let_go.get_future().share();
  std::atomic<int> opened{0}, closed{0};
  std::atomic<bool> late{false};
  open([&](const monitor::MonitorFile&, const StreamSink&, const std::atomic<bool>&) {
    ++opened;
    return std::shared_ptr<void>(nullptr, [&](void*) {
      if (gone.wait_for(std::chrono::seconds(30)) != std::future_status::ready) late = true;
      ++closed;
    });
  });
  const int id = start("mqtt://127.0.0.1/spindle");
  ASSERT_TRUE(wait_until([&] { return opened == 1; }));
  EXPECT_TRUE(ask("DELETE", "/api/monitors/" + std::to_string(id)).empty());
  EXPECT_EQ(closed, 0);
  const std::size_t messages = published("monitors").size();
  let_go.set_value();
  ASSERT_TRUE(wait_until([&] { return closed == 1; }));
  open();
  EXPECT_EQ(published("monitors").size(), messages);
  EXPECT_FALSE(late);
}

// A stream that says of its spindle that it hardly turns, as fast as it is taken: ended within a hop.
TEST_F(MonitorSessionsTest, EndsAtOnceWhateverTheSpeed) {
  std::atomic<bool> let_go{false};
  open([&](const monitor::MonitorFile&, const StreamSink& sink, const std::atomic<bool>&) {
    auto sender = std::make_shared<std::jthread>([queue = &sink.queue, samples = cut(1.0, 9.0, 9.0)] {
      for (std::size_t at = 0;; at = (at + 256) % (samples.size() - 256)) {
        live::Hop hop{.samples = std::vector<float>(samples.begin() + static_cast<std::ptrdiff_t>(at),
                                                    samples.begin() + static_cast<std::ptrdiff_t>(at + 256)),
                      .spindle_speed_rad_per_s = 0.05 * units::rpm};
        if (!queue->push(std::move(hop))) return;
      }
    });
    return std::shared_ptr<void>(sender.get(), [sender, &let_go](void*) mutable {
      sender.reset();
      let_go = true;
    });
  });
  const auto begin = std::chrono::steady_clock::now();
  const int id = start("mqtt://127.0.0.1/spindle");
  const json all = wait_for(id, [](const json& now) { return now["decision_count"] > 200; });
  EXPECT_EQ(all["frame"]["state"], "blind");
  // A machine that does not keep up with the sender says so.
  EXPECT_TRUE(all["frame"]["reason"] == "standstill" || all["frame"]["reason"] == "overloaded") << all["frame"];
  const auto asked = std::chrono::steady_clock::now();
  EXPECT_LT(asked - begin, std::chrono::seconds(30));
  ask("DELETE", "/api/monitors/" + std::to_string(id));
  EXPECT_TRUE(wait_until([&] { return let_go.load(); }));
  EXPECT_LT(std::chrono::steady_clock::now() - asked, std::chrono::seconds(2));
}

TEST_F(MonitorSessionsTest, FilesThatMonitorTomlNamesAreReadOnItsThread) {
  io::write_wav(place_.at("cut.wav"), cut(2.0, 100.0, 100.0), 1, rate_hz);
  place_.file("monitor.toml", std::string(config) + "modes = \"none.toml\"\n");
  const json all = wait_for_end(start("cut.wav"), "failed");
  EXPECT_NE(all["error"]["text"].get<std::string>().find("none.toml"), std::string::npos);
  EXPECT_EQ(all["error"]["text"].get<std::string>().find(place_.path().string()), std::string::npos);
}

TEST_F(MonitorSessionsTest, IsServed) {
  io::write_wav(place_.at("cut.wav"), cut(20.0, 5.0, 15.0), 1, rate_hz);
  auto server = std::make_unique<Server>(ServeOptions{.folder = place_.path(), .port = 0});
  const std::string page = test::http_ask(server->port(), "GET", "/").body;
  const std::string mark = "id=\"serve-config\">";
  const std::size_t begin = page.find(mark) + mark.size();
  const std::string token = json::parse(page.substr(begin, page.find("</script>", begin) - begin)).at("token");
  const auto send = [&](const char* method, const std::string& path, const std::string& body) {
    return test::http_ask(server->port(), method, path, {{"X-Robomill-Token", token}}, body);
  };
  test::HttpConnection events(server->port());
  events.send(test::http_text(server->port(), "GET", "/api/events"));
  ASSERT_TRUE(events.wait_for("text/event-stream"));
  const test::HttpAnswer begun =
      send("POST", "/api/monitors", R"({"config":"monitor.toml","input":"cut.wav","speed":20})");
  EXPECT_EQ(begun.status, 200) << begun.body;
  ASSERT_TRUE(events.wait_for("event: monitors"));
  ASSERT_TRUE(events.wait_for("event: monitor\ndata: {\"id\":1"));
  ASSERT_TRUE(events.wait_for("\"state\":\"chatter\""));
  EXPECT_EQ(json::parse(test::http_ask(server->port(), "GET", "/api/monitors").body).size(), 1U);
  EXPECT_EQ(send("DELETE", "/api/monitors/1", "").status, 200);
  EXPECT_EQ(send("GET", "/api/monitors/1", "").status, 404);
  EXPECT_EQ(send("PUT", "/api/monitors", "{}").status, 405);
  EXPECT_EQ(send("POST", "/api/monitors", R"({"config":"monitor.toml","input":"cut.wav"})").status, 200);
  server.reset();  // with a session that runs
}

/// The same minute again and again.
class EndlessMinute : public io::SampleSource {
 public:
  EndlessMinute(std::vector<float> minute, std::uint64_t frames, double at_hz)
      : minute_(std::move(minute)), left_(frames) {
    sample_rate_hz_ = at_hz;
  }
  bool next(std::size_t frames, io::SampleBlock& block) override {
    const std::size_t count = std::min({frames, minute_.size() - at_, static_cast<std::size_t>(left_)});
    const auto begin = minute_.begin() + static_cast<std::ptrdiff_t>(at_);
    block.samples.assign(begin, begin + static_cast<std::ptrdiff_t>(count));
    at_ = (at_ + count) % minute_.size();
    left_ -= count;
    return count > 0;
  }

 private:
  std::vector<float> minute_;
  std::uint64_t left_;
  std::size_t at_ = 0;
};

// Eight hours in which it chatters each minute; what it holds on the heap after an hour is what it holds in the end.
TEST(MonitorSession, TakesNoMoreMemoryWithTime) {
  constexpr double slow_hz = 2048.0;
  const auto minutes = static_cast<std::uint64_t>(test::seeds(480));
  MonitorInput input;
  input.file.columns.channels = {"ax"};
  input.file.options = {.sample_rate_hz = slow_hz, .spindle_speed_rad_per_s = 3000.0 * units::rpm, .teeth = 2};
  input.recording = std::make_unique<EndlessMinute>(cut(60.0, 20.0, 25.0, 383.0, slow_hz),
                                                    minutes * static_cast<std::uint64_t>(60.0 * slow_hz), slow_hz);
  std::atomic<std::size_t> messages{0}, longest{0};
  MonitorSession session({.id = 1, .speed = 0.0}, std::move(input), [&](std::string_view, std::string_view data) {
    ++messages;
    longest = std::max(longest.load(), data.size());
  });
  const auto held = [] { return static_cast<double>(::mallinfo2().uordblks); };
  const auto wait_for_alarms = [&](std::uint64_t count) {
    while (!session.over() && session.summary().value("alarm_count", std::uint64_t{0}) < count) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  };
  wait_for_alarms(minutes / 8);
  const double early = held();
  wait_for_alarms(minutes);
  const double late = held();
  while (!session.over()) std::this_thread::sleep_for(std::chrono::milliseconds(20));
  const io::Json all = session.all();
  EXPECT_EQ(all["alarm_count"], minutes);
  // With the time in which it learnt.
  EXPECT_EQ(all["alarms"].size(), std::min<std::size_t>(minutes + 1, MonitorHistory::most_rows));
  EXPECT_LT(late - early, 2e6);  // what the ring of frames and the history still take
  EXPECT_LT(longest, 20'000U);
}

TEST(FrameRing, HoldsTenMinutesASecondEach) {
  FrameRing ring(false);
  for (int i = 0; i < 20'000; ++i) {
    MonitorFrame frame;
    frame.clock_s = 0.1 * i + 0.01;
    frame.score = i % 10 == 3 ? 2.0 : 0.5;
    frame.threshold = 1.0;
    frame.state = i % 10 == 3 ? monitor::State::chatter : monitor::State::stable;
    frame.amplitude = {1.0F, i % 10 == 7 ? 5.0F : 2.0F};
    ring.add(frame);
  }
  ASSERT_EQ(ring.frames().size(), FrameRing::most_frames);
  for (const MonitorFrame& frame : ring.frames()) {
    EXPECT_EQ(frame.state, monitor::State::chatter);
    EXPECT_EQ(frame.score, 2.0);
    EXPECT_EQ(frame.amplitude[1], 5.0F);
  }
  MonitorFrame late;
  late.clock_s = 1e5;
  ring.add(late);
  EXPECT_EQ(ring.frames().size(), 1U);  // of the minutes before nothing is left
}

TEST(FrameJson, HasTheSpectrumInLetters) {
  MonitorFrame frame;
  frame.amplitude = {1e-9F, 0.1F, 10.0F, 0.0F};
  json out = json::parse(frame_json(frame).dump());
  EXPECT_EQ(out["peak_db"], 20);
  EXPECT_EQ(level_db(out, 0), 20 - 63);
  EXPECT_EQ(level_db(out, 1), -20);
  EXPECT_EQ(level_db(out, 2), 20);
  EXPECT_TRUE(out["score"].is_null());
  frame.amplitude = {0.0F, 0.0F};
  out = json::parse(frame_json(frame).dump());
  EXPECT_TRUE(out["spectrum"].is_null());
}

TEST(PacedSource, ComesByTheClockAndCanBeEnded) {
  using Clock = std::chrono::steady_clock;
  const std::vector<float> samples(1000, 1.0F);
  std::stop_source stop;
  const Clock::time_point begin = Clock::now();
  PacedSource quick(std::make_unique<EndlessMinute>(samples, 1000, 100.0), 1, 5000.0, stop.get_token());
  EXPECT_EQ(quick.sample_rate_hz(), 100.0);
  io::SampleBlock block;
  std::size_t count = 0;
  while (quick.next(100, block)) count += block.samples.size();
  EXPECT_EQ(count, 1000U);
  EXPECT_GE(Clock::now() - begin, std::chrono::milliseconds(170));  // the last hundred of 0.2 s are due after 0.18 s
  PacedSource slow(std::make_unique<EndlessMinute>(samples, 1000, 100.0), 1, 1e-3, stop.get_token());
  EXPECT_TRUE(slow.next(100, block));
  std::jthread other([&] { stop.request_stop(); });
  EXPECT_FALSE(slow.next(100, block));  // a day later it would be true
}

}  // namespace monitor_sessions_test
}  // namespace robomill::serve
