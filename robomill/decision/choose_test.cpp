#include "robomill/decision/choose.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "robomill/stability/forced_vibration.hpp"
#include "testing/stability/problems.hpp"

namespace robomill::decision {
namespace choose_test {

using stability::testing::rpm;

stability::LobesProblem cut(double feed_m) {
  stability::LobesProblem problem = stability::testing::benchmark(0.1);
  problem.milling.feed_per_tooth_m = feed_m;
  return problem;
}

Recommendation chosen(const stability::LobesProblem& problem, const RecommendOptions& options) {
  stability::LobesOptions lobes = stability::testing::chart(5000.0, 25000.0, 3e-3, 41, 20);
  lobes.method = stability::Method::collocation;
  lobes.output = stability::Output::limits;
  return choose(problem, lobes, stability::compute_lobes(problem, lobes).limit, options);
}

std::vector<Operation> all_of(const Recommendation& r) {
  std::vector<Operation> all = r.alternatives;
  all.push_back(*r.recommended);
  return all;
}

// In the deepest pocket, at 922 Hz / 2 teeth, tooth passing meets the mode. What is recommended, and every alternative,
// vibrates by no more than the feed per tooth, and the reason is named where that binds.
TEST(Choose, ForcedVibrationIsALimit) {
  const stability::LobesProblem problem = cut(0.02e-3);
  const stability::ForcedResponse response(problem);
  const Recommendation found = chosen(problem, {.radial_depth_m = 1e-3});
  ASSERT_EQ(found.status, Recommendation::Status::found);
  bool binds = false;
  for (const Operation& op : all_of(found)) {
    const double speed = op.spindle_speed_rad_per_s;
    for (const double part : {-0.02, -0.01, 0.0, 0.01, 0.02}) {
      const double amplitude_m = response.at({speed * (1.0 + part), op.axial_depth_m}).amplitude_m;
      EXPECT_LE(amplitude_m, 1.01 * problem.milling.feed_per_tooth_m) << speed / rpm;
    }
    EXPECT_DOUBLE_EQ(op.vibration.amplitude_m, response.at({speed, op.axial_depth_m}).amplitude_m);
    if (op.limited_by != LimitedBy::forced_vibration) continue;
    binds = true;
    EXPECT_LT(op.axial_depth_m, 0.8 * op.limit_depth_m);
  }
  EXPECT_TRUE(binds);
}

// The torque that the spindle is asked for is that of the force model: with edge forces the depth is smaller.
TEST(Choose, EdgeForcesLoadTheSpindle) {
  const std::vector<SpindleCapacity> spindle = {{400.0, 0.02, 1e6}, {3000.0, 0.02, 1e6}};
  stability::LobesProblem problem = cut(0.1e-3);
  const Recommendation without = chosen(problem, {.radial_depth_m = 1e-3, .machine = {.spindle = spindle}});
  problem.milling.coefficients.tangential_edge_n_per_m = 20e3;
  const Recommendation with = chosen(problem, {.radial_depth_m = 1e-3, .machine = {.spindle = spindle}});
  EXPECT_LT(with.recommended->axial_depth_m, without.recommended->axial_depth_m);
  for (const Operation& op : all_of(with)) {
    const double torque = cutting::mean_torque_n_m(problem.milling, op.axial_depth_m, 0.1e-3);
    EXPECT_NEAR(op.torque_n_m, torque, 1e-9 * torque);
    EXPECT_LE(torque, 0.02 * (1.0 + 1e-9));
  }
}

TEST(DepthOfTorque, IsWhereTheTorqueIsReached) {
  const auto bent = [](double depth_m) { return 100.0 * depth_m + 2e4 * depth_m * depth_m; };
  for (const double deepest_m : {1e-3, 5e-3, 20e-3}) {
    for (const double share : {1e-6, 0.1, 0.5, 0.999}) {
      const double torque = share * bent(deepest_m);
      EXPECT_NEAR(bent(depth_of_torque_m(bent, torque, deepest_m)), torque, 1e-9 * torque);
    }
    EXPECT_EQ(depth_of_torque_m(bent, 2.0 * bent(deepest_m), deepest_m), deepest_m);
    EXPECT_EQ(depth_of_torque_m(bent, 0.0, deepest_m), 0.0);
  }
}

}  // namespace choose_test
}  // namespace robomill::decision
