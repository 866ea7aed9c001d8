#include "robomill/signal/bands.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "robomill/base/random.hpp"

namespace robomill::signal {
namespace bands_test {

// Property: each run holds exactly the extremes of its samples, whatever their number.
TEST(Bands, HoldTheExtremesOfTheirRuns) {
  Random random(1);
  for (int trial = 0; trial < 60; ++trial) {
    const auto n = static_cast<std::size_t>(1 + random.index(3000));
    const std::size_t most = 2 + 2 * random.index(40);
    Bands bands(2, most);
    std::vector<std::array<double, 2>> all(n);
    for (auto& values : all) {
      values = {random.normal(), random.normal()};
      bands.add(values);
    }
    const std::size_t length = bands.length();
    for (std::size_t curve = 0; curve < 2; ++curve) {
      const Band band = bands.band(curve);
      ASSERT_EQ(static_cast<std::size_t>(band.low.size()), (n + length - 1) / length);
      ASSERT_LE(static_cast<std::size_t>(band.low.size()), most);
      for (std::size_t run = 0; run * length < n; ++run) {
        double low = HUGE_VAL, high = -HUGE_VAL;
        for (std::size_t i = run * length; i < std::min(n, (run + 1) * length); ++i) {
          low = std::min(low, all[i][curve]);
          high = std::max(high, all[i][curve]);
        }
        ASSERT_EQ(band.low[static_cast<Eigen::Index>(run)], low);
        ASSERT_EQ(band.high[static_cast<Eigen::Index>(run)], high);
      }
    }
  }
}

// Property: what is left out, one by one as NaN or at once, is in no extreme, and runs without a value are NaN.
TEST(Bands, LeaveOutWhatIsAbsent) {
  Random random(2);
  for (int trial = 0; trial < 60; ++trial) {
    const std::size_t most = 2 + 2 * random.index(40);
    Bands one_by_one(2, most), at_once(2, most);
    std::vector<double> all;
    while (all.size() < 2000) {
      const auto count = static_cast<std::size_t>(1 + random.index(trial % 2 == 0 ? 5 : 500));
      const bool absent = random.index(2) == 0;
      if (absent) at_once.skip(count);
      for (std::size_t i = 0; i < count; ++i) {
        all.push_back(absent ? NAN : random.normal());
        const std::array<double, 2> values = {all.back(), NAN};
        one_by_one.add(values);
        if (!absent) at_once.add(values);
      }
    }
    const std::size_t length = at_once.length();
    ASSERT_EQ(length, one_by_one.length());
    const Band band = at_once.band(0), other = one_by_one.band(0);
    ASSERT_EQ(static_cast<std::size_t>(band.low.size()), (all.size() + length - 1) / length);
    ASSERT_TRUE(at_once.band(1).low.array().isNaN().all());
    for (std::size_t run = 0; run * length < all.size(); ++run) {
      double low = NAN, high = NAN;
      for (std::size_t i = run * length; i < std::min(all.size(), (run + 1) * length); ++i) {
        if (std::isnan(all[i])) continue;
        low = std::isnan(low) ? all[i] : std::min(low, all[i]);
        high = std::isnan(high) ? all[i] : std::max(high, all[i]);
      }
      const auto at = static_cast<Eigen::Index>(run);
      if (std::isnan(low)) {
        ASSERT_TRUE(std::isnan(band.low[at]) && std::isnan(band.high[at]) && std::isnan(other.low[at]));
        continue;
      }
      ASSERT_EQ(band.low[at], low);
      ASSERT_EQ(band.high[at], high);
      ASSERT_EQ(other.low[at], low);
    }
  }
  Bands years(1, 10);
  years.skip(std::uint64_t{1} << 60);
  EXPECT_LE(years.band(0).low.size(), 10);
}

}  // namespace bands_test
}  // namespace robomill::signal
