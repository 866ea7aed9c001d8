#pragma once
#include <Eigen/Core>
#include <vector>

#include "robomill/base/random.hpp"
#include "testing/monitor/recording.hpp"

/// From the acceleration of a cut to the channels of a recording.
namespace robomill::monitor::testing {

/// Vibration of corpus_rate_hz, x and y, as sensors see it.
struct Sensors {
  struct Echo {
    double delay_s = 0.0, gain = 0.0;
  };
  double sample_rate_hz = corpus_rate_hz;
  Eigen::MatrixX2d mix = Eigen::Matrix2d::Identity();  ///< channels x (x, y)
  std::vector<Echo> echoes = {};
};
/// Interleaved: what a converter without a filter before it takes at its instants.
[[nodiscard]] std::vector<float> sensed(const CleanCut::Columns& vibration, const Sensors& sensors);
/// The truth at the frames of another rate; its frequencies are folded there.
[[nodiscard]] Truth at_rate(const Truth& truth, double sample_rate_hz);

/// A tone at no multiple of rotation.
struct MachineTone {
  double frequency_hz = 0.0, amplitude = 0.0;
  double from_s = -1e9, to_s = 1e9, fade_s = 0.1;
  double swing = 0.0, swing_hz = 1.0;  ///< of its amplitude
};
/// Of a frequency drawn evenly in its logarithm that keeps from all multiples of these rotations by a tenth of a
/// rotation, and 2 Hz at least.
[[nodiscard]] MachineTone draw_tone(double low_hz, double high_hz, double amplitude,
                                    const std::vector<double>& rotations_hz, Random& random);
/// To every channel, with a gain of 0.3 to 1 and a phase of its own.
void add_tones(const std::vector<MachineTone>& tones, double sample_rate_hz, int channels, Random& random,
               std::vector<float>& samples);

/// What a turning spindle shows without cutting: multiples of rotation and, of belts and gears, of a third of it, with
/// amplitudes that grow with the square of the speed up to those at the nominal one, and more where one passes a
/// resonance.
struct DriveOrders {
  double nominal_rad_per_s = 0.0;
  double amplitude = 0.0;  ///< of the rotation at the nominal speed
  double thirds = 0.0;     ///< of each multiple of a third, up to the twelfth
  double resonance_hz = 540.0, damping_ratio = 0.05;
};
/// @param rotation_rad, speed_rad_per_s  one a frame
void add_orders(const DriveOrders& orders, const std::vector<double>& rotation_rad,
                const std::vector<float>& speed_rad_per_s, int channels, Random& random, std::vector<float>& samples);

}  // namespace robomill::monitor::testing
