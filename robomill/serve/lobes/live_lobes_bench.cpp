// How long a slider's next picture takes: median, 95 % and longest of many that all differ [ms].
#include "robomill/serve/lobes/live_lobes.hpp"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <string>
#include <vector>

namespace robomill::serve {
namespace {

struct Case {
  const char* file;
  const char* dragged;  ///< key that moves
  double from, to;
  std::vector<io::TomlSetting> held = {};
};

/// Ways that sliders go.
const std::vector<Case>& cases() {
  static const std::vector<Case> all = {
      {"first-lobes/lobes.toml", "coefficients.tangential_n_per_mm2", 300, 1500},
      {"first-lobes/lobes.toml", "cut.radial_depth_mm", 0.5, 12},
      {"first-lobes/lobes.toml", "cut.radial_depth_mm", 0.5, 12, {{"tool.helix_deg", "30"}, {"tool.teeth", "4"}}},
      {"ball-end-lobes/lobes.toml", "coefficients.tangential_n_per_mm2", 500, 2500},
      {"ball-end-lobes/lobes.toml", "cut.lead_deg", -30, 30},
      {"ball-end-lobes/lobes.toml", "cut.stepover_mm", 0.1, 3},
      {"ball-end-lobes/lead.toml", "cut.axial_depth_mm", 0.05, 0.5}};
  return all;
}

void drag(benchmark::State& state, bool chart) {
  const Case& one = cases()[static_cast<std::size_t>(state.range(0))];
  LiveLobes live;
  LiveLobesRequest request;
  request.file = std::string(ROBOMILL_SOURCE_DIR "/examples/") + one.file;
  request.chart = chart;
  const int steps = chart ? 10 : 100;
  std::vector<double> milliseconds;
  for (auto _ : state) {
    for (int i = 0; i < steps; ++i) {
      request.settings = one.held;
      request.settings.push_back({one.dragged, std::to_string(one.from + (one.to - one.from) * i / (steps - 1))});
      const auto begin = std::chrono::steady_clock::now();
      benchmark::DoNotOptimize(live.answer(request));
      const std::chrono::duration<double, std::milli> spent = std::chrono::steady_clock::now() - begin;
      milliseconds.push_back(spent.count());
    }
  }
  std::ranges::sort(milliseconds);
  const auto share = [&](double part) {
    return milliseconds[static_cast<std::size_t>(part * static_cast<double>(milliseconds.size() - 1))];
  };
  state.counters["median"] = share(0.5);
  state.counters["95 %"] = share(0.95);
  state.counters["longest"] = milliseconds.back();
  state.SetLabel(std::string(one.file) + " " + one.dragged);
}

void drag_limit(benchmark::State& state) {
  drag(state, false);
}
void drag_chart(benchmark::State& state) {
  drag(state, true);
}

BENCHMARK(drag_limit)->DenseRange(0, 6)->Iterations(1)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(drag_chart)->DenseRange(0, 6)->Iterations(1)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace robomill::serve
