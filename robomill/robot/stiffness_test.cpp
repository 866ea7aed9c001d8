#include "robomill/robot/stiffness.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>

#include "robomill/base/linear_algebra.hpp"
#include "robomill/base/random.hpp"
#include "testing/robot/arms.hpp"
#include "testing/robot/jacobian.hpp"
#include "testing/support.hpp"

namespace robomill::robot {
namespace stiffness_test {

using robomill::test::field_of;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Jacobian = Eigen::Matrix<double, 6, Eigen::Dynamic>;

const Eigen::Vector3d tip(0.05, -0.02, 0.3);

Wrench milling(double force_n) {
  return {.force_n = force_n * Eigen::Vector3d(0.6, -0.7, 0.3).normalized()};
}

/// ∂(displacement, rotation)/∂(force, moment) of the loaded equilibrium, by central differences of fourth order.
Matrix6 measured_compliance(const Arm& arm, const Eigen::VectorXd& unloaded, const Wrench& wrench) {
  Matrix6 out;
  const Eigen::Matrix3d loaded = loaded_posture(arm, unloaded, tip, wrench).flange.linear();
  for (int j = 0; j < 6; ++j) {
    const double h = 200.0;
    const auto at = [&](double change) {
      Wrench w = wrench;
      (j < 3 ? w.force_n : w.moment_n_m)(j % 3) += change;
      const LoadedPosture posture = loaded_posture(arm, unloaded, tip, w);
      EXPECT_EQ(posture.status, LoadedPosture::Status::converged);
      const Eigen::AngleAxisd turn(Eigen::Matrix3d(posture.flange.linear() * loaded.transpose()));
      Eigen::Matrix<double, 6, 1> moved;
      moved << posture.displacement_m, turn.angle() * turn.axis();
      return moved;
    };
    out.col(j) = (8.0 * (at(h) - at(-h)) - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * h);
  }
  return out;
}

/// Largest difference of translation and rotation due to force and moment, each as a share of its block's largest.
double difference(const Matrix6& a, const Matrix6& b) {
  double out = 0.0;
  for (int i = 0; i < 6; i += 3) {
    for (int j = 0; j < 6; j += 3) {
      out = std::max(out, (a - b).block<3, 3>(i, j).cwiseAbs().maxCoeff() / b.block<3, 3>(i, j).cwiseAbs().maxCoeff());
    }
  }
  return out;
}

// Source: kinematics and joint stiffness of [GbtAdl2023]; eigenvalues of that model, to 0.001 N/um.
TEST(Stiffness, HasTheEigenvaluesOfTheKr210sModel) {
  const Stiffness s = stiffness(testing::kr210(), testing::kr210_posture(), Eigen::Vector3d::Zero());
  EXPECT_EQ(s.status, Stiffness::Status::regular);
  const PrincipalStiffness principal = principal_stiffness(s.compliance);
  EXPECT_NEAR(principal.stiffness_n_per_m(0), 0.544e6, 0.0005e6);
  EXPECT_NEAR(principal.stiffness_n_per_m(1), 0.606e6, 0.0005e6);
  EXPECT_NEAR(principal.stiffness_n_per_m(2), 4.719e6, 0.0005e6);
  const Eigen::Matrix3d block = s.compliance.topLeftCorner<3, 3>();
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d direction = principal.direction.col(i);
    EXPECT_LT((block * direction * principal.stiffness_n_per_m(i) - direction).norm(), 1e-12);
  }
}

TEST(Stiffness, IsThatOfTheLoadedEquilibrium) {
  const Arm arm = testing::kr210();
  for (const double force_n : {374.0, 37e3}) {
    const Wrench wrench = milling(force_n);
    const LoadedPosture loaded = loaded_posture(arm, testing::kr210_posture(), tip, wrench);
    ASSERT_EQ(loaded.status, LoadedPosture::Status::converged);
    const Matrix6 measured = measured_compliance(arm, testing::kr210_posture(), wrench);
    const Stiffness s = stiffness(arm, loaded.position, tip, wrench);
    EXPECT_LT(difference(s.compliance, measured), 1e-6) << force_n << " N";
    EXPECT_LT(difference(s.stiffness, linear_algebra::inverse(Eigen::MatrixXd(measured))), 1e-6) << force_n << " N";
    // Without Kc it is not, so that the check sees Kc.
    EXPECT_GT(difference(stiffness(arm, loaded.position, tip).compliance, measured), 1e-5) << force_n << " N";
  }
}

TEST(Stiffness, IsThatOfTheLoadedEquilibriumUnderAMomentToo) {
  const Arm arm = testing::kr210();
  const Wrench wrench{.force_n = {900.0, 4000.0, -3000.0}, .moment_n_m = {-2000.0, 5000.0, 8000.0}};
  const LoadedPosture loaded = loaded_posture(arm, testing::kr210_posture(), tip, wrench);
  const Matrix6 measured = measured_compliance(arm, testing::kr210_posture(), wrench);
  EXPECT_LT(difference(stiffness(arm, loaded.position, tip, wrench).compliance, measured), 1e-6);
  EXPECT_GT(difference(measured.transpose(), measured), 1e-4);
}

// [BallEndRobot] eq. 17 prints Kc = (∂J⁻ᵀ/∂θ) F: not only is its unit another one, it also fails the check that Jᵀ
// passes.
TEST(Stiffness, IsNotWhatTheMisprintGives) {
  const Arm arm = testing::kr210();
  for (const double force_n : {374.0, 37e3}) {
    const Wrench wrench = milling(force_n);
    const LoadedPosture loaded = loaded_posture(arm, testing::kr210_posture(), tip, wrench);
    const Jacobian jac = jacobian(arm, loaded.position, tip);
    const Matrix6 inverse = linear_algebra::inverse(Eigen::MatrixXd(jac)).transpose();
    Eigen::Matrix<double, 6, 1> force;
    force << wrench.force_n, wrench.moment_n_m;
    Matrix6 joint = Matrix6::Zero();
    for (int k = 0; k < 6; ++k) {
      joint.col(k) = inverse * testing::jacobian_derivative(jac, k).transpose() * inverse * force;
      joint(k, k) += arm.joints[static_cast<std::size_t>(k)].stiffness;
    }
    const Matrix6 printed = jac * linear_algebra::inverse(Eigen::MatrixXd(joint)) * jac.transpose();
    const Matrix6 measured = measured_compliance(arm, testing::kr210_posture(), wrench);
    const double error = difference(printed, measured);
    EXPECT_GT(error, 100.0 * difference(stiffness(arm, loaded.position, tip, wrench).compliance, measured));
    EXPECT_GT(error, 1e-5) << force_n << " N";
  }
}

TEST(Stiffness, LoadStiffnessIsTheDerivativeOfTheTorque) {
  Random random(5);
  for (int k = 0; k < 20; ++k) {
    const Arm arm = testing::random_chain(random, 6);
    const Eigen::VectorXd position = testing::random_position(random, 6);
    const Wrench wrench{.force_n = testing::random_vector(random), .moment_n_m = testing::random_vector(random)};
    Eigen::Matrix<double, 6, 1> stacked;
    stacked << wrench.force_n, wrench.moment_n_m;
    const Jacobian jac = jacobian(arm, position, tip);
    const Eigen::MatrixXd kc = load_stiffness(jac, wrench);
    for (Eigen::Index i = 0; i < 6; ++i) {
      EXPECT_LT((kc.col(i) - testing::jacobian_derivative(jac, i).transpose() * stacked).norm(), 1e-13);
    }
  }
}

TEST(Stiffness, ReportsSingularPosturesAndWhatBuckles) {
  const Arm arm = testing::kr210();
  Eigen::VectorXd straight = testing::kr210_posture();
  straight(4) = 0.0;
  const Stiffness singular = stiffness(arm, straight, tip);
  EXPECT_EQ(singular.status, Stiffness::Status::singular);
  EXPECT_GT(singular.condition_number, 1e12);
  EXPECT_TRUE(singular.stiffness.isZero());
  EXPECT_TRUE(singular.compliance.allFinite());

  // Of a wide Jacobian, against the singular values of the matrix itself.
  Random random(6);
  const Arm eight = testing::random_chain(random, 8);
  Jacobian wide = jacobian(eight, testing::random_position(random, 8), tip);
  const double number = condition_number(wide, 0.4);
  wide.topRows<3>() /= 0.4;
  const Eigen::VectorXd singular_values = linear_algebra::thin_svd(Eigen::MatrixXd(wide)).values;
  EXPECT_NEAR(number, singular_values(0) / singular_values(5), 1e-12 * number);

  const Wrench huge = milling(5e7);
  EXPECT_EQ(stiffness(arm, testing::kr210_posture(), tip, huge).status, Stiffness::Status::buckled);
  const Arm five = arm_from_dh(std::vector<DhRow>(5, {.a_m = 0.3, .alpha_rad = 1.0}));
  EXPECT_TRUE(std::isinf(condition_number(jacobian(five, Eigen::VectorXd::Ones(5), tip))));
}

// One joint of lever a and stiffness k under a force F towards its axis: it holds until F a = k and then folds.
TEST(Stiffness, AnInvertedPendulumBucklesAtItsLoad) {
  Arm arm = arm_from_dh({{.a_m = 2.0}});
  arm.joints[0].stiffness = 1000.0;
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(1);
  const auto under = [&](double force_n) { return Wrench{.force_n = {-force_n, 0.0, 0.0}}; };
  const LoadedPosture below = loaded_posture(arm, zero, Eigen::Vector3d::Zero(), under(499.0));
  EXPECT_EQ(below.status, LoadedPosture::Status::converged);
  EXPECT_EQ(below.position(0), 0.0);
  EXPECT_EQ(loaded_posture(arm, zero, Eigen::Vector3d::Zero(), under(501.0)).status, LoadedPosture::Status::buckled);
  EXPECT_EQ(stiffness(arm, zero, Eigen::Vector3d::Zero(), under(501.0)).status, Stiffness::Status::buckled);
  // Across its lever: k θ = F a cos θ.
  const LoadedPosture bent = loaded_posture(arm, zero, Eigen::Vector3d::Zero(), {.force_n = {0.0, 800.0, 0.0}});
  EXPECT_EQ(bent.status, LoadedPosture::Status::converged);
  EXPECT_NEAR(1000.0 * bent.position(0), 800.0 * 2.0 * std::cos(bent.position(0)), 1e-9);
  EXPECT_NEAR(bent.rotation_rad.z(), bent.position(0), 1e-12);
  EXPECT_NEAR(bent.displacement_m.y(), 2.0 * std::sin(bent.position(0)), 1e-12);
}

TEST(Stiffness, RejectsAnArmWithoutStiffnessAndNumbersThatAreNone) {
  Arm arm = testing::kr210();
  const Eigen::VectorXd position = testing::kr210_posture();
  arm.joints[3].stiffness = 0.0;
  EXPECT_EQ(field_of([&] { (void)stiffness(arm, position, tip); }), "joints[4].stiffness");
  EXPECT_EQ(field_of([&] { (void)loaded_posture(arm, position, tip, {}); }), "joints[4].stiffness");
  arm = testing::kr210();
  EXPECT_EQ(field_of([&] { (void)stiffness(arm, position.head(5), tip); }), "position");
  const Wrench none{.force_n = {std::nan(""), 0.0, 0.0}};
  EXPECT_EQ(field_of([&] { (void)stiffness(arm, position, tip, none); }), "wrench.force_n");
  EXPECT_EQ(field_of([&] { (void)loaded_posture(arm, position, Eigen::Vector3d(0.0, std::nan(""), 0.0), {}); }),
            "point_m");
  EXPECT_EQ(field_of([&] { (void)stiffness(arm, position, tip, {}, {.characteristic_length_m = 0.0}); }),
            "characteristic_length_m");
  EXPECT_EQ(field_of([&] { (void)stiffness(arm, position, tip, {}, {.max_condition_number = 0.0}); }),
            "max_condition_number");
  EXPECT_EQ(field_of([&] { (void)loaded_posture(arm, position, tip, {}, {.tolerance = 0.0}); }), "tolerance");
  EXPECT_EQ(field_of([&] { (void)loaded_posture(arm, position, tip, {}, {.max_iterations = 0}); }), "max_iterations");
}

}  // namespace stiffness_test
}  // namespace robomill::robot
