#include "robomill/modal/posture/calibration.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "robomill/base/linear_algebra.hpp"
#include "robomill/base/parallel.hpp"
#include "robomill/modal/posture/calibration_search.hpp"
#include "robomill/modal/posture/column_deviation.hpp"
#include "robomill/modal/posture/posture_calibration.hpp"

namespace robomill::modal::detail {
namespace {

/// From the first stage on, the damping that is added to find the way, as a share of each frequency.
constexpr double stages[] = {0.15, 0.08, 0.04, 0.02};
constexpr int stage_lines[] = {30, 50, 80, 150};
constexpr std::size_t last_stage = std::size(stages) - 1;

double quantile95(std::vector<double> values) {
  if (values.empty()) return 0.0;
  std::ranges::sort(values);
  return values[static_cast<std::size_t>(0.95 * static_cast<double>(values.size() - 1))];
}

/// Predicted deviations of one posture's modes.
struct ModeSpread {
  Eigen::VectorXd log_frequency, damping_ratio, residue;
};
ModeSpread spread_of(const FlexibleArm& arm, const FlexibleArm::System& system, const FlexibleArm::Modes& modes,
                     const Eigen::MatrixXd& covariance) {
  const FlexibleArm::Sensitivity by = arm.sensitivity(system, modes);
  const Eigen::Index m = modes.pole.size();
  ModeSpread out{
      .log_frequency = Eigen::VectorXd(m), .damping_ratio = Eigen::VectorXd(m), .residue = Eigen::VectorXd(m)};
  for (Eigen::Index k = 0; k < m; ++k) {
    out.log_frequency(k) =
        std::sqrt(std::max(0.0, (by.log_frequency.row(k) * covariance * by.log_frequency.row(k).transpose()).value()));
    out.damping_ratio(k) =
        std::sqrt(std::max(0.0, (by.damping_ratio.row(k) * covariance * by.damping_ratio.row(k).transpose()).value()));
    out.residue(k) = std::sqrt(total_variance(by.residue[static_cast<std::size_t>(k)], covariance));
  }
  return out;
}

/// The mode of another model that is most like one: near in frequency, and of its shape.
Eigen::Index counterpart(const FlexibleArm::Modes& of, Eigen::Index mode, const FlexibleArm::Modes& among) {
  Eigen::Index best = 0;
  double least = std::numeric_limits<double>::infinity();
  const Eigen::Vector3cd a = of.at_tip.col(mode);
  for (Eigen::Index j = 0; j < among.pole.size(); ++j) {
    const Eigen::Vector3cd b = among.at_tip.col(j);
    const double alike = std::norm(a.dot(b)) / std::max(a.squaredNorm() * b.squaredNorm(), 1e-300);
    const double apart = std::abs(std::log(std::abs(among.pole(j)) / std::abs(of.pole(mode)))) + 0.1 * (1.0 - alike);
    if (apart < least) {
      least = apart;
      best = j;
    }
  }
  return best;
}

/// How far the left-out postures' own modes lie from their predictions, in predicted deviations.
void scale_deviations(const FlexibleArm& arm, const CalibrationSearch& search, const CalibrationData& data,
                      double highest_hz, LeftOutPostures& out) {
  std::vector<std::vector<double>> z(3);
  std::array<DirectError, 3> direct;
  double error = 0.0, size = 0.0;
  for (std::size_t k = 0; k < data.size(); ++k) {
    const CalibrationSearch::LeftOut left = search.without(k);
    const PostureNormal at = search.evaluate_at(k, left.parameters, true);
    error += at.error;
    size += at.size;
    const Eigen::VectorXd refined = search.refined(k, left.parameters, at);
    const FlexibleArm::System before = arm.at(data.joints()[k], left.parameters);
    out.predicted += direct_deviation(arm, before, left.covariance, data.last_stage()[k]);
    for (std::size_t axis = 0; axis < direct.size(); ++axis) {
      const DirectError one = direct_error(before, data.last_stage()[k], static_cast<int>(axis));
      direct[axis].error += one.error;
      direct[axis].size += one.size;
    }
    const FlexibleArm::Modes predicted = arm.modes(before, highest_hz);
    const FlexibleArm::Modes found = arm.modes(arm.at(data.joints()[k], refined), highest_hz);
    const ModeSpread spread = spread_of(arm, before, predicted, left.covariance);
    for (Eigen::Index i = 0; i < predicted.pole.size() && found.pole.size() > 0; ++i) {
      const Eigen::Index j = counterpart(predicted, i, found);
      const double was = std::abs(predicted.pole(i)), is = std::abs(found.pole(j));
      z[0].push_back(std::abs(std::log(is / was)) / std::max(spread.log_frequency(i), 1e-9));
      const double zeta_was = -predicted.pole(i).real() / was, zeta_is = -found.pole(j).real() / is;
      z[1].push_back(std::abs(zeta_is - zeta_was) / std::max(spread.damping_ratio(i), 1e-12));
      const Eigen::Matrix3cd a = predicted.at_tip.col(i) * predicted.at_tip.col(i).transpose();
      const Eigen::Matrix3cd b = found.at_tip.col(j) * found.at_tip.col(j).transpose();
      z[2].push_back((a - b).norm() / a.norm() / std::max(spread.residue(i), 1e-9));
    }
  }
  out.error = error / size;
  out.predicted /= static_cast<double>(data.size());
  for (std::size_t axis = 0; axis < direct.size(); ++axis) {
    out.direct(static_cast<Eigen::Index>(axis)) = direct[axis].ratio();
  }
  const auto scale = [&](std::size_t i) { return std::clamp(quantile95(z[i]) / 1.96, 0.5, 10.0); };
  out.frequency_scale = scale(0);
  out.damping_scale = scale(1);
  out.residue_scale = scale(2);
}

}  // namespace

double posture_distance(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  const Eigen::Index n = a.size() - 1;
  return n > 0 ? (a.tail(n) - b.tail(n)).norm() : 0.0;
}

CalibrationData::CalibrationData(const std::vector<PostureData>& postures, Stages wanted) {
  for (const PostureData& posture : postures) joints_.push_back(posture.joints());
  for (std::size_t i = 0; i < std::size(stages); ++i) {
    std::vector<SmoothedFrf>& stage = stages_.emplace_back(postures.size());
    const bool is_last = i + 1 == std::size(stages);
    if (wanted == Stages::last && !is_last) continue;
    parallel_for(postures.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        stage[k] = postures[k].smoothed(stages[i], stage_lines[i], is_last);
      }
    });
  }
}

Beginning begin_calibration(const FlexibleArm& arm, const CalibrationData& data, Progress& progress) {
  CalibrationSearch search(arm, data, false, arm.start());
  constexpr int iterations = 20;
  constexpr double least_gain = 1e-3;
  for (std::size_t i = 0; i < last_stage; ++i) {
    search.stage(i);
    search.descend(iterations, least_gain, false, progress);
    search.estimate_noise();
  }
  return {.parameters = search.common(), .noise = search.noise()};
}

CalibrationData CalibrationData::without_force(int axis) const {
  CalibrationData out = *this;
  for (std::vector<SmoothedFrf>& stage : out.stages_) {
    for (SmoothedFrf& frf : stage) {
      frf.value.middleRows(3 * axis, 3).setZero();
      frf.weight.middleRows(3 * axis, 3).setZero();
    }
  }
  return out;
}

namespace {

void take(const CalibrationSearch& search, Calibration& out) {
  out.error = search.error();
  out.noise = search.noise();
  out.common = search.common();
  out.differing = search.differing();
  out.deviating = search.deviating();
  out.covariance = search.covariance();
}

}  // namespace

std::optional<Calibration> again(const FlexibleArm& arm, const CalibrationData& data, bool varying,
                                 const PostureCalibration& kept) {
  constexpr double same_error = 1e-9;
  if (kept.common.size() != arm.start().size()) return std::nullopt;
  CalibrationSearch search(arm, data, varying, kept.common);
  if (kept.differing.rows() != search.differing().rows() || kept.differing.cols() != search.differing().cols()) {
    return std::nullopt;
  }
  search.stage(last_stage);
  search.resume(kept.differing, kept.noise);
  Calibration out;
  take(search, out);
  if (!(std::abs(out.error - kept.error) <= same_error * kept.error) || !out.covariance.allFinite()) {
    return std::nullopt;
  }
  out.left_out = kept.left_out;
  return out;
}

Calibration calibrate(const FlexibleArm& arm, const CalibrationData& data, double highest_hz,
                      const CalibrationChoice& choice, const Beginning& beginning, Progress& progress) {
  Calibration out;
  const bool varying = choice.varying;
  CalibrationSearch search(arm, data, varying, beginning.parameters);
  search.stage(last_stage);
  if (data.size() > 0) {
    constexpr int iterations = 20, settling_iterations = 3;
    constexpr double least_gain = 3e-4;
    search.expect_noise(beginning.noise);
    search.descend(iterations, least_gain, varying, progress);
    search.estimate_noise();
    search.descend(settling_iterations, least_gain, varying, progress);
  }
  take(search, out);
  if (choice.judged && data.size() >= 3) scale_deviations(arm, search, data, highest_hz, out.left_out);
  return out;
}

PostureParameters predict(const FlexibleArm& arm, const Calibration& calibration,
                          const std::vector<Eigen::VectorXd>& postures, const Eigen::VectorXd& joints) {
  const Eigen::Index p = calibration.common.size(), d = calibration.differing.rows();
  const Eigen::Index n = static_cast<Eigen::Index>(postures.size());
  PostureParameters out{.mean = calibration.common, .covariance = calibration.covariance.topLeftCorner(p, p)};
  if (d == 0) return out;
  Eigen::MatrixXd kernel(n, n);
  Eigen::VectorXd to(n);
  for (Eigen::Index a = 0; a < n; ++a) {
    for (Eigen::Index b = 0; b < n; ++b) {
      kernel(a, b) = posture_kernel(postures[static_cast<std::size_t>(a)], postures[static_cast<std::size_t>(b)]);
    }
    to(a) = posture_kernel(postures[static_cast<std::size_t>(a)], joints);
  }
  kernel.diagonal().array() += own_share;
  const Eigen::VectorXd weights = linear_algebra::solve_positive_definite(kernel, to);
  const double left = 1.0 - to.dot(weights);
  // φ = θ + Σ_k w_k u_k: of (θ, u), row by row.
  const auto picked = [&](const Eigen::MatrixXd& of) {
    Eigen::MatrixXd rows = of.topRows(p);
    for (Eigen::Index a = 0; a < d; ++a) {
      for (Eigen::Index k = 0; k < n; ++k) {
        rows.row(calibration.deviating[static_cast<std::size_t>(a)]) += weights(k) * of.row(p + k * d + a);
      }
    }
    return rows;
  };
  for (Eigen::Index a = 0; a < d; ++a) {
    out.mean(calibration.deviating[static_cast<std::size_t>(a)]) += calibration.differing.row(a).dot(weights);
  }
  out.covariance = picked(picked(calibration.covariance).transpose()).transpose();
  for (Eigen::Index a = 0; a < d; ++a) {
    const Eigen::Index row = calibration.deviating[static_cast<std::size_t>(a)];
    const double s = arm.parameters()[static_cast<std::size_t>(row)].posture_deviation;
    out.covariance(row, row) += s * s * left;
  }
  return out;
}

}  // namespace robomill::modal::detail
