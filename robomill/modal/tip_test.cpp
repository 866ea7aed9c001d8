#include "robomill/modal/tip.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "robomill/base/error.hpp"
#include "robomill/base/random.hpp"

namespace robomill::modal {
namespace tip_test {

Eigen::VectorXcd random_vector(Random& random, Eigen::Index size) {
  Eigen::VectorXcd out(size);
  for (std::complex<double>& v : out) v = {random.normal(), random.normal()};
  return out;
}

/// Of the tip and of another point, in the directions that are given.
ModalModel random_model(Random& random, std::vector<Dof> dofs) {
  dofs.push_back({.point = 3, .axis = Axis::x});
  ModalModel out{.excitations = dofs, .responses = dofs, .modes = {}};
  const auto size = static_cast<Eigen::Index>(dofs.size());
  for (int k = 0; k < 4; ++k) {
    Mode mode{.frequency_hz = random.uniform(50.0, 500.0),
              .damping_ratio = random.uniform(0.01, 0.05),
              .left = random_vector(random, size),
              .right = random_vector(random, size)};
    mode.frequency_std_hz = 1.0 + k;
    out.modes.push_back(mode);
  }
  for (const Dof& excitation : dofs) {
    for (const Dof& response : dofs) {
      out.residuals.push_back({.name = {response, excitation},
                               .mass = {random.normal(), random.normal()},
                               .stiffness = {1e-5 * random.normal(), 1e-5 * random.normal()}});
    }
  }
  return out;
}

/// The 3 x 3 receptance of the tip; zero where the model does not know it.
Eigen::Matrix3cd receptance(const FrfSet& set, Eigen::Index line) {
  Eigen::Matrix3cd out = Eigen::Matrix3cd::Zero();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const Frf* frf = set.find({tip_axes()[static_cast<std::size_t>(i)], tip_axes()[static_cast<std::size_t>(j)]});
      if (frf != nullptr) out(i, j) = frf->receptance(line);
    }
  }
  return out;
}

// q = H F in one frame is T q = (T H Tᵀ) (T F) in the other, whatever the model is made of.
TEST(Tip, ATurnedModelHasTheTurnedReceptances) {
  Random random(11);
  const Eigen::VectorXd lines = Eigen::VectorXd::LinSpaced(9, 20.0, 600.0);
  for (int round = 0; round < 40; ++round) {
    std::vector<Dof> dofs = tip_axes();
    if (round % 2 == 1) dofs.pop_back();  // z is not known: rigid
    const ModalModel model = random_model(random, dofs);
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(random.uniform(-3.0, 3.0),
                          Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized())
            .toRotationMatrix();
    const ModalModel other = turned(model, turn);
    EXPECT_NO_THROW(other.validate());
    const FrfSet before = synthesize(model, lines), after = synthesize(other, lines);
    for (Eigen::Index line = 0; line < lines.size(); ++line) {
      const Eigen::Matrix3cd expected = turn * receptance(before, line) * turn.transpose();
      EXPECT_LT((receptance(after, line) - expected).norm(), 1e-12 * expected.norm());
    }
    EXPECT_EQ(other.modes[2].frequency_std_hz, 3.0);
    // What the cut sees of it is the same, up to its freedom of scale, as turning what it saw before.
    const TipModes one = turned(tip_modes(model, {}, 0.0), turn), two = tip_modes(other, {}, 0.0);
    for (Eigen::Index k = 0; k < one.pole.size(); ++k) {
      const Eigen::Matrix3cd residue = one.right.col(k) * one.left.col(k).transpose();
      EXPECT_LT((two.right.col(k) * two.left.col(k).transpose() - residue).norm(), 1e-12 * residue.norm());
    }
    EXPECT_LT((one.compliance - two.compliance).norm(), 1e-12 * one.compliance.norm());
  }
}

TEST(Tip, AModelWithoutATipCannotBeTurned) {
  Random random(5);
  ModalModel model = random_model(random, {{.axis = Axis::z}});
  model.excitations.back().axis = model.responses.back().axis = Axis::z;
  EXPECT_THROW(static_cast<void>(turned(model, Eigen::Matrix3d::Identity())), InvalidInput);
}

}  // namespace tip_test
}  // namespace robomill::modal
