#include "robomill/path/published/fir_joint.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/path/published/fir_profile.hpp"
#include "robomill/robot/kinematics.hpp"

namespace robomill::path {
namespace fir_joint_test {

/// One joint along a block: q' = a + b s + c s²/2.
struct Bend {
  double a = 0.0, b = 0.0, c = 0.0;
  /// q', q'', q'''
  [[nodiscard]] std::array<double, 3> at(double s) const { return {a + b * s + 0.5 * c * s * s, b + c * s, c}; }
  [[nodiscard]] std::vector<robot::JointJet> jets(int steps) const {
    std::vector<robot::JointJet> out;
    for (int i = 0; i <= steps; ++i) {
      robot::JointJet jet = robot::JointJet::Zero();
      const std::array<double, 3> d = at(static_cast<double>(i) / steps);
      jet.row(0) << 0.0, d[0], d[1], d[2];
      out.push_back(jet);
    }
    return out;
  }
};

FirConstants stretched(const Bend& bend, double max_jerk, Method method, FirConstants constants) {
  robot::JointLimits limits;
  limits.max_velocity.setConstant(1e6);
  limits.max_acceleration.setConstant(1e6);
  limits.max_jerk.setConstant(max_jerk);
  SmoothingOptions options;
  options.method = method;
  stretch_for_joints(bend.jets(32), limits, 1, options, constants);
  return constants;
}

/// The largest jerk of the joint over the block alone.
double largest_jerk(const Bend& bend, const FirConstants& c) {
  Boxes boxes;
  for (const double width : {c.t1_s, c.t2_s, c.t3_s}) boxes.add(width);
  double most = 0.0;
  for (int i = 0; i <= 4000; ++i) {
    const Eigen::Vector4d s = share_at(boxes, (c.t1_s + c.t2_s + c.t3_s) * i / 4000.0);
    const std::array<double, 3> d = bend.at(s[0]);
    most = std::max(most, std::abs(d[2] * std::pow(s[1], 3) + 3.0 * d[1] * s[1] * s[2] + d[0] * s[3]));
  }
  return most;
}

// Equation 30 by hand, T1 = 1 s, T2 = 0.1 s, half the limit 10: both rows, with s̈ > 0 at the beginning of the block and
// s̈ < 0 at its end.
TEST(FirJoint, AsPrintedTheJerkStepHasItsSigns) {
  const Bend bend = {.a = 0.02, .b = 0.2, .c = -0.3};
  const FirConstants start = {.t1_s = 1.0, .t2_s = 0.1, .t3_s = 0.001};
  const FirConstants printed = stretched(bend, 20.0, Method::paper_as_printed, start);
  double expected = 0.0;
  for (int i = 0; i <= 32; ++i) {
    const double s = i / 32.0, reach = 0.5 * (0.1 + printed.t3_s);
    const std::array<double, 3> d = bend.at(s);
    for (const double sign : {1.0, -1.0}) {
      if (sign > 0.0 ? s > reach : s < 1.0 - reach) continue;
      for (const double row : {1.0, -1.0}) {
        const double left = std::abs(10.0 - row * (d[2] + sign * 30.0 * d[1]));
        expected = std::max(expected, std::abs(d[0]) / (0.1 * left));
      }
    }
  }
  EXPECT_EQ(printed.t1_s, 1.0);
  EXPECT_EQ(printed.t2_s, 0.1);
  EXPECT_NEAR(printed.t3_s, expected, 1e-12);
}

// Each block alone keeps half the limit with magnitudes. With the printed signs opposite terms cancel at full speed and
// not on the way to it, and the absolute value hides terms beyond the limit.
TEST(FirJoint, MagnitudesKeepHalfTheJerkAndPrintedSignsDoNot) {
  double paper = 0.0, printed = 0.0;
  for (int seed = 0; seed < 200; ++seed) {
    Random random(1, static_cast<std::uint64_t>(seed));
    const Bend bend = {.a = random.normal(), .b = 3.0 * random.normal(), .c = 20.0 * random.normal()};
    const double limit = 200.0 * std::exp(random.normal());
    const FirConstants start = {.t1_s = 1.0, .t2_s = 0.1, .t3_s = 0.05};
    for (const Method method : {Method::paper, Method::paper_as_printed}) {
      const FirConstants c = stretched(bend, limit, method, start);
      if (c.t1_s < c.t2_s + c.t3_s) continue;  // speeding up and braking overlap: docs/theory/fir-smoothing.md
      double& most = method == Method::paper ? paper : printed;
      most = std::max(most, largest_jerk(bend, c) / limit);
    }
  }
  EXPECT_LE(paper, 0.5 * (1.0 + 5e-3));
  EXPECT_GT(paper, 0.4);
  EXPECT_GT(printed, 0.6);
}

}  // namespace fir_joint_test
}  // namespace robomill::path
