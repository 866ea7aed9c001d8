#include "robomill/modal/files/example_hit.hpp"

#include <cmath>
#include <numbers>

#include "robomill/base/random.hpp"
#include "robomill/io/system/append.hpp"

namespace robomill::modal {
namespace made_up_hit {
namespace {

constexpr double rate_hz = 12'800.0;
constexpr int samples = 3200;
constexpr double before_s = 0.02;  ///< from the record's begin to the hit
constexpr double pulse_s = 1e-3, peak_force_n = 200.0;
constexpr double force_noise_n = 0.01, response_noise_m_per_s2 = 0.005;
constexpr double mass_kg = 0.6, frequency_hz = 620.0, damping_ratio = 0.03;

/// A half sine.
double force_n(double time_s) {
  const double since_s = time_s - before_s;
  if (since_s < 0.0 || since_s > pulse_s) return 0.0;
  return peak_force_n * std::sin(std::numbers::pi * since_s / pulse_s);
}

/// m x'' + 2 m ζ ω x' + m ω² x = F.
struct Motion {
  double x_m = 0.0, v_m_per_s = 0.0;

  [[nodiscard]] double acceleration(double time_s) const {
    constexpr double omega = 2.0 * std::numbers::pi * frequency_hz;
    return force_n(time_s) / mass_kg - 2.0 * damping_ratio * omega * v_m_per_s - omega * omega * x_m;
  }
  [[nodiscard]] Motion after(const Motion& rate, double step_s) const {
    return {.x_m = x_m + step_s * rate.x_m, .v_m_per_s = v_m_per_s + step_s * rate.v_m_per_s};
  }
  [[nodiscard]] Motion rate(double time_s) const { return {.x_m = v_m_per_s, .v_m_per_s = acceleration(time_s)}; }
  /// One step of Runge and Kutta.
  void step(double time_s, double step_s) {
    const Motion a = rate(time_s), b = after(a, step_s / 2).rate(time_s + step_s / 2);
    const Motion c = after(b, step_s / 2).rate(time_s + step_s / 2), d = after(c, step_s).rate(time_s + step_s);
    *this = after(a, step_s / 6).after(b, step_s / 3).after(c, step_s / 3).after(d, step_s / 6);
  }
};

}  // namespace
}  // namespace made_up_hit

std::string example_hit_csv() {
  using namespace made_up_hit;
  constexpr int steps_a_sample = 4;
  constexpr double step_s = 1.0 / (rate_hz * steps_a_sample);
  Random random(1);
  Motion motion;
  std::string text = "time_s,force_n,ax_m_per_s2\n";
  for (int i = 0; i < samples; ++i) {
    const double time_s = i / rate_hz;
    io::append(text, "{:.7f},{:.3f},{:.3f}\n", time_s, force_n(time_s) + force_noise_n * random.normal(),
               motion.acceleration(time_s) + response_noise_m_per_s2 * random.normal());
    for (int k = 0; k < steps_a_sample; ++k) motion.step(time_s + k * step_s, step_s);
  }
  return text;
}

}  // namespace robomill::modal
