#pragma once
// The source's named holes as simulated stand-ins, and its threshold on many holes.
#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "examples/calibrate-holes/holes.hpp"
#include "robomill/monitor/calibration.hpp"
#include "robomill/monitor/monitor.hpp"

namespace robomill::examples {

/// What the source prints of a named hole; units as printed.
struct NamedHole {
  std::string_view name, material;
  double diameter_mm = 0.0, point_angle_deg = 0.0, spindle_speed_rpm = 0.0, feed_mm_per_s = 0.0;
  bool chatter = true;
  double alarm_s = monitor::unknown_s, visible_s = monitor::unknown_s;  ///< printed
};
/// Experiments 1 to 4, and the stable hole of fig. 7.
[[nodiscard]] const std::array<NamedHole, 5>& named_holes();
[[nodiscard]] HoleConditions conditions_of(const NamedHole& hole);

/// The published feature with its window, hop and bands.
[[nodiscard]] monitor::MonitorOptions entropy_options(monitor::Entropy entropy);

/// The entropy of a hole, hop by hop.
struct EntropyCourse {
  std::vector<double> time_s;  ///< of a value's last sample, in the record
  std::vector<double> one;     ///< of the acceleration in x alone
  std::vector<double> both;    ///< x and y summed, as `robomill calibrate` takes them
};
[[nodiscard]] EntropyCourse entropy_course(const Hole& hole, monitor::Entropy entropy);

/// The first time at which the values pass the threshold; NaN: never.
[[nodiscard]] double passed_s(const std::vector<double>& time_s, const std::vector<double>& values, double threshold,
                              bool below = false);

/// When holes pass a threshold. Before: more than a window (50 ms) before the onset.
struct Passed {
  int chatter_before = 0, chatter_in = 0, chatter_never = 0;
  int stable_passes = 0, stable_never = 0;
  double median_delay_s = monitor::unknown_s;  ///< after the onset, of those that pass in chatter
};
struct JudgedHole {
  bool chatter = false;
  double onset_s = monitor::unknown_s;
  double tenth_s = monitor::unknown_s;  ///< SqueezedVisibility::tenth_s()
  EntropyCourse energy;                 ///< mean squares, (m/s²)²
};
[[nodiscard]] Passed count_passed(const std::vector<JudgedHole>& holes, double threshold, bool both);

/// The source's procedure: the entropy at the time at which each hole begins to chatter, of every second one; the
/// threshold is their median, the others verify it.
struct OnsetThreshold {
  double threshold = 0.0, low_decile = 0.0, high_decile = 0.0;
  Passed verified;
};
/// @param when  JudgedHole::onset_s: as simulated; tenth_s: as the spectrum shows it
[[nodiscard]] OnsetThreshold onset_threshold(const std::vector<JudgedHole>& holes, double JudgedHole::*when);

/// What a plot with linear axes shows; NaN: not.
struct Growth {
  double rises_s =
      monitor::unknown_s;  ///< the entropy is below a twentieth of its greatest for the last time before it
  double settles_s = monitor::unknown_s;    ///< it first has nineteen twentieths of it
  double amplitude_s = monitor::unknown_s;  ///< the root mean square of 10 ms first has a tenth of its greatest
};
[[nodiscard]] Growth growth_of(const Hole& hole, const EntropyCourse& energy);

/// The first alarm of the default detector, which is told teeth and spindle speed; NaN: none.
[[nodiscard]] double default_alarm_s(const Hole& hole);

/// The holes of examples/calibrate-holes, simulated on every core.
[[nodiscard]] std::vector<Hole> simulate_holes(std::uint64_t count, std::uint64_t seed);

/// Both channels, interleaved.
[[nodiscard]] monitor::Recording recording_of(const Hole& hole, std::string_view name);

}  // namespace robomill::examples
