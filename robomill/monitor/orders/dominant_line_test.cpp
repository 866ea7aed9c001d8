// The line that comes to dominate, of sums of sines.
#include "robomill/monitor/orders/dominant_line.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "robomill/base/random.hpp"
#include "testing/monitor/tones.hpp"

namespace dominant_line_test {

using namespace robomill;
using namespace robomill::monitor;
using monitor::testing::power_of;
using monitor::testing::usual_windows_s;

constexpr double rate_hz = 2048.0;
constexpr double hop_s = 0.025;

struct Followed {
  double first_s = -1.0;  // when all that the test asks for held first
  double frequency_hz = 0.0;
};

/// @param amplitude  of a line at `hz`, over noise of 0.01
Followed follow(double hz, const std::function<double(double)>& amplitude, double seconds,
                const DominantLine::Forced& forced = {}) {
  Random random(3);
  Spectra spectra(rate_hz, 1, usual_windows_s);
  DominantLine line(spectra.spectrum(0, 0).line.size(), hop_s);
  const auto hop = static_cast<std::size_t>(hop_s * rate_hz);
  Followed out;
  std::vector<float> x(hop);
  for (std::size_t at = 0; static_cast<double>(at) < seconds * rate_hz; at += hop) {
    for (std::size_t i = 0; i < hop; ++i) {
      const double t = static_cast<double>(at + i) / rate_hz;
      x[i] = static_cast<float>(amplitude(t) * std::sin(2.0 * std::numbers::pi * hz * t) + 0.01 * random.normal());
    }
    spectra.push(x, hop);
    spectra.transform(0);
    const std::vector<float> power = power_of(spectra.spectrum(0, 0));
    const double whole = energy_of(power, spectra.spectrum(0, 0), spectra.highest_hz()).whole;
    line.step(power, spectra.spectrum(0, 0), whole, forced, spectra.past_s() > 0.3);
    const bool holds = line.share() >= DominantLine::least_share && line.kept() >= 9 && line.rise() >= 12.6 &&
                       line.rise_since() >= 2.0;
    if (!holds || out.first_s >= 0.0) continue;
    out = {static_cast<double>(at + hop) / rate_hz, line.frequency_hz()};
  }
  return out;
}

double growing(double per_s, double t) {
  return std::min(1.0, 0.003 * std::exp(per_s * std::max(0.0, t - 1.0)));
}

// As chatter of turning and of arms does: 2 to 10 1/s in amplitude.
TEST(DominantLine, FindsWhatStillGrowsWhenItDominates) {
  for (const double per_s : {2.0, 4.0, 8.0}) {
    const Followed found = follow(
        97.0, [&](double t) { return growing(per_s, t); }, 5.0);
    ASSERT_GT(found.first_s, 1.0) << per_s;
    EXPECT_LT(growing(per_s, found.first_s - 0.15), 0.5) << per_s;  // before it is full
    EXPECT_NEAR(found.frequency_hz, 97.0, 1.0);
  }
}

// It comes within a window and stays: a drive's tone, or tooth passing as the tool enters.
TEST(DominantLine, AToneThatBeginsIsNone) {
  for (const double fade_s : {0.01, 0.1, 0.2}) {
    const Followed found = follow(
        97.0, [&](double t) { return std::clamp((t - 1.0) / fade_s, 0.0, 1.0); }, 4.0);
    EXPECT_LT(found.first_s, 0.0) << fade_s;
  }
  EXPECT_LT(follow(
                97.0, [](double) { return 1.0; }, 4.0)
                .first_s,
            0.0);
  EXPECT_LT(follow(
                97.0, [](double) { return 0.0; }, 4.0)
                .first_s,
            0.0);
}

TEST(DominantLine, ForcedVibrationIsLeftOut) {
  const auto grows = [](double t) { return growing(4.0, t); };
  const DominantLine::Forced three_teeth{.rotation_hz = 20.0, .teeth = 3, .off_ratio = 0.01};
  EXPECT_LT(follow(120.0, grows, 4.0, three_teeth).first_s, 0.0);
  EXPECT_LT(follow(40.0, grows, 4.0, three_teeth).first_s, 0.0);  // a low multiple of rotation: runout
  EXPECT_GT(follow(150.0, grows, 4.0, three_teeth).first_s, 0.0);
  // Of a slow lathe tooth passing stands too close to be told apart.
  EXPECT_GT(follow(97.0, grows, 4.0, {.rotation_hz = 5.4, .teeth = 1}).first_s, 0.0);
  // The multiples of a comb that was found, but not what it was found by.
  EXPECT_LT(follow(240.0, grows, 4.0, {.comb_hz = 120.0}).first_s, 0.0);
  EXPECT_GT(follow(120.0, grows, 4.0, {.comb_hz = 120.0}).first_s, 0.0);
}

TEST(DominantLine, BeginsAnewAfterReset) {
  DominantLine line(100, hop_s);
  EXPECT_EQ(line.rise(), 0.0);
  EXPECT_EQ(line.kept(), 0);
  EXPECT_EQ(line.rise_since(), 0.0);
}

}  // namespace dominant_line_test
