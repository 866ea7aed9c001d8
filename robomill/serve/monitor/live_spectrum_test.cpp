#include "robomill/serve/monitor/live_spectrum.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

namespace robomill::serve {
namespace live_spectrum_test {

TEST(LiveSpectrum, ShowsAToneInItsBandAtAnyRate) {
  for (const double at_hz : {100.0, 2048.0, 10'240.0, 51'200.0, 192'000.0}) {
    monitor::MonitorOptions options = {.sample_rate_hz = at_hz, .channels = 3, .tachometer_channel = 0};
    LiveSpectrum spectrum(options);
    const std::vector<double>& edges_hz = spectrum.edges_hz();
    EXPECT_LE(edges_hz.size(), LiveSpectrum::most_bands + 1);
    EXPECT_GE(edges_hz.back(), std::min(at_hz / 2.0, 9950.0));
    EXPECT_TRUE(spectrum.take().empty());
    const double tone_hz = 0.3 * std::min(at_hz / 2.0, 10e3);
    std::vector<float> samples;
    for (int i = 0; i < static_cast<int>(0.5 * at_hz); ++i) {
      samples.insert(samples.end(), {1e6F, std::nanf(""),
                                     static_cast<float>(3.0 * std::sin(2.0 * std::numbers::pi * tone_hz * i / at_hz))});
    }
    spectrum.add(samples);
    const std::vector<float> amplitude = spectrum.take();
    ASSERT_EQ(amplitude.size() + 1, edges_hz.size());
    const auto strongest = static_cast<std::size_t>(std::ranges::max_element(amplitude) - amplitude.begin());
    EXPECT_NEAR(tone_hz, std::clamp(tone_hz, edges_hz[strongest], edges_hz[strongest + 1]), 1e-9 * tone_hz) << at_hz;
    EXPECT_NEAR(amplitude[strongest], 3.0F, 0.5F);  // up to 1.4 dB less between two lines
    EXPECT_TRUE(spectrum.take().empty());
  }
}

}  // namespace live_spectrum_test
}  // namespace robomill::serve
