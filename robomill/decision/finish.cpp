#include "robomill/decision/finish.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>

#include "robomill/base/error.hpp"
#include "robomill/base/parallel.hpp"
#include "robomill/stability/surface_error.hpp"

namespace robomill::decision {
namespace {

/// Which limit a cut breaks; none where it keeps both.
std::optional<LimitedBy> broken(const stability::SurfacePoint& surface, const FinishLimits& limits) {
  if (!surface.stable) return LimitedBy::chatter;
  const bool rough =
      limits.max_surface_error_m > 0.0 && !(std::abs(surface.surface_location_error_m) <= limits.max_surface_error_m);
  if (rough) return LimitedBy::surface_error;
  if (limits.max_deflection_m > 0.0 && !(surface.peak_deflection_m <= limits.max_deflection_m)) {
    return LimitedBy::deflection;
  }
  return std::nullopt;
}

/// @param look  what a depth breaks, if anything
template <class Look>
FinishDepth deepest_kept(double deepest_m, const Look& look) {
  constexpr int looks = 6;
  constexpr int halvings = 12;
  constexpr double tolerance = 0.02;
  if (!(deepest_m > 0.0)) return {};
  double kept_m = 0.0;
  for (int i = 1; i <= looks; ++i) {
    double broken_m = deepest_m * i / looks;
    std::optional<LimitedBy> reason = look(broken_m);
    if (!reason) {
      kept_m = broken_m;
      continue;
    }
    for (int k = 0; k < halvings && broken_m - kept_m > tolerance * broken_m; ++k) {
      const double middle_m = 0.5 * (kept_m + broken_m);
      if (const std::optional<LimitedBy> here = look(middle_m)) {
        broken_m = middle_m;
        reason = here;
      } else {
        kept_m = middle_m;
      }
    }
    return {.axial_depth_m = kept_m, .reason = *reason};
  }
  return {};
}

}  // namespace

void FinishLimits::validate() const {
  require_non_negative("max_surface_error_m", max_surface_error_m, "m");
  require_non_negative("max_deflection_m", max_deflection_m, "m");
}

void require_finishable(const stability::LobesProblem& problem, const FinishLimits& limits) {
  problem.require_plane("a recommendation");
  limits.validate();
  if (!limits.any()) return;
  if (problem.has_measured()) {
    throw InvalidInput("finishing", "needs modes of tool and workpiece",
                       "The surface that measured FRFs leave cannot be computed: run robomill modes on them");
  }
  const cutting::Immersion& immersion = problem.milling.immersion;
  const bool wall = immersion.entry_rad <= 1e-9 || immersion.exit_rad >= std::numbers::pi - 1e-9;
  if (limits.max_surface_error_m > 0.0 && !wall) {
    throw InvalidInput("max_surface_error_m", limits.max_surface_error_m, "m", "goes with a cut that finishes a wall",
                       "These teeth enter after 0 and leave before 180 degrees");
  }
}

FinishDepth finish_depth(const stability::LobesProblem& problem, double spindle_speed_rad_per_s, double deepest_m,
                         const FinishLimits& limits) {
  if (!limits.any()) return {};
  return deepest_kept(deepest_m, [&](double depth_m) {
    return broken(stability::surface_point(problem, {spindle_speed_rad_per_s, depth_m}), limits);
  });
}

FinishDepth vibration_depth(const stability::ForcedResponse& response, double spindle_speed_rad_per_s, double deepest_m,
                            double feed_per_tooth_m) {
  return deepest_kept(deepest_m, [&](double depth_m) -> std::optional<LimitedBy> {
    if (response.at({spindle_speed_rad_per_s, depth_m}).amplitude_m <= feed_per_tooth_m) return std::nullopt;
    return LimitedBy::forced_vibration;
  });
}

std::vector<double> vibration_depths(const stability::LobesProblem& problem,
                                     std::span<const double> spindle_speed_rad_per_s, double deepest_m,
                                     Progress& progress) {
  constexpr double step_share = 0.005;
  constexpr double most_steps = 4.0;
  const stability::ForcedResponse response(problem);
  const std::size_t count = spindle_speed_rad_per_s.size();
  std::vector<double> at(count), after(count, deepest_m);  // at a speed, and between it and the next
  const auto depth_at = [&](double speed) {
    return std::min(deepest_m,
                    vibration_depth(response, speed, deepest_m, problem.milling.feed_per_tooth_m).axial_depth_m);
  };
  progress.start("forced vibration", count);
  parallel_for(count, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      progress.check();
      const double speed = spindle_speed_rad_per_s[i];
      at[i] = depth_at(speed);
      if (i + 1 < count) {
        const double next = spindle_speed_rad_per_s[i + 1];
        const double steps = std::clamp(std::ceil((next / speed - 1.0) / step_share), 1.0, most_steps);
        for (double k = 1.0; k < steps; ++k) {
          after[i] = std::min(after[i], depth_at(std::lerp(speed, next, k / steps)));
        }
      }
      progress.advance();
    }
  });
  std::vector<double> out = at;
  for (std::size_t i = 0; i + 1 < count; ++i) {
    out[i] = std::min(out[i], after[i]);
    out[i + 1] = std::min(out[i + 1], after[i]);
  }
  return out;
}

}  // namespace robomill::decision
