#pragma once
#include <cstddef>
#include <vector>

#include "robomill/cutting/engagement.hpp"
#include "robomill/cutting/force.hpp"

namespace robomill::stability::detail {

/// What an edge on a ring answers a displacement with, in T at the angle φ: K = f nᵀ [N/m],
///   n = (sin κ sin φ, sin κ cos φ, -cos κ),  f_y + i f_x = (outward - i tangential) e^{iφ},  f_z = upward.
struct RingStiffness {
  double sine = 0.0, cosine = 0.0;                       ///< of κ
  double tangential = 0.0, outward = 0.0, upward = 0.0;  ///< width times coefficients [N/m]
};

/// A rotation of the cutter over which one tooth's edge cuts on one ring, and what it meets.
struct EdgeContact {
  double from_rad = 0.0, to_rad = 0.0;  ///< of the rotation; the edge stands at φ = rotation + turn
  double turn_rad = 0.0;
  double delay_rad = 0.0;  ///< rotation since the tooth that left the surface
  std::size_t ring = 0;
};

/// Who cuts what who left, from engagement, runout and feed alone; vibration has no part in it. Teeth of equal pitch
/// and helix that stand true all do the same: the period is that of a tooth, and only the first one is held.
struct EdgeContacts {
  std::vector<RingStiffness> rings;
  std::vector<EdgeContact> contacts;
  double period_rad = 0.0;
  int teeth = 1;            ///< held
  bool equal_teeth = true;  ///< every delay is the period
};

/// @param feed_per_tooth_m  decides with runout who misses; > 0 where there is runout
/// @throws InvalidInput as coefficients.validate over the engaged angles
[[nodiscard]] EdgeContacts edge_contacts(const cutting::Cutter& cutter, const cutting::Engagement& engagement,
                                         const cutting::MillingCoefficients& coefficients, double feed_per_tooth_m);

}  // namespace robomill::stability::detail
