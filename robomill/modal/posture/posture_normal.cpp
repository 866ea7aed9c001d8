#include "robomill/modal/posture/posture_normal.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <span>

#include "robomill/modal/posture/receptance_lines.hpp"

namespace robomill::modal::detail {
namespace {

using Complex = std::complex<double>;

/// Large residuals count less: c² ln(1 + r²/c²).
constexpr double robust = 4.0;

/// The model is symmetric: the two entries that mirror each other have one row of derivatives.
constexpr std::array<std::array<Eigen::Index, 2>, 6> mirrored = {{{0, 0}, {1, 3}, {2, 6}, {4, 4}, {5, 7}, {8, 8}}};

/// What a line's entries of one value of the model come to: weighted residual = root · slope · ∂H and this.
struct WeightedResidual {
  double root = 0.0;    ///< of the weights; 0: not measured
  Complex slope = 1.0;  ///< of the residual by the model's value
  Complex value = 0.0;
};

WeightedResidual residual_of(Complex model, const SmoothedFrf& frf, Eigen::Index line, std::size_t pair,
                             PostureNormal& out) {
  double weights = 0.0;
  Complex weighted = 0.0, slope = 1.0;
  const bool on_diagonal = mirrored[pair][0] == mirrored[pair][1];
  for (std::size_t side = 0; side < (on_diagonal ? 1U : 2U); ++side) {
    const Eigen::Index e = mirrored[pair][side];
    const double weight = frf.weight(e, line);
    if (weight == 0.0) continue;
    // Logarithms of what lies on the diagonal: too stiff counts as much as too soft.
    const Complex data = frf.value(e, line);
    const bool diagonal = on_diagonal && data != 0.0;
    const Complex miss = diagonal ? std::abs(data) * std::log(model / data) : model - data;
    if (diagonal) slope = std::abs(data) / model;
    const double square = std::norm(miss) * weight * weight;
    out.cost += robust * robust * std::log1p(square / (robust * robust));
    out.error += std::abs(model - data);
    out.size += std::abs(data);
    out.residuals += 2.0;
    const double counted = weight * weight / (1.0 + square / (robust * robust));
    weights += counted;
    weighted += counted * miss;
  }
  if (weights == 0.0) return {};
  const double root = std::sqrt(weights);
  return {.root = root, .slope = slope, .value = weighted / root};
}

}  // namespace

PostureNormal normal_of(const FlexibleArm& arm, const Eigen::VectorXd& joints, const SmoothedFrf& frf,
                        const Eigen::VectorXd& parameters, bool derivatives) {
  const Eigen::Index count = parameters.size();
  const FlexibleArm::System system = arm.at(joints, parameters);
  PostureNormal out;
  out.matrix = Eigen::MatrixXd::Zero(count, count);
  out.gradient = Eigen::VectorXd::Zero(count);
  FlexibleArm::ReceptanceLines model(arm, system, derivatives);
  const std::span<const Complex> lines = frf.s;
  constexpr auto lanes = static_cast<Eigen::Index>(lane_count), rows_a_pair = 2 * lanes;
  constexpr auto rows = static_cast<Eigen::Index>(mirrored.size()) * rows_a_pair;  // of eight lines
  const auto batches = (static_cast<Eigen::Index>(lines.size()) + lanes - 1) / lanes;
  Eigen::MatrixXd real;
  Eigen::VectorXd residual;
  if (derivatives) {
    real.setZero(rows * batches, count);
    residual.setZero(rows * batches);
  }
  for (Eigen::Index batch = 0; batch < batches; ++batch) {
    const auto first = static_cast<std::size_t>(batch * lanes);
    const std::size_t here = std::min(lane_count, lines.size() - first);
    model.evaluate(lines.subspan(first, here));
    for (std::size_t pair = 0; pair < mirrored.size(); ++pair) {
      const Eigen::Index row = rows * batch + rows_a_pair * static_cast<Eigen::Index>(pair);
      for (std::size_t lane = 0; lane < here; ++lane) {
        const auto line = static_cast<Eigen::Index>(first + lane);
        const WeightedResidual one = residual_of(model.value().at(pair, lane), frf, line, pair, out);
        if (!derivatives || one.root == 0.0) continue;
        const Eigen::Index at = row + static_cast<Eigen::Index>(lane);
        residual(at) = one.value.real();
        residual(at + lanes) = one.value.imag();
        for (Eigen::Index p = 0; p < count; ++p) {
          const SymmetricLanes& by = model.derivative()[static_cast<std::size_t>(p)];
          const double re = by.re[pair].v[lane], im = by.im[pair].v[lane];
          real(at, p) = one.root * (one.slope.real() * re - one.slope.imag() * im);
          real(at + lanes, p) = one.root * (one.slope.real() * im + one.slope.imag() * re);
        }
      }
    }
  }
  if (!derivatives) return out;
  out.matrix.selfadjointView<Eigen::Lower>().rankUpdate(real.transpose());
  out.matrix.triangularView<Eigen::StrictlyUpper>() = out.matrix.transpose();
  out.gradient.noalias() = real.transpose() * residual;
  return out;
}

}  // namespace robomill::modal::detail
