// Cuts in three directions: one limit, a boundary, one radius, a gain margin, a block of a program.
#include <benchmark/benchmark.h>

#include "robomill/base/random.hpp"
#include "robomill/stability/block.hpp"
#include "robomill/stability/sweep.hpp"
#include "testing/stability/blocks.hpp"
#include "testing/stability/problems.hpp"
#include "testing/stability/spatial_cases.hpp"

namespace robomill::stability {
namespace {

using testing::rpm;

LobesOptions depths() {
  LobesOptions options;
  options.spindle_speed_rad_per_s = {8000.0 * rpm, 24000.0 * rpm};
  options.axial_depth_m = {0.0, 1.5e-3};
  options.grid = {100, 31};
  return options;
}

/// The reference cut of this number, from 1.
const testing::SpatialReference& reference(const benchmark::State& state) {
  static const std::vector<testing::SpatialReference> all = testing::spatial_references();
  return all[static_cast<std::size_t>(state.range(0)) - 1];
}

void spatial_limit(benchmark::State& state) {
  const testing::SpatialReference& cut = reference(state);
  for (auto _ : state) benchmark::DoNotOptimize(limit_depths(cut.problem, depths(), {cut.limit_speed_rpm * rpm}));
}

void spatial_limits_of_100_speeds(benchmark::State& state) {
  std::vector<double> speeds;
  for (int i = 0; i < 100; ++i) speeds.push_back((8000.0 + 160.0 * i) * rpm);
  for (auto _ : state) benchmark::DoNotOptimize(limit_depths(reference(state).problem, depths(), speeds));
}

void spatial_boundary(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(compute_lobes(reference(state).problem, depths()));
}

void spatial_radius(benchmark::State& state) {
  const testing::SpatialReference& cut = reference(state);
  const OperatingPoint point{cut.speed_rpm * rpm, 1e-3 * cut.depth_mm};
  for (auto _ : state) benchmark::DoNotOptimize(evaluate_point(cut.problem, {}, point));
}

void spatial_gain_margin(benchmark::State& state) {
  const testing::SpatialReference& cut = reference(state);
  const OperatingPoint point{cut.speed_rpm * rpm, 1e-3 * cut.depth_mm};
  for (auto _ : state) benchmark::DoNotOptimize(gain_margin(cut.problem, point));
}

/// Every node of a map to 1e-6, of a ball end's slot and a structure of a robot's kind with so many modes.
void spatial_map(benchmark::State& state) {
  Random random(731);
  LobesProblem problem = testing::spatial_references().front().problem;
  problem.dynamics = testing::robot_like_modes(random, static_cast<int>(state.range(0)));
  LobesOptions options = depths();
  options.grid = {50, 40};
  options.output = Output::map;
  for (auto _ : state) benchmark::DoNotOptimize(compute_lobes(problem, options));
}

/// Radius, limit, margin, regime and quantiles of one block after the other; the number of modes. Processor time.
void block_of_a_program(benchmark::State& state) {
  std::vector<testing::BlockCase> blocks;
  for (std::uint64_t seed = 0; seed < 64; ++seed) {
    Random random(731, seed);
    blocks.push_back(testing::block_case(random, static_cast<int>(state.range(0))));
  }
  std::size_t at = 0;
  for (auto _ : state) {
    const testing::BlockCase& block = blocks[at++ % blocks.size()];
    benchmark::DoNotOptimize(block_stability(block.problem, block.spindle_speed_rad_per_s, block.depth_m));
  }
}

BENCHMARK(block_of_a_program)->Arg(4)->Arg(8)->Arg(10)->Arg(16)->Arg(32)->MinTime(1.0)->Unit(benchmark::kMillisecond);
BENCHMARK(spatial_limit)->DenseRange(1, 5)->Unit(benchmark::kMillisecond);
BENCHMARK(spatial_radius)->DenseRange(1, 5)->Unit(benchmark::kMillisecond);
BENCHMARK(spatial_gain_margin)->DenseRange(1, 5)->Unit(benchmark::kMillisecond);
BENCHMARK(spatial_limits_of_100_speeds)->DenseRange(1, 4)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(spatial_map)->Arg(8)->Arg(32)->Unit(benchmark::kMillisecond)->UseRealTime()->MeasureProcessCPUTime();
BENCHMARK(spatial_boundary)->DenseRange(1, 4)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace robomill::stability
