#include "robomill/live/act.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "robomill/live/advisor.hpp"
#include "robomill/live/files/command_json.hpp"
#include "robomill/monitor/files/monitor_events.hpp"
#include "testing/robot_modes.hpp"
#include "testing/support.hpp"

namespace robomill::live {
namespace act_test {

using Kind = Command::Kind;
using monitor::ActRule;
using monitor::ActSettings;
using monitor::MonitorEvent;
using monitor::NoSpeed;
using monitor::State;

constexpr double rpm = std::numbers::pi / 30.0, hop_s = 0.025;

/// Decisions a hop, as a session gives them to an actor; what it advises is set here.
class Course {
 public:
  explicit Course(const ActSettings& settings, double given_rpm = 0.0) : actor_(settings, given_rpm * rpm) {}

  /// For so long in this state; the commands that followed.
  std::vector<Command> stay(State state, double seconds) {
    std::vector<Command> out;
    for (int hops = static_cast<int>(std::lround(seconds / hop_s)); hops > 0; --hops) {
      if (const std::optional<Command> command = step(state)) out.push_back(*command);
    }
    return out;
  }
  std::optional<Command> step(State state) {
    time_s += hop_s;
    monitor::Decision d;
    d.time_s = time_s;
    d.state = state;
    d.changed = state != last_;
    d.spindle_speed_rad_per_s = speed_rpm * rpm;
    if (state == State::chatter) d.chatter_frequency_hz = frequency_hz;
    last_ = state;
    const bool due = actor_.observe(d, time_s);
    if (!due && !d.changed) return std::nullopt;
    event = {};
    event.time_s = time_s;
    event.decision = d;
    if (state == State::chatter && !actor_.settling()) {
      event.no_speed = no_speed;
      if (no_speed == NoSpeed::ambiguous_alias) event.line_hz = {661.0, 989.0};
      for (const double each : suggested_rpm) event.stable_speeds_rad_per_s.push_back(each * rpm);
      if (!suggested_rpm.empty()) event.suggested_spindle_speed_rad_per_s = suggested_rpm.front() * rpm;
    }
    const std::optional<Command> command = actor_.act(event);
    EXPECT_EQ(event.command, command ? name_in(command_names, command->kind) : "");
    return command;
  }

  double time_s = 0.0, speed_rpm = 6000.0, frequency_hz = 545.0;
  std::vector<double> suggested_rpm = {};
  NoSpeed no_speed = NoSpeed::none;
  MonitorEvent event;

 private:
  Actor actor_;
  State last_ = State::stable;
};

ActSettings rule(ActRule which) {
  ActSettings settings{.rule = which, .settle_s = 1.0, .calm_s = 0.5};
  if (which == ActRule::hold) settings.retract_m = 2e-3;
  return settings;
}

TEST(Act, WhatFollowsChatter) {
  struct Row {
    ActRule rule;
    std::vector<double> suggested_rpm;
    NoSpeed no_speed;
    double frequency_hz;
    Kind command;
    double speed_rpm, feed_override, retract_m;
    const char* reason;
  };
  for (const Row& row : std::vector<Row>{
           {ActRule::reduce, {5400}, NoSpeed::none, 545, Kind::feed, 0, 0.5, 0, "50 %"},
           {ActRule::reduce, {}, NoSpeed::arm, 20, Kind::feed, 0, 0.5, 0, "50 %"},
           {ActRule::hold, {5400}, NoSpeed::none, 545, Kind::hold, 0, 1.0, 2e-3, "2 mm out of the cut"},
           {ActRule::speed, {5400, 3600}, NoSpeed::none, 545, Kind::spindle_speed, 5400, 0.9, 0, "545.0 Hz"},
           // Neither the present speed, one above it, nor one below half of it, unless the settings allow it.
           {ActRule::speed, {6030, 9000, 2900, 4500}, NoSpeed::none, 545, Kind::spindle_speed, 4500, 0.75, 0, ""},
           {ActRule::speed, {6030, 9000, 2900}, NoSpeed::none, 545, Kind::none, 0, 1.0, 0, "allowed range"},
           {ActRule::speed, {}, NoSpeed::arm, 20, Kind::none, 0, 1.0, 0, "mode of the arm"},
           {ActRule::speed, {}, NoSpeed::unclear, 545, Kind::none, 0, 1.0, 0, "not clear"},
           {ActRule::speed, {}, NoSpeed::mode_coupling, 545, Kind::none, 0, 1.0, 0, "couple"},
           {ActRule::speed, {}, NoSpeed::ambiguous_alias, 661, Kind::none, 0, 1.0, 0, "may be 661.0 or 989.0 Hz"},
           {ActRule::speed, {}, NoSpeed::none, 0, Kind::none, 0, 1.0, 0, "frequency of chatter is not known"},
           {ActRule::speed, {}, NoSpeed::none, 545, Kind::none, 0, 1.0, 0, "number of teeth"}}) {
    Course course(rule(row.rule));
    course.suggested_rpm = row.suggested_rpm;
    course.no_speed = row.no_speed;
    course.frequency_hz = row.frequency_hz;
    EXPECT_TRUE(course.stay(State::stable, 1.0).empty());
    EXPECT_TRUE(course.stay(State::transition, 0.1).empty());
    const double begun_s = course.time_s;
    const std::vector<Command> commands = course.stay(State::chatter, 0.9);
    ASSERT_EQ(commands.size(), 1U) << row.reason;  // once, however long it chatters
    const Command& c = commands.front();
    EXPECT_EQ(c.kind, row.command) << row.reason;
    EXPECT_NEAR(c.spindle_speed_rad_per_s, row.speed_rpm * rpm, 1e-9);
    EXPECT_NEAR(c.feed_override, row.feed_override, 1e-12);
    EXPECT_EQ(c.retract_m, row.retract_m);
    EXPECT_NE(c.reason.find(row.reason), std::string::npos) << c.reason;
    EXPECT_FALSE(c.not_claimed.empty());
    // At the first decision; that nothing can be done only when chatter's frequency had time to become known.
    EXPECT_NEAR(c.time_s - begun_s, row.command == Kind::none ? 0.5 + hop_s : hop_s, 1e-9) << row.reason;
  }
  Course none(rule(ActRule::none));
  none.suggested_rpm = {5400};
  EXPECT_TRUE(none.stay(State::chatter, 5.0).empty());
}

// Feed per tooth is that of the program at every speed: override · programmed speed = speed.
TEST(Act, TriesEachSuggestedSpeedOnce) {
  ActSettings settings = rule(ActRule::speed);
  settings.lowest_rad_per_s = 2000.0 * rpm;
  settings.highest_rad_per_s = 10'000.0 * rpm;
  Course course(settings);
  course.suggested_rpm = {8000, 5400, 9500, 3600};  // 9,500 rpm needs more feed than an interpolator gives
  double programmed_rpm = 6000.0;
  for (const double wanted_rpm : {8000.0, 5400.0, 3600.0}) {
    const std::vector<Command> commands = course.stay(State::chatter, 0.1);
    ASSERT_EQ(commands.size(), 1U);
    EXPECT_NEAR(commands[0].spindle_speed_rad_per_s, wanted_rpm * rpm, 1e-9);
    EXPECT_NEAR(commands[0].feed_override * programmed_rpm, wanted_rpm, 1e-9);
    EXPECT_EQ(commands[0].feed_first, wanted_rpm < course.speed_rpm);
    course.speed_rpm = wanted_rpm;
    EXPECT_TRUE(course.stay(State::chatter, 0.9 - hop_s).empty());
  }
}

TEST(Act, SaysWhenNoSpeedIsLeft) {
  Course course(rule(ActRule::speed));
  course.suggested_rpm = {5400, 4500};
  std::vector<Command> commands;
  for (int i = 0; i < 10; ++i) {
    for (const Command& c : course.stay(State::chatter, 1.0)) {
      commands.push_back(c);
      if (c.kind == Kind::spindle_speed) course.speed_rpm = c.spindle_speed_rad_per_s / rpm;
    }
  }
  ASSERT_EQ(commands.size(), 3U);
  EXPECT_EQ(commands[2].kind, Kind::none);
  EXPECT_NE(commands[2].reason.find("2 changes of speed"), std::string::npos) << commands[2].reason;
  EXPECT_NEAR(commands[2].feed_override, 0.75, 1e-12);  // what was commanded stays
}

// Suggestions that move with the measured frequency are no new ones for ever.
TEST(Act, ChangesSpeedNoMoreOftenThanSpeedsWereSuggested) {
  Course course(rule(ActRule::speed));
  course.suggested_rpm = {5400, 4500};
  std::size_t changes = 0;
  for (int i = 0; i < 400; ++i) {
    for (const Command& c : course.stay(State::chatter, 0.1)) {
      if (c.kind != Kind::spindle_speed) continue;
      ++changes;
      for (double& each : course.suggested_rpm) each -= 150.0;
    }
  }
  EXPECT_EQ(changes, 2U);
}

// A new alarm counts from its own suggestions, and the feed from the speed of the program.
TEST(Act, AnAlarmEndsWithCalm) {
  Course course(rule(ActRule::speed));
  course.suggested_rpm = {5400};
  ASSERT_EQ(course.stay(State::chatter, 0.1).size(), 1U);
  course.speed_rpm = 5400;
  EXPECT_TRUE(course.stay(State::stable, 0.4).empty());  // shorter than calm_s: the same alarm
  EXPECT_TRUE(course.stay(State::chatter, 0.1).empty());
  EXPECT_TRUE(course.stay(State::stable, 2.0).empty());
  course.suggested_rpm = {3600};
  const std::vector<Command> next = course.stay(State::chatter, 0.1);
  ASSERT_EQ(next.size(), 1U);
  EXPECT_NEAR(next[0].feed_override, 0.6, 1e-12);
}

TEST(Act, RestoresAReducedFeedAfterCalm) {
  ActSettings settings = rule(ActRule::reduce);
  settings.reduce_to = 0.3;
  Course course(settings);
  ASSERT_EQ(course.stay(State::chatter, 3.0).size(), 1U);
  EXPECT_TRUE(course.stay(State::transition, 3.0).empty());
  EXPECT_TRUE(course.stay(State::stable, 0.4).empty());
  EXPECT_TRUE(course.stay(State::transition, 0.1).empty());  // calm counts anew
  EXPECT_TRUE(course.stay(State::stable, 0.5).empty());
  const std::vector<Command> restored = course.stay(State::stable, 0.1);
  ASSERT_EQ(restored.size(), 1U);
  EXPECT_EQ(restored[0].kind, Kind::release);
  EXPECT_EQ(restored[0].feed_override, 1.0);
  EXPECT_TRUE(course.stay(State::stable, 3.0).empty());
  EXPECT_EQ(course.stay(State::chatter, 0.1).size(), 1U);
}

// People resume: whoever finds chatter again stops again.
TEST(Act, HoldsWheneverChatterBegins) {
  Course course(rule(ActRule::hold));
  EXPECT_EQ(course.stay(State::chatter, 0.5).size(), 1U);
  EXPECT_TRUE(course.stay(State::stable, 0.2).empty());
  EXPECT_EQ(course.stay(State::chatter, 0.5).size(), 1U);
  EXPECT_TRUE(course.stay(State::stable, 5.0).empty());  // a hold is not released
  EXPECT_EQ(course.stay(State::chatter, 0.5).size(), 1U);
}

TEST(Act, ABlindMonitorLeavesWhatWasCommanded) {
  Course reduced(rule(ActRule::reduce));
  ASSERT_EQ(reduced.stay(State::chatter, 0.1).size(), 1U);
  EXPECT_TRUE(reduced.stay(State::stable, 0.3).empty());
  EXPECT_FALSE(reduced.step(State::blind));
  EXPECT_NE(reduced.event.message.find("a feed override of 50.0 % stays"), std::string::npos) << reduced.event.message;
  EXPECT_TRUE(reduced.stay(State::blind, 100.0).empty());  // which is no calm
  EXPECT_TRUE(reduced.stay(State::stable, 0.2).empty());
  EXPECT_EQ(reduced.stay(State::stable, 0.1).size(), 1U);

  Course changed(rule(ActRule::speed));
  changed.suggested_rpm = {5400, 4500};
  ASSERT_EQ(changed.stay(State::chatter, 0.1).size(), 1U);
  EXPECT_FALSE(changed.step(State::blind));
  EXPECT_NE(changed.event.message.find("5400 rpm and a feed override of 90.0 % stay"), std::string::npos);
  EXPECT_TRUE(changed.stay(State::blind, 100.0).empty());  // nor does a spindle settle
  EXPECT_TRUE(changed.stay(State::chatter, 0.8).empty());
  EXPECT_EQ(changed.stay(State::chatter, 0.2).size(), 1U);

  Course untouched(rule(ActRule::hold));
  EXPECT_FALSE(untouched.step(State::blind));
  EXPECT_EQ(untouched.event.message, "blind: nothing is commanded");
}

// Where the detector knows no speed, the given one counts; without either nothing is commanded.
TEST(Act, NeedsASpindleSpeed) {
  Course given(rule(ActRule::speed), 6000.0);
  given.speed_rpm = 0.0;
  given.suggested_rpm = {5400};
  const std::vector<Command> commands = given.stay(State::chatter, 0.1);
  ASSERT_EQ(commands.size(), 1U);
  EXPECT_NEAR(commands[0].feed_override, 0.9, 1e-12);
  Course unknown(rule(ActRule::speed));
  unknown.speed_rpm = 0.0;
  unknown.suggested_rpm = {5400};
  const std::vector<Command> none = unknown.stay(State::chatter, 1.0);
  ASSERT_EQ(none.size(), 1U);
  EXPECT_NE(none[0].reason.find("spindle speed is not known"), std::string::npos);
}

TEST(Act, RejectsSettingsThatMakeNoSense) {
  const auto field = [](const ActSettings& settings) { return test::field_of([&] { const Actor actor(settings); }); };
  EXPECT_EQ(field({.rule = ActRule::hold}), "retract_m");
  EXPECT_EQ(field({.rule = ActRule::reduce, .reduce_to = 1.0}), "reduce_to");
  EXPECT_EQ(field({.rule = ActRule::speed, .lowest_rad_per_s = 500.0, .highest_rad_per_s = 400.0}),
            "highest_rad_per_s");
  EXPECT_EQ(field({.rule = ActRule::speed, .settle_s = 0.0}), "settle_s");
  EXPECT_EQ(field({.rule = ActRule::speed, .calm_s = std::nan("")}), "calm_s");
  EXPECT_EQ(field({}), "accepted");
}

TEST(Act, ACommandIsOneLineOfJson) {
  const std::string line = command_line({.kind = Kind::spindle_speed,
                                         .time_s = 3.7125,
                                         .spindle_speed_rad_per_s = 5400.0 * rpm,
                                         .feed_override = 0.9,
                                         .feed_first = true,
                                         .reason = "chatter",
                                         .not_claimed = "that it ends"},
                                        1'700'000'000.123456);
  EXPECT_EQ(line.find('\n'), line.size() - 1);
  const auto json = nlohmann::json::parse(line);
  EXPECT_EQ(json["time_s"], 3.7125);
  EXPECT_NEAR(json["decided_unix_s"].get<double>(), 1'700'000'000.123456, 1e-6);
  EXPECT_EQ(json["command"], "spindle-speed");
  EXPECT_NEAR(json["spindle_speed_rpm"].get<double>(), 5400.0, 1e-9);
  EXPECT_EQ(json["feed_override"], 0.9);
  EXPECT_TRUE(json["retract_mm"].is_null());
  EXPECT_EQ(json["first"], "feed");
  EXPECT_EQ(json["reason"], "chatter");
  EXPECT_EQ(json["not_claimed"], "that it ends");
  const auto hold = nlohmann::json::parse(command_line({.kind = Kind::hold, .retract_m = 2e-3}, 0.0));
  EXPECT_EQ(hold["command"], "hold");
  EXPECT_EQ(hold["retract_mm"], 2.0);
  EXPECT_TRUE(hold["spindle_speed_rpm"].is_null());
  EXPECT_TRUE(hold["first"].is_null());
}

/// The advice on chatter at this frequency, at 6,500 rpm and with three teeth.
MonitorEvent advised(const AdviceBasis& basis, double frequency_hz, double std_hz = 0.2) {
  MonitorEvent event;
  event.decision.state = State::chatter;
  event.decision.chatter_frequency_hz = frequency_hz;
  event.decision.chatter_frequency_std_hz = std_hz;
  event.decision.spindle_speed_rad_per_s = 6500.0 * rpm;
  Advisor(basis).advise(event);
  return event;
}

// The robot's modes at 17.40 and 540.08 Hz, measured as sidebands of tooth passing, 325 Hz.
TEST(Advisor, SuggestsNoSpeedForTheArm) {
  const AdviceBasis robot{.teeth = 3, .modes = data::robot_modes()};
  const MonitorEvent tool = advised(robot, 540.08);
  EXPECT_EQ(tool.no_speed, NoSpeed::none);
  EXPECT_GT(tool.suggested_spindle_speed_rad_per_s, 0.0);
  for (const double line_hz : {17.40, 650.0 + 17.40, 650.0 - 17.40}) {
    const MonitorEvent arm = advised(robot, line_hz);
    EXPECT_EQ(arm.no_speed, NoSpeed::arm) << line_hz;
    EXPECT_EQ(arm.mode.number, 1);
    EXPECT_EQ(arm.suggested_spindle_speed_rad_per_s, 0.0);
    EXPECT_TRUE(arm.stable_speeds_rad_per_s.empty());
  }
  // Between two modes of the tool the speeds are about the same; where one of the arm may be meant they are not.
  const MonitorEvent unclear = advised(robot, 650.0 + 17.40, 20.0);
  EXPECT_EQ(unclear.no_speed, NoSpeed::unclear);
  EXPECT_TRUE(unclear.stable_speeds_rad_per_s.empty());
  // Without modes the measured line counts.
  EXPECT_EQ(advised({.teeth = 3}, 60.0).no_speed, NoSpeed::arm);
  EXPECT_EQ(advised({.teeth = 3}, 545.0).no_speed, NoSpeed::none);
}

/// One mode of the tool [Hz].
modal::ModalModel mode_at(double frequency_hz) {
  modal::ModalModel model;
  model.excitations = model.responses = {{.axis = modal::Axis::x}};
  modal::Mode mode;
  mode.frequency_hz = frequency_hz;
  mode.damping_ratio = 0.002;
  mode.left = mode.right = Eigen::VectorXcd::Ones(1);
  model.modes = {mode};
  return model;
}

// 661 Hz at 1,650 Hz without a filter: 989 Hz folded where that is the mode's, else it may be either.
TEST(Advisor, SuggestsNoSpeedWhereTheLineMayBeFolded) {
  const MonitorEvent folded =
      advised({.teeth = 3, .modes = mode_at(989.0), .unfiltered_sample_rate_hz = 1650.0}, 661.0);
  EXPECT_EQ(folded.line_hz, std::vector<double>{989.0});
  EXPECT_EQ(folded.mode.number, 1);
  EXPECT_EQ(folded.no_speed, NoSpeed::none);
  const double passings = 60.0 * 989.0 / 3.0 / (folded.suggested_spindle_speed_rad_per_s / rpm);
  EXPECT_NEAR(passings, std::round(passings), 1e-9);
  const MonitorEvent as_measured =
      advised({.teeth = 3, .modes = mode_at(661.0), .unfiltered_sample_rate_hz = 1650.0}, 661.0);
  EXPECT_TRUE(as_measured.line_hz.empty());
  EXPECT_EQ(as_measured.no_speed, NoSpeed::none);
  const MonitorEvent open = advised({.teeth = 3, .unfiltered_sample_rate_hz = 1650.0}, 661.0);
  EXPECT_EQ(open.line_hz, (std::vector{661.0, 989.0, 2311.0}));
  EXPECT_EQ(open.no_speed, NoSpeed::ambiguous_alias);
  EXPECT_FALSE(open.mode.known());
  EXPECT_EQ(open.suggested_spindle_speed_rad_per_s, 0.0);
  EXPECT_TRUE(open.stable_speeds_rad_per_s.empty());
}

// A spindle from 12,000 rpm on passes 600 teeth a second at least: no lobe of 545 Hz lies there.
TEST(Advisor, KeepsToTheSpeedsOfTheSpindle) {
  EXPECT_EQ(
      advised({.teeth = 3, .lowest_rad_per_s = 12'000.0 * rpm, .highest_rad_per_s = 20'000.0 * rpm}, 545.0).no_speed,
      NoSpeed::arm);
  const MonitorEvent event =
      advised({.teeth = 3, .lowest_rad_per_s = 5000.0 * rpm, .highest_rad_per_s = 8000.0 * rpm}, 545.0);
  ASSERT_EQ(event.stable_speeds_rad_per_s.size(), 1U);
  EXPECT_NEAR(event.stable_speeds_rad_per_s[0], 5450.0 * rpm, 1e-9);
}

// Two tooth passings at 6,500 rpm are 650 Hz: the cut chatters at that speed.
TEST(Advisor, SuggestsNoSpeedAtWhichItChatters) {
  const MonitorEvent event = advised({.teeth = 3}, 651.0);
  EXPECT_NEAR(event.suggested_spindle_speed_rad_per_s, 651.0 * 60.0 / 9.0 * rpm, 1e-9);
  for (const double speed : event.stable_speeds_rad_per_s) EXPECT_GT(std::abs(speed / rpm - 6500.0), 65.0);
}

TEST(Advisor, SuggestsNoSpeedForModeCoupling) {
  AdviceBasis basis{.teeth = 3, .lobes = stability::LobesResult{}, .mode_coupling = {false, true, true}};
  basis.lobes->axial_depth_m = Eigen::VectorXd::LinSpaced(3, 0.0, 4e-3);
  for (const double speed_rpm : {5400.0, 6000.0, 6600.0}) {
    basis.lobes->limit.push_back(
        {.spindle_speed_rad_per_s = speed_rpm * rpm, .status = stability::Limit::Status::found, .axial_depth_m = 1e-3});
  }
  const MonitorEvent coupled = advised(basis, 545.0);
  EXPECT_EQ(coupled.no_speed, NoSpeed::mode_coupling);
  EXPECT_EQ(coupled.suggested_spindle_speed_rad_per_s, 0.0);
  AdviceBasis elsewhere = basis;
  for (stability::Limit& limit : elsewhere.lobes->limit) limit.spindle_speed_rad_per_s *= 1.5;
  EXPECT_EQ(advised(elsewhere, 545.0).no_speed, NoSpeed::none);
  basis.mode_coupling.back() = false;
  EXPECT_GT(advised(basis, 545.0).suggested_spindle_speed_rad_per_s, 0.0);
}

// Three tooth passings at 3,633 rpm, two at 5,450 and one at 10,900 rpm are 545 Hz.
TEST(Advisor, SaysWhereForcedVibrationLimits) {
  AdviceBasis basis{.teeth = 3, .lobes = stability::LobesResult{}, .vibration_depth_m = {4e-3, 2e-3, 4e-3}};
  basis.lobes->axial_depth_m = Eigen::VectorXd::LinSpaced(3, 0.0, 4e-3);
  for (const auto& [speed_rpm, depth_m] : {std::pair{5400.0, 1e-3}, {6000.0, 3e-3}, {6600.0, 1e-3}}) {
    basis.lobes->limit.push_back({.spindle_speed_rad_per_s = speed_rpm * rpm,
                                  .status = stability::Limit::Status::found,
                                  .axial_depth_m = depth_m});
  }
  const MonitorEvent vibrates = advised(basis, 545.0);
  EXPECT_NEAR(vibrates.suggested_spindle_speed_rad_per_s, 6000.0 * rpm, 1e-9);
  EXPECT_EQ(vibrates.suggested_axial_depth_m, 2e-3);
  EXPECT_EQ(vibrates.depth_limited_by, monitor::DepthLimitedBy::forced_vibration);
  EXPECT_NE(monitor::event_line(vibrates).find("\"depth_limited_by\":\"forced-vibration\""), std::string::npos);
  basis.vibration_depth_m.clear();
  const MonitorEvent chatters = advised(basis, 545.0);
  EXPECT_NEAR(chatters.suggested_axial_depth_m, 0.8 * (3e-3 - 0.02 * 6000.0 / 600.0 * 2e-3), 1e-12);
  EXPECT_EQ(chatters.depth_limited_by, monitor::DepthLimitedBy::stability);
  // A spindle that reaches one lobe alone, at which the tip would vibrate too much.
  basis.vibration_depth_m = {0.5e-3, 2e-3, 4e-3};
  basis.lowest_rad_per_s = 5430.0 * rpm;
  basis.highest_rad_per_s = 5500.0 * rpm;
  const MonitorEvent none = advised(basis, 545.0);
  EXPECT_EQ(none.no_speed, NoSpeed::forced_vibration);
  EXPECT_EQ(none.suggested_spindle_speed_rad_per_s, 0.0);
  EXPECT_TRUE(none.stable_speeds_rad_per_s.empty());
  basis.vibration_depth_m = {4e-3, 2e-3, 4e-3};
  EXPECT_EQ(advised(basis, 545.0).stable_speeds_rad_per_s.size(), 1U);
}

}  // namespace act_test
}  // namespace robomill::live
