#pragma once
#include "robomill/simulation/simulation.hpp"

// Method: robomill/simulation/README.md, "The cut"

namespace robomill::simulation {

/// Drilling, or boring out with a drill: n lips on a cone, fed along the axis, the tool free to vibrate along and
/// across it. A lip's chip is cut along n = (cos p sin φ, cos p cos φ, -sin p), p half the point angle, over the width
/// b / sin p; Kt acts against the cut's motion, Kr against n (the thrust). The chisel edge is left out, as is twisting.
struct ROBOMILL_API DrillingCut {
  int lips = 2;                                 ///< n, >= 1, evenly spaced
  double diameter_m = 0.0;                      ///< D [m], > 0; required
  double point_angle_rad = 2.0594885173533087;  ///< 2p [rad], in (0, π]; 118 degrees
  double radial_width_m = 0.0;                  ///< b [m], from the pilot hole (or the core) to the rim, 0 < b <= D/2
  double feed_per_revolution_m = 0.0;           ///< f [m], > 0; required
  double runout_m = 0.0;                        ///< offset of the drill's axis towards the first lip [m], >= 0
  cutting::ForceCoefficients coefficients;      ///< edge forces per length of lip
  modal::TipModes structure;                    ///< x, y and z; no modes: rigid
  double spindle_speed_rad_per_s = 0.0;         ///< Ω [rad/s], > 0; required
  Schedule schedule = {};                       ///< of width and speed in time
  /// @throws InvalidInput naming the member
  void validate() const;
};

/// As for milling; there is no wall.
/// @throws InvalidInput if the cut or an option is out of range
/// @throws Interrupted  when progress asks to stop
[[nodiscard]] ROBOMILL_API Simulation simulate(const DrillingCut& cut, const SimulationOptions& options = {},
                                               Progress& progress = Progress::none());
[[nodiscard]] ROBOMILL_API SmallVibration small_vibration(const DrillingCut& cut, const SimulationOptions& options = {},
                                                          Progress& progress = Progress::none());

}  // namespace robomill::simulation
