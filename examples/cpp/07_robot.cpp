// How far a milling force bends a robot's arm: a KUKA KR 210 with its joints' stiffness.
#include <robomill/base/units.hpp>
#include <robomill/robot/arm.hpp>
#include <robomill/robot/stiffness.hpp>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>

using namespace robomill;

int main() {
  constexpr double deg = units::deg;
  robot::Arm arm = robot::arm_from_dh({{0.350, -90 * deg, 0.4494, 0.0},
                                       {1.150, 0.0, 0.0, -90 * deg},
                                       {0.041, -90 * deg, 0.0, 180 * deg},
                                       {0.0, 90 * deg, -1.200, 0.0},
                                       {0.0, -90 * deg, 0.0, 0.0},
                                       {0.0, 180 * deg, -0.420, 180 * deg}},
                                      Eigen::Isometry3d(Eigen::Translation3d(0.0, 0.0, 0.2256)));
  constexpr std::array stiffness_n_m_per_rad = {2.2072e6, 3.37672e6, 2.77569e6, 2.35016e6, 2.15746e6, 0.467056e6};
  for (std::size_t i = 0; i < stiffness_n_m_per_rad.size(); ++i) arm.joints[i].stiffness = stiffness_n_m_per_rad[i];

  const Eigen::Vector<double, 6> position_rad = Eigen::Vector<double, 6>(10, 20, 25, -30, 60, 15) * deg;
  const Eigen::Vector3d tip_m(0.0, 0.0, 0.25);  // of the tool, in the flange's frame
  const Eigen::Vector3d at_m = robot::forward(arm, position_rad) * tip_m;
  std::printf("tip at (%.1f, %.1f, %.1f) mm\n", at_m.x() / units::mm, at_m.y() / units::mm, at_m.z() / units::mm);

  const robot::Stiffness stiffness = robot::stiffness(arm, position_rad, tip_m);
  const robot::PrincipalStiffness principal = robot::principal_stiffness(stiffness.compliance);
  std::printf("stiffness there: %.2f N/um the softest way, %.2f N/um the stiffest\n",
              principal.stiffness_n_per_m.x() * units::um, principal.stiffness_n_per_m.z() * units::um);

  const robot::Wrench cut{.force_n = {120.0, -160.0, 60.0}};
  const robot::LoadedPosture loaded = robot::loaded_posture(arm, position_rad, tip_m, cut);
  const Eigen::Vector3d moved_m = loaded.displacement_m;
  std::printf("%.0f N move it by (%.1f, %.1f, %.1f) um\n", cut.force_n.norm(), moved_m.x() / units::um,
              moved_m.y() / units::um, moved_m.z() / units::um);

  // The force's work is what the joints' springs take up: F d = sum of torque^2 / stiffness.
  const Eigen::Vector<double, 6> torque_n_m =
      robot::jacobian(arm, position_rad, tip_m).topRows<3>().transpose() * cut.force_n;
  double springs_j = 0.0;
  for (Eigen::Index i = 0; i < 6; ++i)
    springs_j += torque_n_m(i) * torque_n_m(i) / stiffness_n_m_per_rad[static_cast<std::size_t>(i)];
  const double work_j = cut.force_n.dot(moved_m);
  std::printf("force times way %.4f J, in the joints' springs %.4f J\n", work_j, springs_j);
  return loaded.status == robot::LoadedPosture::Status::converged && std::abs(work_j / springs_j - 1.0) < 1e-2 ? 0 : 1;
}
