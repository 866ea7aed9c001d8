#include "testing/modal/structure.hpp"

#include <gtest/gtest.h>
#include <Eigen/Core>

#include <cmath>
#include <complex>
#include <cstdint>
#include <numbers>
#include <stdexcept>

#include "robomill/base/linear_algebra.hpp"
#include "robomill/base/random.hpp"
#include "testing/modal/fit_cases.hpp"
#include "testing/support.hpp"

namespace robomill::modal {
namespace structure_test {

using modal::testing::modes_of;
using modal::testing::Structure;
using Complex = std::complex<double>;

Eigen::MatrixXd random_matrix(Random& random, Eigen::Index n) {
  Eigen::MatrixXd matrix(n, n);
  for (double& value : matrix.reshaped()) value = random.normal();
  return matrix;
}

/// Two to six degrees of freedom, natural frequencies of tens to hundreds of hertz, damping of a few percent that is
/// not proportional, and no matrix symmetric.
Structure random_structure(std::uint64_t seed) {
  Random random(seed);
  const Eigen::Index n = 2 + static_cast<Eigen::Index>(random.index(5));
  Structure structure;
  for (Eigen::Index i = 0; i < n; ++i) structure.dofs.push_back({.point = static_cast<int>(i), .axis = Axis::x});
  Eigen::MatrixXd stiffness_ratios = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    stiffness_ratios(i, i) = 1e5 * std::pow(3.0, static_cast<double>(i)) * random.uniform(0.8, 1.2);
  const Eigen::MatrixXd mixing = Eigen::MatrixXd::Identity(n, n) + 0.15 * random_matrix(random, n);
  structure.mass_kg = mixing * mixing.transpose() + 0.02 * random_matrix(random, n);
  structure.stiffness_n_per_m = mixing * stiffness_ratios * mixing.transpose() + 1e3 * random_matrix(random, n);
  structure.damping_n_s_per_m =
      mixing * (0.1 * stiffness_ratios.cwiseSqrt()) * mixing.transpose() + 1.0 * random_matrix(random, n);
  return structure;
}

Structure one_mass(double mass_kg, double damping_n_s_per_m, double stiffness_n_per_m) {
  return {.dofs = {Dof{}},
          .mass_kg = Eigen::MatrixXd::Constant(1, 1, mass_kg),
          .damping_n_s_per_m = Eigen::MatrixXd::Constant(1, 1, damping_n_s_per_m),
          .stiffness_n_per_m = Eigen::MatrixXd::Constant(1, 1, stiffness_n_per_m)};
}

/// (-ω² M + iω C + K)⁻¹, excitation by excitation (xx, yx, xy, yy).
FrfSet receptance(const Structure& structure, const Eigen::VectorXd& frequency_hz) {
  const Eigen::Index n = structure.mass_kg.rows();
  FrfSet set;
  set.frequency_hz = frequency_hz;
  for (const Dof& excitation : structure.dofs) {
    for (const Dof& response : structure.dofs) {
      set.frfs.push_back({.name = {response, excitation}, .receptance = Eigen::VectorXcd::Zero(frequency_hz.size())});
    }
  }
  for (Eigen::Index line = 0; line < frequency_hz.size(); ++line) {
    const double omega = 2.0 * std::numbers::pi * frequency_hz(line);
    const Eigen::MatrixXcd dynamic_stiffness =
        (structure.stiffness_n_per_m - omega * omega * structure.mass_kg).cast<Complex>() +
        Complex(0.0, omega) * structure.damping_n_s_per_m.cast<Complex>();
    const Eigen::MatrixXcd h = linear_algebra::inverse(dynamic_stiffness);
    for (Eigen::Index k = 0; k < n * n; ++k) set.frfs[static_cast<std::size_t>(k)].receptance(line) = h(k % n, k / n);
  }
  return set;
}

// ψR, ψL and λ as vectors that carry both poles of each pair.
struct Poles {
  Eigen::VectorXcd lambda;
  Eigen::MatrixXcd left, right;
};

Poles all_poles(const ModalModel& model) {
  const Eigen::Index n = static_cast<Eigen::Index>(model.modes.size());
  Poles poles{
      .lambda = Eigen::VectorXcd(2 * n), .left = Eigen::MatrixXcd(n, 2 * n), .right = Eigen::MatrixXcd(n, 2 * n)};
  for (Eigen::Index k = 0; k < n; ++k) {
    const Mode& mode = model.modes[static_cast<std::size_t>(k)];
    poles.lambda(k) = pole(mode);
    poles.left.col(k) = mode.left;
    poles.right.col(k) = mode.right;
  }
  poles.lambda.tail(n) = poles.lambda.head(n).conjugate();
  poles.left.rightCols(n) = poles.left.leftCols(n).conjugate();
  poles.right.rightCols(n) = poles.right.leftCols(n).conjugate();
  return poles;
}

TEST(Structure, ModalFrfIsTheInverseOfTheDynamicStiffness) {
  for (int seed = 0; seed < test::seeds(1000); ++seed) {
    const Structure structure = random_structure(static_cast<std::uint64_t>(seed));
    const ModalModel model = modes_of(structure);
    const Eigen::VectorXd lines = Eigen::VectorXd::LinSpaced(201, 0.0, 2.0 * model.modes.back().frequency_hz);
    ASSERT_LT(cases::relative_error(receptance(structure, lines), synthesize(model, lines)), 1e-10) << seed;
  }
}

// The eigenvalue equations of both sides, Ψ_Lᵀ A Ψ_R = I, and what follows from it for large and small frequencies.
TEST(Structure, EigenvectorsSolveTheirEquationsAndAreBiorthogonal) {
  for (int seed = 0; seed < test::seeds(1000); ++seed) {
    const Structure structure = random_structure(static_cast<std::uint64_t>(seed));
    const Eigen::Index n = structure.mass_kg.rows();
    const Poles poles = all_poles(modes_of(structure));
    for (Eigen::Index k = 0; k < 2 * n; ++k) {
      const Complex lambda = poles.lambda(k);
      const Eigen::MatrixXcd quadratic = lambda * lambda * structure.mass_kg.cast<Complex>() +
                                         lambda * structure.damping_n_s_per_m.cast<Complex>() +
                                         structure.stiffness_n_per_m.cast<Complex>();
      const double size = std::norm(lambda) * structure.mass_kg.norm() + structure.stiffness_n_per_m.norm();
      ASSERT_LT((quadratic * poles.right.col(k)).norm(), 1e-11 * size * poles.right.col(k).norm()) << seed;
      ASSERT_LT((quadratic.transpose() * poles.left.col(k)).norm(), 1e-11 * size * poles.left.col(k).norm()) << seed;
    }
    // Ψ_Lᵀ A Ψ_R with A = [C M; M 0] and Ψ = [ψ; λ ψ].
    const Eigen::MatrixXcd left_mass = poles.left.transpose() * structure.mass_kg.cast<Complex>() * poles.right;
    const Eigen::MatrixXcd left_damping =
        poles.left.transpose() * structure.damping_n_s_per_m.cast<Complex>() * poles.right;
    const Eigen::MatrixXcd product =
        left_damping + left_mass * poles.lambda.asDiagonal() + poles.lambda.asDiagonal() * left_mass;
    ASSERT_LT((product - Eigen::MatrixXcd::Identity(2 * n, 2 * n)).norm(), 1e-9) << seed;

    const Eigen::MatrixXcd sum = poles.right * poles.left.transpose();
    ASSERT_LT(sum.norm(), 1e-11 * poles.right.norm() * poles.left.norm()) << seed;
    const Eigen::MatrixXcd mobility = poles.right * poles.lambda.asDiagonal() * poles.left.transpose();
    const Eigen::MatrixXd mass_inverse = linear_algebra::inverse(structure.mass_kg);
    ASSERT_LT((mobility - mass_inverse.cast<Complex>()).norm(), 1e-10 * mass_inverse.norm()) << seed;
    const Eigen::MatrixXcd compliance =
        -poles.right * poles.lambda.cwiseInverse().asDiagonal() * poles.left.transpose();
    const Eigen::MatrixXd stiffness_inverse = linear_algebra::inverse(structure.stiffness_n_per_m);
    ASSERT_LT((compliance - stiffness_inverse.cast<Complex>()).norm(), 1e-10 * stiffness_inverse.norm()) << seed;
  }
}

TEST(Structure, VectorsKeepTheirNormalisationAndModesTheirOrder) {
  const ModalModel model = modes_of(random_structure(7));
  double last_hz = 0.0;
  for (const Mode& mode : model.modes) {
    EXPECT_GT(mode.frequency_hz, last_hz);
    last_hz = mode.frequency_hz;
    EXPECT_NEAR(mode.left.norm() / mode.right.norm(), 1.0, 1e-13);
    Eigen::Index largest = 0;
    mode.left.cwiseAbs().maxCoeff(&largest);
    EXPECT_GT(mode.left(largest).real(), 0.0);
    EXPECT_NEAR(mode.left(largest).imag(), 0.0, 1e-14 * mode.left.norm());
  }
}

TEST(Structure, IsReciprocalOnlyIfSymmetric) {
  Structure structure = random_structure(3);
  const Eigen::VectorXd lines = Eigen::VectorXd::LinSpaced(101, 5.0, 300.0);
  const FrfName forth{structure.dofs[0], structure.dofs[1]};
  const FrfName back{structure.dofs[1], structure.dofs[0]};
  const auto asymmetry = [&] {
    const FrfSet set = synthesize(modes_of(structure), lines);
    return (set.find(forth)->receptance - set.find(back)->receptance).norm() / set.find(forth)->receptance.norm();
  };
  EXPECT_GT(asymmetry(), 0.01);
  for (Eigen::MatrixXd* matrix : {&structure.mass_kg, &structure.damping_n_s_per_m, &structure.stiffness_n_per_m}) {
    *matrix = Eigen::MatrixXd(0.5 * (*matrix + matrix->transpose()));
  }
  EXPECT_LT(asymmetry(), 1e-11);
  for (const Mode& mode : modes_of(structure).modes) {
    EXPECT_LT((mode.left * mode.right.transpose() - mode.right * mode.left.transpose()).norm(),
              1e-11 * mode.left.squaredNorm());
  }
}

// One mass: residue 1 / (2 i m ω sqrt(1 - ζ²)), so that ψ = sqrt(|residue|).
TEST(Structure, OneMassHasItsClosedForm) {
  const double omega = 2.0 * std::numbers::pi * 922.0;
  const double mass = 0.03993;
  const ModalModel model = modes_of(one_mass(mass, 2.0 * 0.011 * omega * mass, omega * omega * mass));
  ASSERT_EQ(model.modes.size(), 1U);
  EXPECT_NEAR(model.modes[0].frequency_hz, 922.0, 1e-9);
  EXPECT_NEAR(model.modes[0].damping_ratio, 0.011, 1e-12);
  const Complex residue = model.modes[0].right(0) * model.modes[0].left(0);
  const Complex expected = 1.0 / Complex(0.0, 2.0 * mass * omega * std::sqrt(1.0 - 0.011 * 0.011));
  EXPECT_LT(std::abs(residue - expected), 1e-11 * std::abs(expected));
}

// Equal modes in x and y, seen in turned axes: the poles coincide, the eigenvectors do not.
TEST(Structure, RepeatedPolesKeepIndependentVectors) {
  for (const double angle : {0.0, 0.3, 1.0}) {
    Eigen::Matrix2d turn;
    turn << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
    const auto turned = [&](double value) -> Eigen::MatrixXd {
      return turn * (value * Eigen::Matrix2d::Identity()) * turn.transpose();
    };
    const Structure structure{.dofs = {{.axis = Axis::x}, {.axis = Axis::y}},
                              .mass_kg = turned(0.5),
                              .damping_n_s_per_m = turned(10.0),
                              .stiffness_n_per_m = turned(1e6)};
    const Eigen::VectorXd lines = Eigen::VectorXd::LinSpaced(101, 0.0, 500.0);
    EXPECT_LT(cases::relative_error(receptance(structure, lines), synthesize(modes_of(structure), lines)), 1e-10)
        << angle;
  }
}

TEST(Structure, RejectsPolesThatNoModeCanHold) {
  const auto rejected = [](double damping_n_s_per_m, double stiffness_n_per_m) {
    EXPECT_THROW(static_cast<void>(modes_of(one_mass(1.0, damping_n_s_per_m, stiffness_n_per_m))),
                 std::invalid_argument);
  };
  rejected(300.0, 1e4);  // ζ = 1.5
  rejected(0.0, 1e4);    // undamped
  rejected(-2.0, 1e4);   // driven
  rejected(2.0, -1e4);   // buckled
}

}  // namespace structure_test
}  // namespace robomill::modal
