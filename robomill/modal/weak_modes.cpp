#include "robomill/modal/weak_modes.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

namespace robomill::modal {
namespace {

using Eigen::Index;

constexpr double clear_of_scatter = 2.0;   // ‖H_k‖ over the scatter
constexpr double no_peak_damping = 0.1;    // damped more heavily, a small mode only bends a baseline
constexpr double vague_deviation = 0.2;    // of the damping ratio and of the half-power half-width
constexpr double vague_share = 0.2;        // of the FRF, below which a vague mode is weak
constexpr Index fewest_lines = 4;          // to each side of a mode that is sharper than its lines
constexpr double scatter_half_widths = 3;  // the scatter is taken from a band so many times as wide

/// Lines within `reach` of a frequency, at least `fewest` to each side where the axis has them.
struct LineRange {
  Index first = 0, count = 0;
};
LineRange lines_around(const Eigen::VectorXd& frequency_hz, double at_hz, double reach_hz, Index fewest) {
  const double* const begin = frequency_hz.data();
  const double* const end = begin + frequency_hz.size();
  const Index nearest = std::lower_bound(begin, end, at_hz) - begin;
  const Index low = std::lower_bound(begin, end, at_hz - reach_hz) - begin;
  const Index high = std::upper_bound(begin, end, at_hz + reach_hz) - begin;
  const Index first = std::clamp<Index>(std::min(low, nearest - fewest), 0, frequency_hz.size() - 1);
  const Index last = std::clamp<Index>(std::max(high, nearest + fewest + 1), first + 1, frequency_hz.size());
  return {first, last - first};
}

double mean_square(const Eigen::VectorXcd& values, const LineRange& at) {
  return values.segment(at.first, at.count).squaredNorm() / static_cast<double>(at.count);
}

/// Variance of complex Gaussian errors by the median of their squares, which sharp peaks do not move.
double scatter_square(const Eigen::VectorXcd& error, const LineRange& at) {
  Eigen::VectorXd squares = error.segment(at.first, at.count).cwiseAbs2();
  double* const middle = squares.data() + squares.size() / 2;
  std::nth_element(squares.data(), middle, squares.data() + squares.size());
  return *middle / std::numbers::ln2;
}

/// What one mode makes of the FRFs over its half-power band, of the FRF where that is most.
struct ModeShare {
  double of_frf = 0.0, of_scatter = 0.0;
};
ModeShare share_of(const ModalModel& model, std::size_t k, const FrfSet& frfs, const FrfSet& fitted) {
  const Mode& mode = model.modes[k];
  const FrfSet own =
      synthesize({.excitations = model.excitations, .responses = model.responses, .modes = {mode}}, frfs.frequency_hz);
  const double half_width_hz = mode.damping_ratio * mode.frequency_hz;
  const LineRange peak = lines_around(frfs.frequency_hz, mode.frequency_hz, half_width_hz, fewest_lines);
  const LineRange wide = lines_around(frfs.frequency_hz, mode.frequency_hz, scatter_half_widths * half_width_hz,
                                      static_cast<Index>(scatter_half_widths) * fewest_lines);
  ModeShare share;
  for (const Frf& frf : frfs.frfs) {
    const Frf* const part = own.find(frf.name);
    const Frf* const whole = fitted.find(frf.name);
    if (part == nullptr || whole == nullptr) continue;
    const double size = mean_square(part->receptance, peak);
    if (!(size > 0.0) || !(mean_square(frf.receptance, peak) > 0.0)) continue;
    share.of_frf = std::max(share.of_frf, std::sqrt(size / mean_square(frf.receptance, peak)));
    const double scatter = scatter_square(whole->receptance - frf.receptance, wide);
    share.of_scatter = std::max(share.of_scatter, std::sqrt(size / scatter));
  }
  return share;
}

bool knows_deviations(const Mode& mode) {
  return std::isfinite(mode.frequency_std_hz) && std::isfinite(mode.damping_ratio_std);
}

/// What other modes make changes by a share of about ζ over f (1 ± ζ) as well.
bool only_bends(const Mode& mode, const ModeShare& share) {
  return mode.damping_ratio > no_peak_damping && share.of_frf < mode.damping_ratio;
}

bool vague_and_small(const Mode& mode, const ModeShare& share) {
  const double limit = vague_deviation * mode.damping_ratio;
  const bool vague = mode.damping_ratio_std > limit || mode.frequency_std_hz > limit * mode.frequency_hz;
  return vague && share.of_frf < vague_share;
}

}  // namespace

void mark_weak_modes(ModalModel& model, const FrfSet& frfs) {
  frfs.validate();
  const FrfSet fitted = synthesize(model, frfs.frequency_hz);
  for (std::size_t k = 0; k < model.modes.size(); ++k) {
    Mode& mode = model.modes[k];
    const ModeShare share = share_of(model, k, frfs, fitted);
    mode.weak = share.of_scatter < clear_of_scatter || only_bends(mode, share) || vague_and_small(mode, share);
  }
}

void mark_weak_modes(ModalModel& model) {
  model.validate();
  constexpr Index lines = 41;
  for (std::size_t k = 0; k < model.modes.size(); ++k) {
    Mode& mode = model.modes[k];
    mode.weak = false;
    if (!knows_deviations(mode)) continue;
    const Eigen::VectorXd band =
        mode.frequency_hz * Eigen::VectorXd::LinSpaced(lines, 1.0 - mode.damping_ratio, 1.0 + mode.damping_ratio);
    const FrfSet sum = synthesize(model, band);
    const ModeShare share = share_of(model, k, sum, sum);
    mode.weak = only_bends(mode, share) || vague_and_small(mode, share);
  }
}

ModalStiffness modal_stiffness(const ModalModel& model, std::size_t mode) {
  model.validate();
  const Mode& of = model.modes.at(mode);
  std::map<int, std::pair<double, double>> squares;  // of R and L, by point
  for (std::size_t i = 0; i < model.responses.size(); ++i) {
    const auto found = std::ranges::find(model.excitations, model.responses[i]);
    if (found == model.excitations.end() || model.responses[i].axis > Axis::z) continue;
    auto& [right, left] = squares[model.responses[i].point];
    right += std::norm(of.right(static_cast<Index>(i)));
    left += std::norm(of.left(found - model.excitations.begin()));
  }
  double residue = 0.0;
  for (const auto& [point, size] : squares) residue = std::max(residue, std::sqrt(size.first * size.second));
  if (!(residue > 0.0)) return {};
  const double mass_kg = 1.0 / (2.0 * pole(of).imag() * residue);
  const double omega = 2.0 * std::numbers::pi * of.frequency_hz;
  return {.stiffness_n_per_m = mass_kg * omega * omega, .mass_kg = mass_kg};
}

}  // namespace robomill::modal
