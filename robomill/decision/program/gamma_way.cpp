#include "robomill/decision/program/gamma_way.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace robomill::decision {
namespace {

constexpr double unreachable = std::numeric_limits<double>::infinity();
/// Share of the time that a radian away from the programmed γ counts, and a step: it decides between ways as fast as
/// each other.
constexpr double turn_share = 1e-6;

double largest_step(const std::vector<double>& gamma_rad) {
  double widest = 0.0;
  for (std::size_t g = 1; g < gamma_rad.size(); ++g) widest = std::max(widest, gamma_rad[g] - gamma_rad[g - 1]);
  return widest;
}

}  // namespace

GammaWay::GammaWay(const std::vector<double>& times_s, const ProgramOptions& options) {
  const double least_s = largest_step(options.gamma_rad) / options.gamma_rate_rad_per_s;
  double group_s = 0.0;
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    if (i == 0 || group_s >= least_s) {
      begin_.push_back(i);
      group_s = 0.0;
    }
    group_s += times_s[i];
    group_.push_back(begin_.size() - 1);
  }
  // What remains at the end is too short for a step of its own.
  if (begin_.size() > 1 && group_s < least_s) {
    begin_.pop_back();
    for (std::size_t& group : group_) group = std::min(group, begin_.size() - 1);
  }
  begin_.push_back(times_s.size());
  const double total_s = std::accumulate(times_s.begin(), times_s.end(), 0.0);
  step_s_ = turn_share * total_s / static_cast<double>(begin_.size());
  for (const double gamma : options.gamma_rad) turn_s_.push_back(step_s_ * std::abs(gamma));
}

bool GammaWay::solve(const TimeAt& time_at) {
  const std::size_t gammas = turn_s_.size();
  const std::size_t groups = begin_.size() - 1;
  std::vector<double> cost = turn_s_;
  std::vector<std::size_t> from(groups * gammas, 0);
  std::vector<std::vector<double>> times;
  for (std::size_t s = 0; s < groups; ++s) {
    times.assign(gammas, {});
    for (std::size_t g = 0; g < gammas; ++g) {
      for (std::size_t i = begin_[s]; i < begin_[s + 1]; ++i) times[g].push_back(time_at(i, g));
    }
    std::vector<double> next(gammas, unreachable);
    for (std::size_t g = 0; g < gammas; ++g) {
      for (std::size_t before = g == 0 ? 0 : g - 1; before <= std::min(g + 1, gammas - 1); ++before) {
        double total = cost[before] + turn_s_[g] + (before == g ? 0.0 : step_s_);
        for (std::size_t i = 0; i < times[g].size() && std::isfinite(total); ++i) {
          total += std::max(times[g][i], times[before][i]);
        }
        if (total < next[g]) {
          next[g] = total;
          from[s * gammas + g] = before;
        }
      }
    }
    cost = next;
  }
  const auto last = std::ranges::min_element(cost);
  if (!std::isfinite(*last)) return false;
  gamma_.assign(groups + 1, static_cast<std::size_t>(last - cost.begin()));
  for (std::size_t s = groups; s-- > 0;) gamma_[s] = from[s * gammas + gamma_[s + 1]];
  return true;
}

std::vector<GammaWay::Place> GammaWay::places() const {
  std::vector<Place> out;
  for (std::size_t i = 0; i < group_.size(); ++i) {
    const std::size_t begin = gamma_[group_[i]];
    const std::size_t end = gamma_[group_[i] + 1];
    out.push_back({.cut = i, .gamma = begin});
    if (end != begin) out.push_back({.cut = i, .gamma = end});
  }
  return out;
}

}  // namespace robomill::decision
