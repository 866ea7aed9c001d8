#include <benchmark/benchmark.h>

#include "testing/path/ride.hpp"
#include "testing/path/winding.hpp"

namespace {

using namespace robomill;
using path::test::Machine;

/// A winding program with 0.6 mm blocks, all of it before the machine that can be.
struct Bench {
  explicit Bench(Machine kind)
      : machine(path::test::make_machine(kind)),
        posture(path::test::posture_for(first_turn(), *machine)),
        interpolator(*machine, path::test::published_options(path::Method::verified), path::test::Winding::start(),
                     posture.gamma_rad[0], posture.start) {}
  static program::Program first_turn() {
    program::Program out{.start = path::test::Winding::start(), .blocks = {}};
    for (path::test::Winding winding; out.blocks.size() < 5000; winding.take()) out.blocks.push_back(winding.block());
    return out;
  }
  void fill() {
    while (interpolator.push(winding.block()).accepted()) winding.take();
  }
  std::unique_ptr<robot::Kinematics> machine;
  path::Posture posture;
  path::PathInterpolator interpolator;
  path::test::Winding winding;
  path::Sample sample;
};

/// One sample, inverse kinematics included.
void next_sample(benchmark::State& state, Machine kind, double override_share) {
  Bench bench(kind);
  bench.interpolator.set_override(override_share);
  for (auto _ : state) {
    if (bench.interpolator.ready_s() < 2.0) {
      state.PauseTiming();
      bench.fill();
      state.ResumeTiming();
    }
    benchmark::DoNotOptimize(bench.interpolator.next(bench.sample));
  }
}
BENCHMARK_CAPTURE(next_sample, kr210, Machine::kr210, 1.0);
BENCHMARK_CAPTURE(next_sample, kr210_at_150_percent, Machine::kr210, 1.5);
BENCHMARK_CAPTURE(next_sample, hybrid, Machine::hybrid, 1.0);

/// One block, planned and looked at.
void push_block(benchmark::State& state, Machine kind) {
  Bench bench(kind);
  for (auto _ : state) {
    while (!bench.interpolator.push(bench.winding.block()).accepted()) {
      state.PauseTiming();
      for (int i = 0; i < 1000; ++i) bench.interpolator.next(bench.sample);
      state.ResumeTiming();
    }
    bench.winding.take();
  }
}
BENCHMARK_CAPTURE(push_block, kr210, Machine::kr210)->Unit(benchmark::kMicrosecond);

/// From hold() to rest, in samples; the time is that of the samples.
void hold(benchmark::State& state, Machine kind) {
  Bench bench(kind);
  double cycles = 0.0, longest = 0.0;
  for (auto _ : state) {
    bench.interpolator.resume();
    for (int i = 0; i < 777; ++i) {
      bench.fill();
      bench.interpolator.next(bench.sample);
    }
    bench.interpolator.hold();
    double n = 0.0;
    while (bench.interpolator.next(bench.sample) == path::PathInterpolator::State::running) n += 1.0;
    cycles += n;
    longest = std::max(longest, n);
  }
  state.counters["mean_ms"] = cycles / static_cast<double>(state.iterations());
  state.counters["longest_ms"] = longest;
}
BENCHMARK_CAPTURE(hold, kr210, Machine::kr210)->Iterations(100)->Unit(benchmark::kMillisecond);

}  // namespace
