#pragma once
// Vibration of a cut that never was, for tests.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "robomill/base/random.hpp"

namespace robomill::monitor::testing {

struct SyntheticCut {
  double sample_rate_hz = 10240.0, rotation_hz = 80.0;
  double drift_hz_per_s = 0.0;  ///< of the rotation, from 2 s to 3 s
  int teeth = 3, channels = 1;
  double noise = 0.1;       ///< rms; tooth passing has the amplitude 1
  double chatter_hz = 0.0;  ///< 0: none
  double starts_s = 2.0;    ///< of growth from 1e-3
  double growth_per_s = 30.0;
  double chatter = 1.0;  ///< final amplitude
  double ends_s = 1e9;
  double seconds = 4.0;
  std::uint64_t seed = 1;
};

/// Interleaved. Harmonics 1/j of tooth passing, a tenth of it at rotation, white noise; half as loud, and turned, in
/// the second channel.
inline std::vector<float> vibration(const SyntheticCut& cut) {
  Random random(cut.seed);
  std::vector<float> out;
  const auto frames = static_cast<std::size_t>(cut.seconds * cut.sample_rate_hz);
  for (std::size_t i = 0; i < frames; ++i) {
    const double t = static_cast<double>(i) / cut.sample_rate_hz;
    const double drifting = std::clamp(t - 2.0, 0.0, 1.0), drifted = std::max(t - 3.0, 0.0);
    const double more = cut.drift_hz_per_s * (0.5 * drifting * drifting + drifted);
    const double angle = 2.0 * std::numbers::pi * (cut.rotation_hz * t + more);
    for (int c = 0; c < cut.channels; ++c) {
      double x = 0.1 * std::cos(angle + 0.3 * c);
      for (int j = 1; j <= 6; ++j) x += std::cos(j * (cut.teeth * angle + 0.7) + c) / j;
      x += cut.noise * random.normal();
      if (cut.chatter_hz > 0.0 && t > cut.starts_s) {
        const double grown = std::min(cut.chatter, 1e-3 * std::exp(cut.growth_per_s * (t - cut.starts_s)));
        const double left = t < cut.ends_s ? 1.0 : std::exp(-60.0 * (t - cut.ends_s));
        x += grown * left * std::cos(2.0 * std::numbers::pi * cut.chatter_hz * t + c);
      }
      out.push_back(static_cast<float>(c == 0 ? x : 0.5 * x));
    }
  }
  return out;
}

}  // namespace robomill::monitor::testing
