#include "robomill/jobs/learn.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "robomill/base/random.hpp"
#include "robomill/io/sample_source.hpp"
#include "testing/support.hpp"

namespace robomill::jobs {
namespace learn_test {

constexpr double rate_hz = 8000.0;

void write_recording(const std::filesystem::path& path, double chatter, double sample_rate_hz = rate_hz) {
  Random random(2);
  std::vector<float> samples;
  for (int i = 0; i < static_cast<int>(4.0 * sample_rate_hz); ++i) {
    const double t = i / sample_rate_hz;
    double x = 0.002 * random.normal() + 0.02 * std::sin(2.0 * std::numbers::pi * 733.0 * t);
    for (const int k : {3, 6}) x += 0.1 * std::sin(2.0 * std::numbers::pi * 50.0 * k * t);
    if (t > 2.0) x += chatter * std::sin(2.0 * std::numbers::pi * 517.0 * t);
    samples.push_back(static_cast<float>(x));
  }
  io::write_wav(path, samples, 1, sample_rate_hz);
}

class Learn : public ::testing::Test {
 protected:
  Learn() {
    folder_.file("monitor.toml",
                 "[signal]\nchannels = [1]\n[process]\nspindle_speed_rpm = 3000\nteeth = 3\nmachine = \"new.json\"\n");
    write_recording(folder_.at("a.wav"), 0.0);
    write_recording(folder_.at("b.wav"), 0.0);
    write_recording(folder_.at("bad.wav"), 0.4);
    write_recording(folder_.at("fast.wav"), 0.0, 9000.0);
  }
  LearnResult learn(const std::vector<std::string>& names) {
    std::vector<std::filesystem::path> files;
    for (const std::string& name : names) files.push_back(folder_.at(name));
    return run_learn(folder_.at("monitor.toml"), files);
  }
  test::Folder folder_;
};

TEST_F(Learn, ReadsRecordingsOneAfterTheOther) {
  const LearnResult one = learn({"a.wav"}), two = learn({"a.wav", "b.wav"});
  EXPECT_NEAR(one.machine.seconds, 3.7, 0.1);
  EXPECT_NEAR(two.machine.seconds, 2.0 * one.machine.seconds, 0.1);
  ASSERT_FALSE(one.machine.rows.empty());
  EXPECT_NEAR(one.machine.rows.front().rotation_hz, 50.0, 0.2);
}

TEST_F(Learn, NamesTheRecordingWithChatter) {
  const std::string error = test::rejection([&] { (void)learn({"a.wav", "bad.wav"}); });
  EXPECT_NE(error.find("bad.wav"), std::string::npos) << error;
  EXPECT_NE(error.find("an alarm at "), std::string::npos) << error;
}

TEST_F(Learn, RejectsWhatDoesNotGoTogether) {
  EXPECT_NE(test::rejection([&] { (void)learn({"a.wav", "fast.wav"}); }).find("fast.wav"), std::string::npos);
  EXPECT_NE(test::rejection([&] { (void)learn({}); }), "");
  EXPECT_NE(test::rejection([&] { (void)learn({"none.wav"}); }).find("none.wav"), std::string::npos);
}

}  // namespace learn_test
}  // namespace robomill::jobs
