#include "robomill/modal/posture/column_deviation.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <span>

#include "robomill/modal/posture/receptance_lines.hpp"

namespace robomill::modal::detail {
namespace {

using Complex = std::complex<double>;

/// Of a direct entry among the nine, column by column.
Eigen::Index direct_row(int axis) {
  return 4 * axis;
}

/// 2 H(σ) − H(2σ), as SmoothedFrf holds it.
Eigen::Matrix3cd smoothed(const FlexibleArm::System& system, Complex s) {
  const Eigen::Matrix3cd value = FlexibleArm::receptance(system, s);
  return s.real() > 0.0 ? 2.0 * value - FlexibleArm::receptance(system, s + s.real()) : value;
}

using Row6 = Eigen::Matrix<double, 1, 6>;
/// aᵀ G b by the entries 11, 22, 33, 23, 13, 12 of a symmetric G.
Row6 product_row(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  Row6 row;
  row << a(0) * b(0), a(1) * b(1), a(2) * b(2), a(1) * b(2) + a(2) * b(1), a(0) * b(2) + a(2) * b(0),
      a(0) * b(1) + a(1) * b(0);
  return row;
}

/// The line at s of another posture's, which may have an axis of its own; -1: none.
Eigen::Index line_at(const SmoothedFrf& frf, Complex s) {
  constexpr double same = 0.01;
  const auto nearest = std::ranges::min_element(
      frf.s, [&](const Complex& a, const Complex& b) { return std::abs(a - s) < std::abs(b - s); });
  if (nearest == frf.s.end() || std::abs(*nearest - s) > same * std::abs(s)) return -1;
  return nearest - frf.s.begin();
}

}  // namespace

bool is_measured(const CalibrationData& data, int axis) {
  return std::ranges::any_of(data.last_stage(), [&](const SmoothedFrf& frf) {
    return (frf.weight.row(direct_row(axis)).array() > 0.0).any();
  });
}

DirectError direct_error(const FlexibleArm::System& system, const SmoothedFrf& frf, int axis) {
  DirectError out;
  const Eigen::Index row = direct_row(axis);
  for (std::size_t i = 0; i < frf.s.size(); ++i) {
    const auto line = static_cast<Eigen::Index>(i);
    if (!(frf.weight(row, line) > 0.0)) continue;
    const Complex s = frf.s[i];
    out.error += std::abs(smoothed(system, s)(axis, axis) - frf.value(row, line));
    out.size += std::abs(frf.value(row, line));
  }
  return out;
}

Eigen::Vector3d direct_deviation(const FlexibleArm& arm, const FlexibleArm::System& system,
                                 const Eigen::MatrixXd& covariance, const SmoothedFrf& lines) {
  const double mean_of_size = std::sqrt(std::numbers::pi / 4.0);
  constexpr std::array<std::size_t, 3> direct_entries = {0, 3, 5};
  FlexibleArm::ReceptanceLines model(arm, system, true);
  const std::span<const Complex> all = lines.s;
  Eigen::Vector3d deviation = Eigen::Vector3d::Zero(), size = Eigen::Vector3d::Zero();
  Eigen::RowVectorXcd by(covariance.rows());
  for (std::size_t first = 0; first < all.size(); first += lane_count) {
    const std::size_t here = std::min(lane_count, all.size() - first);
    model.evaluate(all.subspan(first, here));
    for (std::size_t lane = 0; lane < here; ++lane) {
      for (std::size_t axis = 0; axis < direct_entries.size(); ++axis) {
        const auto a = static_cast<Eigen::Index>(axis);
        const std::size_t entry = direct_entries[axis];
        for (Eigen::Index p = 0; p < by.size(); ++p) {
          by(p) = model.derivative()[static_cast<std::size_t>(p)].at(entry, lane);
        }
        const double variance = (by * covariance * by.adjoint()).value().real();
        // However far a peak moves, it is missed by no more than both its places hold.
        const double at = std::abs(model.value().at(entry, lane));
        deviation(a) += std::min(mean_of_size * std::sqrt(std::max(0.0, variance)), 2.0 * at);
        size(a) += at;
      }
    }
  }
  return deviation.cwiseQuotient(size);
}

HeldOut hold_out(const FlexibleArm& arm, const CalibrationData& data, double highest_hz, bool varying,
                 const Beginning& beginning, int axis, Progress& progress) {
  const Calibration without =
      calibrate(arm, data.without_force(axis), highest_hz, {.varying = varying, .judged = false}, beginning, progress);
  DirectError all;
  double predicted = 0.0;
  for (std::size_t k = 0; k < data.size(); ++k) {
    const PostureParameters there = predict(arm, without, data.joints(), data.joints()[k]);
    const FlexibleArm::System system = arm.at(data.joints()[k], there.mean);
    const DirectError one = direct_error(system, data.last_stage()[k], axis);
    all.error += one.error;
    all.size += one.size;
    predicted += direct_deviation(arm, system, there.covariance, data.last_stage()[k])(axis);
  }
  if (!(all.size > 0.0)) return {.error = std::numeric_limits<double>::quiet_NaN()};
  return {.error = all.ratio(), .predicted = predicted / static_cast<double>(data.size())};
}

Unmodelled::Unmodelled(const std::vector<FlexibleArm::System>& systems, const CalibrationData& data) {
  double noise = 0.0, freedom = 0.0;  // variance of a weighted residual
  for (const Complex s : data.last_stage().front().s) {
    Line out{.s = s, .mean = Eigen::Matrix<Complex, 6, 1>::Zero(), .covariance = Eigen::Matrix<double, 6, 6>::Zero()};
    Eigen::Matrix<double, 6, 6> precision = Eigen::Matrix<double, 6, 6>::Zero();
    Eigen::Matrix<Complex, 6, 1> product = Eigen::Matrix<Complex, 6, 1>::Zero();
    double squares = 0.0, equations = 0.0, largest = 0.0;
    for (std::size_t p = 0; p < systems.size(); ++p) {
      const SmoothedFrf& frf = data.last_stage()[p];
      const Eigen::Index line = line_at(frf, s);
      if (line < 0) continue;
      const Eigen::Matrix3cd model = smoothed(systems[p], frf.s[static_cast<std::size_t>(line)]);
      largest = std::max(largest, model.norm());
      for (int e = 0; e < 9; ++e) {
        const double weight = frf.weight(e, line);
        if (weight == 0.0) continue;
        const Row6 row = weight * product_row(systems[p].flange_axes.row(e % 3), systems[p].flange_axes.row(e / 3));
        const Complex miss = weight * (frf.value(e, line) - model(e % 3, e / 3));
        precision += row.transpose() * row;
        product += row.transpose() * miss;
        squares += std::norm(miss);
        equations += 1.0;
      }
    }
    if (!(largest > 0.0)) continue;
    precision.diagonal().array() += 1.0 / (largest * largest);
    out.covariance = precision.llt().solve(Eigen::Matrix<double, 6, 6>::Identity());
    out.mean = out.covariance * product;
    noise += std::max(0.0, squares - (product.adjoint() * out.mean).value().real());
    freedom += std::max(1.0, equations - 6.0);
    lines_.push_back(out);
  }
  noise = freedom > 0.0 ? noise / freedom : 1.0;
  // The prior is as wide whatever the noise: where nothing was seen the covariance is its.
  for (Line& line : lines_) line.covariance *= std::min(1.0, noise);
}

Eigen::Vector3d Unmodelled::deviation(const FlexibleArm::System& system) const {
  Eigen::Vector3d deviation = Eigen::Vector3d::Zero(), size = Eigen::Vector3d::Zero();
  for (const Line& line : lines_) {
    const Eigen::Matrix3cd model = smoothed(system, line.s);
    for (int axis = 0; axis < 3; ++axis) {
      const Row6 row = product_row(system.flange_axes.row(axis), system.flange_axes.row(axis));
      deviation(axis) +=
          std::sqrt(std::norm((row * line.mean).value()) + (row * line.covariance * row.transpose()).value());
      size(axis) += std::abs(model(axis, axis));
    }
  }
  return deviation.cwiseQuotient(size);
}

}  // namespace robomill::modal::detail
