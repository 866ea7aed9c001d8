#include "robomill/monitor/tachometer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

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

}  // namespace tachometer_test
