#pragma once
// Holes that a robot drills and countersinks, simulated, with what is true of them.
#include <cstdint>
#include <string>

#include "robomill/simulation/drilling.hpp"

namespace robomill::examples {

inline constexpr double hole_rate_hz = 10240.0;

struct Hole {
  std::string kind;  ///< "drilled", "countersunk"
  simulation::DrillingCut cut;
  double feed_m_per_s = 0.0;
  double seconds = 0.0;           ///< of the cut, entry to exit
  simulation::Simulation record;  ///< acceleration with noise and displacement, idle time before and after
  bool chatter = false;
  double onset_s =
      0.0;        ///< where it chatters: from then on chatter is stronger than what runout forces, and than 1 m/s²
  int draws = 0;  ///< until one was clearly stable or clearly chattering
};

/// Hole number `index` of the set: 6 and 5 mm drills, 1,200 to 4,500 rpm, 0.9 to 9.6 mm/s, every second one
/// countersunk, by the robot of data/robot-modes.toml with a foot that makes it 8 to 60 times stiffer. What
/// vibrates with a twentieth of the runout and yet passes half of what all of the runout forces is chatter; where it
/// stays below a fifth the hole is stable; others are drawn again. Chatter's amplitude in time is that of what
/// regeneration adds: the acceleration less that of the same cut with a rigid cutter's chips.
/// @throws InvalidInput if a hundred draws give none that is clear
[[nodiscard]] Hole simulate_hole(std::uint64_t seed, std::uint64_t index);

/// What is known of a drilled hole.
struct HoleConditions {
  double diameter_m = 0.0, point_angle_rad = 0.0;
  double spindle_speed_rad_per_s = 0.0, feed_m_per_s = 0.0;
};
/// A drilled hole under these; the rest is drawn as for the set, again until the hole is clear and does what is asked.
/// @param chatter  what is asked: a hole with chatter, or a stable one
/// @throws InvalidInput if a hundred draws give none
[[nodiscard]] Hole simulate_hole(const HoleConditions& conditions, bool chatter, std::uint64_t seed,
                                 std::uint64_t index);

/// When the drill first touches the part [s] of the record.
inline constexpr double hole_contact_s = 0.32;

}  // namespace robomill::examples
