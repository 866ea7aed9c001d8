#include "robomill/monitor/orders/residual_lines.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace robomill::monitor {
namespace {

constexpr double reach = 6.0;               // 1/T, to each side of an order that it is taken off
constexpr double kernel_steps = 32.0;       // of 1/T
constexpr double skirt = 0.5;               // of an order's energy, over the square of the distance
constexpr double order_guard = 0.75;        // 1/T
constexpr double teeth_guard = 2.0;         // 1/T
constexpr int most_parts = 6;               // of an order, where it may be a multiple of the rotation
constexpr double fewest_apart = 4.5;        // 1/T, that these stand apart: 15 Hz, the slowest rotation that is sought
constexpr std::size_t folds_a_line = 2;     // of 1/T
constexpr std::size_t fewest_folds = 20;    // whose median is the floor; with fewer it is that of the lines
constexpr std::size_t line_folds = 5;       // that a line spreads over
constexpr double lowest_rotation_hz = 5.0;  // so many orders are kept room for

}  // namespace

ResidualLines::ResidualLines(const Spectrum& spectrum, double highest_hz)
    : like_{.seconds = spectrum.seconds, .step_hz = spectrum.step_hz, .line = {}},
      seconds_(spectrum.seconds),
      step_hz_(spectrum.step_hz),
      share_(spectrum.energy_share()) {
  lines_ = std::min(spectrum.line.size(), static_cast<std::size_t>(highest_hz / step_hz_));
  first_ = spectrum.first_line();
  order_lines_ = static_cast<std::size_t>(reach / (seconds_ * step_hz_));
  kernel_.resize(static_cast<std::size_t>((reach + 1.0) * kernel_steps) + 2);
  for (std::size_t i = 0; i < kernel_.size(); ++i) {
    kernel_[i] = static_cast<float>(hann_kernel(static_cast<double>(i) / kernel_steps));
  }
  rest_.resize(lines_);
  left_.resize(lines_);
  order_energy_.resize(static_cast<std::size_t>(highest_hz / lowest_rotation_hz) + 2);
  fold_.resize(static_cast<std::size_t>(0.5 * highest_hz * seconds_ * folds_a_line) + 2 * line_folds);
  room_.resize(fold_.size());
  sorted_.resize(std::max(fold_.size(), lines_));
  between_.resize(order_energy_.size());
}

void ResidualLines::begin(double rotation_hz, int teeth, bool sure) noexcept {
  sure_ = sure;
  rotation_hz_ = std::max(rotation_hz, lowest_rotation_hz);
  teeth_ = teeth;
  std::ranges::fill(left_, 0.0F);
  std::ranges::fill(between_, 0.0F);
  whole_ = synchronous_ = 0.0;
}

// At a half, third, … of an order.
bool ResidualLines::near_a_fraction(double to_below) const noexcept {
  const double order = rotation_hz_ * seconds_;
  for (int parts = 2; parts <= most_parts; ++parts) {
    if (order / parts < fewest_apart) return false;
    if (std::abs(std::remainder(to_below, order / parts)) < order_guard) return true;
  }
  return false;
}

void ResidualLines::add(const Spectrum& spectrum) noexcept {
  std::copy_n(spectrum.line.begin(), lines_, rest_.begin());
  double whole = 0.0;
  for (std::size_t i = first_; i < lines_; ++i) whole += static_cast<double>(std::norm(rest_[i]));
  whole_ += whole * share_;
  const double order_step = rotation_hz_ / step_hz_;
  const auto orders = static_cast<std::size_t>(static_cast<double>(lines_ - 1) / order_step);
  const double bin = seconds_ * step_hz_;  // a line's width in 1/T
  const auto kernel = [&](double u) {
    const double at = std::abs(u) * kernel_steps;
    const auto k = static_cast<std::size_t>(at);
    return kernel_[k] + static_cast<float>(at - static_cast<double>(k)) * (kernel_[k + 1] - kernel_[k]);
  };
  for (std::size_t k = 1; k <= orders; ++k) {
    const double at = static_cast<double>(k) * order_step;
    const auto near = static_cast<std::size_t>(std::lround(at));
    if (near >= lines_) break;
    const std::complex<float> amplitude = rest_[near] / kernel((static_cast<double>(near) - at) * bin);
    order_energy_[k] = std::norm(amplitude);
    synchronous_ += static_cast<double>(order_energy_[k]);
    const std::size_t from = near > order_lines_ ? near - order_lines_ : 1;
    const std::size_t to = std::min(lines_, near + order_lines_ + 1);
    for (std::size_t i = from; i < to; ++i) rest_[i] -= amplitude * kernel((static_cast<double>(i) - at) * bin);
  }
  order_energy_[0] = order_energy_[orders + 1] = 0.0F;
  for (std::size_t k = 1; k <= orders && teeth_ > 0; ++k) {
    if (k % static_cast<std::size_t>(teeth_) != 0) between_[k] += order_energy_[k];
  }
  const auto share = static_cast<float>(share_);
  const int teeth = std::max(1, teeth_);
  for (std::size_t i = first_; i < lines_; ++i) {
    const double order = static_cast<double>(i) / order_step;
    const auto below = static_cast<std::size_t>(order);
    const double to_below = (order - static_cast<double>(below)) * rotation_hz_ * seconds_;
    const double to_above = rotation_hz_ * seconds_ - to_below;
    const auto guard = [&](std::size_t k) {
      return k % static_cast<std::size_t>(teeth) == 0 ? teeth_guard : order_guard;
    };
    if (to_below < guard(below) || to_above < guard(below + 1)) continue;
    if (!sure_ && near_a_fraction(to_below)) continue;
    const double beside = skirt * (static_cast<double>(order_energy_[below]) / (to_below * to_below) +
                                   static_cast<double>(order_energy_[below + 1]) / (to_above * to_above));
    left_[i] += share * std::max(0.0F, std::norm(rest_[i]) - static_cast<float>(beside));
  }
}

void ResidualLines::share_out(double cell_hz, std::span<double> cells) const noexcept {
  for (std::size_t i = first_; i < lines_; ++i) {
    const auto cell = static_cast<std::size_t>(static_cast<double>(i) * step_hz_ / cell_hz);
    cells[std::min(cells.size() - 1, cell)] += static_cast<double>(left_[i]);
  }
}

void ResidualLines::share_out_between(double cell_hz, std::span<double> cells) const noexcept {
  const auto cell = [&](double hz) { return std::min(cells.size() - 1, static_cast<std::size_t>(hz / cell_hz)); };
  for (std::size_t k = 1; static_cast<double>(k) * rotation_hz_ < static_cast<double>(lines_) * step_hz_; ++k) {
    // An order at the border of two cells stands in both, however its speed wavers.
    const double hz = static_cast<double>(k) * rotation_hz_;
    const double place = hz / cell_hz - 0.5;
    const double part = place - std::floor(place);
    cells[cell(std::max(0.0, hz - 0.5 * cell_hz))] += (1.0 - part) * static_cast<double>(between_[k]);
    cells[cell(hz + 0.5 * cell_hz)] += part * static_cast<double>(between_[k]);
  }
}

ResidualFamily ResidualLines::finish() noexcept {
  ResidualFamily out{.whole = whole_, .synchronous = synchronous_};
  const auto folds = std::clamp<std::size_t>(static_cast<std::size_t>(0.5 * rotation_hz_ * seconds_ * folds_a_line), 1,
                                             fold_.size() - line_folds);
  std::fill_n(fold_.begin(), folds, 0.0);
  std::fill_n(room_.begin(), folds, 0.0);
  const auto place = [&](std::size_t i) {
    const double order = static_cast<double>(i) * step_hz_ / rotation_hz_;
    const double fraction = std::abs(order - std::round(order));
    return std::min(folds - 1, static_cast<std::size_t>(2.0 * fraction * static_cast<double>(folds)));
  };
  std::size_t count = 0;
  for (std::size_t i = first_; i < lines_; ++i) {
    if (!(left_[i] > 0.0F)) continue;
    const auto energy = static_cast<double>(left_[i]);
    out.residual += energy;
    const std::size_t j = place(i);
    fold_[j] += energy;
    room_[j] += 1.0;
    ++count;
  }
  // What a line holds where nothing stands out.
  double floor = 0.0;
  if (folds >= fewest_folds) {
    std::size_t known = 0;
    for (std::size_t j = 0; j < folds; ++j) {
      if (room_[j] > 0.0) sorted_[known++] = fold_[j] / room_[j];
    }
    if (known > 0) {
      const auto middle = sorted_.begin() + static_cast<std::ptrdiff_t>(known / 2);
      std::nth_element(sorted_.begin(), middle, sorted_.begin() + static_cast<std::ptrdiff_t>(known));
      floor = *middle;
    }
  } else if (count > 0) {
    std::size_t known = 0;
    for (std::size_t i = first_; i < lines_ && known < sorted_.size(); ++i) {
      if (left_[i] > 0.0F) sorted_[known++] = static_cast<double>(left_[i]);
    }
    const auto middle = sorted_.begin() + static_cast<std::ptrdiff_t>(known / 2);
    std::nth_element(sorted_.begin(), middle, sorted_.begin() + static_cast<std::ptrdiff_t>(known));
    floor = *middle / std::numbers::ln2;
  }
  const std::size_t width = std::min(line_folds, folds);
  std::size_t best = 0;
  for (std::size_t j = 0; j + width <= folds; ++j) {
    double sum = 0.0;
    for (std::size_t k = j; k < j + width; ++k) sum += fold_[k] - floor * room_[k];
    if (sum > out.family) {
      out.family = sum;
      best = j;
    }
  }
  float most = 0.0F;
  std::size_t at = 0;
  for (std::size_t i = 1; i + 1 < lines_ && out.family > 0.0; ++i) {
    const std::size_t j = place(i);
    if (j < best || j >= best + width || left_[i] <= most) continue;
    most = left_[i];
    at = i;
  }
  if (at > 0) {
    const auto reach_lines = static_cast<std::size_t>(1.25 / (seconds_ * step_hz_));
    for (std::size_t i = at > reach_lines ? at - reach_lines : 1; i < std::min(lines_, at + reach_lines + 1); ++i) {
      out.line += static_cast<double>(left_[i]);
    }
    out.frequency_hz = like_.peak_hz(at, static_cast<double>(left_[at - 1]), static_cast<double>(most),
                                     static_cast<double>(left_[at + 1]));
  }
  return out;
}

}  // namespace robomill::monitor
