// kill -9 at any time: files are whole or what they were, and lines of a stream are whole but for the last one.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/io/system/append_log.hpp"
#include "testing/faults/judge.hpp"
#include "testing/processes.hpp"
#include "testing/support.hpp"

namespace robomill::faults {
namespace kill_test {

namespace fs = std::filesystem;

void sleep_s(double seconds) {
  std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
}

std::vector<std::string> robomill_in(const fs::path& folder, std::initializer_list<const char*> arguments) {
  std::vector<std::string> words = {"env", "-C", folder.string(), ROBOMILL_PROGRAM};
  words.insert(words.end(), arguments.begin(), arguments.end());
  return words;
}

/// Those that write much for the time that they take.
TEST(Kill, LeavesOldOrNewFiles) {
  Random random(5);
  for (const Case& which : all_cases()) {
    const std::string name = std::string(which.verb) + " " + which.ending;
    if (name != "plan folder" && name != "smooth h5" && name != "monitor recordings wav" && name != "sweep folder" &&
        name != "sweep a boundary folder") {
      continue;
    }
    const test::Folder folder;
    Place place({.robomill = ROBOMILL_PROGRAM, .shim = ROBOMILL_FAULT_SHIM}, folder.path());
    Judge judge(place, which);
    for (int turn = 0; turn < test::seeds(100); ++turn) {
      const Judgement judgement = judge.run_killed(random.uniform());
      EXPECT_TRUE(judgement.findings.empty()) << name << ": " << judgement.text;
    }
  }
}

// Events of a stream are written as they come. A line that crosses a page may be cut: the next session ends it.
TEST(Kill, LeavesWholeLinesOfAStream) {
  const test::Folder folder;
  const fs::path work = folder.at("work"), events = work / "events.jsonl";
  fs::create_directory(work);
  restore(work, inputs_of({.verb = "monitor"}));
  ASSERT_EQ(::mkfifo((work / "pipe.csv").c_str(), 0600), 0);
  Random random(7);
  std::size_t all = 0;
  for (int turn = 0; turn < test::seeds(100); ++turn) {
    fs::remove(events);
    test::Process monitor(robomill_in(work, {"monitor", "monitor.toml", "--input", "pipe.csv", "--every-window",
                                             "--quiet", "-o", "events.jsonl"}),
                          folder.at("out.txt"), folder.at("err.txt"));
    const test::Process samples(
        {"sh", "-c", "exec cat '" + (work / "cut.csv").string() + "' >'" + (work / "pipe.csv").string() + "'"},
        folder.at("cat.txt"), folder.at("cat.txt"));
    ASSERT_TRUE(test::wait_for([&] { return !test::slurp(events).empty() || !monitor.running(); }));
    sleep_s(0.05 * random.uniform());
    monitor.signal(SIGKILL);
    (void)monitor.wait();
    const std::string left = test::slurp(events);
    const std::string lines = left.substr(0, left.rfind('\n') + 1);
    if (lines != left) {
      io::AppendLog next(events, {});
      EXPECT_TRUE(next.was_unfinished());
      EXPECT_EQ(next.write("{}\n").error, 0);
      EXPECT_EQ(test::slurp(events), left + "\n{}\n");
    }
    std::istringstream in(lines);
    for (std::string line; std::getline(in, line); ++all) {
      EXPECT_FALSE(nlohmann::json::parse(line, nullptr, false).is_discarded()) << line;
    }
  }
  EXPECT_GT(all, 20U);
}

}  // namespace kill_test
}  // namespace robomill::faults
