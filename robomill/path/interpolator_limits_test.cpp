// What must hold whatever happens while a program runs: no limit is broken, and the path is the programmed one.
#include <gtest/gtest.h>

#include <string>
#include <tuple>

#include "testing/path/mixed_program.hpp"
#include "testing/path/ride.hpp"
#include "testing/support.hpp"

namespace robomill::path {
namespace interpolator_limits_test {

using test::Disturbance;
using test::Machine;
using State = PathInterpolator::State;

constexpr Disturbance calm = {.hold = 0.0};
constexpr Disturbance held = {.hold = 0.004};
constexpr Disturbance overridden = {.change_override = 0.005};
constexpr Disturbance starved = {.stall = 0.01, .blocks = 0.015};
constexpr Disturbance all = {.hold = 0.003, .change_override = 0.01, .stall = 0.003, .blocks = 0.1};

struct Case {
  const char* name;
  Disturbance how;
  bool tip;  ///< limits of the tip are the ones that bind; else the joints'
  double period_s;
};
const Case cases[] = {
    {"calm", calm, true, 0.001},       {"held", held, true, 0.001}, {"overridden", overridden, true, 0.001},
    {"starved", starved, true, 0.001}, {"all", all, true, 0.001},   {"allJoints", all, false, 0.001},
    {"allSlow", all, false, 0.004}};

SmoothingOptions options_of(const Case& given) {
  SmoothingOptions out = test::published_options(Method::verified);
  out.sample_period_s = given.period_s;
  if (given.tip) return out;
  out.tip_tolerance_m = 5e-5;
  out.axis_tolerance_rad = 1e-3;
  out.max_velocity_m_per_s = 0.5;
  out.max_acceleration_m_per_s2 = 5.0;
  out.max_jerk_m_per_s3 = 200.0;
  out.max_angular_velocity_rad_per_s = 3.0;
  out.max_angular_acceleration_rad_per_s2 = 30.0;
  out.max_angular_jerk_rad_per_s3 = 1000.0;
  return out;
}

/// What the check found, less the feed where the override raised it.
void expect_within(const CheckResult& result, double largest_override) {
  EXPECT_LE(result.feed.max, largest_override);
  EXPECT_EQ(result.violations() - result.feed.violations, 0U);
  for (const Violation& violation : result.worst_violations) {
    if (largest_override > 1.0 && violation.order == 1) continue;
    ADD_FAILURE() << "order " << violation.order << " ratio " << violation.ratio << " at " << violation.time_s
                  << " s, block " << violation.block;
  }
}

class Disturbed : public ::testing::TestWithParam<std::tuple<Machine, Case>> {};

TEST_P(Disturbed, RunsKeepEveryLimitAndEndAtTheEnd) {
  const auto& [kind, given] = GetParam();
  const auto machine = test::make_machine(kind);
  const SmoothingOptions options = options_of(given);
  std::size_t waits = 0, holds = 0;
  for (int seed = 0; seed < robomill::test::seeds(kind == Machine::kr210 ? 40 : 80); ++seed) {
    Random random(static_cast<std::uint64_t>(seed), 17);
    const program::Program program =
        test::mixed_program(random, {.least_blocks = 50, .most_blocks = 300, .feed_m_per_s = given.tip ? 0.05 : 0.2});
    const Posture posture = test::posture_for(program, *machine);
    PathInterpolator path(*machine, options, program.start, posture.gamma_rad[0], posture.start);
    const test::Rode rode = test::ride(path, program, given.how, random);
    ASSERT_EQ(rode.state, State::finished) << seed;
    EXPECT_LT((rode.samples.back().tip_m - program.blocks.back().end.tip_m).norm(), 1e-15);
    SCOPED_TRACE("seed " + std::to_string(seed));
    expect_within(test::check(program, *machine, options, rode.samples),
                  given.how.change_override > 0.0 ? given.how.largest_override : 1.0);
    waits += rode.waits;
    holds += rode.holds;
  }
  // The ride was as rough as it was meant to be.
  EXPECT_TRUE(given.how.hold == 0.0 || holds > 10U) << holds;
  EXPECT_TRUE(given.how.blocks > 0.05 || waits > 0U) << waits;
}

std::string name_of(const testing::TestParamInfo<std::tuple<Machine, Case>>& given) {
  const char* const machines[] = {"TiltHead", "Hybrid", "Kr210"};
  return std::string(machines[static_cast<int>(std::get<0>(given.param))]) + "_" + std::get<1>(given.param).name;
}
INSTANTIATE_TEST_SUITE_P(Machines, Disturbed,
                         testing::Combine(testing::Values(Machine::tilt_head, Machine::hybrid, Machine::kr210),
                                          testing::ValuesIn(cases)),
                         name_of);

// Wherever the program breaks off, the machine comes to rest before what is planned ends.
TEST(InterpolatorLimits, HoldWhereverTheProgramBreaksOff) {
  const auto machine = test::make_machine(Machine::hybrid);
  const SmoothingOptions options = test::published_options(Method::verified);
  for (int seed = 0; seed < robomill::test::seeds(50); ++seed) {
    Random random(static_cast<std::uint64_t>(seed), 18);
    const program::Program program = test::mixed_program(random, {.least_blocks = 260, .most_blocks = 400});
    const Posture posture = test::posture_for(program, *machine);
    PathInterpolator path(*machine, options, program.start, posture.gamma_rad[0], posture.start);
    const std::size_t cut = 200 + random.index(program.blocks.size() - 200);
    const double share = random.uniform(0.2, 1.5);
    path.set_override(share);
    std::vector<Sample> samples;
    Sample sample;
    State state = State::running;
    std::size_t at = 0;
    for (int still = 0; still < 20 && samples.size() < 400'000;) {
      while (at < cut && path.push(program.blocks[at]).accepted()) ++at;
      state = path.next(sample);
      samples.push_back(sample);
      still = at == cut && state != State::running ? still + 1 : 0;
    }
    EXPECT_EQ(state, State::waiting);
    EXPECT_GE(path.ready_s(), 0.0);
    // The rest of the program is missing, so that only motion is looked at.
    const CheckResult result = test::check(program, *machine, options, samples);
    for (const Violation& violation : result.worst_violations) {
      if (violation.order > 1 || (violation.order == 1 && share <= 1.0))
        ADD_FAILURE() << seed << ' ' << violation.ratio;
    }
  }
}

// Wherever it is stopped, amid holds and overrides, the machine comes to rest within every limit.
TEST(InterpolatorLimits, HoldWhereverItIsStopped) {
  for (const Machine kind : {Machine::tilt_head, Machine::hybrid, Machine::kr210}) {
    const auto machine = test::make_machine(kind);
    const SmoothingOptions options = test::published_options(Method::verified);
    for (int seed = 0; seed < robomill::test::seeds(30); ++seed) {
      Random random(static_cast<std::uint64_t>(seed), 21);
      const program::Program program = test::mixed_program(random, {.least_blocks = 60, .most_blocks = 200});
      const Posture posture = test::posture_for(program, *machine);
      PathInterpolator path(*machine, options, program.start, posture.gamma_rad[0], posture.start);
      const std::size_t at = 200 + random.index(4000);
      std::vector<Sample> samples;
      Sample sample;
      State state = State::waiting;
      std::size_t block = 0;
      while (state != State::stopped && state != State::finished && samples.size() < 100'000) {
        while (block < program.blocks.size() && path.push(program.blocks[block]).accepted()) ++block;
        if (block == program.blocks.size()) static_cast<void>(path.finish());
        if (random.uniform() < 0.002) path.hold();
        if (random.uniform() < 0.01) path.resume();
        if (random.uniform() < 0.005) path.set_override(random.uniform(0.2, 1.0));
        if (samples.size() == at) path.stop();
        state = path.next(sample);
        samples.push_back(sample);
      }
      ASSERT_NE(state, State::running) << seed;
      ASSERT_LT(samples.size(), at + 3000) << seed;
      for (int i = 0; i < 5; ++i) {
        EXPECT_EQ(path.next(sample), state);
        samples.push_back(sample);
      }
      // The rest of the program is missing, so that only motion is looked at.
      const CheckResult result = test::check(program, *machine, options, samples);
      for (const Violation& violation : result.worst_violations) {
        if (violation.order >= 1) ADD_FAILURE() << seed << " order " << violation.order << ' ' << violation.ratio;
      }
    }
  }
}

}  // namespace interpolator_limits_test
}  // namespace robomill::path
