#include <benchmark/benchmark.h>

#include "robomill/coupling/assembly.hpp"
#include "robomill/coupling/holder.hpp"
#include "testing/coupling/beams.hpp"

namespace robomill::coupling {
namespace {

/// 5,000 frequencies of ten Timoshenko segments, through a joint, on a holder: to take less than 5 ms.
void TenSegments(benchmark::State& state) {
  Assembly assembly;
  for (int i = 0; i < 10; ++i) {
    assembly.tool.push_back(testing::bar(0.012, Beam::timoshenko));
    assembly.tool.back().diameter_m = 0.012 + 0.001 * i;
  }
  assembly.joint = Joint{.translational_stiffness_n_per_m = 2e7, .rotational_stiffness_n_m_per_rad = 5e4};
  assembly.holder.segments = {testing::bar(0.05090)};
  const Eigen::VectorXd f = testing::hertz(5000);
  for (auto _ : state) benchmark::DoNotOptimize(tip_frfs(assembly, f));
}
BENCHMARK(TenSegments)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();

/// The same of one long beam, whose waves are shorter than the series reaches.
void LongBeam(benchmark::State& state) {
  const Assembly assembly{.tool = {testing::bar(0.5, Beam::timoshenko)}, .joint = {}, .holder = {}};
  const Eigen::VectorXd f = testing::hertz(5000);
  for (auto _ : state) benchmark::DoNotOptimize(tip_frfs(assembly, f));
}
BENCHMARK(LongBeam)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();

void DistributedJoint(benchmark::State& state) {
  Assembly assembly = testing::published_pair();
  assembly.joint = Joint{.translational_stiffness_n_per_m = 2e7,
                         .rotational_stiffness_n_m_per_rad = 5e4,
                         .points = 5,
                         .insertion_length_m = 0.04,
                         .shank = {testing::bar(0.04)}};
  const Eigen::VectorXd f = testing::hertz(5000);
  for (auto _ : state) benchmark::DoNotOptimize(tip_frfs(assembly, f));
}
BENCHMARK(DistributedJoint)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();

/// 5,000 lines of an artefact with rotations at its tip taken off.
void RemoveArtefact(benchmark::State& state) {
  const Eigen::VectorXd f = testing::hertz(5000);
  modal::FrfSet measured = tip_frfs(testing::published_pair(), f, {.rotations = true}).frfs;
  for (modal::Frf& frf : measured.frfs) frf.name.response.point = frf.name.excitation.point = 1;
  for (auto _ : state) benchmark::DoNotOptimize(remove_artefact(measured, {0.0}, {testing::bar(0.11892)}));
}
BENCHMARK(RemoveArtefact)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();

}  // namespace
}  // namespace robomill::coupling
