// The rotation where none is given, of combs that are known.
#include "robomill/monitor/orders/comb_search.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/monitor/orders/spectra.hpp"
#include "testing/monitor/tones.hpp"
#include "testing/support.hpp"

namespace comb_search_test {

using namespace robomill;
using namespace robomill::monitor;
using monitor::testing::cut_of;
using monitor::testing::power_of;
using monitor::testing::sum_of;
using monitor::testing::Tone;
using monitor::testing::usual_windows_s;

constexpr double rate_hz = 10240.0;
constexpr std::size_t hop = 256;

double found_hz(CombSearch& search, const std::vector<float>& x) {
  Spectra spectra(rate_hz, 1, usual_windows_s);
  for (std::size_t at = 0; at + hop <= x.size(); at += hop) {
    spectra.push(std::span(x).subspan(at, hop), hop);
    if (spectra.past_s() < usual_windows_s.front()) continue;
    spectra.transform(0);
    search.observe(power_of(spectra.spectrum(0, 0)), spectra.spectrum(0, 0));
  }
  return search.rotation_hz();
}

double found_hz(const std::vector<float>& x) {
  CombSearch search(0.025);
  return found_hz(search, x);
}

bool of_the_mains(double hz) {
  for (const double mains_hz : {25.0, 30.0, 50.0, 60.0}) {
    if (std::abs(hz / mains_hz - 1.0) < 0.015) return true;
  }
  return false;
}

bool multiple(double hz, double of_hz) {
  const double order = std::round(hz / of_hz);
  return order > 0.0 && std::abs(hz - order * of_hz) < 4e-3 * hz + 0.1;
}

// Or a part of tooth passing, which explains the lines as well.
TEST(CombSearch, FindsTheRotationOrAMultipleOfIt) {
  Random random(1);
  const int runs = test::seeds(400);
  int found = 0;
  int asked = 0;
  for (int run = 0; run < runs; ++run) {
    const double rotation_hz = 15.0 * std::exp(random.uniform(0.0, std::log(400.0 / 15.0)));
    // Below 1.5 kHz three multiples of tooth passing: fewer are no comb.
    const int teeth =
        1 + static_cast<int>(random.index(std::min<std::uint64_t>(4, static_cast<std::uint64_t>(500.0 / rotation_hz))));
    const std::vector<float> x = sum_of(cut_of(rotation_hz, teeth, random), rate_hz, 1.0, 0.05);
    bool mains = false;
    for (int k = 1; k <= teeth; ++k) mains = mains || of_the_mains(k * rotation_hz);
    if (mains) continue;
    ++asked;
    const double hz = found_hz(x);
    if (hz == 0.0) continue;
    ++found;
    EXPECT_TRUE(multiple(hz, rotation_hz) || multiple(teeth * rotation_hz, hz))
        << rotation_hz << " " << teeth << " " << hz;
  }
  EXPECT_GT(found, 0.9 * asked);
}

TEST(CombSearch, TakesHumNoiseAndSilenceForNoRotation) {
  for (const double mains_hz : {50.0, 60.0}) {
    const std::array hum = {Tone{mains_hz, 1.0, 0.3}, Tone{2.0 * mains_hz, 0.4, 1.0}, Tone{3.0 * mains_hz, 0.5, 2.0},
                            Tone{5.0 * mains_hz, 0.2, 2.0}};
    EXPECT_EQ(found_hz(sum_of(hum, rate_hz, 1.3, 0.05)), 0.0) << mains_hz;
  }
  for (std::uint64_t seed = 1; seed <= 5; ++seed) EXPECT_EQ(found_hz(sum_of({}, rate_hz, 1.3, 1.0, seed)), 0.0);
  EXPECT_EQ(found_hz(sum_of({}, rate_hz, 0.6)), 0.0);
}

TEST(CombSearch, ForgetsWithItsMemoryAndAtOnce) {
  Random random(2);
  const std::vector<float> first = sum_of(cut_of(81.0, 2, random), rate_hz, 1.3, 0.05);
  const std::vector<float> second = sum_of(cut_of(131.0, 2, random), rate_hz, 3.0, 0.05);
  const auto near = [](double hz, double of_hz) {
    return hz > 0.0 && std::abs(hz / of_hz - std::round(hz / of_hz)) < 4e-3 * hz / of_hz;
  };
  CombSearch search(0.025);
  EXPECT_TRUE(near(found_hz(search, first), 81.0));
  EXPECT_TRUE(near(found_hz(search, second), 131.0));
  search.reset();
  EXPECT_EQ(search.rotation_hz(), 0.0);
  EXPECT_TRUE(near(found_hz(search, first), 81.0));
}

}  // namespace comb_search_test
