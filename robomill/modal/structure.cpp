#include "robomill/modal/structure.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <set>
#include <string>

#include "robomill/base/error.hpp"
#include "robomill/base/linear_algebra.hpp"

namespace robomill::modal {
namespace {

using Complex = std::complex<double>;

constexpr double max_mass_condition = 1e12;
constexpr double max_vector_condition = 1e10;

template <class Matrix>
double condition(const Matrix& matrix) {
  const Eigen::VectorXd values = linear_algebra::thin_svd(matrix).values;
  return values(0) / values(values.size() - 1);
}

void check_matrix(const char* member, const Eigen::MatrixXd& matrix, std::size_t size) {
  const Eigen::Index n = static_cast<Eigen::Index>(size);
  if (matrix.rows() != n || matrix.cols() != n) {
    throw InvalidInput(member,
                       "must be a square matrix with a row for each degree of freedom (" + std::to_string(size) + ")");
  }
  if (!matrix.allFinite()) throw InvalidInput(member, "holds a value that is not finite");
}

/// A pole that a list of modes cannot hold; λ in rad/s.
void reject_pole(const Complex& lambda) {
  if (lambda.imag() == 0.0) {
    throw InvalidInput(
        "damping_n_s_per_m", lambda.real(), "1/s",
        "gives the structure a real pole; every pole must be one of a conjugate pair",
        "The structure is overdamped in some direction, or not held: is the damping too high, a stiffness missing?");
  }
  if (lambda.real() >= 0.0) {
    throw InvalidInput("damping_n_s_per_m", -lambda.real() / std::abs(lambda), "",
                       "is the damping ratio of the mode at " +
                           std::to_string(std::abs(lambda) / (2.0 * std::numbers::pi)) + " Hz; every mode must decay",
                       "Is the damping missing or negative, or a matrix without symmetry pumping energy in?");
  }
}

}  // namespace

void Structure::validate() const {
  if (dofs.empty()) throw InvalidInput("dofs", "name no degree of freedom");
  std::set<Dof> seen;
  for (const Dof& dof : dofs) {
    if (!seen.insert(dof).second) throw InvalidInput("dofs", "name " + to_string(dof) + " twice");
  }
  check_matrix("mass_kg", mass_kg, dofs.size());
  check_matrix("damping_n_s_per_m", damping_n_s_per_m, dofs.size());
  check_matrix("stiffness_n_per_m", stiffness_n_per_m, dofs.size());
  // A zero matrix has condition 0/0; the negated comparison rejects it too.
  if (!(condition(mass_kg) < max_mass_condition)) throw InvalidInput("mass_kg", "must not be singular");
  if (stiffness_n_per_m.isZero(0.0)) throw InvalidInput("stiffness_n_per_m", "must not be zero");
}

ModalModel modes_of(const Structure& structure) {
  structure.validate();
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
  if (!eigen.converged) {
    throw InvalidInput("stiffness_n_per_m", "has no eigenvalues that double precision can find",
                       "Are the units mixed?");
  }
  const Eigen::VectorXcd lambda = scale * eigen.values;
  for (const Complex& value : lambda) reject_pole(value);
  const Eigen::MatrixXcd& vectors = eigen.vectors;
  if (!(condition(vectors) < max_vector_condition)) {
    throw InvalidInput("damping_n_s_per_m", "makes poles coincide without eigenvectors of their own",
                       "A mode at critical damping is no conjugate pair");
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

FrfSet receptance(const Structure& structure, const Eigen::VectorXd& frequency_hz) {
  structure.validate();
  const Eigen::Index n = structure.mass_kg.rows();
  FrfSet set;
  set.frequency_hz = frequency_hz;
  for (const Dof& excitation : structure.dofs) {
    for (const Dof& response : structure.dofs) {
      set.frfs.push_back({.name = {response, excitation}, .receptance = Eigen::VectorXcd::Zero(frequency_hz.size())});
    }
  }
  set.validate();
  for (Eigen::Index line = 0; line < frequency_hz.size(); ++line) {
    const double omega = 2.0 * std::numbers::pi * frequency_hz(line);
    const Eigen::MatrixXcd dynamic_stiffness =
        (structure.stiffness_n_per_m - omega * omega * structure.mass_kg).cast<Complex>() +
        Complex(0.0, omega) * structure.damping_n_s_per_m.cast<Complex>();
    const Eigen::MatrixXcd h = linear_algebra::inverse(dynamic_stiffness);
    if (!h.allFinite()) {
      throw InvalidInput("frequency_hz", frequency_hz(line), "Hz", "is where the dynamic stiffness is singular",
                         "A structure that is not held, or not damped, has no receptance there");
    }
    for (Eigen::Index j = 0; j < n; ++j) {
      for (Eigen::Index i = 0; i < n; ++i) set.frfs[static_cast<std::size_t>(j * n + i)].receptance(line) = h(i, j);
    }
  }
  return set;
}

}  // namespace robomill::modal
