#include "robomill/stability/frequency_domain.hpp"

#include <gtest/gtest.h>
#include <cstdio>
#include <chrono>

#include "robomill/base/random.hpp"
#include "robomill/stability/test_problems.hpp"

namespace robomill::stability {
namespace {
using testing::benchmark;
using testing::robot;
using testing::rpm;

void compare(const char* name, const LobesProblem& p, double depth, std::vector<double> speeds_rpm, double from, double to, double step, double noise) {
  const FrequencyResponse g = FrequencyResponse::of_modes(p);
  std::vector<double> speeds;
  for (double s : speeds_rpm) speeds.push_back(s * rpm);
  auto now = [] { return std::chrono::steady_clock::now(); };
  modal::FrfSet set = modal::synthesize(p.dynamics, Eigen::VectorXd::LinSpaced(Eigen::Index((to - from) / step) + 1, from, to));
  Random random(3);
  for (auto& f : set.frfs) { double peak = f.receptance.cwiseAbs().maxCoeff(); for (auto& v : f.receptance) v += noise * peak * std::complex<double>(random.normal(), random.normal()); }
  const FrequencyResponse m = FrequencyResponse::of_frfs(set, p.feed_direction_rad);
  double worst = 0, at = 0;
  for (double f = from; f < to; f += 0.0371) { double e = (m.at(f * 2 * M_PI) - g.at(f * 2 * M_PI)).norm() / g.at(f * 2 * M_PI).norm(); if (e > worst) { worst = e; at = f; } }
  const auto exact = multi_frequency_limits(p.milling, g, speeds, {.largest_depth_m = depth});
  const auto t0 = now();
  const auto limits = multi_frequency_limits(p.milling, m, speeds, {.largest_depth_m = depth});
  const auto t1 = now();
  const auto zoa = zeroth_order_limits(p.milling, m, speeds, {.largest_depth_m = depth});
  const auto t2 = now();
  auto ms = [](auto a, auto b) { return 1e3 * std::chrono::duration<double>(b - a).count(); };
  std::printf("%s: interp worst %.2e at %.3f, multi %.1f ms, zoa %.1f\n", name, worst, at, ms(t0, t1), ms(t1, t2));
  for (std::size_t i = 0; i < speeds.size(); ++i) {
    const auto& l = limits[i];
    std::printf("  %6.0f: %d %.7f mm %.3f Hz kind %d N %d M %d err %.1e | rel diff %.2e uncovered %.2e | zoa %.5f\n", speeds_rpm[i], int(l.status), l.axial_depth_m * 1e3, l.chatter_frequency_hz, int(l.kind), l.harmonics, l.polynomials, l.error_estimate_m,
      l.axial_depth_m / exact[i].axial_depth_m - 1, l.uncovered_ratio, zoa[i].axial_depth_m * 1e3);
  }
  try { require_coverage(m, limits); } catch (const std::exception& e) { std::printf("  %s\n", e.what()); }
}

TEST(MultiFrequency, Trial) {
  for (double noise : {0.0, 1e-4}) {
  compare("bench 0.05, 0-5000", benchmark(0.05), 0.01, {5000, 10000, 15000, 20000}, 0, 5000, 0.25, noise);
  compare("bench 0.05, 5-3000", benchmark(0.05), 0.01, {5000, 10000, 15000, 20000}, 5, 3000, 0.25, noise);
  compare("bench 0.05, 5-3000, 1 Hz", benchmark(0.05), 0.01, {5000, 10000, 15000, 20000}, 5, 3000, 1, noise);
  compare("bench 0.05, 100-1200", benchmark(0.05), 0.01, {5000, 10000, 15000, 20000}, 100, 1200, 1, noise);
  compare("bench 0.05, 100-900", benchmark(0.05), 0.01, {5000, 10000, 15000, 20000}, 100, 900, 1, noise);
  compare("robot 5-1000", robot(), 0.003, {4000, 5000, 6500, 8000, 15000}, 5, 1000, 0.25, noise);
  compare("robot 0-5000", robot(), 0.003, {4000, 5000, 6500, 8000, 15000}, 0, 5000, 0.25, noise);
  compare("robot 5-500", robot(), 0.003, {4000, 5000, 6500, 8000, 15000}, 5, 500, 0.25, noise);
  compare("robot 100-1000", robot(), 0.003, {4000, 5000, 6500, 8000, 15000}, 100, 1000, 0.25, noise);
  }
}
}  // namespace
}  // namespace robomill::stability
