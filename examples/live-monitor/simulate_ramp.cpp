// A cut of the milling robot in data/robot-modes.toml whose depth grows across the stability limit and falls back,
// again and again: accelerations in x and y as little-endian float32, interleaved, 10,240 Hz, to a file or (-) standard
// output; with --realtime as fast as the cut itself would send them.
// Usage: simulate_ramp [--seconds 20] [--realtime] [file]
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <numbers>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/cutting/milling.hpp"
#include "robomill/modal/tip.hpp"
#include "robomill/simulation/simulation.hpp"
#include "testing/robot_modes.hpp"

namespace {

using namespace robomill;

constexpr double rate_hz = 10240.0, round_s = 10.0;
constexpr double speed_rad_per_s = 7000.0 * std::numbers::pi / 30.0;

/// Entry, steady cutting, a ramp to well above the limit, half a round quiet again, and so on.
std::vector<float> cut(double seconds) {
  simulation::MillingCut cut;
  cut.milling.tool = {.teeth = 3, .diameter_m = 0.012, .runout_m = 3e-6};
  cut.milling.immersion = cutting::immersion(cutting::MillingDirection::up, 1.8e-3, 0.012);
  cut.milling.coefficients = {.tangential_n_per_m2 = 712e6,
                              .radial_n_per_m2 = 287e6,
                              .tangential_edge_n_per_m = 4e3,
                              .radial_edge_n_per_m = 4e3};
  cut.milling.feed_per_tooth_m = 5e-5;
  cut.structure = modal::tip_modes(data::robot_modes(), {}, 0.0);
  cut.spindle_speed_rad_per_s = speed_rad_per_s;
  cut.axial_depth_m = 0.8e-3;
  std::vector<simulation::Schedule::Point>& depth = cut.schedule.depth;
  depth = {{0.5, 0.0}, {0.6, 0.25}};
  for (double t = 0.0; t < seconds; t += round_s) {
    depth.insert(depth.end(), {{t + 4.0, 0.25}, {t + 6.0, 1.0}, {t + 7.5, 1.0}, {t + 7.7, 0.25}});
  }
  const simulation::Simulation s = simulation::simulate(cut, {.seconds = seconds, .sample_rate_hz = rate_hz});
  Random random(1);
  std::vector<float> samples;
  samples.reserve(2 * static_cast<std::size_t>(s.acceleration_m_per_s2.rows()));
  for (Eigen::Index i = 0; i < s.acceleration_m_per_s2.rows(); ++i) {
    for (Eigen::Index c = 0; c < 2; ++c) {
      samples.push_back(static_cast<float>(s.acceleration_m_per_s2(i, c) + 0.5 * random.normal()));
    }
  }
  return samples;
}

/// In blocks of 25 ms.
bool write(const std::vector<float>& samples, std::FILE* out, bool realtime) {
  constexpr std::size_t block = 2 * 256;
  const auto begun = std::chrono::steady_clock::now();
  for (std::size_t i = 0; i < samples.size(); i += block) {
    const std::size_t count = std::min(block, samples.size() - i);
    if (realtime) {
      const double at_s = static_cast<double>(i + count) / 2.0 / rate_hz;
      std::this_thread::sleep_until(
          begun + std::chrono::duration_cast<std::chrono::steady_clock::duration>(std::chrono::duration<double>(at_s)));
    }
    if (std::fwrite(samples.data() + i, sizeof(float), count, out) != count) return false;
    if (realtime && std::fflush(out) != 0) return false;
  }
  return std::fflush(out) == 0;
}

}  // namespace

int main(int argc, char** argv) {
  double seconds = 20.0;
  bool realtime = false;
  std::string file = "-";
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    if (word == "--realtime") {
      realtime = true;
    } else if (word == "--seconds" && i + 1 < argc) {
      seconds = std::atof(argv[++i]);
    } else if (word == "-" || !word.starts_with("-")) {
      file = word;
    } else {
      std::fprintf(stderr, "usage: simulate_ramp [--seconds 20] [--realtime] [file]\n");
      return 2;
    }
  }
  try {
    const std::vector<float> samples = cut(seconds);
    std::FILE* out = file == "-" ? stdout : std::fopen(file.c_str(), "wb");
    if (out == nullptr || !write(samples, out, realtime)) {
      std::fprintf(stderr, "simulate_ramp: cannot write %s\n", file.c_str());
      return 1;
    }
    if (out != stdout && std::fclose(out) != 0) return 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "simulate_ramp: %s\n", error.what());
    return 1;
  }
  return 0;
}
