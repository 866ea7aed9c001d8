#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "robomill/base/random.hpp"
#include "robomill/formats/file.hpp"
#include "robomill/formats/frf_files.hpp"
#include "robomill/formats/gcode.hpp"
#include "robomill/formats/records.hpp"

namespace robomill::formats {
namespace {

std::filesystem::path place(const std::string& name) {
  return std::filesystem::temp_directory_path() / fmt::format("robomill_bench_{}_{}", ::getpid(), name);
}

/// One second at 51.2 kHz as recorders write it: 51,200 lines of time, force and acceleration with three-digit
/// exponents, 2.2 MB.
std::string hit_text() {
  Random random(1);
  std::string text;
  const auto append = [&text](double value, char after) {
    const std::string number = fmt::format("{:.6e}", value);
    const std::size_t exponent = number.size() - 2;
    text += fmt::format("{}0{}{}", number.substr(0, exponent), number.substr(exponent), after);
  };
  for (int i = 0; i < 51200; ++i) {
    append(i / 51200.0, '\t');
    append(random.normal(), '\t');
    append(random.normal(), '\n');
  }
  return text;
}

void read_hit_text(benchmark::State& state) {
  const std::filesystem::path path = place("hit.txt");
  write_file(path, hit_text());
  for (auto _ : state) benchmark::DoNotOptimize(read_record(path, {.time = "1"}));
  std::filesystem::remove(path);
}
BENCHMARK(read_hit_text)->Unit(benchmark::kMillisecond);

/// A program of 200,000 five-axis moves, 12 MB.
void read_program(benchmark::State& state) {
  Random random(2);
  std::string text = "G93\nG0 X0 Y0 Z0 A0 C0\n";
  constexpr int lines = 200000;
  for (int i = 0; i < lines; ++i) {
    text += fmt::format("G1  X {:7.3f}  Y {:7.3f}  Z {:7.3f}  A {:7.3f}  C {:7.3f}  F 159\n",
                        random.uniform(-50.0, 50.0), random.uniform(-50.0, 50.0), random.uniform(0.0, 40.0),
                        random.uniform(-80.0, 0.0), random.uniform(-90.0, 90.0));
  }
  const std::filesystem::path path = place("part.ngc");
  write_file(path, text);
  for (auto _ : state) benchmark::DoNotOptimize(read_gcode(path, program::Machine::xyzac_trt));
  state.SetItemsProcessed(state.iterations() * lines);
  std::filesystem::remove(path);
}
BENCHMARK(read_program)->Unit(benchmark::kMillisecond);

/// Four FRFs of 3,500 lines, written and read.
void frfs(benchmark::State& state, const std::string& ending, bool write) {
  modal::FrfSet set;
  set.frequency_hz = Eigen::VectorXd::LinSpaced(3500, 1.0, 3500.0);
  for (const char* name : {"xx", "xy", "yx", "yy"}) {
    set.frfs.push_back({.name = modal::parse_frf_name(name), .receptance = 1e-6 * Eigen::VectorXcd::Random(3500)});
  }
  const std::filesystem::path path = place("tip" + ending);
  write_frfs(path, set);
  for (auto _ : state) {
    if (write) {
      write_frfs(path, set);
    } else {
      benchmark::DoNotOptimize(read_frfs({path}));
    }
  }
  state.counters["bytes"] = static_cast<double>(std::filesystem::file_size(path));
  std::filesystem::remove(path);
}
BENCHMARK_CAPTURE(frfs, write_uff, ".uff", true)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(frfs, read_uff, ".uff", false)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(frfs, write_csv, ".csv", true)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(frfs, read_csv, ".csv", false)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(frfs, write_mat, ".mat", true)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(frfs, read_mat, ".mat", false)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(frfs, write_json, ".json", true)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(frfs, read_json, ".json", false)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace robomill::formats
