#include "robomill/path/setpoint_stream.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <thread>
#include <utility>
#include <vector>

#include "robomill/path/realtime/scheduling.hpp"
#include "robomill/path/smooth.hpp"
#include "testing/allocations.hpp"
#include "testing/path/mixed_program.hpp"
#include "testing/path/ride.hpp"
#include "testing/support.hpp"

namespace robomill::path {
namespace setpoint_stream_test {

using test::Machine;
using State = PathInterpolator::State;

constexpr std::int64_t ms_ns = 1'000'000;

/// A clock that goes as it is told: between two periods `meanwhile` runs, which stands for the other threads, and the
/// thread wakes up as late as `late_ns` says.
class Told final : public StreamClock {
 public:
  [[nodiscard]] std::int64_t now_ns() noexcept override { return now_ns_ += passes_ns; }
  void sleep_until(std::int64_t time_ns) noexcept override {
    if (meanwhile) meanwhile(count_);
    now_ns_ = std::max(now_ns_, time_ns + (late_ns ? late_ns(count_) : 0));
    ++count_;
  }
  std::function<void(std::size_t period)> meanwhile = {};
  std::function<std::int64_t(std::size_t period)> late_ns = {};
  std::int64_t passes_ns = 0;  ///< with every look at the clock

 private:
  std::int64_t now_ns_ = 77 * ms_ns;
  std::size_t count_ = 0;
};

/// A program on a machine, streamed by a clock that goes as it is told.
struct Streamed {
  Streamed(Machine kind, const program::Program& streamed, double ring_s = 4.0)
      : program(streamed),
        machine(test::make_machine(kind)),
        posture(test::posture_for(program, *machine)),
        path(*machine, options, program.start, posture.gamma_rad[0], posture.start),
        stream(path, {.period_s = options.sample_period_s, .ring_s = ring_s}) {
    setpoints.reserve(200'000);
  }
  /// As far as the look-ahead goes.
  void push() {
    while (block < program.blocks.size() && path.push(program.blocks[block]).accepted()) ++block;
    if (block == program.blocks.size()) static_cast<void>(path.finish());
  }
  void read() {
    for (; stream.begin() < stream.end(); stream.drop_before(stream.begin() + 1)) {
      if (setpoints.size() < setpoints.capacity()) setpoints.push_back(stream[stream.begin()]);
    }
  }
  /// @param command  may command at each period
  void run(const std::function<void(std::size_t)>& command = {}) {
    push();
    clock.meanwhile = [&](std::size_t period) {
      push();
      read();
      if (command) command(period);
    };
    stream.run(clock);
    while (stream.wait()) read();
  }
  [[nodiscard]] std::vector<Sample> samples() const {
    std::vector<Sample> out;
    for (const Setpoint& setpoint : setpoints) out.push_back(setpoint.sample);
    return out;
  }

  SmoothingOptions options = test::published_options(Method::verified);
  const program::Program& program;
  std::unique_ptr<robot::Kinematics> machine;
  Posture posture;
  PathInterpolator path;
  SetpointStream stream;
  Told clock;
  std::vector<Setpoint> setpoints;
  std::size_t block = 0;
};

program::Program some_program(std::uint64_t seed, int least = 60, int most = 200) {
  Random random(seed, 31);
  return test::mixed_program(random, {.least_blocks = least, .most_blocks = most});
}

/// The samples of the same interpolator without a clock.
std::vector<Sample> offline(const Streamed& s) {
  PathInterpolator path(*s.machine, s.options, s.program.start, s.posture.gamma_rad[0], s.posture.start);
  Random random(1);
  return test::ride(path, s.program, {}, random).samples;
}

void expect_same(const std::vector<Setpoint>& setpoints, const std::vector<Sample>& samples) {
  ASSERT_EQ(setpoints.size(), samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Sample &one = setpoints[i].sample, &other = samples[i];
    ASSERT_EQ(one.joints, other.joints) << i;
    ASSERT_EQ(one.tip_m, other.tip_m) << i;
    ASSERT_EQ(one.axis, other.axis) << i;
    ASSERT_EQ(one.time_s, other.time_s) << i;
    ASSERT_EQ(one.block, other.block) << i;
  }
}

TEST(SetpointStream, HandsOverWhatIsSampledOffline) {
  const std::pair<Machine, program::Program> cases[] = {
      {Machine::hybrid, test::s_path()}, {Machine::kr210, some_program(1)}, {Machine::tilt_head, some_program(2)}};
  for (const auto& [kind, program] : cases) {
    Streamed s(kind, program);
    s.run();
    expect_same(s.setpoints, offline(s));
    EXPECT_EQ(s.setpoints.back().state, State::finished);
    EXPECT_EQ(test::check(program, *s.machine, s.options, s.samples()).violations(), 0U);
    const StreamReport& report = s.stream.report();
    EXPECT_EQ(report.periods, s.setpoints.size());
    EXPECT_EQ(report.misses + report.starved + report.overruns + report.shifts + report.reader_holds, 0U);
    EXPECT_EQ(report.hand_over.count(), report.periods);
    EXPECT_EQ(report.hand_over.max_s(), 0.0);
    for (std::size_t i = 1; i < s.setpoints.size(); ++i) {
      ASSERT_EQ(s.setpoints[i].due_ns - s.setpoints[0].due_ns, static_cast<std::int64_t>(i) * ms_ns);
    }
  }
}

/// A curve through samples at even times, at a place between two of them: a cubic through four.
Eigen::Vector3d cubic(const Sample* four, double at_m) {
  Eigen::Vector3d out = Eigen::Vector3d::Zero();
  for (int i = 0; i < 4; ++i) {
    double weight = 1.0;
    for (int j = 0; j < 4; ++j) {
      if (j != i) weight *= (at_m - four[j].path_m) / (four[i].path_m - four[j].path_m);
    }
    out += weight * four[i].tip_m;
  }
  return out;
}

// What is planned ahead runs along the same curve but in corners, whose widths each plan chooses within the tolerance,
// and at other speeds: the stream keeps a reserve for holds.
TEST(SetpointStream, RunsAlongTheTrajectoryThatIsSmoothedAhead) {
  const program::Program program = test::s_path();
  Streamed s(Machine::hybrid, program);
  s.run();
  program::ProgramSource source(program);
  std::vector<Sample> ahead;
  Progress& progress = Progress::none();
  static_cast<void>(smooth(
      source, *s.machine, s.posture, s.options,
      [&](std::span<const Sample> samples) { ahead.insert(ahead.end(), samples.begin(), samples.end()); },
      [&] { ahead.clear(); }, progress));
  double worst_m = 0.0;
  std::size_t at = 0, compared = 0, same = 0;
  for (const Setpoint& setpoint : s.setpoints) {
    const double path_m = setpoint.sample.path_m;
    while (at + 1 < ahead.size() && ahead[at + 1].path_m < path_m) ++at;
    if (at < 1 || at + 2 >= ahead.size()) continue;
    if (ahead[at + 2].path_m - ahead[at - 1].path_m < 3e-6) continue;  // at rest there is no curve to be drawn
    const double apart_m = (cubic(&ahead[at - 1], path_m) - setpoint.sample.tip_m).norm();
    worst_m = std::max(worst_m, apart_m);
    same += apart_m < 1e-9 ? 1U : 0U;
    ++compared;
  }
  EXPECT_GT(compared, s.setpoints.size() * 9 / 10);
  EXPECT_GT(same, compared * 9 / 10);
  EXPECT_LT(worst_m, s.options.tip_tolerance_m);
  EXPECT_LT((s.setpoints.back().sample.joints - ahead.back().joints).norm(), 1e-12);
  EXPECT_GT(s.setpoints.size(), ahead.size());
  EXPECT_LT(static_cast<double>(s.setpoints.size()), 1.2 * static_cast<double>(ahead.size()));
}

/// Limits of velocity, acceleration and jerk of joints and tip, by differences of the set-points themselves. Of the
/// tip, speed and its change; its jerk is the path's too where it bends, and is left to the check.
void expect_within_limits(const Streamed& s) {
  const robot::JointLimits& limits = s.machine->limits();
  const double rate = 1.0 / s.options.sample_period_s;
  const std::vector<Setpoint>& p = s.setpoints;
  for (std::size_t i = 3; i < p.size(); ++i) {
    const robot::Position6 a = p[i].sample.joints, b = p[i - 1].sample.joints, c = p[i - 2].sample.joints,
                           d = p[i - 3].sample.joints;
    for (int j = 0; j < s.machine->joints(); ++j) {
      ASSERT_LE(std::abs(a[j] - b[j]) * rate, limits.max_velocity[j] * (1 + 1e-6)) << i;
      ASSERT_LE(std::abs(a[j] - 2 * b[j] + c[j]) * rate * rate, limits.max_acceleration[j] * (1 + 1e-6)) << i;
      ASSERT_LE(std::abs(a[j] - 3 * b[j] + 3 * c[j] - d[j]) * rate * rate * rate, limits.max_jerk[j] * (1 + 1e-6)) << i;
    }
    const double now = (p[i].sample.tip_m - p[i - 1].sample.tip_m).norm() * rate;
    ASSERT_LE(now, s.options.max_velocity_m_per_s * (1 + 1e-6)) << i;
  }
}

/// What the check finds of motion; tolerances only where the program was run to its end.
void expect_no_violation(const Streamed& s, bool whole) {
  expect_within_limits(s);
  const CheckResult result = test::check(s.program, *s.machine, s.options, s.samples());
  EXPECT_TRUE(!whole || result.violations() == 0U);
  for (const Violation& violation : result.worst_violations) {
    if (violation.order >= 1) ADD_FAILURE() << "order " << violation.order << " ratio " << violation.ratio;
  }
}

TEST(SetpointStream, CommandsKeepEveryLimit) {
  for (const Machine kind : {Machine::tilt_head, Machine::hybrid, Machine::kr210}) {
    for (int seed = 0; seed < robomill::test::seeds(20); ++seed) {
      SCOPED_TRACE(seed);
      const program::Program program = some_program(100 + static_cast<std::uint64_t>(seed));
      Random random(static_cast<std::uint64_t>(seed), 32);
      Streamed s(kind, program);
      std::size_t holds = 0;
      s.run([&](std::size_t) {
        const double what = random.uniform();
        if (what < 0.002) s.stream.hold();
        if (what > 0.99) s.stream.resume();
        if (what > 0.5 && what < 0.505) s.stream.set_override(random.uniform(0.1, 1.0));
        holds += s.stream.state() == State::holding ? 1U : 0U;
      });
      EXPECT_EQ(s.setpoints.back().state, State::finished);
      EXPECT_GT(holds, 0U);
      expect_no_violation(s, true);
    }
  }
}

TEST(SetpointStream, StopsWithinEveryLimit) {
  for (int seed = 0; seed < robomill::test::seeds(40); ++seed) {
    SCOPED_TRACE(seed);
    const program::Program program = some_program(200 + static_cast<std::uint64_t>(seed), 150, 200);
    Random random(static_cast<std::uint64_t>(seed), 33);
    Streamed s(seed % 2 == 0 ? Machine::kr210 : Machine::hybrid, program);
    const std::size_t at = 100 + random.index(2000);
    s.run([&](std::size_t period) {
      if (period == at) s.stream.stop();
    });
    EXPECT_TRUE(s.setpoints.back().state == State::stopped || s.setpoints.size() <= at);
    EXPECT_LT(s.setpoints.size(), at + 3000);
    expect_no_violation(s, false);
    const std::size_t n = s.setpoints.size();
    EXPECT_LT((s.setpoints[n - 1].sample.tip_m - s.setpoints[n - 2].sample.tip_m).norm(), 1e-6);
  }
}

TEST(SetpointStream, AllocatesNothing) {
  const program::Program program = some_program(5);
  Streamed s(Machine::kr210, program);
  s.push();
  s.clock.meanwhile = [&](std::size_t period) {
    s.push();
    s.read();
    if (period == 300) s.stream.hold();
    if (period == 900) s.stream.resume();
    if (period == 1200) s.stream.set_override(0.5);
  };
  static_assert(noexcept(s.stream.run(s.clock)));
  EXPECT_EQ(robomill::test::allocations([&] { s.stream.run(s.clock); }), 0U);
  EXPECT_GT(s.stream.report().periods, 1200U);
  EXPECT_EQ(robomill::test::allocations([&] {
              MonotonicClock clock;
              clock.sleep_until(clock.now_ns() + ms_ns);
            }),
            0U);
}

// Deadlines and delays as they are told: 0.25 ms late as a rule, 1.5 ms at period 10, 3.5 ms at 20, 60 ms at 30.
TEST(SetpointStream, CountsWhatComesLate) {
  const program::Program program = test::s_path();
  Streamed s(Machine::hybrid, program);
  const std::map<std::size_t, std::int64_t> late = {{10, 1'500'000}, {20, 3'500'000}, {30, 60 * ms_ns}};
  s.clock.late_ns = [&](std::size_t period) {
    const auto found = late.find(period);
    return found == late.end() ? 250'000 : found->second;
  };
  s.run();
  const StreamReport& report = s.stream.report();
  // The set-points behind one that is late come as soon as they can: those of 21 and 22 are late too, by 2.5 and 1.5
  // ms, and that of 23, 0.5 ms behind, keeps its deadline. 60 ms are not caught up.
  EXPECT_EQ(report.misses, 5U);
  EXPECT_EQ(report.shifts, 1U);
  EXPECT_NEAR(report.shifted_s, 0.06, 1e-12);
  EXPECT_NEAR(report.hand_over.max_s(), 0.06, 1e-12);
  EXPECT_NEAR(report.hand_over.quantile_s(0.99), 251e-6, 1e-9);
  EXPECT_GE(report.hand_over.mean_s(), 250e-6);
  EXPECT_EQ(s.setpoints[31].due_ns - s.setpoints[30].due_ns, 61 * ms_ns);
  EXPECT_EQ(s.setpoints[30].due_ns - s.setpoints[0].due_ns, 30 * ms_ns);
  // None is left out, and the motion is that of a stream in time.
  expect_same(s.setpoints, offline(s));
}

// At period 10 every look at the clock takes 0.6 ms: woken up in time, handed over too late.
TEST(SetpointStream, CountsAgainstTheHandOverNotTheWakeUp) {
  const program::Program program = test::s_path();
  Streamed s(Machine::hybrid, program);
  s.run([&](std::size_t period) { s.clock.passes_ns = period == 10 ? 600'000 : 0; });
  const StreamReport& report = s.stream.report();
  EXPECT_EQ(report.misses, 1U);
  EXPECT_NEAR(report.wake_up.max_s(), 0.6e-3, 1e-9);
  EXPECT_NEAR(report.hand_over.max_s(), 1.2e-3, 1e-9);
}

// A reader that is away: the motion holds and loses no set-point; when it is back it goes on.
TEST(SetpointStream, HoldsForAReaderThatIsBehind) {
  const program::Program program = some_program(6, 150, 200);
  Streamed s(Machine::tilt_head, program, 1.0);
  s.push();
  bool was_held = false;
  s.clock.meanwhile = [&](std::size_t period) {
    s.push();
    if (period < 500 || period > 3500) s.read();
    was_held = was_held || s.stream.held_for_reader();
    // Whose hold it is matters: this one stays when the reader is back.
    if (period == 3400) s.stream.hold();
    if (period == 4400) {
      EXPECT_EQ(s.stream.state(), State::holding);
      EXPECT_FALSE(s.stream.held_for_reader());
      s.stream.resume();
    }
  };
  s.stream.run(s.clock);
  while (s.stream.wait()) s.read();
  const StreamReport& report = s.stream.report();
  EXPECT_TRUE(was_held);
  EXPECT_EQ(report.reader_holds, 1U);
  EXPECT_GT(report.overruns, 1000U);  // at rest
  EXPECT_EQ(report.overruns_in_motion, 0U);
  EXPECT_EQ(report.periods, s.setpoints.size() + report.overruns);
  // Set-points at rest are missing: as if time had stood still.
  for (std::size_t i = 0; i < s.setpoints.size(); ++i) {
    s.setpoints[i].sample.time_s = static_cast<double>(i) * s.options.sample_period_s;
  }
  expect_no_violation(s, false);
  EXPECT_EQ(s.setpoints.back().state, State::finished);
}

// Blocks that come too slowly are seen.
TEST(SetpointStream, CountsStarvedSetpoints) {
  const program::Program program = some_program(7, 400, 400);
  Streamed s(Machine::tilt_head, program);
  s.clock.meanwhile = [&](std::size_t period) {
    s.read();
    if (period % 100 == 0 && s.block < program.blocks.size() && s.path.push(program.blocks[s.block]).accepted())
      ++s.block;
    if (s.block == program.blocks.size()) static_cast<void>(s.path.finish());
  };
  s.stream.run(s.clock);
  while (s.stream.wait()) s.read();
  EXPECT_GT(s.stream.report().starved, 1000U);
  EXPECT_LT(s.stream.report().starved, s.stream.report().periods);
  EXPECT_EQ(s.stream.report().overruns, 0U);
  expect_no_violation(s, true);
}

TEST(DelayStatistics, QuantilesAndMean) {
  DelayStatistics none;
  EXPECT_EQ(none.quantile_s(0.99), 0.0);
  EXPECT_EQ(none.mean_s(), 0.0);
  DelayStatistics some;
  for (int us = 1; us <= 1000; ++us) some.add(us * std::int64_t{1000} - 1);
  EXPECT_NEAR(some.quantile_s(0.5), 500e-6, 1e-12);
  EXPECT_NEAR(some.quantile_s(0.999), 999e-6, 1e-12);
  EXPECT_NEAR(some.quantile_s(1.0), 1000e-6, 2e-9);
  EXPECT_NEAR(some.mean_s(), 500.5e-6, 2e-9);
  some.add(-5);  // before its time: none
  some.add(40 * ms_ns + 1);
  some.add(100'000 * ms_ns);
  EXPECT_NEAR(some.quantile_s(1002.0 / 1003.0), 41e-3, 1e-9);
  EXPECT_EQ(some.quantile_s(1.0), 100.0);
  EXPECT_EQ(some.max_s(), 100.0);
}

TEST(SetpointStream, RejectsBadOptions) {
  const program::Program program = test::s_path();
  Streamed s(Machine::hybrid, program);
  const auto make = [&](double period_s, double ring_s) {
    SetpointStream stream(s.path, {.period_s = period_s, .ring_s = ring_s});
  };
  EXPECT_EQ(robomill::test::field_of([&] { make(0.001, 4.0); }), "accepted");
  EXPECT_EQ(robomill::test::field_of([&] { make(0.0, 4.0); }), "period_s");
  EXPECT_EQ(robomill::test::field_of([&] { make(std::nan(""), 4.0); }), "period_s");
  EXPECT_EQ(robomill::test::field_of([&] { make(0.001, 0.0); }), "ring_s");
  EXPECT_EQ(robomill::test::field_of([&] { make(0.001, 1e9); }), "ring_s");
}

TEST(Scheduling, SaysWhatItWasNotGranted) {
  Scheduling found;
  std::thread([&] { schedule_first(found); }).join();
  EXPECT_EQ(found.first_in_first_out, found.why_not.empty());
  EXPECT_EQ(found.first_in_first_out, found.priority > 0);
}

}  // namespace setpoint_stream_test
}  // namespace robomill::path
