#include "robomill/monitor/tachometer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "robomill/base/random.hpp"

namespace tachometer_test {

using namespace robomill::monitor;

TEST(Tachometer, CountsPulsesBetweenSamples) {
  Tachometer pulses(10240.0, 1);
  std::vector<double> x;
  for (int i = 0; i < 20480; ++i) {
    const double phase = std::fmod(73.3 * i / 10240.0, 1.0);
    x.push_back(5.0 * std::exp(-std::pow((phase - 0.5) / 0.03, 2)) + 0.01 * std::sin(0.1 * i));
  }
  EXPECT_EQ(pulses.rotation_hz(), 0.0);
  pulses.push(x);
  EXPECT_NEAR(pulses.rotation_hz(), 73.3, 0.02);
  pulses.push(std::vector<double>(1000, 0.0));
  EXPECT_EQ(pulses.rotation_hz(), 0.0);
}

// The shaft stops, and turns again: noise on the line is no pulse, however long it rests.
TEST(Tachometer, ARestHasNoPulses) {
  constexpr double rate_hz = 2048.0;
  Tachometer pulses(rate_hz, 1);
  robomill::Random random(1);
  EXPECT_EQ(pulses.quiet_s(), 0.0);
  const auto push = [&](double seconds, double rotation_hz) {
    std::vector<double> x;
    for (int i = 0; i < static_cast<int>(seconds * rate_hz); ++i) {
      x.push_back((std::fmod(rotation_hz * i / rate_hz, 1.0) > 0.8 ? 5.0 : 0.0) + 0.05 * random.normal());
    }
    pulses.push(x);
  };
  push(2.0, 20.0);
  EXPECT_NEAR(pulses.rotation_hz(), 20.0, 0.1);
  EXPECT_LT(pulses.quiet_s(), 0.05);
  for (int second = 1; second <= 120; ++second) {
    push(1.0, 0.0);
    EXPECT_EQ(pulses.rotation_hz(), 0.0) << second;
    EXPECT_NEAR(pulses.quiet_s(), second, 0.06);
  }
  push(0.3, 20.0);
  EXPECT_NEAR(pulses.rotation_hz(), 20.0, 0.1);
}

}  // namespace tachometer_test
