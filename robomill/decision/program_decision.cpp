#include "robomill/decision/program_decision.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "robomill/base/error.hpp"
#include "robomill/decision/program/candidates.hpp"
#include "robomill/decision/program/even_feeds.hpp"
#include "robomill/decision/program/looks.hpp"
#include "robomill/decision/program/stretch_cost.hpp"

namespace robomill::decision {
namespace {

/// Of two speeds as fast as each other that which is nearer to the programmed one is taken.
constexpr double programmed_share = 1e-9;
/// Rejected speeds that are reported stand this share apart.
constexpr double distinct_speed = 0.03;

/// One stretch at each candidate speed: bounds until it has been looked at.
struct StretchRow {
  std::vector<StretchAt> at = {};
  std::vector<bool> exact = {};
};

/// The least time through stretches × speeds.
class SpeedWay {
 public:
  SpeedWay(const std::vector<ProgramStretch>& stretches, const ProgramOptions& options, CandidateSpeeds& speeds,
           StretchCost& cost, Progress& progress)
      : stretches_(stretches), options_(options), speeds_(speeds), cost_(cost), progress_(progress) {
    rows_.resize(stretches.size());
  }

  /// The candidate of each stretch; empty where some stretch has none. Where a speed of the grid nearly holds, finer
  /// steps about it are taken in.
  std::vector<std::size_t> find() {
    static_cast<void>(find_on_grid());
    refine();
    return find_on_grid();
  }

  [[nodiscard]] const StretchRow& row(std::size_t stretch) const { return rows_[stretch]; }
  /// Whether a speed that is not free is another's.
  [[nodiscard]] bool may_take(std::size_t stretch, std::size_t candidate) const {
    return options_.free_speed ||
           speeds_[candidate].spindle_speed_rad_per_s == stretches_[stretch].programmed_spindle_speed_rad_per_s;
  }

 private:
  std::vector<std::size_t> find_on_grid() {
    extend();
    std::vector<std::size_t> way;
    while (solve(way)) {
      bool seen = true;
      for (std::size_t k = 0; k < way.size(); ++k) {
        if (rows_[k].exact[way[k]]) continue;
        progress_.check();
        rows_[k].at[way[k]] = cost_.exact(stretches_[k], way[k]);
        rows_[k].exact[way[k]] = true;
        seen = false;
        if (!std::isfinite(rows_[k].at[way[k]].time_s)) break;
      }
      if (seen) return way;
    }
    return {};
  }

  /// Bounds of the candidates that are new.
  void extend() {
    for (std::size_t k = 0; k < stretches_.size(); ++k) {
      for (std::size_t j = rows_[k].at.size(); j < speeds_.size(); ++j) {
        rows_[k].at.push_back(may_take(k, j) ? cost_.bound(stretches_[k], j) : StretchAt{});
        rows_[k].exact.push_back(!std::isfinite(rows_[k].at.back().time_s));
      }
    }
    order_.resize(speeds_.size());
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    std::ranges::sort(order_, {}, [this](std::size_t j) { return speed(j); });
  }

  /// Between two speeds that fail there may be one that holds; about speeds that fail by more than the whole limit it
  /// is not looked for.
  void refine() {
    const std::size_t coarse = speeds_.size();
    for (std::size_t j = 0; j < coarse; ++j) {
      const bool near = std::ranges::any_of(rows_, [&](const StretchRow& row) {
        return row.exact[j] && (std::isfinite(row.at[j].time_s) || shortfall(row.at[j].stopped_by) < 1.0);
      });
      if (near && options_.free_speed) speeds_.refine(j);
    }
  }

  [[nodiscard]] double speed(std::size_t candidate) const { return speeds_[candidate].spindle_speed_rad_per_s; }
  [[nodiscard]] double ramp_s(std::size_t from, std::size_t to) const {
    return options_.ramp_rad_per_s2 > 0.0 ? std::abs(speed(from) - speed(to)) / options_.ramp_rad_per_s2 : 0.0;
  }
  [[nodiscard]] double cost_at(std::size_t stretch, std::size_t candidate) const {
    const double time = rows_[stretch].at[candidate].time_s;
    const double programmed = stretches_[stretch].programmed_spindle_speed_rad_per_s;
    return time * (1.0 + programmed_share * std::abs(speed(candidate) / programmed - 1.0));
  }

  /// The least time by what is known.
  bool solve(std::vector<std::size_t>& way) const {
    const std::size_t n = speeds_.size();
    std::vector<double> total(n, 0.0);
    std::vector<std::vector<std::size_t>> from;
    for (std::size_t k = 0; k < stretches_.size(); ++k) {
      from.emplace_back(n);
      std::vector<std::size_t>& before = from.back();
      for (std::size_t j = 0; j < n; ++j) before[j] = j;
      // The cost of a change grows with the difference: one sweep up and one down find the best before each speed.
      for (std::size_t step = 1; k > 0 && step < n; ++step) relax(order_[step - 1], order_[step], total, before);
      for (std::size_t step = n; k > 0 && step-- > 1;) relax(order_[step], order_[step - 1], total, before);
      for (std::size_t j = 0; j < n; ++j) total[j] += cost_at(k, j);
    }
    const auto last = std::ranges::min_element(total);
    if (last == total.end() || !std::isfinite(*last)) return false;
    way.assign(stretches_.size(), static_cast<std::size_t>(last - total.begin()));
    for (std::size_t k = stretches_.size() - 1; k > 0; --k) way[k - 1] = from[k][way[k]];
    return true;
  }

  void relax(std::size_t from, std::size_t to, std::vector<double>& total, std::vector<std::size_t>& before) const {
    const double changed = total[from] + ramp_s(from, to);
    if (changed >= total[to]) return;
    total[to] = changed;
    before[to] = before[from];
  }

  const std::vector<ProgramStretch>& stretches_;
  const ProgramOptions& options_;
  CandidateSpeeds& speeds_;
  StretchCost& cost_;
  Progress& progress_;
  std::vector<std::size_t> order_ = {};  ///< of the candidates, by speed
  std::vector<StretchRow> rows_ = {};
};

RejectedSpeed rejected(const StretchAt& at, const StretchAt& bound, std::size_t stretch, double speed) {
  return {.spindle_speed_rad_per_s = speed,
          .stretch = stretch,
          .cutting_time_s = std::isfinite(at.time_s) ? at.time_s : bound.time_s,
          .stopped_by = at.stopped_by,
          .cut = at.cut};
}

/// The first of them that stand apart from each other and from the speed that was taken.
std::vector<RejectedSpeed> distinct(const std::vector<RejectedSpeed>& all, double taken, int most) {
  std::vector<RejectedSpeed> out;
  const auto near = [](double a, double b) { return std::abs(a - b) < distinct_speed * b; };
  for (const RejectedSpeed& one : all) {
    if (std::ssize(out) >= most) break;
    const double speed = one.spindle_speed_rad_per_s;
    const bool another =
        std::ranges::none_of(out, [&](const RejectedSpeed& o) { return near(speed, o.spindle_speed_rad_per_s); });
    if (another && !near(speed, taken)) out.push_back(one);
  }
  return out;
}

/// What was looked at of a stretch: of a speed that was taken the others by time, else the nearest first.
std::vector<RejectedSpeed> rejections(const SpeedWay& way, const StretchCost& cost, const ProgramStretch& stretch,
                                      std::size_t k, const CandidateSpeeds& speeds, double taken, int most) {
  std::vector<RejectedSpeed> all;
  for (std::size_t j = 0; j < speeds.size(); ++j) {
    if (!way.row(k).exact[j] || !way.may_take(k, j)) continue;
    all.push_back(rejected(way.row(k).at[j], cost.bound(stretch, j), k, speeds[j].spindle_speed_rad_per_s));
  }
  if (taken > 0.0) {
    std::ranges::stable_sort(all, {}, &RejectedSpeed::cutting_time_s);
  } else {
    std::ranges::stable_sort(all, {}, [](const RejectedSpeed& r) { return shortfall(r.stopped_by); });
  }
  return distinct(all, taken, most);
}

/// The limit that most of a stretch's time is spent at, and the cut where it takes longest.
void explain(const std::vector<ProgramCut>& cuts, const ProgramStretch& stretch, const StretchAt& at,
             DecidedStretch& out) {
  std::vector<double> spent(std::size(program_limit_names), 0.0);
  const auto time_of = [&](std::size_t c) { return cuts[c].length_m / at.most[c - stretch.begin]; };
  const auto limit_of = [&](std::size_t c) { return at.most_by[c - stretch.begin].limit; };
  for (std::size_t c = stretch.begin; c < stretch.end; ++c) spent[static_cast<std::size_t>(limit_of(c))] += time_of(c);
  const auto limit = static_cast<ProgramLimit>(std::ranges::max_element(spent) - spent.begin());
  double longest = -1.0;
  for (std::size_t c = stretch.begin; c < stretch.end; ++c) {
    if (limit_of(c) != limit || time_of(c) <= longest) continue;
    longest = time_of(c);
    out.limited_by = at.most_by[c - stretch.begin];
    out.limiting_cut = c;
  }
}

void check_cuts(const std::vector<ProgramCut>& cuts, const std::vector<ProgramStretch>& stretches) {
  for (std::size_t c = 0; c < cuts.size(); ++c) {
    const std::string name = fmt::format("cuts[{}].", c + 1);
    require_positive((name + "length_m").c_str(), cuts[c].length_m, "m");
    require_positive((name + "feed_m_per_s").c_str(), cuts[c].feed_m_per_s, "m/s");
    require_positive((name + "tooth_feed_share").c_str(), cuts[c].tooth_feed_share, "");
    if (cuts[c].looks.empty()) throw InvalidInput(name + "looks", "must name a class of engagements");
  }
  std::size_t at = 0;
  for (const ProgramStretch& stretch : stretches) {
    if (stretch.begin != at || stretch.end <= stretch.begin) {
      throw InvalidInput("stretches", "must cover the cuts one after another");
    }
    require_positive("programmed_spindle_speed_rad_per_s", stretch.programmed_spindle_speed_rad_per_s, "rad/s");
    at = stretch.end;
  }
  if (at != cuts.size()) throw InvalidInput("stretches", "must cover the cuts one after another");
}

/// Feeds and γ of the stretches as they were found.
void put_together(const std::vector<ProgramCut>& cuts, const std::vector<ProgramStretch>& stretches,
                  const SpeedWay& way, const std::vector<std::size_t>& taken, const CandidateSpeeds& speeds,
                  const ProgramOptions& options, ProgramDecision& out) {
  std::vector<FeedBounds> bounds;
  for (std::size_t k = 0; k < stretches.size(); ++k) {
    const StretchAt& at = way.row(k).at[taken[k]];
    DecidedStretch stretch = {.spindle_speed_rad_per_s = speeds[taken[k]].spindle_speed_rad_per_s};
    explain(cuts, stretches[k], at, stretch);
    out.stretches.push_back(stretch);
    for (std::size_t c = stretches[k].begin; c < stretches[k].end; ++c) {
      const std::size_t i = c - stretches[k].begin;
      bounds.push_back({.length_m = cuts[c].length_m, .least_m_per_s = at.least[i], .most_m_per_s = at.most[i]});
      // Where its group has no time of its own for a step, γ runs evenly over it.
      const std::size_t group = at.group[i];
      const auto [first, last] = std::equal_range(at.group.begin(), at.group.end(), group);
      const auto begin = static_cast<double>(i - static_cast<std::size_t>(first - at.group.begin()));
      const auto count = static_cast<double>(last - first);
      const double from = options.gamma_rad[at.gamma[group]];
      const double to = options.gamma_rad[at.gamma[group + 1]];
      out.gamma_begin_rad.push_back(std::lerp(from, to, begin / count));
      out.gamma_end_rad.push_back(std::lerp(from, to, (begin + 1.0) / count));
    }
  }
  out.feed_m_per_s =
      options.free_feed ? even_feeds(bounds, options.feed_slack, options.feed_step_m_per_s) : std::vector<double>();
  if (!options.free_feed) {
    for (const ProgramCut& cut : cuts) out.feed_m_per_s.push_back(cut.feed_m_per_s);
  }
}

}  // namespace

std::string_view to_string(ProgramLimit limit) {
  return name_in(program_limit_names, limit);
}

void ProgramOptions::validate() const {
  if (teeth < 1) throw InvalidInput("teeth", teeth, "", "must be >= 1");
  if (free_speed) {
    require_positive("min_spindle_speed_rad_per_s", min_spindle_speed_rad_per_s, "rad/s");
    if (!(max_spindle_speed_rad_per_s >= min_spindle_speed_rad_per_s)) {
      throw InvalidInput("max_spindle_speed_rad_per_s", max_spindle_speed_rad_per_s, "rad/s",
                         "must not be below the lowest speed");
    }
  }
  if (!(speed_window >= 0.0 && speed_window < 0.5)) {
    throw InvalidInput("speed_window", speed_window, "", "must be in [0, 0.5)");
  }
  require_non_negative("ramp_rad_per_s2", ramp_rad_per_s2, "rad/s^2");
  require_non_negative("feed_slack", feed_slack, "");
  require_non_negative("speed_step_rad_per_s", speed_step_rad_per_s, "rad/s");
  require_non_negative("feed_step_m_per_s", feed_step_m_per_s, "m/s");
  require_positive("gamma_rate_rad_per_s", gamma_rate_rad_per_s, "rad/s");
  if (!std::ranges::is_sorted(gamma_rad, std::ranges::less_equal{}) && gamma_rad.size() > 1) {
    throw InvalidInput("gamma_rad", "must increase");
  }
  if (std::ranges::find(gamma_rad, 0.0) == gamma_rad.end()) throw InvalidInput("gamma_rad", "must hold 0");
  if (alternatives < 0) throw InvalidInput("alternatives", alternatives, "", "must be >= 0");
}

ProgramDecision decide_program(const std::vector<ProgramCut>& cuts, const std::vector<ProgramStretch>& stretches,
                               const ProgramModel& model, const ProgramOptions& options, Progress& progress) {
  options.validate();
  check_cuts(cuts, stretches);
  ProgramDecision out;
  if (cuts.empty()) {
    out.status = ProgramDecision::Status::found;
    return out;
  }
  std::vector<ProgramStretch> units = stretches;
  if (options.one_speed && options.free_speed) {
    units = {{.begin = 0,
              .end = cuts.size(),
              .programmed_spindle_speed_rad_per_s = stretches.front().programmed_spindle_speed_rad_per_s}};
  }
  CandidateSpeeds speeds(units, options);
  std::size_t classes = 0;
  for (const ProgramCut& cut : cuts) classes = std::max(classes, std::ranges::max(cut.looks) + 1);
  Looks looks(model, speeds, classes, options.gamma_rad.size(), progress);
  StretchCost cost(cuts, model, options, speeds, looks);
  SpeedWay way(units, options, speeds, cost, progress);
  const std::vector<std::size_t> taken = way.find();
  out.looks = looks.count();
  if (taken.empty()) {
    for (std::size_t k = 0; k < units.size() && out.rejected.empty(); ++k) {
      const bool none =
          std::ranges::none_of(way.row(k).at, [](const StretchAt& at) { return std::isfinite(at.time_s); });
      if (none) out.rejected = rejections(way, cost, units[k], k, speeds, 0.0, std::max(options.alternatives, 1));
    }
    return out;
  }
  out.status = ProgramDecision::Status::found;
  put_together(cuts, units, way, taken, speeds, options, out);
  for (std::size_t k = 0; k < units.size(); ++k) {
    DecidedStretch& stretch = out.stretches[k];
    for (std::size_t c = units[k].begin; c < units[k].end; ++c) {
      stretch.cutting_time_s += cuts[c].length_m / out.feed_m_per_s[c];
    }
    out.cutting_time_s += stretch.cutting_time_s;
    if (k > 0 && options.ramp_rad_per_s2 > 0.0) {
      out.ramp_time_s += std::abs(stretch.spindle_speed_rad_per_s - out.stretches[k - 1].spindle_speed_rad_per_s) /
                         options.ramp_rad_per_s2;
    }
    const std::vector<RejectedSpeed> more =
        rejections(way, cost, units[k], k, speeds, stretch.spindle_speed_rad_per_s, options.alternatives);
    out.rejected.insert(out.rejected.end(), more.begin(), more.end());
  }
  if (units.size() != stretches.size()) {
    const DecidedStretch whole = out.stretches.front();
    out.stretches.assign(stretches.size(), whole);
    for (std::size_t k = 0; k < stretches.size(); ++k) {
      out.stretches[k].cutting_time_s = 0.0;
      for (std::size_t c = stretches[k].begin; c < stretches[k].end; ++c) {
        out.stretches[k].cutting_time_s += cuts[c].length_m / out.feed_m_per_s[c];
      }
    }
  }
  return out;
}

}  // namespace robomill::decision
