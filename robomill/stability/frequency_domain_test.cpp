#include "robomill/stability/frequency_domain.hpp"

#include <gtest/gtest.h>
#include <cstdio>
#include <chrono>

#include "robomill/stability/test_problems.hpp"

namespace robomill::stability {
namespace {
using testing::benchmark;
using testing::robot;
using testing::rpm;

void compare(const char* name, const LobesProblem& p, double depth, std::vector<double> speeds_rpm, int intervals) {
  const FrequencyResponse g = FrequencyResponse::of_modes(p);
  std::vector<double> speeds;
  for (double s : speeds_rpm) speeds.push_back(s * rpm);
  auto now = [] { return std::chrono::steady_clock::now(); };
  const auto t0 = now();
  const auto limits = multi_frequency_limits(p.milling, g, speeds, {.largest_depth_m = depth});
  const auto t1 = now();
  const auto zoa = zeroth_order_limits(p.milling, g, speeds, {.largest_depth_m = depth});
  const auto t2 = now();
  LobesOptions o = testing::chart(1000, 2000, depth, 2, 60, intervals);
  const auto sd = limit_depths(p, o, speeds);
  const auto t3 = now();
  auto ms = [](auto a, auto b) { return 1e3 * std::chrono::duration<double>(b - a).count(); };
  std::printf("%s: multi %.1f ms, zoa %.1f ms, sd %.1f ms\n", name, ms(t0, t1), ms(t1, t2), ms(t2, t3));
  for (std::size_t i = 0; i < speeds.size(); ++i) {
    const auto& l = limits[i];
    std::printf("  %6.0f: %d %.7f mm %.3f Hz kind %d mode %d N %d M %d err %.1e n %zu | sd %.7f %.3f kind %d mode %d diff %.2e | zoa %.5f %.2f %d\n", speeds_rpm[i], int(l.status), l.axial_depth_m * 1e3, l.chatter_frequency_hz, int(l.kind), l.mode, l.harmonics, l.polynomials, l.error_estimate_m, l.crossings.size(),
      sd[i].axial_depth_m * 1e3, sd[i].chatter_frequency_hz, int(sd[i].kind), sd[i].mode, l.axial_depth_m / sd[i].axial_depth_m - 1, zoa[i].axial_depth_m * 1e3, zoa[i].chatter_frequency_hz, zoa[i].mode);
  }
}

TEST(MultiFrequency, Trial) {
  compare("bench 0.05", benchmark(0.05), 0.01, {5000, 9000, 10000, 15000, 20000, 25000}, 640);
  compare("bench 0.5", benchmark(0.5), 0.005, {5000, 9000, 10000, 15000, 20000, 25000}, 640);
  compare("bench slot", benchmark(1), 0.005, {5000, 9000, 10000, 15000, 20000, 25000}, 640);
  compare("bench slot 1d", benchmark(1, 1), 0.005, {5000, 10000, 15000, 20000, 25000}, 640);
  compare("robot", robot(), 0.003, {4000, 5000, 6500, 8000, 15000}, 640);
  LobesProblem p = robot();
  p.milling.tool.helix_rad = 0.5;
  compare("robot helix", p, 0.003, {4000, 5000, 6500, 8000, 15000}, 320);
  p = benchmark(0.05);
  p.milling.tool.helix_rad = 0.5;
  compare("bench helix", p, 0.02, {5000, 9000, 10000, 15000, 20000}, 320);
  p = robot();
  p.milling.tool.pitch_rad = {110 / 57.29577951308232, 120 / 57.29577951308232, 130 / 57.29577951308232};
  compare("robot pitch", p, 0.003, {4000, 5000, 6500, 8000, 15000}, 320);
  p = benchmark(0.5);
  p.milling.tool.pitch_rad = {2.9, 2.0 * std::numbers::pi - 2.9};
  compare("bench pitch", p, 0.005, {5000, 10000, 14000}, 640);
  p = benchmark(0.8);
  p.milling.tool.teeth = 4;
  p.milling.tool.pitch_rad = {1.4, 1.7, 1.5, 2 * std::numbers::pi - 4.6};
  compare("bench pitch overlap", p, 0.005, {5000, 10000, 14000}, 320);
}
}  // namespace
}  // namespace robomill::stability
