// Whatever call fails, a result is there whole or what was there before still is, and the program says so.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <ostream>
#include <string>
#include <utility>

#include "testing/faults/judge.hpp"
#include "testing/support.hpp"

namespace robomill::faults {

std::ostream& operator<<(std::ostream& out, const Case& which) {
  return out << "robomill " << which.arguments;
}

namespace faults_test {

std::string described(const Judgement& judgement) {
  return std::string(kind_names.at(static_cast<std::size_t>(judgement.fault.kind))) + " at call " +
         std::to_string(judgement.fault.n) + ", to " + call_names.at(static_cast<std::size_t>(judgement.outcome.call)) +
         " " + judgement.outcome.file + ": exit " + std::to_string(judgement.outcome.exit) + "\n" + judgement.text;
}

class Faults : public testing::TestWithParam<Case> {
 protected:
  test::Folder folder_;
  Place place_{{.robomill = ROBOMILL_PROGRAM, .shim = ROBOMILL_FAULT_SHIM}, folder_.path()};
};

TEST_P(Faults, LeaveTheOldFileOrTheNew) {
  Judge judge(place_, GetParam());
  for (const Fault& fault : some_of(judge.faults(), test::seeds(10), 1)) {
    const Judgement judgement = judge.run(fault);
    EXPECT_TRUE(judgement.outcome.reached) << described(judgement);
    EXPECT_TRUE(judgement.findings.empty()) << described(judgement);
  }
  if (GetParam().is(to_stdout)) {
    const Judgement judgement = judge.run_onto_full_device();
    EXPECT_TRUE(judgement.findings.empty()) << described(judgement);
  }
  // What is renamed must be on the disk before, and its new name after: else a loss of power takes both files.
  EXPECT_EQ(judge.undisturbed().unsynced_files, 0U);
  EXPECT_EQ(judge.undisturbed().unsynced_folders, 0U);
}

std::string name_of(const testing::TestParamInfo<Case>& which) {
  std::string name = std::string(which.param.verb) + "_" + which.param.ending;
  std::ranges::replace_if(
      name, [](unsigned char letter) { return std::isalnum(letter) == 0; }, '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Each, Faults, testing::ValuesIn(all_cases()), name_of);

// Two runs print other times, on a busy machine more often.
TEST(WithoutTimes, RunsAreAlike) {
  for (const auto& [text, seconds] : {std::pair("15886 points of the chart in {} s, collocation.", 1.31),
                                      std::pair("226 blocks, 180 of them cut; 512 mm³ removed; {} s\n", 0.04),
                                      std::pair("452 evaluations in {} s\n", 12.5),
                                      std::pair("\"unsettled\":0,\"seconds\":{},\"points\":[]", 1e-05)}) {
    EXPECT_EQ(without_times(fmt::format(fmt::runtime(text), seconds)),
              without_times(fmt::format(fmt::runtime(text), 0)));
  }
}

// The shim itself: a fault happens to the call that was asked for, and to no other.
TEST(Shim, CountsCallsInTheirOrder) {
  const test::Folder folder;
  Place place({.robomill = ROBOMILL_PROGRAM, .shim = ROBOMILL_FAULT_SHIM}, folder.path());
  const std::string arguments = "init job --example --quiet";
  const Outcome whole = place.run(arguments, {}, false);
  ASSERT_EQ(whole.exit, 0) << whole.err;
  EXPECT_FALSE(whole.reached);
  const Files written = files_of(place.folder());
  ASSERT_GE(written.size(), 2U);
  const auto count = [&](Kind kind) { return whole.calls.at(static_cast<std::size_t>(kind)); };
  EXPECT_GE(count(Kind::short_write), 1U);
  EXPECT_GE(count(Kind::no_space), count(Kind::short_write) + 2);  // made and renamed, too
  EXPECT_GE(count(Kind::io_error), count(Kind::no_space));
  EXPECT_GE(count(Kind::no_memory), 1U);
  for (const Kind kind : all_kinds) {
    restore(place.folder(), {});
    EXPECT_TRUE(place.run(arguments, {kind, count(kind)}, false).reached)
        << kind_names.at(static_cast<std::size_t>(kind));
    restore(place.folder(), {});
    const Outcome beyond = place.run(arguments, {kind, count(kind) + 1}, false);
    EXPECT_FALSE(beyond.reached) << kind_names.at(static_cast<std::size_t>(kind));
    EXPECT_EQ(beyond.exit, 0) << beyond.err;
    EXPECT_EQ(files_of(place.folder()), written);
  }
}

// The last two calls of a file that is made: what precedes the rename leaves nothing, what follows it leaves all.
TEST(Shim, KillsBeforeACallAndInTheMiddleOfAWrite) {
  const test::Folder folder;
  Place place({.robomill = ROBOMILL_PROGRAM, .shim = ROBOMILL_FAULT_SHIM}, folder.path());
  bool half = false;
  for (std::uint64_t n = 1; n < 20; ++n) {
    restore(place.folder(), {});
    const Outcome outcome = place.run("init cell --example --quiet", {Kind::killed, n}, false);
    if (!outcome.reached) break;
    EXPECT_EQ(outcome.exit, 137);
    for (const auto& [name, content] : files_of(place.folder()))
      half = half || (name != "cell.toml" && !content.empty());
  }
  EXPECT_TRUE(half);
}

}  // namespace faults_test
}  // namespace robomill::faults
