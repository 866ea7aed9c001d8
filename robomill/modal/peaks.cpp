#include "robomill/modal/peaks.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "robomill/base/statistics.hpp"

namespace robomill::modal {
namespace {

constexpr double min_prominence = 0.23;         // 2 dB
constexpr double noise_factor = 10.0;           // white noise of many lines stays within eight of its deviations
constexpr Eigen::Index noise_half_window = 25;  // lines to either side that the noise is judged from
constexpr double merge_ratio = 0.05;
constexpr double min_damping_ratio = 1e-4;
constexpr double max_damping_ratio = 0.5;

/// Deviation of y's noise near a line, from second differences: they take a smooth curve out. Theirs is sqrt(6) times
/// that of white noise, and the median of a normal variable's magnitude is 0.6745 deviations.
double noise_near(const Eigen::VectorXd& y, Eigen::Index line) {
  std::vector<double> differences;
  const Eigen::Index last = std::min(y.size() - 2, line + noise_half_window);
  for (Eigen::Index i = std::max<Eigen::Index>(1, line - noise_half_window); i <= last; ++i) {
    differences.push_back(std::abs(y(i - 1) - 2.0 * y(i) + y(i + 1)));
  }
  return median(differences) / (0.6745 * std::sqrt(6.0));
}

/// How far one must come down from the line, to either side, before it goes up above it: the lesser of the two
/// descents, where the end of the axis counts as a descent to the lowest line on the way.
double prominence(const Eigen::VectorXd& y, Eigen::Index line) {
  double left = y(line);
  for (Eigen::Index i = line - 1; i >= 0 && y(i) <= y(line); --i) left = std::min(left, y(i));
  double right = y(line);
  for (Eigen::Index i = line + 1; i < y.size() && y(i) <= y(line); ++i) right = std::min(right, y(i));
  return y(line) - std::max(left, right);
}

/// Half-power width over twice the frequency. Where a flank does not come down by 3 dB before the next rise or the end
/// of the axis, twice the other flank counts, and the way to there where neither does.
double half_power_damping(const Eigen::VectorXd& frequency_hz, const Eigen::VectorXd& y, Eigen::Index line) {
  const double half_power = y(line) - 0.5 * std::numbers::ln2;
  const auto flank = [&](Eigen::Index step, bool& reached) {
    Eigen::Index i = line;
    while (i + step >= 0 && i + step < y.size() && y(i) > half_power) i += step;
    reached = y(i) <= half_power;
    return std::abs(frequency_hz(i) - frequency_hz(line));
  };
  bool left_reached = false;
  bool right_reached = false;
  const double left = flank(-1, left_reached);
  const double right = flank(1, right_reached);
  double width = left + right;
  if (left_reached != right_reached) width = 2.0 * (left_reached ? left : right);
  return std::clamp(width / (2.0 * frequency_hz(line)), min_damping_ratio, max_damping_ratio);
}

Eigen::VectorXd log_magnitude(const Frf& frf) {
  // A floor far below any receptance, so that a line of zero is no minus infinity.
  return frf.receptance.cwiseAbs().cwiseMax(1e-150).array().log().matrix();
}

double largest_receptance(Eigen::Index line, const std::vector<const Frf*>& frfs) {
  double largest = 0.0;
  for (const Frf* frf : frfs) largest = std::max(largest, std::abs(frf->receptance(line)));
  return largest;
}

}  // namespace

std::vector<Peak> pick_peaks(const Eigen::VectorXd& frequency_hz, const std::vector<const Frf*>& frfs) {
  std::vector<Peak> found;
  for (const Frf* frf : frfs) {
    const Eigen::VectorXd y = log_magnitude(*frf);
    for (Eigen::Index i = 1; i + 1 < y.size(); ++i) {
      if (!(y(i) > y(i - 1) && y(i) >= y(i + 1))) continue;
      const double height = prominence(y, i);
      if (height < min_prominence || height < noise_factor * noise_near(y, i)) continue;
      found.push_back({.frequency_hz = frequency_hz(i),
                       .prominence = height,
                       .damping_ratio = half_power_damping(frequency_hz, y, i),
                       .receptance = largest_receptance(i, frfs)});
    }
  }
  std::ranges::stable_sort(found, std::greater<>(), &Peak::prominence);
  std::vector<Peak> kept;
  for (const Peak& peak : found) {
    const bool near = std::ranges::any_of(kept, [&](const Peak& other) {
      return std::abs(other.frequency_hz - peak.frequency_hz) < merge_ratio * other.frequency_hz;
    });
    if (!near) kept.push_back(peak);
  }
  std::ranges::stable_sort(kept, {}, &Peak::frequency_hz);
  return kept;
}

Peak peak_at(double frequency_hz, const Eigen::VectorXd& axis_hz, const std::vector<const Frf*>& frfs) {
  Eigen::Index line = 0;
  (axis_hz.array() - frequency_hz).abs().minCoeff(&line);
  const Frf* strongest =
      *std::ranges::max_element(frfs, {}, [&](const Frf* frf) { return std::abs(frf->receptance(line)); });
  const Eigen::VectorXd y = log_magnitude(*strongest);
  return {.frequency_hz = frequency_hz,
          .prominence = prominence(y, line),
          .damping_ratio = half_power_damping(axis_hz, y, line),
          .receptance = std::abs(strongest->receptance(line))};
}

}  // namespace robomill::modal
