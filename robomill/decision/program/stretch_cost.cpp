#include "robomill/decision/program/stretch_cost.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <set>

#include "robomill/decision/program/gamma_way.hpp"

namespace robomill::decision {
namespace {

constexpr double rounding = 1e-12;

/// A feed that is too high or too low for the other.
double apart(double least, double most) {
  return least > 0.0 ? 1.0 - most / least : 0.0;
}

/// @param feed_missed  share of a feed, which counts where the limit itself is kept
StretchTime stopped(const LimitUse& by, double feed_missed, std::size_t cut) {
  const double own = shortfall(by);
  return {.stopped_by = by, .missed = std::max(own > 0.0 ? own : feed_missed, rounding), .cut = cut};
}

/// What keeps a feed from being programmed.
std::optional<StretchTime> broken_by(double feed, const FeedRange& range, std::size_t cut) {
  if (feed > range.most_m_per_s * (1.0 + rounding)) {
    return stopped(range.most_by, apart(feed, range.most_m_per_s), cut);
  }
  if (feed < range.least_m_per_s * (1.0 - rounding)) {
    return stopped(range.least_by, apart(range.least_m_per_s, feed), cut);
  }
  return std::nullopt;
}

}  // namespace

StretchTime StretchCost::bound(const ProgramStretch& stretch, std::size_t candidate) const {
  return by_feeds(stretch, candidate).time;
}

StretchAt StretchCost::by_feeds(const ProgramStretch& stretch, std::size_t candidate) const {
  StretchAt out;
  bool holds = true;
  const double speed = speeds_[candidate].spindle_speed_rad_per_s;
  for (std::size_t c = stretch.begin; c < stretch.end; ++c) {
    FeedRange range = model_.feeds(c, speed);
    std::optional<StretchTime> broken;
    if (range.least_m_per_s > range.most_m_per_s * (1.0 + rounding)) {
      broken = stopped(range.contradiction(), apart(range.least_m_per_s, range.most_m_per_s), c);
    } else if (!options_.free_feed) {
      const double feed = cuts_[c].feed_m_per_s;
      broken = broken_by(feed, range, c);
      range.least_m_per_s = range.most_m_per_s = feed;
    }
    holds = holds && !broken;
    if (broken && broken->missed >= out.time.missed) out.time = *broken;
    out.least.push_back(std::min(range.least_m_per_s, range.most_m_per_s));  // apart by rounding at most, else stopped
    out.most.push_back(range.most_m_per_s);
    out.most_by.push_back(range.most_by);
  }
  if (holds) sum_up(stretch, out);
  return out;
}

StretchAt StretchCost::exact(const ProgramStretch& stretch, std::size_t candidate) {
  StretchAt out = by_feeds(stretch, candidate);
  if (!std::isfinite(out.time.time_s)) return out;
  if (options_.gamma_rad.size() > 1) {
    along_gamma(stretch, candidate, out);
  } else {
    at_programmed_gamma(stretch, candidate, out);
  }
  if (std::isfinite(out.time.time_s)) sum_up(stretch, out);
  return out;
}

double StretchCost::feed_of_a_tooth(std::size_t cut, std::size_t candidate) const {
  const double teeth_per_s = speeds_[candidate].spindle_speed_rad_per_s * options_.teeth / (2.0 * std::numbers::pi);
  return teeth_per_s / cuts_[cut].tooth_feed_share;
}

StretchCost::Feeds StretchCost::narrowed(const Feeds& feeds, std::size_t cut, const CutLook& look,
                                         std::size_t candidate) const {
  Feeds out = feeds;
  const double per_tooth = feed_of_a_tooth(cut, candidate);
  const double most = look.most_feed_per_tooth_m * per_tooth;
  if (most < out.most_m_per_s) {
    out.most_m_per_s = most;
    out.by = out.empty() ? look.at(out.least_m_per_s / per_tooth) : look.by;
  }
  const double least = look.least_feed_per_tooth_m * per_tooth;
  if (least > out.least_m_per_s) {
    out.least_m_per_s = least;
    if (!feeds.empty() && out.empty() && most >= feeds.least_m_per_s) out.by = look.least_by;
  }
  return out;
}

void StretchCost::limit_feed(const ProgramStretch& stretch, std::size_t cut, const CutLook& look, std::size_t candidate,
                             StretchAt& out) const {
  const std::size_t i = cut - stretch.begin;
  const double most = out.most[i];
  const Feeds feeds = narrowed({.least_m_per_s = out.least[i], .most_m_per_s = out.most[i], .by = out.most_by[i]}, cut,
                               look, candidate);
  out.least[i] = feeds.least_m_per_s;
  out.most[i] = feeds.most_m_per_s;
  if (feeds.most_m_per_s < most) out.most_by[i] = look.by;
  if (feeds.empty()) out.time = stopped(feeds.by, apart(feeds.least_m_per_s, feeds.most_m_per_s), cut);
}

void StretchCost::at_programmed_gamma(const ProgramStretch& stretch, std::size_t candidate, StretchAt& out) {
  std::vector<LookAt> at;
  std::set<LookAt> there;
  for (std::size_t c = stretch.begin; c < stretch.end; ++c) {
    for (const std::size_t look : cuts_[c].looks) {
      if (there.insert({.look_class = look}).second) at.push_back({.look_class = look});
    }
  }
  const std::optional<LookAt> failed = looks_.ask_until_failure(at, candidate);
  for (std::size_t c = stretch.begin; c < stretch.end; ++c) {
    for (const std::size_t look_class : cuts_[c].looks) {
      if (failed && look_class != failed->look_class) continue;
      const CutLook look = *looks_.known({.look_class = look_class}, candidate);
      if (failed) {
        out.time = stopped(look.by, 0.0, c);
        return;
      }
      limit_feed(stretch, c, look, candidate, out);
      if (!std::isfinite(out.time.time_s)) return;
    }
  }
  out.gamma = {0, 0};
  out.group.assign(stretch.end - stretch.begin, 0);
}

void StretchCost::along_gamma(const ProgramStretch& stretch, std::size_t candidate, StretchAt& out) {
  std::vector<double> times;
  times.reserve(stretch.end - stretch.begin);
  for (std::size_t c = stretch.begin; c < stretch.end; ++c) {
    times.push_back(cuts_[c].time_s(out.most[c - stretch.begin]));
  }
  GammaWay way(times, options_);
  const auto time_at = [&](std::size_t i, std::size_t gamma) {
    const std::size_t c = stretch.begin + i;
    Feeds feeds = {.least_m_per_s = out.least[i], .most_m_per_s = out.most[i]};
    for (const std::size_t look_class : cuts_[c].looks) {
      const std::optional<CutLook> look = looks_.known({.look_class = look_class, .gamma = gamma}, candidate);
      if (!look) continue;
      feeds = narrowed(feeds, c, *look, candidate);
      if (!look->holds || feeds.empty()) return no_time;
    }
    return std::max(times[i], cuts_[c].time_s(feeds.most_m_per_s));
  };
  while (way.solve(time_at)) {
    std::vector<LookAt> unseen;
    std::set<LookAt> there;
    for (const GammaWay::Place& place : way.places()) {
      for (const std::size_t look_class : cuts_[stretch.begin + place.cut].looks) {
        const LookAt at = {.look_class = look_class, .gamma = place.gamma};
        if (there.insert(at).second && !looks_.known(at, candidate)) unseen.push_back(at);
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
  stop_along_gamma(stretch, candidate, out);
}

StretchTime StretchCost::at_gamma(std::size_t cut, std::size_t gamma, const Feeds& feeds, std::size_t candidate) const {
  StretchTime out;
  for (const std::size_t look_class : cuts_[cut].looks) {
    const std::optional<CutLook> look = looks_.known({.look_class = look_class, .gamma = gamma}, candidate);
    if (!look) continue;
    const Feeds here = look->holds ? narrowed(feeds, cut, *look, candidate) : Feeds{.by = look->by};
    if (look->holds && !here.empty()) continue;
    const StretchTime by = stopped(here.by, look->holds ? apart(here.least_m_per_s, here.most_m_per_s) : 0.0, cut);
    if (by.missed > out.missed) out = by;
  }
  return out;
}

void StretchCost::stop_along_gamma(const ProgramStretch& stretch, std::size_t candidate, StretchAt& out) const {
  const auto missed_less = [](const StretchTime& a, const StretchTime& b) { return a.missed < b.missed; };
  const std::size_t gammas = options_.gamma_rad.size();
  StretchTime no_gamma;                       // the cut that no γ suits: at the γ that comes nearest
  std::vector<StretchTime> farthest(gammas);  // of each γ the cut that it suits least
  for (std::size_t c = stretch.begin; c < stretch.end; ++c) {
    std::vector<StretchTime> at;
    at.reserve(gammas);
    for (std::size_t g = 0; g < gammas; ++g) {
      const std::size_t i = c - stretch.begin;
      at.push_back(at_gamma(c, g, {.least_m_per_s = out.least[i], .most_m_per_s = out.most[i], .by = out.most_by[i]},
                            candidate));
      farthest[g] = std::max(farthest[g], at.back(), missed_less);
    }
    no_gamma = std::max(no_gamma, *std::ranges::min_element(at, missed_less), missed_less);
  }
  // Where some γ suits every cut, but γ cannot step from each to the next: the γ that comes nearest to suiting all.
  out.time = no_gamma.missed > 0.0 ? no_gamma : *std::ranges::min_element(farthest, missed_less);
}

void StretchCost::sum_up(const ProgramStretch& stretch, StretchAt& out) const {
  out.time.time_s = out.time.feed_time_s = 0.0;
  for (std::size_t c = stretch.begin; c < stretch.end; ++c) {
    const double feed = out.most[c - stretch.begin];
    out.time.time_s += cuts_[c].time_s(feed);
    out.time.feed_time_s += cuts_[c].length_m / feed;
  }
}

}  // namespace robomill::decision
