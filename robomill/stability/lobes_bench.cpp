#include "robomill/stability/lobes.hpp"

#include <benchmark/benchmark.h>

#include "robomill/base/parallel.hpp"
#include "robomill/stability/uncertainty.hpp"
#include "testing/stability/problems.hpp"

namespace {

using namespace robomill;
using namespace robomill::stability;

void run(benchmark::State& state, const LobesProblem& problem, LobesOptions options, Output output) {
  options.output = output;
  LobesResult result;
  for (auto _ : state) {
    result = compute_lobes(problem, options);
    benchmark::DoNotOptimize(result);
  }
  state.counters["points"] = static_cast<double>(options.grid[0]) * options.grid[1];
  state.counters["intervals"] = options.intervals;
  state.counters["threads"] = thread_count();
  state.counters["evaluations"] = static_cast<double>(result.evaluations);
}

void benchmark_map(benchmark::State& state) {
  run(state, stability::testing::benchmark(0.05), stability::testing::chart(5000, 25000, 0.01, 200, 200), Output::map);
}
void benchmark_slot_map(benchmark::State& state) {
  run(state, stability::testing::benchmark(1.0), stability::testing::chart(5000, 25000, 0.004, 200, 200), Output::map);
}
void benchmark_boundary(benchmark::State& state) {
  run(state, stability::testing::benchmark(0.05), stability::testing::chart(5000, 25000, 0.01, 200, 200),
      Output::boundary);
}
void robot_map(benchmark::State& state) {
  run(state, stability::testing::robot(), stability::testing::chart(4000, 16000, 0.003, 200, 200), Output::map);
}
void robot_boundary(benchmark::State& state) {
  run(state, stability::testing::robot(), stability::testing::chart(4000, 16000, 0.003, 200, 200), Output::boundary);
}
void robot_helix_map(benchmark::State& state) {
  LobesProblem problem = stability::testing::robot();
  problem.milling.tool.helix_rad = 30.0 / 180.0 * std::numbers::pi;
  run(state, problem, stability::testing::chart(4000, 16000, 0.003, 200, 200), Output::map);
}
void robot_unequal_pitch_map(benchmark::State& state) {
  LobesProblem problem = stability::testing::robot();
  const double degree = std::numbers::pi / 180.0;
  problem.milling.tool.pitch_rad = {110.0 * degree, 120.0 * degree, 130.0 * degree};
  run(state, problem, stability::testing::chart(4000, 16000, 0.003, 200, 200), Output::map);
}

LobesOptions traced(double from_rpm, double to_rpm, double depth_m) {
  LobesOptions options = stability::testing::chart(from_rpm, to_rpm, depth_m, 200, 200);
  options.method = Method::collocation;
  return options;
}
void collocation_point(benchmark::State& state) {
  const LobesProblem problem = stability::testing::benchmark(0.01 * static_cast<double>(state.range(0)));
  PointResult point;
  for (auto _ : state) {
    point = evaluate_point(problem, {}, {5000.0 * stability::testing::rpm, 0.2e-3});
    benchmark::DoNotOptimize(point);
  }
  state.counters["error_estimate"] = point.error_estimate;
}
void collocation_map(benchmark::State& state) {
  run(state, stability::testing::benchmark(0.05), traced(5000, 25000, 0.01), Output::map);
}
void collocation_boundary(benchmark::State& state) {
  run(state, stability::testing::benchmark(0.05), traced(5000, 25000, 0.01), Output::boundary);
}
void collocation_slot_boundary(benchmark::State& state) {
  run(state, stability::testing::benchmark(1.0), traced(5000, 25000, 0.004), Output::boundary);
}
void collocation_robot_boundary(benchmark::State& state) {
  run(state, stability::testing::robot(), traced(4000, 16000, 0.003), Output::boundary);
}
void collocation_robot_helix_boundary(benchmark::State& state) {
  LobesProblem problem = stability::testing::robot();
  problem.milling.tool.helix_rad = 30.0 / 180.0 * std::numbers::pi;
  run(state, problem, traced(4000, 16000, 0.003), Output::boundary);
}

void uncertain_samples(benchmark::State& state) {
  const LobesProblem problem = stability::testing::benchmark(0.05);
  const LobesOptions options = traced(5000, 25000, 0.01);
  Uncertainty uncertainty;
  uncertainty.grid = {100, 50};
  uncertainty.samples = static_cast<int>(state.range(0));
  uncertainty.tangential_std_n_per_m2 = 3e7;
  uncertainty.frequency_std_ratio = 0.01;
  uncertainty.damping_std_ratio = 0.1;
  for (auto _ : state) benchmark::DoNotOptimize(uncertain_limits(problem, options, uncertainty));
  state.counters["samples"] = static_cast<double>(state.range(0));
}
/// The robot's modes again and again, a little apart.
void modes(benchmark::State& state) {
  LobesProblem problem = stability::testing::robot();
  const std::vector<modal::Mode> eight = problem.dynamics.modes;
  problem.dynamics.modes.clear();
  for (std::int64_t k = 0; k < state.range(0); ++k) {
    modal::Mode mode = eight[static_cast<std::size_t>((7 - k % 8) % 8)];
    const double round = static_cast<double>(k / 8);
    mode.frequency_hz *= 1.0 + 0.07 * round;
    mode.right *= 1.0 / (1.0 + round);
    problem.dynamics.modes.push_back(mode);
  }
  run(state, problem, traced(4000, 16000, 0.003), Output::map);
}

}  // namespace

BENCHMARK(uncertain_samples)->Arg(100)->Unit(benchmark::kSecond)->UseRealTime()->MeasureProcessCPUTime();
BENCHMARK(modes)->RangeMultiplier(2)->Range(1, 32)->Unit(benchmark::kSecond)->UseRealTime()->MeasureProcessCPUTime();
BENCHMARK(collocation_point)->Arg(5)->Arg(100)->Unit(benchmark::kMicrosecond);
BENCHMARK(collocation_map)->Unit(benchmark::kSecond)->UseRealTime()->MeasureProcessCPUTime();
BENCHMARK(collocation_boundary)->Unit(benchmark::kSecond)->UseRealTime()->MeasureProcessCPUTime();
BENCHMARK(collocation_slot_boundary)->Unit(benchmark::kSecond)->UseRealTime()->MeasureProcessCPUTime();
BENCHMARK(collocation_robot_boundary)->Unit(benchmark::kSecond)->UseRealTime()->MeasureProcessCPUTime();
BENCHMARK(collocation_robot_helix_boundary)->Unit(benchmark::kSecond)->UseRealTime()->MeasureProcessCPUTime();
BENCHMARK(benchmark_map)->Unit(benchmark::kSecond)->UseRealTime()->MeasureProcessCPUTime();
BENCHMARK(benchmark_slot_map)->Unit(benchmark::kSecond)->UseRealTime()->MeasureProcessCPUTime();
BENCHMARK(benchmark_boundary)->Unit(benchmark::kSecond)->UseRealTime()->MeasureProcessCPUTime();
BENCHMARK(robot_map)->Unit(benchmark::kSecond)->UseRealTime()->MeasureProcessCPUTime();
BENCHMARK(robot_boundary)->Unit(benchmark::kSecond)->UseRealTime()->MeasureProcessCPUTime();
BENCHMARK(robot_helix_map)->Unit(benchmark::kSecond)->UseRealTime()->MeasureProcessCPUTime();
BENCHMARK(robot_unequal_pitch_map)->Unit(benchmark::kSecond)->UseRealTime()->MeasureProcessCPUTime();
