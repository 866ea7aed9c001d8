#pragma once
#include <cstddef>

#include "robomill/path/speed/segment.hpp"

/// The feed override s = dτ/dt at which a plan is run, τ being the time it was planned in.
///
/// A channel x(τ) with velocity x', acceleration x'' and jerk x''' by τ moves with
///     x' s,   x'' s² + x' ṡ,   x''' s³ + 3 x'' s ṡ + x' s̈
/// by time. The plan keeps |x''| <= α A, so that |x''| s² leaves more of A the slower it runs: ṡ may grow like
/// 1 − α s². Hence s is run through θ, with
///     ds/dθ = g(s) = 1 − α s²,   s = tanh(√α θ) / √α  for s <= 1,   and g = 1 − α above:
/// what θ may do hardly depends on s, and from full override to rest are θ(1) = artanh(√α) / √α, 1.9 for α = 0.9 and
/// not 1 / (1 − α) = 10. With |θ̇| <= r and |θ̈| <= κ r² (one number r, the slope), ṡ = g θ̇, |s̈| <= g (κ + 2 α s) r², and
/// a channel keeps its limits if at every s up to the largest
///     |x''| s² + |x'| g r <= A,   |x'''| s³ + 3 |x''| s g r + |x'| g (κ + 2 α s) r² <= J.
namespace robomill::path {

namespace override_limits {
inline constexpr double alpha = 0.9;  ///< of acceleration limits: the most that a plan may use at override 1
inline constexpr double beta = 0.86;  ///< of jerk limits
inline constexpr double kappa = 2.5;  ///< makes stops shortest, about
inline constexpr double max = 1.5;    ///< of s
}  // namespace override_limits

/// Largest magnitudes of the channels' velocity, acceleration and jerk at override 1.
struct Demand {
  Channels velocity = {}, acceleration = {}, jerk = {};
  double feed = 0.0;  ///< the tip's speed over the programmed feed
  void add(const Demand& other) noexcept;
};

/// Plan time up to end_s, and how the override may run and change in it.
struct Stretch {
  enum class Kind { flows, rests, dwell };  ///< rests: the plan comes to rest at its end; dwell: it stands still
  Kind kind = Kind::flows;
  double end_s = 0.0;  ///< of plan time
  double slope = 0.0;  ///< r [1/s]
  double cap = 1.0;    ///< largest s
  double feed = 1.0;   ///< … at overrides up to 1
};

/// What a demand leaves to the override.
/// @param max_slope  [1/s]
[[nodiscard]] Stretch stretch_of(const Demand& demand, const ChannelLimits& limits, double max_slope) noexcept;

/// s of θ and back.
[[nodiscard]] double override_of(double theta) noexcept;
[[nodiscard]] double theta_of(double feed_override) noexcept;

struct OverrideState {
  double theta = 0.0;
  double speed = 0.0;  ///< θ̇ [1/s]
  /// θ where a rise ends that is broken off now.
  [[nodiscard]] double peak(double slope) const noexcept;
};

/// θ and θ̇ one period on, towards a target and to rest there: |θ̇| <= slope, θ̈ constant and within κ slope². Arrives
/// without overshooting, in the end in two periods.
[[nodiscard]] OverrideState approach(const OverrideState& from, double target, double slope, double period_s) noexcept;

/// Plan time that passes, at most, until θ stays at or below `until` when it is brought to rest at `base` <= until as
/// fast as the slope allows [s]; infinite where it cannot come to rest there without passing below.
[[nodiscard]] double travel_s(const OverrideState& from, double base, double until, double slope,
                              double period_s) noexcept;

/// Plan time that passes in a period [s].
[[nodiscard]] double passed_s(const OverrideState& from, const OverrideState& to, double period_s) noexcept;

}  // namespace robomill::path
