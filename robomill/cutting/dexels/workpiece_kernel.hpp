#pragma once
#include "robomill/base/lanes.hpp"

namespace robomill::cutting::detail {

/// Eight parallel rays and a swept ball or cylinder. With a the solid's axis (zero for a ball), u the rays' direction,
/// d the way and w from the solid's origin to the ray, "across" being what is left without the part along a.
struct Meeting {
  enum class Tilt { along, across, oblique };  ///< of the rays to the axis; across: the faces bound λ alone
  enum class Way { none, along, free };        ///< d across, as the rays see it: none, along them, or neither
  Tilt tilt = Tilt::across;
  Way way = Way::none;
  bool faces = false;
  double radius = 0.0, low = 0.0, high = 0.0;
  double uz = 0.0, dz = 0.0;            ///< parts along the axis
  double uu = 0.0, ud = 0.0, dd = 0.0;  ///< products of what is across
  double axis_column = 0.0, axis_row = 0.0, axis_ray = 0.0;
  double way_column = 0.0, way_row = 0.0, way_ray = 0.0;
  double w_row = 0.0;  ///< the same for the eight
  Lanes w_column = {};
  Lanes from = {}, to = {};  ///< result, from the origin's coordinate; from > to where a ray misses
};

/// Fills from and to.
void meet(Meeting& meeting);

}  // namespace robomill::cutting::detail
