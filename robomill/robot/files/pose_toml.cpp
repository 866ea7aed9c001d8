#include "robomill/robot/files/pose_toml.hpp"

#include <vector>

#include "robomill/base/units.hpp"

namespace robomill::robot {

std::optional<Eigen::Vector3d> read_vector(io::TomlFile& file, const std::string& key, const std::string& member,
                                           double factor) {
  std::vector<double> values;
  if (!file.numbers(key, member, factor, values)) return std::nullopt;
  if (values.size() != 3) throw file.reject(key, "must hold three numbers");
  return Eigen::Vector3d(values[0], values[1], values[2]);
}

Eigen::Isometry3d read_pose(io::TomlFile& file, const std::string& origin_key, const std::string& rotation_key) {
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  if (const auto origin_m = read_vector(file, origin_key, "origin_m", units::mm)) out.translation() = *origin_m;
  if (const auto angle_rad = read_vector(file, rotation_key, "rotation_rad", units::deg)) {
    out.linear() = (Eigen::AngleAxisd(angle_rad->z(), Eigen::Vector3d::UnitZ()) *
                    Eigen::AngleAxisd(angle_rad->y(), Eigen::Vector3d::UnitY()) *
                    Eigen::AngleAxisd(angle_rad->x(), Eigen::Vector3d::UnitX()))
                       .toRotationMatrix();
  }
  return out;
}

}  // namespace robomill::robot
