// robomill monitor --learn as a user runs it.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/io/sample_source.hpp"
#include "test_program.hpp"

namespace robomill::app {
namespace learn_test {

class LearnVerb : public ProgramTest {
 protected:
  LearnVerb() {
    folder_.file("monitor.toml", text_ + "machine = \"machine.json\"\n");
    folder_.file("plain.toml", text_);
    wav("a.wav", 0.0);
    wav("bad.wav", 0.4);
  }
  void wav(const std::string& name, double chatter, double rate_hz = 8000.0) {
    Random random(2);
    std::vector<float> samples;
    for (int i = 0; i < static_cast<int>(4.0 * rate_hz); ++i) {
      const double t = i / rate_hz;
      double x = 0.002 * random.normal();
      for (const int k : {3, 6}) x += 0.1 * std::sin(2.0 * std::numbers::pi * 50.0 * k * t);
      if (t > 2.0) x += chatter * std::sin(2.0 * std::numbers::pi * 517.0 * t);
      samples.push_back(static_cast<float>(x));
    }
    io::write_wav(folder_.at(name), samples, 1, rate_hz);
  }
  std::string text_ = "[signal]\nchannels = [1]\n[process]\nspindle_speed_rpm = 3000\nteeth = 3\n";
};

TEST_F(LearnVerb, LearnsAMachineThatTheMonitorUses) {
  const Ended run = robomill("monitor monitor.toml --learn a.wav,a.wav -o machine.json");
  ASSERT_EQ(run.exit, 0) << run.err;
  EXPECT_NE(run.out.find("8000 Hz"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("3000 rpm"), std::string::npos) << run.out;
  EXPECT_EQ(nlohmann::json::parse(slurp(folder_.at("machine.json")))["document"], "machine/1");
  const Ended used = robomill("monitor monitor.toml --input bad.wav");
  EXPECT_EQ(used.exit, 0) << used.err;
  EXPECT_NE(used.out.find("1 alarm."), std::string::npos) << used.out;
  wav("slow.wav", 0.0, 7000.0);
  const Ended other = robomill("monitor monitor.toml --input slow.wav");
  EXPECT_EQ(other.exit, 1);
  EXPECT_NE(other.err.find("process.machine"), std::string::npos) << other.err;
}

TEST_F(LearnVerb, RejectsChatterAndWritesNothing) {
  const Ended run = robomill("monitor plain.toml --learn a.wav,bad.wav -o machine.json");
  EXPECT_EQ(run.exit, 1);
  EXPECT_NE(run.err.find("bad.wav"), std::string::npos) << run.err;
  EXPECT_NE(run.err.find("chatter"), std::string::npos) << run.err;
  EXPECT_FALSE(std::filesystem::exists(folder_.at("machine.json")));
  EXPECT_EQ(robomill("monitor plain.toml --learn a.wav --input a.wav -o machine.json").exit, 2);
  EXPECT_EQ(robomill("monitor plain.toml --learn a.wav -o machine.csv").exit, 1);
  EXPECT_EQ(robomill("monitor monitor.toml --input a.wav").exit, 1) << "machine.json is missing";
}

}  // namespace learn_test
}  // namespace robomill::app
