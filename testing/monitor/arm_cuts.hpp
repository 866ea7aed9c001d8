#pragma once
#include <cstdint>

#include "robomill/base/names.hpp"
#include "testing/monitor/arm_plan.hpp"
#include "testing/monitor/recording.hpp"

/// Cuts of robot arms with slow spindles, as the sensors of an arm show them. What is simulated and what is modelled:
/// testing/monitor/README.md.
namespace robomill::monitor::testing {

enum class ArmSensor {
  spindle_accelerometer,  ///< x and y at the tool, 5,120 Hz
  wrist_accelerometer,    ///< x and y, 2,048 Hz: little of what the tool's modes do reaches the wrist
  force,                  ///< x and y between tool and part, 1,024 or 5,120 Hz
  drive_current,          ///< two to six joints in a controller's trace, 250, 500 or 1,000 Hz [A]
  motor_torque            ///< the same as the controller estimates it [N m]
};
inline constexpr Name<ArmSensor> arm_sensor_names[] = {{"spindle-accelerometer", ArmSensor::spindle_accelerometer},
                                                       {"wrist-accelerometer", ArmSensor::wrist_accelerometer},
                                                       {"force", ArmSensor::force},
                                                       {"drive-current", ArmSensor::drive_current},
                                                       {"motor-torque", ArmSensor::motor_torque}};

/// Seeds of each sensor: as of machine_cut. Odd seeds chatter, even ones do not; the noise is 3, 10 or 30 % of the
/// forced vibration's rms in the sensor. The hint is the speed under load, exact in a fifth of the cuts and off by up
/// to 5 % in the others. Truth is that of the noise-free simulation as the sensor shows it, in the sensor's unit,
/// without what is slower than 3 Hz: the load. kind: the sensor's name.
[[nodiscard]] RecordedCut arm_cut(ArmSensor sensor, std::uint64_t seed);

/// The cut of the spindle accelerometer's seed as it, a wrist accelerometer and a force sensor show it at once, at
/// 5,120 Hz, two channels each. Each has noise of its own; tones, hum and knocks are those of one arm. Truth is the
/// spindle accelerometer's.
[[nodiscard]] RecordedCut arm_cut_of_three_sensors(std::uint64_t seed);

/// A cut, and what stands before the sensor.
struct ArmCut {
  RecordedCut recorded;
  ArmPlan arm;
  CleanCut seen;       ///< of corpus_rate_hz: accelerations stand for what the sensor shows, in its unit
  double level = 0.0;  ///< rms of the forced vibration at full depth, over x and y, in the sensor's unit
};
[[nodiscard]] ArmCut draw_arm_cut(ArmSensor sensor, std::uint64_t seed);

}  // namespace robomill::monitor::testing
