// The file of the events: of a recording whole or not at all, of a stream from session to session.
#include "event_file.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/version.hpp"
#include "testing/processes.hpp"
#include "testing/support.hpp"

namespace robomill::app {
namespace event_file_test {

using nlohmann::json;

std::vector<json> events(const std::filesystem::path& path) {
  std::vector<json> out;
  std::istringstream lines(test::slurp(path));
  for (std::string line; std::getline(lines, line);) out.push_back(json::parse(line, nullptr, false));
  return out;
}

EventFile::Options stream(const std::filesystem::path& place) {
  return {.place = place, .is_stream = true, .input = "mqtt://127.0.0.1:1883/ax", .config = "monitor.toml"};
}

TEST(EventFile, OfAStreamGoesOnFromSessionToSession) {
  const test::Folder folder;
  const auto path = folder.at("events.jsonl");
  for (const char* line : {"{\"event\":\"one\"}\n", "{\"event\":\"two\"}\n"}) {
    EventFile file(stream(path));
    EXPECT_TRUE(file.write(line));
    file.close();
    EXPECT_NO_THROW(file.require_saved());
  }
  const std::vector<json> all = events(path);
  ASSERT_EQ(all.size(), 4U);
  for (const std::size_t begin : {0U, 2U}) {
    const json& started = all[begin];
    EXPECT_EQ(started.at("event"), "started");
    EXPECT_EQ(started.at("time_s"), 0.0);
    EXPECT_EQ(started.at("input"), "mqtt://127.0.0.1:1883/ax");
    EXPECT_EQ(started.at("config"), "monitor.toml");
    EXPECT_EQ(started.at("version"), ROBOMILL_VERSION);
    EXPECT_EQ(started.at("started").get<std::string>().size(), 20U);
    EXPECT_FALSE(started.contains("message"));
  }
  EXPECT_EQ(all[3].at("event"), "two");
}

// A service whose start fails again and again leaves nothing.
TEST(EventFile, BeginsWithTheSession) {
  const test::Folder folder;
  const auto path = folder.at("events.jsonl");
  { const EventFile file(stream(path)); }
  EXPECT_EQ(test::slurp(path), "");
  EventFile file(stream(path));
  file.begin();
  EXPECT_TRUE(file.write("{}\n"));
  file.begin();
  EXPECT_EQ(events(path).size(), 2U);
}

TEST(EventFile, SaysThatItsFileWasMoved) {
  const test::Folder folder;
  const auto path = folder.at("events.jsonl");
  live::Notices notices;
  live::MetricValues metrics;
  testing::internal::CaptureStderr();
  EventFile file(stream(path));
  file.report_to(notices, metrics);
  file.begin();
  std::filesystem::rename(path, folder.at("events.1"));
  EXPECT_TRUE(file.write("{\"event\":\"one\"}\n"));
  EXPECT_TRUE(file.write("{\"event\":\"two\"}\n"));
  EXPECT_NO_THROW(file.require_saved());
  EXPECT_EQ(testing::internal::GetCapturedStderr(),
            "robomill: " + path.string() + ": was moved or removed; events go on in another file there\n");
  const std::vector<live::Notice> said = notices.take(live::Notices::Clock::now(), true);
  ASSERT_EQ(said.size(), 1U);
  EXPECT_EQ(said[0].what, "events-file-moved");
  EXPECT_EQ(events(path).size(), 2U);
}

TEST(EventFile, SaysThatTheLineBeforeWasNotFinished) {
  const test::Folder folder;
  const auto path = folder.file("events.jsonl", "{\"event\":\"sta");
  testing::internal::CaptureStderr();
  EventFile(stream(path)).begin();
  EXPECT_NE(testing::internal::GetCapturedStderr().find("its last line was not finished"), std::string::npos);
  const std::vector<json> all = events(path);
  ASSERT_EQ(all.size(), 2U);
  EXPECT_TRUE(all[0].is_discarded());
  EXPECT_NE(all[1].at("message").get<std::string>().find("was not finished"), std::string::npos);
}

// The monitor goes on, and says so once.
TEST(EventFile, SaysThatEventsCannotBeSaved) {
  live::Notices notices;
  live::MetricValues metrics;
  testing::internal::CaptureStderr();
  EventFile file(stream("/dev/full"));
  file.report_to(notices, metrics);
  for (int i = 0; i < 10; ++i) EXPECT_TRUE(file.write("{}\n"));
  file.write_beside("{}\n");
  file.retry();
  EXPECT_EQ(test::rejection([&] { file.require_saved(); }),
            "/dev/full: 12 events could not be saved. No space left on device. Is the disk full?");
  EXPECT_EQ(
      testing::internal::GetCapturedStderr(),
      "robomill: /dev/full: events cannot be saved: No space left on device; the monitor goes on, and they wait\n");
  const std::vector<live::Notice> said = notices.take(live::Notices::Clock::now(), true);
  ASSERT_EQ(said.size(), 1U);
  EXPECT_EQ(said[0].what, "events-not-saved");
  EXPECT_EQ(metrics.unsaved_events, 12U);
  EXPECT_EQ(metrics.lost_events, 0U);
  EXPECT_EQ(metrics.log_failures, 1U);
  const std::string text = metrics.text();
  EXPECT_NE(text.find("\nrobomill_unsaved_events 12\n"), std::string::npos) << text;
  EXPECT_NE(text.find("\nrobomill_event_log_failures_total 1\n"), std::string::npos) << text;
}

/// Standard output of this process, on a full disk.
class FullOutput {
 public:
  FullOutput() : kept_(::dup(STDOUT_FILENO)) {
    std::fflush(stdout);
    const int full = ::open("/dev/full", O_WRONLY | O_CLOEXEC);
    ::dup2(full, STDOUT_FILENO);
    ::close(full);
  }
  ~FullOutput() {
    ::dup2(kept_, STDOUT_FILENO);
    ::close(kept_);
  }
  FullOutput(const FullOutput&) = delete;
  FullOutput& operator=(const FullOutput&) = delete;

 private:
  int kept_;
};

// A stream goes on, says so once and counts; a recording ends.
TEST(EventFile, StandardOutputThatTakesNothingEndsNoStream) {
  for (const bool is_stream : {true, false}) {
    EventFile file({.place = "-", .is_stream = is_stream});
    testing::internal::CaptureStderr();
    bool first = false, second = false;
    {
      const FullOutput full;
      first = file.write("{}\n");
      second = file.write("{}\n");
    }
    const std::string said = testing::internal::GetCapturedStderr();
    EXPECT_EQ(first, is_stream);
    EXPECT_EQ(second, is_stream);
    if (is_stream) {
      EXPECT_EQ(
          said,
          "robomill: standard output takes no events: No space left on device; the monitor goes on without them\n");
      file.close();
      EXPECT_EQ(test::rejection([&] { file.require_saved(); }),
                "standard output: 2 events could not be written. Is the disk full?");
    } else {
      EXPECT_EQ(said, "");
      EXPECT_NE(test::rejection([&] { file.close(); }), "accepted");
    }
  }
}

TEST(EventFile, OfARecordingIsWholeOrNotAtAll) {
  const test::Folder folder;
  const auto path = folder.file("events.jsonl", "old\n");
  {
    EventFile file({.place = path});
    EXPECT_TRUE(file.write("half\n"));
  }
  EXPECT_EQ(test::slurp(path), "old\n");
  EventFile file({.place = path});
  EXPECT_TRUE(file.write("new\n"));
  file.close();
  EXPECT_EQ(test::slurp(path), "new\n");
  EventFile nowhere({});
  EXPECT_TRUE(nowhere.write("gone\n"));
  nowhere.close();
  EXPECT_NE(
      test::rejection([&] { const EventFile no(stream(folder.at("no/events.jsonl"))); }).find("cannot be written"),
      std::string::npos);
}

}  // namespace event_file_test
}  // namespace robomill::app
