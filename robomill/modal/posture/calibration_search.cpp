#include "robomill/modal/posture/calibration_search.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "robomill/base/linear_algebra.hpp"
#include "robomill/base/parallel.hpp"

namespace robomill::modal::detail {
namespace {

/// Residuals along neighbouring lines are alike: so many count as one.
constexpr double alike_lines = 4.0;
constexpr double process_length_rad = 1.0;

}  // namespace

double posture_kernel(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  const double d = posture_distance(a, b) / process_length_rad;
  return (1.0 - own_share) * std::exp(-0.5 * d * d);
}

CalibrationSearch::CalibrationSearch(const FlexibleArm& arm, const CalibrationData& data, bool varying,
                                     const Eigen::VectorXd& near)
    : arm_(arm), data_(data), start_(arm.start()), prior_(start_.size()) {
  for (Eigen::Index p = 0; p < start_.size(); ++p) {
    const ArmParameter& parameter = arm.parameters()[static_cast<std::size_t>(p)];
    prior_(p) = 1.0 / (parameter.deviation * parameter.deviation);
    if (varying && parameter.posture_deviation > 0.0) {
      deviating_.push_back(p);
      deviation_.push_back(parameter.posture_deviation);
    }
  }
  const Eigen::Index n = static_cast<Eigen::Index>(data.size());
  Eigen::MatrixXd kernel(n, n);
  for (Eigen::Index a = 0; a < n; ++a) {
    for (Eigen::Index b = 0; b < n; ++b) {
      kernel(a, b) =
          posture_kernel(data.joints()[static_cast<std::size_t>(a)], data.joints()[static_cast<std::size_t>(b)]);
    }
  }
  kernel.diagonal().array() += own_share;
  inverse_kernel_ = linear_algebra::solve_positive_definite(kernel, Eigen::MatrixXd(Eigen::MatrixXd::Identity(n, n)));
  common_ = near;
  differing_ = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(deviating_.size()), n);
}

void CalibrationSearch::stage(std::size_t i) {
  frfs_ = &data_.stage(i);
  // The first stages find the way, for which half of many postures do.
  constexpr std::size_t many = 8, thinned_stages = 2;
  const std::size_t step = i < thinned_stages && data_.size() >= many ? 2 : 1;
  active_.clear();
  for (std::size_t k = 0; k < data_.size(); k += step) active_.push_back(k);
}

void CalibrationSearch::resume(const Eigen::MatrixXd& differing, double noise) {
  differing_ = differing;
  noise_ = noise;
  evaluate();
}

void CalibrationSearch::descend(int iterations, double least_gain, bool with_differing, Progress& progress) {
  evaluate();
  double cost = total(common_, differing_);
  double damping = 1e-2;
  for (int i = 0; i < iterations; ++i) {
    progress.check();
    bool better = false;
    double gain = 0.0;
    for (int attempt = 0; attempt < 6 && !better; ++attempt) {
      const Eigen::VectorXd step = solve_step(with_differing, damping, SIZE_MAX);
      Eigen::VectorXd common = common_ + step.head(common_.size());
      Eigen::MatrixXd differing = differing_;
      if (with_differing) {
        differing +=
            Eigen::Map<const Eigen::MatrixXd>(step.data() + common_.size(), differing_.rows(), differing_.cols());
      }
      const double trial = trial_cost(common, differing);
      if (trial < cost) {
        gain = cost - trial;
        better = true;
        common_ = common;
        differing_ = differing;
        cost = trial;
        damping = std::max(damping * 0.2, 1e-9);
        marquardt_ = damping;
      } else {
        damping *= 6.0;
      }
    }
    if (!better) break;
    evaluate();
    if (gain < least_gain * cost) break;
  }
}

void CalibrationSearch::estimate_noise() {
  double cost = 0.0, residuals = 0.0;
  for (const std::size_t k : active_) {
    cost += normals_[k].cost;
    residuals += normals_[k].residuals;
  }
  noise_ = std::max(alike_lines * cost / std::max(residuals, 1.0), 1e-6);
}

double CalibrationSearch::error() const {
  double error = 0.0, size = 0.0;
  for (const std::size_t k : active_) {
    error += normals_[k].error;
    size += normals_[k].size;
  }
  return size > 0.0 ? error / size : 0.0;
}

CalibrationSearch::LeftOut CalibrationSearch::without(std::size_t posture) const {
  // A step too far for the linearised problem is damped until it does the other postures good.
  const double before = total(common_, differing_, posture);
  Eigen::VectorXd common;
  Eigen::MatrixXd differing, precision;
  double damping = 0.0;
  for (int attempt = 0; attempt < 6; ++attempt) {
    precision = assemble(true, damping, posture);
    const Eigen::VectorXd step =
        linear_algebra::solve_positive_definite(precision, Eigen::VectorXd(-gradient(true, posture)));
    common = common_ + step.head(common_.size());
    differing = differing_;
    if (differing_.size() > 0) {
      differing +=
          Eigen::Map<const Eigen::MatrixXd>(step.data() + common_.size(), differing_.rows(), differing_.cols());
    }
    if (trial_cost(common, differing, posture) < before) break;
    damping = damping == 0.0 ? marquardt_ : 6.0 * damping;
  }
  const Eigen::LLT<Eigen::MatrixXd> factor(damping > 0.0 ? assemble(true, 0.0, posture) : precision);
  const Eigen::MatrixXd pick = picked(posture);
  return {.parameters = parameters_of(common, differing, posture), .covariance = pick * factor.solve(pick.transpose())};
}

PostureNormal CalibrationSearch::evaluate_at(std::size_t posture, const Eigen::VectorXd& parameters,
                                             bool derivatives) const {
  return normal_of(arm_, data_.joints()[posture], (*frfs_)[posture], parameters, derivatives);
}

Eigen::VectorXd CalibrationSearch::refined(std::size_t posture, const Eigen::VectorXd& predicted,
                                           PostureNormal at) const {
  Eigen::VectorXd now = predicted;
  const auto cost = [&](const PostureNormal& normal, const Eigen::VectorXd& where) {
    return normal.cost / noise_ + (where - predicted).cwiseAbs2().dot(prior_);
  };
  constexpr int rounds = 3;
  for (int i = 0; i < rounds; ++i) {
    Eigen::MatrixXd matrix = at.matrix / noise_;
    matrix.diagonal() += prior_;
    const Eigen::VectorXd gradient = at.gradient / noise_ + prior_.cwiseProduct(now - predicted);
    const Eigen::VectorXd step = linear_algebra::solve_positive_definite(matrix, Eigen::VectorXd(-gradient));
    const double before = cost(at, now);
    double share = 1.0;
    Eigen::VectorXd next = now + step;
    PostureNormal then = evaluate_at(posture, next, true);
    constexpr double smallest_share = 0.1;
    while (!(cost(then, next) < before) && share > smallest_share) {
      share *= 0.4;
      next = now + share * step;
      then = evaluate_at(posture, next, true);
    }
    if (!(cost(then, next) < before)) break;
    now = next;
    at = std::move(then);
  }
  return now;
}

Eigen::MatrixXd CalibrationSearch::covariance() const {
  const Eigen::MatrixXd precision = assemble(true, 0.0, SIZE_MAX);
  const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(precision.rows(), precision.cols());
  return linear_algebra::solve_positive_definite(precision, one);
}

Eigen::VectorXd CalibrationSearch::parameters_of(const Eigen::VectorXd& common, const Eigen::MatrixXd& differing,
                                                 std::size_t posture) const {
  Eigen::VectorXd out = common;
  for (std::size_t d = 0; d < deviating_.size(); ++d) {
    out(deviating_[d]) += differing(static_cast<Eigen::Index>(d), static_cast<Eigen::Index>(posture));
  }
  return out;
}

void CalibrationSearch::evaluate() {
  normals_.resize(data_.size());
  parallel_for(active_.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t k = active_[i];
      normals_[k] = evaluate_at(k, parameters_of(k), true);
    }
  });
}

double CalibrationSearch::trial_cost(const Eigen::VectorXd& common, const Eigen::MatrixXd& differing,
                                     std::size_t left_out) const {
  std::vector<double> costs(active_.size(), 0.0);
  parallel_for(active_.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t k = active_[i];
      if (k != left_out) costs[i] = evaluate_at(k, parameters_of(common, differing, k), false).cost;
    }
  });
  double cost = 0.0;
  for (const double c : costs) cost += c / noise_;
  return std::isfinite(cost) ? cost + prior_cost(common, differing) : std::numeric_limits<double>::infinity();
}

double CalibrationSearch::total(const Eigen::VectorXd& common, const Eigen::MatrixXd& differing,
                                std::size_t left_out) const {
  double cost = prior_cost(common, differing);
  for (const std::size_t k : active_) {
    if (k != left_out) cost += normals_[k].cost / noise_;
  }
  return cost;
}

double CalibrationSearch::prior_cost(const Eigen::VectorXd& common, const Eigen::MatrixXd& differing) const {
  double cost = (common - start_).cwiseAbs2().dot(prior_);
  for (Eigen::Index d = 0; d < differing.rows(); ++d) {
    const double s = deviation_[static_cast<std::size_t>(d)];
    cost += (differing.row(d) * inverse_kernel_ * differing.row(d).transpose()).value() / (s * s);
  }
  return cost;
}

Eigen::MatrixXd CalibrationSearch::assemble(bool with_differing, double damping, std::size_t left_out) const {
  const Eigen::Index p = common_.size(), d = differing_.rows();
  const Eigen::Index n = static_cast<Eigen::Index>(data_.size());
  const Eigen::Index size = p + (with_differing ? d * n : 0);
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(size, size);
  for (const std::size_t active : active_) {
    if (active == left_out) continue;
    const Eigen::Index k = static_cast<Eigen::Index>(active);
    const Eigen::MatrixXd matrix = normals_[static_cast<std::size_t>(k)].matrix / noise_;
    out.topLeftCorner(p, p) += matrix;
    if (!with_differing) continue;
    const Eigen::Index at = p + k * d;
    for (Eigen::Index a = 0; a < d; ++a) {
      out.col(at + a).head(p) += matrix.col(deviating_[static_cast<std::size_t>(a)]);
      out.row(at + a).head(p) += matrix.row(deviating_[static_cast<std::size_t>(a)]);
      for (Eigen::Index b = 0; b < d; ++b) {
        out(at + a, at + b) += matrix(deviating_[static_cast<std::size_t>(a)], deviating_[static_cast<std::size_t>(b)]);
      }
    }
  }
  const Eigen::VectorXd marquardt = damping * out.diagonal();
  out.diagonal() += marquardt;
  out.diagonal().head(p) += prior_;
  for (Eigen::Index k = 0; with_differing && k < n; ++k) {
    for (Eigen::Index l = 0; l < n; ++l) {
      for (Eigen::Index a = 0; a < d; ++a) {
        const double s = deviation_[static_cast<std::size_t>(a)];
        out(p + k * d + a, p + l * d + a) += inverse_kernel_(k, l) / (s * s);
      }
    }
  }
  return out;
}

Eigen::VectorXd CalibrationSearch::gradient(bool with_differing, std::size_t left_out) const {
  const Eigen::Index p = common_.size(), d = differing_.rows();
  const Eigen::Index n = static_cast<Eigen::Index>(data_.size());
  Eigen::VectorXd out = Eigen::VectorXd::Zero(p + (with_differing ? d * n : 0));
  out.head(p) = prior_.cwiseProduct(common_ - start_);
  for (const std::size_t active : active_) {
    if (active == left_out) continue;
    const Eigen::Index k = static_cast<Eigen::Index>(active);
    const Eigen::VectorXd part = normals_[static_cast<std::size_t>(k)].gradient / noise_;
    out.head(p) += part;
    for (Eigen::Index a = 0; with_differing && a < d; ++a)
      out(p + k * d + a) += part(deviating_[static_cast<std::size_t>(a)]);
  }
  if (!with_differing) return out;
  for (Eigen::Index a = 0; a < d; ++a) {
    const double s = deviation_[static_cast<std::size_t>(a)];
    const Eigen::VectorXd row = inverse_kernel_ * differing_.row(a).transpose() / (s * s);
    for (Eigen::Index k = 0; k < n; ++k) out(p + k * d + a) += row(k);
  }
  return out;
}

Eigen::VectorXd CalibrationSearch::solve_step(bool with_differing, double damping, std::size_t left_out) const {
  return linear_algebra::solve_positive_definite(assemble(with_differing, damping, left_out),
                                                 Eigen::VectorXd(-gradient(with_differing, left_out)));
}

Eigen::MatrixXd CalibrationSearch::picked(std::size_t posture) const {
  const Eigen::Index p = common_.size(), d = differing_.rows();
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(p, p + d * static_cast<Eigen::Index>(data_.size()));
  out.leftCols(p).setIdentity();
  for (Eigen::Index a = 0; a < d; ++a) {
    out(deviating_[static_cast<std::size_t>(a)], p + static_cast<Eigen::Index>(posture) * d + a) = 1.0;
  }
  return out;
}

}  // namespace robomill::modal::detail
