#include "robomill/modal/fit.hpp"

#include <benchmark/benchmark.h>

#include "testing/modal/fit_cases.hpp"
#include "testing/robot_modes.hpp"

namespace robomill::modal {
namespace {

// A row of five points along a structure: each mode is a random shape, one excitation.
FrfSet five_points() {
  Random random(7);
  ModalModel model{.excitations = {{.point = 1, .axis = Axis::z}}, .responses = {}, .modes = {}};
  for (int point = 1; point <= 5; ++point) model.responses.push_back({.point = point, .axis = Axis::z});
  for (int k = 0; k < 8; ++k) {
    Mode mode{.frequency_hz = 150.0 * (k + 1) * random.uniform(0.9, 1.1),
              .damping_ratio = random.uniform(0.005, 0.05),
              .left = Eigen::VectorXcd::Ones(1),
              .right = Eigen::VectorXcd(5)};
    for (std::complex<double>& r : mode.right) r = {1e-8 * random.normal(), 1e-7 * random.normal()};
    model.modes.push_back(mode);
  }
  FrfSet set = synthesize(model, Eigen::VectorXd::LinSpaced(3500, 0.5, 1750.0));
  cases::add_noise(set, 0.02, 3);
  return set;
}

FrfSet noisy_robot() {
  FrfSet set = synthesize(data::robot_modes(), cases::robot_lines());
  cases::add_noise(set, 0.02, 1);
  return set;
}

void report(benchmark::State& state, const FrfSet& set, const FitOptions& options) {
  FitResult result;
  for (auto _ : state) {
    result = fit_modes(set, options);
    benchmark::DoNotOptimize(result.relative_error);
  }
  state.counters["frfs"] = static_cast<double>(set.frfs.size());
  state.counters["lines"] = static_cast<double>(result.lines);
  state.counters["modes"] = static_cast<double>(result.model.modes.size());
  state.counters["relative_error"] = result.relative_error;
}

void hybrid_five_points(benchmark::State& state) {
  report(state, five_points(), {});
}
BENCHMARK(hybrid_five_points)->Unit(benchmark::kMillisecond);

void hybrid_robot(benchmark::State& state) {
  report(state, noisy_robot(), {});
}
BENCHMARK(hybrid_robot)->Unit(benchmark::kMillisecond);

void lscf_robot(benchmark::State& state) {
  report(state, noisy_robot(), {.method = FitMethod::lscf});
}
BENCHMARK(lscf_robot)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace robomill::modal
