#include "robomill/decision/program/even_feeds.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace robomill::decision {
namespace {

constexpr double none = std::numeric_limits<double>::infinity();
/// Levels that feeds are chosen from stand so close, and there are so many of them at most.
constexpr double level_ratio = 0.9975;
constexpr std::size_t most_levels = 600;

/// The greatest whole multiple of the step up to `most`, where that is not below `least`.
double stepped(double least, double most, double step) {
  if (step <= 0.0) return most;
  const double down = std::floor(most / step * (1.0 + 1e-12)) * step;
  return down >= least * (1.0 - 1e-12) && down > 0.0 ? down : most;
}

double time_of(const std::vector<FeedBounds>& cuts, const std::vector<double>& feeds) {
  double time = 0.0;
  for (std::size_t i = 0; i < cuts.size(); ++i) time += cuts[i].length_m / feeds[i];
  return time;
}

std::vector<double> levels_of(const std::vector<FeedBounds>& cuts, double step) {
  std::vector<double> own;
  own.reserve(cuts.size());
  for (const FeedBounds& cut : cuts) own.push_back(stepped(cut.least_m_per_s, cut.most_m_per_s, step));
  std::ranges::sort(own);
  own.erase(std::unique(own.begin(), own.end()), own.end());
  if (own.size() <= most_levels) return own;
  const double ratio = std::min(level_ratio, std::pow(own.front() / own.back(), 1.0 / most_levels));
  std::vector<double> levels;
  for (double level = own.back(); level > own.front(); level *= ratio) levels.push_back(stepped(0.0, level, step));
  std::ranges::sort(levels);
  levels.erase(std::unique(levels.begin(), levels.end()), levels.end());
  return levels;
}

/// Feeds of the least time + penalty · changes.
class LevelPath {
 public:
  /// @param own  feeds of cuts whose bounds hold no level
  LevelPath(const std::vector<FeedBounds>& cuts, std::vector<double> levels, const std::vector<double>& own)
      : cuts_(cuts), levels_(std::move(levels)), own_(own) {
    for (const FeedBounds& cut : cuts) {
      held_.push_back(std::ranges::any_of(levels_, [&](double level) { return holds(cut, level); }));
    }
    from_.resize(cuts_.size() * levels_.size());
    cost_.resize(levels_.size());
  }

  std::vector<double> solve(double penalty_s) {
    std::ranges::fill(cost_, 0.0);
    for (std::size_t i = 0; i < cuts_.size(); ++i) {
      const auto best = static_cast<std::size_t>(std::ranges::min_element(cost_) - cost_.begin());
      const double change = i == 0 ? 0.0 : cost_[best] + penalty_s;
      for (std::size_t l = 0; l < levels_.size(); ++l) {
        const bool stay = cost_[l] <= change || i == 0;
        from_[i * levels_.size() + l] = static_cast<std::uint16_t>(stay ? l : best);
        cost_[l] = (stay ? cost_[l] : change) + time_at(i, levels_[l]);
      }
    }
    std::vector<double> feeds(cuts_.size());
    auto level = static_cast<std::size_t>(std::ranges::min_element(cost_) - cost_.begin());
    for (std::size_t i = cuts_.size(); i-- > 0;) {
      feeds[i] = held_[i] ? levels_[level] : own_[i];
      level = from_[i * levels_.size() + level];
    }
    return feeds;
  }

 private:
  static bool holds(const FeedBounds& bounds, double feed) {
    return feed >= bounds.least_m_per_s * (1.0 - 1e-12) && feed <= bounds.most_m_per_s * (1.0 + 1e-12);
  }
  [[nodiscard]] double time_at(std::size_t cut, double feed) const {
    if (!held_[cut]) return cuts_[cut].length_m / own_[cut];
    return holds(cuts_[cut], feed) ? cuts_[cut].length_m / feed : none;
  }
  const std::vector<FeedBounds>& cuts_;
  std::vector<double> levels_;
  const std::vector<double>& own_;
  std::vector<bool> held_ = {};  ///< its bounds hold some level
  std::vector<std::uint16_t> from_;
  std::vector<double> cost_;
};

}  // namespace

std::vector<double> even_feeds(const std::vector<FeedBounds>& cuts, double slack, double step_m_per_s) {
  std::vector<double> best;
  best.reserve(cuts.size());
  for (const FeedBounds& cut : cuts) best.push_back(stepped(cut.least_m_per_s, cut.most_m_per_s, step_m_per_s));
  if (cuts.empty() || slack <= 0.0) return best;
  const double allowed_s = (1.0 + slack) * time_of(cuts, best);
  const std::vector<double> own = best;
  LevelPath path(cuts, levels_of(cuts, step_m_per_s), own);
  double low = 0.0;
  double high = allowed_s;
  for (int i = 0; i < 20; ++i) {
    const double penalty = 0.5 * (low + high);
    const std::vector<double> feeds = path.solve(penalty);
    if (time_of(cuts, feeds) <= allowed_s) {
      best = feeds;
      low = penalty;
    } else {
      high = penalty;
    }
  }
  return best;
}

}  // namespace robomill::decision
