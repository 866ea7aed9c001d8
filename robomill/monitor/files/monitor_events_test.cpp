#include "robomill/monitor/files/monitor_events.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "robomill/base/units.hpp"

namespace robomill::monitor {
namespace monitor_events_test {

TEST(MonitorEvents, AreOneLineWithTheNamesOfTheInterface) {
  MonitorEvent event;
  event.time_s = 3.7125;
  event.decision.state = State::chatter;
  event.decision.score = 12.5;
  event.decision.threshold = 9.0;
  event.decision.chatter_frequency_hz = 683.6;
  event.decision.chatter_frequency_std_hz = 0.4;
  event.decision.channel = 1;
  event.decision.faults = clipped | not_finite;
  event.decision.synchronous = SynchronousChatter::locked;
  event.mode = {2};
  event.line_hz = {989.0};
  event.suggested_spindle_speed_rad_per_s = 6500.0 * units::rpm;
  event.stable_speeds_rad_per_s = {6500.0 * units::rpm, 3250.0 * units::rpm};
  event.command = "spindle-speed";
  event.compute_s = 123e-6;
  const std::string line = event_line(event);
  EXPECT_EQ(line.find('\n'), line.size() - 1);
  const auto json = nlohmann::json::parse(line);
  EXPECT_EQ(json["time_s"], 3.7125);
  EXPECT_EQ(json["event"], "state");
  EXPECT_EQ(json["state"], "chatter");
  EXPECT_EQ(json["score"], 12.5);
  EXPECT_EQ(json["threshold"], 9.0);
  EXPECT_TRUE(json.contains("energy_entropy"));
  EXPECT_EQ(json["chatter_frequency_hz"], 683.6);
  EXPECT_EQ(json["channel"], 2);
  EXPECT_EQ(json["hidden"], "locked");
  EXPECT_EQ(json["mode"], 2);
  EXPECT_EQ(json["mode_of"], "tool");
  EXPECT_EQ(json["line_frequencies_hz"], (std::vector<double>{989.0}));
  EXPECT_EQ(json["suggested_spindle_speed_rpm"], 6500);
  EXPECT_EQ(json["stable_spindle_speeds_rpm"][1], 3250);
  EXPECT_EQ(json["faults"], (std::vector<std::string>{"not-finite", "clipped"}));
  EXPECT_EQ(json["command"], "spindle-speed");
  EXPECT_TRUE(json["no_speed"].is_null());
  event.no_speed = NoSpeed::mode_coupling;
  EXPECT_EQ(nlohmann::json::parse(event_line(event))["no_speed"], "mode-coupling");
  event.no_speed = NoSpeed::ambiguous_alias;
  EXPECT_EQ(nlohmann::json::parse(event_line(event))["no_speed"], "ambiguous-alias");
  EXPECT_EQ(json["compute_us"], 123);
  EXPECT_FALSE(json.contains("what"));
}

TEST(MonitorEvents, HoldWhatIsUnknownAsNull) {
  MonitorEvent event;
  event.decision.score = std::numeric_limits<double>::quiet_NaN();
  event.decision.energy_entropy = std::numeric_limits<double>::infinity();
  const auto json = nlohmann::json::parse(event_line(event));
  for (const char* key : {"score", "energy_entropy", "chatter_frequency_hz", "chatter_frequency_std_hz", "mode",
                          "suggested_spindle_speed_rpm", "suggested_axial_depth_mm", "spindle_speed_rpm", "hidden",
                          "no_speed", "depth_limited_by", "command"}) {
    EXPECT_TRUE(json[key].is_null()) << key;
  }
  EXPECT_TRUE(json["faults"].empty());
  EXPECT_TRUE(json["line_frequencies_hz"].empty());
}

TEST(MonitorEvents, SayWhyWhereTheyAreAskedTo) {
  MonitorEvent event;
  Explanation& why = event.decision.why;
  why = {.test = monitor::Test::ratio, .hops = 5, .enough_hops = 6, .speed_belief = 0.41F};
  why.ask(Quantity::asynchronous_ratio, 0.31, 0.2);
  why.ask(Quantity::above_quiet, std::numeric_limits<double>::infinity(), 10.0);
  why.ask(Quantity::order_change, 0.01, 0.005, true);
  EXPECT_FALSE(nlohmann::json::parse(event_line(event)).contains("why"));
  event.explained = true;
  const auto json = nlohmann::json::parse(event_line(event))["why"];
  EXPECT_EQ(json["test"], "ratio");
  EXPECT_EQ(json["hops"], 5);
  EXPECT_EQ(json["of"], 6);
  EXPECT_EQ(json["speed_belief"], 0.41);
  ASSERT_EQ(json["conditions"].size(), 3U);
  const auto& ratio = json["conditions"][0];
  EXPECT_EQ(ratio["quantity"], "asynchronous_ratio");
  EXPECT_EQ(ratio["meaning"], "energy beside the orders, to theirs");
  EXPECT_TRUE(ratio["shown_in"].is_null());
  EXPECT_EQ(ratio["value"], 0.31);
  EXPECT_EQ(ratio["at_least"], 0.2);
  EXPECT_FALSE(ratio.contains("at_most"));
  EXPECT_EQ(ratio["holds"], true);
  EXPECT_EQ(json["conditions"][1]["shown_in"], "dB");
  EXPECT_TRUE(json["conditions"][1]["value"].is_null());
  EXPECT_EQ(json["conditions"][2]["at_most"], 0.005);
  EXPECT_FALSE(json["conditions"][2].contains("at_least"));
  EXPECT_EQ(json["conditions"][2]["holds"], false);
  event.kind = MonitorEvent::Kind::window;
  EXPECT_TRUE(nlohmann::json::parse(event_line(event)).contains("why"));
  event.kind = MonitorEvent::Kind::stream;
  EXPECT_FALSE(nlohmann::json::parse(event_line(event)).contains("why"));
  event = {.explained = true};  // no test has anything to go by
  EXPECT_FALSE(nlohmann::json::parse(event_line(event)).contains("why"));
}

TEST(MonitorEvents, HaveWordsForAliases) {
  EXPECT_EQ(line_text({}), "");
  EXPECT_EQ(line_text({989.04}), "989.0 Hz folded");
  EXPECT_EQ(line_text({661.0, 989.0}), "661.0 or 989.0 Hz");
  EXPECT_EQ(line_text({661.0, 989.0, 2311.0}), "661.0, 989.0 or 2311.0 Hz");
}

TEST(MonitorEvents, HoldWhatHappenedToTheStream) {
  MonitorEvent event;
  event.kind = MonitorEvent::Kind::stream;
  event.what = "lost-blocks";
  event.count = 3;
  event.message = "not UTF-8: \xFF";
  const auto json = nlohmann::json::parse(event_line(event));
  EXPECT_EQ(json["event"], "stream");
  EXPECT_EQ(json["what"], "lost-blocks");
  EXPECT_EQ(json["count"], 3);
}

}  // namespace monitor_events_test
}  // namespace robomill::monitor
