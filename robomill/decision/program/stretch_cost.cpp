#include "robomill/decision/program/stretch_cost.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "robomill/decision/program/gamma_way.hpp"

namespace robomill::decision {
namespace {

constexpr double rounding = 1e-12;

void stop(StretchAt& out, const LimitUse& by, std::size_t cut) {
  out.time_s = no_time;
  out.stopped_by = by;
  out.cut = cut;
}

/// Whether the feed as programmed keeps its limits; where not, which it breaks.
std::optional<LimitUse> broken_by(double feed, double least, double most, const LimitUse& least_by,
                                  const LimitUse& most_by) {
  if (feed > most * (1.0 + rounding)) return most_by;
  if (feed < least * (1.0 - rounding)) return least_by;
  return std::nullopt;
}

}  // namespace

StretchAt StretchCost::bound(const ProgramStretch& stretch, std::size_t candidate) const {
  StretchAt out;
  out.time_s = 0.0;
  const double speed = speeds_[candidate].spindle_speed_rad_per_s;
  double worst = -no_time;
  for (std::size_t c = stretch.begin; c < stretch.end; ++c) {
    FeedRange range = model_.feeds(c, speed);
    std::optional<LimitUse> broken;
    if (range.least_m_per_s > range.most_m_per_s * (1.0 + rounding)) {
      broken = range.most_by;
    } else if (!options_.free_feed) {
      const double feed = cuts_[c].feed_m_per_s;
      broken = broken_by(feed, range.least_m_per_s, range.most_m_per_s, range.least_by, range.most_by);
      range.least_m_per_s = range.most_m_per_s = feed;
    }
    if (broken && shortfall(*broken) >= worst) {
      worst = shortfall(*broken);
      stop(out, *broken, c);
    }
    out.least.push_back(range.least_m_per_s);
    out.most.push_back(range.most_m_per_s);
    out.most_by.push_back(range.most_by);
    out.time_s += cuts_[c].length_m / range.most_m_per_s;
  }
  return out;
}

StretchAt StretchCost::exact(const ProgramStretch& stretch, std::size_t candidate) {
  StretchAt out = bound(stretch, candidate);
  if (!std::isfinite(out.time_s)) return out;
  if (options_.gamma_rad.size() > 1) {
    along_gamma(stretch, candidate, out);
  } else {
    at_programmed_gamma(stretch, candidate, out);
  }
  if (std::isfinite(out.time_s)) sum_up(stretch, out);
  return out;
}

double StretchCost::most_feed(std::size_t cut, const CutLook& look, std::size_t candidate) const {
  const double teeth_per_s = speeds_[candidate].spindle_speed_rad_per_s * options_.teeth / (2.0 * std::numbers::pi);
  return look.most_feed_per_tooth_m * teeth_per_s / cuts_[cut].tooth_feed_share;
}

void StretchCost::limit_feed(const ProgramStretch& stretch, std::size_t cut, const CutLook& look, std::size_t candidate,
                             StretchAt& out) const {
  const std::size_t i = cut - stretch.begin;
  const double most = most_feed(cut, look, candidate);
  if (most >= out.most[i]) return;
  out.most[i] = most;
  out.most_by[i] = look.by;
  if (most < out.least[i]) stop(out, look.by, cut);
}

void StretchCost::at_programmed_gamma(const ProgramStretch& stretch, std::size_t candidate, StretchAt& out) {
  std::vector<LookAt> at;
  for (std::size_t c = stretch.begin; c < stretch.end; ++c) {
    for (const std::size_t look : cuts_[c].looks) {
      if (std::ranges::find(at, LookAt{.look_class = look}) == at.end()) at.push_back({.look_class = look});
    }
  }
  const std::optional<LookAt> failed = looks_.ask_until_failure(at, candidate);
  for (std::size_t c = stretch.begin; c < stretch.end; ++c) {
    for (const std::size_t look_class : cuts_[c].looks) {
      if (failed && look_class != failed->look_class) continue;
      const CutLook look = *looks_.known({.look_class = look_class}, candidate);
      if (failed) return stop(out, look.by, c);
      limit_feed(stretch, c, look, candidate, out);
      if (!std::isfinite(out.time_s)) return;
    }
  }
  out.gamma = {0, 0};
  out.group.assign(stretch.end - stretch.begin, 0);
}

void StretchCost::along_gamma(const ProgramStretch& stretch, std::size_t candidate, StretchAt& out) {
  std::vector<double> times;
  for (std::size_t c = stretch.begin; c < stretch.end; ++c) {
    times.push_back(cuts_[c].length_m / out.most[c - stretch.begin]);
  }
  GammaWay way(times, options_);
  const auto time_at = [&](std::size_t i, std::size_t gamma) {
    const std::size_t c = stretch.begin + i;
    double time = times[i];
    for (const std::size_t look_class : cuts_[c].looks) {
      const std::optional<CutLook> look = looks_.known({.look_class = look_class, .gamma = gamma}, candidate);
      if (!look) continue;
      const double feed = std::min(out.most[i], most_feed(c, *look, candidate));
      if (!look->holds || feed < out.least[i]) return no_time;
      time = std::max(time, cuts_[c].length_m / feed);
    }
    return time;
  };
  while (way.solve(time_at)) {
    std::vector<LookAt> unseen;
    for (const GammaWay::Place& place : way.places()) {
      for (const std::size_t look_class : cuts_[stretch.begin + place.cut].looks) {
        const LookAt at = {.look_class = look_class, .gamma = place.gamma};
        if (looks_.known(at, candidate) || std::ranges::find(unseen, at) != unseen.end()) continue;
        unseen.push_back(at);
      }
    }
    if (unseen.empty()) {
      out.gamma = way.gamma();
      out.group = way.groups();
      for (const GammaWay::Place& place : way.places()) {
        for (const std::size_t look_class : cuts_[stretch.begin + place.cut].looks) {
          const CutLook look = *looks_.known({.look_class = look_class, .gamma = place.gamma}, candidate);
          limit_feed(stretch, stretch.begin + place.cut, look, candidate, out);
        }
      }
      return;
    }
    looks_.ask(unseen, candidate);
  }
  // The cut that no γ suits: of each cut the γ that comes nearest, of those the farthest.
  double worst = -no_time;
  for (std::size_t c = stretch.begin; c < stretch.end; ++c) {
    double least = no_time;
    LimitUse by;
    for (std::size_t gamma = 0; gamma < options_.gamma_rad.size(); ++gamma) {
      for (const std::size_t look_class : cuts_[c].looks) {
        const std::optional<CutLook> look = looks_.known({.look_class = look_class, .gamma = gamma}, candidate);
        const double short_by = look ? (look->holds ? 0.0 : shortfall(look->by)) : no_time;
        if (look && short_by < least) {
          least = short_by;
          by = look->by;
        }
      }
    }
    if (std::isfinite(least) && least > worst) {
      worst = least;
      stop(out, by, c);
    }
  }
  out.time_s = no_time;
}

void StretchCost::sum_up(const ProgramStretch& stretch, StretchAt& out) const {
  out.time_s = 0.0;
  for (std::size_t c = stretch.begin; c < stretch.end; ++c) {
    out.time_s += cuts_[c].length_m / out.most[c - stretch.begin];
  }
}

}  // namespace robomill::decision
