#include "robomill/robot/dynamics.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <complex>

#include "robomill/base/linear_algebra.hpp"
#include "robomill/base/random.hpp"
#include "robomill/robot/stiffness.hpp"
#include "testing/robot/arms.hpp"
#include "testing/support.hpp"

namespace robomill::robot {
namespace dynamics_test {

using robomill::test::field_of;
using robomill::test::seeds;
using Complex = std::complex<double>;
using Matrix6c = Eigen::Matrix<Complex, 6, 6>;

const Eigen::Vector3d tip(0.05, -0.02, 0.3);

/// Any arm with masses, rotors, stiffness and a damping that is not proportional.
void furnish(Arm& arm, Random& random) {
  for (Joint& joint : arm.joints) {
    joint.stiffness = random.uniform(0.5e6, 4e6);
    joint.damping = random.uniform(50.0, 2000.0);
    joint.rotor_inertia = random.uniform(0.0, 5.0);
    joint.link.mass_kg = random.uniform(5.0, 200.0);
    joint.link.center_m = 0.3 * testing::random_vector(random);
    const Eigen::Matrix3d turn = testing::random_pose(random, 0.0).linear();
    const Eigen::Vector3d principal(random.uniform(1.0, 2.0), random.uniform(1.0, 2.0), random.uniform(1.0, 2.0));
    joint.link.inertia_kg_m2 = turn * principal.asDiagonal() * turn.transpose();
    joint.link.inertia_kg_m2 = (0.5 * (joint.link.inertia_kg_m2 + joint.link.inertia_kg_m2.transpose())).eval();
  }
}

// Σ Jᵀ m J of each link by its own Jacobian, of an arm that ends there.
TEST(Dynamics, MassMatrixIsThatOfTheLinksOneByOne) {
  Random random(71);
  for (int k = 0; k < 30; ++k) {
    Arm arm = testing::random_chain(random, 1 + k % 7);
    furnish(arm, random);
    const Eigen::VectorXd position = testing::random_position(random, arm.size());
    Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(arm.size(), arm.size());
    Arm part;
    for (const Joint& joint : arm.joints) {
      part.joints.push_back(joint);
      const Eigen::Index m = part.size();
      const Eigen::Matrix<double, 6, Eigen::Dynamic> jac = jacobian(part, position.head(m), joint.link.center_m);
      const Eigen::Matrix3d turn = forward(part, position.head(m)).linear();
      expected.topLeftCorner(m, m) +=
          joint.link.mass_kg * jac.topRows<3>().transpose() * jac.topRows<3>() +
          jac.bottomRows<3>().transpose() * turn * joint.link.inertia_kg_m2 * turn.transpose() * jac.bottomRows<3>();
      expected(m - 1, m - 1) += joint.rotor_inertia;
    }
    EXPECT_LT((mass_matrix(arm, position) - expected).cwiseAbs().maxCoeff(), 1e-12 * expected.cwiseAbs().maxCoeff());
  }
}

/// H of the modes at a frequency, 6 x 6.
Matrix6c receptance(const ToolModes& modes, double frequency_hz) {
  const Complex s(0.0, 2.0 * testing::pi * frequency_hz);
  Matrix6c out = Matrix6c::Zero();
  for (const ToolMode& mode : modes.modes) {
    const double rate = 2.0 * testing::pi * mode.frequency_hz;
    const Complex pole(-mode.damping_ratio * rate,
                       rate * std::sqrt(std::max(0.0, 1.0 - mode.damping_ratio * mode.damping_ratio)));
    const Matrix6c residue = mode.right * mode.left.transpose();
    out += residue / (s - pole) + residue.conjugate() / (s - std::conj(pole));
  }
  for (const OverdampedMode& mode : modes.overdamped) {
    out += (mode.right * mode.left.transpose()).cast<Complex>() / (s + mode.decay_per_s);
  }
  return out;
}

TEST(Dynamics, ModesSumToTheReceptance) {
  for (int k = 0; k < seeds(300); ++k) {
    Random random(73, static_cast<std::uint64_t>(k));
    Arm arm = k % 2 == 0 ? testing::kr210() : testing::random_chain(random, 2 + k % 6);
    furnish(arm, random);
    if (k % 5 == 0) arm.joints[1].damping = 1e6;  // more than critical
    const Eigen::VectorXd position = testing::random_position(random, arm.size());
    const ToolModes modes = tool_modes(arm, position, tip);
    EXPECT_EQ(static_cast<Eigen::Index>(2 * modes.modes.size() + modes.overdamped.size()), 2 * arm.size());
    if (k % 5 == 0) {
      EXPECT_FALSE(modes.overdamped.empty());
    }
    const Eigen::Matrix<double, 6, Eigen::Dynamic> jac = jacobian(arm, position, tip);
    Eigen::MatrixXd stiff = Eigen::MatrixXd::Zero(arm.size(), arm.size()), damp = stiff;
    for (Eigen::Index i = 0; i < arm.size(); ++i) {
      stiff(i, i) = arm.joints[static_cast<std::size_t>(i)].stiffness;
      damp(i, i) = arm.joints[static_cast<std::size_t>(i)].damping;
    }
    const Eigen::MatrixXd mass = mass_matrix(arm, position);
    for (int line = 0; line < 20; ++line) {
      const double frequency_hz = random.uniform(0.0, 100.0), w = 2.0 * testing::pi * frequency_hz;
      const Eigen::MatrixXcd dynamic = (stiff - w * w * mass).cast<Complex>() + Complex(0.0, w) * damp.cast<Complex>();
      const Matrix6c expected =
          jac.cast<Complex>() * linear_algebra::inverse(dynamic) * jac.transpose().cast<Complex>();
      EXPECT_LT((receptance(modes, frequency_hz) - expected).norm(), 1e-10 * expected.norm());
    }
    for (const ToolMode& mode : modes.modes) EXPECT_LT((mode.right - mode.left).norm(), 1e-7 * mode.right.norm());
    for (std::size_t i = 1; i < modes.modes.size(); ++i) {
      EXPECT_LE(modes.modes[i - 1].frequency_hz, modes.modes[i].frequency_hz);
    }
    // At rest it is the compliance.
    const Eigen::Matrix<double, 6, 6> at_rest = stiffness(arm, position, tip).compliance;
    EXPECT_LT((receptance(modes, 0.0).real() - at_rest).norm(), 1e-10 * at_rest.norm());
  }
}

// A lever of 2 m with 10 kg at its end on a spring: ω² = k / (m a²), R Lᵀ = a² / (m a² 2i ω √(1 − ζ²)).
TEST(Dynamics, HasTheModeOfAPendulum) {
  Arm arm = arm_from_dh({{.a_m = 2.0}});
  arm.joints[0].stiffness = 4e5;
  arm.joints[0].damping = 80.0;
  arm.joints[0].link = {.mass_kg = 10.0, .center_m = {2.0, 0.0, 0.0}};
  const double inertia = 40.0, rate = std::sqrt(4e5 / inertia), ratio = 80.0 / (2.0 * inertia * rate);
  const ToolModes modes = tool_modes(arm, Eigen::VectorXd::Zero(1), Eigen::Vector3d::Zero());
  ASSERT_EQ(modes.modes.size(), 1U);
  const ToolMode& mode = modes.modes[0];
  EXPECT_NEAR(mode.frequency_hz, rate / (2.0 * testing::pi), 1e-10);
  EXPECT_NEAR(mode.damping_ratio, ratio, 1e-12);
  const Complex residue = mode.right(1) * mode.left(1);
  const Complex expected = 4.0 / inertia / Complex(0.0, 2.0 * rate * std::sqrt(1.0 - ratio * ratio));
  EXPECT_LT(std::abs(residue - expected), 1e-12 * std::abs(expected));
  EXPECT_LT(std::abs(mode.right(0)), 1e-15);
}

// Without what couples them every joint is an oscillator of its own: ω² = k / m_ii, ζ = c / (2 √(k m_ii)), and moves
// the point by its column of the Jacobian.
TEST(Dynamics, OfTheJointsOwnInertia) {
  Random random(76);
  Arm arm = testing::kr210();
  furnish(arm, random);
  const Eigen::VectorXd position = testing::kr210_posture();
  const Eigen::VectorXd mass = mass_matrix(arm, position).diagonal();
  const Eigen::Matrix<double, 6, Eigen::Dynamic> jac = jacobian(arm, position, tip);
  const ToolModes found = tool_modes(arm, position, tip, Inertia::diagonal);
  ASSERT_EQ(found.modes.size(), 6U);
  for (Eigen::Index i = 0; i < 6; ++i) {
    const Joint& joint = arm.joints[static_cast<std::size_t>(i)];
    const double hz = std::sqrt(joint.stiffness / mass(i)) / (2.0 * testing::pi);
    const auto mode =
        std::ranges::min_element(found.modes, {}, [&](const ToolMode& m) { return std::abs(m.frequency_hz - hz); });
    EXPECT_NEAR(mode->frequency_hz, hz, 1e-9 * hz);
    EXPECT_NEAR(mode->damping_ratio, joint.damping / (2.0 * std::sqrt(joint.stiffness * mass(i))), 1e-9);
    const double along =
        std::abs(mode->right.dot(jac.col(i).cast<Complex>())) / (mode->right.norm() * jac.col(i).norm());
    EXPECT_NEAR(along, 1.0, 1e-9);
  }
  EXPECT_GT(std::abs(tool_modes(arm, position, tip).modes[0].frequency_hz / found.modes[0].frequency_hz - 1.0), 1e-3);
}

TEST(Dynamics, RejectsAnArmWithoutMass) {
  Random random(75);
  Arm arm = testing::kr210();
  const Eigen::VectorXd position = testing::kr210_posture();
  EXPECT_EQ(field_of([&] { (void)tool_modes(arm, position, tip); }), "joints[1].link.mass_kg");
  // A point mass on the last axis alone: the wrist's turning moves nothing.
  for (Joint& joint : arm.joints) joint.link.mass_kg = 10.0;
  EXPECT_NE(field_of([&] { (void)tool_modes(arm, position, tip); }), "accepted");
  furnish(arm, random);
  EXPECT_EQ(field_of([&] { (void)mass_matrix(arm, position.head(5)); }), "position");
  arm.joints[2].stiffness = 0.0;
  EXPECT_EQ(field_of([&] { (void)tool_modes(arm, position, tip); }), "joints[3].stiffness");
}

}  // namespace dynamics_test
}  // namespace robomill::robot
