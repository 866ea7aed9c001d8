#include "robomill/robot/arm.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <kdl/chain.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainjnttojacsolver.hpp>
#include <limits>

#include "testing/robot/arms.hpp"
#include "testing/robot/jacobian.hpp"
#include "testing/robot/kdl.hpp"
#include "testing/support.hpp"

namespace robomill::robot {
namespace arm_test {

using robomill::test::field_of;

// Source: the flange that [GbtAdl2023] (Robot_Model.m) gives in that posture, to 0.01 mm.
TEST(Arm, PutsTheFlangeOfTheKr210WhereItsModelDoes) {
  const Eigen::Isometry3d flange = forward(testing::kr210(), testing::kr210_posture());
  EXPECT_NEAR(flange.translation().x(), 1.98137, 0.6e-5);
  EXPECT_NEAR(flange.translation().y(), -0.27781, 0.6e-5);
  EXPECT_NEAR(flange.translation().z(), 1.22525, 0.6e-5);
}

// Standard DH multiplied out as the textbook writes one row.
TEST(Arm, MultipliesDhRowsAsTheTextbookDoes) {
  Random random(1);
  std::vector<DhRow> rows(5);
  for (DhRow& row : rows) {
    row = {.a_m = random.normal(),
           .alpha_rad = random.normal(),
           .d_m = random.normal(),
           .theta_offset_rad = random.normal()};
  }
  const Eigen::Isometry3d base = testing::random_pose(random, 1.0);
  const Eigen::VectorXd position = testing::random_position(random, 5);
  Eigen::Matrix4d expected = base.matrix();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double theta = position(static_cast<Eigen::Index>(i)) + rows[i].theta_offset_rad, alpha = rows[i].alpha_rad;
    const double ct = std::cos(theta), st = std::sin(theta), ca = std::cos(alpha), sa = std::sin(alpha);
    Eigen::Matrix4d row;
    row << ct, -st * ca, st * sa, rows[i].a_m * ct,  //
        st, ct * ca, -ct * sa, rows[i].a_m * st,     //
        0.0, sa, ca, rows[i].d_m,                    //
        0.0, 0.0, 0.0, 1.0;
    expected = (expected * row).eval();
  }
  EXPECT_LT((forward(arm_from_dh(rows, base), position).matrix() - expected).cwiseAbs().maxCoeff(), 1e-14);
}

TEST(Arm, AgreesWithKdl) {
  Random random(2);
  for (int k = 0; k < 50; ++k) {
    const Arm arm = testing::random_chain(random, 1 + k % 8);
    const Eigen::VectorXd position = testing::random_position(random, arm.size());
    const KDL::Chain chain = testing::kdl_chain(arm);
    KDL::JntArray q(static_cast<unsigned>(arm.size()));
    q.data = position;
    KDL::Frame frame;
    KDL::ChainFkSolverPos_recursive(chain).JntToCart(q, frame);
    const Eigen::Isometry3d flange = forward(arm, position);
    EXPECT_LT((testing::eigen(frame).matrix() - flange.matrix()).cwiseAbs().maxCoeff(), 1e-13);
    KDL::Jacobian jac(static_cast<unsigned>(arm.size()));
    KDL::ChainJntToJacSolver(chain).JntToJac(q, jac);
    EXPECT_LT((jac.data - jacobian(arm, position, Eigen::Vector3d::Zero())).cwiseAbs().maxCoeff(), 1e-13);
  }
}

TEST(Arm, HasTheJacobianAndItsDerivativeOfFiniteDifferences) {
  Random random(3);
  constexpr double h = 1e-5;
  for (int k = 0; k < 20; ++k) {
    const Arm arm = testing::random_chain(random, 7);
    const Eigen::VectorXd position = testing::random_position(random, arm.size());
    const Eigen::Vector3d point = testing::random_vector(random);
    const Eigen::Matrix<double, 6, Eigen::Dynamic> jac = jacobian(arm, position, point);
    for (Eigen::Index i = 0; i < arm.size(); ++i) {
      Eigen::VectorXd up = position, down = position;
      up(i) += h;
      down(i) -= h;
      const Eigen::Isometry3d above = forward(arm, up), below = forward(arm, down);
      const Eigen::Vector3d velocity = (above * point - below * point) / (2.0 * h);
      const Eigen::Matrix3d turn =
          (above.linear() - below.linear()) * forward(arm, position).linear().transpose() / (2.0 * h);
      EXPECT_LT((velocity - jac.col(i).head<3>()).norm(), 1e-8);
      EXPECT_LT((Eigen::Vector3d(turn(2, 1), turn(0, 2), turn(1, 0)) - jac.col(i).tail<3>()).norm(), 1e-8);
      const Eigen::Matrix<double, 6, Eigen::Dynamic> change =
          (jacobian(arm, up, point) - jacobian(arm, down, point)) / (2.0 * h);
      EXPECT_LT((change - testing::jacobian_derivative(jac, i)).cwiseAbs().maxCoeff(), 1e-7);
    }
  }
}

TEST(Arm, ReportsTheJointNearestToItsLimit) {
  Arm arm = testing::with_limits(testing::kr210());
  Eigen::VectorXd position = Eigen::VectorXd::Zero(6);
  position(2) = 2.5;
  LimitCheck check = within_limits(arm, position);
  EXPECT_TRUE(check.inside);
  EXPECT_EQ(check.joint, 2);
  EXPECT_NEAR(check.distance, 150.0 * testing::pi / 180.0 - 2.5, 1e-15);
  position(4) = -3.0;
  check = within_limits(arm, position);
  EXPECT_FALSE(check.inside);
  EXPECT_EQ(check.joint, 4);
  EXPECT_NEAR(check.distance, 125.0 * testing::pi / 180.0 - 3.0, 1e-15);
  position(4) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(within_limits(arm, position).inside);
  EXPECT_TRUE(within_limits(testing::kr210(), 1e6 * Eigen::VectorXd::Ones(6)).inside);
  EXPECT_EQ(within_limits(testing::kr210(), Eigen::VectorXd::Zero(6)).joint, -1);
}

TEST(Arm, RejectsWhatIsNoArm) {
  const auto field = [](auto&& spoil) {
    Arm arm = testing::with_limits(testing::kr210());
    spoil(arm);
    return field_of([&] { arm.validate(); });
  };
  EXPECT_EQ(field([](Arm&) {}), "accepted");
  EXPECT_EQ(field([](Arm& arm) { arm.joints.clear(); }), "joints");
  EXPECT_EQ(field([](Arm& arm) { arm.joints[1].axis *= 1.1; }), "joints[2].axis");
  EXPECT_EQ(field([](Arm& arm) { arm.joints[2].before.linear() *= 2.0; }), "joints[3].before");
  EXPECT_EQ(field([](Arm& arm) { arm.joints[2].before.linear().col(0) *= -1.0; }), "joints[3].before");
  EXPECT_EQ(field([](Arm& arm) { arm.joints[5].max_position = -7.0; }), "joints[6].min_position");
  EXPECT_EQ(field([](Arm& arm) { arm.joints[0].max_position = std::nan(""); }), "joints[1].min_position");
  EXPECT_EQ(field([](Arm& arm) { arm.joints[0].max_velocity = -1.0; }), "joints[1].max_velocity");
  EXPECT_EQ(field([](Arm& arm) { arm.joints[0].max_acceleration = -1.0; }), "joints[1].max_acceleration");
  EXPECT_EQ(field([](Arm& arm) { arm.joints[0].max_jerk = std::nan(""); }), "joints[1].max_jerk");
  EXPECT_EQ(field([](Arm& arm) { arm.joints[3].stiffness = -1.0; }), "joints[4].stiffness");
  EXPECT_EQ(field([](Arm& arm) { arm.joints[3].damping = -1.0; }), "joints[4].damping");
  EXPECT_EQ(field([](Arm& arm) { arm.joints[3].rotor_inertia = -1.0; }), "joints[4].rotor_inertia");
  EXPECT_EQ(field([](Arm& arm) { arm.joints[3].link.mass_kg = -1.0; }), "joints[4].link.mass_kg");
  EXPECT_EQ(field([](Arm& arm) { arm.joints[3].link.center_m.x() = std::nan(""); }), "joints[4].link.center_m");
  EXPECT_EQ(field([](Arm& arm) { arm.joints[3].link.inertia_kg_m2(0, 1) = 1.0; }), "joints[4].link.inertia_kg_m2");
  EXPECT_EQ(field([](Arm& arm) { arm.joints[3].link.inertia_kg_m2.diagonal() << 1.0, -1.0, 1.0; }),
            "joints[4].link.inertia_kg_m2");
  EXPECT_EQ(field([](Arm& arm) { arm.flange.translation().x() = std::nan(""); }), "flange");

  Cell cell{.arm = testing::kr210()};
  EXPECT_EQ(field_of([&] { cell.validate(); }), "accepted");
  cell.tool_length_m = -0.1;
  EXPECT_EQ(field_of([&] { cell.validate(); }), "tool_length_m");
  cell = {.arm = testing::kr210()};
  cell.workpiece.linear() *= 2.0;
  EXPECT_EQ(field_of([&] { cell.validate(); }), "workpiece");
  cell = {};
  EXPECT_EQ(field_of([&] { cell.validate(); }), "arm.joints");
}

TEST(Arm, RejectsPositionsOfAnotherLength) {
  const Arm arm = testing::kr210();
  const Eigen::VectorXd five = Eigen::VectorXd::Zero(5);
  EXPECT_EQ(field_of([&] { (void)forward(arm, five); }), "position");
  EXPECT_EQ(field_of([&] { (void)jacobian(arm, five, Eigen::Vector3d::Zero()); }), "position");
  EXPECT_EQ(field_of([&] { (void)within_limits(arm, five); }), "position");
  EXPECT_EQ(field_of([&] { (void)forward(arm, Eigen::VectorXd::Constant(6, std::nan(""))); }), "position");
}

}  // namespace arm_test
}  // namespace robomill::robot
