#pragma once
// Arms as their makers' published URDFs have them: origins and axes of the joints, typed from the files that
// data/cells/*.toml name, whose own rows are standard DH. Limits stand as the URDF has them, also where the cell takes
// others: known_arms_test.
#include <Eigen/Geometry>
#include <array>
#include <string>
#include <vector>

#include "testing/robot/arms.hpp"

namespace robomill::robot::testing {

/// <origin xyz rpy/> and <axis xyz/>.
struct UrdfJoint {
  Eigen::Vector3d xyz_m, axis;
  Eigen::Vector3d rpy_rad = Eigen::Vector3d::Zero();
};
inline Eigen::Isometry3d urdf_origin(const Eigen::Vector3d& xyz_m, const Eigen::Vector3d& rpy_rad) {
  return Eigen::Translation3d(xyz_m) * Eigen::AngleAxisd(rpy_rad.z(), Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(rpy_rad.y(), Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(rpy_rad.x(), Eigen::Vector3d::UnitX());
}

struct MakerArm {
  std::string name;
  Eigen::Isometry3d base = Eigen::Isometry3d::Identity();   ///< of the controller, `base`, in `base_link`
  Eigen::Isometry3d first = Eigen::Isometry3d::Identity();  ///< a fixed frame before the first joint
  std::vector<UrdfJoint> joints = {};
  Eigen::Isometry3d tool0 = Eigen::Isometry3d::Identity();  ///< after the last joint; its z points out of the flange
  double unit = pi / 180.0;                                 ///< of the limits, as the file writes them
  std::array<double, 6> low = {}, high = {}, velocity = {};
  std::array<double, 6> torque = {};  ///< N m; 0: the file has none

  /// tool0 in `base`.
  [[nodiscard]] Eigen::Isometry3d forward(const Eigen::Ref<const Eigen::VectorXd>& position) const {
    Eigen::Isometry3d out = base.inverse() * first;
    for (std::size_t i = 0; i < joints.size(); ++i) {
      const UrdfJoint& joint = joints[i];
      out = out * urdf_origin(joint.xyz_m, joint.rpy_rad) *
            Eigen::AngleAxisd(position(static_cast<Eigen::Index>(i)), joint.axis);
    }
    return out * tool0;
  }
};

inline std::vector<MakerArm> maker_arms() {
  const Eigen::Vector3d none(0, 0, 0), x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  const auto raised = [](double height_m) { return Eigen::Isometry3d(Eigen::Translation3d(0.0, 0.0, height_m)); };
  const Eigen::Isometry3d out_of_x = urdf_origin(none, {0, pi / 2, 0}),
                          out_of_x_up = urdf_origin(none, {pi, -pi / 2, 0});
  const auto ur = [&](const char* name, double d1, double a2, double a3, double d4, double d5, double d6) {
    MakerArm arm{.name = name};
    arm.base = arm.first = urdf_origin(none, {0, 0, pi});
    arm.joints = {{{0, 0, d1}, z},  {none, z, {pi / 2, 0, 0}},        {{a2, 0, 0}, z},
                  {{a3, 0, d4}, z}, {{0, -d5, 0}, z, {pi / 2, 0, 0}}, {{0, d6, 0}, z, {pi / 2, pi, pi}}};
    arm.tool0 = urdf_origin(none, {0, -pi / 2, -pi / 2}) * urdf_origin(none, {pi / 2, 0, pi / 2});
    arm.low = {-360, -360, -180, -360, -360, -360};
    arm.high = {360, 360, 180, 360, 360, 360};
    return arm;
  };
  std::vector<MakerArm> out;
  out.push_back({.name = "kuka-kr210-r2700",
                 .joints = {{{0, 0, 0.675}, -z},
                            {{0.350, 0, 0}, y},
                            {{1.150, 0, 0}, y},
                            {{0, 0, -0.041}, -x},
                            {{1.200, 0, 0}, y},
                            {{0.215, 0, 0}, -x}},
                 .tool0 = out_of_x,
                 .low = {-185, -140, -120, -350, -125, -350},
                 .high = {185, -5, 155, 350, 125, 350},
                 .velocity = {123, 115, 112, 179, 172, 219}});
  out.push_back(
      {.name = "kuka-kr120-r2500",
       .joints =
           {{{0, 0, 0.675}, -z}, {{0.35, 0, 0}, y}, {{1.150, 0, 0}, y}, {{1.0, 0, -0.041}, -x}, {none, y}, {none, -x}},
       .tool0 = urdf_origin({0.215, 0, 0}, none) * out_of_x,
       .low = {-185, -155, -130, -350, -130, -350},
       .high = {185, 35, 154, 350, 130, 350},
       .velocity = {156, 156, 156, 330, 330, 615}});
  out.push_back({.name = "abb-irb6640-185-280",
                 .joints = {{{0, 0, 0.780}, z},
                            {{0.320, 0, 0}, y},
                            {{0, 0, 1.075}, y},
                            {{0, 0, 0.2}, x},
                            {{1.392, 0, 0}, y},
                            {{0.2, 0, 0}, x}},
                 .tool0 = out_of_x,
                 .unit = 1.0,
                 .low = {-2.967, -1.134, -3.142, -5.236, -2.094, -6.283},
                 .high = {2.967, 1.4855, 1.222, 5.236, 2.094, 6.283},
                 .velocity = {1.7453, 1.5707, 1.5707, 2.9671, 2.4435, 3.3161}});
  out.push_back({.name = "abb-irb4600-60-205",
                 .joints = {{{0, 0, 0.495}, z},
                            {{0.175, 0, 0}, y},
                            {{0, 0, 0.9}, y},
                            {{0, 0, 0.175}, x},
                            {{0.960, 0, 0}, y},
                            {{0.135, 0, 0}, x}},
                 .tool0 = out_of_x,
                 .unit = 1.0,
                 .low = {-3.141, -1.570, -3.141, -6.981, -2.181, -6.981},
                 .high = {3.141, 2.617, 1.308, 6.981, 2.094, 6.981},
                 .velocity = {3.054, 3.054, 3.054, 4.363, 4.363, 6.283}});
  out.push_back({.name = "fanuc-r2000ic-165f",
                 .base = raised(0.670),
                 .joints = {{{0, 0, 0.670}, z},
                            {{0.312, 0, 0}, y},
                            {{0, 0, 1.075}, -y},
                            {{0, 0, 0.225}, -x},
                            {{1.280, 0, 0}, -y},
                            {{0.215, 0, 0}, -x}},
                 .tool0 = out_of_x_up,
                 .low = {-185, -60, -132, -360, -125, -360},
                 .high = {185, 76, 180, 360, 125, 360},
                 .velocity = {130, 115, 125, 180, 180, 260}});
  out.push_back({.name = "fanuc-m20ia",
                 .base = raised(0.525),
                 .joints = {{{0, 0, 0.525}, z},
                            {{0.150, 0, 0}, y},
                            {{0, 0, 0.790}, -y},
                            {{0, 0, 0.250}, -x},
                            {{0.835, 0, 0}, -y},
                            {{0.100, 0, 0}, -x}},
                 .tool0 = out_of_x_up,
                 .unit = 1.0,
                 .low = {-2.967060, -1.745329, -3.228859, -3.490658, -2.443461, -4.712389},
                 .high = {2.967060, 2.792527, 4.766843, 3.490658, 2.443461, 4.712389},
                 .velocity = {3.403392, 3.054326, 3.141593, 6.283185, 6.283185, 9.599311}});
  out.push_back({.name = "yaskawa-gp25",
                 .base = raised(0.505),
                 .joints = {{{0, 0, 0.505}, z},
                            {{0.150, 0, 0}, y},
                            {{0, 0, 0.760}, -y},
                            {{0, 0, 0.200}, -x},
                            {{0.795, 0, 0}, -y},
                            {none, -x}},
                 // its rpy = 3.1415926, −1.570796, 0 stands for π and −π/2
                 .tool0 = urdf_origin({0.100, 0, 0}, none) * out_of_x_up,
                 .low = {-180, -105, -86, -200, -155, -455},
                 .high = {180, 155, 160, 200, 150, 455},
                 .velocity = {210, 210, 265, 420, 420, 885},
                 .torque = {3087, 3087, 926.1, 88.2, 70.56, 50.31}});
  out.push_back(
      {.name = "staubli-rx160",
       .base = raised(0.550),
       .joints =
           {{{0, 0, 0.55}, z}, {{0.15, 0, 0}, y}, {{0, 0, 0.825}, y}, {none, z}, {{0, 0, 0.625}, y}, {{0, 0, 0.11}, z}},
       .tool0 = urdf_origin(none, {0, -pi / 2, 0}) * urdf_origin(none, {0, pi / 2, 0}),
       .low = {-160, -137.5, -150, -270, -105, -270},
       .high = {160, 137.5, 150, 270, 120, 270},
       .velocity = {200, 200, 255, 315, 360, 870},
       .torque = {692, 574, 242, 58, 29, 29}});
  out.push_back({.name = "staubli-tx2-90",
                 .base = raised(0.478),
                 .joints = {{{0, 0, 0.478}, z},
                            {{0.050, 0, 0}, y},
                            {{0, 0.05, 0.425}, y},
                            {none, z},
                            {{0, 0, 0.425}, y},
                            {{0, 0, 0.100}, z}},
                 .low = {-180, -130, -145, -270, -115, -270},
                 .high = {180, 147.5, 145, 270, 140, 270},
                 .velocity = {400, 400, 430, 540, 475, 760},
                 .torque = {318, 166, 76, 34, 29, 11}});
  out.push_back(ur("ur-10e", 0.1807, -0.6127, -0.57155, 0.17415, 0.11985, 0.11655));
  out.back().velocity = {120, 120, 180, 180, 180, 180};
  out.back().torque = {330, 330, 150, 56, 56, 56};
  out.push_back(ur("ur-5e", 0.1625, -0.425, -0.3922, 0.1333, 0.0997, 0.0996));
  out.back().velocity = {180, 180, 180, 180, 180, 180};
  out.back().torque = {150, 150, 150, 28, 28, 28};
  return out;
}

}  // namespace robomill::robot::testing
