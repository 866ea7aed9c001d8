#include "robomill/cutting/engagement.hpp"

#include <Eigen/Geometry>
#include <cmath>

namespace robomill::cutting {

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

}  // namespace robomill::cutting
