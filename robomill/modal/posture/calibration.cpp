#include "robomill/modal/posture/calibration.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "robomill/base/parallel.hpp"
#include "robomill/modal/posture/column_deviation.hpp"
#include "robomill/modal/posture/posture_normal.hpp"

namespace robomill::modal::detail {
namespace {

/// Residuals along neighbouring lines are alike: so many count as one.
constexpr double alike_lines = 4.0;
/// Of what differs from posture to posture, the share that nearby postures do not have in common.
constexpr double own_share = 0.2;
constexpr double process_length_rad = 1.0;
/// From the first stage on, the damping that is added to find the way, as a share of each frequency.
constexpr double stages[] = {0.15, 0.08, 0.04, 0.02};
constexpr int stage_lines[] = {30, 50, 80, 150};
constexpr std::size_t last_stage = std::size(stages) - 1;
/// The variance of a residual before anything is known, of 5 % each: the cell's numbers count until the data agree.
constexpr double first_noise = 40.0;

/// Everything that stays the same while the parameters are sought.
class CalibrationSearch {
 public:
  CalibrationSearch(const FlexibleArm& arm, const CalibrationData& data, bool varying, const Eigen::VectorXd& near)
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
            kernel_of(data.joints()[static_cast<std::size_t>(a)], data.joints()[static_cast<std::size_t>(b)]);
      }
    }
    kernel.diagonal().array() += own_share;
    inverse_kernel_ = kernel.llt().solve(Eigen::MatrixXd::Identity(n, n));
    common_ = near;
    differing_ = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(deviating_.size()), n);
  }

  static double kernel_of(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
    const double d = posture_distance(a, b) / process_length_rad;
    return (1.0 - own_share) * std::exp(-0.5 * d * d);
  }

  void stage(std::size_t i) {
    frfs_ = &data_.stage(i);
    // The first stages find the way, for which half of many postures do.
    constexpr std::size_t many = 8, thinned_stages = 2;
    const std::size_t step = i < thinned_stages && data_.size() >= many ? 2 : 1;
    active_.clear();
    for (std::size_t k = 0; k < data_.size(); k += step) active_.push_back(k);
  }

  [[nodiscard]] Eigen::VectorXd parameters_of(std::size_t posture) const {
    return parameters_of(common_, differing_, posture);
  }

  /// Levenberg-Marquardt over θ (and u).
  /// @param least_gain  of the cost, a share: less ends it
  void descend(int iterations, double least_gain, bool with_differing, Progress& progress) {
    evaluate(common_, differing_, true);
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
      evaluate(common_, differing_, true);
      if (gain < least_gain * cost) break;
    }
  }

  /// From residuals: the variance of one, alike lines counted once.
  void estimate_noise() {
    double cost = 0.0, residuals = 0.0;
    for (const std::size_t k : active_) {
      cost += normals_[k].cost;
      residuals += normals_[k].residuals;
    }
    noise_ = std::max(alike_lines * cost / std::max(residuals, 1.0), 1e-6);
  }
  [[nodiscard]] double noise() const { return noise_; }
  void expect_noise(double noise) { noise_ = noise; }
  [[nodiscard]] double error() const {
    double error = 0.0, size = 0.0;
    for (const std::size_t k : active_) {
      error += normals_[k].error;
      size += normals_[k].size;
    }
    return error / size;
  }

  /// (θ, u) without one posture, from the Gauss-Newton matrices at the solution; its covariance too.
  struct LeftOut {
    Eigen::VectorXd parameters;  ///< φ of the posture left out
    Eigen::MatrixXd covariance;  ///< of them
  };
  [[nodiscard]] LeftOut without(std::size_t posture) const {
    // A step too far for the linearised problem is damped until it does the other postures good.
    const double before = total(common_, differing_, posture);
    Eigen::VectorXd common;
    Eigen::MatrixXd differing, precision;
    double damping = 0.0;
    for (int attempt = 0; attempt < 6; ++attempt) {
      precision = assemble(true, damping, posture);
      const Eigen::VectorXd step = precision.llt().solve(-gradient(true, posture));
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
    return {.parameters = parameters_of(common, differing, posture),
            .covariance = pick * factor.solve(pick.transpose())};
  }
  [[nodiscard]] PostureNormal evaluate_at(std::size_t posture, const Eigen::VectorXd& parameters,
                                          bool derivatives) const {
    return normal_of(arm_, data_.joints()[posture], (*frfs_)[posture], parameters, derivatives);
  }
  /// A posture's own parameters: its receptances, with a wide prior about what was predicted.
  [[nodiscard]] Eigen::VectorXd refined(std::size_t posture, const Eigen::VectorXd& predicted, PostureNormal at) const {
    Eigen::VectorXd now = predicted;
    const auto cost = [&](const PostureNormal& normal, const Eigen::VectorXd& where) {
      return normal.cost / noise_ + (where - predicted).cwiseAbs2().dot(prior_);
    };
    constexpr int rounds = 3;
    for (int i = 0; i < rounds; ++i) {
      Eigen::MatrixXd matrix = at.matrix / noise_;
      matrix.diagonal() += prior_;
      const Eigen::VectorXd gradient = at.gradient / noise_ + prior_.cwiseProduct(now - predicted);
      const Eigen::VectorXd step = matrix.llt().solve(-gradient);
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
  [[nodiscard]] Eigen::MatrixXd covariance() const {
    const Eigen::MatrixXd precision = assemble(true, 0.0, SIZE_MAX);
    return precision.llt().solve(Eigen::MatrixXd::Identity(precision.rows(), precision.cols()));
  }
  [[nodiscard]] const Eigen::VectorXd& common() const { return common_; }
  [[nodiscard]] const Eigen::MatrixXd& differing() const { return differing_; }
  [[nodiscard]] const std::vector<Eigen::Index>& deviating() const { return deviating_; }

 private:
  [[nodiscard]] Eigen::VectorXd parameters_of(const Eigen::VectorXd& common, const Eigen::MatrixXd& differing,
                                              std::size_t posture) const {
    Eigen::VectorXd out = common;
    for (std::size_t d = 0; d < deviating_.size(); ++d) {
      out(deviating_[d]) += differing(static_cast<Eigen::Index>(d), static_cast<Eigen::Index>(posture));
    }
    return out;
  }

  void evaluate(const Eigen::VectorXd& common, const Eigen::MatrixXd& differing, bool derivatives) {
    normals_.resize(data_.size());
    parallel_for(active_.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const std::size_t k = active_[i];
        normals_[k] = evaluate_at(k, parameters_of(common, differing, k), derivatives);
      }
    });
  }

  /// @param left_out  a posture that does not count
  [[nodiscard]] double trial_cost(const Eigen::VectorXd& common, const Eigen::MatrixXd& differing,
                                  std::size_t left_out = SIZE_MAX) const {
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
  double total(const Eigen::VectorXd& common, const Eigen::MatrixXd& differing, std::size_t left_out = SIZE_MAX) const {
    double cost = prior_cost(common, differing);
    for (const std::size_t k : active_) {
      if (k != left_out) cost += normals_[k].cost / noise_;
    }
    return cost;
  }
  [[nodiscard]] double prior_cost(const Eigen::VectorXd& common, const Eigen::MatrixXd& differing) const {
    double cost = (common - start_).cwiseAbs2().dot(prior_);
    for (Eigen::Index d = 0; d < differing.rows(); ++d) {
      const double s = deviation_[static_cast<std::size_t>(d)];
      cost += (differing.row(d) * inverse_kernel_ * differing.row(d).transpose()).value() / (s * s);
    }
    return cost;
  }

  /// The precision of θ and u, or of θ alone. @param damping  Marquardt's, on the diagonal
  [[nodiscard]] Eigen::MatrixXd assemble(bool with_differing, double damping, std::size_t left_out) const {
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
          out(at + a, at + b) +=
              matrix(deviating_[static_cast<std::size_t>(a)], deviating_[static_cast<std::size_t>(b)]);
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
  [[nodiscard]] Eigen::VectorXd gradient(bool with_differing, std::size_t left_out) const {
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
  [[nodiscard]] Eigen::VectorXd solve_step(bool with_differing, double damping, std::size_t left_out) const {
    return assemble(with_differing, damping, left_out).llt().solve(-gradient(with_differing, left_out));
  }
  /// φ of a posture from (θ, u).
  [[nodiscard]] Eigen::MatrixXd picked(std::size_t posture) const {
    const Eigen::Index p = common_.size(), d = differing_.rows();
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(p, p + d * static_cast<Eigen::Index>(data_.size()));
    out.leftCols(p).setIdentity();
    for (Eigen::Index a = 0; a < d; ++a) {
      out(deviating_[static_cast<std::size_t>(a)], p + static_cast<Eigen::Index>(posture) * d + a) = 1.0;
    }
    return out;
  }

  const FlexibleArm& arm_;
  const CalibrationData& data_;
  Eigen::VectorXd start_, prior_;
  std::vector<Eigen::Index> deviating_;
  std::vector<double> deviation_;
  Eigen::MatrixXd inverse_kernel_;
  const std::vector<SmoothedFrf>* frfs_ = nullptr;
  std::vector<PostureNormal> normals_;
  Eigen::VectorXd common_;
  Eigen::MatrixXd differing_;
  std::vector<std::size_t> active_;
  double noise_ = first_noise, marquardt_ = 1e-3;
};

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
    const Eigen::MatrixXcd& r = by.residue[static_cast<std::size_t>(k)];
    out.residue(k) = std::sqrt(std::max(0.0, (r * covariance * r.adjoint()).trace().real()));
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
                      double highest_hz, Calibration& out) {
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
    out.left_out_predicted += direct_deviation(arm, before, left.covariance, data.last_stage()[k]);
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
  out.left_out_error = error / size;
  out.left_out_predicted /= static_cast<double>(data.size());
  for (std::size_t axis = 0; axis < direct.size(); ++axis) {
    out.left_out_direct(static_cast<Eigen::Index>(axis)) = direct[axis].ratio();
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

CalibrationData::CalibrationData(const std::vector<PostureData>& postures) {
  for (const PostureData& posture : postures) joints_.push_back(posture.joints());
  for (std::size_t i = 0; i < std::size(stages); ++i) {
    std::vector<SmoothedFrf>& stage = stages_.emplace_back(postures.size());
    parallel_for(postures.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        stage[k] = postures[k].smoothed(stages[i], stage_lines[i], i + 1 == std::size(stages));
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
    out.error = search.error();
  }
  out.noise = search.noise();
  out.common = search.common();
  out.differing = search.differing();
  out.deviating = search.deviating();
  out.covariance = search.covariance();
  out.left_out_error = std::numeric_limits<double>::quiet_NaN();
  if (choice.judged && data.size() >= 3) scale_deviations(arm, search, data, highest_hz, out);
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
      kernel(a, b) =
          CalibrationSearch::kernel_of(postures[static_cast<std::size_t>(a)], postures[static_cast<std::size_t>(b)]);
    }
    to(a) = CalibrationSearch::kernel_of(postures[static_cast<std::size_t>(a)], joints);
  }
  kernel.diagonal().array() += own_share;
  const Eigen::VectorXd weights = kernel.llt().solve(to);
  const double left = 1.0 - to.dot(weights);
  Eigen::MatrixXd pick = Eigen::MatrixXd::Zero(p, p + d * n);
  pick.leftCols(p).setIdentity();
  for (Eigen::Index a = 0; a < d; ++a) {
    const Eigen::Index row = calibration.deviating[static_cast<std::size_t>(a)];
    out.mean(row) += calibration.differing.row(a).dot(weights);
    for (Eigen::Index k = 0; k < n; ++k) pick(row, p + k * d + a) = weights(k);
  }
  out.covariance = pick * calibration.covariance * pick.transpose();
  for (Eigen::Index a = 0; a < d; ++a) {
    const Eigen::Index row = calibration.deviating[static_cast<std::size_t>(a)];
    const double s = arm.parameters()[static_cast<std::size_t>(row)].posture_deviation;
    out.covariance(row, row) += s * s * left;
  }
  return out;
}

}  // namespace robomill::modal::detail
