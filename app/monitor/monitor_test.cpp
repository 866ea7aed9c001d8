// robomill monitor as a user runs it on a recording.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include "monitor/test_monitor.hpp"
#include "robomill/io/records/mat.hpp"
#include "robomill/io/sample_source.hpp"

namespace robomill::app {
namespace monitor_test {

TEST_F(MonitorVerb, DetectsChatterInARecording) {
  wav("rec.wav", cut(8.0, true));
  const Ended run =
      robomill("monitor monitor.toml --input rec.wav -o events.jsonl --record alarms --report report.json");
  ASSERT_EQ(run.exit, 0) << run.err;
  const json alarm = first_alarm();
  ASSERT_FALSE(alarm.is_null()) << run.out;
  EXPECT_GT(alarm["time_s"].get<double>(), onset_s);
  EXPECT_LT(alarm["time_s"].get<double>(), onset_s + 0.5);
  EXPECT_NEAR(alarm["chatter_frequency_hz"].get<double>(), chatter_hz, 2.0);
  EXPECT_NE(run.out.find("chatter at 68"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("320 decisions, 1 alarm."), std::string::npos) << run.out;
  // The seconds before the alarm, as they were.
  ASSERT_EQ(events_of("recording").size(), 1U);
  const auto recorded =
      io::open_samples(folder_.path() / events_of("recording")[0]["file"].get<std::string>(), {.channels = {"1"}});
  io::SampleBlock block;
  ASSERT_TRUE(recorded->next(100'000, block));
  EXPECT_NEAR(static_cast<double>(block.samples.size()) / rate_hz, alarm["time_s"].get<double>(), 0.026);
  EXPECT_EQ(block.samples[1000], cut(1.0, false)[1000]);
  const json report = json::parse(slurp(folder_.at("report.json")));
  EXPECT_EQ(report["monitor"]["decision_count"], 320);
  EXPECT_EQ(report["monitor"]["events"].size(), events().size());
  EXPECT_FALSE(report["monitor"]["spectrogram"].is_null());
}

// Channels in files of their own, of a format that is held whole; others would no longer take the same memory at any
// length.
TEST_F(MonitorVerb, JoinsChannelsThatAreApart) {
  const std::vector<float> samples = cut(6.0, true);
  const auto put = [&](const char* name, double factor) {
    Eigen::VectorXd values(static_cast<Eigen::Index>(samples.size()));
    for (Eigen::Index i = 0; i < values.size(); ++i) values(i) = factor * samples[static_cast<std::size_t>(i)];
    io::write_mat(folder_.at(std::string(name) + ".mat"),
                  {{.name = name, .re = values}, {.name = "fs", .re = Eigen::MatrixXd::Constant(1, 1, rate_hz)}});
  };
  put("ax", 1.0);
  put("ay", 0.5);
  folder_.file("two.toml", "[signal]\nchannels = [\"ax\", \"ay\"]\n[process]\nspindle_speed_rpm = 3000\nteeth = 2\n");
  const Ended run = robomill("monitor two.toml --input ax.mat --input ay.mat -o events.jsonl");
  ASSERT_EQ(run.exit, 0) << run.err;
  EXPECT_NE(run.out.find("ax.mat + ay.mat processed"), std::string::npos) << run.out;
  ASSERT_FALSE(first_alarm().is_null()) << run.out;
  EXPECT_NEAR(first_alarm()["chatter_frequency_hz"].get<double>(), chatter_hz, 2.0);
  wav("x.wav", cut(0.5, false));
  const auto says = [&](const std::string& options, const std::string& part) {
    const Ended rejected = robomill("monitor two.toml --input ax.mat " + options);
    EXPECT_EQ(rejected.exit, 1) << options;
    EXPECT_NE(rejected.err.find(part), std::string::npos) << rejected.err;
  };
  says("--input x.wav", "x.wav: is read block by block, and joined with another file it would have to be held whole");
  says("--input -", "- is a stream, and stands beside others");
  says("--input mqtt://host/topic", "is a stream, and stands beside others");
  says("--input ay.mat --format f32", "--format: is of one input");
  says("--input notes.pdf", "notes.pdf");
}

// 683 Hz at 3000 rpm with two teeth: tooth passing 100 Hz, so k = 7 gives 60 * 683 / (2 * 7) rpm; mode 2 stands there.
TEST_F(MonitorVerb, NamesTheModeAndABetterSpeed) {
  wav("rec.wav", cut(6.0, true));
  folder_.file("modes.toml",
               "[[modes]]\nfrequency_hz = 300\ndamping_ratio = 0.02\nleft = { x = [1, 0] }\nright = { x = [1, 0] }\n"
               "[[modes]]\nfrequency_hz = 682\ndamping_ratio = 0.01\nleft = { x = [1, 0] }\nright = { x = [1, 0] }\n");
  folder_.file("moded.toml", config_ + "modes = \"modes.toml\"\n");
  ASSERT_EQ(robomill("monitor moded.toml --input rec.wav -o events.jsonl").exit, 0);
  const json alarm = first_alarm();
  ASSERT_FALSE(alarm.is_null());
  EXPECT_EQ(alarm["mode"], 2);
  EXPECT_NEAR(alarm["suggested_spindle_speed_rpm"].get<double>(), 60.0 * chatter_hz / 14.0, 15.0);
  EXPECT_GE(alarm["stable_spindle_speeds_rpm"].size(), 2U);
  folder_.file("toothless.toml", "[signal]\nchannels = [1]\n[process]\nmodes = \"modes.toml\"\n");
  EXPECT_NE(robomill("monitor toothless.toml --input rec.wav").err.find("process.teeth"), std::string::npos);
}

// The chart that robomill lobes writes of the same file: its deepest limit over a window of 2 % of speed, of which a
// fifth is kept as a margin. Of a cut without a feed no more is known; with one forced vibration limits the depth.
TEST_F(MonitorVerb, AdvisesTheBestSpeedAndDepthOfTheLobes) {
  wav("rec.wav", cut(6.0, true));
  const std::string tool = "[tool]\nteeth = 2\ndiameter_mm = 12\n[cut]\ndirection = \"up\"\nradial_depth_mm = 1.8\n";
  const std::string rest =
      "[coefficients]\ntangential_n_per_mm2 = 712\nradial_n_per_mm2 = 287\n"
      "[dynamics]\nx = [{ frequency_hz = 682, damping_ratio = 0.02, modal_mass_kg = 0.02 }]\n"
      "y = [{ frequency_hz = 682, damping_ratio = 0.02, modal_mass_kg = 0.02 }]\n"
      "[lobes]\nspindle_speed_rpm = [6600, 7500]\naxial_depth_mm = [0, 3]\n"
      "grid = [20, 10]\n";
  folder_.file("lobes.toml", tool + rest);
  const Ended chart = robomill("lobes lobes.toml -o -");
  ASSERT_EQ(chart.exit, 0) << chart.err;
  const json lobes = json::parse(chart.out);
  std::vector<double> rpm, mm;
  for (const json& limit : lobes["limit"]) {
    ASSERT_FALSE(limit["axial_depth_mm"].is_null());
    rpm.push_back(limit["spindle_speed_rpm"].get<double>());
    mm.push_back(limit["axial_depth_mm"].get<double>());
  }
  // The limit at any speed, on the line between those of the chart.
  const auto limit_at = [&](double speed_rpm) {
    for (std::size_t i = 1; i < rpm.size(); ++i) {
      if (speed_rpm <= rpm[i]) {
        return std::lerp(mm[i - 1], mm[i], std::max(0.0, (speed_rpm - rpm[i - 1]) / (rpm[i] - rpm[i - 1])));
      }
    }
    return mm.back();
  };
  double best_rpm = 0.0, best_mm = 0.0, least_mm = 1e9;
  for (const double speed_rpm : rpm) {
    double depth_mm = limit_at(speed_rpm);
    for (int k = -20; k <= 20; ++k) depth_mm = std::min(depth_mm, limit_at(speed_rpm * (1.0 + 1e-3 * k)));
    for (std::size_t i = 0; i < rpm.size(); ++i) {
      if (std::abs(rpm[i] / speed_rpm - 1.0) <= 0.02) depth_mm = std::min(depth_mm, mm[i]);
    }
    least_mm = std::min(least_mm, depth_mm);
    if (depth_mm <= best_mm) continue;
    best_mm = depth_mm;
    best_rpm = speed_rpm;
  }
  ASSERT_GT(best_mm, 1.2 * least_mm);  // otherwise any speed would do, or else the first or the last
  ASSERT_NE(best_rpm, lobes["limit"].front()["spindle_speed_rpm"].get<double>());
  ASSERT_NE(best_rpm, lobes["limit"].back()["spindle_speed_rpm"].get<double>());
  folder_.file("lobed.toml", config_ + "lobes = \"lobes.toml\"\n");
  const Ended run = robomill("monitor lobed.toml --input rec.wav -o events.jsonl");
  ASSERT_EQ(run.exit, 0) << run.err;
  const json alarm = first_alarm();
  ASSERT_FALSE(alarm.is_null());
  EXPECT_NEAR(alarm["suggested_spindle_speed_rpm"].get<double>(), best_rpm, 1e-6 * best_rpm);
  EXPECT_NEAR(alarm["suggested_axial_depth_mm"].get<double>(), 0.8 * best_mm, 1e-6 * best_mm);
  EXPECT_EQ(alarm["depth_limited_by"], "stability");
  folder_.file("lobes.toml", tool + "feed_per_tooth_mm = 0.01\n" + rest);
  const Ended fed = robomill("monitor lobed.toml --input rec.wav -o events.jsonl");
  ASSERT_EQ(fed.exit, 0) << fed.err;
  EXPECT_NE(fed.out.find("mm (limited by forced vibration)"), std::string::npos) << fed.out;
  const json vibrates = first_alarm();
  EXPECT_EQ(vibrates["depth_limited_by"], "forced-vibration");
  EXPECT_LT(vibrates["suggested_axial_depth_mm"].get<double>(),
            0.8 * limit_at(vibrates["suggested_spindle_speed_rpm"].get<double>()));
  // Of the milling robot's modes it is one of the arm that shows up there, 7 tooth passings less 17.4 Hz: for it there
  // is no better speed.
  folder_.file("armed.toml", config_ + "modes = \"" ROBOMILL_SOURCE_DIR "/data/robot-modes.toml\"\n");
  ASSERT_EQ(robomill("monitor armed.toml --input rec.wav -o events.jsonl").exit, 0);
  for (const json& event : events_of("state")) {
    EXPECT_TRUE(event["suggested_spindle_speed_rpm"].is_null());
    if (event["state"] != "chatter") continue;
    EXPECT_TRUE(event["no_speed"] == "arm" || event["no_speed"] == "unclear") << event;
  }
  folder_.file("unlobed.toml", config_ + "lobes = \"none.toml\"\n");
  const Ended rejected = robomill("monitor unlobed.toml --input rec.wav -o unlobed.jsonl");
  EXPECT_EQ(rejected.exit, 1);
  EXPECT_NE(rejected.err.find("none.toml"), std::string::npos) << rejected.err;
  EXPECT_FALSE(std::filesystem::exists(folder_.at("unlobed.jsonl")));
}

TEST_F(MonitorVerb, SaysNothingButThatItHasLearntWhereNothingHappens) {
  wav("rec.wav", cut(5.0, false));
  const Ended run = robomill("monitor monitor.toml --input rec.wav -o events.jsonl");
  ASSERT_EQ(run.exit, 0) << run.err;
  const std::vector<json> states = events_of("state");
  ASSERT_EQ(states.size(), 2U);
  EXPECT_EQ(events().size(), 2U);
  EXPECT_EQ(states[0]["reason"], "learning");
  EXPECT_EQ(states[1]["state"], "stable");
  EXPECT_LE(states[1]["time_s"].get<double>(), 3.0);
  EXPECT_NE(run.out.find("0 alarms.\ncannot tell: learning, for "), std::string::npos) << run.out;
  EXPECT_EQ(robomill("monitor monitor.toml --input rec.wav --quiet").out, "");
}

TEST_F(MonitorVerb, ReportsEveryWindow) {
  wav("rec.wav", cut(2.0, false));
  const Ended run = robomill("monitor monitor.toml --input rec.wav --every-window -o -");
  ASSERT_EQ(run.exit, 0) << run.err;
  EXPECT_EQ(std::count(run.out.begin(), run.out.end(), '\n'), 80);
  std::istringstream lines(run.out);
  double before_s = 0.0;
  for (std::string line; std::getline(lines, line);) {
    const json event = json::parse(line);
    for (const char* key : {"time_s", "state", "score", "threshold", "energy_entropy", "chatter_frequency_hz", "mode",
                            "suggested_spindle_speed_rpm", "compute_us"}) {
      EXPECT_TRUE(event.contains(key)) << key;
    }
    EXPECT_NEAR(event["time_s"].get<double>() - before_s, 0.025, 1.5e-4);
    before_s = event["time_s"].get<double>();
  }
}

TEST_F(MonitorVerb, ExplainsItsDecisions) {
  wav("rec.wav", cut(6.0, true));
  const Ended run = robomill("monitor monitor.toml --input rec.wav --why -o events.jsonl --report report.json");
  ASSERT_EQ(run.exit, 0) << run.err;
  const std::vector<json> states = events_of("state");
  ASSERT_GE(states.size(), 2U);
  for (const json& event : states) ASSERT_TRUE(event.contains("why")) << event;
  const json why = first_alarm()["why"];
  EXPECT_GE(why["hops"].get<int>(), why["of"].get<int>());
  ASSERT_FALSE(why["conditions"].empty());
  for (const json& condition : why["conditions"]) {
    EXPECT_EQ(condition["holds"], true) << why;
    EXPECT_NE(condition.contains("at_least"), condition.contains("at_most")) << why;
  }
  const std::string by = "chatter by " + why["test"].get<std::string>() + " (";
  EXPECT_NE(run.out.find(by), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("no alarm; closest is "), std::string::npos) << run.out;
  const json alarm = json::parse(slurp(folder_.at("report.json")))["monitor"]["alarms"].at(0);
  EXPECT_EQ(alarm["why"], why);
  const Ended each = robomill("monitor monitor.toml --input rec.wav --why --every-window --seconds 1 -o -");
  ASSERT_EQ(each.exit, 0) << each.err;
  std::istringstream lines(each.out);
  for (std::string line; std::getline(lines, line);) EXPECT_TRUE(json::parse(line).contains("why")) << line;
  const Ended plain = robomill("monitor monitor.toml --input rec.wav --every-window -o -");
  EXPECT_EQ(plain.out.find("\"why\""), std::string::npos);
}

// The same samples by each way in: the same events but for the time that they took.
TEST_F(MonitorVerb, GivesTheSameEventsForEveryInput) {
  const std::vector<float> samples = cut(6.0, true);
  wav("rec.wav", samples);
  folder_.file("rec.raw", {reinterpret_cast<const char*>(samples.data()), 4 * samples.size()});
  std::string csv = "time_s,ax_m_per_s2\n", bare;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    std::array<char, 64> text = {};
    std::snprintf(text.data(), text.size(), "%.9g", static_cast<double>(samples[i]));
    csv += std::to_string(static_cast<double>(i) / rate_hz) + "," + text.data() + "\n";
    bare += std::string(text.data()) + "\n";
  }
  folder_.file("rec.csv", csv);
  folder_.file("bare.csv", bare);
  const auto events_from = [&](const std::string& input) {
    const Ended run = robomill("monitor monitor.toml --every-window -o - " + input);
    EXPECT_EQ(run.exit, 0) << run.err;
    std::string out;
    std::istringstream lines(run.out);
    for (std::string line; std::getline(lines, line);) {
      json event = json::parse(line);
      event.erase("compute_us");
      out += event.dump() + "\n";
    }
    return out;
  };
  const std::string wanted = events_from("--input rec.wav");
  EXPECT_EQ(std::count(wanted.begin(), wanted.end(), '\n'), 240);
  EXPECT_EQ(events_from("--input rec.csv"), wanted);
  EXPECT_EQ(events_from("--input bare.csv"), wanted);
  EXPECT_EQ(events_from("--input - <rec.raw"), wanted);
  EXPECT_EQ(events_from("--input - --format f32 <rec.raw"), wanted);
  EXPECT_EQ(events_from("--input rec.raw --format f32"), wanted);
  const Ended piped = shell("cat rec.csv | '" ROBOMILL_PROGRAM "' monitor monitor.toml --input - -o events.jsonl");
  EXPECT_EQ(piped.exit, 0) << piped.err;
  EXPECT_FALSE(events_of("state").empty());
}

TEST_F(MonitorVerb, LivesThroughBadSamples) {
  std::vector<float> samples = cut(4.0, false);
  for (std::size_t i = 20'000; i < 21'000; ++i) samples[i] = std::numeric_limits<float>::quiet_NaN();
  wav("rec.wav", samples);
  const Ended run = robomill("monitor monitor.toml --input rec.wav -o events.jsonl --report report.html");
  ASSERT_EQ(run.exit, 0);
  // 1,000 samples are four hops that are mostly lost; eleven more are left out.
  EXPECT_NE(run.out.find("cannot tell: gap, for 0.375 s\n"), std::string::npos) << run.out;
  const std::string page = slurp(folder_.at("report.html"));
  EXPECT_NE(page.find("Cannot tell: gap, for 0."), std::string::npos);
  EXPECT_EQ(page.find("cannot tell: gap"), std::string::npos);  // once is enough
  const std::vector<json> faults = events_of("fault");
  ASSERT_FALSE(faults.empty());
  EXPECT_EQ(faults.front()["faults"][0], "not-finite");
  const std::vector<json> states = events_of("state");
  const auto gap = std::ranges::find_if(states, [](const json& event) { return event["reason"] == "gap"; });
  ASSERT_LT(gap + 1, states.end());
  EXPECT_NE(gap[1]["reason"], "gap");
  EXPECT_NE(states.back()["state"], "blind");
  EXPECT_NEAR(faults.front()["time_s"].get<double>(), 20'000 / rate_hz, 0.03);
  folder_.file(
      "rec.csv", "ax_m_per_s2\n" + [] {
        std::string rows;
        for (int i = 0; i < 3000; ++i) rows += i % 100 == 50 ? "what\n" : std::to_string(i % 7) + "\n";
        return rows;
      }());
  ASSERT_EQ(robomill("monitor monitor.toml --input rec.csv -o events.jsonl").exit, 0);
  std::uint64_t rows = 0;
  for (const json& event : events_of("unreadable-rows")) rows += event["count"].get<std::uint64_t>();
  EXPECT_EQ(rows, 30U);
}

TEST_F(MonitorVerb, RejectsBadInputWithOneMessage) {
  wav("rec.wav", cut(0.5, false));
  const auto rejected = [&](const std::string& arguments, const char* part) {
    const Ended run = robomill("monitor " + arguments);
    EXPECT_EQ(run.exit, 1) << arguments;
    EXPECT_NE(run.err.find(part), std::string::npos) << run.err;
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
  };
  EXPECT_EQ(robomill("monitor").exit, 2);
  EXPECT_EQ(robomill("monitor monitor.toml --input rec.wav --format magic").exit, 2);
  rejected("monitor.toml", "--input");
  rejected("none.toml --input rec.wav", "none.toml");
  rejected("monitor.toml --input none.wav", "none.wav");
  rejected("monitor.toml --input rec.wav -o no/such/folder.jsonl", "cannot be written");
  rejected("monitor.toml --input rec.wav --every-window -o - >/dev/full", "could not be written");
  rejected("monitor.toml --input rec.wav --report r.pdf", "r.pdf");
  rejected("monitor.toml --input mqtt://127.0.0.1", "names no topic");
  folder_.file("five.toml", "[signal]\nsample_rate_hz = 5000\nchannels = [1]\n");
  rejected("five.toml --input rec.wav -o five.jsonl", "was sampled at 10240 Hz");
  EXPECT_FALSE(std::filesystem::exists(folder_.at("five.jsonl")));
  folder_.file("two.toml", "[signal]\nchannels = [1, 2]\n");
  rejected("two.toml --input rec.wav", "has no column 2");
  rejected("two.toml --input mqtt://127.0.0.1/t", "must be given for a stream");
  folder_.file("x.csv", "ay\n1\n");
  rejected("monitor.toml --input x.csv", "has no column ax_m_per_s2. It has 1 column: ay");
}

TEST_F(MonitorVerb, ShowsALine) {
  wav("rec.wav", cut(3.0, false));
  const Ended run = robomill("monitor monitor.toml --input rec.wav --watch");
  ASSERT_EQ(run.exit, 0);
  EXPECT_GE(std::count(run.err.begin(), run.err.end(), '\n'), 3);
  EXPECT_NE(run.err.find("stable"), std::string::npos);
}

}  // namespace monitor_test
}  // namespace robomill::app
