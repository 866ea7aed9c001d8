// robomill calibrate as a user runs it.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/io/sample_source.hpp"
#include "test_program.hpp"

namespace robomill::app {
namespace calibrate_test {

using nlohmann::json;

class CalibrateVerb : public ProgramTest {
 protected:
  void wav(const std::string& name, const std::vector<float>& samples) {
    io::write_wav(folder_.at(name), samples, 1, 10240.0);
  }
};

// Noise that doubles where chatter begins: the un-normalised entropy distinguishes them.
TEST_F(CalibrateVerb, Calibrates) {
  std::string text = "[signal]\nchannels = [1]\n[calibration]\nfalse_alarm_rate = 0.1\n";
  Random random(3);
  for (int i = 0; i < 8; ++i) {
    std::vector<float> samples;
    for (std::size_t k = 0; k < 20'000; ++k) {
      const double gain = i % 2 == 1 && k > 10'000 ? 3.0 : 1.0;
      samples.push_back(static_cast<float>(gain * random.normal()));
    }
    const std::string name = "rec" + std::to_string(i) + ".wav";
    wav(name, samples);
    text += "[[recordings]]\nfile = \"" + name + "\"\nlabel = \"" + (i % 2 == 1 ? "chatter" : "stable") + "\"\n";
    if (i % 2 == 1) text += "onset_s = 0.9766\n";
  }
  folder_.file("recordings.toml", text);
  const Ended run = robomill("calibrate recordings.toml -o calibrated.toml --report report.json");
  ASSERT_EQ(run.exit, 0) << run.err;
  EXPECT_NE(run.out.find("100.0 % found"), std::string::npos) << run.out;
  const json report = json::parse(slurp(folder_.at("report.json")));
  EXPECT_EQ(report["status"], "found");
  EXPECT_EQ(report["reason"], "");
  EXPECT_EQ(report["alarm"], "above");
  EXPECT_EQ(report["recordings"].size(), 8U);
  EXPECT_EQ(report["verifying"]["chosen"]["detection_rate"], 1.0);
  EXPECT_GE(report["setting"]["roc"].size(), 2U);
  EXPECT_NE(slurp(folder_.at("calibrated.toml")).find("threshold = "), std::string::npos);
  EXPECT_EQ(robomill("monitor calibrated.toml --input rec1.wav --quiet").exit, 0);
}

// Labels that the signal does not bear out: exit code 3, the report of what was reached, and no monitor.toml.
TEST_F(CalibrateVerb, WritesNoDetectorWhereNoThresholdWorks) {
  std::string text = "[signal]\nchannels = [1]\n[calibration]\nfalse_alarm_rate = 0.0\n";
  for (int i = 0; i < 8; ++i) {
    Random random(static_cast<std::uint64_t>(10 + i / 2));
    std::vector<float> samples(20'000);
    for (float& sample : samples) sample = static_cast<float>(random.normal());
    const std::string name = "rec" + std::to_string(i) + ".wav";
    wav(name, samples);
    text += "[[recordings]]\nfile = \"" + name + "\"\nlabel = \"" + (i % 2 == 1 ? "chatter" : "stable") + "\"\n";
  }
  folder_.file("recordings.toml", text);
  const Ended run = robomill("calibrate recordings.toml -o calibrated.toml --report report.json");
  EXPECT_EQ(run.exit, 3);
  EXPECT_NE(run.err.find("robomill: not calibrated: "), std::string::npos) << run.err;
  EXPECT_NE(run.err.find("calibrated.toml is not written"), std::string::npos) << run.err;
  EXPECT_NE(run.out.find("Not calibrated"), std::string::npos) << run.out;
  EXPECT_FALSE(std::filesystem::exists(folder_.at("calibrated.toml")));
  const json report = json::parse(slurp(folder_.at("report.json")));
  EXPECT_NE(report["status"], "found");
  EXPECT_NE(report["reason"], "");
  EXPECT_GE(report["setting"]["roc"].size(), 2U);
  const Ended printed = robomill("calibrate recordings.toml -o -");
  EXPECT_EQ(printed.exit, 3);
  EXPECT_EQ(json::parse(printed.out)["status"], report["status"]);
}

// One message, exit code 1, and none of the files that were wanted.
TEST_F(CalibrateVerb, RejectsToCalibrateWithoutBothKinds) {
  Random random(42);
  std::vector<float> samples(10240);
  for (float& sample : samples) sample = static_cast<float>(random.normal());
  for (const char* name : {"rec0.wav", "rec1.wav", "rec2.wav"}) wav(name, samples);
  const auto rejected = [&](const std::vector<std::string>& labels, const std::string& part) {
    std::string text = "[signal]\nchannels = [1]\n";
    for (std::size_t i = 0; i < labels.size(); ++i) {
      text += "[[recordings]]\nfile = \"rec" + std::to_string(i) + ".wav\"\nlabel = \"" + labels[i] + "\"\n";
    }
    folder_.file("recordings.toml", text);
    const Ended run = robomill("calibrate recordings.toml -o out.toml --report report.json");
    EXPECT_EQ(run.exit, 1);
    EXPECT_EQ(run.out, "");
    EXPECT_NE(run.err.find(part), std::string::npos) << run.err;
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    EXPECT_FALSE(std::filesystem::exists(folder_.at("out.toml")));
    EXPECT_FALSE(std::filesystem::exists(folder_.at("report.json")));
  };
  rejected({"stable", "stable", "stable"}, "label = \"chatter\"");
  rejected({"chatter", "chatter", "chatter"}, "label = \"stable\"");
  rejected({"stable", "stable", "chatter"}, "label = \"chatter\"");  // one sets nothing and verifies nothing
  rejected({}, "recordings");
  rejected({"stable", "noisy"}, "noisy");
}

}  // namespace calibrate_test
}  // namespace robomill::app
