#include "robomill/path/published/fir_profile.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "robomill/base/random.hpp"

namespace robomill::path {
namespace fir_profile_test {

Boxes boxes_of(const std::vector<double>& widths) {
  Boxes boxes;
  for (const double width : widths) boxes.add(width);
  return boxes;
}

Boxes random_boxes(Random& random, int count) {
  Boxes boxes;
  for (int i = 0; i < count; ++i) boxes.add(std::exp(random.uniform(std::log(0.002), std::log(2.0))));
  return boxes;
}

// s = Σ ∏ … is what moving averages of the position make of a ramp, one after the other: sampled here, exact there.
TEST(FirProfile, IsTheConvolutionOfItsBoxes) {
  for (const std::vector<double>& widths :
       {std::vector<double>{0.6, 0.1}, {0.6, 0.1, 0.05}, {0.08, 0.1, 0.05}, {0.6, 0.1, 0.05, 0.025}}) {
    const Boxes boxes = boxes_of(widths);
    const double h = 1e-4;
    const auto size = static_cast<std::size_t>(boxes.sum_s() / h + 3.0);
    std::vector<double> way(size);
    for (std::size_t i = 0; i < size; ++i) way[i] = std::min(1.0, static_cast<double>(i) * h / widths[0]);
    for (std::size_t f = 1; f < widths.size(); ++f) {
      const auto span = static_cast<std::size_t>(std::lround(widths[f] / h));
      std::vector<double> sums(size + 1, 0.0);  // trapezoids, so that the average is of second order
      for (std::size_t i = 1; i < size; ++i) sums[i] = sums[i - 1] + 0.5 * (way[i] + way[i - 1]) * h;
      for (std::size_t i = 0; i < size; ++i) way[i] = (sums[i] - (i >= span ? sums[i - span] : 0.0)) / widths[f];
    }
    for (std::size_t i = 0; i < size; i += 7) {
      EXPECT_NEAR(share_at(boxes, static_cast<double>(i) * h)[0], way[i], 2e-6) << widths.size() << " " << i;
    }
  }
}

TEST(FirProfile, DerivativesAreThoseOfTheShare) {
  Random random(3);
  for (int round = 0; round < 200; ++round) {
    const Boxes boxes = random_boxes(random, 4);  // three times differentiable
    const double t = random.uniform(0.0, boxes.sum_s()), e = 1e-4 * boxes.width_s.minCoeff();
    const Eigen::Vector4d before = share_at(boxes, t - e), here = share_at(boxes, t), after = share_at(boxes, t + e);
    double scale = 1.0 / boxes.width_s.maxCoeff();
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR((after[k] - before[k]) / (2.0 * e), here[k + 1], 1e-4 * scale) << k;
      scale /= boxes.width_s.minCoeff();
    }
  }
}

// Longest box first: v ≤ 1/Ta, a ≤ 1/(Ta Tb), and both are met where Ta ≥ Tb + Tc. The jerk is 1/(Ta Tb Tc) there, and
// twice that where braking begins before speeding up has ended: T1 is not the longest by enough.
TEST(FirProfile, PeaksAreThoseOfTheSortedConstants) {
  const auto peaks = [](const Boxes& boxes) {
    Eigen::Vector4d most = Eigen::Vector4d::Zero();
    for (int i = 0; i <= 20000; ++i)
      most = most.cwiseMax(share_at(boxes, boxes.sum_s() * (i + 0.37) / 20000.0).cwiseAbs());
    return most;
  };
  const Eigen::Vector4d usual = peaks(boxes_of({0.6, 0.1, 0.05}));
  EXPECT_NEAR(usual[1], 1.0 / 0.6, 1e-12);
  EXPECT_NEAR(usual[2], 1.0 / 0.06, 1e-10);
  EXPECT_NEAR(usual[3], 1.0 / 0.003, 1e-8);
  const Eigen::Vector4d swapped = peaks(boxes_of({0.05, 0.6, 0.1}));
  EXPECT_NEAR((swapped - usual).tail<3>().norm(), 0.0, 1e-8);
  const Eigen::Vector4d close = peaks(boxes_of({0.12, 0.1, 0.05}));
  EXPECT_NEAR(close[3], 2.0 / (0.12 * 0.1 * 0.05), 1e-6);
}

TEST(FirProfile, IsSymmetricAndMeetsItsEnds) {
  Random random(5);
  for (int count = 1; count <= 4; ++count) {
    for (int round = 0; round < 100; ++round) {
      const Boxes boxes = random_boxes(random, count);
      const double whole = boxes.sum_s(), t = random.uniform(0.0, whole);
      // Widths a thousandfold apart cost the sum of powers five digits; the way is then as short as its pulse.
      EXPECT_NEAR(share_at(boxes, t)[0] + share_at(boxes, whole - t)[0], 1.0, 1e-10);
      EXPECT_NEAR(share_at(boxes, 0.5 * whole)[0], 0.5, 1e-10);
      EXPECT_EQ(share_at(boxes, whole)[0], 1.0);
      EXPECT_EQ(share_at(boxes, -1e-9).norm(), 0.0);
    }
  }
}

// The way that a long pulse leaves is the tail of its share, at unit speed.
TEST(FirProfile, TailIsTheWayThatALongPulseLeaves) {
  Random random(7);
  for (int filters = 1; filters <= 3; ++filters) {
    for (int round = 0; round < 100; ++round) {
      const Boxes tail = random_boxes(random, filters);
      Boxes whole = tail;
      const double pulse = 2.0 * tail.sum_s();
      whole.add(pulse);
      const double tau = random.uniform(0.0, 1.2 * tail.sum_s());
      EXPECT_NEAR(tail_s(tail, tau), pulse * share_at(whole, tau)[0], 1e-12 * pulse);
    }
  }
}

// The closed inverse over its case ranges, as a round trip.
TEST(FirProfile, TailTimeInvertsTheTail) {
  Random random(9);
  for (int filters = 1; filters <= 3; ++filters) {
    for (int round = 0; round < 300; ++round) {
      const Boxes tail = random_boxes(random, filters);
      const double half = 0.5 * tail.sum_s(), tau = half * std::pow(random.uniform(), 3.0);
      EXPECT_NEAR(tail_time_s(tail, tail_s(tail, tau)), tau, 1e-9 * half + 1e-7 * tau) << filters;
      EXPECT_EQ(tail_time_s(tail, 1.0001 * tail_s(tail, half)), half);
      EXPECT_EQ(tail_time_s(tail, 0.0), 0.0);
    }
  }
  // the border of the two cases of two filters: τ = shorter constant
  const Boxes two = boxes_of({0.1, 0.05});
  EXPECT_NEAR(tail_s(two, 0.05), 0.05 * 0.05 / 0.6, 1e-17);
  EXPECT_NEAR(tail_time_s(two, 0.05 * 0.05 / 0.6), 0.05, 1e-15);
  EXPECT_NEAR(tail_time_s(two, 0.05 * 0.05 / 0.6 * (1.0 + 1e-12)), 0.05, 1e-12);
}

}  // namespace fir_profile_test
}  // namespace robomill::path
