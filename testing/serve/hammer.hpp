#pragma once
// For tests: what a hammer and two accelerometers on one mode record.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include "robomill/base/random.hpp"
#include "testing/support.hpp"

namespace robomill::test {

/// A push of the hammer: half a sine of 1 ms.
struct Push {
  double at_s = 0.0, peak_n = 0.0;
};

/// Force and accelerations in x and y of one mode in x of 200 Hz, 2 %, 1 kg, at 8,192 Hz, with noise.
struct HammerRecord {
  static constexpr double rate_hz = 8192.0, mode_hz = 200.0, pulse_s = 1e-3;
  std::vector<double> force_n, ax_m_per_s2, ay_m_per_s2;

  HammerRecord(std::size_t samples, const std::vector<Push>& pushes, std::uint64_t seed) {
    const double w = 2.0 * std::numbers::pi * mode_hz, zeta = 0.02;
    double x = 0.0, v = 0.0;
    Random random(seed);
    const auto push = [&](double t) {
      double sum = 0.0;
      for (const Push& one : pushes) {
        const double s = t - one.at_s;
        if (s > 0.0 && s < pulse_s) sum += one.peak_n * std::sin(std::numbers::pi * s / pulse_s);
      }
      return sum;
    };
    constexpr int steps = 16;
    for (std::size_t i = 0; i < samples; ++i) {
      const double t = static_cast<double>(i) / rate_hz;
      const double a = push(t) - 2.0 * zeta * w * v - w * w * x;
      force_n.push_back(push(t) + 1e-3 * random.normal());
      ax_m_per_s2.push_back(a + 1e-2 * random.normal());
      ay_m_per_s2.push_back(1e-2 * random.normal());
      for (int k = 0; k < steps; ++k) {  // semi-implicit steps, far shorter than the mode's period
        const double dt = 1.0 / rate_hz / steps;
        v += dt * (push(t + k * dt) - 2.0 * zeta * w * v - w * w * x);
        x += dt * v;
      }
    }
  }

  [[nodiscard]] std::string csv() const {
    std::string out = "time_s,force_n,ax_m_per_s2,ay_m_per_s2\n";
    for (std::size_t i = 0; i < force_n.size(); ++i) {
      out += std::to_string(static_cast<double>(i) / rate_hz) + "," + std::to_string(force_n[i]) + "," +
             std::to_string(ax_m_per_s2[i]) + "," + std::to_string(ay_m_per_s2[i]) + "\n";
    }
    return out;
  }
};

/// A record that is there at once: written aside, and renamed.
inline void appear(const Folder& folder, const std::string& name, const std::string& text) {
  std::filesystem::rename(folder.file("." + name, text), folder.at(name));
}

}  // namespace robomill::test
