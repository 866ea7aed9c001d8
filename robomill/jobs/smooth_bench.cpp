#include "robomill/jobs/smooth.hpp"

#include <benchmark/benchmark.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "examples/smooth-impeller-like/blade.hpp"
#include "robomill/io/file.hpp"

namespace {

using namespace robomill;

/// A program of the size of LinuxCNC's impeller sample, 4,306 moves at feed: 22 passes of 195 moves and the steps
/// between them are 4,312. Removed at the end.
class Blade {
 public:
  Blade() : path_(std::filesystem::temp_directory_path() / ("robomill-blade-" + std::to_string(::getpid()) + ".ngc")) {
    io::write_file(path_, examples::blade_program(22, 195));
  }
  ~Blade() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  Blade(const Blade&) = delete;
  Blade& operator=(const Blade&) = delete;
  Blade(Blade&&) = delete;
  Blade& operator=(Blade&&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// robomill smooth from the file to the last sample's check, in all rounds, without a trajectory's file.
void smooth_impeller(benchmark::State& state, const char* cell, path::Method method) {
  const Blade blade;
  jobs::SmoothJob job;
  job.program = blade.path();
  job.cell = std::string(ROBOMILL_SOURCE_DIR "/examples/smooth-impeller-like/") + cell;
  job.method = method;
  job.options.record = false;
  path::Summary summary;
  for (auto _ : state) summary = jobs::run_smooth(job).first().summary;
  state.counters["blocks"] = static_cast<double>(summary.blocks);
  state.counters["duration_s"] = summary.duration_s;
  state.counters["lower_bound_s"] = summary.lower_bound_s;
  state.counters["violations"] = static_cast<double>(summary.check.violations());
  state.counters["rounds"] = summary.rounds;
  state.counters["plan_s"] = summary.plan_s;
  state.counters["emit_s"] = summary.emit_s;
}
BENCHMARK_CAPTURE(smooth_impeller, arm_verified, "cell.toml", path::Method::verified)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(smooth_impeller, arm_optimal, "cell.toml", path::Method::optimal)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(smooth_impeller, hybrid_verified, "cell-hybrid.toml", path::Method::verified)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(smooth_impeller, hybrid_optimal, "cell-hybrid.toml", path::Method::optimal)
    ->Unit(benchmark::kMillisecond);

}  // namespace
