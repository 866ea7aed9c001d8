#include "robomill/monitor/files/monitor_plan.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cstddef>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "robomill/base/units.hpp"
#include "robomill/io/sample_source.hpp"
#include "robomill/jobs/monitor.hpp"
#include "robomill/live/inputs.hpp"
#include "robomill/live/session.hpp"
#include "robomill/modal/files/modes_files.hpp"
#include "testing/monitor/signal.hpp"
#include "testing/support.hpp"

namespace robomill::jobs {
namespace monitor_plan_test {

using monitor::monitor_modes_name;
using monitor::MonitorPlan;
using monitor::plan_monitor;
using monitor::PlannedMonitor;
using robomill::test::field_of;

/// A tool that chatters at 905 Hz, its second mode. No multiple of 80 Hz leads from there to the first one.
modal::ModalModel modes() {
  return modal::modes_from_mass({{.frequency_hz = 1280.0, .damping_ratio = 0.01, .modal_mass_kg = 0.2}},
                                {{.frequency_hz = 905.0, .damping_ratio = 0.02, .modal_mass_kg = 0.2}});
}

MonitorPlan one_cut() {
  return {.speeds = {{.spindle_speed_rad_per_s = 4800.0 * units::rpm}}, .teeth = 3};
}

monitor::MonitorFile written(const MonitorPlan& plan, const test::Folder& folder) {
  const PlannedMonitor texts = plan_monitor(plan);
  if (!texts.modes_json.empty()) folder.file(monitor_modes_name, texts.modes_json);
  return monitor::read_monitor(folder.file("monitor.toml", texts.toml));
}

// A tap at 20 rpm turns more slowly than what counts as a standstill otherwise.
TEST(PlanMonitor, ASlowSpindleDoesNotStandStill) {
  for (const auto& [slowest_rpm, min_rpm] : {std::pair{1.0, 1.0}, std::pair{20.0, 10.0}, std::pair{400.0, 30.0}}) {
    for (const bool others : {false, true}) {
      const test::Folder folder;
      MonitorPlan plan = one_cut();
      plan.speeds = {{.spindle_speed_rad_per_s = slowest_rpm * units::rpm}};
      if (others) plan.speeds.push_back({.spindle_speed_rad_per_s = 4800.0 * units::rpm, .line = 7});
      EXPECT_NEAR(written(plan, folder).options.min_speed_rad_per_s, min_rpm * units::rpm, 1e-12) << slowest_rpm;
    }
  }
}

TEST(PlanMonitor, IsReadBackAsItWasMeant) {
  const test::Folder folder;
  MonitorPlan plan = one_cut();
  plan.modes_file = "modes.json";
  plan.lobes_file = "sub/lobes.toml";
  plan.sample_rate_hz = 25'600.0;
  plan.channels = {"ax_m_per_s2", "ay \"m\" per s2"};
  plan.false_alarms_per_hour = 0.01;
  const monitor::MonitorFile file = written(plan, folder);
  EXPECT_NEAR(file.options.spindle_speed_rad_per_s, 4800.0 * units::rpm, 1e-9);
  EXPECT_EQ(file.options.teeth, 3);
  EXPECT_EQ(file.options.kind, monitor::Kind::comb_cusum);
  EXPECT_EQ(file.options.false_alarms_per_hour, 0.01);
  EXPECT_EQ(file.options.sample_rate_hz, 25'600.0);
  EXPECT_EQ(file.columns.channels, plan.channels);
  EXPECT_EQ(file.modes, folder.at("modes.json"));
  EXPECT_EQ(file.lobes, folder.at("sub/lobes.toml"));
  EXPECT_FALSE(file.anti_alias_filter);
  EXPECT_EQ(file.act.rule, monitor::ActRule::none);
  EXPECT_TRUE(plan_monitor(plan).modes_json.empty());
  // What is not said is left to the defaults of the reader.
  const monitor::MonitorFile plain = written(one_cut(), folder);
  EXPECT_TRUE(plain.modes.empty());
  EXPECT_TRUE(plain.lobes.empty());
  EXPECT_EQ(plain.options.hop_s, monitor::MonitorOptions().hop_s);
}

TEST(PlanMonitor, WritesTheModesOfThePostureNearestToChatter) {
  const test::Folder folder;
  MonitorPlan plan = one_cut();
  plan.modes = modes();
  plan.modes_line = 120;
  const monitor::MonitorFile file = written(plan, folder);
  EXPECT_NE(plan_monitor(plan).toml.find("# The modes are those of the posture nearest to chatter, in line 120"),
            std::string::npos);
  const live::AdviceBasis basis = read_advice_basis(file, Progress::none());
  ASSERT_TRUE(basis.modes);
  ASSERT_EQ(basis.modes->modes.size(), plan.modes->modes.size());
  for (std::size_t i = 0; i < plan.modes->modes.size(); ++i) {
    EXPECT_NEAR(basis.modes->modes[i].frequency_hz, plan.modes->modes[i].frequency_hz, 1e-9);
    EXPECT_LT((basis.modes->modes[i].left - plan.modes->modes[i].left).norm(), 1e-12);
  }
  EXPECT_EQ(basis.teeth, 3);
}

TEST(PlanMonitor, LeavesSeveralSpeedsToTheStreamAndListsThem) {
  const test::Folder folder;
  MonitorPlan plan = one_cut();
  plan.speeds = {{.spindle_speed_rad_per_s = 4800.0 * units::rpm, .line = 3},
                 {.spindle_speed_rad_per_s = 4800.0 * units::rpm, .line = 9},
                 {.spindle_speed_rad_per_s = 6150.5 * units::rpm, .line = 14}};
  EXPECT_FALSE(plan.one_speed());
  const std::string text = plan_monitor(plan).toml;
  EXPECT_NE(text.find("#   from line 3: 4800 rpm\n#   from line 14: 6150.5 rpm\n[signal]"), std::string::npos) << text;
  EXPECT_EQ(text.find("\nspindle_speed_rpm"), std::string::npos) << text;
  EXPECT_EQ(written(plan, folder).options.spindle_speed_rad_per_s, 0.0);
  plan.speeds.pop_back();
  EXPECT_TRUE(plan.one_speed());
  EXPECT_NE(plan_monitor(plan).toml.find("\nspindle_speed_rpm = 4800\n"), std::string::npos);
  plan.speeds.clear();
  for (int i = 0; i < 1000; ++i) plan.speeds.push_back({.spindle_speed_rad_per_s = 300.0 + i, .line = i + 1});
  EXPECT_NE(plan_monitor(plan).toml.find("from line 200: "), std::string::npos);
  EXPECT_EQ(plan_monitor(plan).toml.find("from line 201: "), std::string::npos);
  EXPECT_NE(plan_monitor(plan).toml.find("#   and 800 changes more\n"), std::string::npos);
}

/// The recording as `robomill monitor` takes it, to its end.
std::vector<monitor::MonitorEvent> events_of(const monitor::MonitorFile& file, const std::filesystem::path& recording) {
  std::vector<monitor::MonitorEvent> out;
  const live::Advisor advisor(read_advice_basis(file, Progress::none()));
  live::SessionOutputs outputs;
  outputs.event = [&](const monitor::MonitorEvent& event, const std::string&) {
    out.push_back(event);
    return true;
  };
  outputs.advise = [&](monitor::MonitorEvent& event) { advisor.advise(event); };
  live::Session session(file, {}, std::move(outputs));
  {
    const live::SourceInput input(io::open_samples(recording, file.columns), file, session.queue(), session.notices(),
                                  session.metrics(), true);
    const std::atomic<bool> stop{false};
    session.run(stop);
  }
  return out;
}

/// The first alarm, none: time_s < 0.
monitor::MonitorEvent alarm_of(const std::vector<monitor::MonitorEvent>& events) {
  for (const monitor::MonitorEvent& event : events) {
    if (event.decision.state == monitor::State::chatter) return event;
  }
  return {.time_s = -1.0};
}

/// A cut at 4800 rpm that chatters at 905 Hz from the third second on, with the speed beside the samples or without.
std::filesystem::path recording(const test::Folder& folder, bool with_speed) {
  std::string text = with_speed ? "ax_m_per_s2,spindle_speed_rpm\n" : "ax_m_per_s2\n";
  for (const float x : monitor::testing::vibration({.chatter_hz = 905.0, .starts_s = 2.0})) {
    text += std::to_string(x) + (with_speed ? ",4800\n" : "\n");
  }
  return folder.file("cut.csv", text);
}

TEST(PlanMonitor, ASessionFindsTheChatterOfItsModes) {
  const test::Folder folder;
  MonitorPlan plan = one_cut();
  plan.modes = modes();
  const monitor::MonitorEvent alarm = alarm_of(events_of(written(plan, folder), recording(folder, false)));
  EXPECT_GT(alarm.time_s, 2.0);
  EXPECT_NEAR(alarm.decision.chatter_frequency_hz, 905.0, 5.0);
  EXPECT_NEAR(alarm.decision.spindle_speed_rad_per_s, 4800.0 * units::rpm, 0.5);
  EXPECT_EQ(alarm.mode, (modal::ModeId{.number = 2}));
}

// The column carries what the file leaves out.
TEST(PlanMonitor, ASessionTakesTheSpeedFromTheColumn) {
  const test::Folder folder;
  MonitorPlan plan = one_cut();
  plan.modes = modes();
  plan.speeds = {{.spindle_speed_rad_per_s = 4800.0 * units::rpm, .line = 1},
                 {.spindle_speed_rad_per_s = 6000.0 * units::rpm, .line = 50}};
  const monitor::MonitorEvent alarm = alarm_of(events_of(written(plan, folder), recording(folder, true)));
  EXPECT_GT(alarm.time_s, 2.0);
  EXPECT_NEAR(alarm.decision.chatter_frequency_hz, 905.0, 5.0);
  EXPECT_NEAR(alarm.decision.spindle_speed_rad_per_s, 4800.0 * units::rpm, 0.5);
}

TEST(PlanMonitor, RejectsWhatNoMonitorRunsWith) {
  const auto field = [](auto&& change) {
    MonitorPlan plan = one_cut();
    change(plan);
    return field_of([&] { static_cast<void>(plan_monitor(plan)); });
  };
  EXPECT_EQ(field([](MonitorPlan&) {}), "accepted");
  EXPECT_EQ(field([](MonitorPlan& plan) { plan.speeds.clear(); }), "speeds");
  EXPECT_EQ(field([](MonitorPlan& plan) { plan.speeds.push_back({}); }), "speeds[2].spindle_speed_rad_per_s");
  EXPECT_EQ(field([](MonitorPlan& plan) { plan.speeds[0].line = -1; }), "speeds[1].line");
  EXPECT_EQ(field([](MonitorPlan& plan) { plan.teeth = 0; }), "teeth");
  EXPECT_EQ(field([](MonitorPlan& plan) { plan.teeth = 65; }), "teeth");
  EXPECT_EQ(field([](MonitorPlan& plan) { plan.sample_rate_hz = 0.0; }), "sample_rate_hz");
  EXPECT_EQ(field([](MonitorPlan& plan) { plan.false_alarms_per_hour = 0.0; }), "false_alarms_per_hour");
  EXPECT_EQ(field([](MonitorPlan& plan) { plan.modes_line = -1; }), "modes_line");
  EXPECT_NE(field([](MonitorPlan& plan) { plan.channels.clear(); }), "accepted");
  EXPECT_EQ(field([](MonitorPlan& plan) {
              plan.modes = modes();
              plan.modes_file = "modes.json";
            }),
            "modes_file");
  EXPECT_EQ(field([](MonitorPlan& plan) {
              plan.modes = modes();
              plan.modes->modes[1].damping_ratio = -1.0;
            }),
            "modes[2].damping_ratio");
}

}  // namespace monitor_plan_test
}  // namespace robomill::jobs
