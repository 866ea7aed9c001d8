// From hammer hits to a receptance. The structure is one mass on a spring, so the right answer is known.
#include <robomill/base/random.hpp>
#include <robomill/modal/hits.hpp>

#include <cmath>
#include <complex>
#include <cstdint>
#include <cstdio>
#include <numbers>
#include <string>

using namespace robomill;
constexpr double pi = std::numbers::pi, mass_kg = 0.8, omega = 2.0 * pi * 310.0, damping_ratio = 0.02;

// What force sensor and accelerometer record of one blow, a half sine: central differences, each sample the mean of its
// steps, since a recorder that filters both channels alike does not fold high frequencies onto low ones.
modal::Hit blow(double peak_n, std::uint64_t seed) {
  constexpr double rate_hz = 8192.0, start_s = 0.05, pulse_s = 1e-3;
  constexpr Eigen::Index samples = 8192, steps = 16;
  constexpr double step_s = 1.0 / (rate_hz * steps), damped = damping_ratio * omega * step_s;
  Random random(seed);
  const auto noise = [&] { return 0.05 * random.normal(); };
  modal::Hit hit;
  hit.file = "blow " + std::to_string(seed);
  hit.sample_rate_hz = rate_hz;
  hit.force_n = Eigen::VectorXd::NullaryExpr(samples, noise);
  hit.responses.push_back({.dof = {}, .samples = Eigen::VectorXd::NullaryExpr(samples, noise)});
  double x_m = 0.0, v_m_per_s = 0.0;
  for (Eigen::Index i = 0; i < samples * steps; ++i) {
    const double since_s = static_cast<double>(i) * step_s - start_s, before_m_per_s = v_m_per_s;
    const double force_n = since_s > 0.0 && since_s < pulse_s ? peak_n * std::sin(pi * since_s / pulse_s) : 0.0;
    v_m_per_s = ((1.0 - damped) * v_m_per_s + step_s * (force_n / mass_kg - omega * omega * x_m)) / (1.0 + damped);
    x_m += step_s * v_m_per_s;
    hit.force_n(i / steps) += force_n / steps;
    hit.responses[0].samples(i / steps) += (v_m_per_s - before_m_per_s) / step_s / steps;
  }
  return hit;
}

int main() {
  const modal::FrfResult result = modal::estimate_frfs({blow(180.0, 1), blow(200.0, 2), blow(220.0, 3)},
                                                       {.min_frequency_hz = 50.0, .max_frequency_hz = 1000.0});
  for (const modal::HitVerdict& hit : result.hits)
    std::printf("%s: %.0f N, %s\n", hit.file.c_str(), hit.peak_force_n, hit.accepted ? "accepted" : "rejected");

  const modal::Frf& frf = result.set.frfs.front();
  Eigen::Index peak = 0;
  const double highest_m_per_n = frf.receptance.cwiseAbs().maxCoeff(&peak);
  std::printf("%s: %.3f um/N at %.1f Hz (mass and spring: %.1f Hz), %s\n", modal::to_string(frf.name).c_str(),
              highest_m_per_n * 1e6, result.set.frequency_hz(peak), omega / (2.0 * pi),
              modal::to_string(result.grades.front().grade).c_str());

  const Eigen::ArrayXcd w = (2.0 * pi * result.set.frequency_hz).cast<std::complex<double>>();
  const std::complex<double> damped(0.0, 2.0 * damping_ratio * omega);
  const Eigen::VectorXcd exact = 1.0 / (mass_kg * (omega * omega - w.square() + damped * w));
  const double error = (frf.receptance - exact).norm() / exact.norm();
  std::printf("differs from 1 / (m (w0^2 - w^2 + 2 i z w0 w)) by %.2f %%\n", 100.0 * error);
  return error < 0.005 ? 0 : 1;
}
