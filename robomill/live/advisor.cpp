#include "robomill/live/advisor.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <vector>

#include "robomill/base/parallel.hpp"
#include "robomill/base/units.hpp"
#include "robomill/decision/finish.hpp"
#include "robomill/stability/peak_classification.hpp"

namespace robomill::live {

using monitor::NoSpeed;

namespace {

/// Of the speed: how near a limit of the chart must be to be that of the cut.
constexpr double chart_reach = 0.05;
/// Of the speed: a suggestion as near as that is the speed at which it chatters.
constexpr double same_as_present = 0.01;

/// Of each limit: whether the cut just above it is unstable without the wave of the tooth before.
std::vector<bool> coupling_above(const stability::LobesProblem& problem, const stability::LobesResult& lobes,
                                 Progress& progress) {
  constexpr double above = 1.05;
  std::vector<char> found(lobes.limit.size(), 0);
  parallel_for(found.size(), 1, [&](std::size_t begin, std::size_t end) {
    progress.check();
    for (std::size_t i = begin; i < end; ++i) {
      const stability::Limit& limit = lobes.limit[i];
      if (limit.status != stability::Limit::Status::found || !(limit.axial_depth_m > 0.0)) continue;
      const stability::ChatterMechanism mechanism = stability::chatter_mechanism(
          problem,
          {.spindle_speed_rad_per_s = limit.spindle_speed_rad_per_s, .axial_depth_m = above * limit.axial_depth_m});
      found[i] = mechanism.kind == stability::ChatterMechanism::Kind::mode_coupling ? 1 : 0;
    }
  });
  return {found.begin(), found.end()};
}

/// Of each limit: how deep forced vibration lets the cut go. Empty where the cut has no feed.
std::vector<double> vibration_of(const stability::LobesProblem& problem, const stability::LobesResult& lobes,
                                 Progress& progress) {
  if (!(problem.milling.feed_per_tooth_m > 0.0) || lobes.axial_depth_m.size() == 0) return {};
  std::vector<double> speeds;
  speeds.reserve(lobes.limit.size());
  for (const stability::Limit& limit : lobes.limit) speeds.push_back(limit.spindle_speed_rad_per_s);
  return decision::vibration_depths(problem, speeds, lobes.axial_depth_m.maxCoeff(), progress);
}

}  // namespace

void AdviceBasis::take_cut(const stability::LobesProblem& problem, const stability::LobesOptions& options,
                           Progress& progress) {
  if (!problem.dynamics.modes.empty()) modes = problem.dynamics;
  workpiece = problem.workpiece_dynamics;
  lobes = stability::compute_lobes(problem, options, progress);
  vibration_depth_m = vibration_of(problem, *lobes, progress);
  if (modes) mode_coupling = coupling_above(problem, *lobes, progress);
}

NoSpeed Advisor::no_speed(const monitor::Advice& advice, double spindle_speed_rad_per_s) const {
  if (advice.line_hz.size() > 1) return NoSpeed::ambiguous_alias;
  const double lowest_tooth_passing_hz = basis_.teeth * basis_.lowest_rad_per_s / units::revolution;
  if (advice.lowest_hz < std::max(basis_.arm_below_hz, lowest_tooth_passing_hz)) {
    return advice.frequency_hz > 0.0 ? NoSpeed::arm : NoSpeed::unclear;
  }
  if (!basis_.lobes || basis_.mode_coupling.size() != basis_.lobes->limit.size()) return NoSpeed::none;
  const std::vector<stability::Limit>& limits = basis_.lobes->limit;
  const auto away = [&](const stability::Limit& limit) {
    return std::abs(limit.spindle_speed_rad_per_s - spindle_speed_rad_per_s);
  };
  const auto nearest = std::ranges::min_element(limits, {}, away);
  // What the chart says beyond its ends is nothing.
  if (nearest == limits.end() || away(*nearest) > chart_reach * spindle_speed_rad_per_s) return NoSpeed::none;
  const auto index = static_cast<std::size_t>(std::distance(limits.begin(), nearest));
  return basis_.mode_coupling[index] ? NoSpeed::mode_coupling : NoSpeed::none;
}

void Advisor::advise(monitor::MonitorEvent& event) const {
  const monitor::Decision& d = event.decision;
  const double speed_rad_per_s =
      d.spindle_speed_rad_per_s > 0.0 ? d.spindle_speed_rad_per_s : basis_.spindle_speed_rad_per_s;
  if (!(d.chatter_frequency_hz > 0.0) || basis_.teeth < 1 || !(speed_rad_per_s > 0.0)) return;
  monitor::AdviceOptions options;
  options.lowest_rad_per_s = basis_.lowest_rad_per_s;
  if (basis_.highest_rad_per_s > 0.0) options.highest_rad_per_s = basis_.highest_rad_per_s;
  options.speed_window = basis_.speed_window;
  options.depth_margin = basis_.depth_margin;
  options.vibration_depth_m = basis_.vibration_depth_m;
  options.unfiltered_sample_rate_hz = basis_.unfiltered_sample_rate_hz;
  const monitor::Advice advice = monitor::advise(d.chatter_frequency_hz, d.chatter_frequency_std_hz, speed_rad_per_s,
                                                 basis_.teeth, basis_.modes ? &*basis_.modes : nullptr,
                                                 basis_.lobes ? &*basis_.lobes : nullptr, options, basis_.workpiece);
  event.mode = advice.mode;
  if (advice.line_hz != std::vector{d.chatter_frequency_hz}) event.line_hz = advice.line_hz;
  event.no_speed = no_speed(advice, speed_rad_per_s);
  if (event.no_speed != NoSpeed::none) return;
  for (const monitor::StableSpeed& stable : advice.speeds) {
    const double away_rad_per_s = std::abs(stable.spindle_speed_rad_per_s - speed_rad_per_s);
    if (away_rad_per_s < same_as_present * speed_rad_per_s) continue;
    event.stable_speeds_rad_per_s.push_back(stable.spindle_speed_rad_per_s);
  }
  if (advice.best) {
    event.suggested_spindle_speed_rad_per_s = advice.best->spindle_speed_rad_per_s;
    event.suggested_axial_depth_m = advice.best->axial_depth_m;
    event.depth_limited_by =
        advice.best_vibrates ? monitor::DepthLimitedBy::forced_vibration : monitor::DepthLimitedBy::stability;
  } else if (!event.stable_speeds_rad_per_s.empty()) {
    event.suggested_spindle_speed_rad_per_s = event.stable_speeds_rad_per_s.front();
  } else if (advice.vibrating_speeds > 0) {
    event.no_speed = NoSpeed::forced_vibration;
  }
}

}  // namespace robomill::live
