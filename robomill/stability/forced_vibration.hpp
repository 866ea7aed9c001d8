#pragma once
#include <limits>
#include <memory>

#include "robomill/base/export.hpp"
#include "robomill/modal/mode_id.hpp"
#include "robomill/stability/frequency_response.hpp"
#include "robomill/stability/lobes.hpp"

// Method: robomill/stability/README.md, "Forced vibration (`forced_vibration.hpp`)"

namespace robomill::stability {

/// How a stable cut makes the tip vibrate, its mean deflection apart. NaN: not computed.
struct ForcedVibration {
  /// Half the peak to peak of the tip, in the direction in which that is greatest [m]: half the greatest distance
  /// between two of its places. In the plane in x and y, of a cut in three directions in x, y and z.
  double amplitude_m = std::numeric_limits<double>::quiet_NaN();
  /// The harmonic in which the tip moves most: of tooth passing where all teeth cut alike, else of the rotation.
  int harmonic = 0;
  bool of_tooth_passing = true;
  double frequency_hz = 0.0;
  double harmonic_m = std::numeric_limits<double>::quiet_NaN();  ///< greatest displacement of that harmonic alone [m]
  modal::ModeId mode = {};                                       ///< that moves most in it; unknown of measured FRFs
  double mode_frequency_hz = 0.0;                                ///< of that mode; 0: unknown
  double mode_m = 0.0;                                           ///< greatest displacement of that mode in it [m]
};

/// The tip's answer to the force of a rigid tool, harmonic by harmonic from the whole receptance:
///   q(t) = Σ_k G(i k Ω) F_k e^{i k Ω t},  k = ±1, ±2, …,
/// with chips of the feed and of runout and edge forces in F. Of equal teeth, which meet the surface that the one
/// before left with the same displacement, it is the steady motion of a stable cut; of teeth that differ what they
/// regenerate is left out in the plane.
///   Of a cut in three directions it is that of surface_point(): the exact answer between the borders of the force,
///   with
/// what unequal teeth regenerate; the mode is that which their force without it moves most.
class ROBOMILL_API ForcedResponse {
 public:
  /// @throws InvalidInput if the problem is not a valid milling cut, its feed is not > 0, or one in three directions is
  /// of measured FRFs
  explicit ForcedResponse(const LobesProblem& problem);
  /// @throws InvalidInput unless speed and depth are > 0
  [[nodiscard]] ForcedVibration at(const OperatingPoint& point) const;

 private:
  struct Spatial;
  cutting::Milling milling_;
  FrequencyResponse response_;
  bool equal_teeth_ = true;
  std::shared_ptr<const Spatial> spatial_ = {};  ///< in place of them
};

}  // namespace robomill::stability
