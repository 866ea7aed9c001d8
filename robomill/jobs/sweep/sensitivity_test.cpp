#include "robomill/jobs/sweep/sensitivity.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/jobs/sweep/samples.hpp"

namespace robomill::jobs {
namespace sensitivity_test {

using Function = std::function<double(const std::vector<double>& shares)>;

std::vector<double> values_of(const Function& f, std::size_t samples, std::size_t inputs, std::uint64_t seed) {
  std::vector<double> out;
  for (const std::vector<double>& point : saltelli_samples(samples, inputs, seed)) out.push_back(f(point));
  return out;
}

SobolIndices indices_of(const Function& f, std::size_t samples, std::size_t inputs, std::uint64_t seed = 1) {
  return sobol_indices(values_of(f, samples, inputs, seed), inputs, seed);
}

/// sin x1 + a sin^2 x2 + b x3^4 sin x1, x in [-pi, pi] [IshigamiHomma1990].
constexpr double a = 7.0, b = 0.1;
double ishigami(const std::vector<double>& shares) {
  std::array<double, 3> x{};
  for (std::size_t k = 0; k < 3; ++k) x[k] = std::numbers::pi * (2.0 * shares[k] - 1.0);
  return std::sin(x[0]) + a * std::pow(std::sin(x[1]), 2) + b * std::pow(x[2], 4) * std::sin(x[0]);
}

struct Exact {
  double variance = 0.0;
  std::vector<double> first = {}, total = {};
};

Exact exact_ishigami() {
  const double pi4 = std::pow(std::numbers::pi, 4);
  const double v1 = 0.5 * std::pow(1.0 + b * pi4 / 5.0, 2), v2 = a * a / 8.0, v13 = b * b * pi4 * pi4 * 8.0 / 225.0;
  const double v = v1 + v2 + v13;
  return {.variance = v, .first = {v1 / v, v2 / v, 0.0}, .total = {(v1 + v13) / v, v2 / v, v13 / v}};
}

/// Product of (|4 x - 2| + a) / (1 + a) [Sobol2001].
constexpr std::array<double, 6> g_a = {0.0, 0.5, 3.0, 9.0, 99.0, 99.0};
double g_function(const std::vector<double>& shares) {
  double out = 1.0;
  for (std::size_t k = 0; k < g_a.size(); ++k) out *= (std::abs(4.0 * shares[k] - 2.0) + g_a[k]) / (1.0 + g_a[k]);
  return out;
}

Exact exact_g_function() {
  double all = 1.0;
  const auto part = [](double one) { return 1.0 / (3.0 * (1.0 + one) * (1.0 + one)); };
  for (const double one : g_a) all *= 1.0 + part(one);
  Exact out{.variance = all - 1.0};
  for (const double one : g_a) {
    out.first.push_back(part(one) / out.variance);
    out.total.push_back(part(one) * all / (1.0 + part(one)) / out.variance);
  }
  return out;
}

bool holds(const Estimate& estimate, double exact) {
  return estimate.low <= exact && exact <= estimate.high;
}

void expect_in_band(const Function& f, const Exact& exact, std::size_t samples) {
  const SobolIndices found = indices_of(f, samples, exact.first.size());
  ASSERT_EQ(found.status, SobolStatus::found);
  EXPECT_EQ(found.samples, samples);
  EXPECT_EQ(found.left_out, 0U);
  EXPECT_NEAR(found.variance, exact.variance, 0.05 * exact.variance);
  for (std::size_t k = 0; k < exact.first.size(); ++k) {
    const SobolIndex& input = found.inputs[k];
    EXPECT_TRUE(holds(input.first, exact.first[k])) << k << ": " << input.first.value << " of " << exact.first[k];
    EXPECT_TRUE(holds(input.total, exact.total[k])) << k << ": " << input.total.value << " of " << exact.total[k];
  }
}

TEST(SobolIndices, OfClosedFormsLieInTheirIntervals) {
  expect_in_band(ishigami, exact_ishigami(), 1024);
  expect_in_band(g_function, exact_g_function(), 1024);
}

TEST(SobolIndices, HaveIntervalsThatCoverClosedForms) {
  const Exact exact = exact_ishigami();
  int covered = 0, all = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const SobolIndices found = indices_of(ishigami, 256, 3, seed);
    for (std::size_t k = 0; k < 3; ++k) {
      covered += (holds(found.inputs[k].first, exact.first[k]) ? 1 : 0) +
                 (holds(found.inputs[k].total, exact.total[k]) ? 1 : 0);
      all += 2;
    }
  }
  EXPECT_GE(covered, all * 90 / 100);
}

// Of a sum there are no interactions: both indices are the squares of the coefficients over their sum.
TEST(SobolIndices, OfASumAddUpToOne) {
  const auto sum = [](const std::vector<double>& x) { return 1e6 + 3.0 * x[0] - 4.0 * x[1] + 12.0 * x[2]; };
  const SobolIndices found = indices_of(sum, 1024, 3);
  const std::array<double, 3> exact = {9.0 / 169.0, 16.0 / 169.0, 144.0 / 169.0};
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(found.inputs[k].first.value, exact[k], 0.01) << "a mean of 1e6 does not matter";
    EXPECT_NEAR(found.inputs[k].total.value, exact[k], 0.01);
  }
}

TEST(SobolIndices, OfAConstantAreNone) {
  const SobolIndices found = indices_of([](const auto&) { return 0.1; }, 64, 2);
  EXPECT_EQ(found.status, SobolStatus::constant);
  EXPECT_NEAR(found.mean, 0.1, 1e-15);
  EXPECT_TRUE(std::isnan(found.inputs[0].first.value));
}

// A sample with a value that is none counts as little as if it had never been.
TEST(SobolIndices, LeaveOutWholeSamplesAndCountThem) {
  std::vector<double> values = values_of(ishigami, 128, 3, 5);
  std::vector<double> rest;
  for (std::size_t i = 0; i < 128; ++i) {
    if (i % 10 == 3) {
      values[i * 5 + i % 5] = i % 4 == 3 ? std::nan("") : std::numeric_limits<double>::infinity();
    } else {
      rest.insert(rest.end(), &values[i * 5], &values[i * 5] + 5);
    }
  }
  const SobolIndices found = sobol_indices(values, 3, 1), without = sobol_indices(rest, 3, 1);
  EXPECT_EQ(found.left_out, 13U);
  EXPECT_EQ(found.samples, 115U);
  EXPECT_EQ(without.left_out, 0U);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(found.inputs[k].first.value, without.inputs[k].first.value);
    EXPECT_EQ(found.inputs[k].total.high, without.inputs[k].total.high);
  }
  for (double& value : values) value = std::nan("");
  const SobolIndices none = sobol_indices(values, 3, 1);
  EXPECT_EQ(none.status, SobolStatus::too_few);
  EXPECT_EQ(none.left_out, 128U);
  EXPECT_THROW(static_cast<void>(sobol_indices(values, 4, 1)), InvalidInput);
}

TEST(SaltelliSamples, ShareAllKeysButOne) {
  const Shares rows = saltelli_samples(4, 3, 9);
  ASSERT_EQ(rows.size(), 20U);
  for (std::size_t i = 0; i < rows.size(); i += 5) {
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t other = 0; other < 3; ++other) {
        EXPECT_EQ(rows[i + 2 + k][other], rows[i + (other == k ? 1 : 0)][other]);
      }
    }
  }
}

// A net: of 2^m points one stands in each of 2^m equal parts, by either key; the shift, around the end, keeps their
// distances.
TEST(SobolSequence, HasOnePointInEachPart) {
  const Shares zero = sobol_sequence(1, 2, 3), rows = sobol_sequence(64, 2, 3);
  for (std::size_t k = 0; k < 2; ++k) {
    std::array<int, 64> parts{};
    for (const std::vector<double>& row : rows) {
      const double unshifted = row[k] - zero[0][k] + (row[k] < zero[0][k] ? 1.0 : 0.0);
      ++parts[static_cast<std::size_t>(std::floor(unshifted * 64.0 + 1e-9)) % 64];
    }
    for (const int part : parts) EXPECT_EQ(part, 1);
  }
}

}  // namespace sensitivity_test
}  // namespace robomill::jobs
