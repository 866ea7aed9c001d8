#include <benchmark/benchmark.h>

#include "robomill/cutting/coefficients.hpp"
#include "robomill/cutting/engagement.hpp"
#include "robomill/cutting/force.hpp"
#include "testing/cutting/cutters.hpp"

namespace robomill::cutting {
namespace {

using testing::ball_end;
using testing::degree;
using testing::mm;

MillingCoefficients polynomials() {
  return {.tangential_n_per_m2 = {325.4e6, 435.8e6, -65.25e6, 1772e6},
          .radial_n_per_m2 = {700e6},
          .axial_n_per_m2 = {300e6},
          .tangential_edge_n_per_m = {13.15e3},
          .radial_edge_n_per_m = {15.43e3},
          .axial_edge_n_per_m = {-11.52e3}};
}

Cut pass() {
  return {.axial_depth_m = 1.2 * mm, .radial_depth_m = 1.0 * mm, .lead_rad = 0.2, .tilt_rad = -0.15};
}

// One revolution, 360 angles, 50 rings, 2 teeth.
void revolution(benchmark::State& state, double runout_m) {
  Cutter cutter = ball_end(3.0 * mm, 2, 30.0 * degree);
  cutter.mill.runout_m = runout_m;
  const Engagement engagement = engage(cutter, pass(), {.slices = 50});
  ForceKernel kernel(cutter, polynomials());
  const CutMotion motion = {.feed_per_tooth_m = 0.01 * mm, .spindle_speed_rad_per_s = 1885.0};
  CuttingForce force;
  for (auto _ : state) {
    kernel.revolution(engagement, motion, force);
    benchmark::DoNotOptimize(force.force_n.data());
  }
  state.counters["rings"] = static_cast<double>(engagement.slices.size());
}
void Revolution(benchmark::State& state) {
  revolution(state, 0.0);
}
void RevolutionWithRunout(benchmark::State& state) {
  revolution(state, 0.004 * mm);
}
BENCHMARK(Revolution)->Unit(benchmark::kMicrosecond);
BENCHMARK(RevolutionWithRunout)->Unit(benchmark::kMicrosecond);

void EngageBall(benchmark::State& state) {
  const Cutter cutter = ball_end(3.0 * mm);
  for (auto _ : state) benchmark::DoNotOptimize(engage(cutter, pass(), {.slices = 50}));
}
BENCHMARK(EngageBall)->Unit(benchmark::kMicrosecond);

void EngageBullNose(benchmark::State& state) {
  const Cutter cutter = testing::bull_nose(12.0 * mm, 2.0 * mm);
  for (auto _ : state) benchmark::DoNotOptimize(engage(cutter, pass(), {.slices = 50}));
}
BENCHMARK(EngageBullNose)->Unit(benchmark::kMicrosecond);

void EngageFlatUpright(benchmark::State& state) {
  const Cutter cutter = testing::flat_end(12.0 * mm);
  for (auto _ : state) {
    benchmark::DoNotOptimize(engage(cutter, {.axial_depth_m = 2.0 * mm, .radial_depth_m = mm}, {.slices = 50}));
  }
}
BENCHMARK(EngageFlatUpright)->Unit(benchmark::kMicrosecond);

void FitSlots(benchmark::State& state) {
  std::vector<SlotForce> rows;
  for (int i = 1; i <= 12; ++i) {
    rows.push_back({.feed_per_tooth_m = 0.01 * mm * i,
                    .axial_depth_m = 2.0 * mm,
                    .mean_force_n = Eigen::Vector3d(-50.0 - i, 60.0 + 2.0 * i, 10.0 + i)});
  }
  for (auto _ : state) benchmark::DoNotOptimize(identify_from_slots(rows, {.teeth = 4}));
}
BENCHMARK(FitSlots)->Unit(benchmark::kMicrosecond);

void FitSignal(benchmark::State& state) {
  const Cutter cutter = ball_end(3.0 * mm, 2, 30.0 * degree);
  const Engagement engagement = engage(cutter, pass());
  const CutMotion motion = {.feed_per_tooth_m = 0.01 * mm, .spindle_speed_rad_per_s = 1885.0};
  const CuttingForce force = cutting_force(cutter, engagement, polynomials(), motion);
  for (auto _ : state)
    benchmark::DoNotOptimize(identify_from_signal(cutter, engagement, motion, force.rotation_rad, force.force_n));
}
BENCHMARK(FitSignal)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace robomill::cutting
