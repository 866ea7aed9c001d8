#include "robomill/cutting/workpiece.hpp"

#include <benchmark/benchmark.h>

#include <cmath>
#include <numbers>

#include "robomill/cutting/program_engagement.hpp"

namespace robomill::cutting {
namespace {

using Eigen::Vector3d;
using program::Block;
using program::Pose;
using program::Program;

Cutter cutter_of(CutterKind kind) {
  Cutter cutter;
  cutter.kind = kind;
  cutter.mill = {.teeth = 2, .diameter_m = 6e-3};
  cutter.corner_radius_m = kind == CutterKind::bull_nose ? 1e-3 : 0.0;
  return cutter;
}

Stock blank() {
  Stock stock;
  stock.shape = Stock::Shape::turned;
  stock.outline_m = {{0.046, 0.0}, {0.046, 0.004}, {0.016, 0.036}};
  return stock;
}

/// 1,000 blocks of 0.8 mm between blades of a blank of 92 mm, the axis outwards and turning by 0.7 degrees a block.
Program blades() {
  Program program;
  constexpr int passes = 20;
  constexpr int blocks = 50;
  for (int pass = 0; pass < passes; ++pass) {
    for (int i = 0; i <= blocks; ++i) {
      const double share = i / static_cast<double>(blocks);
      const double angle = 2.0 * std::numbers::pi * pass / passes + 0.7 * share;
      const double radius = 0.012 + 0.034 * share;
      const double lean = 1.25 - 0.6 * share;
      Pose pose;
      pose.tip_m = {radius * std::cos(angle), radius * std::sin(angle), 0.028 - 0.026 * share};
      pose.axis = {std::sin(lean) * std::cos(angle), std::sin(lean) * std::sin(angle), std::cos(lean)};
      if (pass == 0 && i == 0) {
        program.start = pose;
        continue;
      }
      program.blocks.push_back({.kind = i == 0 ? Block::Kind::rapid : Block::Kind::feed,
                                .line = 0,
                                .end = pose,
                                .duration_s = i == 0 ? 0.0 : 0.1});
    }
  }
  return program;
}

/// One block of a pass, 1 mm long, at a dexel of 0.25 mm.
void one_block(benchmark::State& state, CutterKind kind) {
  const Cutter cutter = cutter_of(kind);
  const Profile profile(cutter);
  Workpiece part(blank(), 0.25e-3);
  const EngagementFinder finder(cutter, part.dexel_m(), {});
  const Vector3d axis = Vector3d(0.3, 0.2, 1.0).normalized();
  double x = -0.04;
  for (auto _ : state) {
    const Pose from = {.tip_m = {x, 0.0, 0.02}, .axis = axis};
    x = x > 0.04 ? -0.04 : x + 1e-3;
    const Pose to = {.tip_m = {x, 0.0, 0.02}, .axis = axis};
    benchmark::DoNotOptimize(finder.at(part, to, {.tip_m_per_s = {0.01, 0.0, 0.0}}, 0.0));
    benchmark::DoNotOptimize(part.remove(profile, from, to));
  }
}
BENCHMARK_CAPTURE(one_block, ball_end, CutterKind::ball_end)->Unit(benchmark::kMicrosecond)->UseRealTime();
BENCHMARK_CAPTURE(one_block, flat_end, CutterKind::flat_end)->Unit(benchmark::kMicrosecond)->UseRealTime();
BENCHMARK_CAPTURE(one_block, bull_nose, CutterKind::bull_nose)->Unit(benchmark::kMicrosecond)->UseRealTime();

void program_of_1000_blocks(benchmark::State& state) {
  const Program program = blades();
  double volume = 0.0;
  std::size_t bytes = 0;
  for (auto _ : state) {
    Workpiece part(blank(), 0.25e-3);
    volume = 0.0;
    walk(program, cutter_of(CutterKind::ball_end), part, {}, [&](std::span<const BlockEngagement> batch) {
      for (const BlockEngagement& block : batch) volume += block.removed_volume_m3;
    });
    bytes = part.memory_bytes();
  }
  state.counters["removed_mm3"] = volume * 1e9;
  state.counters["megabytes"] = static_cast<double>(bytes) * 1e-6;
}
BENCHMARK(program_of_1000_blocks)->Unit(benchmark::kMillisecond)->UseRealTime()->Iterations(2);

}  // namespace
}  // namespace robomill::cutting
