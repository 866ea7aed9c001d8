#include "robomill/stability/time_steps/discretizations.hpp"

#include <benchmark/benchmark.h>

#include <array>
#include <vector>

#include "testing/stability/problems.hpp"

namespace {

using namespace robomill::stability;
using detail::Scheme;

using Make = std::unique_ptr<Scheme> (*)(const LobesProblem&, int);

/// 200 depths at each of ten speeds, one thread; time a point.
void points(benchmark::State& state, Make make, const LobesProblem& problem, double depth_m) {
  const std::unique_ptr<Scheme> scheme = make(problem, static_cast<int>(state.range(0)));
  const std::unique_ptr<detail::PointEvaluator> evaluator = scheme->evaluator();
  std::vector<OperatingPoint> all;
  for (int i = 0; i < 10; ++i) {
    for (int j = 1; j <= 200; ++j) all.push_back({(5000.0 + 1000.0 * i) * testing::rpm, depth_m * j / 200.0});
  }
  std::array<detail::Outcome, robomill::lane_count> out;
  for (auto _ : state) {
    for (std::size_t at = 0; at < all.size(); at += out.size()) {
      evaluator->evaluate(std::span(all).subspan(at, out.size()), {}, out);
      benchmark::DoNotOptimize(out);
    }
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) * static_cast<std::int64_t>(all.size()));
  state.counters["point"] = benchmark::Counter(
      static_cast<double>(all.size()), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void zeroth_order(benchmark::State& state, const LobesProblem& problem, double depth_m) {
  points(state, detail::semi_discretization, problem, depth_m);
}
void first_order(benchmark::State& state, const LobesProblem& problem, double depth_m) {
  points(state, detail::first_order_semi_discretization, problem, depth_m);
}
void full(benchmark::State& state, const LobesProblem& problem, double depth_m) {
  points(state, detail::full_discretization, problem, depth_m);
}

}  // namespace

#define ROBOMILL_DISCRETIZATION(method)                                                                   \
  BENCHMARK_CAPTURE(method, low_immersion, testing::benchmark(0.05), 10e-3)->Arg(40)->Arg(160)->Arg(640); \
  BENCHMARK_CAPTURE(method, slot, testing::benchmark(1.0), 4e-3)->Arg(40)->Arg(160)->Arg(640);            \
  BENCHMARK_CAPTURE(method, robot, testing::robot(), 3e-3)->Arg(40)->Arg(160)->Arg(640)
ROBOMILL_DISCRETIZATION(zeroth_order);
ROBOMILL_DISCRETIZATION(first_order);
ROBOMILL_DISCRETIZATION(full);
