#pragma once
// Sums of sines and their spectra, for tests.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <span>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/monitor/orders/spectra.hpp"

namespace robomill::monitor::testing {

struct Tone {
  double hz = 0.0, amplitude = 1.0, phase = 0.0;
};

/// Σ A cos(2πft + φ) and white noise.
inline std::vector<float> sum_of(std::span<const Tone> tones, double rate_hz, double seconds, double noise = 0.0,
                                 std::uint64_t seed = 1) {
  Random random(seed);
  std::vector<float> out(static_cast<std::size_t>(seconds * rate_hz));
  for (std::size_t i = 0; i < out.size(); ++i) {
    double x = noise > 0.0 ? noise * random.normal() : 0.0;
    for (const Tone& tone : tones) {
      x += tone.amplitude * std::cos(2.0 * std::numbers::pi * tone.hz * static_cast<double>(i) / rate_hz + tone.phase);
    }
    out[i] = static_cast<float>(x);
  }
  return out;
}

/// Multiples of tooth passing, 1/j, and a tenth at the rotation, as SyntheticCut has them; random phases.
inline std::vector<Tone> cut_of(double rotation_hz, int teeth, Random& random, double highest_hz = 5000.0) {
  std::vector<Tone> out;
  if (teeth > 1) out.push_back({rotation_hz, 0.1, random.uniform(0.0, 6.0)});
  for (int j = 1; j <= 6 && j * teeth * rotation_hz < highest_hz; ++j) {
    out.push_back({j * teeth * rotation_hz, 1.0 / j, random.uniform(0.0, 6.0)});
  }
  return out;
}

inline constexpr std::array usual_windows_s = {0.3, 0.15};

inline void transform_all(Spectra& spectra) {
  for (std::size_t w = 0; w < usual_windows_s.size(); ++w) spectra.transform(w);
}

/// Spectra of one channel after all samples.
inline Spectra spectra_of(std::span<const float> samples, double rate_hz) {
  Spectra out(rate_hz, 1, usual_windows_s);
  out.push(samples, samples.size());
  transform_all(out);
  return out;
}

inline std::vector<float> power_of(const Spectrum& spectrum) {
  std::vector<float> out(spectrum.line.size());
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = std::norm(spectrum.line[i]);
  return out;
}

}  // namespace robomill::monitor::testing
