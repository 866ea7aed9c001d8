#include "robomill/jobs/sweep.hpp"

#include <benchmark/benchmark.h>

#include <filesystem>
#include <vector>

#include "robomill/base/units.hpp"
#include "robomill/jobs/files/lobes_toml.hpp"
#include "robomill/jobs/sweep/evaluate.hpp"
#include "robomill/stability/lobes.hpp"

namespace {

using namespace robomill;

const std::filesystem::path cut = ROBOMILL_SOURCE_DIR "/examples/sweep/lobes.toml";

/// The limit at a speed by the library's function alone, of a document that was read once.
void limit_by_library(benchmark::State& state) {
  const jobs::LobesFile file = jobs::read_milling(cut);
  for (auto _ : state) {
    benchmark::DoNotOptimize(stability::limit_depths(file.problem, file.options, {8000.0 * units::rpm}));
  }
}
BENCHMARK(limit_by_library)->Unit(benchmark::kMicrosecond);

/// The spectral radius likewise.
void radius_by_library(benchmark::State& state) {
  const jobs::LobesFile file = jobs::read_milling(cut);
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        stability::evaluate_point(file.problem, file.options, {8000.0 * units::rpm, 2.0 * units::mm}));
  }
}
BENCHMARK(radius_by_library)->Unit(benchmark::kMicrosecond);

/// The same as a point of a study: the values set, the document read and checked.
void of_a_point(benchmark::State& state, const char* collect) {
  const jobs::Evaluator evaluator({.job = "lobes", .base = cut, .collect = {collect}});
  const std::vector<io::TomlSetting> settings = {{"cut.radial_depth_mm", "3"},
                                                 {"dynamics.x[0].damping_ratio", "0.03"},
                                                 {"coefficients.tangential_n_per_mm2", "800"}};
  for (auto _ : state) benchmark::DoNotOptimize(evaluator.at(settings, Progress::none()));
}
BENCHMARK_CAPTURE(of_a_point, limit, "limit@8000")->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(of_a_point, radius, "abs_mu@8000,2")->Unit(benchmark::kMicrosecond);

/// Of that the document alone.
void read_of_a_point(benchmark::State& state) {
  const io::TomlSource source(cut, {}, {{"cut.radial_depth_mm", "3"}});
  for (auto _ : state) benchmark::DoNotOptimize(jobs::read_lobes(source));
}
BENCHMARK(read_of_a_point)->Unit(benchmark::kMicrosecond);

}  // namespace
