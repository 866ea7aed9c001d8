#include "robomill/simulation/simulation.hpp"

#include <benchmark/benchmark.h>

#include "robomill/simulation/drilling.hpp"
#include "testing/simulation/cuts.hpp"
#include "testing/simulation/posture_cases.hpp"

namespace {

using namespace robomill;
using namespace robomill::simulation;

template <class Cut>
void two_seconds(benchmark::State& state, const Cut& cut) {
  Simulation result;
  for (auto _ : state) {
    result = simulate(cut);
    benchmark::DoNotOptimize(result);
  }
  state.counters["steps_per_revolution"] = result.steps_per_revolution;
  state.counters["slices"] = result.slices;
}

MillingCut robot() {
  return simulation::testing::cut_of(stability::testing::robot(), 6500.0, 0.6e-3, 1e-5);
}

void robot_eight_modes(benchmark::State& state) {
  two_seconds(state, robot());
}
void robot_helix(benchmark::State& state) {
  MillingCut cut = robot();
  cut.milling.tool.helix_rad = 0.52;
  cut.axial_depth_m = 3e-3;
  two_seconds(state, cut);
}
void benchmark_slot(benchmark::State& state) {
  two_seconds(state, simulation::testing::cut_of(stability::testing::benchmark(1.0), 5000.0, 0.2e-3));
}
void benchmark_low_immersion(benchmark::State& state) {
  two_seconds(state, simulation::testing::cut_of(stability::testing::benchmark(0.05), 5000.0, 1e-3));
}
void drilling_three_modes(benchmark::State& state) {
  DrillingCut cut;
  cut.diameter_m = 0.01;
  cut.radial_width_m = 5e-4;
  cut.feed_per_revolution_m = 1e-4;
  cut.coefficients = {.tangential_n_per_m2 = 9e8, .radial_n_per_m2 = 5e8};
  cut.structure = modal::joined(simulation::testing::one_mode(0, 400.0, 0.03, 0.3),
                                simulation::testing::one_mode(1, 430.0, 0.03, 0.3));
  cut.structure = modal::joined(cut.structure, simulation::testing::one_mode(2, 900.0, 0.03, 0.5));
  cut.spindle_speed_rad_per_s = 3000.0 * simulation::testing::rpm;
  two_seconds(state, cut);
}

/// A ball end of two teeth at 18,000 rpm, 30 rings, on an arm that moves in all directions.
PostureCut ball_on_arm() {
  PostureCut cut = simulation::testing::ball_cut(0.2, 0.1);
  cut.motion.feed_per_tooth_m = 2e-5;
  cut.structure = simulation::testing::arm_modes();
  return cut;
}
void ball_end(benchmark::State& state) {
  two_seconds(state, ball_on_arm());
}
void small_vibration_of_ball_end(benchmark::State& state) {
  const PostureCut cut = ball_on_arm();
  for (auto _ : state) {
    SmallVibration small = small_vibration(cut);
    benchmark::DoNotOptimize(small);
  }
}

void small_vibration_of_robot(benchmark::State& state) {
  const MillingCut cut = robot();
  for (auto _ : state) {
    SmallVibration small = small_vibration(cut);
    benchmark::DoNotOptimize(small);
  }
}

/// Steps alone, by the number of modes.
void modes(benchmark::State& state) {
  stability::LobesProblem problem = stability::testing::benchmark(0.1);
  problem.dynamics.modes.clear();
  const auto count = static_cast<int>(state.range(0));
  for (int k = 0; k < count; ++k) {
    problem.dynamics.modes.push_back(stability::testing::mass_mode(k % 2, 300.0 + 600.0 * k / count, 0.02, 0.2));
  }
  const MillingCut cut = simulation::testing::cut_of(problem, 5000.0, 1e-4);
  const SimulationOptions options = {.steps_per_revolution = 1000};
  for (auto _ : state) {
    Simulation result = simulate(cut, options);
    benchmark::DoNotOptimize(result);
  }
}

}  // namespace

BENCHMARK(robot_eight_modes)->Unit(benchmark::kMillisecond);
BENCHMARK(robot_helix)->Unit(benchmark::kMillisecond);
BENCHMARK(benchmark_low_immersion)->Unit(benchmark::kMillisecond);
BENCHMARK(benchmark_slot)->Unit(benchmark::kMillisecond);
BENCHMARK(drilling_three_modes)->Unit(benchmark::kMillisecond);
BENCHMARK(ball_end)->Unit(benchmark::kMillisecond);
BENCHMARK(small_vibration_of_ball_end)->Unit(benchmark::kMillisecond);
BENCHMARK(small_vibration_of_robot)->Unit(benchmark::kMillisecond);
BENCHMARK(modes)->RangeMultiplier(2)->Range(1, 32)->Unit(benchmark::kMillisecond);
