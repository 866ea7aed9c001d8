#include "robomill/path/duration.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <span>
#include <string>

#include "robomill/base/random.hpp"
#include "robomill/path/smooth.hpp"
#include "testing/path/machine.hpp"
#include "testing/path/random_program.hpp"
#include "testing/path/s_path.hpp"
#include "testing/support.hpp"

namespace robomill::path {
namespace duration_test {

using robomill::test::field_of;
using robomill::test::rejection;

program::Program straight(double length_m, double feed_m_per_s) {
  program::Program out;
  out.blocks.push_back({.line = 7, .end = {}, .duration_s = length_m / feed_m_per_s});
  out.blocks.back().end.tip_m.x() = length_m;
  return out;
}

struct Outcome {
  Summary summary;
  std::size_t samples = 0;  ///< sent out, whether it ended or not
};

/// Into `out`, so that what was sent is known where it throws.
void smooth_into(Outcome& out, const program::Program& program, const SmoothingOptions& options,
                 const robot::JointLimits& limits = test::tilt_head_limits()) {
  const test::TiltHead machine(limits);
  program::ProgramSource source(program);
  Posture posture;
  EXPECT_EQ(machine.all({.tip_m = program.start.tip_m, .axis = program.start.axis}, &posture.start, 1), 1);
  out.summary = smooth(
      source, machine, posture, options, [&](std::span<const Sample> some) { out.samples += some.size(); }, [] {},
      Progress::none());
}

/// What is said of a program that lasts too long; nothing of it may have been sampled.
std::string rejected(const program::Program& program, const SmoothingOptions& options,
                     const robot::JointLimits& limits = test::tilt_head_limits()) {
  Outcome run;
  std::string said = rejection([&] { smooth_into(run, program, options, limits); });
  EXPECT_EQ(run.samples, 0U);
  return said;
}

TEST(Duration, NamesTheLineTheDwellOrTheLimit) {
  const SmoothingOptions options = test::published_options(Method::verified);
  const program::Program part = straight(0.05, 0.02);
  EXPECT_EQ(rejected(straight(0.05, 1e-8 / 60.0), options).substr(0, 88),
            "block 1 (line 7): takes 8.333e+04 h at 1e-05 mm/min, the program 8.333e+04 h; 24 h are a");
  program::Program still = part;
  still.blocks.push_back(
      {.kind = program::Block::Kind::dwell, .line = 8, .end = part.blocks.back().end, .duration_s = 1e9});
  EXPECT_NE(rejected(still, options).find("block 2 (line 8): dwells for 2.778e+05 h"), std::string::npos);

  const auto with = [&](double SmoothingOptions::*limit, double value) {
    SmoothingOptions slow = options;
    slow.*limit = value;
    return field_of([&] {
      Outcome none;
      smooth_into(none, part, slow);
    });
  };
  EXPECT_EQ(with(&SmoothingOptions::max_velocity_m_per_s, 1e-9), "max_velocity_m_per_s");
  EXPECT_EQ(with(&SmoothingOptions::max_acceleration_m_per_s2, 1e-12), "max_acceleration_m_per_s2");
  EXPECT_EQ(with(&SmoothingOptions::max_jerk_m_per_s3, 1e-17), "max_jerk_m_per_s3");
  EXPECT_EQ(with(&SmoothingOptions::max_duration_s, 0.0), "max_duration_s");
}

// Only the plan shows what the joints allow, and it does so before any of it is sampled.
TEST(Duration, LimitsOfJointsCount) {
  for (const Method method : {Method::verified, Method::optimal, Method::paper, Method::no_joint_jerk}) {
    for (const int order : {1, 2, 3}) {
      if (order == 3 && method == Method::no_joint_jerk) continue;
      robot::JointLimits limits = test::tilt_head_limits();
      (order == 1   ? limits.max_velocity
       : order == 2 ? limits.max_acceleration
                    : limits.max_jerk)[0] = std::pow(1e-7, order);
      const std::string said = rejected(straight(0.05, 0.02), test::published_options(method), limits);
      EXPECT_NE(said.find("within the limits of the tool and the joints; 24 h are allowed"), std::string::npos)
          << order << ": " << said;
    }
  }
}

// A day at 10 µs is eight thousand million samples, which is hours of work; what of it is asked for is known before.
TEST(Duration, SamplesThatTakeTooLongAreRejectedBeforeAnyIsMade) {
  SmoothingOptions options = test::published_options(Method::verified);
  EXPECT_EQ(field_of([&] { require_end(options, 80'000.0, 0, 0); }), "accepted");
  options.sample_period_s = 1e-5;
  EXPECT_EQ(field_of([&] { require_end(options, 80'000.0, 0, 0); }), "sample_period_s");
  const std::string said = rejected(straight(5.0, 1e-4), options);
  EXPECT_NE(said.find("sample_period_s = 1e-05 s; would take about 5.6 h of one core"), std::string::npos) << said;
}

TEST(Duration, NoMachineFollowsMoreCloselyThanATenthOfAMicrometre) {
  SmoothingOptions options = test::published_options(Method::verified);
  options.tip_tolerance_m = 2e-11;
  EXPECT_EQ(field_of([&] { options.validate(); }), "tip_tolerance_m");
  options.tip_tolerance_m = 2e-5;
  options.axis_tolerance_rad = 1e-9;
  EXPECT_EQ(field_of([&] { options.validate(); }), "axis_tolerance_rad");
}

// From rest to rest along a line, one limit at a time: the closed forms against the plan.
TEST(Duration, ClosedFormsAreLowerBoundsAndNear) {
  const double length_m = 0.05;
  for (int limit = 0; limit < 3; ++limit) {
    SmoothingOptions options = test::published_options(Method::verified);
    options.max_velocity_m_per_s = limit == 0 ? 1e-3 : 1.0;
    options.max_acceleration_m_per_s2 = limit == 1 ? 1e-3 : 1e3;
    options.max_jerk_m_per_s3 = limit == 2 ? 1e-3 : 1e6;
    robot::JointLimits limits = test::tilt_head_limits();
    limits.max_jerk.head<5>().setConstant(1e6);
    limits.max_acceleration.head<5>().setConstant(1e3);
    Outcome run;
    smooth_into(run, straight(length_m, 0.9), options, limits);
    const double least_s = limit == 0   ? length_m / 1e-3
                           : limit == 1 ? 2.0 * std::sqrt(length_m / 1e-3)
                                        : std::cbrt(32.0 * length_m / 1e-3);
    EXPECT_GT(run.summary.duration_s, least_s) << limit;
    // With acceleration alone the plan keeps to constant jerk where it starts and stops.
    EXPECT_LT(run.summary.duration_s, (limit == 1 ? 1.6 : 1.02) * least_s) << limit;
    options.max_duration_s = 0.999 * least_s;
    EXPECT_NE(rejected(straight(length_m, 0.9), options, limits).find("makes the program last at least"),
              std::string::npos);
  }
}

// What fits into the time that is allowed is not rejected, to a percent: a round that is planned again may come out
// shorter. What does not fit always is.
TEST(Duration, AllowsWhatFits) {
  Random random(18);
  for (int seed = 0; seed < robomill::test::seeds(60); ++seed) {
    const program::Program program = test::random_program(random, {.blocks = 40, .max_lean_rad = 0.4});
    SmoothingOptions options = test::published_options(Method::verified);
    Outcome run, again;
    smooth_into(run, program, options);
    options.max_duration_s = 1.01 * run.summary.duration_s;
    ASSERT_NO_THROW(smooth_into(again, program, options)) << seed;
    EXPECT_EQ(again.samples, run.samples);
    options.max_duration_s = 0.99 * run.summary.duration_s;
    ASSERT_THROW(smooth_into(again, program, options), InvalidInput) << seed;
  }
}

}  // namespace duration_test
}  // namespace robomill::path
