// The spectra against sums and integrals that define them.
#include "robomill/monitor/orders/spectra.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <span>
#include <vector>

#include "robomill/base/random.hpp"
#include "testing/monitor/tones.hpp"

namespace spectra_test {

using namespace robomill;
using namespace robomill::monitor;
using monitor::testing::power_of;
using monitor::testing::spectra_of;
using monitor::testing::sum_of;
using monitor::testing::Tone;
using monitor::testing::transform_all;
using monitor::testing::usual_windows_s;

constexpr double turn = 2.0 * std::numbers::pi;
constexpr double rate_hz = 10240.0;

/// What a sine of amplitude 1 shows at a distance u = (ν - ν₀) T under the Hann window of length T:
///   h(u) = sin(πu)/(πu (1 - u²)),   h(0) = 1, h(±1) = 1/2, ∫ h² du = 3/2.   [Harris1978]
double hann_kernel(double u) {
  if (std::abs(u) < 1e-8) return 1.0;
  if (std::abs(std::abs(u) - 1.0) < 1e-8) return 0.5;
  return std::sin(std::numbers::pi * u) / (std::numbers::pi * u * (1.0 - u * u));
}

double energy_of(const Spectrum& spectrum) {
  double sum = 0.0;
  for (const auto& x : spectrum.line) sum += static_cast<double>(std::norm(x));
  return sum * spectrum.energy_share();
}

double greatest(const Spectrum& spectrum, double highest_hz) {
  double most = 0.0;
  for (std::size_t i = 0; i < spectrum.line.size() && static_cast<double>(i) * spectrum.step_hz < highest_hz; ++i) {
    most = std::max(most, static_cast<double>(std::abs(spectrum.line[i])));
  }
  return most;
}

TEST(HannKernel, IsTheFourierSumOfTheWindow) {
  Random random(1);
  constexpr int points = 4000;
  for (int run = 0; run < 50; ++run) {
    const double u = random.uniform(-8.0, 8.0);
    double sum = 0.0;
    for (int i = 0; i < points; ++i) {
      const double t = (i + 0.5) / points;
      sum += (1.0 - std::cos(turn * t)) * std::cos(turn * u * (t - 0.5)) / points;
    }
    EXPECT_NEAR(hann_kernel(u), sum, 2e-6) << u;
  }
}

TEST(HannKernel, HasItsZerosHalvesAndEnergy) {
  EXPECT_DOUBLE_EQ(hann_kernel(0.0), 1.0);
  for (const double side : {-1.0, 1.0}) {
    EXPECT_DOUBLE_EQ(hann_kernel(side), 0.5);
    for (int k = 2; k < 9; ++k) EXPECT_NEAR(hann_kernel(side * k), 0.0, 1e-15);
    // No step where the closed form is 0/0.
    for (const double off : {1e-9, 2e-8, 1e-6}) {
      EXPECT_NEAR(hann_kernel(side * off), 1.0, 1e-7);
      EXPECT_NEAR(hann_kernel(side * (1.0 + off)), 0.5, 1e-5);
    }
  }
  double integral = 0.0;
  for (int i = -20000; i <= 20000; ++i) integral += std::pow(hann_kernel(i / 200.0), 2) / 200.0;
  EXPECT_NEAR(integral, 1.5, 1e-9);
}

// Wherever it stands between two lines, in windows of any length: the lines of some are 1/(2T) apart.
TEST(Spectra, ShowTheAmplitudeOfASineBetweenLines) {
  Random random(9);
  for (int run = 0; run < 60; ++run) {
    const std::array<double, 1> window_s = {random.uniform(0.1, 0.5)};
    const Tone tone{random.uniform(300.0, 4500.0), random.uniform(0.1, 10.0), random.uniform(0.0, turn)};
    Spectra spectra(rate_hz, 1, window_s);
    const std::vector<float> x = sum_of(std::array{tone}, rate_hz, 0.6);
    spectra.push(x, x.size());
    spectra.transform(0);
    const Spectrum& own = spectra.spectrum(0, 0);
    EXPECT_NEAR(std::abs(std::complex<double>(own.at(tone.hz))), tone.amplitude, 3e-3 * tone.amplitude);
    const std::vector<float> power = power_of(own);
    const double place = tone.hz / own.step_hz;
    EXPECT_NEAR(own.power_at(power, place), tone.amplitude * tone.amplitude, 5e-3 * tone.amplitude * tone.amplitude);
    const auto k = static_cast<std::size_t>(std::ranges::max_element(power) - power.begin());
    const double read_hz = own.peak_hz(k, static_cast<double>(power[k - 1]), static_cast<double>(power[k]),
                                       static_cast<double>(power[k + 1]));
    EXPECT_NEAR(read_hz, tone.hz, 0.01 / own.seconds);
    std::array<float, 1> at_third = {};
    const std::array third = {static_cast<float>(place / 3.0)};
    ASSERT_EQ(at_multiple(power, own.dip, third, 3, power.size() - 1, at_third), 1U);
    EXPECT_NEAR(at_third[0], tone.amplitude * tone.amplitude, 5e-3 * tone.amplitude * tone.amplitude);
  }
}

// At every line near it, not only at its own: X = A exp(iφ) h((ν - f) T), φ the phase in the window's middle.
TEST(Spectra, ShowASineByTheKernelWithThePhaseOfTheMiddle) {
  Random random(2);
  for (int run = 0; run < 20; ++run) {
    const Tone tone{random.uniform(200.0, 4800.0), random.uniform(0.1, 10.0), random.uniform(0.0, turn)};
    const std::vector<float> x = sum_of(std::array{tone}, rate_hz, 0.31 + 0.01 * run);
    const Spectra spectra = spectra_of(x, rate_hz);
    for (std::size_t w = 0; w < usual_windows_s.size(); ++w) {
      const Spectrum& own = spectra.spectrum(w, 0);
      EXPECT_NEAR(own.seconds, usual_windows_s[w], 2.5 / rate_hz);
      EXPECT_LE(own.step_hz * own.seconds, 0.5);
      const double middle_s = (static_cast<double>(x.size()) - 0.5 * own.seconds * rate_hz) / rate_hz;
      const std::complex<double> amplitude = std::polar(tone.amplitude, turn * tone.hz * middle_s + tone.phase);
      for (std::size_t i = 1; i < own.line.size(); ++i) {
        const double u = (static_cast<double>(i) * own.step_hz - tone.hz) * own.seconds;
        if (std::abs(u) > 5.0) continue;
        EXPECT_LT(std::abs(std::complex<double>(own.line[i]) - amplitude * hann_kernel(u)), 2e-3 * tone.amplitude) << u;
      }
    }
  }
}

TEST(Spectra, EnergyIsTheSumOfTheSquaresOfAmplitudes) {
  Random random(3);
  for (int run = 0; run < 10; ++run) {
    std::vector<Tone> tones;
    double squares = 0.0;
    for (double hz = random.uniform(100.0, 300.0); hz < 4900.0; hz += random.uniform(100.0, 900.0)) {
      tones.push_back({hz, random.uniform(0.1, 2.0), random.uniform(0.0, turn)});
      squares += std::pow(tones.back().amplitude, 2);
    }
    const Spectra spectra = spectra_of(sum_of(tones, rate_hz, 0.4), rate_hz);
    for (std::size_t w = 0; w < usual_windows_s.size(); ++w) {
      EXPECT_NEAR(energy_of(spectra.spectrum(w, 0)), squares, 2e-3 * squares);
    }
  }
}

// A sine of amplitude A has the variance A²/2.
TEST(Spectra, EnergyOfNoiseIsTwiceItsVariance) {
  double sum = 0.0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    sum += energy_of(spectra_of(sum_of({}, rate_hz, 0.35, 0.7, seed), rate_hz).spectrum(0, 0)) / 20.0;
  }
  EXPECT_NEAR(sum, 2.0 * 0.49, 0.04);
}

TEST(Spectra, PeaksStandWhereTheSinesAre) {
  Random random(4);
  for (int run = 0; run < 30; ++run) {
    const Tone tone{random.uniform(200.0, 4800.0), 1.0, random.uniform(0.0, turn)};
    const Spectrum own = spectra_of(sum_of(std::array{tone}, rate_hz, 0.4), rate_hz).spectrum(0, 0);
    const auto k = static_cast<std::size_t>(std::lround(tone.hz / own.step_hz));
    const double found = own.peak_hz(k, std::norm(own.line[k - 1]), std::norm(own.line[k]), std::norm(own.line[k + 1]));
    EXPECT_NEAR(found, tone.hz, 0.02 / own.seconds);
  }
}

TEST(Spectra, ReducedRatesKeepWhatPassesAndFoldNothingIn) {
  Random random(5);
  for (const double high_hz : {20480.0, 44100.0, 48000.0, 96000.0}) {
    const double highest_hz = Spectra(high_hz, 1, usual_windows_s).highest_hz();
    const double reduced_hz = high_hz / std::floor(high_hz / 10240.0);
    EXPECT_NEAR(highest_hz, 0.425 * reduced_hz, 1e-6);
    for (int run = 0; run < 6; ++run) {
      const double hz = run == 0 ? highest_hz : random.uniform(50.0, 0.92 * highest_hz);
      const Spectrum own = spectra_of(sum_of(std::array{Tone{hz, 1.0, 1.0}}, high_hz, 0.4), high_hz).spectrum(0, 0);
      // Between two lines a sine shows h of half their distance.
      const double off = std::abs(std::remainder(hz / own.step_hz, 1.0)) * own.step_hz * own.seconds;
      EXPECT_NEAR(greatest(own, 1e9), hann_kernel(off), run == 0 ? 0.13 : 0.01) << high_hz << " " << hz;
    }
    // 10^(-50/20)
    for (int run = 0; run < 6; ++run) {
      const double hz = run == 0 ? reduced_hz - highest_hz : random.uniform(reduced_hz - highest_hz, 0.5 * high_hz);
      const Spectra folded = spectra_of(sum_of(std::array{Tone{hz, 1.0, 1.0}}, high_hz, 0.4), high_hz);
      EXPECT_LT(greatest(folded.spectrum(0, 0), highest_hz), 3.16e-3) << high_hz << " " << hz;
    }
  }
}

TEST(Spectra, TheCourseOfADecayingSineFallsAsItDoes) {
  Random random(6);
  for (int run = 0; run < 20; ++run) {
    const double hz = random.uniform(800.0, 4000.0), decay_s = random.uniform(0.01, 0.3);
    std::vector<float> x = sum_of(std::array{Tone{hz, 2.0, random.uniform(0.0, turn)}}, rate_hz, 0.3);
    Spectra spectra(rate_hz, 2, usual_windows_s);
    spectra.push(
        [&] {
          std::vector<float> both = x;
          for (std::size_t i = 0; i < x.size(); ++i) {
            both.push_back(static_cast<float>(x[i] * std::exp(-static_cast<double>(i) / rate_hz / decay_s)));
          }
          return both;
        }(),
        x.size());
    std::array<double, 6> steady = {}, falling = {};
    spectra.course(1, 0, hz, 0.0, steady);
    spectra.course(1, 1, hz, 0.0, falling);
    for (std::size_t b = 0; b < 6; ++b) {
      EXPECT_NEAR(steady[b], 4.0, 0.1);
      if (b == 0) continue;
      EXPECT_NEAR(std::log(falling[b] / falling[b - 1]), -2.0 * 0.025 / decay_s, 0.03 + 0.05 * 0.05 / decay_s)
          << decay_s;
    }
  }
}

// Orders of the amplitude 1 about a knock of 0.7 that decays in 20 ms: beside them its decay shows.
TEST(Spectra, TheCourseLeavesTheOrdersOut) {
  Random random(7);
  int fall_beside = 0, fall_among = 0;
  const int runs = 100;
  for (int run = 0; run < runs; ++run) {
    const double rotation_hz = random.uniform(30.0, 60.0), knock_hz = (12.0 + run % 5 + 0.5) * rotation_hz;
    std::vector<Tone> tones;
    for (int k = 1; k <= 30; ++k) tones.push_back({k * rotation_hz, 1.0, random.uniform(0.0, turn)});
    std::vector<float> x = sum_of(tones, rate_hz, 0.35);
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double t = static_cast<double>(i) / rate_hz - 0.25;
      if (t > 0.0) x[i] += static_cast<float>(0.7 * std::exp(-t / 0.02) * std::sin(turn * knock_hz * t));
    }
    Spectra spectra(rate_hz, 1, usual_windows_s);
    spectra.push(x, x.size());
    transform_all(spectra);
    const auto falls = [&](double without_hz) {
      std::array<double, 6> course = {};
      spectra.course(1, 0, knock_hz, without_hz, course);
      return course.back() < 0.5 * *std::ranges::max_element(course);
    };
    fall_beside += falls(rotation_hz) ? 1 : 0;
    fall_among += falls(0.0) ? 1 : 0;
  }
  EXPECT_GE(fall_beside, 80);
  EXPECT_LE(fall_among, 60);
}

TEST(Spectra, PowerIsThatOfTheChannelsThatAreGood) {
  const std::vector<float> x = sum_of(std::array{Tone{700.0}}, rate_hz, 0.3, 0.1);
  std::vector<float> two = x;
  for (const float sample : x) two.push_back(2.0F * sample);
  Spectra spectra(rate_hz, 2, usual_windows_s);
  spectra.push(two, x.size());
  transform_all(spectra);
  std::vector<float> power(spectra.spectrum(0, 0).line.size());
  const auto at = static_cast<std::size_t>(std::lround(700.0 / spectra.spectrum(0, 0).step_hz));
  spectra.power(0, 0, power);
  const float both = power[at];
  spectra.power(0, 1, power);
  EXPECT_NEAR(both, 1.25 * power[at], 1e-5 * both);
  EXPECT_EQ(power[0], 0.0F);
}

// Long windows of a slow spindle need no high frequencies: fewer samples cost less.
TEST(Spectra, AReducedRateSavesTheHighFrequencies) {
  const Spectra slow(10240.0, 1, std::array{1.0, 0.5}, 2560.0);
  EXPECT_NEAR(slow.highest_hz(), 0.425 * 2560.0, 1e-6);
  EXPECT_NEAR(slow.spectrum(0, 0).seconds, 1.0, 2.5 / 2560.0);
  EXPECT_LT(slow.spectrum(0, 0).line.size(), 4097U);
}

TEST(Spectra, AreTheSameInAnyBlocksAndAfterReset) {
  for (const double any_hz : {8000.0, 44100.0}) {
    const std::vector<float> x = sum_of(std::array{Tone{700.0}}, any_hz, 0.5, 0.3);
    const Spectra whole = spectra_of(x, any_hz);
    Spectra pieces(any_hz, 1, usual_windows_s);
    Random random(7);
    for (int pass = 0; pass < 2; ++pass) {
      std::size_t at = 0;
      while (at < x.size()) {
        const std::size_t n = std::min<std::size_t>(1 + random.index(900), x.size() - at);
        pieces.push(std::span(x).subspan(at, n), n);
        at += n;
      }
      transform_all(pieces);
      EXPECT_NEAR(pieces.past_s(), 0.5, 1e-3);
      for (std::size_t w = 0; w < usual_windows_s.size(); ++w) {
        EXPECT_TRUE(pieces.spectrum(w, 0).line == whole.spectrum(w, 0).line);
      }
      pieces.reset();
      EXPECT_EQ(pieces.past_s(), 0.0);
    }
  }
}

}  // namespace spectra_test
