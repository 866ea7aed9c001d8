#include "robomill/stability/collocation/mesh/edge_contacts.hpp"

#include <algorithm>
#include <cmath>

#include "robomill/base/units.hpp"
#include "robomill/cutting/chip.hpp"
#include "robomill/cutting/polynomial.hpp"

namespace robomill::stability::detail {
namespace {

RingStiffness stiffness_of(const cutting::EdgeSlice& slice, const cutting::MillingCoefficients& k) {
  const double kappa = slice.position_rad;
  const double radial = slice.width_m * cutting::detail::polynomial(k.radial_n_per_m2, kappa);
  const double axial = slice.width_m * cutting::detail::polynomial(k.axial_n_per_m2, kappa);
  RingStiffness ring;
  ring.sine = std::sin(kappa);
  ring.cosine = std::cos(kappa);
  ring.tangential = slice.width_m * cutting::detail::polynomial(k.tangential_n_per_m2, kappa);
  ring.outward = axial * ring.cosine - radial * ring.sine;
  ring.upward = axial * ring.sine + radial * ring.cosine;
  return ring;
}

}  // namespace

EdgeContacts edge_contacts(const cutting::Cutter& cutter, const cutting::Engagement& engagement,
                           const cutting::MillingCoefficients& coefficients, double feed_per_tooth_m) {
  const cutting::FlatEndMill& mill = cutter.mill;
  EdgeContacts out;
  out.equal_teeth = mill.has_equal_teeth();
  out.period_rad = out.equal_teeth ? units::revolution / mill.teeth : units::revolution;
  out.teeth = out.equal_teeth ? 1 : mill.teeth;
  if (!engagement.slices.empty()) {
    const auto [low, high] = std::ranges::minmax_element(engagement.slices, {}, &cutting::EdgeSlice::position_rad);
    coefficients.validate(low->position_rad, high->position_rad);
  }
  const Eigen::RowVector3d feed = engagement.feed_from_tool.row(0);
  cutting::detail::ChipShare chips;
  for (std::size_t i = 0; i < engagement.slices.size(); ++i) {
    const cutting::EdgeSlice& slice = engagement.slices[i];
    const RingStiffness ring = stiffness_of(slice, coefficients);
    out.rings.push_back(ring);
    const cutting::detail::Forwards forwards = {.mean = -feed.z() * ring.cosine,
                                                .amplitude = ring.sine * std::hypot(feed.x(), feed.y()),
                                                .middle_rad = std::atan2(feed.x(), feed.y())};
    for (int j = 0; j < out.teeth; ++j) {
      const double turn = mill.standing_angle(j) - mill.lag_rad_per_m(j) * slice.height_m;
      if (!out.equal_teeth) chips.set(mill, j, slice.height_m, ring.sine, feed_per_tooth_m * mill.teeth);
      for (const cutting::Arc& arc : engagement.of(i)) {
        if (out.equal_teeth) {
          out.contacts.push_back({arc.entry_rad - turn, arc.exit_rad - turn, turn, out.period_rad, i});
          continue;
        }
        double missed_rad = 0.0;
        for (const cutting::detail::ChipPiece& piece : chips.pieces(arc, forwards, missed_rad)) {
          out.contacts.push_back({piece.from_rad - turn, piece.to_rad - turn, turn, piece.delay_rad, i});
        }
      }
    }
  }
  return out;
}

}  // namespace robomill::stability::detail
