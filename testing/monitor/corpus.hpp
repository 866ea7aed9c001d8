#pragma once
#include <cstdint>
#include <string>

#include "testing/monitor/recording.hpp"

/// The cuts that the monitor is judged on: the robot of data/robot-modes.toml, eight modes, accelerations in x and y.
namespace robomill::monitor::testing {

/// cut(1) … cut(200) are the set of the README's table, 30 of them drilling at 1,200 to 4,500 rpm; half chatter, half
/// are stable throughout. Seeds from 1001 on are for tuning: nothing is fitted to the first 200.
inline constexpr std::uint64_t corpus_size = 200;

/// Drawn at random: teeth, diameter, immersion, feed's direction, material, helix, runout, speed; the depth against the
/// limit of linear theory; entry, exit, a ramp across the limit, a step across it, or an abrupt start above it; half
/// of those that chatter are freed of it again by a smaller depth; changes of speed; noise of 5, 15 or 40 % of the
/// forced vibration's rms, hum, knocks, drifting gain. A draw whose chatter stays below half the forced vibration's
/// rms, or exceeds ten times that (in drilling 300 times: lost contact alone holds it back), or comes too near to a
/// multiple of the rotation (those are locked_chatter's), or whose stable cut does not settle, is drawn again.
[[nodiscard]] RecordedCut cut(std::uint64_t seed);

/// Chatter whose frequency is a multiple of the spindle's rotation: the speed is where the multiplier of a revolution
/// is real.
[[nodiscard]] RecordedCut locked_chatter(std::uint64_t seed);
/// Multiplier of a tooth period real and below -1, with 2 or 4 teeth: chatter at odd halves of tooth passing.
[[nodiscard]] RecordedCut period_doubling(std::uint64_t seed);

/// What cut() simulates, and how often it had to draw.
struct DrawnCut {
  CutPlan plan;
  CleanCut clean;
  RecordedCut recorded;
  int draws = 0;
  Disturbance disturbance;    ///< what disturbed() made of plan and clean to give the samples
  Random random = Random(0);  ///< as disturbed() was given it: with parts of the disturbance the same noise comes again
};
[[nodiscard]] DrawnCut draw(std::uint64_t seed);

/// What a cut is to be.
struct CutWish {
  bool drilling = false, chatter = false;
  bool low = false;             ///< in milling, chatter of the arm instead of the tool
  std::string course = "step";  ///< of chatter: "ramp", "step" or "abrupt"
  int noise = 0;                ///< 0, 1, 2
  /// Growth of small vibration in full depth: drawn between these, evenly in its logarithm [1/s].
  double least_growth_per_s = 6.0, most_growth_per_s = 60.0;
  double most_limits = 3.0;             ///< greatest depth, as a multiple of the limit
  double most_speed_rad_per_s = 1e300;  ///< of the spindle
};
/// Draws as cut() does, until the cut is as wished.
[[nodiscard]] DrawnCut draw(const CutWish& wish, Random& random);

/// A plan of stable cutting, without idle times: entry, steady cutting, a change of speed in half of them, exit.
[[nodiscard]] CutPlan stable_plan(bool drilling, double seconds, Random& random);
/// Whether the cut is what its plan calls stable: for no tenth of a second does what regeneration adds stay above a
/// quarter of the reference level. Vibration that rings on for longer, or grows before it dies out, is neither stable
/// cutting nor chatter.
[[nodiscard]] bool settles(const CutPlan& plan, const CleanCut& clean);

}  // namespace robomill::monitor::testing
