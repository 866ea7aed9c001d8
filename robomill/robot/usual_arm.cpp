#include "robomill/robot/usual_arm.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace robomill::robot {
namespace {

constexpr double long_reach_m = 1.3;

/// Links of next to nothing stand in for frames.
constexpr double least_mass_kg = 0.01;

struct Density {
  double lowest, highest;  ///< moving mass over the reach cubed [kg/m^3]
};

Density usual_density(double reach_m) {
  return reach_m >= long_reach_m ? Density{5.0, 150.0} : Density{5.0, 300.0};
}

std::vector<double> masses_of(const Arm& arm) {
  std::vector<double> out;
  for (const Joint& joint : arm.joints) {
    if (joint.link.mass_kg > least_mass_kg) out.push_back(joint.link.mass_kg);
  }
  return out;
}

void compare_inertias(const Arm& arm, double reach_m, std::vector<std::string>& out) {
  for (std::size_t k = 0; k < arm.joints.size(); ++k) {
    const Link& link = arm.joints[k].link;
    const double largest = link.inertia_kg_m2.diagonal().maxCoeff();
    if (link.mass_kg <= least_mass_kg || largest <= 0.0) continue;
    const double radius_m = std::sqrt(largest / link.mass_kg);
    if (radius_m >= 0.002 && radius_m <= reach_m) continue;
    out.push_back(fmt::format(
        "link {}: {:.6g} kg with a moment of inertia of {:.4g} kg m^2 has a radius of gyration of {:.4g} mm; 2 mm to "
        "the reach of {:.4g} mm is usual. Is it in {}?",
        k + 1, link.mass_kg, largest, 1e3 * radius_m, 1e3 * reach_m,
        radius_m > reach_m ? "kg mm^2, or the mass in t" : "t m^2, or the mass in g"));
  }
}

}  // namespace

double stretched_reach_m(const Arm& arm) {
  if (arm.joints.size() < 2) return 0.0;
  Posture posture;
  posture.update(arm, Eigen::VectorXd::Zero(arm.size()));
  const Eigen::Vector3d up = posture.axis.col(0);
  const Eigen::Vector3d first = posture.origin_m.col(1) - posture.origin_m.col(0);
  double reach_m = (first - up * up.dot(first)).norm();
  const Eigen::Index last = std::min<Eigen::Index>(arm.size(), 5) - 1;
  for (Eigen::Index k = 1; k < last; ++k) reach_m += (posture.origin_m.col(k + 1) - posture.origin_m.col(k)).norm();
  return reach_m;
}

std::vector<std::string> unusual_masses(const Arm& arm) {
  std::vector<std::string> out;
  const std::vector<double> masses = masses_of(arm);
  const bool slides = std::ranges::any_of(arm.joints, &Joint::prismatic);
  const double reach_m = stretched_reach_m(arm);
  if (masses.size() < 4 || slides || !(reach_m > 0.0)) return out;
  double sum_kg = 0.0;
  for (const double mass : masses) sum_kg += mass;
  const auto [lowest, highest] = std::ranges::minmax(masses);
  if (highest <= 1.001 * lowest) {
    out.push_back(fmt::format(
        "all links of the arm weigh {:.6g} kg; the links of an arm get lighter from base to flange. Such masses stand "
        "in for others: natural frequencies and torques that follow from them are wrong.",
        lowest));
  }
  const Density usual = usual_density(reach_m);
  const double cube = std::pow(reach_m, 3);
  const double density = sum_kg / cube;
  if (density < usual.lowest || density > usual.highest) {
    out.push_back(fmt::format(
        "the links of the arm weigh {:.6g} kg together; {:.0f} to {:.0f} kg is usual with a reach of {:.3g} "
        "m. Natural frequencies and torques that follow from them are wrong{}",
        sum_kg, usual.lowest * cube, usual.highest * cube, reach_m,
        density > 1e3 * usual.lowest     ? ". Are they in g?"
        : density < 1e-3 * usual.highest ? ". Are they in t?"
                                         : "."));
  }
  compare_inertias(arm, reach_m, out);
  return out;
}

std::vector<std::string> unusual_displacements(const std::vector<Load>& loads) {
  std::vector<std::string> out;
  double work = 0.0, size = 0.0;
  std::vector<double> stiffness_n_per_m;
  std::size_t against = 0, forces = 0;
  for (const Load& load : loads) {
    const double force_n = load.wrench.force_n.norm(), moved_m = load.displacement_m.norm();
    if (!(force_n > 0.0) || !(moved_m > 0.0) || load.wrench.moment_n_m.norm() > 0.0) continue;
    const double along = load.wrench.force_n.dot(load.displacement_m);
    ++forces;
    if (along < 0.0) ++against;
    work += along;
    size += force_n * moved_m;
    stiffness_n_per_m.push_back(force_n / moved_m);
  }
  if (forces == 0) return out;
  if (2 * against > forces && work < -0.05 * size) {
    out.push_back(fmt::format(
        "in {} of {} loads the point moved against the force, which no spring does. Are forces of the robot "
        "on its surroundings given, or is an axis turned round? Forces count as they act on the robot.",
        against, forces));
  }
  std::ranges::nth_element(stiffness_n_per_m,
                           stiffness_n_per_m.begin() + static_cast<std::ptrdiff_t>(stiffness_n_per_m.size() / 2));
  const double n_per_um = 1e-6 * stiffness_n_per_m[stiffness_n_per_m.size() / 2];
  if (n_per_um < 0.02 || n_per_um > 50.0) {
    out.push_back(fmt::format(
        "force over displacement is {:.3g} N/um in the middle of the loads; 0.02 to 50 N/um is usual. {}", n_per_um,
        n_per_um < 0.02 ? "Are displacements in um, or forces in kN or kgf?"
                        : "Are displacements in m, or forces in mN?"));
  }
  return out;
}

}  // namespace robomill::robot
