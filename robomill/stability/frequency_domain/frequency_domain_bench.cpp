#include "robomill/stability/frequency_domain/frequency_domain.hpp"

#include <benchmark/benchmark.h>

#include <numbers>

#include "robomill/stability/peak_classification.hpp"
#include "testing/stability/problems.hpp"

namespace {

using namespace robomill;
using namespace robomill::stability;
using stability::testing::rpm;

std::vector<double> speeds(double from_rpm, double to_rpm, int count) {
  std::vector<double> out;
  for (int i = 0; i < count; ++i) out.push_back((from_rpm + (to_rpm - from_rpm) * i / (count - 1)) * rpm);
  return out;
}

template <class Limits>
void run(benchmark::State& state, Limits limits, const LobesProblem& problem, const FrequencyResponse& response,
         const std::vector<double>& at, double depth_m) {
  for (auto _ : state) {
    auto found = limits(problem.milling, response, at, FrequencyOptions{.largest_depth_m = depth_m}, Progress::none());
    benchmark::DoNotOptimize(found);
  }
  state.counters["speeds"] = static_cast<double>(at.size());
}

FrequencyResponse measured(const LobesProblem& problem, double high_hz) {
  const auto lines = static_cast<Eigen::Index>(high_hz * 4.0) + 1;
  return FrequencyResponse::of_frfs(
      modal::synthesize(problem.dynamics, Eigen::VectorXd::LinSpaced(lines, 0.0, high_hz)), problem.feed_direction_rad);
}

void multi_frequency_benchmark(benchmark::State& state) {
  const LobesProblem p = stability::testing::benchmark(0.05);
  run(state, multi_frequency_limits, p, FrequencyResponse::of_modes(p), speeds(5000, 25000, 200), 0.01);
}
void multi_frequency_benchmark_slot(benchmark::State& state) {
  const LobesProblem p = stability::testing::benchmark(1.0);
  run(state, multi_frequency_limits, p, FrequencyResponse::of_modes(p), speeds(5000, 25000, 40), 0.004);
}
void multi_frequency_robot(benchmark::State& state) {
  const LobesProblem p = stability::testing::robot();
  run(state, multi_frequency_limits, p, FrequencyResponse::of_modes(p), speeds(4000, 16000, 200), 0.003);
}
void multi_frequency_robot_from_frfs(benchmark::State& state) {
  const LobesProblem p = stability::testing::robot();
  run(state, multi_frequency_limits, p, measured(p, 4000.0), speeds(4000, 16000, 40), 0.003);
}
void multi_frequency_robot_helix(benchmark::State& state) {
  LobesProblem p = stability::testing::robot();
  p.milling.tool.helix_rad = std::numbers::pi / 6.0;
  run(state, multi_frequency_limits, p, FrequencyResponse::of_modes(p), speeds(4000, 16000, 10), 0.003);
}
void multi_frequency_robot_unequal_pitch(benchmark::State& state) {
  LobesProblem p = stability::testing::robot();
  const double degree = std::numbers::pi / 180.0;
  p.milling.tool.pitch_rad = {110.0 * degree, 120.0 * degree, 130.0 * degree};
  run(state, multi_frequency_limits, p, FrequencyResponse::of_modes(p), speeds(4000, 16000, 10), 0.003);
}
void zeroth_order_robot(benchmark::State& state) {
  const LobesProblem p = stability::testing::robot();
  run(state, zeroth_order_limits, p, FrequencyResponse::of_modes(p), speeds(4000, 16000, 200), 0.003);
}
void frfs_to_interpolation(benchmark::State& state) {
  const LobesProblem p = stability::testing::robot();
  const modal::FrfSet set = modal::synthesize(p.dynamics, Eigen::VectorXd::LinSpaced(16001, 0.0, 4000.0));
  for (auto _ : state) {
    FrequencyResponse response = FrequencyResponse::of_frfs(set, 0.0);
    benchmark::DoNotOptimize(response);
  }
}
void chatter_mechanism_robot(benchmark::State& state) {
  const LobesProblem p = stability::testing::robot();
  for (auto _ : state) {
    ChatterMechanism verdict = chatter_mechanism(p, {6500 * rpm, 0.8e-3});
    benchmark::DoNotOptimize(verdict);
  }
}

}  // namespace

BENCHMARK(multi_frequency_benchmark)->Unit(benchmark::kSecond)->UseRealTime()->MeasureProcessCPUTime();
BENCHMARK(multi_frequency_benchmark_slot)->Unit(benchmark::kSecond)->UseRealTime()->MeasureProcessCPUTime();
BENCHMARK(multi_frequency_robot)->Unit(benchmark::kSecond)->UseRealTime()->MeasureProcessCPUTime();
BENCHMARK(multi_frequency_robot_from_frfs)->Unit(benchmark::kSecond)->UseRealTime()->MeasureProcessCPUTime();
BENCHMARK(multi_frequency_robot_helix)->Unit(benchmark::kSecond)->UseRealTime()->MeasureProcessCPUTime();
BENCHMARK(multi_frequency_robot_unequal_pitch)->Unit(benchmark::kSecond)->UseRealTime()->MeasureProcessCPUTime();
BENCHMARK(zeroth_order_robot)->Unit(benchmark::kMillisecond)->UseRealTime()->MeasureProcessCPUTime();
BENCHMARK(frfs_to_interpolation)->Unit(benchmark::kMillisecond)->UseRealTime()->MeasureProcessCPUTime();
BENCHMARK(chatter_mechanism_robot)->Unit(benchmark::kMillisecond)->UseRealTime()->MeasureProcessCPUTime();
