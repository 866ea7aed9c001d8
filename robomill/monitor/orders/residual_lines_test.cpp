// What is left beside the orders, of sums of sines whose amplitudes are known.
#include "robomill/monitor/orders/residual_lines.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/monitor/orders/noise_floor.hpp"
#include "robomill/monitor/orders/spectra.hpp"
#include "testing/monitor/tones.hpp"

namespace residual_lines_test {

using namespace robomill;
using namespace robomill::monitor;
using monitor::testing::cut_of;
using monitor::testing::power_of;
using monitor::testing::spectra_of;
using monitor::testing::sum_of;
using monitor::testing::Tone;
using monitor::testing::usual_windows_s;

constexpr double rate_hz = 10240.0;

double energy(const std::vector<Tone>& tones) {
  return std::accumulate(tones.begin(), tones.end(), 0.0,
                         [](double sum, const Tone& tone) { return sum + tone.amplitude * tone.amplitude; });
}

/// Of the window, 0: the long one.
struct Left {
  Left(const std::vector<Tone>& tones, double rotation_hz, std::size_t window, int teeth = 3, bool sure = true,
       double noise = 0.0, std::uint64_t seed = 1)
      : spectra(spectra_of(sum_of(tones, rate_hz, 0.32, noise, seed), rate_hz)),
        lines(spectra.spectrum(window, 0), {.highest_hz = spectra.highest_hz(), .sample_rate_hz = rate_hz}) {
    family = lines.find(power_of(spectra.spectrum(window, 0)), {}, {rotation_hz, teeth, sure});
  }
  /// Energy of what stands beside the orders.
  [[nodiscard]] double residual() const {
    std::vector<double> cells(600);
    lines.share_out(10.0, cells);
    return std::accumulate(cells.begin(), cells.end(), 0.0);
  }
  Spectra spectra;
  ResidualLines lines;
  ResidualFamily family;
};

TEST(ResidualLines, OrdersAloneLeaveNothing) {
  Random random(1);
  for (int run = 0; run < 40; ++run) {
    const double rotation_hz = random.uniform(25.0, 300.0);
    const int teeth = 1 + static_cast<int>(random.index(5));
    const std::vector<Tone> tones = cut_of(rotation_hz, teeth, random);
    for (std::size_t w = 0; w < 2; ++w) {
      if (rotation_hz * usual_windows_s.at(w) < 8.0) continue;  // as CutTests chooses its windows
      const Left left(tones, rotation_hz, w, teeth);
      EXPECT_NEAR(left.family.whole, energy(tones), 0.01 * energy(tones)) << rotation_hz;
      EXPECT_NEAR(left.family.synchronous, energy(tones), 0.015 * energy(tones)) << rotation_hz << " " << teeth;
      EXPECT_LT(left.residual(), 1e-3 * energy(tones)) << rotation_hz << " " << teeth;
      // A speed that is off by a thousandth leaves little more.
      EXPECT_LT(Left(tones, 1.001 * rotation_hz, w, teeth).family.family, 0.03 * energy(tones)) << rotation_hz;
    }
  }
}

TEST(ResidualLines, AFamilyCountsAsItsAmplitudesSay) {
  Random random(2);
  for (int run = 0; run < 40; ++run) {
    // Beyond the main lobe of an order and its own, a line counts wholly.
    const double rotation_hz = random.uniform(100.0, 250.0);
    std::vector<Tone> tones = cut_of(rotation_hz, 3, random);
    const double cut = energy(tones);
    const double strongest_hz = (std::floor(random.uniform(4.0, 12.0)) + random.uniform(0.3, 0.7)) * rotation_hz;
    std::vector<Tone> family;
    for (const auto& [side, amplitude] :
         {std::pair{-1, 0.5}, std::pair{0, 0.9}, std::pair{1, 0.4}, std::pair{3, 0.2}}) {
      family.push_back({strongest_hz + side * rotation_hz, amplitude, random.uniform(0.0, 6.0)});
    }
    tones.insert(tones.end(), family.begin(), family.end());
    for (std::size_t w = 0; w < 2; ++w) {
      if (w == 1 && rotation_hz < 150.0) continue;
      const ResidualFamily left = Left(tones, rotation_hz, w).family;
      EXPECT_NEAR(left.synchronous, cut, 0.015 * cut) << rotation_hz << " " << strongest_hz << " " << w;
      EXPECT_NEAR(left.family, energy(family), 0.08 * energy(family)) << rotation_hz << " " << strongest_hz << " " << w;
      EXPECT_NEAR(left.frequency_hz, strongest_hz, w == 0 ? 0.3 : 0.6) << rotation_hz;
    }
  }
}

// ±f_c + k f stand at the fractions φ and 1 - φ of an order, which are one place.
TEST(ResidualLines, TheMirrorImagesOfAFamilyBelongToIt) {
  std::vector<Tone> tones = {{360.0, 1.0}, {6.3 * 120.0, 0.4, 1.0}, {9.7 * 120.0, 0.3, 2.0}};
  EXPECT_NEAR(Left(tones, 120.0, 0).family.family, 0.25, 0.02);
  tones.push_back({12.45 * 120.0, 0.35});  // another
  EXPECT_NEAR(Left(tones, 120.0, 0).family.family, 0.25, 0.02);
  EXPECT_NEAR(Left(tones, 120.0, 0).residual(), 0.3725, 0.02);
}

TEST(ResidualLines, NoiseIsNoFamily) {
  Random random(3);
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    const double rotation_hz = random.uniform(40.0, 250.0);
    const std::vector<Tone> tones = cut_of(rotation_hz, 3, random);
    const Left left(tones, rotation_hz, 0, 3, true, 0.5, seed);
    EXPECT_GT(left.residual(), 0.15);
    EXPECT_LT(left.family.family, 0.2 * left.family.synchronous) << rotation_hz;
  }
}

TEST(ResidualLines, SharesItselfOutWholly) {
  Random random(4);
  for (int run = 0; run < 20; ++run) {
    const double rotation_hz = random.uniform(80.0, 250.0);
    const double line_hz = (7.0 + random.uniform(0.3, 0.7)) * rotation_hz;
    const int between = 3 * static_cast<int>(random.index(6)) + 1 + static_cast<int>(random.index(2));
    std::vector<Tone> tones = {{3.0 * rotation_hz, 1.0}, {line_hz, 0.5, 1.0}, {between * rotation_hz, 0.3, 2.0}};
    const Left left(tones, rotation_hz, 0);
    std::vector<double> beside(600), orders(600);
    left.lines.share_out(10.0, beside);
    left.lines.share_out_between(10.0, orders);
    EXPECT_NEAR(std::accumulate(beside.begin(), beside.end(), 0.0), 0.25, 0.01);
    EXPECT_NEAR(std::accumulate(orders.begin(), orders.end(), 0.0), 0.09, 0.01) << between;
    const auto near = [](const std::vector<double>& cells, double hz) {
      const auto at = static_cast<std::size_t>(hz / 10.0);
      return cells[at - 1] + cells[at] + cells[at + 1];
    };
    EXPECT_NEAR(near(beside, line_hz), 0.25, 0.01) << line_hz;
    EXPECT_NEAR(near(orders, between * rotation_hz), 0.09, 0.01) << between;
    // Its place is that of its energy, to the cell's width.
    double moment = 0.0;
    const double all = std::accumulate(orders.begin(), orders.end(), 0.0);
    for (std::size_t i = 0; i < orders.size(); ++i) moment += orders[i] * (static_cast<double>(i) + 0.5) * 10.0 / all;
    EXPECT_NEAR(moment, between * rotation_hz, 0.02 * between * rotation_hz + 5.0);
    // Where the teeth are not known, every order may be theirs.
    const Left unknown(tones, rotation_hz, 0, 0);
    std::vector<double> none(600);
    unknown.lines.share_out_between(10.0, none);
    EXPECT_EQ(std::accumulate(none.begin(), none.end(), 0.0), 0.0);
  }
}

// The comb that was found may be a multiple of the rotation: what stands at its fractions is then an order.
TEST(ResidualLines, SimpleFractionsDoNotCountWhereTheRotationIsUnsure) {
  for (int parts = 2; parts <= 6; ++parts) {
    for (int part = 1; part < parts; ++part) {
      const double hz = (4.0 + static_cast<double>(part) / parts) * 120.0;
      const std::vector<Tone> tones = {{120.0, 1.0}, {240.0, 0.7, 1.0}, {hz, 0.5, 2.0}};
      EXPECT_LT(Left(tones, 120.0, 0, 0, false).family.family, 0.1) << part << "/" << parts;
      EXPECT_NEAR(Left(tones, 120.0, 0, 0, true).family.family, 0.25, 0.02) << part << "/" << parts;
    }
  }
  // Away from them it does.
  const std::vector<Tone> tones = {{120.0, 1.0}, {240.0, 0.7, 1.0}, {4.083 * 120.0, 0.5, 2.0}};
  EXPECT_NEAR(Left(tones, 120.0, 0, 0, false).family.family, 0.25, 0.06);
}

// Of a window of eight turns and more, mild chatter shows several lines, each far above the noise beside it.
TEST(ResidualLines, CountsTheLinesThatStandOut) {
  std::vector<Tone> tones = {{240.0, 1.0}, {480.0, 0.5, 1.0}};
  for (const int count : {0, 1, 2, 3, 5}) {
    std::vector<Tone> all = tones;
    for (int i = 0; i < count; ++i) all.push_back({(5.0 + i) * 80.0 + 31.0, 0.1, 0.7 * i});
    const Spectra spectra = spectra_of(sum_of(all, rate_hz, 0.32, 0.02), rate_hz);
    const std::vector<float> power = power_of(spectra.spectrum(0, 0));
    NoiseFloor floor(power.size());
    ResidualLines lines(spectra.spectrum(0, 0), {.highest_hz = spectra.highest_hz(), .sample_rate_hz = rate_hz});
    const ResidualFamily found = lines.find(power, floor.of(power, 300), {80.0, 3, true});
    EXPECT_EQ(found.lines, count);
  }
}

// A converter at 1,650 Hz without a filter shows the 15th order of 200 Hz at 2 x 1,650 - 15 x 200 = 300 Hz.
TEST(ResidualLines, FoldedOrdersDoNotCount) {
  constexpr double low_hz = 1650.0;
  const auto family_of = [&](double line_hz, double sample_rate_hz) {
    const std::vector<Tone> tones = {{200.0, 0.2}, {600.0, 1.0, 1.0}, {line_hz, 0.5, 2.0}};
    const Spectra spectra = spectra_of(sum_of(tones, low_hz, 0.32), low_hz);
    ResidualLines lines(spectra.spectrum(0, 0), {.highest_hz = spectra.highest_hz(), .sample_rate_hz = sample_rate_hz});
    return lines.find(power_of(spectra.spectrum(0, 0)), {}, {200.0, 3, true}).family;
  };
  EXPECT_LT(family_of(300.0, low_hz), 0.01);
  EXPECT_NEAR(family_of(300.0, 20.0 * low_hz), 0.25, 0.03);  // a converter with a filter
  EXPECT_NEAR(family_of(260.0, low_hz), 0.25, 0.05);
}

// Speeds at both ends of what may be asked.
TEST(ResidualLines, AreFiniteAtAnySpeed) {
  for (const double rotation_hz : {0.0, 1e-3, 5.0, 15.0, 2559.0, 5119.0, 5121.0, 1e5}) {
    for (const bool sure : {false, true}) {
      for (std::size_t w = 0; w < 2; ++w) {
        const Left left({{240.0, 1.0}, {777.0, 0.5}}, rotation_hz, w, 2, sure, 0.1);
        EXPECT_TRUE(std::isfinite(left.family.family) && std::isfinite(left.family.frequency_hz)) << rotation_hz;
        EXPECT_GE(left.family.family, 0.0);
        EXPECT_NEAR(left.family.whole, 1.27, 0.05);
        std::vector<double> cells(10);
        left.lines.share_out(10.0, cells);
        left.lines.share_out_between(10.0, cells);
        EXPECT_TRUE(std::isfinite(cells.back()));
      }
    }
  }
}

}  // namespace residual_lines_test
