#include "robomill/robot/inverse.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <kdl/chain.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>

#include "robomill/base/random.hpp"
#include "testing/robot/arms.hpp"
#include "testing/robot/kdl.hpp"
#include "testing/support.hpp"

namespace robomill::robot {
namespace inverse_test {

using robomill::test::rejection;
using robomill::test::seeds;

double pose_error(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return (a.matrix() - b.matrix()).cwiseAbs().maxCoeff();
}

double apart(double a, double b) {
  return std::abs(std::remainder(a - b, 2.0 * testing::pi));
}

/// Every solution of a random posture puts the flange back, and the posture is one of them.
void check_postures(const Arm& arm, Random& random, int count) {
  const SphericalWristInverse inverse(arm);
  const KDL::Chain chain = testing::kdl_chain(arm);
  KDL::ChainFkSolverPos_recursive peer(chain);
  for (int k = 0; k < count; ++k) {
    const Position6 position = testing::random_position(random, 6);
    const Eigen::Isometry3d flange = forward(arm, position);
    const InverseSolutions solutions = inverse.solve(flange);
    ASSERT_EQ(solutions.status, InverseSolutions::Status::found);
    double nearest = 1e9, room = 1.0;
    for (int i = 0; i < solutions.count; ++i) {
      const InverseSolution& solution = solutions.solution[static_cast<std::size_t>(i)];
      const Position6& q = solution.position_rad;
      ASSERT_LT(pose_error(forward(arm, q), flange), 1e-9) << position.transpose();
      double distance = 0.0;
      for (int j = 0; j < 6; ++j) {
        distance = std::max(distance, apart(q(j), position(j)));
        ASSERT_LE(std::abs(q(j)), testing::pi);
      }
      if (distance < nearest) {
        nearest = distance;
        room = std::min({solution.elbow_rad, solution.wrist_rad, solutions.shoulder_m});
      }
      KDL::JntArray joints(6);
      joints.data = q;
      KDL::Frame frame;
      peer.JntToCart(joints, frame);
      ASSERT_LT(pose_error(testing::eigen(frame), flange), 1e-9);
    }
    ASSERT_LT(nearest, 1e-9 + 1e-13 / room) << position.transpose();
  }
}

TEST(Inverse, PutsTheFlangeBackAndFindsThePosture) {
  Random random(11);
  check_postures(testing::kr210(), random, seeds(40000));
  check_postures(testing::irb(), random, seeds(20000));
}

/// An arm of the kind with every offset and angle drawn.
Arm random_spherical_wrist(Random& random, bool perpendicular) {
  const auto offset = [&] { return random.uniform(-0.3, 0.3); };
  const auto length = [&] { return random.uniform(0.4, 1.2) * (random.uniform() < 0.5 ? -1.0 : 1.0); };
  const auto angle = [&] {
    return perpendicular ? (random.uniform() < 0.5 ? -0.5 : 0.5) * testing::pi : random.uniform(0.5, 2.6);
  };
  const auto turn = [&] { return random.uniform(-testing::pi, testing::pi); };
  Arm arm = arm_from_dh({{.a_m = offset(), .alpha_rad = angle(), .d_m = length(), .theta_offset_rad = turn()},
                         {.a_m = length(),
                          .alpha_rad = random.uniform() < 0.5 ? testing::pi : 0.0,
                          .d_m = offset(),
                          .theta_offset_rad = turn()},
                         {.a_m = offset(), .alpha_rad = angle(), .d_m = offset(), .theta_offset_rad = turn()},
                         {.alpha_rad = angle(), .d_m = length(), .theta_offset_rad = turn()},
                         {.alpha_rad = angle(), .theta_offset_rad = turn()},
                         {.a_m = offset(), .alpha_rad = turn(), .d_m = offset(), .theta_offset_rad = turn()}},
                        testing::random_pose(random, 0.5));
  for (Joint& joint : arm.joints) {
    if (random.uniform() < 0.5) joint.axis = -joint.axis;
  }
  return arm;
}

TEST(Inverse, HoldsForRandomSphericalWrists) {
  Random random(12);
  for (int k = 0; k < seeds(400); ++k) check_postures(random_spherical_wrist(random, k % 2 == 0), random, 100);
}

TEST(Inverse, FindsAllEightOfAPostureInTheMiddle) {
  const Arm arm = testing::kr210();
  const SphericalWristInverse inverse(arm);
  const InverseSolutions solutions = inverse.solve(forward(arm, testing::kr210_posture()));
  ASSERT_EQ(solutions.count, 8);
  for (int i = 0; i < 8; ++i) {
    const InverseSolution& a = solutions.solution[static_cast<std::size_t>(i)];
    EXPECT_EQ(a.shoulder_back, i >= 4);
    EXPECT_EQ(a.elbow_down, i % 4 >= 2);
    EXPECT_EQ(a.wrist_flipped, i % 2 == 1);
    for (int j = 0; j < i; ++j) {
      EXPECT_GT((a.position_rad - solutions.solution[static_cast<std::size_t>(j)].position_rad).norm(), 0.1);
    }
  }
}

TEST(Inverse, KeepsThePoseNearEverySingularity) {
  Random random(13);
  const Arm arm = testing::kr210();
  const SphericalWristInverse inverse(arm);
  // The elbow is stretched where the forearm's angle, atan(0.041 / 1.2), is made up for.
  const double stretched = std::atan2(1.2, 0.041) - testing::pi;
  for (int k = 0; k < seeds(4000); ++k) {
    const double near = random.uniform() < 0.2 ? 0.0 : std::pow(10.0, random.uniform(-16.0, -1.0));
    Position6 position = testing::random_position(random, 6);
    if (k % 2 == 0) position(4) = near + (k % 4 == 0 ? testing::pi : 0.0);
    if (k % 3 == 0) position(2) = stretched + near;
    const Eigen::Isometry3d flange = forward(arm, position);
    const InverseSolutions solutions = inverse.solve(flange, position);
    ASSERT_EQ(solutions.status, InverseSolutions::Status::found) << near;
    double elbow = 4.0;
    InverseSolution straightest{.wrist_rad = 4.0};
    for (int i = 0; i < solutions.count; ++i) {
      const InverseSolution& solution = solutions.solution[static_cast<std::size_t>(i)];
      ASSERT_LT(pose_error(forward(arm, solution.position_rad), flange), 1e-9) << near;
      if (solution.wrist_rad < straightest.wrist_rad) straightest = solution;
      elbow = std::min(elbow, solution.elbow_rad);
    }
    if (k % 2 == 0) {
      EXPECT_LT(straightest.wrist_rad, near + 1e-7);
    }
    if (k % 3 == 0) {
      EXPECT_LT(elbow, near + 1e-5);
    }
    // At a stretched elbow rounding bends the arm by 1e-8, and with it the wrist.
    if (k % 2 == 0 && k % 3 != 0 && near == 0.0) {
      EXPECT_TRUE(solutions.wrist_singular);
      EXPECT_LT(straightest.wrist_rad, 1e-12);
      EXPECT_LT(apart(straightest.position_rad(3), position(3)), 1e-12);
    }
  }
}

TEST(Inverse, ReportsTheShoulderSingularityAndTakesTheHint) {
  // An arm whose wrist can stand on axis 1.
  const Arm arm = testing::irb();
  const SphericalWristInverse inverse(arm);
  Eigen::Isometry3d flange = Eigen::Isometry3d::Identity();
  const Eigen::Vector3d above(0.0, 0.0, 1.8);
  flange.translation() = above + Eigen::Vector3d(0.0, 0.0, 0.2);
  Position6 hint = Position6::Zero();
  hint(0) = 0.7;
  const InverseSolutions on = inverse.solve(flange, hint);
  EXPECT_TRUE(on.shoulder_singular);
  EXPECT_LT(on.shoulder_m, 1e-12);
  ASSERT_GT(on.count, 0);
  for (int i = 0; i < on.count; ++i) {
    const Position6& q = on.solution[static_cast<std::size_t>(i)].position_rad;
    EXPECT_NEAR(q(0), 0.7, 1e-12);
    EXPECT_LT(pose_error(forward(arm, q), flange), 1e-9);
  }
  flange.translation().x() += 0.01;
  const InverseSolutions beside = inverse.solve(flange, hint);
  EXPECT_FALSE(beside.shoulder_singular);
  EXPECT_NEAR(beside.shoulder_m, 0.01, 1e-12);
}

TEST(Inverse, ReportsByHowMuchAPoseIsOutOfReach) {
  const Arm arm = testing::irb();
  const SphericalWristInverse inverse(arm);
  const double reach = 1.075 + std::hypot(0.2, 1.142);
  Eigen::Isometry3d flange = Eigen::Isometry3d::Identity();
  // The wrist's centre stands 0.2 m below the flange, axis 2 at (0.32, 0, 0.78).
  flange.translation() = Eigen::Vector3d(0.32 + reach + 0.05, 0.0, 0.78 + 0.2);
  InverseSolutions solutions = inverse.solve(flange);
  EXPECT_EQ(solutions.status, InverseSolutions::Status::out_of_reach);
  EXPECT_EQ(solutions.count, 0);
  EXPECT_NEAR(solutions.out_of_reach_m, 0.05, 1e-12);
  flange.translation().x() -= 0.05 + 1e-6;
  solutions = inverse.solve(flange);
  EXPECT_EQ(solutions.status, InverseSolutions::Status::found);
  EXPECT_EQ(solutions.out_of_reach_m, 0.0);
}

TEST(Inverse, ReportsByHowMuchAPoseIsTooNear) {
  const Arm arm = arm_from_dh({{.alpha_rad = -testing::pi / 2, .d_m = 0.8},
                               {.a_m = 1.0},
                               {.alpha_rad = -testing::pi / 2},
                               {.alpha_rad = testing::pi / 2, .d_m = 0.7},
                               {.alpha_rad = -testing::pi / 2},
                               {.d_m = 0.2}});
  Eigen::Isometry3d flange = Eigen::Isometry3d::Identity();
  flange.translation() = Eigen::Vector3d(0.03, 0.04, 0.8 + 0.2);
  const InverseSolutions solutions = SphericalWristInverse(arm).solve(flange);
  EXPECT_EQ(solutions.status, InverseSolutions::Status::out_of_reach);
  EXPECT_NEAR(solutions.out_of_reach_m, 1.0 - 0.7 - 0.05, 1e-12);
}

TEST(Inverse, ReportsHowFarAWristThatIsNotPerpendicularFallsShort) {
  const Arm arm = arm_from_dh({{.a_m = 0.3, .alpha_rad = -testing::pi / 2, .d_m = 0.5},
                               {.a_m = 1.0},
                               {.a_m = 0.1, .alpha_rad = -testing::pi / 2},
                               {.alpha_rad = 0.8, .d_m = 1.0},
                               {.alpha_rad = -0.7},
                               {.d_m = 0.1}});
  const SphericalWristInverse inverse(arm);
  Position6 position;
  position << 0.1, -0.5, 0.2, 0.3, 0.0, 0.4;
  // At zero joint 5 axis 6 lies 0.1 rad from axis 4; turned by 0.05 rad towards it it cannot be reached.
  Posture posture;
  posture.update(arm, position);
  const Eigen::Vector3d normal = posture.axis.col(3).cross(posture.axis.col(5)).normalized();
  const double between = std::acos(posture.axis.col(3).dot(posture.axis.col(5)));
  EXPECT_NEAR(between, 0.1, 1e-9);
  const Eigen::Isometry3d flange = posture.flange;
  const Eigen::Vector3d centre = posture.origin_m.col(5);
  const Eigen::Isometry3d turned =
      Eigen::Translation3d(centre) * Eigen::AngleAxisd(-0.05, normal) * Eigen::Translation3d(-centre) * flange;
  // The other elbow may reach it; only those near the posture are asked.
  EXPECT_GT(inverse.solve(flange).count, 0);
  const InverseSolutions solutions = inverse.solve(turned);
  if (solutions.count == 0) {
    EXPECT_NEAR(solutions.out_of_reach_rad, 0.05, 1e-9);
  }
  for (int i = 0; i < solutions.count; ++i) {
    EXPECT_LT(pose_error(forward(arm, solutions.solution[static_cast<std::size_t>(i)].position_rad), turned), 1e-9);
  }
}

TEST(Inverse, SaysWhyAnArmIsNotOfItsKind) {
  const auto said = [](const Arm& arm) { return rejection([&] { (void)SphericalWristInverse(arm); }); };
  EXPECT_NE(said(testing::ur5e()).find("axes 4, 5 and 6 that meet in one point"), std::string::npos)
      << said(testing::ur5e());
  Arm arm = testing::kr210();
  arm.joints[2].before.rotate(Eigen::AngleAxisd(1e-3, Eigen::Vector3d::UnitX()));
  EXPECT_NE(said(arm).find("axes 2 and 3 that are parallel: they are off (0.001 rad)"), std::string::npos) << said(arm);
  arm = testing::kr210();
  arm.joints.pop_back();
  EXPECT_NE(said(arm).find("six joints (5 joints)"), std::string::npos) << said(arm);
  arm = testing::kr210();
  arm.joints[3].prismatic = true;
  EXPECT_NE(said(arm).find("revolute joints alone (4 is prismatic)"), std::string::npos) << said(arm);
  arm = testing::kr210();
  arm.joints[1].before.linear().setIdentity();
  EXPECT_NE(said(arm).find("axes 1 and 2 that are not parallel"), std::string::npos) << said(arm);
  arm = testing::kr210();
  arm.joints[2].before.translation().setZero();
  EXPECT_NE(said(arm).find("axes 2 and 3 apart"), std::string::npos) << said(arm);
  arm = testing::kr210();
  arm.joints[5].before.linear().setIdentity();
  EXPECT_NE(said(arm).find("axes 5 and 6 that are not parallel"), std::string::npos) << said(arm);
}

}  // namespace inverse_test
}  // namespace robomill::robot
