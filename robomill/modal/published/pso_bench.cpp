#include "robomill/modal/published/pso.hpp"

#include <benchmark/benchmark.h>

#include <complex>
#include <span>
#include <vector>

#include "robomill/modal/published/pso_misfit.hpp"
#include "testing/modal/fit_cases.hpp"
#include "testing/robot_modes.hpp"

namespace robomill::modal {
namespace {

const Dof axis_x{.point = 0, .axis = Axis::x};

/// H_xx and H_yx of the robot, 3,981 lines each.
FrfSet x_hits() {
  FrfSet frfs = synthesize(data::robot_modes(), cases::robot_lines());
  std::erase_if(frfs.frfs, [](const Frf& frf) { return frf.name.excitation != axis_x; });
  return frfs;
}

/// 1,000 iterations of 400 particles, eight modes, the two FRFs of the x hits.
void thousand_iterations(benchmark::State& state) {
  const FrfSet frfs = x_hits();
  PsoOptions options;
  options.modes = 8;
  options.lines = 0;
  options.max_iterations = 1000;
  options.inertia_iterations = 1000;
  options.stall_iterations = 1000;  // run to the end
  PsoResult result;
  for (auto _ : state) result = fit_pso(frfs, options);
  state.counters["iterations"] = result.iterations;
  state.counters["particles"] = options.particles;
  state.counters["modes"] = options.modes;
  state.counters["lines"] = static_cast<double>(frfs.frequency_hz.size());
  state.counters["misfit"] = result.best.back();
}
BENCHMARK(thousand_iterations)->Unit(benchmark::kSecond)->UseRealTime()->MeasureProcessCPUTime()->Iterations(1);

/// One particle's misfit: eight modes, two FRFs.
void misfit(benchmark::State& state, detail::Simd simd) {
  if (!detail::supports(simd)) {
    state.SkipWithError("not on this processor");
    return;
  }
  const FrfSet frfs = x_hits();
  const std::vector<const Frf*> targets = {&frfs.frfs[0], &frfs.frfs[1]};
  const detail::Misfit evaluate(frfs.frequency_hz, targets, simd);
  const ModalModel model = data::robot_modes();
  std::vector<Eigen::VectorXcd> residues;
  std::vector<detail::MisfitMode> modes;
  for (const Mode& mode : model.modes) residues.push_back(mode.right * mode.left(0));
  for (std::size_t k = 0; k < residues.size(); ++k) {
    modes.push_back({.frequency_hz = model.modes[k].frequency_hz,
                     .damping_ratio = model.modes[k].damping_ratio,
                     .residues = std::span<const std::complex<double>>(residues[k].data(), 2)});
  }
  for (auto _ : state) benchmark::DoNotOptimize(evaluate(modes));
  state.counters["modes"] = static_cast<double>(modes.size());
  state.counters["lines"] = static_cast<double>(frfs.frequency_hz.size());
}
BENCHMARK_CAPTURE(misfit, baseline, detail::Simd::baseline)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(misfit, avx2, detail::Simd::avx2)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace robomill::modal
