#include "robomill/robot/files/pose_toml.hpp"

namespace robomill::robot {

Eigen::Isometry3d Placement::pose() const {
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  out.translation() = origin_m;
  out.linear() = (Eigen::AngleAxisd(rotation_rad.z(), Eigen::Vector3d::UnitZ()) *
                  Eigen::AngleAxisd(rotation_rad.y(), Eigen::Vector3d::UnitY()) *
                  Eigen::AngleAxisd(rotation_rad.x(), Eigen::Vector3d::UnitX()))
                     .toRotationMatrix();
  return out;
}

std::vector<io::Row<Placement>> placement_rows(const std::string& before, const std::string& of) {
  return {
      io::key(before + "origin_mm", &Placement::origin_m, "origin of " + of).entries(3),
      io::key(before + "rotation_deg", &Placement::rotation_rad, "angles about x, y and z of " + of + "; R = Rz Ry Rx")
          .entries(3)};
}

}  // namespace robomill::robot
