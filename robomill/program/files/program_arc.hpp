#pragma once
#include <Eigen/Core>

namespace robomill::program {

/// A circular arc, or a helix about its axis, in W. Its radius runs evenly from the begin's to the end's, which differ
/// by what the program has rounded.
struct Arc {
  Eigen::Vector3d center_m = Eigen::Vector3d::Zero();  ///< in the plane of the begin
  Eigen::Vector3d towards = Eigen::Vector3d::UnitX();  ///< unit vector from the centre to the begin
  Eigen::Vector3d ahead = Eigen::Vector3d::UnitY();    ///< unit vector along the arc where it begins
  Eigen::Vector3d rise_m = Eigen::Vector3d::Zero();    ///< of the whole arc, along its axis
  double begin_radius_m = 0.0, end_radius_m = 0.0;
  double sweep_rad = 0.0;  ///< > 0; beyond 2π more than one turn

  /// c + r(s) (cos φ a + sin φ b) + s h with φ = s sweep, s in [0, 1].
  [[nodiscard]] Eigen::Vector3d at(double share) const;
  [[nodiscard]] double length_m() const;
  /// Number of equal chords that leave the arc by no more than the tolerance, and no chord above a quarter of a turn.
  /// Linear interpolation errs by at most Δφ²/8 max |p''|, and |p''| <= r + 2 |dr/dφ|.
  [[nodiscard]] double chords(double tolerance_m) const;
  /// By how much so many equal chords leave the arc, at most.
  [[nodiscard]] double deviation_m(double chords) const;

 private:
  /// The largest |p''| by the angle.
  [[nodiscard]] double bend_m() const;
};

/// By how much an arc's radius at its end may differ from that at its begin, as LinuxCNC's [LinuxCncGcode]: a program's
/// last digit, or a thousandth of the radius, but never half a millimetre.
[[nodiscard]] double arc_radius_error_m(double radius_m, bool inches);

/// The arc about an axis that turns counterclockwise seen against `normal`, with a rise along it. Where the ends have
/// the same place about the axis it is a whole turn.
/// @param center_m  anywhere on the axis
/// @param normal    unit vector
[[nodiscard]] Arc arc_about(const Eigen::Vector3d& center_m, const Eigen::Vector3d& normal,
                            const Eigen::Vector3d& begin_m, const Eigen::Vector3d& end_m);

}  // namespace robomill::program
