#include "testing/modal/posture_judge.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <limits>
#include <numbers>

#include "robomill/modal/posture/assignment.hpp"
#include "robomill/stability/lobes.hpp"
#include "robomill/stability/uncertainty.hpp"

namespace robomill::modal::testing {
namespace {

using std::numbers::pi;
constexpr double close_modes = 0.03;             // relative
constexpr double matching_log_frequency = 0.15;  // as bad as a shape without likeness
constexpr double no_match = 1.5;

Eigen::Matrix3cd residue(const Mode& mode) {
  return mode.right * mode.left.transpose();
}

/// Peak of ‖H‖ of a mode alone.
double peak_of(const Eigen::Matrix3cd& residue, double frequency_hz, double damping_ratio) {
  return residue.norm() / (2.0 * pi * frequency_hz * damping_ratio);
}

Eigen::Matrix3cd receptance(const ModalModel& model, double frequency_hz) {
  const std::complex<double> s(0.0, 2.0 * pi * frequency_hz);
  Eigen::Matrix3cd out = Eigen::Matrix3cd::Zero();
  for (const Mode& mode : model.modes) {
    out += residue(mode) / (s - pole(mode)) + residue(mode).conjugate() / (s - std::conj(pole(mode)));
  }
  for (const Residual& residual : model.residuals) {
    const auto i = static_cast<Eigen::Index>(residual.name.response.axis) - 1;
    out(i, static_cast<Eigen::Index>(residual.name.excitation.axis) - 1) += residual.stiffness;
  }
  return out;
}

double cost_of(const Mode& a, const Mode& b) {
  const Eigen::Matrix3cd ra = residue(a), rb = residue(b);
  const double size = ra.squaredNorm() * rb.squaredNorm();
  const double likeness = size > 0.0 ? std::norm((ra.conjugate().array() * rb.array()).sum()) / size : 0.0;
  return std::min(no_match,
                  std::abs(std::log(a.frequency_hz / b.frequency_hz)) / matching_log_frequency + 1.0 - likeness);
}

/// Of each true mode its predicted one, or -1.
std::vector<Eigen::Index> partners(const std::vector<Mode>& truth, const std::vector<Mode>& predicted) {
  if (truth.empty() || predicted.empty()) return std::vector<Eigen::Index>(truth.size(), -1);
  Eigen::MatrixXd cost(truth.size(), predicted.size());
  for (std::size_t i = 0; i < truth.size(); ++i) {
    for (std::size_t j = 0; j < predicted.size(); ++j) {
      cost(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = cost_of(truth[i], predicted[j]);
    }
  }
  std::vector<Eigen::Index> out = detail::assign(cost);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (out[i] >= 0 && cost(static_cast<Eigen::Index>(i), out[i]) >= no_match) out[i] = -1;
  }
  return out;
}

/// Modes that count as one.
struct Group {
  double frequency_hz = 0.0, deviation_hz = 0.0, size = 0.0;
  Eigen::Matrix3cd residue = Eigen::Matrix3cd::Zero();
  void add(const Mode& mode) {
    const Eigen::Matrix3cd of_mode = testing::residue(mode);
    const double weight = of_mode.norm();
    frequency_hz = (size * frequency_hz + weight * mode.frequency_hz) / (size + weight);
    deviation_hz = (size * deviation_hz + weight * mode.frequency_std_hz) / (size + weight);
    size += weight;
    residue += of_mode;
  }
};

stability::LobesProblem problem_of(const ModalModel& modes) {
  stability::LobesProblem out;
  out.milling.tool = {.teeth = 3, .diameter_m = 0.016};
  out.milling.immersion = cutting::immersion(cutting::MillingDirection::up, 0.008, 0.016);
  out.milling.coefficients = {.tangential_n_per_m2 = 800e6, .radial_n_per_m2 = 250e6};
  out.milling.feed_per_tooth_m = 1e-4;
  out.dynamics = modes;
  return out;
}

stability::LobesOptions lobes_options(bool heavy) {
  stability::LobesOptions out;
  out.axial_depth_m = {0.0, heavy ? 0.006 : 0.0015};
  out.grid = {2, 60};
  out.tolerance = 1e-4;
  return out;
}

constexpr double rpm = 2.0 * pi / 60.0;

}  // namespace

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  const auto last = static_cast<double>(values.size() - 1);
  return values[static_cast<std::size_t>(std::lround(share * last))];
}

PostureJudge::PostureJudge(const SimulatedArm& arm, const PostureJudgeOptions& options)
    : arm_(&arm), options_(options) {
  for (const Eigen::VectorXd& joints : arm.held_out_postures()) {
    Truth truth{.modes = arm.modes(joints), .peak_m_per_n = 0.0, .limit_m = {}, .band_limit_m = {}};
    for (const Mode& mode : truth.modes.modes) {
      truth.peak_m_per_n = std::max(truth.peak_m_per_n, receptance(truth.modes, mode.frequency_hz).norm());
    }
    if (options_.limits) truth.limit_m = limits(truth.modes, options_.spindle_speed_rpm);
    if (options_.bands) truth.band_limit_m = limits(truth.modes, options_.band_spindle_speed_rpm);
    truth_.push_back(std::move(truth));
  }
}

std::vector<double> PostureJudge::limits(const ModalModel& modes, const std::vector<double>& spindle_speed_rpm) const {
  std::vector<double> speeds;
  for (const double speed : spindle_speed_rpm) speeds.push_back(speed * rpm);
  std::vector<double> out;
  for (const stability::Limit& limit :
       stability::limit_depths(problem_of(modes), lobes_options(arm_->is_heavy()), speeds)) {
    out.push_back(limit.status == stability::Limit::Status::found ? limit.axial_depth_m
                                                                  : std::numeric_limits<double>::infinity());
  }
  return out;
}

void PostureJudge::judge_modes(const Truth& truth, const ModalModel& predicted, PostureScore& score) const {
  const std::vector<Mode>& modes = truth.modes.modes;
  const std::vector<Eigen::Index> partner = partners(modes, predicted.modes);
  std::vector<char> taken(predicted.modes.size(), 0);
  for (const Eigen::Index j : partner) {
    if (j >= 0) taken[static_cast<std::size_t>(j)] = 1;
  }
  for (std::size_t first = 0, last = 0; first < modes.size(); first = last + 1) {
    for (last = first; last + 1 < modes.size(); ++last) {
      if (modes[last + 1].frequency_hz > (1.0 + close_modes) * modes[last].frequency_hz) break;
    }
    if (modes[first].frequency_hz > options_.highest_hz) break;
    Group of_truth, of_model;
    bool seen = false, lone = first == last;
    double own_peak = 0.0;
    for (std::size_t k = first; k <= last; ++k) {
      of_truth.add(modes[k]);
      const double peak = peak_of(residue(modes[k]), modes[k].frequency_hz, modes[k].damping_ratio);
      own_peak = std::max(own_peak, peak);
      seen = seen || peak > 0.1 * receptance(truth.modes, modes[k].frequency_hz).norm();
      if (partner[k] >= 0) of_model.add(predicted.modes[static_cast<std::size_t>(partner[k])]);
    }
    if (!seen) continue;
    if (!(of_model.size > 0.0)) {
      ++score.missed;
      continue;
    }
    for (std::size_t j = 0; j < predicted.modes.size() && !lone; ++j) {  // a group of more modes than the true one
      const double f = predicted.modes[j].frequency_hz;
      if (taken[j] != 0 || f < modes[first].frequency_hz || f > modes[last].frequency_hz) continue;
      of_model.add(predicted.modes[j]);
    }
    const double error_hz = std::abs(of_model.frequency_hz - of_truth.frequency_hz);
    score.frequency_error.push_back(error_hz / of_truth.frequency_hz);
    if (own_peak >= 0.01 * truth.peak_m_per_n) {
      score.residue_error.push_back((of_model.residue - of_truth.residue).norm() / of_truth.residue.norm());
    }
    if (!std::isfinite(of_model.deviation_hz)) continue;
    ++score.banded;
    if (error_hz <= 1.96 * of_model.deviation_hz) ++score.frequencies_in_band;
  }
}

void PostureJudge::judge_limits(const Truth& truth, const ModalModel& predicted, PostureScore& score) const {
  const stability::LobesOptions options = lobes_options(arm_->is_heavy());
  if (options_.limits) {
    const std::vector<double> found = limits(predicted, options_.spindle_speed_rpm);
    for (std::size_t k = 0; k < found.size(); ++k) {
      const double limit = truth.limit_m[k];
      if (!std::isfinite(limit)) continue;
      const double relative = std::min(found[k], options.axial_depth_m[1]) / limit - 1.0;
      score.limit_error.push_back(std::abs(relative));
      if (relative > 0.1) ++score.too_deep;
    }
  }
  if (!options_.bands) return;
  stability::LobesOptions at = options;
  at.spindle_speed_rad_per_s = {options_.band_spindle_speed_rpm.front() * rpm,
                                options_.band_spindle_speed_rpm.back() * rpm};
  const stability::UncertainLimits band =
      stability::uncertain_limits(problem_of(predicted), at, {.samples = 40, .grid = {2, 60}, .seed = 7});
  for (Eigen::Index k = 0; k < 2; ++k) {
    const double limit = truth.band_limit_m[static_cast<std::size_t>(k)];
    ++score.banded_limits;
    if (limit >= band.limit_5_percent_m(k) && limit <= band.limit_95_percent_m(k)) ++score.limits_in_band;
  }
}

PostureScore PostureJudge::judge(const PosturePredictor& predict) const {
  PostureScore out;
  for (std::size_t p = 0; p < truth_.size(); ++p) {
    const ModalModel predicted = predict(arm_->held_out_postures()[p]);
    judge_modes(truth_[p], predicted, out);
    judge_limits(truth_[p], predicted, out);
  }
  return out;
}

}  // namespace robomill::modal::testing
