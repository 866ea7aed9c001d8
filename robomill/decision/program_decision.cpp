#include "robomill/decision/program_decision.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "robomill/base/error.hpp"
#include "robomill/cutting/cut_limits.hpp"
#include "robomill/decision/program/candidates.hpp"
#include "robomill/decision/program/even_feeds.hpp"
#include "robomill/decision/program/looks.hpp"
#include "robomill/decision/program/speed_way.hpp"
#include "robomill/decision/program/stretch_cost.hpp"
#include "robomill/decision/program/stretch_row.hpp"

namespace robomill::decision {
namespace {

/// Rejected speeds that are reported stand this share apart.
constexpr double distinct_speed = 0.03;

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

/// Stretches that have their speed in common: [begin, end).
struct OneSpeed {
  std::size_t begin = 0, end = 0;
};

std::vector<OneSpeed> speeds_in_common(std::size_t stretches, const ProgramOptions& options) {
  if (options.one_speed && options.free_speed) return {{.begin = 0, .end = stretches}};
  std::vector<OneSpeed> out;
  out.reserve(stretches);
  for (std::size_t k = 0; k < stretches; ++k) out.push_back({.begin = k, .end = k + 1});
  return out;
}

/// A speed that was not taken, with the share by which it misses what stops it.
struct Missed {
  RejectedSpeed speed = {};
  double time_s = 0.0;  ///< of its cuts, ProgramCut::time_s
  double share = 0.0;
};

/// Stopped: by the stretch that misses most; none where it has not been looked at.
std::optional<Missed> missed_at(const SpeedWay& way, OneSpeed stretches, std::size_t candidate) {
  Missed out = {.speed = {.stretch = stretches.begin}};
  bool looked = true;
  for (std::size_t k = stretches.begin; k < stretches.end; ++k) {
    const std::optional<StretchTime> seen = way.row(k).seen(candidate);
    looked = looked && seen;
    const bool holds = seen && std::isfinite(seen->time_s);
    const StretchTime time = holds ? *seen : way.row(k).bound(candidate);
    out.time_s += time.time_s;
    out.speed.cutting_time_s += time.feed_time_s;
    if (!seen || holds || seen->missed <= out.share) continue;
    out.share = seen->missed;
    out.speed.stretch = k;
    out.speed.stopped_by = seen->stopped_by;
    out.speed.cut = seen->cut;
  }
  if (!looked && out.share == 0.0) return std::nullopt;
  return out;
}

/// What was looked at: of a speed that was taken the others by time, else the nearest first.
std::vector<RejectedSpeed> rejections(const SpeedWay& way, OneSpeed stretches, const CandidateSpeeds& speeds,
                                      double taken, int most) {
  std::vector<Missed> all;
  for (std::size_t j = 0; j < speeds.size(); ++j) {
    std::optional<Missed> one = missed_at(way, stretches, j);
    if (!one) continue;
    one->speed.spindle_speed_rad_per_s = speeds[j].spindle_speed_rad_per_s;
    all.push_back(*one);
  }
  std::ranges::stable_sort(all, {}, [&](const Missed& one) { return taken > 0.0 ? one.time_s : one.share; });
  std::vector<RejectedSpeed> out;
  out.reserve(all.size());
  for (const Missed& one : all) out.push_back(one.speed);
  return distinct(out, taken, most);
}

/// Whether no speed suits all of them.
bool has_no_speed(const SpeedWay& way, OneSpeed stretches, std::size_t speeds) {
  for (std::size_t j = 0; j < speeds; ++j) {
    bool all = true;
    for (std::size_t k = stretches.begin; k < stretches.end; ++k) all = all && std::isfinite(way.row(k).time_s(j));
    if (all) return false;
  }
  return true;
}

/// The limit that most of a stretch's time is spent at, and the cut where it takes longest.
void explain(const std::vector<ProgramCut>& cuts, const ProgramStretch& stretch, const StretchAt& at,
             DecidedStretch& out) {
  std::vector<double> spent(std::size(program_limit_names), 0.0);
  const auto time_of = [&](std::size_t c) { return cuts[c].time_s(at.most[c - stretch.begin]); };
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

/// Own cuts one after another, behind them those of other ways.
void check_stretches(std::size_t cuts, const std::vector<ProgramStretch>& stretches) {
  std::size_t own = 0;
  for (const ProgramStretch& stretch : stretches) {
    if (stretch.begin != own || stretch.end <= stretch.begin || stretch.end > cuts) {
      throw InvalidInput("stretches", "must cover the cuts one after another");
    }
    require_positive("programmed_spindle_speed_rad_per_s", stretch.programmed_spindle_speed_rad_per_s, "rad/s");
    own = stretch.end;
  }
  std::vector<bool> in_use(cuts, false);
  bool any = false;
  for (std::size_t k = 0; k < stretches.size(); ++k) {
    const std::size_t count = stretches[k].end - stretches[k].begin;
    const std::string name = fmt::format("stretches[{}].others", k + 1);
    for (const std::size_t first : stretches[k].others) {
      if (first < own) throw InvalidInput(name, "must stand behind the cuts of the stretches themselves");
      if (first > cuts - count) throw InvalidInput(name, "must have as many cuts as the stretch");
      for (std::size_t c = first; c < first + count; ++c) {
        if (in_use[c]) throw InvalidInput(name, "must have cuts of its own");
        in_use[c] = true;
      }
      any = true;
    }
  }
  if (!any && own != cuts) throw InvalidInput("stretches", "must cover the cuts one after another");
}

void check_cuts(const std::vector<ProgramCut>& cuts, const std::vector<ProgramStretch>& stretches) {
  for (std::size_t c = 0; c < cuts.size(); ++c) {
    const std::string name = fmt::format("cuts[{}].", c + 1);
    require_positive((name + "length_m").c_str(), cuts[c].length_m, "m");
    require_positive((name + "feed_m_per_s").c_str(), cuts[c].feed_m_per_s, "m/s");
    require_positive((name + "tooth_feed_share").c_str(), cuts[c].tooth_feed_share, "");
    require_non_negative((name + "lost_s").c_str(), cuts[c].lost_s, "s");
    if (!(cuts[c].feed_part >= 0.0 && cuts[c].feed_part <= 1.0)) {
      throw InvalidInput(name + "feed_part", cuts[c].feed_part, "", "must be in [0, 1]");
    }
    if (cuts[c].looks.empty()) throw InvalidInput(name + "looks", "must name a class of engagements");
  }
  check_stretches(cuts.size(), stretches);
}

/// A stretch as it was taken.
struct Taken {
  ProgramStretch made = {};
  const StretchAt* at = nullptr;
};

/// Feeds of what was taken.
void put_feeds(const std::vector<ProgramCut>& cuts, const std::vector<Taken>& taken, const ProgramOptions& options,
               ProgramDecision& out) {
  std::vector<FeedBounds> bounds;
  std::vector<std::size_t> of;
  for (const Taken& stretch : taken) {
    for (std::size_t c = stretch.made.begin; c < stretch.made.end; ++c) {
      const std::size_t i = c - stretch.made.begin;
      bounds.push_back(
          {.length_m = cuts[c].length_m, .least_m_per_s = stretch.at->least[i], .most_m_per_s = stretch.at->most[i]});
      of.push_back(c);
    }
  }
  const std::vector<double> feeds =
      options.free_feed ? even_feeds(bounds, options.feed_slack, options.feed_step_m_per_s) : std::vector<double>();
  out.feed_m_per_s.assign(cuts.size(), 0.0);
  for (std::size_t i = 0; i < of.size(); ++i) {
    out.feed_m_per_s[of[i]] = options.free_feed ? feeds[i] : cuts[of[i]].feed_m_per_s;
  }
}

/// γ runs evenly over the time of a group: each of its cuts has the share of its own time.
void put_gamma(const std::vector<ProgramCut>& cuts, const Taken& stretch, const ProgramOptions& options,
               ProgramDecision& out) {
  const std::vector<std::size_t>& group = stretch.at->group;
  const auto time_of = [&](std::size_t i) {
    const std::size_t c = stretch.made.begin + i;
    return cuts[c].time_s(out.feed_m_per_s[c]);
  };
  for (std::size_t first = 0; first < group.size();) {
    std::size_t last = first;
    double whole_s = 0.0;
    for (; last < group.size() && group[last] == group[first]; ++last) whole_s += time_of(last);
    const double from = options.gamma_rad[stretch.at->gamma[group[first]]];
    const double to = options.gamma_rad[stretch.at->gamma[group[first] + 1]];
    double run_s = 0.0;
    for (std::size_t i = first; i < last; ++i) {
      out.gamma_begin_rad[stretch.made.begin + i] = std::lerp(from, to, run_s / whole_s);
      run_s += time_of(i);
      out.gamma_end_rad[stretch.made.begin + i] = std::lerp(from, to, run_s / whole_s);
    }
    first = last;
  }
}

/// Ways, feeds and γ of the stretches as they were found.
void put_together(const std::vector<ProgramCut>& cuts, const SpeedWay& way, const std::vector<std::size_t>& found,
                  const CandidateSpeeds& speeds, const ProgramOptions& options, ProgramDecision& out) {
  std::vector<Taken> taken;
  taken.reserve(found.size());
  for (std::size_t k = 0; k < found.size(); ++k) {
    const StretchRow& row = way.row(k);
    taken.push_back({.made = row.made(row.best_way(found[k])), .at = &row.best(found[k])});
    DecidedStretch stretch = {.spindle_speed_rad_per_s = speeds[found[k]].spindle_speed_rad_per_s,
                              .way = row.best_way(found[k])};
    explain(cuts, taken.back().made, *taken.back().at, stretch);
    out.stretches.push_back(stretch);
  }
  put_feeds(cuts, taken, options, out);
  out.gamma_begin_rad.assign(cuts.size(), 0.0);
  out.gamma_end_rad.assign(cuts.size(), 0.0);
  for (std::size_t k = 0; k < found.size(); ++k) {
    put_gamma(cuts, taken[k], options, out);
    DecidedStretch& stretch = out.stretches[k];
    for (std::size_t c = taken[k].made.begin; c < taken[k].made.end; ++c) {
      stretch.cutting_time_s += cuts[c].time_s(out.feed_m_per_s[c]);
    }
    out.cutting_time_s += stretch.cutting_time_s;
    if (k > 0 && options.ramp_rad_per_s2 > 0.0) {
      out.ramp_time_s += std::abs(stretch.spindle_speed_rad_per_s - out.stretches[k - 1].spindle_speed_rad_per_s) /
                         options.ramp_rad_per_s2;
    }
  }
}

}  // namespace

LimitUse FeedRange::contradiction() const {
  LimitUse out = most_by;
  // These rise as the feed does.
  const bool as_feed = out.limit == ProgramLimit::greatest_chip || out.limit == ProgramLimit::tip_speed ||
                       out.limit == ProgramLimit::joint_speed;
  if (as_feed && most_m_per_s > 0.0) out.value = out.allowed * least_m_per_s / most_m_per_s;
  return out;
}

LimitUse CutLook::at(double feed_per_tooth_m) const {
  LimitUse out = by;
  out.value += by_rise_per_m * (feed_per_tooth_m - by_feed_per_tooth_m);
  return out;
}

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
  cutting::require_speed_window(speed_window);
  require_non_negative("ramp_rad_per_s2", ramp_rad_per_s2, "rad/s^2");
  require_non_negative("feed_slack", feed_slack, "");
  require_non_negative("speed_step_rad_per_s", speed_step_rad_per_s, "rad/s");
  require_non_negative("feed_step_m_per_s", feed_step_m_per_s, "m/s");
  require_non_negative("other_gain", other_gain, "");
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
  CandidateSpeeds speeds(stretches, options);
  std::size_t classes = 0;
  for (const ProgramCut& cut : cuts) classes = std::max(classes, std::ranges::max(cut.looks) + 1);
  Looks looks(model, speeds, classes, options.gamma_rad.size(), progress);
  StretchCost cost(cuts, model, options, speeds, looks);
  SpeedWay way(stretches, options, speeds, cost, progress);
  const std::vector<std::size_t> found = way.find();
  out.looks = looks.count();
  if (!found.empty()) {
    out.status = ProgramDecision::Status::found;
    put_together(cuts, way, found, speeds, options, out);
  }
  for (const OneSpeed& one : speeds_in_common(stretches.size(), options)) {
    if (found.empty() && !has_no_speed(way, one, speeds.size())) continue;
    const double taken = found.empty() ? 0.0 : out.stretches[one.begin].spindle_speed_rad_per_s;
    const int most = found.empty() ? std::max(options.alternatives, 1) : options.alternatives;
    const std::vector<RejectedSpeed> more = rejections(way, one, speeds, taken, most);
    out.rejected.insert(out.rejected.end(), more.begin(), more.end());
    if (found.empty()) break;
  }
  return out;
}

}  // namespace robomill::decision
