#pragma once
#include "robomill/simulation/simulation.hpp"

// Method: robomill/simulation/README.md, "The cut"

namespace robomill::simulation {

/// A drill that is fed along its axis, free to vibrate along and across it.
struct ROBOMILL_API DrillingCut : cutting::Drill {
  double radial_width_m = 0.0;           ///< b [m], from the pilot hole (or the core) to the rim, 0 < b <= D/2
  double feed_per_revolution_m = 0.0;    ///< f [m], > 0; required
  double runout_m = 0.0;                 ///< offset of the drill's axis towards the first lip [m], >= 0
  modal::TipModes structure;             ///< x, y and z; no modes: rigid
  double spindle_speed_rad_per_s = 0.0;  ///< Ω [rad/s], > 0; required
  Schedule schedule = {};                ///< of width and speed in time
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
