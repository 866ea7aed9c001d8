#include "robomill/path/interpolator.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>

#include "robomill/path/speed/planner.hpp"
#include "testing/allocations.hpp"
#include "testing/path/mixed_program.hpp"
#include "testing/path/ride.hpp"
#include "testing/support.hpp"

namespace robomill::path {
namespace interpolator_test {

using test::Machine;
using Status = PathInterpolator::Pushed::Status;
using State = PathInterpolator::State;

SmoothingOptions options() {
  return test::published_options(Method::verified);
}

program::Block move_to(double x_m, double duration_s) {
  return {.kind = program::Block::Kind::feed, .line = 7, .end = {.tip_m = {x_m, 0.0, 0.0}}, .duration_s = duration_s};
}

/// A tilt head at the origin that is given one straight program.
struct Straight {
  explicit Straight(const SmoothingOptions& smoothing = options())
      : machine(test::tilt_head_limits()),
        path(machine, smoothing, {}, 0.0, (robot::Position6() << 0.0, 0.0, 0.15, 0.0, 0.0, 0.0).finished(),
             {.look_ahead_s = 20.0}) {}
  State next() {
    const State state = path.next(sample);
    speed_m_per_s = (sample.tip_m.x() - x_m) / 0.001;
    x_m = sample.tip_m.x();
    return state;
  }
  /// Runs until the tool rests or finishes; the number of cycles.
  int run_to_rest() {
    int n = 0;
    while (next() == State::running && n < 100'000) ++n;
    return n;
  }
  test::TiltHead machine;
  PathInterpolator path;
  Sample sample;
  double x_m = 0.0, speed_m_per_s = 0.0;
};

static_assert(noexcept(std::declval<PathInterpolator&>().next(std::declval<Sample&>())));
static_assert(noexcept(std::declval<PathInterpolator&>().push(std::declval<const program::Block&>())));
static_assert(noexcept(std::declval<PathInterpolator&>().push(std::declval<const program::Block&>(), 0.0)));
static_assert(noexcept(std::declval<PathInterpolator&>().finish()));
static_assert(noexcept(std::declval<PathInterpolator&>().hold()));
static_assert(noexcept(std::declval<PathInterpolator&>().resume()));
static_assert(noexcept(std::declval<PathInterpolator&>().stop()));
static_assert(noexcept(std::declval<PathInterpolator&>().set_override(1.0)));

// The samples lie on the planner's own path, and the last one where the program ends.
TEST(PathInterpolator, RunsThePlannersPathToTheProgramsEnd) {
  for (const Machine kind : {Machine::tilt_head, Machine::hybrid, Machine::kr210}) {
    const auto machine = test::make_machine(kind);
    const program::Program program = test::s_path();
    const Posture posture = test::posture_for(program, *machine);
    PathInterpolator path(*machine, options(), program.start, posture.gamma_rad[0], posture.start);
    Random random(1);
    const test::Rode rode = test::ride(path, program, {}, random);
    ASSERT_EQ(rode.state, State::finished);
    EXPECT_LT((rode.samples.back().tip_m - program.blocks.back().end.tip_m).norm(), 1e-15);
    EXPECT_LT((rode.samples.back().axis - program.blocks.back().end.axis).norm(), 1e-15);
    Planner planner(*machine, options(), PlannerOptions::interpolated());
    planner.begin(program.start, posture.gamma_rad[0], posture.start);
    std::vector<Polynomial> pieces;
    const auto take = [&] {
      pieces.insert(pieces.end(), planner.path().begin(), planner.path().end());
      planner.path().clear();
      planner.motion().clear();
    };
    for (std::size_t i = 0; i < program.blocks.size(); ++i) {
      ASSERT_TRUE(planner.push(program.blocks[i], i, posture.gamma_rad[0]).ok());
      take();
    }
    ASSERT_TRUE(planner.finish().ok());
    take();
    std::size_t piece = 0;
    double before_m = 0.0;
    for (const Sample& sample : rode.samples) {
      ASSERT_GE(sample.path_m, before_m);
      before_m = sample.path_m;
      while (piece + 1 < pieces.size() && pieces[piece + 1].begin_m <= sample.path_m) ++piece;
      const robot::ToolPose pose = pieces[piece].pose(sample.path_m - pieces[piece].begin_m);
      ASSERT_EQ((pose.tip_m - sample.tip_m).norm(), 0.0);
      ASSERT_EQ((pose.axis - sample.axis).norm(), 0.0);
    }
    EXPECT_EQ(test::check(program, *machine, options(), rode.samples).violations(), 0U);
  }
}

TEST(PathInterpolator, MovesBeforeTheProgramIsRead) {
  const auto machine = test::make_machine(Machine::tilt_head);
  Random random(2);
  const program::Program program =
      test::mixed_program(random, {.least_blocks = 1500, .most_blocks = 1500, .half_box_m = 0.02});
  const Posture posture = test::posture_for(program, *machine);
  PathInterpolator path(*machine, options(), program.start, 0.0, posture.start);
  const test::Rode rode = test::ride(path, program, {.blocks = 1.0}, random);
  ASSERT_EQ(rode.state, State::finished);
  EXPECT_LT(rode.read_at_first_motion, 300U);
  EXPECT_EQ(test::check(program, *machine, options(), rode.samples).violations(), 0U);
}

TEST(PathInterpolator, HoldsAndGoesOn) {
  Straight s;
  ASSERT_TRUE(s.path.push(move_to(0.1, 2.0)).accepted());
  ASSERT_TRUE(s.path.finish().accepted());
  while (s.x_m < 0.03) ASSERT_EQ(s.next(), State::running);
  EXPECT_GT(s.speed_m_per_s, 0.0495);
  s.path.hold();
  const double from_m = s.x_m;
  const int cycles = s.run_to_rest();
  EXPECT_EQ(s.next(), State::holding);
  // The shortest stop from 50 mm/s with 500 mm/s² and 10,000 mm/s³ takes 150 ms and 3.75 mm.
  EXPECT_LT(cycles, 330);
  EXPECT_LT(s.x_m - from_m, 0.0095);
  for (int i = 0; i < 1000; ++i) {
    EXPECT_EQ(s.next(), State::holding);
    EXPECT_EQ(s.speed_m_per_s, 0.0);
  }
  EXPECT_EQ(s.path.feed_override(), 0.0);
  s.path.resume();
  s.run_to_rest();
  EXPECT_EQ(s.next(), State::finished);
  EXPECT_EQ(s.x_m, 0.1);
}

// The same way to rest as a hold, sample by sample, and no way on.
TEST(PathInterpolator, StopsForGood) {
  Straight held, stopped;
  for (Straight* const s : {&held, &stopped}) {
    ASSERT_TRUE(s->path.push(move_to(0.1, 2.0)).accepted());
    ASSERT_TRUE(s->path.push({.kind = program::Block::Kind::dwell, .end = {}, .duration_s = 1.0}).accepted());
    ASSERT_TRUE(s->path.push(move_to(0.2, 2.0)).accepted());
    for (int i = 0; i < 800; ++i) ASSERT_EQ(s->next(), State::running);
  }
  held.path.hold();
  stopped.path.stop();
  EXPECT_EQ(stopped.path.push(move_to(0.3, 2.0)).status, Status::closed);
  for (int i = 0; i < 1000; ++i) {
    const State state = held.next();
    ASSERT_EQ(stopped.next(), state == State::holding ? State::stopped : state);
    ASSERT_EQ(stopped.sample.tip_m, held.sample.tip_m);
    ASSERT_EQ(stopped.sample.time_s, held.sample.time_s);
  }
  const double x_m = stopped.x_m;
  EXPECT_GT(x_m, 0.0);
  EXPECT_LT(x_m, 0.1);
  stopped.path.resume();
  stopped.path.set_override(1.5);
  for (int i = 0; i < 100; ++i) {
    ASSERT_EQ(stopped.next(), State::stopped);
    ASSERT_EQ(stopped.x_m, x_m);
  }
  EXPECT_NEAR(stopped.sample.time_s, 1.899, 1e-9);
}

// Before it has moved, in a dwell, while it waits for blocks, and at the end, where there is nothing to stop.
TEST(PathInterpolator, StopsAtRestAtOnce) {
  Straight begun;
  ASSERT_TRUE(begun.path.push(move_to(0.1, 2.0)).accepted());
  begun.path.stop();
  EXPECT_EQ(begun.next(), State::stopped);
  Straight dwelling;
  ASSERT_TRUE(dwelling.path.push({.kind = program::Block::Kind::dwell, .end = {}, .duration_s = 1.0}).accepted());
  ASSERT_TRUE(dwelling.path.push(move_to(0.1, 2.0)).accepted());
  ASSERT_TRUE(dwelling.path.finish().accepted());
  for (int i = 0; i < 500; ++i) dwelling.next();
  dwelling.path.stop();
  for (int i = 0; i < 1000; ++i) ASSERT_EQ(dwelling.next(), State::stopped);
  EXPECT_EQ(dwelling.x_m, 0.0);
  Straight waiting;
  EXPECT_EQ(waiting.next(), State::waiting);
  waiting.path.stop();
  EXPECT_EQ(waiting.next(), State::stopped);
  Straight finished;
  ASSERT_TRUE(finished.path.push(move_to(0.01, 0.5)).accepted());
  ASSERT_TRUE(finished.path.finish().accepted());
  finished.run_to_rest();
  finished.path.stop();
  EXPECT_EQ(finished.next(), State::finished);
}

// Only where blocks are missing: not at the end, not where it is held.
TEST(PathInterpolator, KnowsWhenBlocksAreMissing) {
  Straight s;
  EXPECT_EQ(s.next(), State::waiting);
  EXPECT_TRUE(s.path.starved());
  s.path.hold();
  EXPECT_EQ(s.next(), State::holding);
  EXPECT_FALSE(s.path.starved());
  s.path.resume();
  ASSERT_TRUE(s.path.push(move_to(0.01, 0.5)).accepted());
  ASSERT_TRUE(s.path.finish().accepted());
  do {
    ASSERT_NE(s.next(), State::waiting);
    ASSERT_FALSE(s.path.starved());
  } while (s.x_m < 0.01);
  EXPECT_EQ(s.next(), State::finished);
  EXPECT_FALSE(s.path.starved());
}

TEST(PathInterpolator, OverrideScalesTheFeedUpToTheLimits) {
  // At a programmed 20 mm/s of 50 possible; at last 45.
  const std::pair<double, double> cases[] = {{0.3, 0.006}, {1.0, 0.02}, {1.5, 0.03}, {7.0, 0.03}};
  Straight s;
  ASSERT_TRUE(s.path.push(move_to(0.1, 5.0)).accepted());
  ASSERT_TRUE(s.path.push(move_to(0.3, 0.2 / 0.045)).accepted());
  ASSERT_TRUE(s.path.finish().accepted());
  for (const auto& [share, feed] : cases) {
    s.path.set_override(share);
    for (int i = 0; i < 600; ++i) s.next();
    EXPECT_NEAR(s.speed_m_per_s, 0.998 * feed, 1e-5) << share;
  }
  s.path.set_override(std::numeric_limits<double>::quiet_NaN());  // stays
  for (int i = 0; i < 10; ++i) s.next();
  EXPECT_NEAR(s.speed_m_per_s, 0.998 * 0.03, 1e-5);
  while (s.x_m < 0.2) s.next();
  EXPECT_GT(s.speed_m_per_s, 0.048);  // 67.5 mm/s were asked for
  EXPECT_LE(s.speed_m_per_s, 0.05);
  s.path.set_override(0.0);
  s.run_to_rest();
  EXPECT_EQ(s.next(), State::holding);
  s.path.set_override(1.0);
  s.run_to_rest();
  EXPECT_EQ(s.x_m, 0.3);
}

// A look-ahead that runs dry: a stop along the path, and on when blocks come.
TEST(PathInterpolator, WaitsForBlocksAtRest) {
  const auto machine = test::make_machine(Machine::hybrid);
  Random random(4);
  const program::Program program = test::mixed_program(random, {.least_blocks = 700, .most_blocks = 700});
  const Posture posture = test::posture_for(program, *machine);
  PathInterpolator path(*machine, options(), program.start, 0.0, posture.start);
  std::vector<Sample> samples;
  State state = State::waiting;
  std::size_t at = 0, dry = 0;
  Sample sample;
  while (at < program.blocks.size()) {
    // Some hundred blocks, and then nothing until the tool has come to rest.
    for (const std::size_t to = std::min(program.blocks.size(), at + 150); at < to;) {
      const PathInterpolator::Pushed pushed = path.push(program.blocks[at]);
      if (pushed.accepted()) {
        ++at;
        continue;
      }
      ASSERT_EQ(pushed.status, Status::full);
      path.next(sample);
      samples.push_back(sample);
    }
    int still = 0;
    for (int i = 0; i < 200'000 && still < 100; ++i) {
      state = path.next(sample);
      still = state == State::waiting ? still + 1 : 0;
      samples.push_back(sample);
    }
    ASSERT_EQ(state, State::waiting);
    if (samples.back().path_m > 0.0) {
      ++dry;
      EXPECT_EQ(samples.back().path_m, samples[samples.size() - 90].path_m);
    }
  }
  EXPECT_GE(dry, 3U);
  while (!path.finish().accepted()) {
    path.next(sample);
    samples.push_back(sample);
  }
  while (path.next(sample) != State::finished) samples.push_back(sample);
  samples.push_back(sample);
  EXPECT_EQ(test::check(program, *machine, options(), samples).violations(), 0U);
}

// Dwells go by the clock.
TEST(PathInterpolator, DwellsAsLongAsProgrammedAtAnyOverride) {
  for (const double share : {0.4, 1.5}) {
    Straight s;
    s.path.set_override(share);
    const program::Block dwell{.kind = program::Block::Kind::dwell, .end = {}, .duration_s = 0.25};
    for (const program::Block& block : {dwell, move_to(0.002, 0.1), dwell, dwell, move_to(0.004, 0.1), dwell}) {
      ASSERT_TRUE(s.path.push(block).accepted());
    }
    ASSERT_TRUE(s.path.finish().accepted());
    int still[3] = {};
    for (State state = State::running; state != State::finished;) {
      state = s.next();
      for (int i = 0; i < 3; ++i) still[i] += s.x_m == 0.002 * i && s.speed_m_per_s == 0.0 ? 1 : 0;
    }
    for (const auto& [cycles, least] : {std::pair{still[0], 250}, {still[1], 500}, {still[2], 250}}) {
      EXPECT_GE(cycles, least);
      EXPECT_LE(cycles, least + 5);
    }
  }
}

TEST(PathInterpolator, AllocatesNothing) {
  const auto machine = test::make_machine(Machine::kr210);
  Random random(6);
  const program::Program program = test::mixed_program(random, {.least_blocks = 600, .most_blocks = 600});
  const Posture posture = test::posture_for(program, *machine);
  PathInterpolator path(*machine, options(), program.start, posture.gamma_rad[0], posture.start);
  State state = State::waiting;
  const std::size_t taken = robomill::test::allocations([&] {
    Sample sample;
    std::size_t at = 0;
    for (int n = 0; n < 1'000'000 && state != State::finished; ++n) {
      if (at == program.blocks.size()) {
        static_cast<void>(path.finish());
      } else if (path.push(program.blocks[at]).accepted()) {
        ++at;
      }
      state = path.next(sample);
    }
  });
  EXPECT_EQ(state, State::finished);
  EXPECT_EQ(taken, 0U);
}

// Much longer than what is held: the look-ahead fills, and takes more as the tool moves on.
TEST(PathInterpolator, StreamsAnyNumberOfBlocksThroughTheSameMemory) {
  SmoothingOptions wide = options();
  wide.tip_tolerance_m = 5e-4;
  wide.max_velocity_m_per_s = 0.5;
  wide.max_acceleration_m_per_s2 = 4.0;
  wide.max_jerk_m_per_s3 = 80.0;
  Straight s(wide);
  const int blocks = robomill::test::seeds(1'000'000);
  const auto at = [](int i) { return Eigen::Vector3d(0.2 * std::sin(1e-3 * i), 0.2 * std::sin(1.7e-3 * i), 0.0); };
  std::size_t fulls = 0;
  bool sound = true;
  const std::size_t taken = robomill::test::allocations([&] {
    program::Block block;
    for (int i = 1; i <= blocks && sound;) {
      block.end.tip_m = at(i);
      block.duration_s = 0.002;
      block.line = static_cast<std::size_t>(i);
      const Status status = s.path.push(block).status;
      sound = status == Status::accepted || status == Status::full;
      i += status == Status::accepted ? 1 : 0;
      fulls += status == Status::full ? 1 : 0;
      if (status == Status::full) s.next();
    }
    while (sound && !s.path.finish().accepted()) s.next();
    while (sound && s.next() != State::finished) {
    }
  });
  EXPECT_TRUE(sound);
  EXPECT_EQ(taken, 0U);
  EXPECT_GT(fulls, 100U);
  EXPECT_LT((s.sample.tip_m - at(blocks)).norm(), 1e-12);
}

TEST(PathInterpolator, StopsWithinLimitsBeforeWhatCannotBeReached) {
  const test::TiltHead machine(test::tilt_head_limits());
  program::Program program;
  for (int i = 1; i <= 400; ++i) {
    program::Block block = move_to(0.004 * i, 0.1);
    block.line = static_cast<std::size_t>(i) + 10;
    program.blocks.push_back(block);
  }
  PathInterpolator path(machine, options(), {}, 0.0, (robot::Position6() << 0.0, 0.0, 0.15, 0.0, 0.0, 0.0).finished());
  Random random(8);
  const test::Rode rode = test::ride(path, program, {}, random);
  EXPECT_EQ(rode.state, State::stopped);
  EXPECT_EQ(rode.pushed.status, Status::unreachable);
  EXPECT_EQ(rode.pushed.reach.status, robot::Reach::Status::outside_limits);
  EXPECT_EQ(rode.pushed.reach.joint, 0);
  EXPECT_EQ(rode.pushed.block, 250U);  // the one that begins at 1 m
  EXPECT_EQ(rode.pushed.line, 261U);
  EXPECT_GT(rode.samples.back().tip_m.x(), 0.5);
  EXPECT_LE(rode.samples.back().tip_m.x(), 1.0);
  EXPECT_EQ(path.push(program.blocks[0]).status, Status::unreachable);
  EXPECT_EQ(path.finish().status, Status::unreachable);
  const CheckResult result = test::check(program, machine, options(), rode.samples);
  EXPECT_EQ(result.tip_velocity.violations + result.tip_acceleration.violations + result.tip_jerk.violations, 0U);
}

TEST(PathInterpolator, RejectsBadBlocksAndGoesOn) {
  Straight s;
  program::Block bad = move_to(std::numeric_limits<double>::quiet_NaN(), 1.0);
  EXPECT_EQ(s.path.push(bad).status, Status::invalid);
  bad = move_to(0.1, -1.0);
  EXPECT_EQ(s.path.push(bad).status, Status::invalid);
  bad = move_to(0.1, 1.0);
  bad.end.axis = {0.0, 0.0, 2.0};
  EXPECT_EQ(s.path.push(bad).status, Status::invalid);
  bad.end.axis = {0.0, 0.0, 1.0};
  EXPECT_EQ(s.path.push(bad, std::numeric_limits<double>::infinity()).status, Status::invalid);
  EXPECT_EQ(s.path.push(bad).line, 7U);
  EXPECT_TRUE(s.path.finish().accepted());
  EXPECT_EQ(s.path.push(bad).status, Status::closed);
  s.run_to_rest();
  EXPECT_EQ(s.next(), State::finished);
  EXPECT_EQ(s.x_m, 0.1);
  Straight other;
  bad.end.axis = {0.0, 0.0, -1.0};
  EXPECT_EQ(other.path.push(bad).status, Status::antipodal);
  Straight none;
  EXPECT_EQ(none.next(), State::waiting);
  EXPECT_TRUE(none.path.finish().accepted());
  EXPECT_EQ(none.next(), State::finished);
  EXPECT_EQ(none.x_m, 0.0);
}

TEST(PathInterpolator, RejectsBadOptions) {
  const test::TiltHead machine(test::tilt_head_limits());
  const auto make = [&](const SmoothingOptions& smoothing, const InterpolatorOptions& ahead, double x_m) {
    PathInterpolator path(machine, smoothing, {.tip_m = {x_m, 0.0, 0.0}}, 0.0, robot::Position6::Zero(), ahead);
  };
  EXPECT_EQ(robomill::test::field_of([&] { make(options(), {}, 0.0); }), "accepted");
  EXPECT_EQ(robomill::test::field_of([&] { make({}, {}, 0.0); }), "tip_tolerance_m");
  EXPECT_EQ(robomill::test::field_of([&] { make(options(), {.look_ahead_s = 0.0}, 0.0); }), "look_ahead_s");
  EXPECT_EQ(robomill::test::field_of([&] { make(options(), {.look_ahead_segments = 3}, 0.0); }), "look_ahead_segments");
  EXPECT_EQ(robomill::test::field_of([&] { make(options(), {}, 2.0); }), "start");
}

}  // namespace interpolator_test
}  // namespace robomill::path
