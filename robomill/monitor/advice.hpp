#pragma once
#include <optional>
#include <span>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/modal/modes.hpp"
#include "robomill/stability/lobes.hpp"

// Method: robomill/monitor/README.md, "Outputs"

namespace robomill::monitor {

/// A speed at which the cut follows the chatter's own wave: the teeth pass a whole number of times k a period of it.
struct StableSpeed {
  int lobe = 1;                          ///< k
  double spindle_speed_rad_per_s = 0.0;  ///< 2π f_c/(N k); n = 60 f_c/(N k) revolutions a minute
  double std_rad_per_s = 0.0;            ///< from that of the frequency
};

struct AdviceOptions {
  double lowest_rad_per_s = 0.0;      ///< >= 0; of the spindle: lowest <= speed <= highest
  double highest_rad_per_s = 2100.0;  ///< > lowest; 20,000 rpm
  double speed_window = 0.0;          ///< in [0, 0.5): the limit of a speed n is the lowest of n (1 ± speed_window)
  double depth_margin = 0.0;          ///< in [0, 1): share of the chart's limit that the best depth keeps off
  /// Of each limit of the lobes the depth up to which forced vibration stays within the feed per tooth
  /// (decision::vibration_depths); empty: not known. It needs no margin.
  std::span<const double> vibration_depth_m = {};
  /// Of samples that no anti-alias filter is stated for, f_s > 0: then the line may be one of f_s - f and f_s + f that
  /// is folded to f. 0: a filter is stated.
  double unfiltered_sample_rate_hz = 0.0;
  /// @throws InvalidInput naming the field
  ROBOMILL_API void validate() const;
};

/// What to do about chatter.
struct Advice {
  /// What the measured line f may be, in the order f, f_s - f, f_s + f. Of more than one it is not known which: then no
  /// mode is named, there are no speeds and no best one, and the frequencies below are 0.
  std::vector<double> line_hz = {};
  modal::ModeId mode = {};  ///< that chatters; unknown: none explains it, several do about as well, or none were given
  /// Of the mode's motion: the one measured less its multiple of tooth passing or rotation. 0 where the modes that
  /// explain it about as well disagree on that: then there are no speeds.
  double frequency_hz = 0.0;
  double std_hz = 0.0;
  double expected_hz = 0.0;  ///< of that mode; 0 without one
  /// Of the mode's motion as far as it is known: where several modes explain the line about as well, that of the
  /// lowest.
  double lowest_hz = 0.0;
  std::vector<StableSpeed> speeds;  ///< nearest to the present speed first
  /// Speeds that are left out of them: where the cut is as deep as the chart's limit at the present speed, which it is
  /// since it chatters, forced vibration would exceed the feed per tooth.
  int vibrating_speeds = 0;
  /// With a chart: the speed in range with the greatest depth over its window, and that depth: the limit less the
  /// margin, or where forced vibration reaches the feed per tooth. Of a depth that is stable up to the end of the chart
  /// that end counts.
  std::optional<stability::OperatingPoint> best = {};
  bool best_vibrates = false;  ///< it is forced vibration that keeps the best one from being deeper
};

/// The mode is that which stability::explain names for the measured line; its own frequency then counts for the speeds,
/// because a sideband n f_tooth ± f is no vibration of the structure. Without modes the measured frequency counts.
///
/// Without an anti-alias filter the line may be f, f_s - f or f_s + f, up to 3/2 f_s. It is that which the modes
/// explain where they explain one alone. Of a folded line a multiple of tooth passing up to the tenth counts.
/// @param frequency_hz            of chatter as measured, f > 0; below unfiltered_sample_rate_hz, where that is given
/// @param std_hz                  its standard deviation, >= 0
/// @param spindle_speed_rad_per_s > 0 where modes are given
/// @param teeth                   >= 1
/// @param modes, lobes            may be null; of the lobes the limits count
/// @param workpiece               its modes count beside those of the tool, where both are known
/// @throws InvalidInput naming what is out of range
[[nodiscard]] ROBOMILL_API Advice advise(double frequency_hz, double std_hz, double spindle_speed_rad_per_s, int teeth,
                                         const modal::ModalModel* modes = nullptr,
                                         const stability::LobesResult* lobes = nullptr,
                                         const AdviceOptions& options = {}, const modal::ModalModel& workpiece = {});

}  // namespace robomill::monitor
