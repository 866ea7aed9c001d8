#include "robomill/modal/mac.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>

#include "robomill/base/error.hpp"
#include "robomill/base/random.hpp"
#include "testing/robot_modes.hpp"

namespace robomill::modal {
namespace mac_test {

using Complex = std::complex<double>;

Eigen::VectorXcd random_vector(Random& random, Eigen::Index n) {
  Eigen::VectorXcd vector(n);
  for (Complex& value : vector) {
    const double re = random.normal();
    value = {re, random.normal()};
  }
  return vector;
}

TEST(Mac, IsOneForAMultipleZeroForAnOrthogonalVectorAndBetweenElse) {
  Random random(1);
  for (int i = 0; i < 100; ++i) {
    const Eigen::VectorXcd a = random_vector(random, 4);
    Eigen::VectorXcd b = random_vector(random, 4);
    EXPECT_NEAR(mac(a, Complex(-0.3, 2.0) * a), 1.0, 1e-14);
    EXPECT_NEAR(mac(1e-200 * a, 1e200 * a), 1.0, 1e-14);
    EXPECT_DOUBLE_EQ(mac(a, b), mac(b, a));
    EXPECT_NEAR(mac(a, b), std::norm(a.dot(b)) / (a.squaredNorm() * b.squaredNorm()), 1e-14);
    b -= a * a.dot(b) / a.squaredNorm();
    EXPECT_NEAR(mac(a, b), 0.0, 1e-14);
  }
  EXPECT_EQ(mac(Eigen::Vector2cd::Zero(), Eigen::Vector2cd::Ones()), 0.0);
  // Without the conjugate this would be zero.
  EXPECT_NEAR(mac(Eigen::Vector2cd(1.0, Complex(0.0, 1.0)), Eigen::Vector2cd(1.0, Complex(0.0, 1.0))), 1.0, 1e-14);
}

TEST(Mac, BetweenModesIsThatOfTheirResidues) {
  const ModalModel model = data::robot_modes();
  const Eigen::MatrixXd with_itself = mac(model, model);
  ASSERT_EQ(with_itself.rows(), 8);
  for (Eigen::Index i = 0; i < 8; ++i) {
    EXPECT_NEAR(with_itself(i, i), 1.0, 1e-14);
    for (Eigen::Index j = 0; j < 8; ++j) {
      const Mode& a = model.modes[static_cast<std::size_t>(i)];
      const Mode& b = model.modes[static_cast<std::size_t>(j)];
      const Eigen::MatrixXcd residue_a = a.right * a.left.transpose();
      const Eigen::MatrixXcd residue_b = b.right * b.left.transpose();
      EXPECT_NEAR(with_itself(i, j), mac(residue_a.reshaped(), residue_b.reshaped()), 1e-13);
    }
  }
  ModalModel scaled = model;
  for (Mode& mode : scaled.modes) {
    mode.left *= Complex(0.0, 3.0);
    mode.right /= Complex(0.0, 3.0);
  }
  EXPECT_LT((mac(model, scaled) - with_itself).norm(), 1e-13);
}

TEST(Frac, SeesShapeAndNotScale) {
  const Eigen::VectorXd lines = Eigen::VectorXd::LinSpaced(500, 5.0, 100.0);
  const ModalModel model = data::robot_modes();
  const FrfSet measured = synthesize(model, lines);
  EXPECT_LT((frac(measured, measured) - Eigen::VectorXd::Ones(4)).norm(), 1e-13);
  FrfSet other = measured;
  for (Frf& frf : other.frfs) frf.receptance *= Complex(0.0, 0.5);
  EXPECT_LT((frac(measured, other) - Eigen::VectorXd::Ones(4)).norm(), 1e-13);
  ModalModel shifted = model;
  for (Mode& mode : shifted.modes) mode.frequency_hz *= 1.05;
  EXPECT_LT(frac(measured, synthesize(shifted, lines)).maxCoeff(), 0.95);
}

TEST(Mac, RejectsWhatCannotBeCompared) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(static_cast<void>(mac(Eigen::Vector2cd::Ones(), Eigen::Vector3cd::Ones())), InvalidInput);
  EXPECT_THROW(static_cast<void>(mac(Eigen::VectorXcd(), Eigen::VectorXcd())), InvalidInput);
  EXPECT_THROW(static_cast<void>(mac(Eigen::Vector2cd(nan, 1.0), Eigen::Vector2cd::Ones())), InvalidInput);
  const ModalModel model = data::robot_modes();
  ModalModel other = model;
  other.responses[1].axis = Axis::z;
  EXPECT_THROW(static_cast<void>(mac(model, other)), InvalidInput);
  const FrfSet set = synthesize(model, Eigen::Vector2d(1.0, 2.0));
  EXPECT_THROW(static_cast<void>(frac(set, synthesize(model, Eigen::Vector2d(1.0, 3.0)))), InvalidInput);
  EXPECT_THROW(static_cast<void>(frac(set, synthesize(other, Eigen::Vector2d(1.0, 2.0)))), InvalidInput);
}

}  // namespace mac_test
}  // namespace robomill::modal
