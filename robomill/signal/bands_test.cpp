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

}  // namespace bands_test
}  // namespace robomill::signal
