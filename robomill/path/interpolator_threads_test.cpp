// One thread reads a program, another runs it.
#include <gtest/gtest.h>

#include <cstdint>
#include <thread>
#include <vector>

#include "testing/path/mixed_program.hpp"
#include "testing/path/ride.hpp"
#include "testing/support.hpp"

namespace robomill::path {
namespace interpolator_threads_test {

using test::Machine;
using State = PathInterpolator::State;

// Two threads at their own pace; what is run does not depend on it, only when.
TEST(InterpolatorThreads, RunAProgramWhileItIsRead) {
  const auto machine = test::make_machine(Machine::kr210);
  const SmoothingOptions options = test::published_options(Method::verified);
  for (int seed = 0; seed < robomill::test::seeds(20); ++seed) {
    Random random(static_cast<std::uint64_t>(seed), 19);
    const program::Program program = test::mixed_program(random, {.least_blocks = 150, .most_blocks = 200});
    const Posture posture = test::posture_for(program, *machine);
    PathInterpolator path(*machine, options, program.start, posture.gamma_rad[0], posture.start);
    std::thread reader([&] {
      Random own(static_cast<std::uint64_t>(seed), 20);
      for (const program::Block& block : program.blocks) {
        while (!path.push(block).accepted()) std::this_thread::yield();
        if (own.uniform() < 0.05) path.set_override(own.uniform(0.3, 1.0));
        if (own.uniform() < 0.02) path.hold();
      }
      while (!path.finish().accepted()) std::this_thread::yield();
    });
    std::vector<Sample> samples;
    Sample sample;
    for (State state = State::waiting; state != State::finished;) {
      state = path.next(sample);
      if (state == State::holding) path.resume();
      if (state == State::waiting || state == State::holding) {
        std::this_thread::yield();
        // Standing still is no news: a few samples of it do.
        if (samples.size() > 10 && samples[samples.size() - 10].path_m == sample.path_m) continue;
      }
      sample.time_s = static_cast<double>(samples.size()) * options.sample_period_s;
      samples.push_back(sample);
    }
    reader.join();
    EXPECT_LT((samples.back().tip_m - program.blocks.back().end.tip_m).norm(), 1e-15);
    CheckResult result = test::check(program, *machine, options, samples);
    result.dwell_s.violations = 0;  // what was left out may have been one
    EXPECT_EQ(result.violations(), 0U) << seed;
  }
}

}  // namespace interpolator_threads_test
}  // namespace robomill::path
