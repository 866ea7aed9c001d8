#pragma once
#include <array>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/modal/mode_id.hpp"
#include "robomill/stability/forced_vibration.hpp"
#include "robomill/stability/lobes.hpp"

// Method: robomill/decision/README.md, "The recommendation (`recommend.hpp`)"

namespace robomill::decision {

/// Which limit keeps an operation, or a finishing depth, from being deeper.
enum class LimitedBy {
  chatter,         ///< (1 - depth_margin) · the lowest unstable depth of the speed window
  depth_range,     ///< (1 - depth_margin) · searched_depth_m: no depth that was looked at is unstable
  cutter,          ///< max_axial_depth_m, the cutter's flute length
  spindle_torque,  ///< the mean cutting torque reaches what the spindle gives at this speed
  spindle_power,   ///< the mean cutting power reaches what the spindle gives at this speed
  surface_error,   ///< FinishLimits::max_surface_error_m
  deflection,      ///< FinishLimits::max_deflection_m
  /// Forced vibration, its mean apart, as far as the feed per tooth: teeth would leave the cut and meet it again.
  forced_vibration
};

/// How deep forced vibration lets a cut go at one speed.
struct FinishDepth {
  double axial_depth_m = std::numeric_limits<double>::infinity();  ///< infinite: nothing limits it
  LimitedBy reason = LimitedBy::surface_error;
};

/// What limits the depth at one speed.
struct DepthLimit {
  stability::Limit chatter;  ///< stable_in_range: up to RecommendOptions::searched_depth_m
  FinishDepth finish = {};
};

/// What the spindle gives at one speed; linear in between.
struct SpindleCapacity {
  double spindle_speed_rad_per_s = 0.0;
  double torque_n_m = 0.0;
  double power_w = 0.0;
};
/// Linear in speed between the points of a curve; no torque and no power outside it.
[[nodiscard]] ROBOMILL_API SpindleCapacity capacity_at(const std::vector<SpindleCapacity>& curve,
                                                       double spindle_speed_rad_per_s);

/// The depth in [0, deepest_m] at which an increasing torque of depth reaches torque_n_m; deepest_m where it does not.
[[nodiscard]] ROBOMILL_API double depth_of_torque_m(const std::function<double(double)>& mean_torque_n_m,
                                                    double torque_n_m, double deepest_m);

/// What is kept where nobody says otherwise: share of the limit that a depth keeps off, at every speed within so much.
inline constexpr double default_depth_margin = 0.2, default_speed_window = 0.02;

/// What cutter and spindle allow, and how far off the limits conditions are kept.
struct MachineLimits {
  double max_axial_depth_m = 0.0;            ///< of the cutter, in [0, 0.5 m]; 0: not limited
  double min_spindle_speed_rad_per_s = 0.0;  ///< min <= speed <= max; min < max, each 0 or one that spindles have
  double max_spindle_speed_rad_per_s = 0.0;  ///< 0: not limited
  /// By increasing speed, torque and power >= 0; empty: not limited. Outside it the spindle gives nothing.
  std::vector<SpindleCapacity> spindle = {};
  double depth_margin = default_depth_margin;  ///< in [0, 1); depth <= (1 - depth_margin) · limit …
  double speed_window = default_speed_window;  ///< … at every speed of n (1 ± speed_window), in [0, 0.5)

  ROBOMILL_API void validate() const;  ///< throws InvalidInput naming the field; of the curve "spindle[2].power_w"
};

/// What recommend needs to know of the cut and its machine.
struct RecommendOptions {
  int teeth = 0;                  ///< >= 1; required
  double radial_depth_m = 0.0;    ///< > 0; required
  double diameter_m = 0.0;        ///< of the cutter, for the cutting speed; 0: unknown
  double feed_per_tooth_m = 0.0;  ///< > 0; required
  double searched_depth_m = 0.0;  ///< largest depth that the limits were looked for at, > 0; required
  /// Mean cutting torque over a revolution of a depth [m], increasing [N m]; empty: none.
  std::function<double(double)> mean_torque_n_m = {};
  MachineLimits machine = {};  ///< without max_axial_depth_m depths go to searched_depth_m
  int alternatives = 3;        ///< >= 0; their speeds lie 5 % apart at least

  ROBOMILL_API void validate() const;  ///< throws InvalidInput naming the field
};

/// Lowest and highest speed of the spindle, within its curve where there is one [rad/s]; 0: not said.
[[nodiscard]] ROBOMILL_API std::array<double, 2> spindle_range(const MachineLimits& limits);

/// A speed and depth to cut at.
struct Operation {
  double spindle_speed_rad_per_s = 0.0;
  double axial_depth_m = 0.0;
  double feed_per_tooth_m = 0.0;
  double feed_m_per_s = 0.0;           ///< f_z N n
  double cutting_speed_m_per_s = 0.0;  ///< of the tooth; 0 where the diameter is unknown
  double removal_rate_m3_per_s = 0.0;  ///< a_p a_e f_z N n
  double limit_depth_m = 0.0;          ///< lowest limit over the speed window (searched_depth_m where there is none)
  double margin = 0.0;                 ///< 1 - depth / limit
  double torque_n_m = 0.0, power_w = 0.0;  ///< means over a revolution
  LimitedBy limited_by = LimitedBy::chatter;
  double chatter_frequency_hz = 0.0;  ///< what chatters at the window's lowest limit; 0: nothing
  modal::ModeId mode = {};
  /// Of the forced vibration, where it was computed; else NaN. See stability::SurfacePoint.
  double surface_error_m = std::numeric_limits<double>::quiet_NaN();
  double peak_deflection_m = std::numeric_limits<double>::quiet_NaN();
  stability::ForcedVibration vibration = {};
};

struct Recommendation {
  /// found: `recommended` holds. no_safe_depth: no speed in range has a depth > 0 that keeps all limits; see `reason`.
  enum class Status { found, no_safe_depth };
  Status status = Status::no_safe_depth;
  std::string reason = {};  ///< why there is no safe depth
  std::optional<Operation> recommended = {};
  std::vector<Operation> alternatives = {};  ///< by falling removal rate
};

/// The speed and depth with the highest removal rate such that the depth is at most (1 - depth_margin) times the limit
/// and at most the finishing depth at every speed of the window, within the spindle's range, torque and power and the
/// cutter's depth; and the next best, each at another lobe where there is one.
///
/// @param limits  by increasing speed, at least two
/// @param limit_at  the limit at any speed: looks between the given ones before an operation is offered
/// @throws InvalidInput if options or limits break their rules
[[nodiscard]] ROBOMILL_API Recommendation recommend(const std::vector<DepthLimit>& limits,
                                                    const RecommendOptions& options,
                                                    const std::function<DepthLimit(double speed_rad_per_s)>& limit_at);

}  // namespace robomill::decision
