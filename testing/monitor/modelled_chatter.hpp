#pragma once
#include <Eigen/Core>
#include <vector>

#include "robomill/base/random.hpp"
#include "testing/monitor/recording.hpp"

namespace robomill::monitor::testing {

/// Chatter by a model, for what the time-domain simulation does not do:
///   c(t) = A(t) Σ_m w_m(t) a d_m [cos φ_m + s cos(φ_m + z θ) + s cos(φ_m - z θ)],  dφ_m/dt = 2π f_m(t)
/// in x and y, with the spindle's angle θ and z teeth. A grows as a logistic function and falls exponentially; the
/// weight w_m follows 1 while the chatter visits mode m and 0 else, with a time constant of 15 ms; a makes A the root
/// of the mean square over both channels. f_m = frequency + drift + a wander with a correlation time of 50 ms.
struct ModelledChatter {
  struct Mode {
    double frequency_hz = 0.0;
    double direction_rad = 0.0;
  };
  struct Visit {
    double from_s = 0.0;
    std::size_t mode = 0;
  };
  std::vector<Mode> modes = {};
  std::vector<Visit> visits = {{0.0, 0}};  ///< by time; the first holds from the start
  double final_m_per_s2 = 0.0;
  double growth_per_s = 0.0, half_s = 0.0;  ///< A is half the final one at half_s
  double end_s = 0.0, decay_per_s = 100.0;  ///< from end_s on
  double drift_hz_per_s = 0.0, drift_from_s = 0.0, drift_to_s = 0.0;
  double sideband = 0.0;   ///< s; the lower one is left out where it would come below 20 Hz
  double wander_hz = 0.0;  ///< standard deviation
};

/// Adds it to the cut's acceleration where the tool is in contact, or was in the last second.
/// @return the model's truth: times as find_times has them, course_hz, lines
[[nodiscard]] Truth add_chatter(const ModelledChatter& chatter, const CutPlan& plan, Random& random, CleanCut& clean);

}  // namespace robomill::monitor::testing
