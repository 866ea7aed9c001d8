// simulate_holes DIRECTORY [HOLES] [SEED]: drilled and countersunk holes as WAV files, x and y in m/s², and the
// recordings.toml that `robomill calibrate` reads.
#include <fmt/format.h>

#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "examples/calibrate-holes/holes.hpp"
#include "robomill/base/parallel.hpp"
#include "robomill/simulation/files/simulation_files.hpp"

namespace {

using namespace robomill;
using examples::Hole;

std::string table_of(const Hole& hole, const std::string& file) {
  constexpr double rpm = std::numbers::pi / 30.0;
  std::string text = fmt::format(
      "\n[[recordings]]  # {}, {:.1f} mm, {:.2f} mm/s\n"
      "file = \"{}\"\n"
      "label = \"{}\"\n"
      "spindle_speed_rpm = {:.0f}\n",
      hole.kind, 1e3 * hole.cut.diameter_m, 1e3 * hole.feed_m_per_s, file, hole.chatter ? "chatter" : "stable",
      hole.cut.spindle_speed_rad_per_s / rpm);
  if (hole.chatter) text += fmt::format("onset_s = {:.3f}\n", hole.onset_s);
  return text;
}

void write_holes(const std::filesystem::path& folder, std::uint64_t count, std::uint64_t seed) {
  std::filesystem::create_directories(folder);
  std::vector<std::string> tables(count);
  std::vector<int> draws(count), chatter(count);
  parallel_for(count, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const Hole hole = examples::simulate_hole(seed, k);
      const std::string file = fmt::format("hole-{:03}.wav", k + 1);
      simulation::write_simulation(folder / file, hole.record);
      tables[k] = table_of(hole, file);
      draws[k] = hole.draws;
      chatter[k] = hole.chatter ? 1 : 0;
    }
  });
  std::string text = fmt::format(
      "# Holes simulated by simulate_holes, seed {}.\n"
      "[signal]\n"
      "sample_rate_hz = {:.0f}\n"
      "anti_alias_filter = true\n"
      "channels = [1, 2]\n"
      "[process]\n"
      "teeth = 2\n"
      "[detector]\n"
      "kind = \"energy-entropy\"\n"
      "entropy = \"energy\"\n"
      "[calibration]\n"
      "false_alarm_rate = 0.05\n",
      seed, examples::hole_rate_hz);
  int drawn = 0, chattering = 0;
  for (std::size_t k = 0; k < count; ++k) {
    text += tables[k];
    drawn += draws[k];
    chattering += chatter[k];
  }
  std::ofstream file(folder / "recordings.toml", std::ios::binary);
  file << text;
  file.close();
  if (!file) throw std::runtime_error(fmt::format("{}: cannot be written", (folder / "recordings.toml").string()));
  fmt::print("{} holes in {}: {} chatter, {} are stable; {} were drawn again, being neither.\n", count, folder.string(),
             chattering, count - static_cast<std::uint64_t>(chattering), drawn - static_cast<int>(count));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2 || argc > 4) {
    std::fputs("usage: simulate_holes DIRECTORY [HOLES] [SEED]\n", stderr);
    return 2;
  }
  try {
    write_holes(argv[1], argc > 2 ? std::stoull(argv[2]) : 480, argc > 3 ? std::stoull(argv[3]) : 1);
  } catch (const std::exception& error) {
    fmt::print(stderr, "simulate_holes: {}\n", error.what());
    return 1;
  }
  return 0;
}
