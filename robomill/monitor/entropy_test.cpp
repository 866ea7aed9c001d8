#include "robomill/monitor/entropy.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "robomill/base/random.hpp"
#include "testing/allocations.hpp"
#include "testing/support.hpp"

namespace robomill::monitor {
namespace entropy_test {

MonitorOptions published(Entropy entropy) {
  return {.sample_rate_hz = 10240.0, .entropy = entropy};
}

std::vector<double> tone(double frequency_hz, double amplitude, std::size_t n) {
  std::vector<double> x(n);
  for (std::size_t m = 0; m < n; ++m) {
    x[m] = amplitude * std::sin(2.0 * std::numbers::pi * frequency_hz * static_cast<double>(m) / 10240.0);
  }
  return x;
}

// With p of one over 16: ln 16 = 2.77, far below a threshold of 105, and of 10⁵.
TEST(EnergyEntropyFormula, NormalisedIsAtMostTheLogarithmOfTheBands) {
  std::vector<double> energies(16, 3.7);
  EXPECT_NEAR(energy_entropy(energies, Entropy::normalised), std::log(16.0), 1e-14);
  Random random(1);
  for (int trial = 0; trial < 1000; ++trial) {
    for (double& e : energies) e = std::pow(random.uniform(), 4);
    const double h = energy_entropy(energies, Entropy::normalised);
    EXPECT_GE(h, 0.0);
    EXPECT_LE(h, std::log(16.0) + 1e-14);
  }
}

// -x ln x is at most 1/e, whatever the unit of x: 16/e = 5.89 for 16 bands, below 105 and 10⁵ as well. So of the forms
// that grow with chatter as the source's does, only one that carries the energy itself can pass either.
TEST(EnergyEntropyFormula, WithoutNormalisationTheLogarithmBoundsIt) {
  Random random(4);
  double most = 0.0;
  for (int trial = 0; trial < 100'000; ++trial) {
    double sum = 0.0;
    for (int b = 0; b < 16; ++b) {
      const double e = std::exp(random.uniform(-20.0, 20.0));
      sum -= e * std::log(e);
    }
    most = std::max(most, sum);
  }
  EXPECT_LE(most, 16.0 / std::numbers::e);
  const std::vector<double> bands(16, 1e5);
  EXPECT_GT(energy_entropy(bands, Entropy::energy), 1e5);
}

TEST(EntropyDetector, HasNoThresholdOfItsOwn) {
  MonitorOptions options = published(Entropy::energy);
  EXPECT_EQ(test::field_of([&] { options.validate(); }), "accepted");  // comb-cusum needs none
  options.kind = Kind::energy_entropy;
  EXPECT_EQ(test::field_of([&] { ChatterMonitor monitor(options); }), "threshold");
  options.threshold = 1e5;
  EXPECT_EQ(test::field_of([&] { ChatterMonitor monitor(options); }), "accepted");
}

TEST(EnergyEntropyFormula, OneBandHasNone) {
  const double energies[] = {0.0, 5.0, 0.0};
  EXPECT_EQ(energy_entropy(energies, Entropy::normalised), 0.0);
  EXPECT_EQ(energy_entropy(energies, Entropy::energy), 0.0);
  const double none[] = {0.0, 0.0};
  EXPECT_EQ(energy_entropy(none, Entropy::normalised), 0.0);
  EXPECT_EQ(energy_entropy(none, Entropy::energy), 0.0);
}

// -Σ E ln p by hand: E = (1, 3): 1 ln 4 + 3 ln(4/3).
TEST(EnergyEntropyFormula, EnergyScalesWithTheUnitAndIsNeverNegative) {
  const double energies[] = {1.0, 3.0}, in_another_unit[] = {1e6, 3e6};
  const double expected = std::log(4.0) + 3.0 * std::log(4.0 / 3.0);
  EXPECT_NEAR(energy_entropy(energies, Entropy::energy), expected, 1e-15);
  EXPECT_NEAR(energy_entropy(in_another_unit, Entropy::energy), 1e6 * expected, 1e-8);
  EXPECT_NEAR(energy_entropy(in_another_unit, Entropy::normalised), expected / 4.0, 1e-15);
}

// Two tones in two bands: their mean squares are half the squares of their amplitudes.
TEST(EnergyEntropy, FindsTheEnergiesOfTwoTones) {
  EnergyEntropy feature(published(Entropy::normalised));
  std::vector<double> x = tone(480.0, 2.0, 4096);
  const std::vector<double> second = tone(2720.0, 1.0, 4096);
  for (std::size_t m = 0; m < x.size(); ++m) x[m] += second[m];
  const double h = feature.push(x);
  for (std::size_t b = 0; b < 16; ++b) {
    EXPECT_NEAR(feature.energies()[b], b == 1 ? 2.0 : b == 8 ? 0.5 : 0.0, 1e-3) << "band " << b;
  }
  EXPECT_NEAR(h, -0.8 * std::log(0.8) - 0.2 * std::log(0.2), 1e-3);
}

TEST(EnergyEntropy, AnySplitGivesTheSameBits) {
  Random random(2);
  std::vector<double> x(5000);
  for (double& value : x) value = random.normal();
  EnergyEntropy whole(published(Entropy::energy)), parts(published(Entropy::energy));
  const double expected = whole.push(x);
  double h = 0.0;
  for (std::size_t at = 0; at < x.size();) {
    const std::size_t size = std::min<std::size_t>(x.size() - at, 1 + random.index(700));
    h = parts.push(std::span<const double>(x).subspan(at, size));
    at += size;
  }
  EXPECT_EQ(h, expected);
  parts.reset();
  EXPECT_EQ(parts.push(x), expected);
}

TEST(EnergyEntropy, HoldsNothingFromBeforeItsWarmUp) {
  EnergyEntropy late(published(Entropy::energy)), settled(published(Entropy::energy));
  const std::vector<double> x = tone(700.0, 1.0, settled.warm_up());
  std::vector<double> noise(4096);
  Random random(3);
  for (double& value : noise) value = random.normal();
  static_cast<void>(settled.push(noise));
  const double h = settled.push(x);
  EXPECT_NEAR(h, late.push(x), 1e-12);
}

TEST(EnergyEntropy, WorksAtOtherRatesAndOddWindows) {
  EnergyEntropy feature({.sample_rate_hz = 5020.0});  // 251 samples
  std::vector<double> x(3000, 0.0);
  EXPECT_EQ(feature.push(x), 0.0);
  EXPECT_EQ(feature.warm_up(), 504U);
}

TEST(EnergyEntropy, AllocatesNothing) {
  EnergyEntropy feature(published(Entropy::energy));
  const std::vector<double> x = tone(700.0, 1.0, 3000);
  EXPECT_EQ(test::allocations([&] {
              static_cast<void>(feature.push(x));
              feature.reset();
            }),
            0U);
}

}  // namespace entropy_test
}  // namespace robomill::monitor
