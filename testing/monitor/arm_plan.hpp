#pragma once
#include <string>

#include "robomill/modal/modes.hpp"
#include "testing/monitor/recording.hpp"

/// Cuts of robot arms with slow spindles, before any sensor.
namespace robomill::monitor::testing {

/// What an arm cuts: the arm, and a cut that linear theory calls stable, or one that becomes unstable.
struct ArmPlan {
  CutPlan plan;
  /// At the tip, x, y and z: two or three modes of the arm at 8 to 60 Hz, damping 1 to 5 %, in any direction; then two
  /// of the tool in its holder at 350 to 800 Hz, across.
  modal::ModalModel dynamics;
  int arm_modes = 0;           ///< the first ones of dynamics
  double limit_share = 0.0;    ///< the limit of small vibration as a share of the plan's greatest depth
  double growth_per_s = 0.0;   ///< of small vibration at that depth; where stable below 0
  std::string course = {};     ///< "ramp", "step", "abrupt" or "stable"
  double speed_rad_per_s = 0;  ///< of the spindle under load
};

/// Drawn at random: 300 to 3,000 rpm, even in the logarithm; milling with one to four edges, or (one of four) drilling
/// with one or two; the arm; diameter, immersion, material, feed, runout, a worn land and what it damps; the depth
/// against the limit of small vibration: 0.3 to 0.75 of it, or so far above it that chatter grows by 2 to 30 1/s, at
/// most four times it; the spindle slows down by up to 2 % while it cuts.
[[nodiscard]] ArmPlan draw_arm_plan(bool chatter, Random& random);

}  // namespace robomill::monitor::testing
