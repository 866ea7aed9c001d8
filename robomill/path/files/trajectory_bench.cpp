#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "robomill/path/files/trajectory.hpp"
#include "testing/path/trajectories.hpp"

namespace robomill::path {
namespace {

/// 100 s of six joints at 1 ms.
void trajectory(benchmark::State& state, const std::string& ending) {
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / fmt::format("robomill_bench_{}{}", ::getpid(), ending);
  const auto samples = test::sines(100000);
  for (auto _ : state) {
    const auto file = open_sample_file(path, test::arm_info());
    file->add(samples);
    file->commit();
  }
  state.counters["bytes"] = static_cast<double>(std::filesystem::file_size(path));
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(samples.size()));
  std::filesystem::remove(path);
}
BENCHMARK_CAPTURE(trajectory, csv, ".csv")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(trajectory, hdf5, ".h5")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(trajectory, krl, ".src")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(trajectory, servoj, ".servoj")->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace robomill::path
