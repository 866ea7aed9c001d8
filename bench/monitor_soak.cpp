// A stream of stable cutting, 24 hours or as many as the argument says, fed to the monitor as fast as it goes: resident
// memory each simulated quarter of an hour, alarms, and how exactly the streamed transform still gives the signal back.
// Usage: monitor_soak [hours] [teeth]; without teeth the cuts have two to four, and the monitor is not given their
// number.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <span>
#include <string>
#include <utility>

#include "robomill/monitor/monitor.hpp"
#include "robomill/signal/synchrosqueeze.hpp"
#include "testing/monitor/hours.hpp"

namespace {

using namespace robomill;
using monitor::testing::corpus_rate_hz;

constexpr Eigen::Index window = 512, hop = 256;

/// Of this process [MiB]; 0 where the system does not say.
double resident_mib() {
  std::ifstream status("/proc/self/status");
  std::string word;
  double kib = 0.0;
  while (status >> word) {
    if (word == "VmRSS:") status >> kib;
  }
  return kib / 1024.0;
}

/// The first channel through the streamed transform; at each column its bands' sum against the sample at its centre.
class Reconstruction {
 public:
  Reconstruction()
      : stream_({.sample_rate_hz = corpus_rate_hz, .window_length = window, .hop = hop},
                signal::equal_bands(corpus_rate_hz, 16)) {}

  void push(double sample) {
    recent_[count_++ % window] = sample;
    power_ += 1e-4 * (sample * sample - power_);
    if (!stream_.push(sample)) return;
    const std::uint64_t centre = stream_.centre();
    if (centre < window) return;
    double sum = 0.0;
    for (const double band : stream_.band_values()) sum += band;
    worst_ = std::max(worst_, std::abs(sum - recent_[centre % window]) / std::sqrt(power_ + 1e-12));
  }
  /// Largest error since the last call, as a share of the signal's rms.
  double worst() { return std::exchange(worst_, 0.0); }

 private:
  signal::SynchrosqueezeStream stream_;
  std::array<double, window> recent_ = {};
  std::uint64_t count_ = 0;
  double power_ = 0.0, worst_ = 0.0;
};

}  // namespace

int main(int argc, char** argv) {
  const double hours = argc > 1 ? std::atof(argv[1]) : 24.0;
  const int teeth = argc > 2 ? std::atoi(argv[2]) : 0;
  monitor::testing::StableHours stream(21, hours, 48, teeth);
  monitor::ChatterMonitor monitor({.sample_rate_hz = corpus_rate_hz, .channels = 2, .teeth = teeth});
  Reconstruction reconstruction;
  int alarms = 0;
  std::uint64_t hop = 0;
  std::uint64_t blind = 0;
  bool chatter = false;
  double next_report_s = 0.0;
  const std::clock_t begun = std::clock();
  fmt::print(
      "| simulated, h | resident, MiB | reconstruction error | alarms | blind, % | processor, s "
      "|\n|---|---|---|---|---|---|\n");
  const auto report = [&] {
    fmt::print("| {:.2f} | {:.1f} | {:.1e} | {} | {:.2f} | {:.0f} |\n", stream.seconds() / 3600.0, resident_mib(),
               reconstruction.worst(), alarms,
               hop > 0 ? 100.0 * static_cast<double>(blind) / static_cast<double>(hop) : 0.0,
               static_cast<double>(std::clock() - begun) / CLOCKS_PER_SEC);
    std::fflush(stdout);
  };
  for (std::span<const float> samples = stream.next(); !samples.empty(); samples = stream.next()) {
    monitor.set_spindle_speed(stream.hint_rad_per_s());
    while (!samples.empty()) {
      const std::size_t take = std::min(samples.size(), 2 * monitor.frames_to_next_decision());
      for (std::size_t i = 0; i < take; i += 2) reconstruction.push(static_cast<double>(samples[i]));
      const monitor::Decision decision = monitor.push(samples.first(take));
      if (decision.hop != hop) blind += decision.state == monitor::State::blind ? 1 : 0;
      hop = decision.hop;
      const bool now = decision.state == monitor::State::chatter;
      alarms += now && !chatter ? 1 : 0;
      chatter = now;
      samples = samples.subspan(take);
    }
    if (stream.seconds() >= next_report_s) {
      report();
      next_report_s += 900.0;
    }
  }
  report();
  return 0;
}
