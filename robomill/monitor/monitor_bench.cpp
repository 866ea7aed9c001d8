#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <vector>

#include "robomill/monitor/monitor.hpp"
#include "testing/monitor/signal.hpp"

namespace {

using namespace robomill::monitor;

/// One hop of 256 samples with 512-point windows: comb, squeezing, bands, test. Counters per channel, over all hops.
void hop(benchmark::State& state, Kind kind, int channels) {
  const testing::SyntheticCut cut{.channels = channels, .seconds = 10.0};
  const std::vector<float> samples = testing::vibration(cut);
  const MonitorOptions options = {.kind = kind,
                                  .sample_rate_hz = cut.sample_rate_hz,
                                  .channels = channels,
                                  .spindle_speed_rad_per_s = 510.0,
                                  .teeth = cut.teeth,
                                  .threshold = 1e9};
  ChatterMonitor monitor(options);
  const std::size_t block = options.hop_samples() * static_cast<std::size_t>(channels);
  std::vector<double> took_us;
  std::size_t at = 0;
  for (auto _ : state) {
    const auto start = std::chrono::steady_clock::now();
    benchmark::DoNotOptimize(monitor.push(std::span(samples).subspan(at, block)));
    took_us.push_back(std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count());
    at = at + 2 * block <= samples.size() ? at + block : 0;
  }
  std::ranges::sort(took_us);
  const auto quantile = [&](double share) {
    return took_us[static_cast<std::size_t>(share * static_cast<double>(took_us.size() - 1))] / channels;
  };
  state.counters["median_us"] = quantile(0.5);
  state.counters["p99_us"] = quantile(0.99);
  state.counters["p999_us"] = quantile(0.999);
}
BENCHMARK_CAPTURE(hop, comb_cusum_1, Kind::comb_cusum, 1)->Unit(benchmark::kMicrosecond)->Iterations(4000);
BENCHMARK_CAPTURE(hop, comb_cusum_2, Kind::comb_cusum, 2)->Unit(benchmark::kMicrosecond)->Iterations(4000);
BENCHMARK_CAPTURE(hop, energy_entropy_1, Kind::energy_entropy, 1)->Unit(benchmark::kMicrosecond)->Iterations(4000);

}  // namespace
