#include "robomill/modal/fitting/fit_data.hpp"

#include <cmath>

namespace robomill::modal::detail {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

std::complex<double> Poles::pole(Index k) const {
  return omega(k) * Complex(-zeta(k), std::sqrt(1.0 - zeta(k) * zeta(k)));
}

void Poles::fix_gauge() {
  gauge.assign(static_cast<std::size_t>(size()), 0);
  for (Index k = 0; k < size(); ++k) {
    Index& row = gauge[static_cast<std::size_t>(k)];
    left.col(k).cwiseAbs().maxCoeff(&row);
    if (left(row, k) != 0.0) left.col(k) /= Complex(left(row, k));
    left(row, k) = 1.0;
  }
}

Poles Poles::without(Index k) const {
  Poles rest{.omega = VectorXd(size() - 1),
             .zeta = VectorXd(size() - 1),
             .left = MatrixXcd(left.rows(), size() - 1),
             .gauge = gauge};
  rest.gauge.erase(rest.gauge.begin() + k);
  for (Index from = 0, to = 0; from < size(); ++from) {
    if (from == k) continue;
    rest.omega(to) = omega(from);
    rest.zeta(to) = zeta(from);
    rest.left.col(to) = left.col(from);
    ++to;
  }
  return rest;
}

Poles Poles::with(double new_omega, double new_zeta, const VectorXcd& new_left) const {
  Poles more = *this;
  more.omega.conservativeResize(size() + 1);
  more.zeta.conservativeResize(size() + 1);
  more.left.conservativeResize(new_left.size(), size() + 1);
  more.omega(size()) = new_omega;
  more.zeta(size()) = new_zeta;
  more.left.col(size()) = new_left;
  more.fix_gauge();
  return more;
}

Index parameter_count(const FitData& data, Index modes) {
  return 2 * data.excitations * modes;
}

VectorXd to_parameters(const Poles& poles) {
  VectorXd parameters(2 * poles.left.rows() * poles.size());
  Index next = 0;
  for (Index k = 0; k < poles.size(); ++k) {
    parameters(next++) = poles.omega(k);
    parameters(next++) = poles.zeta(k);
    for (Index j = 0; j < poles.left.rows(); ++j) {
      if (j == poles.gauge[static_cast<std::size_t>(k)]) continue;
      parameters(next++) = poles.left(j, k).real();
      parameters(next++) = poles.left(j, k).imag();
    }
  }
  return parameters;
}

Poles from_parameters(const VectorXd& parameters, const Poles& shape) {
  Poles poles = shape;
  Index next = 0;
  for (Index k = 0; k < poles.size(); ++k) {
    poles.omega(k) = parameters(next++);
    poles.zeta(k) = parameters(next++);
    for (Index j = 0; j < poles.left.rows(); ++j) {
      if (j == shape.gauge[static_cast<std::size_t>(k)]) continue;
      poles.left(j, k) = Complex(parameters(next), parameters(next + 1));
      next += 2;
    }
  }
  return poles;
}

}  // namespace robomill::modal::detail
