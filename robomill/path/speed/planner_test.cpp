#include "robomill/path/speed/planner.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/path/emitter.hpp"
#include "robomill/robot/hybrid.hpp"
#include "testing/allocations.hpp"
#include "testing/path/machine.hpp"
#include "testing/path/random_program.hpp"
#include "testing/path/s_path.hpp"
#include "testing/support.hpp"

namespace robomill::path {
namespace planner_test {

using robomill::test::field_of;
using robomill::test::seeds;
using test::random_program;
using Kind = Planner::Status::Kind;

static_assert(noexcept(std::declval<Planner&>().push(std::declval<const program::Block&>(), 0, 0.0)));
static_assert(noexcept(std::declval<Planner&>().resume()) && noexcept(std::declval<Planner&>().finish()));
static_assert(noexcept(std::declval<Planner&>().begin(std::declval<const program::Pose&>(), 0.0,
                                                      std::declval<const robot::Position6&>())));

SmoothingOptions options() {
  return test::published_options(Method::verified);
}

const test::TiltHead& head() {
  static const test::TiltHead machine(test::tilt_head_limits());
  return machine;
}

/// All that a planner makes of a program.
struct Made {
  Planner::Status status;
  std::vector<Segment> motion;
  std::vector<Polynomial> path;
  std::size_t most_held = 0, most_motion = 0, most_path = 0;
  [[nodiscard]] double time_s() const {
    double sum = 0.0;
    for (const Segment& segment : motion) sum += duration_s(segment);
    return sum;
  }
};

/// @param take  gets motion and path each time that there is some
template <class Take>
Planner::Status run(Planner& planner, const program::Program& program, Take&& take) {
  Planner::Status status = planner.begin(program.start, 0.0, robot::Position6::Zero());
  const auto hold = [&] {
    take(planner);
    planner.motion().clear();
    planner.path().clear();
    while (status.ok() && planner.busy()) {
      status = planner.resume();
      take(planner);
      planner.motion().clear();
      planner.path().clear();
    }
  };
  for (std::size_t i = 0; status.ok() && i < program.blocks.size(); ++i) {
    status = planner.push(program.blocks[i], i, 0.0);
    hold();
  }
  if (!status.ok()) return status;
  status = planner.finish();
  hold();
  return status;
}

Made make(const program::Program& program, const robot::Kinematics& machine, const SmoothingOptions& o,
          const PlannerOptions& planner_options) {
  Planner planner(machine, o, planner_options);
  Made out;
  out.status = run(planner, program, [&](Planner& at) {
    out.motion.insert(out.motion.end(), at.motion().begin(), at.motion().end());
    out.path.insert(out.path.end(), at.path().begin(), at.path().end());
    out.most_held = std::max(out.most_held, at.held());
    out.most_motion = std::max(out.most_motion, at.motion().size());
    out.most_path = std::max(out.most_path, at.path().size());
  });
  return out;
}

void expect_whole(const Made& made) {
  ASSERT_TRUE(made.status.ok()) << static_cast<int>(made.status.kind) << " in block " << made.status.block;
  ASSERT_FALSE(made.motion.empty());
  EXPECT_EQ(made.motion.front().kind, Segment::Kind::from_rest);
  const Polynomial& end = made.path.back();
  double u_m = 0.0, b = 0.0;
  for (std::size_t i = 0; i < made.motion.size(); ++i) {
    const Segment& segment = made.motion[i];
    ASSERT_NEAR(segment.begin_m, u_m, 1e-12) << i;
    ASSERT_NEAR(segment.begin_b, b, 1e-12 * b) << i << " of " << made.motion.size();
    if (segment.kind == Segment::Kind::cruise) {
      ASSERT_GT(segment.middle_b, 0.0);
      // b' joins too.
      if (i > 0 && made.motion[i - 1].kind == Segment::Kind::cruise) {
        const Segment& before = made.motion[i - 1];
        const double in = (before.end_b - before.middle_b) / before.length_m;
        const double out = (segment.middle_b - segment.begin_b) / segment.length_m;
        ASSERT_NEAR(in, out, 1e-7 * (before.end_b / before.length_m + segment.begin_b / segment.length_m)) << i;
      }
    }
    u_m = segment.begin_m + segment.length_m;
    b = segment.end_b;
  }
  EXPECT_NEAR(u_m, end.begin_m + end.length_m, 1e-12);
  EXPECT_EQ(b, 0.0);
  for (std::size_t i = 0; i + 1 < made.path.size(); ++i) {
    ASSERT_NEAR(made.path[i].begin_m + made.path[i].length_m, made.path[i + 1].begin_m, 1e-13);
    ASSERT_LT((made.path[i].pose(made.path[i].length_m).tip_m - made.path[i + 1].pose(0.0).tip_m).norm(), 1e-13);
  }
}

/// A wavy line of dense blocks.
program::Program dense(std::size_t blocks, double step_m) {
  program::Program out;
  const auto pose = [&](std::size_t i) {
    const double s = step_m * static_cast<double>(i);
    program::Pose at;
    at.tip_m = {0.05 * std::cos(20.0 * s), 0.05 * std::sin(20.0 * s), 0.004 * std::sin(300.0 * s)};
    at.axis = Eigen::Vector3d(0.2 * std::sin(25.0 * s), 0.15 * std::cos(40.0 * s), 1.0).normalized();
    return at;
  };
  out.start = pose(0);
  for (std::size_t i = 1; i <= blocks; ++i) {
    out.blocks.push_back({.line = i, .end = pose(i)});
    const double way_m = (out.blocks.back().end.tip_m - out.begin_of(i - 1).tip_m).norm();
    out.blocks.back().duration_s = way_m / 0.05;
  }
  return out;
}

/// The largest share of the joints' and the tool's limits, by exact derivatives at 7 places of each segment.
double used(const Made& made, const robot::Kinematics& machine, const SmoothingOptions& o) {
  double out = 0.0;
  std::size_t at = 0;
  robot::Position6 near = robot::Position6::Zero();
  for (const Segment& segment : made.motion) {
    if (segment.kind != Segment::Kind::cruise) continue;
    for (const double s : {0.02, 0.2, 0.35, 0.5, 0.65, 0.8, 0.98}) {
      const double u_m = segment.begin_m + s * segment.length_m, r = 1.0 - s, d = segment.length_m;
      while (at + 1 < made.path.size() && made.path[at + 1].begin_m <= u_m) ++at;
      robot::JointJet q;
      const robot::ToolJet tool = made.path[at].jet(u_m - made.path[at].begin_m);
      EXPECT_EQ(machine.follow(tool, near, q).status, robot::Reach::Status::found);
      near = q.col(0);
      const double b = r * r * segment.begin_b + 2.0 * r * s * segment.middle_b + s * s * segment.end_b;
      const double b1 = 2.0 / d * (r * (segment.middle_b - segment.begin_b) + s * (segment.end_b - segment.middle_b));
      const double b2 = 2.0 / (d * d) * (segment.begin_b - 2.0 * segment.middle_b + segment.end_b), v = std::sqrt(b);
      const robot::Position6 velocity = q.col(1) * v, acceleration = q.col(2) * b + q.col(1) * 0.5 * b1,
                             jerk = v * (q.col(3) * b + 1.5 * q.col(2) * b1 + 0.5 * q.col(1) * b2);
      for (int k = 0; k < machine.joints(); ++k) {
        out = std::max({out, std::abs(velocity[k]) / machine.limits().max_velocity[k],
                        std::abs(acceleration[k]) / machine.limits().max_acceleration[k],
                        std::abs(jerk[k]) / machine.limits().max_jerk[k]});
      }
      out = std::max(out, tool.tip_m.col(1).norm() * v / o.max_velocity_m_per_s);
      out = std::max(out, tool.axis.col(1).norm() * v / o.max_angular_velocity_rad_per_s);
    }
  }
  return out;
}

TEST(Planner, WindowsHardlyCostTime) {
  const robot::HybridKinematics machine(test::s_machine(2.0, 40.0));
  const program::Program s_path = test::s_path();
  const program::Program programs[] = {s_path, dense(1500, 3e-4)};
  for (const program::Program& program : programs) {
    PlannerOptions whole{.window = 20000, .commit = 16000};
    const Made best = make(program, machine, options(), whole);
    ASSERT_NO_FATAL_FAILURE(expect_whole(best));
    for (const PlannerOptions& o :
         {PlannerOptions{}, PlannerOptions{.window = 500, .commit = 350}, PlannerOptions::real_time()}) {
      const Made made = make(program, machine, options(), o);
      ASSERT_NO_FATAL_FAILURE(expect_whole(made)) << o.window;
      EXPECT_LT(made.time_s(), 1.02 * best.time_s()) << o.window << " segments";
      EXPECT_GT(made.time_s(), 0.99 * best.time_s()) << o.window << " segments";
    }
  }
}

TEST(Planner, LimitsHoldBetweenThePointsToo) {
  const robot::HybridKinematics machine(test::s_machine(2.0, 40.0));
  for (const program::Program& program : {test::s_path(), dense(600, 3e-4)}) {
    const Made made = make(program, machine, options(), {});
    ASSERT_NO_FATAL_FAILURE(expect_whole(made));
    EXPECT_LT(used(made, machine, options()), 1.03);
    EXPECT_GT(used(made, machine, options()), 0.95);
  }
}

/// Plans row by row; in each proposed row some 2 mm are asked to run at 0.8 of all speeds.
/// @param asked  gets where
Made make_revised(const program::Program& program, const robot::Kinematics& machine, const PlannerOptions& how,
                  std::vector<double>& asked) {
  SpeedCorrections corrections;
  Planner planner(machine, options(), how, &corrections, Planner::Task::proposals);
  Made out;
  out.status = run(planner, program, [&](Planner& at) {
    if (at.proposes()) {
      EXPECT_FALSE(at.revise());  // nothing is asked
      const std::vector<Segment> before = at.motion();
      const Segment& middle = before[at.kept() / 2];
      const auto cell = static_cast<std::int64_t>(middle.begin_m * SpeedCorrections::cells_per_m);
      for (std::int64_t i = cell; i < cell + 10; ++i) corrections.speed.emplace(i, 0.8);
      EXPECT_TRUE(at.revise());
      asked.push_back(middle.begin_m);
      EXPECT_EQ(at.motion().size(), before.size());
      for (std::size_t i = 0; i < before.size(); ++i) {
        EXPECT_EQ(at.motion()[i].begin_m, before[i].begin_m);
        if (how.local_slow_down && i > 0 && i + 1 < before.size() && !at.suspect(i - 1) && !at.suspect(i) &&
            !at.suspect(i + 1)) {
          EXPECT_NEAR(at.motion()[i].middle_b, before[i].middle_b, 1e-3 * before[i].middle_b);
        }
      }
    }
    out.motion.insert(out.motion.end(), at.motion().begin(),
                      at.motion().begin() + static_cast<std::ptrdiff_t>(at.kept()));
    out.path.insert(out.path.end(), at.path().begin(), at.path().end());
  });
  return out;
}

TEST(Planner, RevisesWhatItProposes) {
  const robot::HybridKinematics machine(test::s_machine(2.0, 40.0));
  const program::Program program = dense(1500, 3e-4);
  const Made plain = make(program, machine, options(), {});
  for (const bool local_slow_down : {true, false}) {
    std::vector<double> asked;
    PlannerOptions how;
    how.local_slow_down = local_slow_down;
    const Made made = make_revised(program, machine, how, asked);
    ASSERT_NO_FATAL_FAILURE(expect_whole(made));
    EXPECT_LT(used(made, machine, options()), 1.03);
    ASSERT_GT(asked.size(), 1U);
    // As slow as asked there, hardly slower than without in all.
    for (const double at_m : asked) {
      const auto segment = std::ranges::upper_bound(made.motion, at_m + 1e-3, {}, &Segment::begin_m) - 1;
      const auto plainly = std::ranges::upper_bound(plain.motion, at_m + 1e-3, {}, &Segment::begin_m) - 1;
      EXPECT_LT(segment->middle_b, 0.7 * plainly->middle_b);
    }
    EXPECT_GT(made.time_s(), plain.time_s());
    EXPECT_LT(made.time_s(), plain.time_s() + 0.15 * static_cast<double>(asked.size()));
  }
}

TEST(Planner, PlansRandomPrograms) {
  for (int seed = 0; seed < seeds(100); ++seed) {
    Random random(31, static_cast<std::uint64_t>(seed));
    const program::Program program =
        random_program(random, {.blocks = 80, .max_m = seed % 2 == 0 ? 0.02 : 1e-3, .max_lean_rad = 0.5});
    const Made made = make(program, head(), options(), seed % 3 == 0 ? PlannerOptions::real_time() : PlannerOptions{});
    ASSERT_NO_FATAL_FAILURE(expect_whole(made)) << seed;
  }
}

program::Block dwell(const program::Pose& at, double seconds) {
  return {.kind = program::Block::Kind::dwell, .end = at, .duration_s = seconds};
}

TEST(Planner, DwellsWhereTheProgramDoes) {
  program::Program program;
  const program::Pose a = {.tip_m = {0.01, 0.0, 0.0}}, b = {.tip_m = {0.01, 0.01, 0.0}};
  program.blocks = {{.line = 1, .end = a, .duration_s = 0.2},
                    dwell(a, 0.25),
                    {.line = 3, .end = b, .duration_s = 0.2},
                    dwell(b, 0.5)};
  const Made made = make(program, head(), options(), {});
  ASSERT_NO_FATAL_FAILURE(expect_whole(made));
  std::vector<Segment> dwells;
  for (const Segment& segment : made.motion) {
    if (segment.kind == Segment::Kind::dwell) dwells.push_back(segment);
  }
  ASSERT_EQ(dwells.size(), 2U);
  EXPECT_EQ(dwells[0].dwell_s, 0.25);
  EXPECT_NEAR(dwells[0].begin_m, 0.01, 1e-15);
  EXPECT_EQ(dwells[1].dwell_s, 0.5);
  EXPECT_NEAR(dwells[1].begin_m, 0.02, 1e-15);
  // A stop is exact: the path runs through the corner.
  double miss = 1.0;
  for (const Polynomial& p : made.path) miss = std::min(miss, (p.pose(p.length_m).tip_m - a.tip_m).norm());
  EXPECT_LT(miss, 1e-15);
}

// At the start, one after another, after a block that does not move: all are waited.
TEST(Planner, LosesNoDwell) {
  program::Program program;
  const program::Pose a = {.tip_m = {0.01, 0.0, 0.0}};
  program.blocks = {dwell(program.start, 0.125),
                    {.end = a, .duration_s = 0.2},
                    dwell(a, 0.25),
                    dwell(a, 0.5),
                    {.end = a, .duration_s = 0.1},
                    dwell(a, 1.0),
                    {.end = program.start, .duration_s = 0.2}};
  const Made made = make(program, head(), options(), {});
  ASSERT_TRUE(made.status.ok());
  double sum_s = 0.0;
  for (const Segment& segment : made.motion) sum_s += segment.kind == Segment::Kind::dwell ? segment.dwell_s : 0.0;
  EXPECT_EQ(sum_s, 1.875);
}

// Blocks shorter than anything else: many thousand times the look-ahead's nodes within one segment.
TEST(Planner, TakesBlocksFarShorterThanItsSegments) {
  SmoothingOptions quick = options();
  quick.max_velocity_m_per_s = 0.3;
  quick.max_acceleration_m_per_s2 = 1.0;
  for (const double step_m : {2e-6, 2e-5}) {
    program::Program program;
    for (int i = 1; i <= 3000; ++i)
      program.blocks.push_back({.end = {.tip_m = {step_m * i, 0.0, 0.0}}, .duration_s = step_m / 0.05});
    for (const PlannerOptions& o : {PlannerOptions{}, PlannerOptions::real_time()}) {
      const Made made = make(program, head(), quick, o);
      ASSERT_NO_FATAL_FAILURE(expect_whole(made)) << step_m << ' ' << o.window;
    }
  }
}

// Memory and what is held do not grow with the program; after construction nothing is allocated.
TEST(Planner, RunsInBoundedMemory) {
  const auto all = static_cast<std::size_t>(seeds(200000));
  for (const PlannerOptions& o : {PlannerOptions::real_time(), PlannerOptions{}}) {
    const std::size_t blocks = o.window < 500 ? all : all / 4;
    Planner planner(head(), options(), o);
    const std::size_t motion = planner.motion().capacity(), path = planner.path().capacity();
    EXPECT_EQ(motion, planner.motion_capacity());
    EXPECT_EQ(path, planner.path_capacity());
    Random random(32);
    std::size_t most_held = 0, segments = 0, taken = 0;
    program::Pose at;
    Planner::Status status = planner.begin(at, 0.0, robot::Position6::Zero());
    const auto hold = [&] {
      for (;;) {
        most_held = std::max(most_held, planner.held());
        segments += planner.motion().size();
        EXPECT_EQ(planner.motion().capacity(), motion);
        EXPECT_EQ(planner.path().capacity(), path);
        planner.motion().clear();
        planner.path().clear();
        if (!status.ok() || !planner.busy()) break;
        taken += robomill::test::allocations([&] { status = planner.resume(); });
      }
    };
    double turn = 0.0;
    for (std::size_t i = 0; status.ok() && i < blocks; ++i) {
      // Small steps round about, now and then a reversal, a rotation or a dwell.
      turn += random.uniform() < 0.02 ? 3.1 : random.uniform(-0.1, 0.15);
      program::Block block{.line = i + 1, .end = at};
      block.end.tip_m += random.uniform(5e-5, 1e-3) * Eigen::Vector3d(std::cos(turn), std::sin(turn), 0.0);
      if (block.end.tip_m.norm() > 0.3) block.end.tip_m *= 0.99;
      block.end.axis = program::between(at, {at.tip_m, test::random_lean(random, 0.5)}, 0.01).axis.normalized();
      if (random.uniform() < 0.01) block.end.tip_m = at.tip_m;
      block.duration_s = std::max(1e-4, (block.end.tip_m - at.tip_m).norm() / 0.05);
      if (random.uniform() < 0.001) block = dwell(at, 0.1);
      at = block.end;
      taken += robomill::test::allocations([&] { status = planner.push(block, i, 0.0); });
      ASSERT_TRUE(status.ok()) << i << ' ' << static_cast<int>(status.kind);
      hold();
    }
    taken += robomill::test::allocations([&] { status = planner.finish(); });
    hold();
    EXPECT_TRUE(status.ok());
    EXPECT_EQ(taken, 0U);
    EXPECT_LE(most_held, o.look_ahead + 4 * Blend::max_reach + 64);
    EXPECT_GT(segments, blocks / 4);
  }
}

TEST(Planner, SaysWhatIsWrongAndWhere) {
  {
    Planner planner(head(), options(), {});
    EXPECT_EQ(planner.begin({.tip_m = {2.0, 0.0, 0.0}}, 0.0, robot::Position6::Zero()).kind, Kind::outside_limits);
  }
  {  // Beyond a prismatic joint's travel in block 1: reported with line, joint and amount.
    program::Program program;
    program.blocks = {{.line = 7, .end = {.tip_m = {0.9, 0.0, 0.0}}, .duration_s = 10.0},
                      {.line = 9, .end = {.tip_m = {1.2, 0.0, 0.0}}, .duration_s = 10.0}};
    const Made made = make(program, head(), options(), {});
    EXPECT_EQ(made.status.kind, Kind::outside_limits);
    EXPECT_EQ(made.status.block, 1U);
    EXPECT_EQ(made.status.line, 9U);
    EXPECT_EQ(made.status.reach.joint, 0);
    EXPECT_GT(made.status.reach.beyond, 0.0);
  }
  {  // Below the platform's reach.
    robot::HybridMachine hybrid = test::s_machine(2.0, 40.0);
    hybrid.limits.min_position.setConstant(-10.0);
    hybrid.limits.max_position.setConstant(10.0);
    const robot::HybridKinematics machine(hybrid);
    program::Program program;
    program.blocks = {{.line = 4, .end = {.tip_m = {0.0, 0.0, 0.7}}, .duration_s = 10.0}};
    const Made made = make(program, machine, options(), {});
    EXPECT_FALSE(made.status.ok());
    EXPECT_EQ(made.status.line, 4U);
  }
  {
    program::Program program;
    program.blocks = {
        {.line = 3, .end = {.tip_m = {0.01, 0.0, 0.0}, .axis = -Eigen::Vector3d::UnitZ()}, .duration_s = 1.0}};
    const Made made = make(program, head(), options(), {});
    EXPECT_EQ(made.status.kind, Kind::antipodal);
    EXPECT_EQ(made.status.block, 0U);
    EXPECT_EQ(made.status.line, 3U);
  }
  SmoothingOptions bad = options();
  bad.tip_tolerance_m = 0.0;
  EXPECT_EQ(field_of([&] { Planner(head(), bad, {}); }), "tip_tolerance_m");
}

// The samples lie on the path, at rest at both ends, and their number is the time's.
TEST(Emitter, RunsAlongTheMotion) {
  const program::Program program = dense(200, 3e-4);
  const Made made = make(program, head(), options(), {});
  ASSERT_NO_FATAL_FAILURE(expect_whole(made));
  Emitter emitter(head(), 1e-3, robot::Position6::Zero());
  std::vector<Sample> samples;
  ASSERT_TRUE(emitter.add(made.path, made.motion, samples));
  ASSERT_TRUE(emitter.finish(samples));
  EXPECT_NEAR(emitter.duration_s(), made.time_s(), 1e-12);
  EXPECT_EQ(samples.size(), static_cast<std::size_t>(std::ceil(made.time_s() / 1e-3)) + 1);
  EXPECT_EQ(samples.front().tip_m, program.start.tip_m);
  EXPECT_LT((samples.back().tip_m - program.blocks.back().end.tip_m).norm(), 1e-14);
  for (std::size_t i = 1; i < samples.size(); ++i) {
    EXPECT_DOUBLE_EQ(samples[i].time_s, 1e-3 * static_cast<double>(i));
    EXPECT_GE(samples[i].path_m, samples[i - 1].path_m);
    EXPECT_GE(samples[i].block, samples[i - 1].block);
    EXPECT_LT((samples[i].tip_m - samples[i - 1].tip_m).norm(), 0.05 * 1e-3 * 1.001);
    EXPECT_LT((head().forward(samples[i].joints).tip_m - samples[i].tip_m).norm(), 1e-12);
  }
  // The same when it comes in pieces.
  Emitter slowly(head(), 1e-3, robot::Position6::Zero());
  std::vector<Sample> again;
  ASSERT_TRUE(slowly.add(made.path, {}, again));
  for (const Segment& segment : made.motion) ASSERT_TRUE(slowly.add({}, std::span(&segment, 1), again));
  ASSERT_TRUE(slowly.finish(again));
  ASSERT_EQ(again.size(), samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) ASSERT_EQ(again[i].joints, samples[i].joints);
}

}  // namespace planner_test
}  // namespace robomill::path
