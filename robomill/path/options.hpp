#pragma once
#include "robomill/base/export.hpp"
#include "robomill/base/names.hpp"

/// NC program + robot -> smooth joint trajectory. Work frame W: the program's own; docs/frames.md.
// Method: robomill/path/README.md, "Method"
namespace robomill::path {

/// How a program becomes a trajectory.
///   verified:         a blended path and the fastest speed along it, window by window; every limit holds
///   optimal:          the same path, the speed optimised over long windows on a finer grid
///   paper:            FIR pulses per block as published, with tip and axis sharing their time constants
///   paper_as_printed: the published equations with their errors
///   no_joint_jerk:    the method before it [Sun2021]: joint velocity and |acceleration| alone
enum class Method { verified, optimal, paper, paper_as_printed, no_joint_jerk };
/// As in a cell's [smoothing]; the fastest to plan first.
inline constexpr Name<Method> method_names[] = {{"verified", Method::verified},
                                                {"optimal", Method::optimal},
                                                {"paper", Method::paper},
                                                {"paper-as-printed", Method::paper_as_printed},
                                                {"no-joint-jerk", Method::no_joint_jerk}};

/// Limits and tolerances of a smoothed path. Limits of tip and axis hold along their paths: speed, d(speed)/dt, and
/// the jerk vector's projection on the direction of motion.
struct ROBOMILL_API SmoothingOptions {
  Method method = Method::verified;
  double tip_tolerance_m = 0.0;     ///< > 0; distance of the tip to the programmed path <= tip_tolerance_m; required
  double axis_tolerance_rad = 0.0;  ///< > 0; angle of the axis to the programmed curve <= this; required
  /// > 0; of the tip: |value| <= limit at every sample.
  double max_velocity_m_per_s = 0.0, max_acceleration_m_per_s2 = 0.0, max_jerk_m_per_s3 = 0.0;
  /// > 0; of the axis: |value| <= limit at every sample.
  double max_angular_velocity_rad_per_s = 0.0, max_angular_acceleration_rad_per_s2 = 0.0,
         max_angular_jerk_rad_per_s3 = 0.0;
  double sample_period_s = 0.001;   ///< in [1e-5, 0.1]; of what is sent out
  double max_duration_s = 86400.0;  ///< > 0; a program with duration > this is rejected before it is sampled
  int filters = 2;  ///< 1 to 3; moving averages in series: 1 a trapezoid of speed, 2 the S curve, 3 smoother. verified
                    ///< and optimal need at least 2
  /// @throws InvalidInput naming the member
  void validate() const;
};

}  // namespace robomill::path
