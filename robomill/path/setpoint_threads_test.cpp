// The stream by the real clock, with its threads.
#include <gtest/gtest.h>

#include <atomic>
#include <thread>
#include <vector>

#include "robomill/path/setpoint_stream.hpp"
#include "testing/path/mixed_program.hpp"
#include "testing/path/ride.hpp"

namespace robomill::path {
namespace setpoint_threads_test {

using test::Machine;
using State = PathInterpolator::State;

// One thread plans, one runs, one reads, one commands; whatever their pace, all set-points arrive in order and none
// violates a limit.
TEST(SetpointThreads, EverySetpointArrives) {
  Random random(1, 41);
  const program::Program program = test::mixed_program(random, {.least_blocks = 8, .most_blocks = 8});
  const auto machine = test::make_machine(Machine::tilt_head);
  const SmoothingOptions options = test::published_options(Method::verified);
  const Posture posture = test::posture_for(program, *machine);
  PathInterpolator path(*machine, options, program.start, posture.gamma_rad[0], posture.start);
  SetpointStream stream(path, {.period_s = options.sample_period_s});
  std::thread planner([&] {
    for (const program::Block& block : program.blocks) {
      while (!path.push(block).accepted()) std::this_thread::yield();
    }
    while (!path.finish().accepted()) std::this_thread::yield();
  });
  std::thread loop([&] {
    MonotonicClock clock;
    stream.run(clock);
  });
  std::thread operator_of([&] {
    for (int i = 0; !stream.ended(); ++i) {
      if (i % 3 == 0) stream.hold();
      stream.set_override(i % 2 == 0 ? 0.6 : 1.0);
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
      stream.resume();
      std::this_thread::sleep_for(std::chrono::milliseconds(150));
    }
  });
  std::vector<Sample> samples;
  State last = State::waiting;
  while (stream.wait()) {
    for (; stream.begin() < stream.end(); stream.drop_before(stream.begin() + 1)) {
      samples.push_back(stream[stream.begin()].sample);
      last = stream[stream.begin()].state;
      // What is put out while no block has come does not count as a dwell.
      ASSERT_NEAR(samples.back().time_s, static_cast<double>(samples.size() - 1) * options.sample_period_s, 1e-9);
    }
  }
  for (std::thread* const each : {&planner, &loop, &operator_of}) each->join();
  EXPECT_EQ(last, State::finished);
  const StreamReport& report = stream.report();
  EXPECT_EQ(report.periods, samples.size() + report.overruns);
  EXPECT_EQ(report.wake_up.count(), report.periods);
  EXPECT_LE(report.wake_up.mean_s(), report.hand_over.mean_s());
  CheckResult result = test::check(program, *machine, options, samples);
  EXPECT_EQ(result.violations() - result.dwell_s.violations, 0U);
  EXPECT_LT((samples.back().tip_m - program.blocks.back().end.tip_m).norm(), 1e-12);
}

}  // namespace setpoint_threads_test
}  // namespace robomill::path
