// The surface that a block of a program leaves, beside its spectral radius; the plane's.
#include <benchmark/benchmark.h>

#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/stability/surface_error.hpp"
#include "testing/stability/blocks.hpp"
#include "testing/stability/problems.hpp"

namespace robomill::stability {
namespace {

constexpr double tolerance = 1e-4;  // of a block

/// Blocks of so many modes; unequal: of teeth that differ, each period of which is a revolution.
std::vector<testing::BlockCase> blocks(int modes, bool unequal) {
  std::vector<testing::BlockCase> all;
  for (std::uint64_t seed = 0; seed < 64; ++seed) {
    Random random(731, seed);
    testing::BlockCase block = testing::block_case(random, modes);
    SpatialMilling& milling = *block.problem.spatial;
    milling.feed_per_tooth_m = 5e-5;
    if (unequal) {
      milling.cutter.mill.pitch_rad.assign(static_cast<std::size_t>(milling.cutter.mill.teeth),
                                           2.0 * std::numbers::pi / milling.cutter.mill.teeth);
      milling.cutter.mill.pitch_rad.front() += 0.1;
      milling.cutter.mill.pitch_rad.back() -= 0.1;
    }
    all.push_back(block);
  }
  return all;
}

/// The number of modes; whether teeth differ.
void surface_of_a_block(benchmark::State& state) {
  const std::vector<testing::BlockCase> all = blocks(static_cast<int>(state.range(0)), state.range(1) != 0);
  std::size_t at = 0;
  for (auto _ : state) {
    const testing::BlockCase& block = all[at++ % all.size()];
    benchmark::DoNotOptimize(
        surface_of_stable_cut(block.problem, {block.spindle_speed_rad_per_s, block.depth_m}, tolerance));
  }
}

void radius_of_a_block(benchmark::State& state) {
  const std::vector<testing::BlockCase> all = blocks(static_cast<int>(state.range(0)), state.range(1) != 0);
  std::size_t at = 0;
  for (auto _ : state) {
    const testing::BlockCase& block = all[at++ % all.size()];
    benchmark::DoNotOptimize(
        evaluate_point(block.problem, {.tolerance = tolerance}, {block.spindle_speed_rad_per_s, block.depth_m}));
  }
}

void surface_in_the_plane(benchmark::State& state) {
  LobesProblem problem = testing::robot();
  problem.milling.feed_per_tooth_m = 5e-5;
  for (auto _ : state) {
    benchmark::DoNotOptimize(surface_of_stable_cut(problem, {7000.0 * testing::rpm, 1e-4}, tolerance));
  }
}

BENCHMARK(surface_of_a_block)->ArgsProduct({{8, 16, 32}, {0, 1}})->Unit(benchmark::kMillisecond);
BENCHMARK(radius_of_a_block)->ArgsProduct({{8, 16, 32}, {0, 1}})->Unit(benchmark::kMillisecond);
BENCHMARK(surface_in_the_plane)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace robomill::stability
