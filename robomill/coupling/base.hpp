#pragma once
#include <Eigen/Core>
#include <string>
#include <vector>

#include "robomill/coupling/assembly.hpp"

/// What a tool stands on.
namespace robomill::coupling::detail {

/// Receptances of the holder's mouth, one a frequency: of its segments on the wall, of its measured FRFs, or zero for
/// the wall itself. A plane's are (u, θ) for (f, m); θ of y is -(rotation about x), so that θ = ∂u/∂z in both.
struct Base {
  std::vector<Eigen::Matrix2cd> x, y;    ///< of each plane
  std::vector<Eigen::Matrix2cd> xy, yx;  ///< of one plane for loads in the other; empty: none
  bool measured = false;
  std::vector<double> suspect_hz = {};
  std::vector<std::string> notes = {};
};

/// @throws InvalidInput as tip_frfs
[[nodiscard]] Base base_receptances(const Holder& holder, const Eigen::VectorXd& frequency_hz);

/// Where lines stand in another axis: lines are the same where they differ by no more than 1e-5 of themselves.
/// @param whose  "the measured holder"
/// @throws InvalidInput if one is outside of `axis_hz` or none of its lines, naming both steps
[[nodiscard]] std::vector<Eigen::Index> lines_in(const Eigen::VectorXd& axis_hz, const Eigen::VectorXd& wanted_hz,
                                                 const std::string& whose);

/// One matrix element of a plane by name: row and column 0 for u and f, 1 for θ and m. The second axis is the plane of
/// the load.
[[nodiscard]] modal::FrfName element_name(modal::Axis plane, int row, modal::Axis load_plane, int column, int point = 0,
                                          int load_point = 0);
/// What it is to be multiplied by: -1 where one of both, and not both, is a rotation about x or its moment.
[[nodiscard]] double element_sign(modal::Axis plane, int row, modal::Axis load_plane, int column);

/// Frequencies at which a driving-point receptance creates energy: Im H > 0 by more than three times its noise, which
/// is its deviation or, where that is not known, the scatter between neighbouring lines.
[[nodiscard]] std::vector<double> suspect_lines(const modal::Frf& frf, const Eigen::VectorXd& frequency_hz);

}  // namespace robomill::coupling::detail
