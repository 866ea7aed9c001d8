#include "robomill/decision/program/candidates.hpp"

#include <algorithm>
#include <cmath>

namespace robomill::decision {
namespace {

/// The coarse grid's steps are no wider; the fine grid has so many in each.
constexpr double widest_step = 0.01, narrowest_step = 0.0025;
constexpr int fine_steps = 4;

}  // namespace

CandidateSpeeds::CandidateSpeeds(const std::vector<ProgramStretch>& stretches, const ProgramOptions& options)
    : options_(options) {
  if (options.speed_window > 0.0) {
    const double step = std::clamp(0.5 * options.speed_window, narrowest_step, widest_step);
    window_ = {.ratio = 1.0 + step, .half = static_cast<int>(std::ceil(options.speed_window / step - 1e-9))};
  }
  if (options.free_speed) {
    const double range = std::log(options.max_spindle_speed_rad_per_s / options.min_spindle_speed_rad_per_s);
    const int steps = static_cast<int>(std::floor(range / std::log(window_.ratio) + 1e-9));
    for (int i = 0; i <= steps; ++i) add_step(fine_steps * i);
    add_alone(options.max_spindle_speed_rad_per_s);
  }
  for (const ProgramStretch& stretch : stretches) {
    const double programmed = stretch.programmed_spindle_speed_rad_per_s;
    const bool inside =
        programmed >= options.min_spindle_speed_rad_per_s && programmed <= options.max_spindle_speed_rad_per_s;
    if (!options.free_speed || inside) add_alone(programmed);
  }
}

void CandidateSpeeds::refine(std::size_t candidate) {
  const int step = candidates_[candidate].step;
  if (step < 0) return;
  for (int fine = step - fine_steps + 1; fine < step + fine_steps; ++fine) {
    if (fine > 0) add_step(fine);
  }
}

std::size_t CandidateSpeeds::grid_speed(int step) {
  const auto [found, is_new] = grid_.try_emplace(step, speeds_.size());
  if (is_new) {
    const double low = options_.min_spindle_speed_rad_per_s;
    const double speed = low * std::pow(window_.ratio, static_cast<double>(step) / fine_steps);
    speeds_.push_back(speed);
  }
  return found->second;
}

double CandidateSpeeds::rounded(double speed) const {
  const double unit = options_.speed_step_rad_per_s;
  if (unit > 0.0) speed = std::max(1.0, std::round(speed / unit)) * unit;
  // Rounding must not take the ends of the range out of a spindle's curve that ends there too.
  for (const double end : {options_.min_spindle_speed_rad_per_s, options_.max_spindle_speed_rad_per_s}) {
    if (std::abs(speed - end) < 1e-9 * end) speed = end;
  }
  return speed;
}

void CandidateSpeeds::add_step(int step) {
  const std::size_t center = grid_speed(step);
  CandidateSpeed candidate = {.spindle_speed_rad_per_s = rounded(speeds_[center]), .step = step};
  const bool inside = candidate.spindle_speed_rad_per_s >= options_.min_spindle_speed_rad_per_s * (1.0 - 1e-12) &&
                      candidate.spindle_speed_rad_per_s <= options_.max_spindle_speed_rad_per_s * (1.0 + 1e-12);
  const bool there = std::ranges::any_of(candidates_, [&](const CandidateSpeed& c) {
    return c.spindle_speed_rad_per_s == candidate.spindle_speed_rad_per_s;
  });
  if (!inside || there) return;
  for (int k = -window_.half; k <= window_.half; ++k) candidate.window.push_back(grid_speed(step + fine_steps * k));
  candidates_.push_back(std::move(candidate));
}

void CandidateSpeeds::add_alone(double speed) {
  if (std::ranges::any_of(candidates_, [&](const CandidateSpeed& c) { return c.spindle_speed_rad_per_s == speed; })) {
    return;
  }
  CandidateSpeed candidate = {.spindle_speed_rad_per_s = speed};
  for (int k = -window_.half; k <= window_.half; ++k) {
    candidate.window.push_back(speeds_.size());
    speeds_.push_back(k == 0 ? speed : speed * std::pow(window_.ratio, k));
  }
  candidates_.push_back(std::move(candidate));
}

}  // namespace robomill::decision
