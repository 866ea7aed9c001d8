#include "robomill/simulation/posture_model.hpp"

#include <algorithm>
#include <cmath>

#include "robomill/base/units.hpp"
#include "robomill/cutting/polynomial.hpp"

namespace robomill::simulation::detail {
namespace {

/// Half the profile's curvature at a height.
double bend_along(const cutting::Profile& profile, double height_m) {
  for (const cutting::Profile::Piece& piece : profile.pieces()) {
    const bool within = height_m > piece.first.height_m && height_m < piece.last.height_m;
    if (within && piece.arc_radius_m > 0.0) return 0.5 / piece.arc_radius_m;
  }
  return 0.0;
}

/// As many rings as it takes: where the angles nearly close the circle, the surface at entry would run into that at
/// exit, and two rings share them.
void add_rings(std::vector<Ring>& rings, Ring ring, const cutting::Arc& arc, double step_rad) {
  constexpr double margin_steps = 8.0;
  const double range = arc.exit_rad - arc.entry_rad;
  ring.entry_rad = arc.entry_rad;
  ring.exit_rad = arc.exit_rad;
  ring.whole_circle = range >= units::revolution * (1.0 - 1e-12);
  if (ring.whole_circle || range + margin_steps * step_rad <= units::revolution) {
    rings.push_back(ring);
    return;
  }
  const double middle = arc.entry_rad + 0.5 * range;
  ring.exit_rad = middle;
  rings.push_back(ring);
  ring.entry_rad = middle >= units::revolution ? middle - units::revolution : middle;
  ring.exit_rad = ring.entry_rad + 0.5 * range;
  rings.push_back(ring);
}

/// Of tooth j: the length that its edge forces are referred to, per width of cut.
double edge_per_width(const PostureCut& cut, int tooth, const cutting::EdgeSlice& slice) {
  const cutting::FlatEndMill& mill = cut.cutter.mill;
  if (!cutting::counts_edge_length(cut.coefficients.edge_measure, cut.cutter.kind)) return 1.0;
  if (mill.tooth_helix_rad.empty()) return slice.edge_length_per_width;
  return cutting::edge_length_per_width(
      mill, tooth, {.radius_m = slice.radius_m, .height_m = slice.height_m, .position_rad = slice.position_rad});
}

void add_tooth(CutModel& model, const PostureCut& cut, const cutting::EdgeSlice& slice, int tooth, std::size_t ring) {
  const cutting::FlatEndMill& mill = cut.cutter.mill;
  const cutting::MillingCoefficients& k = cut.coefficients;
  const Ring& on = model.rings[ring];
  const auto value = [&](const std::vector<double>& of) { return cutting::detail::polynomial(of, slice.position_rad); };
  Element& element = model.add(mill.standing_angle(tooth) - mill.lag_rad_per_m(tooth) * slice.height_m, ring);
  element.radius_m = mill.radius_deviation_m(tooth, slice.height_m) * on.lateral;
  element.width_m = slice.width_m;
  element.chip = resistance(on, value(k.tangential_n_per_m2), value(k.radial_n_per_m2), value(k.axial_n_per_m2));
  const double longer = edge_per_width(cut, tooth, slice);
  element.edge = resistance(on, longer * value(k.tangential_edge_n_per_m), longer * value(k.radial_edge_n_per_m),
                            longer * value(k.axial_edge_n_per_m));
}

}  // namespace

CutModel posture_model(const PostureCut& cut, int steps_per_revolution) {
  const cutting::FlatEndMill& mill = cut.cutter.mill;
  const cutting::Engagement& engagement = cut.engagement;
  const cutting::Profile profile(cut.cutter);
  CutModel model;
  model.dimensions = 3;
  model.slices = std::max(1, static_cast<int>(engagement.slices.size()));
  model.radius_m = profile.max_radius_m();
  model.feed_m_per_s =
      cut.motion.feed_per_tooth_m * mill.teeth * cut.motion.spindle_speed_rad_per_s / units::revolution;
  model.feed_direction = engagement.feed_from_tool.row(0).transpose();
  model.spindle.mean_rad_per_s = cut.motion.spindle_speed_rad_per_s;
  model.steps_per_revolution = steps_per_revolution;
  model.rings.reserve(2 * engagement.arcs.size());
  model.elements.reserve(2 * engagement.arcs.size() * static_cast<std::size_t>(mill.teeth));
  for (std::size_t i = 0; i < engagement.slices.size(); ++i) {
    const cutting::EdgeSlice& slice = engagement.slices[i];
    Ring ring;
    ring.lateral = std::sin(slice.position_rad);
    ring.axial = std::cos(slice.position_rad);
    if (slice.radius_m > 0.0) ring.bend_around_per_m = 0.5 * ring.lateral / slice.radius_m;
    ring.bend_along_per_m = bend_along(profile, slice.height_m);
    std::size_t added = model.rings.size();
    for (const cutting::Arc& arc : engagement.of(i)) {
      add_rings(model.rings, ring, arc, units::revolution / steps_per_revolution);
    }
    for (; added < model.rings.size(); ++added) {
      for (int tooth = 0; tooth < mill.teeth; ++tooth) add_tooth(model, cut, slice, tooth, added);
    }
  }
  return model;
}

double mean_arc_rad(const cutting::Engagement& engagement) {
  double angle = 0.0, width = 0.0;
  for (std::size_t i = 0; i < engagement.slices.size(); ++i) {
    for (const cutting::Arc& arc : engagement.of(i)) {
      angle += engagement.slices[i].width_m * (arc.exit_rad - arc.entry_rad);
      width += engagement.slices[i].width_m;
    }
  }
  return width > 0.0 ? angle / width : units::revolution;
}

}  // namespace robomill::simulation::detail
