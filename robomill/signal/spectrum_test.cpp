#include "robomill/signal/spectrum.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "robomill/base/error.hpp"
#include "robomill/base/random.hpp"

namespace robomill::signal {
namespace spectrum_test {

Eigen::VectorXd sine(Eigen::Index n, double sample_rate_hz, double frequency_hz, double amplitude, double phase) {
  Eigen::VectorXd x(n);
  for (Eigen::Index j = 0; j < n; ++j) {
    x(j) =
        amplitude * std::sin(2.0 * std::numbers::pi * frequency_hz * static_cast<double>(j) / sample_rate_hz + phase);
  }
  return x;
}

TEST(AmplitudeSpectrum, ShowsTheAmplitudeOfASineAtALine) {
  const Spectrum spectrum = amplitude_spectrum(sine(1000, 1000.0, 120.0, 3.0, 0.4).array() + 7.0, 1000.0);
  EXPECT_EQ(spectrum.frequency_hz.size(), 501);
  EXPECT_DOUBLE_EQ(spectrum.frequency_hz(500), 500.0);
  EXPECT_NEAR(spectrum.amplitude(120), 3.0, 1e-12);
  EXPECT_NEAR(spectrum.amplitude(0), 7.0, 1e-12);
  EXPECT_LT(spectrum.amplitude(123), 1e-12);
}

TEST(AmplitudeSpectrum, ShowsTheAmplitudeAtTheHighestLine) {
  Eigen::VectorXd x(64);
  for (Eigen::Index j = 0; j < 64; ++j) x(j) = j % 2 == 0 ? 2.0 : -2.0;
  EXPECT_NEAR(amplitude_spectrum(x, 64.0).amplitude(32), 2.0, 1e-12);
}

// The mirror image of the line at -f leaks by about (Δf/f)³: 1e-6 here.
TEST(FindPeaks, InterpolatesFrequencyAndAmplitudeOfALoneSine) {
  Random random(3);
  for (int trial = 0; trial < 200; ++trial) {
    const double frequency_hz = random.uniform(100.0, 400.0);
    const double amplitude = random.uniform(0.1, 10.0);
    const Eigen::VectorXd x = sine(1000 + trial, 1000.0, frequency_hz, amplitude, random.uniform(0.0, 6.0));
    const std::vector<SpectralPeak> peaks = find_peaks(amplitude_spectrum(x, 1000.0), {.count = 1});
    ASSERT_EQ(peaks.size(), 1u);
    EXPECT_NEAR(peaks[0].frequency_hz, frequency_hz, 1e-5);
    EXPECT_NEAR(peaks[0].amplitude, amplitude, 1e-5 * amplitude);
  }
}

TEST(FindPeaks, OrdersByHeightAndKeepsToItsLimits) {
  const Eigen::VectorXd x = sine(2000, 1000.0, 50.3, 1.0, 0.0) + sine(2000, 1000.0, 120.7, 3.0, 1.0) +
                            sine(2000, 1000.0, 333.1, 0.4, 2.0) + sine(2000, 1000.0, 410.0, 0.01, 2.0);
  const Spectrum spectrum = amplitude_spectrum(x, 1000.0);
  const std::vector<SpectralPeak> peaks = find_peaks(spectrum);
  ASSERT_EQ(peaks.size(), 3u);
  EXPECT_NEAR(peaks[0].frequency_hz, 120.7, 1e-3);
  EXPECT_NEAR(peaks[1].frequency_hz, 50.3, 1e-3);
  EXPECT_NEAR(peaks[2].frequency_hz, 333.1, 1e-3);
  EXPECT_NEAR(peaks[2].amplitude, 0.4, 1e-3);

  ASSERT_EQ(find_peaks(spectrum, {.count = 2}).size(), 2u);
  EXPECT_NEAR(find_peaks(spectrum, {.min_frequency_hz = 200.0, .max_frequency_hz = 400.0})[0].frequency_hz, 333.1,
              1e-3);
  const std::vector<SpectralPeak> apart = find_peaks(spectrum, {.min_separation_hz = 100.0});
  ASSERT_EQ(apart.size(), 2u);
  EXPECT_NEAR(apart[1].frequency_hz, 333.1, 1e-3);
}

TEST(FindPeaks, FindsNothingInSilence) {
  EXPECT_TRUE(find_peaks(amplitude_spectrum(Eigen::VectorXd::Zero(100), 10.0)).empty());
}

TEST(Spectrum, RejectsWhatMakesNoSense) {
  Eigen::VectorXd x = Eigen::VectorXd::Zero(100);
  EXPECT_THROW(static_cast<void>(amplitude_spectrum(x, 0.0)), InvalidInput);
  EXPECT_THROW(static_cast<void>(amplitude_spectrum(x.head(3), 1.0)), InvalidInput);
  const Spectrum spectrum = amplitude_spectrum(x, 1.0);
  EXPECT_THROW(static_cast<void>(find_peaks(spectrum, {.count = 0})), InvalidInput);
  EXPECT_THROW(static_cast<void>(find_peaks(spectrum, {.relative_height = 2.0})), InvalidInput);
  EXPECT_THROW(static_cast<void>(find_peaks(Spectrum{})), InvalidInput);
  x(5) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(static_cast<void>(amplitude_spectrum(x, 1.0)), InvalidInput);
}

}  // namespace spectrum_test
}  // namespace robomill::signal
