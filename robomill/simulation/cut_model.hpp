#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "robomill/cutting/milling.hpp"
#include "robomill/simulation/schedule.hpp"

namespace robomill::simulation {

struct DrillingCut;

namespace detail {

/// Ω(t) = Ω_0 (1 + a sin(r Ω_0 t)), or Ω_0 times a schedule; the rotation is its integral from 0.
struct Spindle {
  double mean_rad_per_s = 0.0;
  double amplitude = 0.0;
  double ratio = 0.0;
  Profile schedule = {};
  [[nodiscard]] bool steady() const { return amplitude == 0.0 && schedule.empty(); }
  [[nodiscard]] double rotation(double time_s) const;  ///< [rad]
  [[nodiscard]] double speed(double time_s) const;     ///< [rad/s]
};

/// What a piece of edge at φ meets, a width of cut: against its motion t = (cos φ, -sin φ, 0), outward
/// r = (sin φ, cos φ, 0) and z of the tool frame.
struct Resistance {
  double tangential = 0.0, radial = 0.0, axial = 0.0;
};

/// A piece of a cutting edge: a tooth's slice, or a drill's lip. Force on the tool, chip thickness h:
/// F = -width (chip h + edge).
struct Element {
  double standing_rad = 0.0;  ///< its angle at rotation 0, in [0, 2π)
  double sine = 0.0, cosine = 1.0;
  double radius_m = 0.0;  ///< beyond the nominal, along the chip
  double width_m = 0.0;   ///< of cut
  int ring = 0;           ///< on whose surface it cuts: that of its slice
  Resistance chip;        ///< [N/m²]
  Resistance edge;        ///< [N/m]
};

/// A ring of the cutter's envelope within one range of angles: its chips are cut along
/// n = (lateral sin φ, lateral cos φ, -axial).
struct Ring {
  double entry_rad = 0.0, exit_rad = 0.0;  ///< entry in [0, 2π), exit less than a revolution after it
  bool whole_circle = false;               ///< in the cut at every angle
  double lateral = 1.0, axial = 0.0;       ///< sin κ, cos κ
  /// Half the envelope's curvatures, along t and along the profile: of marks that the feed leaves behind.
  double bend_around_per_m = 0.0, bend_along_per_m = 0.0;
};

/// Of coefficients that act against t, against the chip's direction n, and, axial, on the tool along the profile
/// (cos κ sin φ, cos κ cos φ, sin κ).
[[nodiscard]] Resistance resistance(const Ring& ring, double tangential, double radial, double axial);

/// A cut as the time step sees it, in the tool frame.
struct CutModel {
  int dimensions = 2;  ///< 2: a cylinder fed along x that moves in x and y; 3: any
  std::vector<Element> elements;
  std::vector<Ring> rings;
  int slices = 1;
  double radius_m = 0.0;
  double feed_m_per_s = 0.0;
  Profile feed;   ///< of feed_m_per_s; from 1 at time 0
  Profile depth;  ///< of the elements' width, ring by ring from the first; with points: every ring a slice
  Eigen::Vector3d feed_direction = Eigen::Vector3d::UnitX();
  cutting::ProcessDamping damping;
  Spindle spindle;
  int steps_per_revolution = 0;
  /// Appends an element. @param angle_rad  at rotation 0, any
  Element& add(double angle_rad, std::size_t ring);
};

/// How fine: time steps of a mean revolution, axial slices.
struct Resolution {
  int steps_per_revolution = 0;
  int slices = 1;
};

[[nodiscard]] CutModel milling_model(const cutting::Milling& milling, double spindle_speed_rad_per_s,
                                     double axial_depth_m, const Resolution& resolution);
[[nodiscard]] CutModel drilling_model(const DrillingCut& cut, int steps_per_revolution);

}  // namespace detail
}  // namespace robomill::simulation
