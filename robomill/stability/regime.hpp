#pragma once
#include "robomill/base/export.hpp"
#include "robomill/base/names.hpp"
#include "robomill/stability/lobes.hpp"

// Method: robomill/stability/README.md, "Regime (`regime.hpp`)"

namespace robomill::stability {

/// What makes a cut chatter.
enum class Regime {
  stable,         ///< nothing: there is no limit
  regenerative,   ///< the wave that the tooth before left
  mode_coupling,  ///< unstable without that wave too: modes feed each other through the force
  low_frequency  ///< less than half a wave between two teeth: q(t) - q(t - τ) is close to τ dq/dt, a force that follows
                 ///< the velocity; usual of an arm's own modes
};
/// As files write them.
inline constexpr Name<Regime> regime_names[] = {{"none", Regime::stable},
                                                {"regenerative", Regime::regenerative},
                                                {"mode-coupling", Regime::mode_coupling},
                                                {"low-frequency", Regime::low_frequency}};
[[nodiscard]] ROBOMILL_API std::string_view to_string(Regime regime);

struct RegimeResult {
  Regime regime = Regime::stable;
  double without_delay = 0.0;        ///< spectral radius of the same period with F = K q
  double waves_between_teeth = 0.0;  ///< chatter frequency times the mean delay
  /// Process damping, which is not known here, would raise the limit: more than three waves stand between two teeth.
  bool lower_bound = false;
};

/// At a point that is unstable or on the border, by collocation; `stable` where the point is stable.
/// @throws InvalidInput as evaluate_point
[[nodiscard]] ROBOMILL_API RegimeResult regime_at(const LobesProblem& problem, const OperatingPoint& point,
                                                  double tolerance = 1e-4);

}  // namespace robomill::stability
