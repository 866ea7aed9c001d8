#include "testing/modal/simulated_arm.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <complex>
#include <limits>

#include "robomill/base/linear_algebra.hpp"
#include "robomill/base/random.hpp"
#include "robomill/robot/dynamics.hpp"
#include "testing/support.hpp"

namespace robomill::modal::testing {
namespace simulated_arm_test {

using Complex = std::complex<double>;

Eigen::Matrix3cd matrix_at(const FrfSet& set, Eigen::Index line) {
  Eigen::Matrix3cd out;
  for (Eigen::Index k = 0; k < 9; ++k) out(k % 3, k / 3) = set.frfs[static_cast<std::size_t>(k)].receptance(line);
  return out;
}

// With every tilt and the tool locked the arm is the rigid one that robomill/robot/dynamics knows.
TEST(SimulatedArm, HasTheMassOfTheRigidArmWhereTiltsAreLocked) {
  for (std::uint64_t seed = 0; seed < 16; ++seed) {
    const SimulatedArm arm(seed);
    const Eigen::VectorXd& joints = arm.measured_postures()[seed % 12];
    const Eigen::MatrixXd mass = arm.matrices(joints).mass, rigid = robot::mass_matrix(arm.exact().arm, joints);
    Eigen::MatrixXd turns(6, 6);
    for (Eigen::Index i = 0; i < 6; ++i) {
      for (Eigen::Index j = 0; j < 6; ++j) turns(i, j) = mass(3 * i, 3 * j);
    }
    EXPECT_LT((turns - rigid).norm(), 1e-12 * rigid.norm()) << seed;
  }
}

// The tip's rows are the Jacobian: the spindle's pose is that of the cell.
TEST(SimulatedArm, MovesItsTipAsTheCellDoes) {
  for (std::uint64_t seed = 0; seed < 16; ++seed) {
    const SimulatedArm arm(seed);
    const Eigen::VectorXd& joints = arm.held_out_postures()[seed % 8];
    const Eigen::Matrix<double, 6, Eigen::Dynamic> jac =
        robot::jacobian(arm.told().arm, joints, Eigen::Vector3d(0.0, 0.0, arm.told().tool_length_m));
    const Eigen::Matrix3Xd tip = arm.matrices(joints).tip;
    for (Eigen::Index i = 0; i < 6; ++i) EXPECT_LT((tip.col(3 * i) - jac.col(i).head<3>()).norm(), 1e-12) << seed;
    const Eigen::Vector3d axis = robot::forward(arm.told().arm, joints).linear().col(2);
    EXPECT_LT((axis.transpose() * tip.rightCols(4)).norm(), 1e-12) << "the tool bends across its axis";
  }
}

TEST(SimulatedArm, HasAReceptanceThatIsThatOfItsModesSymmetricAndPassive) {
  for (std::uint64_t seed = 0; seed < 16; ++seed) {
    const SimulatedArm arm(seed);
    const Eigen::VectorXd& joints = arm.measured_postures()[(3 * seed) % 12];
    const Eigen::VectorXd frequency_hz = Eigen::VectorXd::LinSpaced(60, 3.0, 700.0);
    const FrfSet exact = arm.receptance(joints, frequency_hz);
    const FrfSet all = synthesize(arm.modes(joints, std::numeric_limits<double>::infinity()), frequency_hz);
    for (Eigen::Index line = 0; line < frequency_hz.size(); ++line) {
      const Eigen::Matrix3cd h = matrix_at(exact, line);
      EXPECT_LT((matrix_at(all, line) - h).norm(), 1e-7 * h.norm()) << seed;
      EXPECT_LT((h - h.transpose()).norm(), 1e-9 * h.norm()) << seed;
      const Eigen::MatrixXd loss = -h.imag();
      EXPECT_GT(linear_algebra::symmetric_eigen_pairs(loss).values(0), -1e-9 * h.norm()) << seed;
    }
    // What is above 700 Hz is taken at rest: (150 / 700)^2 is missing of it.
    const Eigen::VectorXd low_hz = Eigen::VectorXd::LinSpaced(60, 3.0, 150.0);
    const FrfSet exact_low = arm.receptance(joints, low_hz);
    const ModalModel few = arm.modes(joints);
    const FrfSet of_few = synthesize(few, low_hz);
    Eigen::Matrix3d rest;
    for (Eigen::Index k = 0; k < 9; ++k)
      rest(k % 3, k / 3) = few.residuals[static_cast<std::size_t>(k)].stiffness.real();
    for (Eigen::Index line = 0; line < low_hz.size(); ++line) {
      EXPECT_LT((matrix_at(of_few, line) - matrix_at(exact_low, line)).norm(), 0.06 * rest.norm()) << seed;
    }
  }
}

TEST(SimulatedArm, HasModesLikeThoseOfRealArms) {
  for (std::uint64_t seed = 0; seed < 16; ++seed) {
    const SimulatedArm arm(seed);
    const ModalModel model = arm.modes(arm.measured_postures()[0]);
    EXPECT_GE(model.modes.size(), 8U) << seed;
    EXPECT_GT(model.modes.front().frequency_hz, arm.is_heavy() ? 4.0 : 6.0) << seed;
    EXPECT_LT(model.modes.front().frequency_hz, arm.is_heavy() ? 20.0 : 30.0) << seed;
    for (const Mode& mode : model.modes) {
      EXPECT_GT(mode.damping_ratio, 0.005) << seed << " " << mode.frequency_hz;
      EXPECT_LT(mode.damping_ratio, 0.12) << seed << " " << mode.frequency_hz;
    }
    EXPECT_EQ(arm.bracket_axes() > 0, (seed / 2) % 2 == 1);
  }
}

// The joints' stiffness at a posture is not that at another: no constant explains all postures.
TEST(SimulatedArm, HasAStiffnessThatDependsOnThePosture) {
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    const SimulatedArm arm(seed);
    double widest = 0.0;
    for (Eigen::Index i = 0; i < 6; ++i) {
      double low = 1e300, high = 0.0;
      for (const Eigen::VectorXd& joints : arm.measured_postures()) {
        const double k = arm.matrices(joints).stiffness(3 * i, 3 * i);
        low = std::min(low, k);
        high = std::max(high, k);
        const double k0 = arm.exact().arm.joints[static_cast<std::size_t>(i)].stiffness;
        EXPECT_GT(k, 0.89 * k0);
        EXPECT_LT(k, 1.25 * k0);
      }
      widest = std::max(widest, high / low - 1.0);
    }
    EXPECT_GT(widest, 0.03) << seed;
  }
}

TEST(SimulatedArm, TellsWhatIsOffByAFifthAtMostAndMeasuresWithNoise) {
  const SimulatedArm arm(6), again(6);
  ASSERT_EQ(arm.measured_postures().size(), 12U);
  ASSERT_EQ(arm.held_out_postures().size(), 8U);
  for (std::size_t i = 0; i < 6; ++i) {
    const robot::Joint &told = arm.told().arm.joints[i], &exact = arm.exact().arm.joints[i];
    EXPECT_NEAR(told.stiffness / exact.stiffness, 1.0, 0.2);
    EXPECT_NEAR(told.link.mass_kg / exact.link.mass_kg, 1.0, 0.2);
    EXPECT_NE(told.link.mass_kg, exact.link.mass_kg);
  }
  const Eigen::VectorXd& joints = arm.measured_postures()[5];
  const FrfSet measured = arm.measure(joints, 11), same = again.measure(joints, 11), other = arm.measure(joints, 12);
  ASSERT_EQ(measured.frfs.size(), 9U);
  EXPECT_EQ(measured.frequency_hz.size(), 696);
  const FrfSet exact = arm.receptance(joints, measured.frequency_hz);
  for (std::size_t k = 0; k < 9; ++k) {
    EXPECT_TRUE((measured.frfs[k].receptance.array() == same.frfs[k].receptance.array()).all());
    EXPECT_FALSE((measured.frfs[k].receptance.array() == other.frfs[k].receptance.array()).all());
    const Eigen::ArrayXcd error = measured.frfs[k].receptance - exact.frfs[k].receptance;
    const double share = std::sqrt((error.abs2() / exact.frfs[k].receptance.array().abs2()).mean());
    EXPECT_NEAR(share, 0.05, 0.006);
  }
  EXPECT_EQ(arm.measure(joints, 11, {.force_in_z = false}).frfs.size(), 6U);
}

}  // namespace simulated_arm_test
}  // namespace robomill::modal::testing
