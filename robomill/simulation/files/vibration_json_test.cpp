#include "robomill/simulation/files/vibration_json.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "robomill/io/json.hpp"

namespace robomill::simulation {
namespace vibration_json_test {

/// 3 µm at 400 Hz in x about 10 µm, nothing in z.
Simulation sine(Eigen::Index samples) {
  Simulation s;
  s.sample_rate_hz = 10000.0;
  s.displacement_m.setZero(samples, 3);
  s.acceleration_m_per_s2.setZero(samples, 3);
  s.force_n.setZero(samples, 3);
  for (Eigen::Index i = 0; i < samples; ++i) {
    const double phase = 2.0 * std::numbers::pi * 400.0 * static_cast<double>(i) / s.sample_rate_hz;
    s.displacement_m(i, 0) = 10e-6 + 3e-6 * std::sin(phase);
    s.displacement_m(i, 1) = 1e-9 * static_cast<double>(i);
    s.force_n(i, 2) = i == 7777 ? 250.0 : 1.0;
  }
  return s;
}

TEST(VibrationJson, KeepsPeaksAndNamesTheLine) {
  const io::Json json = io::Json::parse(vibration_json(sine(20000)));
  const auto high = json["force_n"]["z"]["high"].get<std::vector<double>>();
  EXPECT_EQ(*std::ranges::max_element(high), 250.0);
  EXPECT_LE(high.size(), 2000U);
  EXPECT_NEAR(json["run_s"].get<double>() * static_cast<double>(high.size()), 2.0, json["run_s"].get<double>());
  EXPECT_EQ(json["displacement_um"]["x"]["low"].size(), high.size());
  EXPECT_FALSE(json["displacement_um"].contains("z"));
  EXPECT_FALSE(json["force_n"].contains("x"));
  const auto& spectrum = json["spectrum"];
  EXPECT_EQ(spectrum["from_s"], 1.0);
  const auto amplitude = spectrum["x_um"].get<std::vector<double>>();
  const auto top = std::ranges::max_element(amplitude) - amplitude.begin();
  EXPECT_EQ(spectrum["frequency_hz"][static_cast<std::size_t>(top)], 400.0);
  EXPECT_NEAR(amplitude[static_cast<std::size_t>(top)], 3.0, 1e-6);
}

TEST(VibrationJson, SaysNothingOfWhatIsTooShortOrStill) {
  EXPECT_TRUE(io::Json::parse(vibration_json(sine(20)))["spectrum"].is_null());
  EXPECT_TRUE(io::Json::parse(vibration_json(sine(0)))["displacement_um"].empty());
  Simulation still = sine(1000);
  still.displacement_m.setZero();
  EXPECT_TRUE(io::Json::parse(vibration_json(still))["spectrum"].is_null());
}

}  // namespace vibration_json_test
}  // namespace robomill::simulation
