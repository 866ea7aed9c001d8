#include "robomill/monitor/orders/residual_lines.hpp"

#include <algorithm>
#include <cmath>

namespace robomill::monitor {
namespace {

constexpr float skirt = 0.5F;                            // of an order's energy, over the square of the distance
constexpr int most_parts = 6;                            // of an order, where it may be a multiple of the rotation
constexpr double fewest_apart = 4.5;                     // 1/T, that these stand apart
constexpr std::size_t fewest_folds = 4, line_folds = 5;  // of an order; that a line spreads over
constexpr std::size_t fewest_with_room = 3;              // whose median is the floor
// Orders folded about a multiple of the sample rate: as far as the sixth multiple of tooth passing they may be strong.
constexpr int folded_about = 2;       // multiples of the rate
constexpr double folded_teeth = 6.0;  // multiples of tooth passing
constexpr int usual_teeth = 4;
constexpr double least_apart = 10.0;                        // 1/T, where they are looked for
constexpr double folded_width = 1.25, folded_drift = 1e-3;  // 1/T; of the rate's multiple: the speed is off so far
constexpr float ten_db = 14.4F;  // of the floor: 10 dB over the mean of noise, whose median is the floor

}  // namespace

ResidualLines::ResidualLines(const Spectrum& spectrum, const Setup& setup)
    : setup_(setup),
      like_{.seconds = spectrum.seconds, .step_hz = spectrum.step_hz, .dip = spectrum.dip, .line = {}},
      bin_(spectrum.seconds * spectrum.step_hz),
      first_(spectrum.first_line()),
      lines_(std::min(spectrum.line.size() - 1, static_cast<std::size_t>(setup.highest_hz / spectrum.step_hz))) {
  order_energy_.resize(static_cast<std::size_t>(setup.highest_hz / lowest_rotation_hz) + 3);
  to_order_.resize(lines_);
  left_.resize(lines_ + 1);
  fold_of_.resize(lines_);
  fold_.resize(std::max(fewest_folds, static_cast<std::size_t>(setup.highest_hz * spectrum.seconds)) + 1);
  room_.resize(fold_.size());
  sorted_.resize(fold_.size());
}

ResidualFamily ResidualLines::find(std::span<const float> power, std::span<const float> floor,
                                   const Orders& orders) noexcept {
  orders_ = orders;
  orders_.rotation_hz = std::clamp(orders.rotation_hz, lowest_rotation_hz, setup_.highest_hz);
  order_step_ = orders_.rotation_hz / like_.step_hz;
  const double apart = order_step_ * bin_;
  folds_ = std::clamp(static_cast<std::size_t>(apart), fewest_folds, fold_.size());
  ResidualFamily out;
  measure_orders(power, out);
  keep_lines(power);
  if (!orders_.sure) leave_out_fractions();
  if (apart >= least_apart) leave_out_folded();
  const Family family = strongest_family();
  if (family.energy > 0.0) describe(family, power, floor, out);
  return out;
}

void ResidualLines::measure_orders(std::span<const float> power, ResidualFamily& out) noexcept {
  out.whole = sums_of(power.subspan(first_, lines_ - first_)).plain * like_.energy_share();
  count_ = std::min(order_energy_.size() - 2, static_cast<std::size_t>(static_cast<double>(lines_ - 1) / order_step_));
  order_energy_[0] = 0.0F;
  order_energy_[count_ + 1] = 0.0F;
  const auto teeth = static_cast<std::size_t>(std::max(1, orders_.teeth));
  for (std::size_t k = 1; k <= count_; ++k) {
    order_energy_[k] = like_.power_at(power, static_cast<double>(k) * order_step_);
    out.synchronous += static_cast<double>(order_energy_[k]);
    if (k % teeth == 0) out.teeth += static_cast<double>(order_energy_[k]);
  }
}

void ResidualLines::keep_lines(std::span<const float> power) noexcept {
  std::ranges::fill(left_, 0.0F);
  std::ranges::fill(to_order_, -1.0F);
  const auto apart = static_cast<float>(order_step_ * bin_);
  const auto share = static_cast<float>(like_.energy_share());
  const float folds_of_it = 2.0F * static_cast<float>(folds_) / apart;
  const auto last_fold = static_cast<std::int32_t>(folds_ - 1);
  const double guard = main_lobe / bin_;
  for (std::size_t k = 0; k <= count_; ++k) {
    const double at = static_cast<double>(k) * order_step_;
    const std::size_t from = std::max(first_, static_cast<std::size_t>(at + guard) + 1);
    const double last = std::min(at + order_step_ - guard, static_cast<double>(lines_) - 1.0);
    const float below_energy = skirt * order_energy_[k];
    const float above_energy = skirt * order_energy_[k + 1];
    for (std::size_t i = from; static_cast<double>(i) < last; ++i) {
      const auto below = static_cast<float>((static_cast<double>(i) - at) * bin_);
      const float above = apart - below;
      const float beside = below_energy / (below * below) + above_energy / (above * above);
      left_[i] = share * std::max(0.0F, power[i] - beside);
      to_order_[i] = std::min(below, above);
      fold_of_[i] = std::min(last_fold, static_cast<std::int32_t>(to_order_[i] * folds_of_it));
    }
  }
}

void ResidualLines::leave_out_fractions() noexcept {
  const double apart = order_step_ * bin_;
  for (int parts = 2; parts <= most_parts && apart / parts >= fewest_apart; ++parts) {
    const double part = order_step_ / parts;
    for (std::size_t i = first_; i < lines_; ++i) {
      const double place = static_cast<double>(i) / part;
      if (std::abs(place - std::round(place)) * part * bin_ < on_an_order) left_[i] = 0.0F, to_order_[i] = -1.0F;
    }
  }
}

// Without a filter before the converter an order k f near a multiple m of the rate stands at |m fs - k f|: all of these
// at one fraction of an order.
void ResidualLines::leave_out_folded() noexcept {
  const double apart = order_step_ * bin_;
  const double strong_hz = folded_teeth * orders_.rotation_hz * (orders_.teeth > 0 ? orders_.teeth : usual_teeth);
  for (int m = 1; m <= folded_about; ++m) {
    if ((m - 0.5) * setup_.sample_rate_hz >= strong_hz) return;
    const double orders = m * setup_.sample_rate_hz / orders_.rotation_hz;
    const auto at = static_cast<float>(std::abs(orders - std::round(orders)) * apart);
    const auto width = static_cast<float>(folded_width + folded_drift * m * setup_.sample_rate_hz * like_.seconds);
    for (std::size_t i = first_; i < lines_; ++i) {
      if (std::abs(to_order_[i] - at) <= width) left_[i] = 0.0F, to_order_[i] = -1.0F;
    }
  }
}

ResidualLines::Family ResidualLines::strongest_family() noexcept {
  std::fill_n(fold_.begin(), folds_, 0.0);
  std::fill_n(room_.begin(), folds_, 0.0);
  for (std::size_t i = first_; i < lines_; ++i) {
    if (to_order_[i] < 0.0F) continue;
    fold_[static_cast<std::size_t>(fold_of_[i])] += static_cast<double>(left_[i]);
    room_[static_cast<std::size_t>(fold_of_[i])] += 1.0;
  }
  std::size_t known = 0;
  for (std::size_t j = 0; j < folds_; ++j) {
    if (room_[j] > 0.0) sorted_[known++] = fold_[j] / room_[j];
  }
  Family out{.folds = std::min(line_folds, folds_)};
  if (known < fewest_with_room) return out;
  const auto middle = sorted_.begin() + static_cast<std::ptrdiff_t>(known / 2);
  std::nth_element(sorted_.begin(), middle, sorted_.begin() + static_cast<std::ptrdiff_t>(known));
  const double floor = *middle;
  for (std::size_t j = 0; j + out.folds <= folds_; ++j) {
    double sum = 0.0;
    for (std::size_t k = j; k < j + out.folds; ++k) sum += fold_[k] - floor * room_[k];
    if (sum > out.energy) {
      out.energy = sum;
      out.first_fold = j;
    }
  }
  return out;
}

void ResidualLines::describe(const Family& family, std::span<const float> power, std::span<const float> floor,
                             ResidualFamily& out) const noexcept {
  out.family = family.energy;
  const float share = static_cast<float>(like_.energy_share());
  std::size_t strongest = 0;
  std::size_t counted = 0;  // half orders, from 1, up to the last one that has a line
  for (std::size_t i = first_; i < lines_; ++i) {
    const auto fold = static_cast<std::size_t>(fold_of_[i]);
    if (to_order_[i] < 0.0F || fold < family.first_fold || fold >= family.first_fold + family.folds) continue;
    if (left_[i] > left_[strongest]) strongest = i;
    if (floor.empty() || left_[i] <= ten_db * share * floor[i]) continue;
    const auto half = static_cast<std::size_t>(2.0 * static_cast<double>(i) / order_step_) + 1;
    if (half == counted || power[i] < power[i - 1] || power[i] < power[i + 1]) continue;
    counted = half;
    ++out.lines;
  }
  out.frequency_hz = like_.peak_hz(strongest, static_cast<double>(power[strongest - 1]),
                                   static_cast<double>(power[strongest]), static_cast<double>(power[strongest + 1]));
}

void ResidualLines::share_out(double cell_hz, std::span<double> cells) const noexcept {
  const double cells_a_line = like_.step_hz / cell_hz;
  for (std::size_t i = first_; i < lines_; ++i) {
    const auto cell = static_cast<std::size_t>(static_cast<double>(i) * cells_a_line);
    cells[std::min(cells.size() - 1, cell)] += static_cast<double>(left_[i]);
  }
}

double ResidualLines::between(double from_hz, double to_hz) const noexcept {
  const auto from = std::max(first_, static_cast<std::size_t>(std::ceil(from_hz / like_.step_hz)));
  const auto end = std::min(lines_, static_cast<std::size_t>(std::ceil(to_hz / like_.step_hz)));
  return from < end ? sums_of(std::span(left_).subspan(from, end - from)).plain : 0.0;
}

void ResidualLines::share_out_between(double cell_hz, std::span<double> cells) const noexcept {
  const auto cell = [&](double hz) { return std::min(cells.size() - 1, static_cast<std::size_t>(hz / cell_hz)); };
  for (std::size_t k = 1; orders_.teeth > 0 && k <= count_; ++k) {
    if (k % static_cast<std::size_t>(orders_.teeth) == 0) continue;
    // An order at the border of two cells stands in both, however its speed wavers.
    const double hz = static_cast<double>(k) * orders_.rotation_hz;
    const double place = hz / cell_hz - 0.5;
    const double part = place - std::floor(place);
    const auto energy = static_cast<double>(order_energy_[k]);
    cells[cell(std::max(0.0, hz - 0.5 * cell_hz))] += (1.0 - part) * energy;
    cells[cell(hz + 0.5 * cell_hz)] += part * energy;
  }
}

}  // namespace robomill::monitor
