#include "testing/modal/structure.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <stdexcept>

#include "robomill/base/linear_algebra.hpp"

namespace robomill::modal::testing {

using Complex = std::complex<double>;

ModalModel modes_of(const Structure& structure) {
  const Eigen::Index n = structure.mass_kg.rows();
  const Eigen::MatrixXd stiffness = linear_algebra::solve(structure.mass_kg, structure.stiffness_n_per_m);
  const Eigen::MatrixXd damping = linear_algebra::solve(structure.mass_kg, structure.damping_n_s_per_m);
  // Time in units of 1/scale, so that displacement and velocity weigh alike in the eigenproblem.
  const double scale = std::sqrt(stiffness.norm() / std::sqrt(static_cast<double>(n)));

  Eigen::MatrixXd state = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  state.topRightCorner(n, n).setIdentity();
  state.bottomLeftCorner(n, n) = -stiffness / (scale * scale);
  state.bottomRightCorner(n, n) = -damping / scale;
  const linear_algebra::EigenPairs eigen = linear_algebra::eigen_pairs(state);
  const Eigen::VectorXcd lambda = scale * eigen.values;
  for (const Complex& value : lambda) {
    if (!eigen.converged || value.imag() == 0.0 || !(value.real() < 0.0)) {
      throw std::invalid_argument("the structure has a pole that is real or does not decay");
    }
  }
  const Eigen::MatrixXcd& vectors = eigen.vectors;
  const Eigen::VectorXd sizes = linear_algebra::thin_svd(vectors).values;
  if (!(sizes(0) < 1e10 * sizes(2 * n - 1))) {
    throw std::invalid_argument("the structure has coinciding poles without eigenvectors of their own");
  }
  // The rows of the inverse are the left eigenvectors, which are so biorthogonal within repeated poles too. The force
  // enters the state through M⁻¹ / scale.
  const Eigen::MatrixXcd left = linear_algebra::inverse(vectors).rightCols(n) *
                                linear_algebra::inverse(structure.mass_kg).cast<Complex>() / scale;

  ModalModel model;
  model.excitations = structure.dofs;
  model.responses = structure.dofs;
  for (Eigen::Index k = 0; k < 2 * n; ++k) {
    if (lambda(k).imag() < 0.0) continue;
    Mode mode;
    mode.frequency_hz = std::abs(lambda(k)) / (2.0 * std::numbers::pi);
    mode.damping_ratio = -lambda(k).real() / std::abs(lambda(k));
    mode.left = left.row(k).transpose();
    mode.right = vectors.col(k).head(n);
    normalise(mode);
    model.modes.push_back(mode);
  }
  std::ranges::stable_sort(model.modes, {}, &Mode::frequency_hz);
  return model;
}

}  // namespace robomill::modal::testing
