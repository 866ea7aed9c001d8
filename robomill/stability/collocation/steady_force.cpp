#include "robomill/stability/collocation/steady_force.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

#include "robomill/base/units.hpp"
#include "robomill/cutting/chip.hpp"
#include "robomill/cutting/polynomial.hpp"

namespace robomill::stability::detail {
namespace {

using Complex = std::complex<double>;
using cutting::detail::polynomial;

/// What a ring answers a chip with, and its edge by itself: f_y + i f_x = across e^{iφ}, f_z = along.
struct RingForce {
  Complex across_per_chip = 0.0, across_edge = 0.0;
  double along_per_chip = 0.0, along_edge = 0.0;
};

RingForce ring_force(const cutting::EdgeSlice& slice, const cutting::MillingCoefficients& k, double edge_m) {
  const double kappa = slice.position_rad;
  const double sine = std::sin(kappa);
  const double cosine = std::cos(kappa);
  const auto across = [&](double tangential, double radial, double axial) {
    return Complex(axial * cosine - radial * sine, -tangential);
  };
  const double radial = slice.width_m * polynomial(k.radial_n_per_m2, kappa);
  const double axial = slice.width_m * polynomial(k.axial_n_per_m2, kappa);
  const double radial_edge = edge_m * polynomial(k.radial_edge_n_per_m, kappa);
  const double axial_edge = edge_m * polynomial(k.axial_edge_n_per_m, kappa);
  return {.across_per_chip = across(slice.width_m * polynomial(k.tangential_n_per_m2, kappa), radial, axial),
          .across_edge = across(edge_m * polynomial(k.tangential_edge_n_per_m, kappa), radial_edge, axial_edge),
          .along_per_chip = axial * sine + radial * cosine,
          .along_edge = axial_edge * sine + radial_edge * cosine};
}

/// With the chip c0 + Re(c1 e^{iφ}).
ForceStretch harmonics(const RingForce& ring, double c0, Complex c1) {
  ForceStretch out;
  // f_y + i f_x = steady + once e^{iφ} + twice e^{2iφ}: f_x is the real part of -i times the same.
  const Complex steady = 0.5 * ring.across_per_chip * std::conj(c1);
  const Complex once = ring.across_per_chip * c0 + ring.across_edge;
  const Complex twice = 0.5 * ring.across_per_chip * c1;
  const Complex minus_i(0.0, -1.0);
  out.mean << steady.imag(), steady.real(), ring.along_per_chip * c0 + ring.along_edge;
  out.first << minus_i * once, once, ring.along_per_chip * c1;
  out.second << minus_i * twice, twice, 0.0;
  return out;
}

/// Adds what cuts over [from, to] of rotation, φ = θ + turn, period by period.
void add(const ForceStretch& ring, const cutting::detail::ChipPiece& piece, double turn_rad,
         const Eigen::Matrix3d& axes, SteadyForce& out) {
  const double period = out.period_rad;
  const double from = piece.from_rad - turn_rad;
  const double to = piece.to_rad - turn_rad;
  for (double shift = std::floor(from / period) * period; shift < to; shift += period) {
    ForceStretch part;
    part.from_rad = std::max(from - shift, 0.0);
    part.to_rad = std::min(to - shift, period);
    if (!(part.to_rad > part.from_rad)) continue;
    const Complex turn = std::polar(1.0, turn_rad + shift);
    part.mean = axes * ring.mean;
    part.first = axes * (ring.first * turn);
    part.second = axes * (ring.second * (turn * turn));
    out.stretches.push_back(part);
  }
}

}  // namespace

SteadyForce steady_force(const cutting::Cutter& cutter, const cutting::Engagement& engagement,
                         const cutting::MillingCoefficients& coefficients, double feed_per_tooth_m,
                         const Eigen::Matrix3d& axes_from_tool) {
  const cutting::FlatEndMill& mill = cutter.mill;
  SteadyForce out;
  out.equal_teeth = mill.has_equal_teeth();
  out.period_rad = out.equal_teeth ? units::revolution / mill.teeth : units::revolution;
  const bool per_edge = cutting::counts_edge_length(coefficients.edge_measure, cutter.kind);
  const Eigen::RowVector3d feed = engagement.feed_from_tool.row(0);
  cutting::detail::ChipShare chips;
  for (std::size_t i = 0; i < engagement.slices.size(); ++i) {
    const cutting::EdgeSlice& slice = engagement.slices[i];
    const double sine = std::sin(slice.position_rad);
    const double cosine = std::cos(slice.position_rad);
    const cutting::detail::Forwards forwards = {.mean = -feed.z() * cosine,
                                                .amplitude = sine * std::hypot(feed.x(), feed.y()),
                                                .middle_rad = std::atan2(feed.x(), feed.y())};
    const Complex wave = std::polar(forwards.amplitude, -forwards.middle_rad);
    const cutting::Profile::Point point = {
        .radius_m = slice.radius_m, .height_m = slice.height_m, .position_rad = slice.position_rad};
    for (int j = 0; j < (out.equal_teeth ? 1 : mill.teeth); ++j) {
      double stretch = per_edge ? slice.edge_length_per_width : 1.0;
      if (per_edge && !mill.tooth_helix_rad.empty()) stretch = cutting::edge_length_per_width(mill, j, point);
      const RingForce ring = ring_force(slice, coefficients, slice.width_m * stretch);
      const double turn = mill.standing_angle(j) - mill.lag_rad_per_m(j) * slice.height_m;
      chips.set(mill, j, slice.height_m, sine, feed_per_tooth_m * mill.teeth);
      for (const cutting::Arc& arc : engagement.of(i)) {
        double missed_rad = 0.0;
        for (const cutting::detail::ChipPiece& piece : chips.pieces(arc, forwards, missed_rad)) {
          const ForceStretch force =
              harmonics(ring, piece.offset_m + piece.slope_m * forwards.mean, piece.slope_m * wave);
          add(force, piece, turn, axes_from_tool, out);
        }
      }
    }
  }
  return out;
}

}  // namespace robomill::stability::detail
