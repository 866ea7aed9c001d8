// The simulator in the loop: a cut chatters, the monitor detects it in the stream, a rule changes speed and feed of the
// cut while it is simulated, and it goes on.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/live/advisor.hpp"
#include "robomill/live/session.hpp"
#include "robomill/simulation/engine.hpp"
#include "robomill/simulation/resample.hpp"
#include "robomill/stability/lobes.hpp"
#include "testing/simulation/cuts.hpp"

namespace robomill::live {
namespace acting_test {

using monitor::State;
using simulation::Schedule;
using simulation::detail::Engine;
using simulation::detail::Physics;
using simulation::detail::Profile;
using std::numbers::pi;

constexpr double rpm = pi / 30.0, rate_hz = 10'240.0;
constexpr Eigen::Index hop_frames = 256;
constexpr double programmed_rpm = 6700.0, depth_m = 0.6e-3, quiet_share = 0.3, step_s = 1.2, end_s = 6.0;

/// The robot's cut at 0.18 mm, from step_s on at 0.6 mm, which is twice the limit of its speed. Beside it the forced
/// vibration of the same cut, which cannot chatter.
class SimulatedCut {
 public:
  SimulatedCut()
      : cut_(simulation::testing::cut_of(stability::testing::robot(), programmed_rpm, depth_m)),
        model_(model_of(cut_)),
        full_(model_, cut_.structure, Physics::full),
        forced_(model_, cut_.structure, Physics::forced),
        out_(full_.step_s(), rate_hz, rows, 2),
        out_forced_(full_.step_s(), rate_hz, rows, 2) {
    out_.push(Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero());
    out_forced_.push(Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero());
  }

  /// The next 25 ms of two accelerometers.
  Hop next(Random& random) {
    Hop hop;
    const Eigen::Index from = given_;
    given_ += hop_frames;
    while (out_.rows_done() < given_) {
      full_.step();
      forced_.step();
      push(full_, out_);
      push(forced_, out_forced_);
    }
    for (Eigen::Index i = from; i < given_; ++i) {
      for (const Eigen::Index c : {0, 1}) {
        hop.samples.push_back(static_cast<float>(out_.acceleration_m_per_s2(i, c) + 0.5 * random.normal()));
      }
    }
    return hop;
  }
  [[nodiscard]] double time_s() const { return static_cast<double>(given_) / rate_hz; }
  [[nodiscard]] bool done() const { return given_ + hop_frames > rows; }

  /// From now on within `within_s`: the speed (0: as it is), and the feed as a share of the programmed one.
  void command(double speed_rad_per_s, double feed_override, double within_s) {
    const double now_s = full_.time_s();
    const double before = speed_.back().share;
    speed_.push_back({now_s, before});
    speed_.push_back(
        {now_s + within_s, speed_rad_per_s > 0.0 ? speed_rad_per_s / cut_.spindle_speed_rad_per_s : before});
    feed_.push_back({now_s, feed_.back().share});
    feed_.push_back({now_s + within_s, feed_override});
    model_.spindle.schedule = Profile(speed_);
    model_.feed = Profile(feed_);
  }
  /// Root mean square of the acceleration between two times, of the cut and of its forced vibration.
  [[nodiscard]] std::pair<double, double> level(double from_s, double to_s) const {
    const auto from = static_cast<Eigen::Index>(from_s * rate_hz), n = static_cast<Eigen::Index>(to_s * rate_hz) - from;
    const auto rms = [&](const simulation::detail::Resampler& r) {
      return r.acceleration_m_per_s2.middleRows(from, n).norm() / std::sqrt(static_cast<double>(n));
    };
    return {rms(out_), rms(out_forced_)};
  }

 private:
  static constexpr auto rows = static_cast<Eigen::Index>(end_s * rate_hz);

  static simulation::detail::CutModel model_of(const simulation::MillingCut& cut) {
    simulation::detail::CutModel model =
        simulation::detail::milling_model(cut.milling, cut.spindle_speed_rad_per_s, cut.axial_depth_m, {480, 1});
    model.depth = Profile({{0.1, 0.0}, {0.2, quiet_share}, {step_s, quiet_share}, {step_s, 1.0}});
    model.spindle.schedule = Profile({{0.0, 1.0}});
    model.feed = Profile({{0.0, 1.0}});
    return model;
  }
  static void push(const Engine<2>& engine, simulation::detail::Resampler& out) {
    if (!out.done()) {
      out.push({engine.displacement()(0), engine.displacement()(1), 0.0}, Eigen::Vector3d::Zero());
    }
  }

  simulation::MillingCut cut_;
  simulation::detail::CutModel model_;
  Engine<2> full_, forced_;
  simulation::detail::Resampler out_, out_forced_;
  std::vector<Schedule::Point> speed_ = {{0.0, 1.0}}, feed_ = {{0.0, 1.0}};
  Eigen::Index given_ = 0;
};

monitor::MonitorFile monitored(monitor::ActRule rule) {
  monitor::MonitorFile file;
  file.columns.channels = {"ax", "ay"};
  file.options.channels = 2;
  file.options.sample_rate_hz = rate_hz;
  file.options.spindle_speed_rad_per_s = programmed_rpm * rpm;
  file.options.teeth = 3;
  file.act.rule = rule;
  return file;
}

/// The robot's modes and the chart of its cut.
Advisor advisor(double speed_window = AdviceBasis().speed_window) {
  const stability::LobesProblem problem = stability::testing::robot();
  return Advisor({.teeth = 3,
                  .modes = problem.dynamics,
                  .lobes = stability::compute_lobes(problem, stability::testing::chart(4500, 7500, 2e-3, 61, 40)),
                  .speed_window = speed_window});
}

/// What a session of a simulated cut did.
struct Outcome {
  std::vector<Command> commands = {};
  std::vector<monitor::MonitorEvent> events = {};
  std::vector<State> states = {};  ///< one a hop
  [[nodiscard]] bool all_from(double from_s, State wanted) const {
    return std::all_of(states.begin() + static_cast<std::ptrdiff_t>(from_s / 0.025), states.end(),
                       [&](State state) { return state == wanted; });
  }
  [[nodiscard]] double first_s(State wanted) const {
    return 0.025 * static_cast<double>(std::find(states.begin(), states.end(), wanted) - states.begin());
  }
};

/// The spindle takes 0.4 s to another speed; the feed follows it, alone it takes 0.1 s.
Outcome monitored_run(const monitor::MonitorFile& file, SimulatedCut& cut,
                      std::function<void(monitor::MonitorEvent&)> advise) {
  Outcome out;
  SessionOutputs outputs;
  outputs.advise = std::move(advise);
  outputs.decision = [&](const monitor::Decision& d, double, double) { out.states.push_back(d.state); };
  outputs.event = [&](const monitor::MonitorEvent& event, const std::string&) {
    out.events.push_back(event);
    return true;
  };
  outputs.command = [&](const Command& command) {
    out.commands.push_back(command);
    const bool speed = command.kind == Command::Kind::spindle_speed;
    cut.command(speed ? command.spindle_speed_rad_per_s : 0.0, command.feed_override, speed ? 0.4 : 0.1);
  };
  Session session(file, {}, std::move(outputs));
  Random random(5);
  while (!cut.done()) session.process(cut.next(random));
  return out;
}

// 0.6 mm is twice the limit at 6,700 rpm; at the speed that the chart gives it is below the limit: what remains is the
// forced vibration.
TEST(Acting, TheSuggestedSpeedEndsChatter) {
  SimulatedCut cut;
  const Advisor known =
      advisor(0.0);  // a window keeps off the lobe's end, nearer to where tooth passing meets the mode
  const Outcome run = monitored_run(monitored(monitor::ActRule::speed), cut,
                                    [&](monitor::MonitorEvent& event) { known.advise(event); });
  ASSERT_EQ(run.commands.size(), 1U);
  const Command& command = run.commands.front();
  EXPECT_EQ(command.kind, Command::Kind::spindle_speed);
  EXPECT_GT(command.time_s, step_s);
  EXPECT_LT(command.time_s, step_s + 0.5);
  const double share = command.spindle_speed_rad_per_s / (programmed_rpm * rpm);
  EXPECT_NEAR(command.feed_override, share, 1e-3 * share);  // feed per tooth stays
  EXPECT_TRUE(command.feed_first);
  const auto event = std::find_if(run.events.begin(), run.events.end(),
                                  [](const monitor::MonitorEvent& e) { return !e.command.empty(); });
  ASSERT_NE(event, run.events.end());
  EXPECT_EQ(event->command, "spindle-speed");
  EXPECT_EQ(event->time_s, command.time_s);

  const auto [before, forced_before] = cut.level(command.time_s - 0.05, command.time_s);
  EXPECT_GT(before, 2.0 * forced_before);  // it did chatter
  const auto [after, forced_after] = cut.level(end_s - 1.0, end_s - 0.1);
  EXPECT_NEAR(after, forced_after, 0.01 * forced_after);
  EXPECT_LT(after, 0.6 * before);  // before: as far as it had grown when it was detected
  EXPECT_TRUE(run.all_from(command.time_s + monitor::ActSettings().settle_s + 0.5, State::stable));
  // The cut went on: half of the time was at the full depth, with a feed.
  EXPECT_EQ(run.states.size(), static_cast<std::size_t>(end_s / 0.025));
}

// 6,300 rpm has a limit of 0.33 mm: chatter is still there, is detected anew, and the next speed ends it.
TEST(Acting, TheNextSpeedFollowsWhereChatterIsStillThere) {
  SimulatedCut cut;
  const Outcome run = monitored_run(monitored(monitor::ActRule::speed), cut, [](monitor::MonitorEvent& event) {
    event.stable_speeds_rad_per_s = {6300.0 * rpm, 5200.0 * rpm};
  });
  ASSERT_EQ(run.commands.size(), 2U);
  EXPECT_NEAR(run.commands[0].spindle_speed_rad_per_s, 6300.0 * rpm, 1e-9);
  EXPECT_NEAR(run.commands[1].spindle_speed_rad_per_s, 5200.0 * rpm, 1e-9);
  EXPECT_GE(run.commands[1].time_s, run.commands[0].time_s + monitor::ActSettings().settle_s - 1e-9);
  EXPECT_NEAR(run.commands[1].feed_override, 5200.0 / programmed_rpm, 1e-3);
  const auto [between, forced_between] = cut.level(run.commands[1].time_s - 0.3, run.commands[1].time_s);
  EXPECT_GT(between, 1.5 * forced_between);
  const auto [after, forced_after] = cut.level(end_s - 0.5, end_s - 0.1);
  EXPECT_NEAR(after, forced_after, 0.02 * forced_after);
}

// Half the feed: chatter goes on, with less of it.
TEST(Acting, AReducedFeedIsNoCure) {
  SimulatedCut cut;
  const Outcome run = monitored_run(monitored(monitor::ActRule::reduce), cut, {});
  ASSERT_EQ(run.commands.size(), 1U);
  EXPECT_EQ(run.commands[0].kind, Command::Kind::feed);
  EXPECT_EQ(run.commands[0].feed_override, 0.5);
  EXPECT_NE(run.commands[0].not_claimed.find("does not end regenerative chatter"), std::string::npos);
  EXPECT_TRUE(run.all_from(run.commands[0].time_s, State::chatter));
  const auto [after, forced_after] = cut.level(end_s - 1.0, end_s - 0.1);
  EXPECT_GT(after, 2.0 * forced_after);
}

// What a session does that nobody asked to act.
TEST(Acting, NoRuleCommandsNothing) {
  SimulatedCut cut;
  const Advisor known = advisor();
  const Outcome run =
      monitored_run(monitored(monitor::ActRule::none), cut, [&](monitor::MonitorEvent& event) { known.advise(event); });
  EXPECT_TRUE(run.commands.empty());
  EXPECT_TRUE(run.all_from(run.first_s(State::chatter), State::chatter));
}

}  // namespace acting_test
}  // namespace robomill::live
