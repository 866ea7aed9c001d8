// Notices and the ring of the last seconds.
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <numeric>
#include <string>
#include <vector>

#include "robomill/io/sample_source.hpp"
#include "robomill/live/alarm_ring.hpp"
#include "robomill/live/notices.hpp"
#include "testing/support.hpp"

namespace robomill::live {
namespace parts_test {

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
  std::vector<std::string> reported;
  AlarmRing ring(
      {.folder = folder.at("alarms"), .seconds = 2.0, .channels = 2, .sample_rate_hz = 100.0},
      [&](const std::filesystem::path& file, const std::string& error) { reported.push_back(file.string() + error); });
  for (std::size_t i = 0; i < 100; ++i) ring.add(ramp(14 * i, 14));
  EXPECT_TRUE(ring.alarm(7.0));
  ring.finish();
  EXPECT_TRUE(ring.alarm(7.0));
  ring.finish();
  ASSERT_EQ(reported, (std::vector<std::string>{folder.at("alarms") / "alarm_7.000s.wav",
                                                folder.at("alarms") / "alarm_7.000s_2.wav"}));
  const auto wav = io::open_samples(reported.front(), {.channels = {"1", "2"}, .sample_rate_hz = 100.0});
  io::SampleBlock block;
  ASSERT_TRUE(wav->next(1000, block));
  EXPECT_EQ(block.samples, ramp(1400 - 400, 400));
}

TEST(AlarmRing, ReportsWhatItCannotWrite) {
  const test::Folder folder;
  std::string reported;
  AlarmRing ring(
      {.folder = folder.at("alarms"), .seconds = 1.0, .channels = 1, .sample_rate_hz = 100.0},
      [&](const std::filesystem::path& file, const std::string& error) { reported = file.string() + error; });
  ring.add(ramp(0, 10));
  std::filesystem::remove_all(folder.at("alarms"));
  EXPECT_TRUE(ring.alarm(0.1));
  ring.finish();
  EXPECT_NE(reported.find("cannot be written"), std::string::npos) << reported;
  const auto file = folder.file("taken", "x");
  EXPECT_THROW(AlarmRing({.folder = file, .sample_rate_hz = 100.0}, {}), InvalidInput);
}

}  // namespace parts_test
}  // namespace robomill::live
