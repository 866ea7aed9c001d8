#include "robomill/monitor/monitor.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "testing/support.hpp"

namespace monitor_test {

using namespace robomill;
using namespace robomill::monitor;

TEST(ChatterMonitor, DecidesOnceAHopWhateverTheBlocks) {
  ChatterMonitor monitor({.sample_rate_hz = 10240.0, .channels = 2});
  EXPECT_EQ(monitor.frames_to_next_decision(), 256U);
  const std::vector<float> odd(333, 0.0F);
  std::size_t pushed = 0;
  Decision decision;
  while (pushed < 10 * 512) {
    decision = monitor.push(odd);
    pushed += odd.size();
    EXPECT_EQ(decision.hop, pushed / 512);
  }
  EXPECT_DOUBLE_EQ(decision.time_s, (10.0 * 256.0 - 1.0) / 10240.0);
}

TEST(MonitorOptions, RejectWhatMakesNoSense) {
  const auto field = [](const MonitorOptions& options) { return test::field_of([&] { options.validate(); }); };
  EXPECT_EQ(field({}), "sample_rate_hz");
  EXPECT_EQ(field({.sample_rate_hz = 1e4}), "accepted");
  EXPECT_EQ(field({.sample_rate_hz = 1e4, .channels = 0}), "channels");
  EXPECT_EQ(field({.sample_rate_hz = 1e4, .channels = 2, .tachometer_channel = 2}), "tachometer_channel");
  EXPECT_EQ(field({.sample_rate_hz = 1e4, .tachometer_channel = 0}), "tachometer_channel");
  EXPECT_EQ(field({.sample_rate_hz = 1e4, .spindle_speed_rad_per_s = std::nan("")}), "spindle_speed_rad_per_s");
  EXPECT_EQ(field({.sample_rate_hz = 1e4, .window_s = 0.01}), "window_s");
  EXPECT_EQ(field({.sample_rate_hz = 1e4, .hop_s = 1e-4}), "hop_s");
  EXPECT_EQ(field({.sample_rate_hz = 1e4, .bands = 65}), "bands");
  EXPECT_EQ(field({.sample_rate_hz = 1e4, .false_alarms_per_hour = 0.0}), "false_alarms_per_hour");
  EXPECT_EQ(field({.sample_rate_hz = 1e4, .full_scale = -1.0}), "full_scale");
}

}  // namespace monitor_test
