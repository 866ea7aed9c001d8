// robomill monitor on samples that were taken without an anti-alias filter.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/io/sample_source.hpp"
#include "test_program.hpp"

namespace robomill::app {
namespace alias_test {

using nlohmann::json;

constexpr double rate_hz = 1650.0, rotation_hz = 115.0, onset_s = 3.0;
constexpr double mode_hz = 989.0, measured_hz = rate_hz - mode_hz;

/// A cut at 6,900 rpm with two teeth, and from 3 s on chatter of a mode at 989 Hz, as a converter without a filter
/// takes it.
std::vector<float> folded_cut() {
  Random random(42);
  std::vector<float> samples;
  for (int i = 0; i < static_cast<int>(6.0 * rate_hz); ++i) {
    const double t = i / rate_hz;
    double x = 0.1 * random.normal();
    for (int k = 1; k <= 7; ++k) {
      x += (k % 2 == 0 ? 4.0 : 1.0) / k * std::sin(2.0 * std::numbers::pi * rotation_hz * k * t + k);
    }
    if (t > onset_s) {
      x += std::min(10.0, 0.02 * std::exp((t - onset_s) / 0.05)) * std::sin(2.0 * std::numbers::pi * mode_hz * t);
    }
    samples.push_back(static_cast<float>(x));
  }
  return samples;
}

std::string mode_table(double frequency_hz) {
  return "[[modes]]\nfrequency_hz = " + std::to_string(frequency_hz) +
         "\ndamping_ratio = 0.005\nleft = { x = [1, 0] }\nright = { x = [1, 0] }\n";
}

class FoldedLine : public ProgramTest {
 protected:
  /// The surest event of chatter, and the program's text.
  json alarm(const std::vector<double>& modes_hz, bool filter, const std::string& more = {}) {
    io::write_wav(folder_.at("rec.wav"), folded_cut(), 1, rate_hz);
    std::string modes;
    for (const double frequency_hz : modes_hz) modes += mode_table(frequency_hz);
    folder_.file("modes.toml", modes);
    folder_.file("monitor.toml", std::string("[signal]\nchannels = [\"ax\"]\n") +
                                     (filter ? "anti_alias_filter = true\n" : "") +
                                     "[process]\nspindle_speed_rpm = 6900\nteeth = 2\n" +
                                     (modes.empty() ? "" : "modes = \"modes.toml\"\n") + more);
    const Ended run = robomill("monitor monitor.toml --input rec.wav -o events.jsonl --report run.json");
    EXPECT_EQ(run.exit, 0) << run.err;
    said_ = run.out;
    json surest;
    std::istringstream lines(slurp(folder_.at("events.jsonl")));
    for (std::string line; std::getline(lines, line);) {
      json event = json::parse(line);
      if (event["state"] != "chatter" || event["chatter_frequency_hz"].is_null()) continue;
      if (!event["command"].is_null()) command_ = event["command"].get<std::string>();
      if (surest.is_null() || event["chatter_frequency_std_hz"] < surest["chatter_frequency_std_hz"]) surest = event;
    }
    EXPECT_FALSE(surest.is_null()) << said_;
    if (surest.is_null()) return surest;
    EXPECT_NEAR(surest["chatter_frequency_hz"].get<double>(), measured_hz, 2.0);
    return surest;
  }
  [[nodiscard]] json recorded_alarm() const {
    return json::parse(slurp(folder_.at("run.json")))["monitor"]["alarms"].at(0);
  }

  std::string said_, command_;
};

// Tooth passing is 230 Hz: the speeds are those at which 989 Hz, or 661 Hz, is a multiple of it.
void expect_speeds_of(const json& event, double frequency_hz) {
  ASSERT_FALSE(event["suggested_spindle_speed_rpm"].is_null()) << event;
  const double periods = 60.0 * frequency_hz / (2.0 * event["suggested_spindle_speed_rpm"].get<double>());
  EXPECT_NEAR(periods, std::round(periods), 0.01) << event;
}

TEST_F(FoldedLine, IsNamedWhereOneAliasAloneFitsTheModes) {
  const json event = alarm({mode_hz}, false);
  EXPECT_EQ(event["mode"], 1);
  ASSERT_EQ(event["line_frequencies_hz"].size(), 1U);
  EXPECT_NEAR(event["line_frequencies_hz"][0].get<double>(), mode_hz, 2.0);
  EXPECT_TRUE(event["no_speed"].is_null());
  expect_speeds_of(event, mode_hz);
  EXPECT_NE(said_.find(" Hz folded), mode 1; try "), std::string::npos) << said_;
  EXPECT_NEAR(recorded_alarm()["line_frequencies_hz"].at(0).get<double>(), mode_hz, 2.0);
}

TEST_F(FoldedLine, IsNotNamedWhereSeveralFitOrNone) {
  for (const std::vector<double>& modes_hz : {std::vector{measured_hz, mode_hz}, {60.0}, {}}) {
    const json event = alarm(modes_hz, false, "[act]\nrule = \"speed\"\n");
    EXPECT_TRUE(event["mode"].is_null());
    EXPECT_TRUE(event["suggested_spindle_speed_rpm"].is_null());
    EXPECT_TRUE(event["stable_spindle_speeds_rpm"].empty());
    EXPECT_EQ(event["no_speed"], "ambiguous-alias");
    EXPECT_EQ(event["line_frequencies_hz"].size(), modes_hz.size() == 2 ? 2U : 3U) << event;
    EXPECT_NE(said_.find("no mode, no speed: signal.anti_alias_filter is not stated, the line may be 66"),
              std::string::npos)
        << said_;
    // The rule commands nothing, and says why.
    EXPECT_EQ(command_, "none");
    EXPECT_NE(said_.find("; signal.anti_alias_filter is not stated: the line may be 66"), std::string::npos) << said_;
    EXPECT_EQ(recorded_alarm()["no_speed"], "ambiguous-alias");
  }
}

TEST_F(FoldedLine, IsWhatWasMeasuredWhereAFilterIsStated) {
  const json event = alarm({measured_hz, mode_hz}, true);
  EXPECT_EQ(event["mode"], 1);
  EXPECT_TRUE(event["line_frequencies_hz"].empty());
  EXPECT_TRUE(event["no_speed"].is_null());
  expect_speeds_of(event, measured_hz);
  EXPECT_EQ(said_.find("folded"), std::string::npos) << said_;
}

}  // namespace alias_test
}  // namespace robomill::app
