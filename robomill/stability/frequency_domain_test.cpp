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

TEST(MultiFrequency, Trial) {
  const LobesProblem p = benchmark(0.05);
  const FrequencyResponse g = FrequencyResponse::of_modes(p);
  const auto t0 = std::chrono::steady_clock::now();
  const auto limits = multi_frequency_limits(p.milling, g, {5000 * rpm, 10000 * rpm, 15000 * rpm, 20000 * rpm}, {.largest_depth_m = 0.01});
  std::printf("%.1f ms\n", 1e3 * std::chrono::duration<double>(std::chrono::steady_clock::now() - t0).count());
  for (const auto& l : limits) {
    std::printf("%d %.8f mm %.3f Hz kind %d mode %d N %d M %d err %.2e crossings %zu\n", int(l.status), l.axial_depth_m * 1e3, l.chatter_frequency_hz, int(l.kind), l.mode, l.harmonics, l.polynomials, l.error_estimate_m, l.crossings.size());
  }
}
}  // namespace
}  // namespace robomill::stability
