#pragma once
#include <array>
#include <string_view>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/base/names.hpp"
#include "robomill/base/units.hpp"

// Method: robomill/process/README.md, "The decision (`decide.hpp`)"

namespace robomill::process {

/// What a decision makes least.
enum class Goal {
  time,         ///< of cutting and of changing the spindle's speed
  removal_rate  ///< of cutting alone: the removal rate while the tool cuts is greatest
};
inline constexpr Name<Goal> goal_names[] = {{"time", Goal::time}, {"removal_rate", Goal::removal_rate}};

/// What may differ from the program.
enum class Free { spindle_speed, feed, gamma, axial_depth, lead, tilt };
inline constexpr Name<Free> free_names[] = {
    {"spindle_speed", Free::spindle_speed}, {"feed", Free::feed}, {"gamma", Free::gamma},
    {"axial_depth", Free::axial_depth},     {"lead", Free::lead}, {"tilt", Free::tilt}};

/// Where the spindle may change its speed.
enum class SpeedChanges {
  none,  ///< one speed for the whole program
  air    ///< in rapid moves between cuts
};
inline constexpr Name<SpeedChanges> speed_change_names[] = {{"none", SpeedChanges::none}, {"air", SpeedChanges::air}};

/// How finishing passes are moved against the deflection that is predicted.
struct ROBOMILL_API PathOffsets {
  double max_offset_m = 0.5e-3;         ///< > 0; longer offsets are cut off there
  bool controller_compensates = false;  ///< the robot's controller does it already: the program is left as it is
  /// @throws InvalidInput naming the member
  void validate() const;
};

/// What is free, and what must be kept beside spindle, safety and finishing.
struct ROBOMILL_API DecideOptions {
  /// Nothing: the program is judged as it is.
  std::vector<Free> free = {Free::spindle_speed, Free::feed};
  Goal goal = Goal::time;
  SpeedChanges speed_changes = SpeedChanges::air;
  bool speed_changes_given = false;  ///< that is asked for; else the output may allow one speed alone
  /// > 0; of the spindle. The default is an assumption: 3,000 rpm a second.
  double spindle_ramp_rad_per_s2 = 3000.0 * units::rpm;
  double max_force_n = 0.0;                         ///< >= 0; peak on the tool; 0: no limit
  double max_deflection_m = 0.0;                    ///< >= 0; of the tip under a revolution's mean force; 0: no limit
  bool avoid_reversals = false;                     ///< no joint's load may turn round while it cuts
  double max_feed_m_per_s = 0.0;                    ///< >= 0; of the tip; 0: no limit
  std::array<double, 2> chip_thickness_m = {0, 0};  ///< greatest in the cut: least and most; 0: as the program has it
  std::array<double, 2> cutting_speed_m_per_s = {0, 0};  ///< of the outermost point that cuts; 0: no limit
  /// Turns of the flange about the tool's axis, from where the program has it.
  std::array<double, 2> gamma_range_rad = {-90.0 * units::deg, 90.0 * units::deg};
  double gamma_step_rad = 15.0 * units::deg;  ///< >= 1°
  /// Leans of the tool from where the program has it, where lead or tilt are free: in (0, 45°], and its steps, >= 1°.
  double cone_rad = 15.0 * units::deg, cone_step_rad = 7.5 * units::deg;
  bool compensate = false;  ///< finishing passes are moved
  PathOffsets offsets = {};
  [[nodiscard]] bool is_free(Free what) const;
  [[nodiscard]] bool leans_free() const;  ///< lead or tilt
  /// @throws InvalidInput naming the member
  void validate() const;
};

}  // namespace robomill::process
