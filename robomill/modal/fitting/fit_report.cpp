#include "robomill/modal/fitting/fit_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace robomill::modal::detail {
namespace {

using Eigen::Index;

std::string list_of(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

void warn_of_gaps(FitResult& result, const FrfSet& set, const FrfSet& model) {
  std::vector<std::string> implied;
  std::vector<std::string> zero;
  for (const Frf& frf : model.frfs) {
    if (set.find(frf.name) != nullptr) continue;
    (frf.receptance.squaredNorm() > 0.0 ? implied : zero).push_back(to_string(frf.name));
  }
  if (!zero.empty()) {
    result.warnings.push_back(fmt::format(
        "{} not measured: taken as zero. Measure the cross FRFs to know how the directions act on each other.",
        list_of(zero)));
  }
  if (!implied.empty()) {
    result.warnings.push_back(fmt::format(
        "{} not measured: follows from the other FRFs' mode vectors, with their errors.", list_of(implied)));
  }
}

// A force at rest must not take power out of the structure: Im H_ii <= 0.
void warn_of_activity(FitResult& result, const FrfSet& model) {
  constexpr double negligible = 1e-6;  // of the largest |H_ii|
  for (const Frf& frf : model.frfs) {
    if (frf.name.response != frf.name.excitation) continue;
    const double threshold = negligible * frf.receptance.cwiseAbs().maxCoeff();
    const auto active = static_cast<double>((frf.receptance.imag().array() > threshold).count());
    const double share = active / static_cast<double>(frf.receptance.size());
    if (share < 0.005) continue;
    result.warnings.push_back(fmt::format(
        "The model is not passive: Im H_{} > 0 on {:.0f} % of the lines (a force there would take power out).",
        to_string(frf.name), 100.0 * share));
  }
}

void warn_of_one_way(FitResult& result, const FrfSet& model) {
  constexpr double tolerated = 0.05;
  for (const Frf& frf : model.frfs) {
    if (!(frf.name.response < frf.name.excitation)) continue;
    const Frf* other = model.find({.response = frf.name.excitation, .excitation = frf.name.response});
    if (other == nullptr) continue;
    const double size = std::max(frf.receptance.norm(), other->receptance.norm());
    const double difference = (frf.receptance - other->receptance).norm();
    if (difference <= tolerated * size) continue;
    result.warnings.push_back(
        fmt::format("The model is not reciprocal: H_{} and H_{} differ by {:.0f} % of the larger.", to_string(frf.name),
                    to_string(other->name), 100.0 * difference / size));
  }
}

// A blow cannot move a mass at once: 2 Re Σ R Lᵀ = 0, or H falls as 1/ω above the modes where it should as 1/ω².
void warn_of_jump(FitResult& result) {
  constexpr double tolerated = 0.02;
  const ModalModel& model = result.model;
  Eigen::MatrixXd sum =
      Eigen::MatrixXd::Zero(static_cast<Index>(model.responses.size()), static_cast<Index>(model.excitations.size()));
  double size = 0.0;
  for (const Mode& mode : model.modes) {
    const Eigen::MatrixXcd residue = mode.right * mode.left.transpose();
    sum += 2.0 * residue.real();
    size += 2.0 * residue.norm();
  }
  if (sum.norm() <= tolerated * size) return;
  result.warnings.push_back(
      fmt::format("2 Re Σ R Lᵀ is {:.0f} % of the residues' size where a complete structure has 0: modes outside the "
                  "band, or noise.",
                  100.0 * sum.norm() / size));
}

void warn_of_vague_modes(FitResult& result) {
  for (const Mode& mode : result.model.modes) {
    const double share = mode.damping_ratio_std / mode.damping_ratio;
    if (mode.weak || !(share > 0.5)) continue;
    result.warnings.push_back(
        fmt::format("The mode at {:.1f} Hz is vague: the standard deviation of its damping ratio is {:.0f} % of it.",
                    mode.frequency_hz, 100.0 * share));
  }
}

void note_weak_modes(FitResult& result) {
  std::vector<std::string> weak;
  for (std::size_t k = 0; k < result.model.modes.size(); ++k) {
    if (result.model.modes[k].weak) weak.push_back(std::to_string(k + 1));
  }
  if (weak.empty()) return;
  result.warnings.push_back(
      fmt::format("Weak: mode {}. The FRFs hardly show {}: no warning and no name of a vibration rests on {}.",
                  list_of(weak), weak.size() == 1 ? "it" : "them", weak.size() == 1 ? "it" : "them"));
}

void warn_of_error(FitResult& result) {
  const double error = result.relative_error;
  if (error < doubtful_fit_error) return;
  result.warnings.push_back(
      error < unusable_fit_error
          ? fmt::format("The fit differs from the FRFs by {:.3g} %: look at both before you use a number.",
                        100.0 * error)
          : fmt::format("The modes do not describe the FRFs: the fit differs from them by {:.3g} %. Fit the band "
                        "in which the FRFs can be trusted, or ask for more modes.",
                        100.0 * error));
}

void warn_of_bounds(FitResult& result) {
  for (const ModeAtBound& at : result.at_bounds) {
    const Mode& mode = result.model.modes[static_cast<std::size_t>(at.mode - 1)];
    result.warnings.push_back(
        at.bound == FitBound::damping || at.bound == FitBound::swarm_damping
            ? fmt::format("The mode at {:.1f} Hz stands at the bound of the damping ratio, {:.4g}: it is no mode that "
                          "the FRFs show, but fills what the others leave.",
                          mode.frequency_hz, mode.damping_ratio)
            : fmt::format(
                  "The mode at {:.1f} Hz stands at the {} end of the band: it is no mode that the FRFs show, but "
                  "stands for something outside. Widen the band, or fit fewer modes.",
                  mode.frequency_hz, at.bound == FitBound::band_low ? "lower" : "upper"));
  }
}

}  // namespace

void set_errors(FitResult& result, const FrfSet& set) {
  const FrfSet model = synthesize(result.model, set.frequency_hz);
  double error2 = 0.0;
  double size2 = 0.0;
  double sum = 0.0;
  double lines = 0.0;
  for (const Frf& frf : set.frfs) {
    const Frf* fitted = model.find(frf.name);
    const Eigen::VectorXcd difference = fitted == nullptr ? frf.receptance : fitted->receptance - frf.receptance;
    FrfFitError one{.name = frf.name};
    double ratio = 0.0;
    double counted = 0.0;
    for (Index i = 0; i < difference.size(); ++i) {
      if (frf.receptance(i) == 0.0) continue;
      ratio += std::abs(difference(i)) / std::abs(frf.receptance(i));
      counted += 1.0;
    }
    if (counted > 0.0) one.relative = difference.norm() / frf.receptance.norm();
    error2 += difference.squaredNorm();
    size2 += frf.receptance.squaredNorm();
    sum += ratio;
    lines += counted;
    result.by_frf.push_back(one);
  }
  result.relative_error = size2 > 0.0 ? std::sqrt(error2 / size2) : 0.0;
  result.mean_relative_error = lines > 0.0 ? sum / lines : 0.0;
}

void find_bounds(FitResult& result, const FitOptions& options) {
  const bool swarm = options.method == FitMethod::pso;
  const double max_damping_ratio = swarm ? options.pso_max_damping_ratio : options.max_damping_ratio;
  constexpr double same_damping = 1e-3;  // as a share of the bound
  constexpr double same_line = 0.5;      // of the lines' distance
  const double near_hz = same_line * (result.band_high_hz - result.band_low_hz) /
                         static_cast<double>(std::max<Index>(result.lines - 1, 1));
  for (std::size_t k = 0; k < result.model.modes.size(); ++k) {
    const Mode& mode = result.model.modes[k];
    const int number = static_cast<int>(k) + 1;
    if (mode.damping_ratio >= (1.0 - same_damping) * max_damping_ratio) {
      result.at_bounds.push_back({number, swarm ? FitBound::swarm_damping : FitBound::damping});
    }
    if (mode.frequency_hz <= result.band_low_hz + near_hz) result.at_bounds.push_back({number, FitBound::band_low});
    if (mode.frequency_hz >= result.band_high_hz - near_hz) result.at_bounds.push_back({number, FitBound::band_high});
  }
}

void add_warnings(FitResult& result, const FrfSet& set) {
  warn_of_error(result);
  warn_of_bounds(result);
  note_weak_modes(result);
  const FrfSet model = synthesize(result.model, set.frequency_hz);
  warn_of_gaps(result, set, model);
  warn_of_activity(result, model);
  warn_of_one_way(result, model);
  warn_of_jump(result);
  warn_of_vague_modes(result);
}

}  // namespace robomill::modal::detail
