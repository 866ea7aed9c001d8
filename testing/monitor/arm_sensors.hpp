#pragma once
#include <vector>

#include "testing/monitor/arm_cuts.hpp"
#include "testing/monitor/sensors.hpp"

/// From the cut of an arm to the channels of a recording.
namespace robomill::monitor::testing {

/// Low-pass of second order, of gain 1 at 0 Hz: y'' + 2 ζ ω y' + ω² y = ω² x, sampled; little damped, a resonance.
class TwoPoles {
 public:
  TwoPoles(double frequency_hz, double damping_ratio, double sample_rate_hz);
  double next(double x) {
    const double y = gain_ * x + turn_ * a_ - square_ * b_;
    b_ = a_;
    a_ = y;
    return y;
  }
  /// Root of the mean square of its output of white noise of rms 1.
  [[nodiscard]] double noise_gain() const;

 private:
  double gain_ = 1.0, turn_ = 0.0, square_ = 0.0, a_ = 0.0, b_ = 0.0;
};

/// How an arm's cut comes to a recording.
struct ArmSensing {
  struct LowPass {
    double frequency_hz = 0.0, damping_ratio = 0.7;
  };
  ArmSensor sensor = ArmSensor::spindle_accelerometer;
  std::vector<LowPass> low_passes = {};
  double scale = 1.0;  ///< of drives: from the tip's deflection to torque or current [N or A/m]
  Sensors sampled;     ///< rate, and the channels' share of x and y
  [[nodiscard]] bool of_drives() const {
    return sensor == ArmSensor::drive_current || sensor == ArmSensor::motor_torque;
  }
};
/// @param choice  of the rates that the sensor has; any number
[[nodiscard]] ArmSensing draw_sensing(ArmSensor sensor, std::uint64_t choice, Random& random);

/// What the sensor shows of a cut: acceleration_m_per_s2 and forced_m_per_s2 are in its unit.
[[nodiscard]] CleanCut seen_by(const ArmSensing& sensing, const CleanCut& clean);

/// All that a recording has beside the cut, added to its samples.
/// @param level  of ArmCut
/// @param noise   as a share of it
/// @param events  draws what several sensors show at once: tones, hum, knocks; may be `random`
void disturb_arm_cut(const ArmCut& cut, const ArmSensing& sensing, double noise, Random& random, Random& events,
                     std::vector<float>& samples);

}  // namespace robomill::monitor::testing
