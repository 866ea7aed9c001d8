#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <unistd.h>

#include <Eigen/Core>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>

#include "robomill/base/random.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/records/records.hpp"
#include "robomill/modal/files/frf_files.hpp"
#include "robomill/program/files/program_files.hpp"
#include "robomill/program/files/rewrite.hpp"

namespace robomill {
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
  io::write_file(path, hit_text());
  for (auto _ : state) benchmark::DoNotOptimize(io::read_record(path, {.time = "1"}));
  std::filesystem::remove(path);
}
BENCHMARK(read_hit_text)->Unit(benchmark::kMillisecond);

std::string five_axis_moves(int lines) {
  Random random(2);
  std::string text = "G93\nG0 X0 Y0 Z0 A0 C0\n";
  for (int i = 0; i < lines; ++i) {
    text += fmt::format("G1  X {:7.3f}  Y {:7.3f}  Z {:7.3f}  A {:7.3f}  C {:7.3f}  F 159\n",
                        random.uniform(-50.0, 50.0), random.uniform(-50.0, 50.0), random.uniform(0.0, 40.0),
                        random.uniform(-80.0, 0.0), random.uniform(-90.0, 90.0));
  }
  return text;
}

/// The same moves by vectors, as APT or as columns.
std::string vector_moves(int lines, const char* head, const char* line) {
  Random random(2);
  std::string text = head;
  for (int i = 0; i < lines; ++i) {
    const Eigen::Vector3d axis = Eigen::Vector3d(random.normal(), random.normal(), 5.0).normalized();
    text += fmt::format(fmt::runtime(line), random.uniform(-50.0, 50.0), random.uniform(-50.0, 50.0),
                        random.uniform(0.0, 40.0), axis.x(), axis.y(), axis.z());
  }
  return text;
}

/// Arcs of a quarter turn, 2 mm in radius: 36 chords each.
std::string arcs(int lines) {
  std::string text = "G0 X2 Y0 Z0\nF600\n";
  for (int i = 0; i < lines; ++i) text += i % 2 == 0 ? "G3 X0 Y2 I-2\n" : "G2 X2 Y0 J-2\n";
  return text;
}

/// A program of 200,000 five-axis moves, 12 MB, into memory.
void read_program(benchmark::State& state) {
  constexpr int lines = 200000;
  const std::filesystem::path path = place("part.ngc");
  io::write_file(path, five_axis_moves(lines));
  for (auto _ : state) benchmark::DoNotOptimize(program::read_program(path, {.machine = program::Machine::xyzac_trt}));
  state.SetItemsProcessed(state.iterations() * lines);
  std::filesystem::remove(path);
}
BENCHMARK(read_program)->Unit(benchmark::kMillisecond);

double memory_bytes(const char* key) {
  std::ifstream status("/proc/self/status");
  std::string line;
  while (std::getline(status, line)) {
    if (line.starts_with(key)) return 1024.0 * std::strtod(line.c_str() + std::strlen(key) + 1, nullptr);
  }
  return 0.0;
}

/// A program's blocks one after another; the most memory held on the way.
void stream(benchmark::State& state, const std::string& name, std::string (*text)(int), int lines) {
  const std::filesystem::path path = place(name);
  io::write_file(path, text(lines));
  std::ofstream("/proc/self/clear_refs") << "5";
  const double before = memory_bytes("VmRSS");
  std::size_t blocks = 0;
  for (auto _ : state) {
    const auto file = program::open_program(path, {.machine = program::Machine::xyzac_trt});
    program::Block block;
    while (file->next(block)) ++blocks;
  }
  state.counters["peak_bytes"] = memory_bytes("VmHWM") - before;
  state.counters["blocks"] = static_cast<double>(blocks) / static_cast<double>(state.iterations());
  state.SetItemsProcessed(state.iterations() * lines);
  std::filesystem::remove(path);
}
std::string apt_moves(int lines) {
  return vector_moves(lines, "FEDRAT/600,MMPM\n", "GOTO/{:.4f},{:.4f},{:.4f},{:.7f},{:.7f},{:.7f}\n");
}
std::string csv_moves(int lines) {
  return vector_moves(lines, "x_mm,y_mm,z_mm,i,j,k,feed_mm_per_min\n",
                      "{:.4f},{:.4f},{:.4f},{:.7f},{:.7f},{:.7f},600\n");
}
BENCHMARK_CAPTURE(stream, gcode, "part.ngc", five_axis_moves, 1000000)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(stream, apt, "part.apt", apt_moves, 1000000)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(stream, csv, "part.csv", csv_moves, 1000000)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(stream, arcs, "arcs.ngc", arcs, 100000)->Unit(benchmark::kMillisecond);

/// A program rewritten: every third move slower, each ten moves at another speed.
void rewrite(benchmark::State& state, const std::string& name, std::string (*text)(int), int lines) {
  const program::ProgramReading reading = {.machine = program::Machine::xyzac_trt};
  const std::string program_text = text(lines);
  const program::Program read = program::read_program_text(program_text, name, reading);
  program::Program wanted = read;
  for (std::size_t i = 0; i < wanted.blocks.size(); ++i) {
    program::Block& block = wanted.blocks[i];
    if (block.line % 3 == 0) block.duration_s *= 1.25;
    if (block.spindle != program::Spindle::not_given)
      block.spindle_speed_rad_per_s *= block.line / 10 % 2 == 0 ? 1.0 : 1.1;
  }
  std::size_t changed = 0;
  for (auto _ : state) {
    const program::Rewritten out = program::rewrite_program_text(program_text, name, reading, read, wanted);
    changed = out.changed_lines + out.added_lines;
  }
  state.counters["changed"] = static_cast<double>(changed);
  state.SetItemsProcessed(state.iterations() * lines);
}
std::string turning_moves(int lines) {
  return "M3 S12000\n" + five_axis_moves(lines);
}
std::string turning_apt_moves(int lines) {
  return "SPINDL/12000,RPM,CLW\n" + apt_moves(lines);
}
BENCHMARK_CAPTURE(rewrite, gcode, "part.ngc", turning_moves, 200000)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(rewrite, apt, "part.apt", turning_apt_moves, 200000)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(rewrite, csv, "part.csv", csv_moves, 200000)->Unit(benchmark::kMillisecond);

/// Four FRFs of 3,500 lines, written and read.
void frfs(benchmark::State& state, const std::string& ending, bool write) {
  modal::FrfSet set;
  set.frequency_hz = Eigen::VectorXd::LinSpaced(3500, 1.0, 3500.0);
  for (const char* name : {"xx", "xy", "yx", "yy"}) {
    set.frfs.push_back({.name = modal::parse_frf_name(name), .receptance = 1e-6 * Eigen::VectorXcd::Random(3500)});
  }
  const std::filesystem::path path = place("tip" + ending);
  modal::write_frfs(path, set);
  for (auto _ : state) {
    if (write) {
      modal::write_frfs(path, set);
    } else {
      benchmark::DoNotOptimize(modal::read_frfs({path}));
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
}  // namespace robomill
