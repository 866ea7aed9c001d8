#include "robomill/io/system/append_log.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <new>
#include <set>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "robomill/io/system/confinement.hpp"
#include "testing/support.hpp"

namespace robomill::io {
namespace append_log_test {

namespace fs = std::filesystem;
using test::Folder;
using test::rejection;

std::string content(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

std::vector<std::string> lines(const fs::path& path) {
  std::vector<std::string> out;
  std::istringstream text(content(path));
  for (std::string line; std::getline(text, line);) out.push_back(line);
  return out;
}

std::string lost_line(std::uint64_t count) {
  return "lost " + std::to_string(count) + "\n";
}

TEST(AppendLog, AppendsToWhatIsThere) {
  const Folder folder;
  const fs::path path = folder.at("e.jsonl");
  for (const char* line : {"1\n", "2\n"}) {
    AppendLog log(path, {});
    EXPECT_FALSE(log.was_unfinished());
    EXPECT_EQ(log.write(line).error, 0);
    EXPECT_EQ(log.state().waiting, 0U);
  }
  EXPECT_EQ(content(path), "1\n2\n");
  fs::create_symlink(path, folder.at("link"));
  AppendLog through(folder.at("link"), {});
  (void)through.write("3\n");
  EXPECT_EQ(content(path), "1\n2\n3\n");
}

TEST(AppendLog, EndsALineThatWasNotFinished) {
  const Folder folder;
  const fs::path path = folder.file("e.jsonl", "whole\n{\"half");
  {
    AppendLog log(path, {});
    EXPECT_TRUE(log.was_unfinished());
    EXPECT_EQ(content(path), "whole\n{\"half");
    (void)log.write("next\n");
    (void)log.write("last\n");
  }
  EXPECT_EQ(content(path), "whole\n{\"half\nnext\nlast\n");
  EXPECT_FALSE(AppendLog(path, {}).was_unfinished());
}

// What kills the process in the middle of its work leaves whole lines. Their length divides a page's: between two pages
// of one write() the system itself may stop.
TEST(AppendLog, LeavesWholeLinesWhenItIsKilled) {
  const Folder folder;
  const fs::path path = folder.at("e.jsonl");
  for (int i = 0; i < 5; ++i) {
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      AppendLog log(path, {});
      for (int k = 0; k < 100'000; ++k) (void)log.write(std::string(63, 'x') + "\n");
      ::_exit(0);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    if (!fs::exists(path)) continue;  // it had not come so far
    EXPECT_FALSE(AppendLog(path, {}).was_unfinished());
    for (const std::string& line : lines(path)) ASSERT_EQ(line.size(), 63U);
  }
}

TEST(AppendLog, KeepsWhatCannotBeWrittenUntilThereIsRoom) {
  const Folder folder;
  const fs::path path = folder.at("e.jsonl");
  AppendLog log(path, {.lost_line = lost_line});
  AppendLog::State state;
  std::string half;
  {
    const test::FileSizeLimit full(10);
    state = log.write("first\n");
    EXPECT_EQ(state.error, 0);
    state = log.write("second\n");  // four bytes of it would have room
    (void)log.write("third\n");
    state = log.retry();
    half = content(path);
  }
  EXPECT_EQ(half, "first\n");
  EXPECT_EQ(state.error, EFBIG);
  EXPECT_EQ(state.waiting, 2U);
  EXPECT_EQ(state.failures, 1U);
  state = log.retry();
  EXPECT_EQ(state.error, 0);
  EXPECT_EQ(state.waiting, 0U);
  EXPECT_EQ(state.lost, 0U);
  EXPECT_EQ(content(path), "first\nsecond\nthird\n");
  {
    const test::FileSizeLimit full(10);
    state = log.write("fourth\n");
  }
  EXPECT_EQ(state.failures, 2U);
  EXPECT_EQ(log.write("fifth\n").error, 0);
  EXPECT_EQ(content(path), "first\nsecond\nthird\nfourth\nfifth\n");
}

TEST(AppendLog, SaysHowManyWereTooManyToKeep) {
  const Folder folder;
  for (const bool says : {true, false}) {
    const fs::path path = folder.at(says ? "e.jsonl" : "silent.jsonl");
    AppendLog log(path, says ? AppendLog::Options{.most_waiting = 3, .lost_line = lost_line}
                             : AppendLog::Options{.most_waiting = 3});
    AppendLog::State state;
    {
      const test::FileSizeLimit full(0);
      for (int i = 0; i < 10; ++i) state = log.write(std::to_string(i) + "\n");
    }
    EXPECT_EQ(state.waiting, 3U);
    EXPECT_EQ(state.lost, 7U);
    state = log.write("10\n");
    EXPECT_EQ(state.error, 0);
    EXPECT_EQ(state.lost, 8U);  // the newest four are one too many
    EXPECT_EQ(content(path), says ? "lost 8\n8\n9\n10\n" : "8\n9\n10\n");
    EXPECT_EQ(log.state().lost, 8U);
  }
}

// Lines that matter less are lost before the older ones that matter.
TEST(AppendLog, LosesMinorLinesFirst) {
  const Folder folder;
  const fs::path path = folder.at("e.jsonl");
  AppendLog log(path, {.most_waiting = 3, .lost_line = lost_line});
  {
    const test::FileSizeLimit full(0);
    (void)log.write("alarm\n");
    for (int i = 0; i < 10; ++i) (void)log.write(std::to_string(i) + "\n", true);
    EXPECT_EQ(log.write("end\n").lost, 9U);
  }
  EXPECT_EQ(log.retry().waiting, 0U);
  EXPECT_EQ(content(path), "lost 9\nalarm\n9\nend\n");
}

// What a rotation moves away, or a user removes, is not written to: nobody would find it.
TEST(AppendLog, FollowsItsPlace) {
  const Folder folder;
  const fs::path path = folder.at("e.jsonl");
  AppendLog log(path, {});
  EXPECT_EQ(log.write("1\n").moved, 0U);
  fs::rename(path, folder.at("e.1"));
  EXPECT_EQ(log.write("2\n").moved, 1U);
  fs::remove(path);
  EXPECT_EQ(log.write("3\n").moved, 2U);
  fs::rename(path, folder.at("e.2"));
  folder.file("e.jsonl", "half");
  EXPECT_EQ(log.write("4\n").moved, 3U);
  EXPECT_EQ(log.write("5\n").moved, 3U);
  EXPECT_EQ(content(folder.at("e.1")), "1\n");
  EXPECT_EQ(content(folder.at("e.2")), "3\n");
  EXPECT_EQ(content(path), "half\n4\n5\n");
  fs::remove(path);
  fs::create_directory(path);
  AppendLog::State state = log.write("6\n");
  EXPECT_EQ(state.error, EEXIST);
  EXPECT_EQ(state.waiting, 1U);
  fs::remove(path);
  state = log.retry();
  EXPECT_EQ(state.error, 0);
  EXPECT_EQ(content(path), "6\n");
}

// An exception on the way loses nothing, and the log goes on.
TEST(AppendLog, GoesOnAfterAnException) {
  const Folder folder;
  const fs::path path = folder.at("e.jsonl");
  bool throws = true;
  AppendLog log(path, {.most_waiting = 1, .lost_line = [&](std::uint64_t count) {
                         if (throws) throw std::bad_alloc();
                         return lost_line(count);
                       }});
  {
    const test::FileSizeLimit full(0);
    (void)log.write("1\n");
    EXPECT_THROW((void)log.write("2\n"), std::bad_alloc);
  }
  throws = false;
  EXPECT_EQ(log.retry().waiting, 0U);
  EXPECT_EQ(content(path), "lost 1\n2\n");
}

TEST(AppendLog, IsDurableOnceClosed) {
  const Folder folder;
  AppendLog log(folder.at("e.jsonl"), {});
  (void)log.write("1\n");
  EXPECT_EQ(log.close().error, 0);
  const AppendLog::State state = log.write("2\n");
  EXPECT_NE(state.error, 0);
  EXPECT_EQ(state.waiting, 1U);
  AppendLog full("/dev/full", {});
  (void)full.write("1\n");
  EXPECT_EQ(full.close().error, ENOSPC);
}

TEST(AppendLog, WritesDevicesAndPipesThrough) {
  AppendLog full("/dev/full", {});
  const AppendLog::State state = full.write("lost\n");
  EXPECT_EQ(state.error, ENOSPC);
  EXPECT_EQ(error_text(state.error), "No space left on device");
  EXPECT_EQ(state.waiting, 1U);
  AppendLog nothing("/dev/null", {});
  EXPECT_EQ(nothing.write("gone\n").error, 0);
}

// Each line of each thread once and whole, those of one thread in their order.
TEST(AppendLog, TakesLinesOfSeveralThreads) {
  const Folder folder;
  const fs::path path = folder.at("e.jsonl");
  constexpr int threads = 4, each = 500;
  {
    AppendLog log(path, {});
    std::vector<std::jthread> writers;
    for (int t = 0; t < threads; ++t) {
      writers.emplace_back([&log, t] {
        for (int i = 0; i < each; ++i) (void)log.write(std::to_string(t) + " " + std::to_string(i) + "\n");
      });
    }
    writers.clear();
    EXPECT_EQ(log.retry().waiting, 0U);
    EXPECT_EQ(log.state().lost, 0U);
  }
  std::vector<int> next(threads);
  for (const std::string& line : lines(path)) {
    const int thread = std::stoi(line);
    EXPECT_EQ(std::stoi(line.substr(2)), next[static_cast<std::size_t>(thread)]++) << line;
  }
  EXPECT_EQ(next, std::vector<int>(threads, each));
}

// A pipe that nobody empties keeps one thread; the others go on.
TEST(AppendLog, NoThreadWaitsForAnothersWrite) {
  const Folder folder;
  const fs::path path = folder.at("pipe");
  ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
  std::ifstream reader;
  std::jthread opening([&] { reader.open(path); });
  AppendLog log(path, {});
  opening.join();
  std::atomic<bool> filled{false};
  std::jthread stuck([&] {
    (void)log.write(std::string(1 << 20, 'x') + "\n");
    filled = true;
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  EXPECT_FALSE(filled);
  EXPECT_EQ(log.write("behind\n").waiting, 1U);
  std::string first, second;
  std::getline(reader, first);
  std::getline(reader, second);
  EXPECT_EQ(first.size(), std::size_t{1} << 20);
  EXPECT_EQ(second, "behind");
}

TEST(AppendLog, RejectsPlacesThatCannotBeWritten) {
  const Folder folder;
  EXPECT_NE(rejection([&] { const AppendLog log(folder.at("no/where"), {}); }).find("There is no folder"),
            std::string::npos);
  EXPECT_NE(rejection([&] { const AppendLog log(folder.path(), {}); }).find("is a folder"), std::string::npos);
  const fs::path outside = folder.at("outside.jsonl");
  fs::create_directories(folder.at("inside"));
  ASSERT_EQ(::mkfifo(folder.at("inside/pipe").c_str(), 0600), 0);
  const Confinement confinement(folder.at("inside"));
  EXPECT_NE(rejection([&] { const AppendLog log(outside, {}); }).find("outside"), std::string::npos);
  EXPECT_NE(rejection([&] { const AppendLog log(folder.at("inside/pipe"), {}); }).find("a device or a pipe"),
            std::string::npos);
  EXPECT_FALSE(fs::exists(outside));
}

}  // namespace append_log_test
}  // namespace robomill::io
