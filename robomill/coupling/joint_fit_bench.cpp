#include "robomill/coupling/joint_fit.hpp"

#include <benchmark/benchmark.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "robomill/base/random.hpp"
#include "testing/coupling/beams.hpp"

namespace robomill::coupling {
namespace {

/// 5,000 lines of the published pair with a planted joint and 1 % of noise, or with none: the rigid bar.
modal::FrfSet measured(bool rigid) {
  Assembly assembly = testing::published_pair();
  if (!rigid) {
    assembly.joint = Joint{.translational_stiffness_n_per_m = 2e7,
                           .translational_damping_n_s_per_m = 40.0,
                           .rotational_stiffness_n_m_per_rad = 5e4,
                           .rotational_damping_n_m_s_per_rad = 0.5};
  }
  modal::FrfSet set = tip_frfs(assembly, testing::hertz(5000)).frfs;
  set.frfs.resize(1);
  if (rigid) return set;
  Random random(1);
  for (std::complex<double>& h : set.frfs[0].receptance) {
    h += 0.01 * std::abs(h) / std::numbers::sqrt2 * std::complex<double>(random.normal(), random.normal());
  }
  return set;
}

void joint(benchmark::State& state, JointMethod method, bool rigid) {
  const modal::FrfSet set = measured(rigid);
  JointFitResult result;
  for (auto _ : state) result = fit_joint(testing::published_pair(), set, {.method = method});
  state.counters["lines"] = static_cast<double>(set.frequency_hz.size());
  state.counters["iterations"] = result.iterations;
  state.counters["objective"] = result.objective_m_per_n;
}
BENCHMARK_CAPTURE(joint, hybrid_planted, JointMethod::hybrid, false)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();
BENCHMARK_CAPTURE(joint, hybrid_rigid, JointMethod::hybrid, true)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();
BENCHMARK_CAPTURE(joint, ga_rigid, JointMethod::ga, true)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

}  // namespace
}  // namespace robomill::coupling
