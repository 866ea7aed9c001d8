#include "robomill/path/files/stream_json.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace robomill::path {
namespace stream_json_test {

TEST(StreamJson, HoldsWhatWasCounted) {
  StreamedProgram streamed{.program = "part.ngc", .cell = "cell.toml", .end = StreamEnd::stopped};
  streamed.report.period_s = 0.004;
  streamed.report.periods = 1000;
  streamed.report.misses = 3;
  for (int i = 1; i <= 1000; ++i) streamed.report.hand_over.add(i * std::int64_t{1000} - 1);
  streamed.written.lines = 999;
  streamed.scheduling.why_not = "Operation not permitted";
  streamed.commands = 2;
  const auto json = nlohmann::json::parse(stream_json(streamed));
  EXPECT_EQ(json["document"], "stream/1");
  EXPECT_EQ(json["end"], "stopped");
  EXPECT_EQ(json["failure"], nullptr);
  EXPECT_EQ(json["sample_period_ms"], 4.0);
  EXPECT_EQ(json["deadline_misses"], 3);
  EXPECT_EQ(json["hand_over"]["p99_us"], 990.0);
  EXPECT_EQ(json["hand_over"]["p999_us"], 999.0);
  EXPECT_NEAR(json["hand_over"]["max_us"].get<double>(), 1000.0, 0.01);
  EXPECT_FALSE(json["real_time"].get<bool>());
  EXPECT_EQ(json["why_not_real_time"], "Operation not permitted");
  const std::string text = stream_text(streamed);
  EXPECT_TRUE(text.starts_with("stopped: 1000 set-points, one every 4 ms\nmisses     3 of 1000")) << text;
  EXPECT_NE(text.find("99 % 990, 99.9 % 999, max 1000 us"), std::string::npos) << text;
  EXPECT_NE(text.find("no SCHED_FIFO: Operation not permitted"), std::string::npos) << text;
  streamed.end = StreamEnd::failed;
  streamed.failure = "line 7\x1b[31m";
  EXPECT_TRUE(stream_text(streamed).starts_with("failed (line 7\\x1b[31m): ")) << stream_text(streamed);
}

}  // namespace stream_json_test
}  // namespace robomill::path
