#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/path/sample.hpp"
#include "robomill/process/decide.hpp"
#include "robomill/process/decide/block_times.hpp"
#include "testing/process/programs.hpp"
#include "testing/support.hpp"

namespace robomill::process {
namespace decide_time_test {

/// A robot that comes to a feed of its own in each line, and loses some time in it.
class SlowRobot {
 public:
  explicit SlowRobot(int seed) : random_(static_cast<std::uint64_t>(seed)) {
    for (int line = 0; line < 64; ++line) {
      reached_m_per_s_.push_back(random_.uniform(0.004, 0.02));
      lost_s_.push_back(random_.uniform(0.0, 0.1));
    }
  }
  [[nodiscard]] RobotRun run(const ForcesResult& forces) const {
    const program::Program& program = forces.program->program;
    RobotRun out = {.time_s = 0.0, .block_time_s = {}, .torque_shares = {}};
    for (std::size_t i = 0; i < program.blocks.size(); ++i) {
      const program::Block& block = program.blocks[i];
      const double way_m = (block.end.tip_m - program.begin_of(i).tip_m).norm();
      const bool fed = block.kind == program::Block::Kind::feed && way_m > 0.0;
      const double time_s =
          fed ? std::max(block.duration_s, way_m / reached_m_per_s_[i % 64]) + lost_s_[i % 64] : block.duration_s;
      out.block_time_s.push_back(time_s);
      out.time_s += time_s;
    }
    return out;
  }

 private:
  Random random_;
  std::vector<double> reached_m_per_s_ = {}, lost_s_ = {};
};

class DecideTime : public testing::ThreePasses {};

// Short lines in which a faster feed gains nothing: the choice is measured in what the robot takes.
TEST_F(DecideTime, TheRobotTakesNoLongerThanForTheProgramNorForAChoiceByTheFeeds) {
  const DynamicsAt dynamics = constant_dynamics(modes(20.0));
  const Judged judged = judge(dynamics);
  DecideProblem asked = problem(judged, dynamics);
  asked.options.spindle_ramp_rad_per_s2 = 1e9;
  const DecideResult by_feeds = decide(asked);
  ASSERT_EQ(by_feeds.status, DecideResult::Status::found) << by_feeds.reason;
  EXPECT_TRUE(std::isnan(by_feeds.decided->robot_time_s));
  for (int seed = 1; seed <= test::seeds(60); ++seed) {
    const SlowRobot robot(seed);
    asked.robot_run = [&](const ForcesResult& run, const ProgramBlocks&, const std::vector<double>&) {
      return robot.run(run);
    };
    const DecideResult result = decide(asked);
    ASSERT_EQ(result.status, DecideResult::Status::found) << result.reason;
    ASSERT_TRUE(result.as_programmed.violations.empty());
    EXPECT_EQ(result.decided->robot_time_s, robot.run(*result.forces).time_s) << "seed " << seed;
    EXPECT_LE(result.decided->robot_time_s, result.as_programmed.robot_time_s) << "seed " << seed;
    EXPECT_LE(result.decided->robot_time_s, (1.0 + 1e-9) * robot.run(*by_feeds.forces).time_s) << "seed " << seed;
    EXPECT_TRUE(result.decided->violations.empty());
    EXPECT_LE(result.exact_runs, 4);
  }
}

// A robot that is slower the faster it is fed, as one whose blends must begin earlier.
TEST_F(DecideTime, AProgramThatTakesTheRobotLessThanEveryChoiceStays) {
  const DynamicsAt dynamics = constant_dynamics(modes(20.0));
  const Judged judged = judge(dynamics);
  DecideProblem asked = problem(judged, dynamics);
  asked.robot_run = [&](const ForcesResult& run, const ProgramBlocks&, const std::vector<double>&) {
    RobotRun out = {.time_s = 0.0, .block_time_s = {}, .torque_shares = {}};
    const program::Program& before = judged.forces.program->program;
    for (std::size_t i = 0; i < before.blocks.size(); ++i) {
      const double was_s = before.blocks[i].duration_s;
      const double is_s = run.program->program.blocks[i].duration_s;
      out.block_time_s.push_back(is_s > 0.0 ? was_s * was_s / is_s : 0.0);
      out.time_s += out.block_time_s.back();
    }
    return out;
  };
  const DecideResult result = decide(asked);
  ASSERT_EQ(result.status, DecideResult::Status::found) << result.reason;
  EXPECT_EQ(result.decided->robot_time_s, result.as_programmed.robot_time_s);
  EXPECT_EQ(result.decided->cutting_time_s, result.as_programmed.cutting_time_s);
  const program::Program& before = judged.forces.program->program;
  for (std::size_t i = 0; i < before.blocks.size(); ++i) {
    EXPECT_EQ(result.forces->program->program.blocks[i].duration_s, before.blocks[i].duration_s);
    EXPECT_EQ(result.forces->program->program.blocks[i].spindle_speed_rad_per_s,
              before.blocks[i].spindle_speed_rad_per_s);
  }
  EXPECT_TRUE(std::ranges::any_of(
      result.notes, [](const std::string& note) { return note.find("stay as programmed") != std::string::npos; }));
  // Where the program breaks a limit it does not stay.
  asked.options.max_force_n = 0.9 * result.as_programmed.peak_force_n;
  const DecideResult slower = decide(asked);
  ASSERT_EQ(slower.status, DecideResult::Status::found) << slower.reason;
  EXPECT_TRUE(slower.decided->violations.empty());
  EXPECT_LE(slower.decided->peak_force_n, 1.005 * asked.options.max_force_n);
}

TEST(BlockTimes, AddUpToTheTrajectorysTime) {
  BlockTimes times({0, 1, 1, 2});
  const auto sample = [](double time_s, std::size_t block) {
    path::Sample out;
    out.time_s = time_s;
    out.block = block;
    return out;
  };
  times.add(std::vector{sample(0.0, 0), sample(9.0, 3)});
  times.add(std::vector{sample(0.0, 0), sample(1.0, 0), sample(2.0, 1)});
  times.add(std::vector{sample(4.0, 2), sample(4.5, 3)});
  EXPECT_EQ(times.times_s(), (std::vector{1.0, 3.0, 0.5}));
}

}  // namespace decide_time_test
}  // namespace robomill::process
