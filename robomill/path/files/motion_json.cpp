#include "robomill/path/files/motion_json.hpp"

#include <array>
#include <cstddef>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/io/json.hpp"
#include "robomill/signal/files/bands_json.hpp"

namespace robomill::path {
namespace {

using signal::band_json;

/// A column a point; x, y and, of three rows, z.
io::Json places_json(const Eigen::Ref<const Eigen::MatrixXd>& places_m) {
  constexpr std::array<const char*, 3> keys = {"x_mm", "y_mm", "z_mm"};
  io::Json json = io::Json::object();
  for (Eigen::Index i = 0; i < places_m.rows(); ++i) {
    json[keys.at(static_cast<std::size_t>(i))] = io::numbers(places_m.row(i).transpose() / units::mm);
  }
  return json;
}

io::Json joint_json(const JointMotion& joint) {
  const double unit = joint.prismatic ? units::mm : units::deg;
  const bool tracked = joint.tracking_error.low.size() > 0;
  return {{"unit", joint.prismatic ? "mm" : "deg"},
          {"velocity", band_json(joint.velocity, unit)},
          {"acceleration", band_json(joint.acceleration, unit)},
          {"jerk", band_json(joint.jerk, unit)},
          {"tracking_error", tracked ? band_json(joint.tracking_error, unit) : io::Json()}};
}

io::Json corner_json(const ProgramCorner& corner) {
  return {{"block", corner.block + 1},
          {"line", corner.line},
          {"turn_deg", io::number(corner.turn_rad / units::deg)},
          {"radius_mm", io::number(corner.radius_m / units::mm)},
          {"program", places_json(corner.vertices_m)}};
}

io::Json motion_json(const Motion& motion) {
  io::Json json = {{"run_s", io::number(motion.run_s)},
                   {"tip_speed_mm_per_s", band_json(motion.tip_speed_m_per_s, units::mm)},
                   {"axis_speed_deg_per_s", band_json(motion.axis_speed_rad_per_s, units::deg)}};
  json["joints"] = io::Json::array();
  for (const JointMotion& joint : motion.joints) json["joints"].push_back(joint_json(joint));
  json["tip"] = places_json(motion.tip_m);
  json["tip"]["speed_mm_per_s"] = io::numbers(motion.tip_speed_at_m_per_s / units::mm);
  json["corner_paths"] = io::Json::array();
  for (const Eigen::Matrix2Xd& way : motion.corner_paths_m) json["corner_paths"].push_back(places_json(way));
  return json;
}

}  // namespace

std::string motion_json(const ProgramOutline& outline, const std::vector<Motion>& motions) {
  io::Json json = {{"program", places_json(outline.path_m)}};
  json["corners"] = io::Json::array();
  for (const ProgramCorner& corner : outline.corners) json["corners"].push_back(corner_json(corner));
  json["motions"] = io::Json::array();
  for (const Motion& motion : motions) {
    if (motion.corner_paths_m.size() != outline.corners.size()) {
      throw InvalidInput("motions.corner_paths_m", "must hold one path for each corner of the outline");
    }
    json["motions"].push_back(motion_json(motion));
  }
  return io::dump(json);
}

}  // namespace robomill::path
