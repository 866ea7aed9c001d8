// Notices, the ring of the last seconds, metrics, the line of --watch.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <numeric>
#include <string>
#include <vector>

#include "alarm_ring.hpp"
#include "http_get.hpp"
#include "metrics.hpp"
#include "notices.hpp"
#include "robomill/io/sample_source.hpp"
#include "testing/support.hpp"
#include "watch.hpp"

namespace robomill::app {
namespace {

using std::chrono::milliseconds;

TEST(Notices, AFloodBecomesOneASecond) {
  Notices notices;
  const Notices::Clock::time_point begin = Notices::Clock::now();
  notices.add("lost", "first");
  ASSERT_EQ(notices.take(begin).size(), 1U);
  for (int i = 0; i < 1000; ++i) {
    notices.add("lost", "many");
    EXPECT_TRUE(notices.take(begin + milliseconds(i / 2)).empty());
  }
  notices.add("other", "at once");
  EXPECT_EQ(notices.take(begin + milliseconds(600)).front().what, "other");
  const std::vector<Notice> later = notices.take(begin + milliseconds(1000));
  ASSERT_EQ(later.size(), 1U);
  EXPECT_EQ(later.front().count, 1000U);
  EXPECT_EQ(later.front().message, "many");
  notices.add("lost", "last", 7);
  EXPECT_TRUE(notices.take(begin + milliseconds(1001)).empty());
  EXPECT_EQ(notices.take(begin + milliseconds(1001), true).front().count, 7U);
}

std::vector<float> ramp(std::size_t from, std::size_t count) {
  std::vector<float> out(count);
  std::iota(out.begin(), out.end(), static_cast<float>(from));
  return out;
}

TEST(AlarmRing, WritesTheLastSeconds) {
  const test::Folder folder;
  std::vector<std::string> told;
  AlarmRing ring(
      {.folder = folder.at("alarms"), .seconds = 2.0, .channels = 2, .sample_rate_hz = 100.0},
      [&](const std::filesystem::path& file, const std::string& error) { told.push_back(file.string() + error); });
  for (std::size_t i = 0; i < 100; ++i) ring.add(ramp(14 * i, 14));
  EXPECT_TRUE(ring.alarm(7.0));
  ring.finish();
  EXPECT_TRUE(ring.alarm(7.0));
  ring.finish();
  ASSERT_EQ(told, (std::vector<std::string>{folder.at("alarms") / "alarm_7.000s.wav",
                                            folder.at("alarms") / "alarm_7.000s_2.wav"}));
  const auto wav = io::open_samples(told.front(), {.channels = {"1", "2"}, .sample_rate_hz = 100.0});
  io::SampleBlock block;
  ASSERT_TRUE(wav->next(1000, block));
  EXPECT_EQ(block.samples, ramp(1400 - 400, 400));
}

TEST(AlarmRing, TellsWhatItCannotWrite) {
  const test::Folder folder;
  std::string told;
  AlarmRing ring({.folder = folder.at("alarms"), .seconds = 1.0, .channels = 1, .sample_rate_hz = 100.0},
                 [&](const std::filesystem::path& file, const std::string& error) { told = file.string() + error; });
  ring.add(ramp(0, 10));
  std::filesystem::remove_all(folder.at("alarms"));
  EXPECT_TRUE(ring.alarm(0.1));
  ring.finish();
  EXPECT_NE(told.find("cannot be written"), std::string::npos) << told;
  const auto file = folder.file("taken", "x");
  EXPECT_THROW(AlarmRing({.folder = file, .sample_rate_hz = 100.0}, {}), InvalidInput);
}

TEST(Metrics, AnswerInTheTextFormat) {
  MetricValues values;
  monitor::Decision decision;
  decision.state = monitor::State::chatter;
  decision.score = 12.5;
  decision.chatter_frequency_hz = 683.5;
  values.set(decision);
  values.level = std::numeric_limits<double>::quiet_NaN();
  values.dropped_hops = 3;
  const MetricsServer server(values, "127.0.0.1", 0);
  const std::string answer = test::http_get(server.port(), "/metrics");
  EXPECT_EQ(answer.rfind("HTTP/1.1 200 OK", 0), 0U) << answer;
  for (const char* line : {"\nrobomill_state 2\n", "\nrobomill_score 12.5\n", "\nrobomill_chatter_frequency_hz 683.5\n",
                           "\nrobomill_decisions_total 1\n", "\nrobomill_dropped_hops_total 3\n",
                           "# TYPE robomill_score gauge\n", "# TYPE robomill_alarms_total counter\n"}) {
    EXPECT_NE(answer.find(line), std::string::npos) << line;
  }
  EXPECT_EQ(answer.find("nan"), std::string::npos);
  EXPECT_EQ(test::http_get(server.port(), "/other").rfind("HTTP/1.1 404", 0), 0U);
  EXPECT_EQ(test::http_get(server.port(), "/" + std::string(20'000, 'x')).rfind("HTTP/1.1 414", 0), 0U);
  EXPECT_NE(
      test::refusal([&] { const MetricsServer second(values, "127.0.0.1", server.port()); }).find("cannot listen"),
      std::string::npos);
}

TEST(Watch, ShowsTheSpectrumAsABar) {
  monitor::Decision decision;
  decision.state = monitor::State::transition;
  decision.bands = 4;
  decision.band_level = {0.0F, 1.0F, 0.063F, 0.001F};  // none, 0, -24 and -60 dB
  decision.level = 1.25;
  decision.score = 3.0;
  decision.threshold = 9.0;
  decision.chatter_frequency_hz = 683.6;
  const std::string line = watch_line(decision, 12.3456);
  EXPECT_NE(line.find("[ █▄ ]"), std::string::npos) << line;
  EXPECT_NE(line.find("12.346 s  transition"), std::string::npos) << line;
  EXPECT_NE(line.find("683.6 Hz"), std::string::npos) << line;
  EXPECT_EQ(line.find("rpm"), std::string::npos) << line;
  EXPECT_NE(watch_line({}, 0.0).find("[]"), std::string::npos);
}

}  // namespace
}  // namespace robomill::app
