#include "robomill/jobs/calibrate.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/io/sample_source.hpp"
#include "testing/support.hpp"

namespace robomill::jobs {
namespace calibrate_test {

/// Noise that trebles where chatter begins.
std::vector<monitor::Recording> noise() {
  std::vector<monitor::Recording> out(8);
  Random random(3);
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i].chatter = i % 2 == 1;
    if (out[i].chatter) out[i].onset_s = 0.9766;
    for (std::size_t k = 0; k < 20'000; ++k) {
      out[i].samples.push_back(static_cast<float>((out[i].chatter && k > 10'000 ? 3.0 : 1.0) * random.normal()));
    }
  }
  return out;
}

// From files as from samples in memory, and what is written is read back from another folder.
TEST(RunCalibrate, IsTheCalibrationOfItsRecordings) {
  const test::Folder folder;
  const std::vector<monitor::Recording> recordings = noise();
  std::string text =
      "[signal]\nchannels = [1]\n[process]\nmodes = \"modes.json\"\n[calibration]\nfalse_alarm_rate = 0.1\n";
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    const std::string name = "rec" + std::to_string(i) + ".wav";
    io::write_wav(folder.at(name), recordings[i].samples, 1, 10240.0);
    text += "[[recordings]]\nfile = \"" + name + "\"\n" +
            (recordings[i].chatter ? "label = \"chatter\"\nonset_s = 0.9766\n" : "label = \"stable\"\n");
  }
  const CalibrateResult found = run_calibrate(folder.file("recordings.toml", text), 2);
  EXPECT_EQ(found.monitor.options.sample_rate_hz, 10240.0);
  const monitor::Calibration expected =
      monitor::calibrate(recordings, found.monitor.options, {.false_alarm_rate = 0.1, .seed = 2});
  EXPECT_EQ(found.calibration.options.threshold, expected.options.threshold);
  EXPECT_EQ(found.calibration.verifying.chosen.detection_rate, expected.verifying.chosen.detection_rate);
  EXPECT_EQ(found.calibration.alarms.size(), 8U);

  std::filesystem::create_directory(folder.at("machine"));
  const std::string toml = calibrated_toml(found, folder.at("machine/monitor.toml"));
  EXPECT_TRUE(toml.starts_with("# robomill calibrate recordings.toml: 8 recordings, half of them to verify.\n"))
      << toml;
  EXPECT_NE(toml.find("modes = \"../modes.json\""), std::string::npos) << toml;
  const monitor::MonitorFile back = monitor::read_monitor(folder.file("machine/monitor.toml", toml));
  EXPECT_NEAR(back.options.threshold, expected.options.threshold, 1e-12 * expected.options.threshold);
  EXPECT_EQ(back.options.alarm_below, expected.options.alarm_below);

  EXPECT_TRUE(found.monitor.notes.empty());
  const auto cut = folder.at("rec3.wav");
  std::filesystem::resize_file(cut, std::filesystem::file_size(cut) - 4000);
  const std::vector<std::string> notes = run_calibrate(folder.at("recordings.toml"), 2).monitor.notes;
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_NE(notes[0].find("rec3.wav"), std::string::npos) << notes[0];

  CalibrateResult failed = found;
  failed.calibration.status = monitor::Calibration::Status::not_verified;
  EXPECT_EQ(test::field_of([&] { static_cast<void>(calibrated_toml(failed, folder.at("monitor.toml"))); }),
            "calibration");
}

// Channels in files of their own calibrate as those of one file do.
TEST(RunCalibrate, TakesChannelsApart) {
  const test::Folder folder;
  const std::vector<monitor::Recording> recordings = noise();
  std::string together = "[signal]\nchannels = [1, 2]\n[calibration]\nfalse_alarm_rate = 0.1\n";
  std::string apart = "[signal]\nchannels = [\"ax\", \"ay\"]\n[calibration]\nfalse_alarm_rate = 0.1\n";
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    const std::vector<float>& x = recordings[i].samples;
    const std::vector<float> y(x.rbegin(), x.rend());
    std::vector<float> both;
    for (std::size_t k = 0; k < x.size(); ++k) {
      both.push_back(x[k]);
      both.push_back(y[k]);
    }
    const std::string n = std::to_string(i);
    io::write_wav(folder.at("x" + n + ".wav"), x, 1, 10240.0);
    io::write_wav(folder.at("y" + n + ".wav"), y, 1, 10240.0);
    io::write_wav(folder.at("xy" + n + ".wav"), both, 2, 10240.0);
    const std::string label =
        recordings[i].chatter ? "label = \"chatter\"\nonset_s = 0.9766\n" : "label = \"stable\"\n";
    together += "[[recordings]]\nfile = \"xy" + n + ".wav\"\n" + label;
    apart += "[[recordings]]\nfile = [\"x" + n + ".wav\", \"y" + n + ".wav\"]\n" + label;
  }
  const CalibrateResult of_one = run_calibrate(folder.file("together.toml", together), 2);
  const CalibrateResult of_two = run_calibrate(folder.file("apart.toml", apart), 2);
  EXPECT_EQ(of_two.calibration.options.threshold, of_one.calibration.options.threshold);
  EXPECT_EQ(of_two.calibration.verifying.chosen.detection_rate, of_one.calibration.verifying.chosen.detection_rate);
  EXPECT_EQ(of_two.monitor.notes.size(), 8U) << "nothing says that they begin together";
  EXPECT_NE(of_two.calibration.alarms.at(0).name.find("y0.wav"), std::string::npos);
}

}  // namespace calibrate_test
}  // namespace robomill::jobs
