#include "robomill/cutting/engagement.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "robomill/base/error.hpp"

namespace robomill::cutting {

void Cut::validate(const Cutter& cutter) const {
  cutter.validate();
  require_positive("axial_depth_m", axial_depth_m, "m");
  if (direction != MillingDirection::slot) {
    require_positive("radial_depth_m", radial_depth_m, "m");
    const double widest = 2.0 * Profile(cutter).max_radius_m();
    if (radial_depth_m > widest * (1.0 + 1e-12)) {
      throw InvalidInput("radial_depth_m", radial_depth_m, "m", "must be at most the cutter's diameter",
                         "A wider step leaves a ridge; a cut without a neighbouring pass is a slot");
    }
  }
  const auto check_angle = [](const char* field, double angle) {
    if (!(std::abs(angle) < 0.48 * std::numbers::pi)) {
      throw InvalidInput(field, angle, "rad", "must lie between -86 and 86 degrees");
    }
  };
  check_angle("lead_rad", lead_rad);
  check_angle("tilt_rad", tilt_rad);
  require_finite("curvature_along_feed_per_m", curvature_along_feed_per_m, "1/m");
  require_finite("curvature_across_feed_per_m", curvature_across_feed_per_m, "1/m");
  if (curvature_along_feed_per_m == 0.0 && curvature_across_feed_per_m == 0.0) return;
  const bool along = curvature_along_feed_per_m != 0.0;
  const char* field = along ? "curvature_along_feed_per_m" : "curvature_across_feed_per_m";
  const double curvature = along ? curvature_along_feed_per_m : curvature_across_feed_per_m;
  if (along && curvature_across_feed_per_m != 0.0) {
    throw InvalidInput(field, curvature, "1/m", "must be 0 where the surface is curved across the feed",
                       "The surface is taken for a cylinder nearby");
  }
  if (along && cutter.kind != CutterKind::ball_end) {
    throw InvalidInput(field, curvature, "1/m", "must be 0 except for a ball end",
                       "What another cutter sweeps along a circle has no closed form; let it cut a dexel workpiece");
  }
  const double reach =
      std::max(axial_depth_m, cutter.kind == CutterKind::ball_end ? 0.5 * cutter.mill.diameter_m : 0.0);
  if (!(curvature * reach > -0.999)) {
    throw InvalidInput(field, curvature, "1/m", "must leave the surface a hollow that the cutter fits into",
                       "Its radius must be greater than the cutter's and than the depth");
  }
  if (direction != MillingDirection::slot && !(std::abs(curvature) * radial_depth_m < 1.0)) {
    throw InvalidInput(field, curvature, "1/m", "must be less than one in a step-over");
  }
}

void EngagementOptions::validate() const {
  if (slices < 0 || slices > 10000) throw InvalidInput("slices", slices, "", "must lie between 0 and 10,000");
  if (rings_per_stretch < 0 || rings_per_stretch > 1000) {
    throw InvalidInput("rings_per_stretch", rings_per_stretch, "", "must lie between 0 and 1,000");
  }
}

Eigen::Matrix3d feed_from_tool(double lead_rad, double tilt_rad) {
  return (Eigen::AngleAxisd(tilt_rad, Eigen::Vector3d::UnitX()) * Eigen::AngleAxisd(lead_rad, Eigen::Vector3d::UnitY()))
      .toRotationMatrix();
}

double patch_area_m2(const Engagement& engagement) {
  double area = 0.0;
  for (std::size_t i = 0; i < engagement.slices.size(); ++i) {
    const EdgeSlice& slice = engagement.slices[i];
    for (const Arc& arc : engagement.of(i)) area += slice.radius_m * slice.width_m * (arc.exit_rad - arc.entry_rad);
  }
  return area;
}

double chip_area_m2(const Engagement& engagement) {
  const Eigen::RowVector3d feed = engagement.feed_from_tool.row(0);  // x_F in T
  double area = 0.0;
  for (std::size_t i = 0; i < engagement.slices.size(); ++i) {
    const EdgeSlice& slice = engagement.slices[i];
    const double sine = std::sin(slice.position_rad);
    const double cosine = std::cos(slice.position_rad);
    for (const Arc& arc : engagement.of(i)) {
      const double along = feed.x() * sine * (std::cos(arc.entry_rad) - std::cos(arc.exit_rad)) +
                           feed.y() * sine * (std::sin(arc.exit_rad) - std::sin(arc.entry_rad)) -
                           feed.z() * cosine * (arc.exit_rad - arc.entry_rad);
      area += slice.radius_m * slice.width_m * along;
    }
  }
  return area;
}

double greatest_chip_share(const Engagement& engagement) {
  const Eigen::RowVector3d feed = engagement.feed_from_tool.row(0);  // x_F in T
  const double steepest_rad = std::atan2(feed.x(), feed.y());        // where sin φ x + cos φ y is greatest
  double greatest = 0.0;
  for (std::size_t i = 0; i < engagement.slices.size(); ++i) {
    const double kappa = engagement.slices[i].position_rad;
    const auto share = [&](double phi) {
      return std::sin(kappa) * (std::sin(phi) * feed.x() + std::cos(phi) * feed.y()) - std::cos(kappa) * feed.z();
    };
    for (const Arc& arc : engagement.of(i)) {
      greatest = std::max({greatest, share(arc.entry_rad), share(arc.exit_rad)});
      const double ahead = std::remainder(steepest_rad - arc.entry_rad, 2.0 * std::numbers::pi);
      const double into = ahead < 0.0 ? ahead + 2.0 * std::numbers::pi : ahead;
      if (into < arc.exit_rad - arc.entry_rad) greatest = std::max(greatest, share(steepest_rad));
    }
  }
  return greatest;
}

}  // namespace robomill::cutting
