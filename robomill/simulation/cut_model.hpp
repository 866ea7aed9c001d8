#pragma once
#include <vector>

#include "robomill/cutting/milling.hpp"

namespace robomill::simulation::detail {

/// Ω(t) = Ω_0 (1 + a sin(r Ω_0 t)); the rotation is its integral from 0.
struct Spindle {
  double mean_rad_per_s = 0.0;
  double amplitude = 0.0;
  double ratio = 0.0;
  [[nodiscard]] bool steady() const { return amplitude == 0.0; }
  [[nodiscard]] double rotation(double time_s) const;  ///< [rad]
  [[nodiscard]] double speed(double time_s) const;     ///< [rad/s]
};

/// A piece of a cutting edge: a tooth's slice, or a drill's lip.
struct Element {
  double standing_rad = 0.0;  ///< its angle at rotation 0, in [0, 2π)
  double sine = 0.0, cosine = 1.0;
  double radius_m = 0.0;  ///< beyond the nominal
  double width_m = 0.0;   ///< of cut
  int ring = 0;           ///< on whose surface it cuts: that of its slice
};

/// A cut as the time step sees it. Elements at φ cut a chip along n = (lateral sin φ, lateral cos φ, -axial).
struct CutModel {
  std::vector<Element> elements;
  int rings = 1;
  double entry_rad = 0.0, exit_rad = 0.0;
  bool whole_circle = false;  ///< a drill: in the cut at every angle
  double lateral = 1.0, axial = 0.0;
  double radius_m = 0.0;
  double feed_m_per_s = 0.0;  ///< along x, or for a drill along -z
  cutting::ForceCoefficients coefficients;
  cutting::ProcessDamping damping;
  Spindle spindle;
  int steps_per_revolution = 0;
};

/// How fine: time steps of a mean revolution, axial slices.
struct Resolution {
  int steps_per_revolution = 0;
  int slices = 1;
};

[[nodiscard]] CutModel milling_model(const cutting::Milling& milling, double spindle_speed_rad_per_s,
                                     double axial_depth_m, const Resolution& resolution);

}  // namespace robomill::simulation::detail
