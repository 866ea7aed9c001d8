#include "robomill/robot/kinematics/choose.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "robomill/base/random.hpp"
#include "testing/robot/arms.hpp"
#include "testing/support.hpp"

namespace robomill::robot {
namespace choose_test {

using robomill::test::field_of;
using robomill::test::seeds;

double pose_error(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return (a.matrix() - b.matrix()).cwiseAbs().maxCoeff();
}

/// Every image within limits of every solution, the nearest by brute force.
double nearest_by_search(const Arm& arm, const InverseSolutions& solutions, const Position6& previous) {
  double best = std::numeric_limits<double>::infinity();
  for (int k = 0; k < solutions.count; ++k) {
    double sum = 0.0;
    for (int i = 0; i < 6; ++i) {
      const Joint& joint = arm.joints[static_cast<std::size_t>(i)];
      double least = std::numeric_limits<double>::infinity();
      for (int turns = -3; turns <= 3; ++turns) {
        const double angle =
            solutions.solution[static_cast<std::size_t>(k)].position_rad(i) + 2.0 * testing::pi * turns;
        if (angle < joint.min_position || angle > joint.max_position) continue;
        least = std::min(least, std::pow(angle - previous(i), 2));
      }
      sum += least;
    }
    best = std::min(best, sum);
  }
  return best;
}

TEST(Choose, TakesTheNearestWithinLimits) {
  Random random(31);
  const Arm arm = testing::with_limits(testing::kr210());
  const SphericalWristInverse inverse(arm);
  int outside = 0;
  for (int k = 0; k < seeds(20000); ++k) {
    const Eigen::Isometry3d flange = forward(arm, testing::random_position(random, 6));
    const Position6 previous = 1.5 * testing::random_position(random, 6);
    const InverseSolutions solutions = inverse.solve(flange);
    const Choice choice = choose(arm, solutions, previous, {.singularity = {.max_condition_number = 1e300}});
    const double expected = nearest_by_search(arm, solutions, previous);
    if (std::isinf(expected)) {
      ++outside;
      EXPECT_EQ(choice.status, Reach::Status::outside_limits);
      ASSERT_GE(choice.joint, 0);
      const Joint& joint = arm.joints[static_cast<std::size_t>(choice.joint)];
      const double at = choice.position_rad(choice.joint);
      EXPECT_NEAR(choice.beyond_rad, std::max(joint.min_position - at, at - joint.max_position), 1e-12);
      continue;
    }
    ASSERT_EQ(choice.status, Reach::Status::found);
    EXPECT_NEAR((choice.position_rad - previous).squaredNorm(), expected, 1e-9);
    EXPECT_TRUE(within_limits(arm, choice.position_rad).inside);
    EXPECT_LT(pose_error(forward(arm, choice.position_rad), flange), 1e-9);
    EXPECT_NEAR(choice.condition_number, condition_number(jacobian(arm, choice.position_rad, Eigen::Vector3d::Zero())),
                1e-6 * choice.condition_number);
  }
  EXPECT_GT(outside, 10);
}

TEST(Choose, ReportsWhyThereIsNone) {
  const Arm arm = testing::with_limits(testing::kr210());
  const SphericalWristInverse inverse(arm);
  Eigen::Isometry3d flange = forward(arm, testing::kr210_posture());
  flange.translation().x() += 10.0;
  const Choice far = choose(arm, inverse.solve(flange), Position6::Zero());
  EXPECT_EQ(far.status, Reach::Status::out_of_reach);
  EXPECT_GT(far.out_of_reach_m, 8.0);

  Position6 straight = testing::kr210_posture();
  straight(4) = 1e-5;
  const Choice singular = choose(arm, inverse.solve(forward(arm, straight)), straight);
  EXPECT_EQ(singular.status, Reach::Status::singular);
  EXPECT_GT(singular.condition_number, 1e4);
  EXPECT_LT(singular.travel_rad, 1e-6);

  Arm narrow = testing::kr210();
  narrow.joints[1].min_position = 1.0;
  narrow.joints[1].max_position = 1.1;
  const Position6 posture = testing::kr210_posture();
  const Choice outside = choose(narrow, inverse.solve(forward(arm, posture)), posture);
  EXPECT_EQ(outside.status, Reach::Status::outside_limits);
  EXPECT_EQ(outside.joint, 1);
  EXPECT_NEAR(outside.beyond_rad, std::max(1.0 - outside.position_rad(1), outside.position_rad(1) - 1.1), 1e-12);
}

TEST(Choose, FollowsAPathWithoutJumpsOverManyTurns) {
  const Arm arm = testing::kr210();
  const SphericalWristInverse inverse(arm);
  std::vector<Eigen::Isometry3d> flanges;
  std::vector<Position6> positions;
  for (int k = 0; k <= 2000; ++k) {
    const double t = k / 2000.0;
    Position6 position = testing::kr210_posture();
    position(0) += 10.0 * t;
    position(3) += 15.0 * t;
    position(5) -= 20.0 * t;
    position(4) -= 0.3 * std::sin(9.0 * t);
    positions.push_back(position);
    flanges.push_back(forward(arm, position));
  }
  const Followed way = follow(arm, inverse, flanges, positions.front());
  EXPECT_EQ(way.status, Reach::Status::found);
  ASSERT_EQ(way.reached, flanges.size());
  for (std::size_t k = 0; k < flanges.size(); ++k) EXPECT_LT((way.position_rad[k] - positions[k]).norm(), 1e-9);
  EXPECT_NEAR(way.largest_travel_rad, 20.0 / 2000.0, 1e-9);

  // Joint 6 may not turn that far: at its limit the arm would have to swing round.
  const Arm limited = testing::with_limits(arm);
  const Followed ended = follow(limited, inverse, flanges, positions.front(), {.max_travel_rad = 0.5});
  EXPECT_EQ(ended.status, Reach::Status::jump);
  EXPECT_GT(ended.last.travel_rad, 0.5);
  const double until = (350.0 - 18.86) * testing::pi / 180.0 / 20.0;
  EXPECT_NEAR(static_cast<double>(ended.reached), 2000.0 * until, 1.0);
  EXPECT_EQ(ended.position_rad.size(), ended.reached);
  EXPECT_GT(follow(limited, inverse, flanges, positions.front()).largest_travel_rad, 0.5);
}

TEST(Choose, FindsTheStartThatGetsFarthest) {
  const Arm arm = testing::with_limits(testing::kr210());
  const SphericalWristInverse inverse(arm);
  std::vector<Eigen::Isometry3d> flanges;
  for (int k = 0; k <= 300; ++k) {
    Position6 position = testing::kr210_posture();
    position(3) += 5.5 - 11.0 * k / 300.0;
    flanges.push_back(forward(arm, position));
  }
  const Followed way = follow(arm, inverse, flanges);
  EXPECT_EQ(way.status, Reach::Status::found);
  EXPECT_EQ(way.reached, flanges.size());
  EXPECT_NEAR(way.largest_travel_rad, 11.0 / 300.0, 1e-9);
  flanges.front().translation().x() += 10.0;
  const Followed none = follow(arm, inverse, flanges);
  EXPECT_EQ(none.status, Reach::Status::out_of_reach);
  EXPECT_EQ(none.reached, 0U);
}

TEST(Choose, SolvesAnyArmNearASeed) {
  Random random(33);
  for (int k = 0; k < seeds(2000); ++k) {
    const Arm arm = k % 2 == 0 ? testing::ur5e() : testing::random_chain(random, 6 + k % 3);
    const Eigen::VectorXd position = testing::random_position(random, arm.size());
    if (condition_number(jacobian(arm, position, Eigen::Vector3d::Zero())) > 100.0) continue;
    const Eigen::Isometry3d flange = forward(arm, position);
    Eigen::VectorXd seed = position;
    for (double& angle : seed) angle += random.uniform(-0.05, 0.05);
    const NearResult near = solve_near(arm, flange, seed);
    ASSERT_EQ(near.status, NearResult::Status::converged);
    EXPECT_LT(pose_error(forward(arm, near.position), flange), 1e-11);
    if (arm.size() == 6) {
      EXPECT_LT((near.position - position).norm(), 1.0);
    }
  }
}

TEST(Choose, SaysThatANearSolutionDidNotConverge) {
  const Arm arm = testing::ur5e();
  Eigen::Isometry3d flange = forward(arm, testing::kr210_posture());
  flange.translation().x() += 3.0;
  const NearResult near = solve_near(arm, flange, testing::kr210_posture());
  EXPECT_EQ(near.status, NearResult::Status::not_converged);
  EXPECT_GT(near.error_m, 1.0);
  EXPECT_TRUE(near.position.allFinite());
}

TEST(Choose, RejectsOptionsThatMakeNoSense) {
  const Arm arm = testing::kr210();
  const SphericalWristInverse inverse(arm);
  const std::vector<Eigen::Isometry3d> one = {forward(arm, testing::kr210_posture())};
  EXPECT_EQ(field_of([&] { (void)follow(arm, inverse, {}); }), "flanges");
  ChooseOptions options;
  options.weight(3) = -1.0;
  EXPECT_EQ(field_of([&] { (void)follow(arm, inverse, one, {}, options); }), "weight");
  options = {.singularity = {.characteristic_length_m = -1.0}};
  EXPECT_EQ(field_of([&] { (void)follow(arm, inverse, one, {}, options); }), "singularity.characteristic_length_m");
  options = {.max_travel_rad = 0.0};
  EXPECT_EQ(field_of([&] { (void)follow(arm, inverse, one, {}, options); }), "max_travel_rad");
  options = {};
  options.point_m.x() = std::nan("");
  EXPECT_EQ(field_of([&] { (void)follow(arm, inverse, one, {}, options); }), "point_m");
  Arm five = arm;
  five.joints.pop_back();
  EXPECT_EQ(field_of([&] { (void)follow(five, inverse, one); }), "arm.joints");
  const Eigen::VectorXd seed = testing::kr210_posture();
  EXPECT_EQ(field_of([&] { (void)solve_near(arm, one[0], seed.head(4)); }), "position");
  EXPECT_EQ(field_of([&] { (void)solve_near(arm, one[0], seed, {.tolerance_m = 0.0}); }), "tolerance_m");
  EXPECT_EQ(field_of([&] { (void)solve_near(arm, one[0], seed, {.tolerance_rad = -1.0}); }), "tolerance_rad");
  EXPECT_EQ(field_of([&] { (void)solve_near(arm, one[0], seed, {.max_iterations = 0}); }), "max_iterations");
}

}  // namespace choose_test
}  // namespace robomill::robot
