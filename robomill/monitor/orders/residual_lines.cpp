#include "robomill/monitor/orders/residual_lines.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <numeric>

namespace robomill::monitor {
namespace {

constexpr double reach = 6.0;             // 1/T, to each side of an order that it is taken off
constexpr std::size_t kernel_rows = 16;   // from one line to the next
constexpr float skirt = 0.5F;             // of an order's energy, over the square of the distance
constexpr double teeth_guard = 2.0;       // 1/T
constexpr int most_parts = 6;             // of an order, where it may be a multiple of the rotation
constexpr float fewest_apart = 4.5F;      // 1/T, that these stand apart: 15 Hz, the slowest rotation that is sought
constexpr std::size_t folds_a_line = 2;   // of 1/T
constexpr std::size_t fewest_folds = 20;  // whose median is the floor; with fewer it is that of the lines
constexpr std::size_t line_folds = 5;     // that a line spreads over

}  // namespace

ResidualLines::ResidualLines(const Spectrum& spectrum, double highest_hz)
    : like_{.seconds = spectrum.seconds, .step_hz = spectrum.step_hz, .line = {}},
      seconds_(spectrum.seconds),
      step_hz_(spectrum.step_hz),
      share_(spectrum.energy_share()) {
  lines_ = std::min(spectrum.line.size(), static_cast<std::size_t>(highest_hz / step_hz_));
  first_ = spectrum.first_line();
  order_lines_ = static_cast<std::size_t>(reach / (seconds_ * step_hz_));
  const double bin = seconds_ * step_hz_;  // a line's width in 1/T
  for (std::size_t row = 0; row <= kernel_rows; ++row) {
    const double order = static_cast<double>(order_lines_) - 0.5 + static_cast<double>(row) / kernel_rows;
    for (std::size_t i = 0; i <= 2 * order_lines_; ++i) {
      kernel_.push_back(static_cast<float>(hann_kernel((static_cast<double>(i) - order) * bin)));
    }
  }
  for (auto* of_each : {&share_of_, &skirt_below_, &skirt_above_, &re_, &im_}) of_each->resize(lines_);
  fold_of_.resize(lines_);
  left_.resize(lines_ + 1);
  order_energy_.resize(static_cast<std::size_t>(highest_hz / lowest_rotation_hz) + 2);
  fold_.resize(static_cast<std::size_t>(0.5 * highest_hz * seconds_ * folds_a_line) + 2 * line_folds);
  room_.resize(fold_.size());
  sorted_.resize(fold_.size());
  strongest_.resize(fold_.size());
  between_orders_.resize(order_energy_.size());
  between_.resize(order_energy_.size());
}

void ResidualLines::begin(double rotation_hz, int teeth, bool sure) noexcept {
  rotation_hz_ = std::max(rotation_hz, lowest_rotation_hz);
  teeth_ = teeth;
  std::ranges::fill(left_, 0.0F);
  std::ranges::fill(between_, 0.0F);
  whole_ = synchronous_ = 0.0;
  const double order_step = rotation_hz_ / step_hz_;
  orders_ = static_cast<std::size_t>(static_cast<double>(lines_ - 1) / order_step);
  folds_ = std::clamp<std::size_t>(static_cast<std::size_t>(0.5 * rotation_hz_ * seconds_ * folds_a_line), 1,
                                   fold_.size() - line_folds);
  const double bin = seconds_ * step_hz_;
  const auto apart = static_cast<float>(order_step * bin);
  const auto share = static_cast<float>(share_);
  const float folds_of_it = 2.0F * static_cast<float>(folds_) / apart;
  const auto last_fold = static_cast<std::int32_t>(folds_ - 1);
  const auto guard = [&](std::size_t k) {
    return (k % static_cast<std::size_t>(std::max(1, teeth)) == 0 ? teeth_guard : on_an_order) / bin;
  };
  for (std::size_t k = 0; k <= orders_; ++k) {
    const double at = static_cast<double>(k) * order_step;
    const std::size_t from = std::max(first_, static_cast<std::size_t>(std::ceil(at + guard(k))));
    const double last = std::min(at + order_step - guard(k + 1), static_cast<double>(lines_ - 1));
    const std::size_t to = last < static_cast<double>(from) ? from : static_cast<std::size_t>(last) + 1;
    between_orders_[k] = {from, to};
    const auto to_first = static_cast<float>((static_cast<double>(from) - at) * bin);
    const auto to_below = [&](std::size_t i) {
      return to_first + static_cast<float>(static_cast<std::int32_t>(i - from)) * static_cast<float>(bin);
    };
    for (std::size_t i = from; i < to; ++i) {
      const float below = to_below(i);
      const float above = apart - below;
      share_of_[i] = share;
      skirt_below_[i] = skirt / (below * below);
      skirt_above_[i] = skirt / (above * above);
      fold_of_[i] = std::min(last_fold, static_cast<std::int32_t>(std::min(below, above) * folds_of_it));
    }
    // At a half, third, … of an order.
    for (int parts = 2; !sure && parts <= most_parts && apart / static_cast<float>(parts) >= fewest_apart; ++parts) {
      const float part = apart / static_cast<float>(parts);
      for (std::size_t i = from; i < to; ++i) {
        const float below = to_below(i) / part;
        const std::int32_t nearest = static_cast<std::int32_t>(2.0F * below + 1.0F) / 2;
        const float off = below - static_cast<float>(nearest);
        share_of_[i] = std::abs(off) * part < static_cast<float>(on_an_order) ? 0.0F : share_of_[i];
      }
    }
  }
}

void ResidualLines::add(const Spectrum& spectrum) noexcept {
  for (std::size_t i = 0; i < lines_; ++i) {
    re_[i] = spectrum.line[i].real();
    im_[i] = spectrum.line[i].imag();
  }
  for (const auto* part : {&re_, &im_}) whole_ += share_ * sums_of(std::span(*part).subspan(first_)).squares;
  const double order_step = rotation_hz_ / step_hz_;
  const std::size_t columns = 2 * order_lines_ + 1;
  std::ranges::fill(order_energy_, 0.0F);
  for (std::size_t k = 1; k <= orders_; ++k) {
    const double at = static_cast<double>(k) * order_step;
    const auto near = static_cast<std::size_t>(std::lround(at));
    if (near >= lines_) break;
    const double place = (at - static_cast<double>(near) + 0.5) * kernel_rows;
    const std::size_t row = std::min(kernel_rows - 1, static_cast<std::size_t>(place));
    const auto part = static_cast<float>(place - static_cast<double>(row));
    const float* before = kernel_.data() + row * columns;
    const float* after = before + columns;
    const auto kernel = [&](std::size_t i) { return before[i] + part * (after[i] - before[i]); };
    const float re = re_[near] / kernel(order_lines_);
    const float im = im_[near] / kernel(order_lines_);
    order_energy_[k] = re * re + im * im;
    synchronous_ += static_cast<double>(order_energy_[k]);
    if (teeth_ > 0 && k % static_cast<std::size_t>(teeth_) != 0) between_[k] += order_energy_[k];
    const std::size_t first = near > order_lines_ ? 0 : order_lines_ + 1 - near;
    const std::size_t end = std::min(columns, lines_ + order_lines_ - near);
    for (std::size_t i = first; i < end; ++i) {
      re_[near + i - order_lines_] -= re * kernel(i);
      im_[near + i - order_lines_] -= im * kernel(i);
    }
  }
  for (std::size_t k = 0; k <= orders_; ++k) {
    const float below = order_energy_[k];
    const float above = order_energy_[k + 1];
    for (std::size_t i = between_orders_[k].from; i < between_orders_[k].to; ++i) {
      const float beside = below * skirt_below_[i] + above * skirt_above_[i];
      left_[i] += share_of_[i] * std::max(0.0F, re_[i] * re_[i] + im_[i] * im_[i] - beside);
    }
  }
}

void ResidualLines::share_out(double cell_hz, std::span<double> cells) const noexcept {
  const double cells_a_line = step_hz_ / cell_hz;
  for (std::size_t i = first_; i < lines_; ++i) {
    const auto cell = static_cast<std::size_t>(static_cast<double>(i) * cells_a_line);
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

// Of the lines that count, found bit by bit: the bits of numbers above 0 are in their order.
double ResidualLines::median_line(std::size_t count) const noexcept {
  const std::size_t rank = left_.size() - count + count / 2;
  std::int32_t median = 0;
  for (std::int32_t bit = 1 << 30; bit > 0; bit >>= 1) {
    const std::int32_t sought = median | bit;
    std::int32_t below = 0;
    for (const float energy : left_) below += std::bit_cast<std::int32_t>(energy) < sought ? 1 : 0;
    if (static_cast<std::size_t>(below) <= rank) median = sought;
  }
  return static_cast<double>(std::bit_cast<float>(median));
}

ResidualFamily ResidualLines::finish() noexcept {
  ResidualFamily out{.whole = whole_, .synchronous = synchronous_};
  out.teeth = synchronous_ - std::accumulate(between_.begin(), between_.end(), 0.0);
  std::fill_n(fold_.begin(), folds_, 0.0);
  std::fill_n(room_.begin(), folds_, 0.0);
  std::fill_n(strongest_.begin(), folds_, 0);
  std::size_t count = 0;
  for (std::size_t i = first_; i < lines_; ++i) {
    if (!(left_[i] > 0.0F)) continue;
    const auto j = static_cast<std::size_t>(fold_of_[i]);
    fold_[j] += static_cast<double>(left_[i]);
    room_[j] += 1.0;
    if (left_[i] > left_[strongest_[j]]) strongest_[j] = i;
    ++count;
  }
  // What a line holds where nothing stands out.
  double floor = 0.0;
  if (folds_ >= fewest_folds) {
    std::size_t known = 0;
    for (std::size_t j = 0; j < folds_; ++j) {
      if (room_[j] > 0.0) sorted_[known++] = fold_[j] / room_[j];
    }
    if (known > 0) {
      const auto middle = sorted_.begin() + static_cast<std::ptrdiff_t>(known / 2);
      std::nth_element(sorted_.begin(), middle, sorted_.begin() + static_cast<std::ptrdiff_t>(known));
      floor = *middle;
    }
  } else if (count > 0) {
    floor = median_line(count) / std::numbers::ln2;
  }
  const std::size_t width = std::min(line_folds, folds_);
  std::size_t best = 0;
  for (std::size_t j = 0; j + width <= folds_; ++j) {
    double sum = 0.0;
    for (std::size_t k = j; k < j + width; ++k) sum += fold_[k] - floor * room_[k];
    if (sum > out.family) {
      out.family = sum;
      best = j;
    }
  }
  if (out.family <= 0.0) return out;
  std::size_t at = 0;
  for (std::size_t j = best; j < best + width; ++j) {
    if (left_[strongest_[j]] > left_[at]) at = strongest_[j];
  }
  out.frequency_hz = like_.peak_hz(at, static_cast<double>(left_[at - 1]), static_cast<double>(left_[at]),
                                   static_cast<double>(left_[at + 1]));
  return out;
}

}  // namespace robomill::monitor
