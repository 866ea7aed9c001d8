#include "robomill/signal/synchrosqueeze.hpp"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <vector>

#include "robomill/base/parallel.hpp"
#include "robomill/base/random.hpp"

namespace {

using namespace robomill;
using namespace robomill::signal;

constexpr double rate_hz = 10240.0;

Eigen::VectorXd record(Eigen::Index n) {
  Random random(1);
  Eigen::VectorXd x(n);
  for (Eigen::Index m = 0; m < n; ++m) x(m) = random.normal() + std::sin(0.4 * static_cast<double>(m));
  return x;
}

double processor_time_us() {
  timespec now = {};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e6 * static_cast<double>(now.tv_sec) + 1e-3 * static_cast<double>(now.tv_nsec);
}

/// The value below which a part of them lies.
double part(std::vector<double>& values, double share) {
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

/// 256 samples at a time through 512 points into 16 bands, a column a sample; as counters the distribution of a hop's
/// time [µs], on the clock and of the processor.
void stream_hop(benchmark::State& state) {
  const Eigen::VectorXd x = record(1 << 16);
  const SynchrosqueezeOptions options = {.sample_rate_hz = rate_hz, .window = static_cast<WindowKind>(state.range(0))};
  SynchrosqueezeStream stream(options, equal_bands(rate_hz, 16));
  std::vector<double> out(256 * 16), clock_us, processor_us;
  clock_us.reserve(1 << 20);
  processor_us.reserve(1 << 20);
  std::size_t at = 0;
  for (auto _ : state) {
    const auto start = std::chrono::steady_clock::now();
    const double start_us = processor_time_us();
    benchmark::DoNotOptimize(stream.push(std::span<const double>(x.data() + at, 256), out));
    const double end_us = processor_time_us();
    const std::chrono::duration<double, std::micro> took = std::chrono::steady_clock::now() - start;
    if (clock_us.size() < clock_us.capacity()) {
      clock_us.push_back(took.count());
      processor_us.push_back(end_us - start_us);
    }
    at = (at + 256) % static_cast<std::size_t>(x.size());
  }
  state.counters["p50"] = part(clock_us, 0.5);
  state.counters["p99"] = part(clock_us, 0.99);
  state.counters["p99.9"] = part(clock_us, 0.999);
  state.counters["cpu_p50"] = part(processor_us, 0.5);
  state.counters["cpu_p99"] = part(processor_us, 0.99);
  state.counters["cpu_p99.9"] = part(processor_us, 0.999);
}
BENCHMARK(stream_hop)
    ->Unit(benchmark::kMicrosecond)
    ->ArgName("window")
    ->Arg(static_cast<int>(WindowKind::hann))
    ->Arg(static_cast<int>(WindowKind::blackman_harris));

/// 256 samples at wide hops, from 129 on by FFT.
void stream_wide_hop(benchmark::State& state) {
  const Eigen::VectorXd x = record(1 << 16);
  SynchrosqueezeStream stream({.sample_rate_hz = rate_hz, .hop = state.range(0)}, equal_bands(rate_hz, 16));
  std::vector<double> out(16 * 256);
  Eigen::Index at = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(stream.push(std::span<const double>(x.data() + at, 256), out));
    at = (at + 256) % x.size();
  }
}
BENCHMARK(stream_wide_hop)->Unit(benchmark::kMicrosecond)->ArgName("hop")->Arg(16)->Arg(128)->Arg(129)->Arg(256);

/// 10 s at 10,240 Hz, 512 points, a column a sample: 102,400 × 257 coefficients, of the squeezed transform alone or of
/// both. Before the first time it runs once untimed: a virtual machine is given its memory when it first touches it,
/// which took 2.4 s for 421 MB on one, whatever the number of threads, and the first of these to run had paid for all.
void batch(benchmark::State& state) {
  set_thread_count(static_cast<int>(state.range(0)));
  const Eigen::VectorXd x = record(102400);
  const auto run = [&] {
    benchmark::DoNotOptimize(
        synchrosqueeze(x, {.sample_rate_hz = rate_hz}, state.range(1) == 1 ? Keep::both : Keep::squeezed));
  };
  run();
  for (auto _ : state) run();
  set_thread_count(0);
}
BENCHMARK(batch)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->MeasureProcessCPUTime()
    ->ArgNames({"threads", "both"})
    ->ArgsProduct({{1, 2}, {0, 1}});

/// The same record into 16 band signals.
void batch_bands(benchmark::State& state) {
  set_thread_count(static_cast<int>(state.range(0)));
  const Eigen::VectorXd x = record(102400), edges = equal_bands(rate_hz, 16);
  for (auto _ : state) benchmark::DoNotOptimize(band_signals(x, {.sample_rate_hz = rate_hz}, edges));
  set_thread_count(0);
}
BENCHMARK(batch_bands)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->MeasureProcessCPUTime()
    ->ArgName("threads")
    ->Arg(1)
    ->Arg(2);

}  // namespace
