#include "robomill/decision/program/speed_way.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace robomill::decision {
namespace {

/// Of two speeds as fast as each other that which is nearer to the programmed one is taken.
constexpr double programmed_share = 1e-9;

}  // namespace

SpeedWay::SpeedWay(const std::vector<ProgramStretch>& stretches, const ProgramOptions& options, CandidateSpeeds& speeds,
                   StretchCost& cost, Progress& progress)
    : stretches_(stretches),
      options_(options),
      speeds_(speeds),
      cost_(cost),
      progress_(progress),
      one_speed_(options.one_speed && options.free_speed),
      failures_(stretches.size(), 0),
      look_at_(stretches.size()) {
  rows_.reserve(stretches.size());
  for (const ProgramStretch& stretch : stretches) rows_.emplace_back(stretch, options.other_gain);
  std::iota(look_at_.begin(), look_at_.end(), std::size_t{0});
}

std::vector<std::size_t> SpeedWay::find() {
  static_cast<void>(find_on_grid());
  refine();
  return find_on_grid();
}

std::vector<std::size_t> SpeedWay::find_on_grid() {
  extend();
  std::vector<std::size_t> way;
  while (solve(way)) {
    if (!look_along(way)) return way;
  }
  return {};
}

bool SpeedWay::look_along(const std::vector<std::size_t>& way) {
  std::ranges::stable_sort(look_at_, std::ranges::greater{}, [this](std::size_t k) { return failures_[k]; });
  bool looked = false;
  for (const std::size_t k : look_at_) {
    if (rows_[k].exact(way[k])) continue;
    progress_.check();
    looked = true;
    if (!rows_[k].look(cost_, way[k])) {
      ++failures_[k];
      break;
    }
  }
  return looked;
}

void SpeedWay::extend() {
  for (std::size_t k = 0; k < stretches_.size(); ++k) {
    for (std::size_t j = rows_[k].size(); j < speeds_.size(); ++j) {
      if (may_take(k, j)) {
        rows_[k].add(cost_, j);
      } else {
        rows_[k].add_none();
      }
    }
  }
  order_.resize(speeds_.size());
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  std::ranges::sort(order_, {}, [this](std::size_t j) { return speed(j); });
}

/// Between two speeds that fail there may be one that holds; about speeds that fail by more than the whole limit it is
/// not looked for.
void SpeedWay::refine() {
  const std::size_t coarse = options_.free_speed ? speeds_.size() : 0;
  for (std::size_t j = 0; j < coarse; ++j) {
    if (nearly_holds(j)) speeds_.refine(j);
  }
}

bool SpeedWay::nearly_holds(std::size_t candidate) const {
  bool some = false;
  bool all = true;
  for (const StretchRow& row : rows_) {
    const std::optional<StretchTime> seen = row.seen(candidate);
    if (!seen) continue;
    const bool near = std::isfinite(seen->time_s) || seen->missed < 1.0;
    some = some || near;
    all = all && near;
  }
  return some && (all || !one_speed_);
}

/// A speed that is not free is another's where it differs.
bool SpeedWay::may_take(std::size_t stretch, std::size_t candidate) const {
  return options_.free_speed || speed(candidate) == stretches_[stretch].programmed_spindle_speed_rad_per_s;
}

double SpeedWay::ramp_s(std::size_t from, std::size_t to) const {
  return options_.ramp_rad_per_s2 > 0.0 ? std::abs(speed(from) - speed(to)) / options_.ramp_rad_per_s2 : 0.0;
}

double SpeedWay::cost_at(std::size_t stretch, std::size_t candidate) const {
  const double programmed = stretches_[stretch].programmed_spindle_speed_rad_per_s;
  return rows_[stretch].time_s(candidate) * (1.0 + programmed_share * std::abs(speed(candidate) / programmed - 1.0));
}

bool SpeedWay::solve(std::vector<std::size_t>& way) const {
  const std::size_t n = speeds_.size();
  std::vector<double> total(n, 0.0);
  std::vector<std::vector<std::size_t>> from;
  from.reserve(stretches_.size());
  for (std::size_t k = 0; k < stretches_.size(); ++k) {
    from.emplace_back(n);
    std::vector<std::size_t>& before = from.back();
    for (std::size_t j = 0; j < n; ++j) before[j] = j;
    // The cost of a change grows with the difference: one sweep up and one down find the best before each speed.
    const bool changes = k > 0 && !one_speed_;
    for (std::size_t step = 1; changes && step < n; ++step) relax(order_[step - 1], order_[step], total, before);
    for (std::size_t step = n; changes && step-- > 1;) relax(order_[step], order_[step - 1], total, before);
    for (std::size_t j = 0; j < n; ++j) total[j] += cost_at(k, j);
  }
  const auto last = std::ranges::min_element(total);
  if (last == total.end() || !std::isfinite(*last)) return false;
  way.assign(stretches_.size(), static_cast<std::size_t>(last - total.begin()));
  for (std::size_t k = stretches_.size() - 1; k > 0; --k) way[k - 1] = from[k][way[k]];
  return true;
}

void SpeedWay::relax(std::size_t from, std::size_t to, std::vector<double>& total,
                     std::vector<std::size_t>& before) const {
  const double changed = total[from] + ramp_s(from, to);
  if (changed >= total[to]) return;
  total[to] = changed;
  before[to] = before[from];
}

}  // namespace robomill::decision
