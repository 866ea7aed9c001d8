#include "examples/postures/ten_postures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "robomill/robot/arm.hpp"
#include "robomill/robot/inverse.hpp"
#include "robomill/stability/lobes.hpp"

namespace robomill::examples {
namespace {

constexpr double degree = std::numbers::pi / 180.0;
constexpr double deepest_m = 0.010;

/// The arm's rows, as the cell tells them; below them the base stands 225.6 mm high.
const std::array<robot::DhRow, 6> rows{{{.a_m = 0.350, .alpha_rad = -90 * degree, .d_m = 0.4494},
                                        {.a_m = 1.150, .theta_offset_rad = -90 * degree},
                                        {.a_m = 0.041, .alpha_rad = -90 * degree, .theta_offset_rad = 180 * degree},
                                        {.alpha_rad = 90 * degree, .d_m = -1.200},
                                        {.alpha_rad = -90 * degree},
                                        {.alpha_rad = 180 * degree, .d_m = -0.420, .theta_offset_rad = 180 * degree}}};

template <class Values>
std::string list(const Values& values, const char* format) {
  std::string out;
  for (const double value : values) out += (out.empty() ? "" : ", ") + fmt::format(fmt::runtime(format), value);
  return "[" + out + "]";
}

std::string joint_list(const robot::Arm& arm, const char* key, double robot::Joint::*member, double unit) {
  std::vector<double> values;
  for (const robot::Joint& joint : arm.joints) values.push_back(joint.*member / unit);
  return fmt::format("{} = {}\n", key, list(values, "{:.6g}"));
}

/// A link in the frame at the end of its row.
std::string link_toml(const robot::Link& link, const robot::DhRow& row) {
  const Eigen::Isometry3d to_row = robot::dh_link(row).inverse();
  const Eigen::Vector3d center_mm = 1e3 * (to_row * link.center_m);
  const Eigen::Matrix3d i = to_row.linear() * link.inertia_kg_m2 * to_row.linear().transpose();
  const std::array<double, 6> inertia{i(0, 0), i(1, 1), i(2, 2), i(0, 1), i(0, 2), i(1, 2)};
  return fmt::format("[[robot.links]]\nmass_kg = {:.6g}\ncenter_mm = {}\ninertia_kg_m2 = {}\n\n", link.mass_kg,
                     list(center_mm, "{:.9g}"), list(inertia, "{:.12g}"));
}

}  // namespace

const std::vector<Direction>& directions() {
  static const std::vector<Direction> out{{"x", {0, 1, 2}}, {"y", {0, 3, 4}}, {"z", {3, 5, 6}}, {"gamma", {7, 8, 9}}};
  return out;
}

std::vector<Eigen::VectorXd> joints_of_poses(const modal::testing::SimulatedArm& arm) {
  const robot::SphericalWristInverse inverse(arm.told().arm);
  Eigen::VectorXd near = Eigen::VectorXd::Zero(6);
  near << 0.0, 15.0 * degree, 15.0 * degree, 0.0, 60.0 * degree, 0.0;
  std::vector<Eigen::VectorXd> out;
  for (const TabulatedPose& pose : ten_poses) {
    robot::Cell cell = arm.told();
    cell.workpiece.linear() = Eigen::AngleAxisd(pose.alpha_deg * degree, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    const Eigen::Vector3d tip_m = 1e-3 * Eigen::Vector3d(pose.x_mm, pose.y_mm, pose.z_mm);
    const robot::ToolPose tool{.tip_m = cell.workpiece.inverse() * tip_m, .gamma_rad = pose.gamma_deg * degree};
    const robot::InverseSolutions ways = inverse.solve(robot::flange_pose(cell, tool), near);
    const Eigen::VectorXd* best = nullptr;
    std::vector<Eigen::VectorXd> inside;
    for (int k = 0; k < ways.count; ++k) {
      const Eigen::VectorXd joints = ways.solution[static_cast<std::size_t>(k)].position_rad;
      if (robot::within_limits(cell.arm, joints).inside) inside.push_back(joints);
    }
    for (const Eigen::VectorXd& joints : inside) {
      if (best == nullptr || (joints - near).norm() < (*best - near).norm()) best = &joints;
    }
    if (best == nullptr) throw std::runtime_error(fmt::format("posture {} is out of reach", out.size() + 1));
    near = *best;
    out.push_back(near);
  }
  return out;
}

std::string cell_toml(const modal::testing::SimulatedArm& arm, const std::vector<Eigen::VectorXd>& joints,
                      const std::string& drives) {
  const robot::Cell& cell = arm.told();
  std::string out =
      "# A KR 210-like arm with a spindle, simulated; masses, stiffness and damping as somebody may know them: up to\n"
      "# 20 % off. Written by simulate_postures.\n[robot]\nkind = \"serial\"\nbase_origin_mm = [0, 0, 225.6]\ndh = [\n";
  for (const robot::DhRow& row : rows) {
    out += fmt::format("  {{ a_mm = {:.6g}, alpha_deg = {:.6g}, d_mm = {:.6g}, theta_offset_deg = {:.6g} }},\n",
                       1e3 * row.a_m, row.alpha_rad / degree, 1e3 * row.d_m, row.theta_offset_rad / degree);
  }
  out += "]\n";
  out += joint_list(cell.arm, "joint_min_position_deg", &robot::Joint::min_position, degree);
  out += joint_list(cell.arm, "joint_max_position_deg", &robot::Joint::max_position, degree);
  out += joint_list(cell.arm, "joint_stiffness_n_m_per_rad", &robot::Joint::stiffness, 1.0);
  out += joint_list(cell.arm, "joint_damping_n_m_s_per_rad", &robot::Joint::damping, 1.0);
  out += joint_list(cell.arm, "joint_rotor_inertia_kg_m2", &robot::Joint::rotor_inertia, 1.0);
  out += drives + "\n# The last link holds the spindle.\n";
  for (std::size_t i = 0; i < rows.size(); ++i) out += link_toml(cell.arm.joints[i].link, rows[i]);
  const Eigen::Isometry3d& mount = arm.mount();
  const double turn = std::atan2(mount.linear()(2, 1), mount.linear()(1, 1));  // mounts turn about x alone
  out += fmt::format(
      "[tool]\nlength_mm = {:.17g}\nmount_origin_mm = {}\nmount_rotation_deg = [{:.17g}, 0, 0]\n\n"
      "[workpiece]\norigin_mm = [1270, 0, 776]\nrotation_deg = [0, 0, 90]\n",
      1e3 * cell.tool_length_m, list(Eigen::Vector3d(1e3 * mount.translation()), "{:.9g}"), turn / degree);
  for (std::size_t k = 0; k < joints.size(); ++k) {
    out += fmt::format("\n[[postures]]\njoints_deg = {}\nfrf = \"posture_{}.uff\"\n",
                       list(Eigen::VectorXd(joints[k] / degree), "{:.9g}"), k + 1);
  }
  return out;
}

std::string lobes_toml(const Eigen::VectorXd& joints) {
  return fmt::format(
      "[tool]\nteeth = 3\ndiameter_mm = 16\n\n[cut]\ndirection = \"up\"\nradial_depth_mm = 8\nfeed_per_tooth_mm = "
      "0.1\n\n"
      "[coefficients]\ntangential_n_per_mm2 = 800\nradial_n_per_mm2 = 250\n\n"
      "[dynamics]\ncell = \"cell.toml\"\njoints_deg = {}\n\n"
      "[lobes]\nspindle_speed_rpm = [3000, 15000]\naxial_depth_mm = [0, 5]\ngrid = [100, 50]\n",
      list(Eigen::VectorXd(joints / degree), "{:.9g}"));
}

std::vector<double> limit_curve(const modal::ModalModel& modes, const std::vector<double>& spindle_speed_rpm) {
  stability::LobesProblem problem;
  problem.milling.tool = {.teeth = 3, .diameter_m = 0.016};
  problem.milling.immersion = cutting::immersion(cutting::MillingDirection::up, 0.008, 0.016);
  problem.milling.coefficients = {.tangential_n_per_m2 = 800e6, .radial_n_per_m2 = 250e6};
  problem.milling.feed_per_tooth_m = 1e-4;
  problem.dynamics = modes;
  stability::LobesOptions options;
  options.axial_depth_m = {0.0, deepest_m};
  options.grid = {2, 100};
  options.tolerance = 1e-4;
  std::vector<double> speeds;
  speeds.reserve(spindle_speed_rpm.size());
  for (const double rpm : spindle_speed_rpm) speeds.push_back(rpm * std::numbers::pi / 30.0);
  std::vector<double> out;
  for (const stability::Limit& limit : stability::limit_depths(problem, options, speeds)) {
    const bool found = limit.status == stability::Limit::Status::found;
    out.push_back(found ? limit.axial_depth_m : std::numeric_limits<double>::infinity());
  }
  return out;
}

modal::ModalModel modes_between(const modal::ModalModel& modes, double low_hz, double high_hz) {
  modal::ModalModel out = modes;
  out.residuals.clear();
  std::erase_if(out.modes, [&](const modal::Mode& m) { return m.frequency_hz < low_hz || m.frequency_hz > high_hz; });
  return out;
}

double spread(const std::vector<std::vector<double>>& curves) {
  double sum = 0.0;
  int speeds = 0;
  for (std::size_t k = 0; k < curves.front().size(); ++k) {
    double least = std::numeric_limits<double>::infinity(), most = 0.0, mean = 0.0;
    for (const std::vector<double>& curve : curves) {
      least = std::min(least, curve[k]);
      most = std::max(most, curve[k]);
      mean += curve[k] / static_cast<double>(curves.size());
    }
    if (!std::isfinite(mean)) continue;
    sum += (most - least) / mean;
    ++speeds;
  }
  return speeds > 0 ? sum / speeds : 0.0;
}

}  // namespace robomill::examples
