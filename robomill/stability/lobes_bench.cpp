#include "robomill/stability/lobes.hpp"

#include <benchmark/benchmark.h>

#include "robomill/base/parallel.hpp"
#include "robomill/stability/test_problems.hpp"

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

}  // namespace

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
