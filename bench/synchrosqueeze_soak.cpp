// Drift of the sliding transform: a billion samples (27 hours at 10,240 Hz; or as many as the first argument says)
// through 512 points and 16 bands, a column each 16 samples, and how far the bands' sum is from the signal. Ends with 1
// where that passes 1e-9 of its amplitude.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/signal/synchrosqueeze.hpp"

int main(int argc, char** argv) {
  using namespace robomill;
  const std::uint64_t samples = argc > 1 ? std::stoull(argv[1]) : 1'000'000'000;
  signal::SynchrosqueezeStream stream({.sample_rate_hz = 10240.0, .hop = 16}, signal::equal_bands(10240.0, 16));
  Random random(1);
  std::vector<double> last(512);
  double worst = 0.0, worst_now = 0.0;
  for (std::uint64_t m = 0; m < samples; ++m) {
    const double x = random.uniform(-0.5, 0.5) + 0.5 * std::sin(0.7 * static_cast<double>(m));
    last[m % 512] = x;
    if (stream.push(x)) {
      double sum = 0.0;
      for (const double band : stream.band_values()) sum += band;
      worst_now = std::max(worst_now, std::abs(sum - last[stream.centre() % 512]));
    }
    if ((m + 1) % std::max<std::uint64_t>(1, samples / 10) == 0) {
      fmt::print("{:>12} samples: largest error {:.3g} since the last line\n", m + 1, worst_now);
      worst = std::max(worst, worst_now);
      worst_now = 0.0;
    }
  }
  return worst < 1e-9 ? 0 : 1;
}
