#include "robomill/modal/posture/posture_normal.hpp"

#include <array>
#include <cmath>
#include <complex>

namespace robomill::modal::detail {
namespace {

using Complex = std::complex<double>;

/// Large residuals count less: c² ln(1 + r²/c²).
constexpr double robust = 4.0;

}  // namespace

PostureNormal normal_of(const FlexibleArm& arm, const Eigen::VectorXd& joints, const SmoothedFrf& frf,
                        const Eigen::VectorXd& parameters, bool derivatives) {
  const Eigen::Index count = parameters.size();
  const FlexibleArm::System system = arm.at(joints, parameters);
  PostureNormal out;
  out.matrix = Eigen::MatrixXd::Zero(count, count);
  out.gradient = Eigen::VectorXd::Zero(count);
  const Eigen::Index lines = static_cast<Eigen::Index>(frf.s.size());
  Eigen::Matrix<Complex, 9, Eigen::Dynamic> derivative(9, count), derivative_farther(9, count);
  // The model is symmetric: the two entries that mirror each other have one row of derivatives.
  constexpr std::array<std::array<Eigen::Index, 2>, 6> mirrored = {{{0, 0}, {4, 4}, {8, 8}, {1, 3}, {2, 6}, {5, 7}}};
  constexpr Eigen::Index rows_a_line = 12;
  Eigen::MatrixXd real;
  Eigen::VectorXd residual;
  if (derivatives) {
    real.setZero(rows_a_line * lines, count);
    residual.setZero(rows_a_line * lines);
  }
  for (Eigen::Index i = 0; i < lines; ++i) {
    Eigen::Matrix3cd value;
    const Complex s = frf.s[static_cast<std::size_t>(i)];
    if (derivatives) {
      arm.receptance(system, s, value, derivative);
    } else {
      value = FlexibleArm::receptance(system, s);
    }
    if (s.real() > 0.0) {  // 2 H(σ) − H(2σ)
      Eigen::Matrix3cd farther;
      if (derivatives) {
        arm.receptance(system, s + s.real(), farther, derivative_farther);
        derivative = 2.0 * derivative - derivative_farther;
      } else {
        farther = FlexibleArm::receptance(system, s + s.real());
      }
      value = 2.0 * value - farther;
    }
    const Eigen::Map<const Eigen::Matrix<Complex, 9, 1>> model(value.data());
    for (std::size_t pair = 0; pair < mirrored.size(); ++pair) {
      double weights = 0.0;
      Complex weighted = 0.0, slope = 1.0;
      for (std::size_t side = 0; side < (mirrored[pair][0] == mirrored[pair][1] ? 1U : 2U); ++side) {
        const Eigen::Index e = mirrored[pair][side];
        const double weight = frf.weight(e, i);
        if (weight == 0.0) continue;
        // Logarithms of what lies on the diagonal: too stiff counts as much as too soft.
        const Complex data = frf.value(e, i);
        const bool diagonal = mirrored[pair][0] == mirrored[pair][1] && data != 0.0;
        const Complex miss = diagonal ? std::abs(data) * std::log(model(e) / data) : model(e) - data;
        if (diagonal) slope = std::abs(data) / model(e);
        const double square = std::norm(miss) * weight * weight;
        out.cost += robust * robust * std::log1p(square / (robust * robust));
        out.error += std::abs(model(e) - data);
        out.size += std::abs(frf.value(e, i));
        out.residuals += 2.0;
        const double counted = weight * weight / (1.0 + square / (robust * robust));
        weights += counted;
        weighted += counted * miss;
      }
      if (!derivatives || weights == 0.0) continue;
      const double root = std::sqrt(weights);
      const Eigen::Index row = rows_a_line * i + 2 * static_cast<Eigen::Index>(pair);
      real.row(row) = root * (slope * derivative.row(mirrored[pair][0])).real();
      real.row(row + 1) = root * (slope * derivative.row(mirrored[pair][0])).imag();
      residual(row) = weighted.real() / root;
      residual(row + 1) = weighted.imag() / root;
    }
  }
  if (!derivatives) return out;
  out.matrix.selfadjointView<Eigen::Lower>().rankUpdate(real.transpose());
  out.matrix.triangularView<Eigen::StrictlyUpper>() = out.matrix.transpose();
  out.gradient.noalias() = real.transpose() * residual;
  return out;
}

}  // namespace robomill::modal::detail
