#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <string>

#include "robomill/base/random.hpp"
#include "robomill/base/units.hpp"
#include "robomill/cell/arm_modes.hpp"
#include "robomill/cell/files/cell_toml.hpp"
#include "robomill/jobs/stiffness.hpp"
#include "robomill/robot/collision.hpp"
#include "robomill/robot/joint_load.hpp"
#include "robomill/robot/pose.hpp"
#include "robomill/robot/stiffness.hpp"
#include "testing/support.hpp"

/// One set-up, described in frames that stand elsewhere, is the same physics.
namespace robomill::cell {
namespace cell_frames_test {

using std::numbers::pi;
using test::Folder;

Eigen::Isometry3d random_pose(Random& random, double reach_m) {
  const auto around = [&] { return random.uniform(-reach_m, reach_m); };
  const Eigen::Translation3d to(around(), around(), around());
  return to * Eigen::AngleAxisd(random.uniform(-pi, pi), Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(random.uniform(-1.4, 1.4), Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(random.uniform(-pi, pi), Eigen::Vector3d::UnitX());
}

std::string list(const Eigen::Vector3d& v, double unit) {
  return fmt::format("[{:.15g}, {:.15g}, {:.15g}]", v.x() / unit, v.y() / unit, v.z() / unit);
}

/// origin and rotation about x, about y, about z, R = Rz Ry Rx.
std::string pose(const char* origin, const char* rotation, const Eigen::Isometry3d& at) {
  const Eigen::Matrix3d& r = at.linear();
  const double y = std::asin(std::clamp(-r(2, 0), -1.0, 1.0));
  const Eigen::Vector3d turns(std::atan2(r(2, 1), r(2, 2)), y, std::atan2(r(1, 0), r(0, 0)));
  return fmt::format("{} = {}\n{} = {}\n", origin, list(at.translation(), units::mm), rotation,
                     list(turns, units::deg));
}

std::string rotation_of(const Eigen::Isometry3d& at) {
  const std::string both = pose("origin_mm", "rotation_deg", at);
  std::string rotation = both.substr(both.find('\n') + 1);
  rotation.pop_back();
  return rotation;
}

/// An arrangement, and how it is described.
struct Arrangement {
  Eigen::Isometry3d base = Eigen::Isometry3d::Identity(), workpiece = base, mount = base;
  double flange_mm = -170.0;  ///< where the last row says that the flange is
  double length_m = 0.2;
  Eigen::Vector3d center_m = {0.15, 0.04, 0.22};           ///< of the payload, in the flange frame
  Eigen::Isometry3d box = Eigen::Isometry3d::Identity();   ///< of a body of the spindle, in the flange frame
  Eigen::Isometry3d post = Eigen::Isometry3d::Identity();  ///< of a body of the cell, in B
};

std::string cell_text(const Arrangement& s) {
  return "[robot]\n" + pose("base_origin_mm", "base_rotation_deg", s.base) +
         fmt::format(R"(dh = [
 {{ a_mm = 350, alpha_deg = 90, d_mm = -815 }}, {{ a_mm = 850, alpha_deg = 0, d_mm = 0 }},
 {{ a_mm = 145, alpha_deg = 90, d_mm = 0, theta_offset_deg = -90 }}, {{ a_mm = 0, alpha_deg = -90, d_mm = -820 }},
 {{ a_mm = 0, alpha_deg = 90, d_mm = 0 }}, {{ a_mm = 0, alpha_deg = 180, d_mm = {:.15g}, theta_offset_deg = 180 }}]
joint_stiffness_n_m_per_rad = [1.5e6, 1.9e6, 1.25e6, 3.4e5, 2.9e5, 1.5e5]
joint_damping_n_m_s_per_rad = [760, 1278, 695, 104, 66, 32]
joint_rotor_inertia_kg_m2 = [55, 68, 53, 6.7, 5.6, 2.4]
links = [{{ mass_kg = 207, center_mm = [-150, 400, 0], inertia_kg_m2 = [10, 10, 10, 0, 0, 0] }},
 {{ mass_kg = 147, center_mm = [-425, 0, 0], inertia_kg_m2 = [14, 14, 14, 0, 0, 0] }},
 {{ mass_kg = 118, center_mm = [-40, 0, 60], inertia_kg_m2 = [4, 4, 4, 0, 0, 0] }},
 {{ mass_kg = 43, center_mm = [0, 300, 0], inertia_kg_m2 = [2, 2, 2, 0, 0, 0] }},
 {{ mass_kg = 14, center_mm = [0, 0, 0], inertia_kg_m2 = [0.3, 0.3, 0.3, 0, 0, 0] }}, {{ mass_kg = 1e-6 }}]
)",
                     s.flange_mm) +
         "[workpiece]\n" + pose("origin_mm", "rotation_deg", s.workpiece) +
         "[tool]\nmass_kg = 60\ncenter_mm = " + list(s.center_m, units::mm) +
         fmt::format("\nlength_mm = {:.15g}\n", s.length_m / units::mm) +
         pose("mount_origin_mm", "mount_rotation_deg", s.mount) +
         "[geometry]\nstickout_mm = 60\nclearance_mm = 1\nshank_diameter_mm = 10\nholder = [{ length_mm = 50, "
         "diameter_mm = 40 }]\n"
         "spindle = { box_from_mm = [-60, -60, 0], box_to_mm = [60, 60, 90], " +
         fmt::format("origin_mm = {}, ", list(s.box.translation(), units::mm)) + rotation_of(s.box) +
         " }\ncell = [{ name = \"post\", box_from_mm = [-50, -50, -50], box_to_mm = [50, 50, 50], " +
         fmt::format("origin_mm = {}, ", list(s.post.translation(), units::mm)) + rotation_of(s.post) + " }]\n";
}

/// What a set-up comes to, in the work frame.
struct Physics {
  Eigen::Vector3d tip_m, axis, deflection_m;
  Eigen::VectorXd torque_n_m, frequency_hz;
  Eigen::Matrix3cd receptance;
  double distance_m = 0.0;
};

Physics physics_of(const CellFile& cell, const Eigen::VectorXd& joints, const Eigen::Vector3d& force_in_work_n) {
  Physics out;
  const Eigen::Matrix3d to_base = cell.robot.workpiece.linear();
  const robot::ToolPose at = robot::tool_pose(cell.robot, robot::forward(cell.robot.arm, joints));
  out.tip_m = at.tip_m;
  out.axis = at.axis;
  const Eigen::Vector3d tip_m = robot::tip_point(cell.robot);
  const robot::Wrench wrench = {.force_n = to_base * force_in_work_n};
  out.deflection_m = to_base.transpose() *
                     robot::stiffness(cell.robot.arm, joints, tip_m).compliance.topLeftCorner<3, 3>() * wrench.force_n;
  const std::vector<robot::JointLoad> loads = robot::joint_loads(loaded_arm(cell), joints, tip_m, wrench);
  out.torque_n_m.resize(joints.size());
  for (std::size_t k = 0; k < loads.size(); ++k)
    out.torque_n_m(static_cast<Eigen::Index>(k)) = loads[k].torque().value();
  robot::Cell loaded = cell.robot;
  loaded.arm = loaded_arm(cell);
  const modal::ModalModel modes = arm_modes(loaded, joints);
  out.frequency_hz.resize(static_cast<Eigen::Index>(modes.modes.size()));
  out.receptance.setZero();
  const std::complex<double> s(0.0, 2.0 * pi * 15.0);
  for (std::size_t k = 0; k < modes.modes.size(); ++k) {
    const modal::Mode& mode = modes.modes[k];
    out.frequency_hz(static_cast<Eigen::Index>(k)) = mode.frequency_hz;
    const Eigen::Matrix3cd residue = mode.right * mode.left.transpose();
    out.receptance += residue / (s - modal::pole(mode)) + residue.conjugate() / (s - std::conj(modal::pole(mode)));
  }
  out.receptance = (to_base.transpose() * out.receptance * to_base).eval();
  robot::CellGeometry geometry = *cell.geometry;
  geometry.tool.edges = {{.height_m = 0.0, .radius_m = 5e-3}, {.height_m = 20e-3, .radius_m = 5e-3}};
  out.distance_m = robot::CollisionChecker(cell.robot, geometry).check(joints, 10.0).distance_m;
  return out;
}

void expect_same(const Physics& a, const Physics& b, int seed) {
  const auto near = [&](const auto& x, const auto& y, const char* what) {
    EXPECT_LE((x - y).norm(), 1e-7 * (1e-9 + x.norm())) << what << ", seed " << seed;
  };
  near(a.tip_m, b.tip_m, "tip");
  near(a.axis, b.axis, "axis");
  near(a.deflection_m, b.deflection_m, "deflection");
  near(a.torque_n_m, b.torque_n_m, "torques");
  near(a.frequency_hz, b.frequency_hz, "modes");
  near(a.receptance, b.receptance, "FRF");
  EXPECT_NEAR(a.distance_m, b.distance_m, 1e-6) << "seed " << seed;
}

// Weight pulls along -z of the base: a set-up that is turned about z and moved is the same. So is a flange that is said
// to stand elsewhere along its axis, with mount, payload and spindle moved back; and a mount that takes over a part of
// the tool's length.
TEST(CellFrames, OneSetUpInOtherFramesIsTheSamePhysics) {
  const Folder folder;
  Random random(11);
  const int seeds = test::seeds(100);
  for (int seed = 0; seed < seeds; ++seed) {
    Arrangement one;
    one.base = Eigen::Isometry3d(Eigen::AngleAxisd(pi, Eigen::Vector3d::UnitX()));
    one.workpiece = random_pose(random, 1.0);
    one.mount = random_pose(random, 0.2);
    one.length_m = random.uniform(0.1, 0.4);
    one.center_m = {random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2), random.uniform(0.0, 0.4)};
    one.box = random_pose(random, 0.1);
    one.post = random_pose(random, 1.0);
    one.post.translation() += Eigen::Vector3d(2.0, 0.0, 2.0);
    Arrangement other = one;
    const Eigen::Isometry3d moved =
        Eigen::Translation3d(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)) *
        Eigen::AngleAxisd(random.uniform(-pi, pi), Eigen::Vector3d::UnitZ());
    other.base = moved * one.base;
    other.workpiece = moved * one.workpiece;
    other.post = moved * one.post;
    const double further_m = random.uniform(-0.1, 0.1);
    other.flange_mm -= further_m / units::mm;  // z of the last row points against the flange's
    const Eigen::Translation3d back(0.0, 0.0, -further_m);
    other.mount = back * one.mount;
    other.center_m = back * one.center_m;
    other.box = back * one.box;
    const double shorter_m = random.uniform(0.0, 0.05);
    other.mount = other.mount * Eigen::Translation3d(0.0, 0.0, shorter_m);
    other.length_m -= shorter_m;
    Eigen::VectorXd joints(6);
    for (double& q : joints) q = random.uniform(-1.2, 1.2);
    joints(4) += joints(4) < 0.0 ? -0.3 : 0.3;
    const Eigen::Vector3d force_n(random.uniform(-300.0, 300.0), random.uniform(-300.0, 300.0), 200.0);
    const CellFile a = read_cell(folder.file("one.toml", cell_text(one)));
    const CellFile b = read_cell(folder.file("other.toml", cell_text(other)));
    expect_same(physics_of(a, joints, force_n), physics_of(b, joints, force_n), seed);
  }
}

// The payload hangs where it is said to hang, however the spindle is bolted on: the torque of joint k from its weight
// alone is z_k · (r × m g) about the joint, by forward kinematics of the flange.
TEST(CellFrames, APayloadHangsInTheFlangeFrame) {
  const Folder folder;
  Random random(5);
  for (int seed = 0; seed < test::seeds(100); ++seed) {
    Arrangement s;
    s.base = Eigen::Isometry3d(Eigen::AngleAxisd(pi, Eigen::Vector3d::UnitX()));
    s.mount = random_pose(random, 0.3);
    s.center_m = {random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2), random.uniform(0.0, 0.4)};
    const CellFile cell = read_cell(folder.file("cell.toml", cell_text(s)));
    Arrangement bare = s;
    bare.mount = Eigen::Isometry3d::Identity();
    const CellFile plain = read_cell(folder.file("plain.toml", cell_text(bare)));
    Eigen::VectorXd joints(6);
    for (double& q : joints) q = random.uniform(-1.2, 1.2);
    robot::Posture posture;
    posture.update(plain.robot.arm, joints);
    const Eigen::Vector3d center_m = posture.flange * s.center_m;
    const Eigen::Vector3d weight_n(0.0, 0.0, -60.0 * 9.80665);
    const auto gravity = [&](const robot::Arm& arm) {
      return robot::joint_loads(arm, joints, Eigen::Vector3d::Zero());
    };
    const auto with = gravity(loaded_arm(cell)), without = gravity(cell.robot.arm);
    for (Eigen::Index k = 0; k < 6; ++k) {
      const auto i = static_cast<std::size_t>(k);
      const Eigen::Vector3d lever_m = center_m - posture.origin_m.col(k);
      const double held = -posture.axis.col(k).dot(lever_m.cross(weight_n));
      EXPECT_NEAR(with[i].gravity - without[i].gravity, held, 1e-3) << "joint " << k + 1 << ", seed " << seed;
    }
  }
}

// Loads attack at a point that is given in the flange frame; the spindle on it is bolted on at an angle.
TEST(CellFrames, ThePointOfTheLoadsIsInTheFlangeFrame) {
  const Folder folder;
  Random random(9);
  for (int seed = 0; seed < 5; ++seed) {
    Arrangement s;
    s.base = Eigen::Isometry3d(Eigen::AngleAxisd(pi, Eigen::Vector3d::UnitX()));
    s.mount = random_pose(random, 0.2);
    const auto cell_path = folder.file("cell.toml", cell_text(s));
    Arrangement bare = s;
    bare.mount = Eigen::Isometry3d::Identity();
    const CellFile plain = read_cell(folder.file("plain.toml", cell_text(bare)));
    const Eigen::Vector3d point_m(random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2), random.uniform(0.1, 0.4));
    std::string loads = "q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg,fx_n,fy_n,fz_n,dx_mm,dy_mm,dz_mm\n";
    for (int i = 0; i < 40; ++i) {
      Eigen::VectorXd joints(6);
      for (double& q : joints) q = random.uniform(-1.2, 1.2);
      const Eigen::Vector3d force_n(random.uniform(-400.0, 400.0), random.uniform(-400.0, 400.0),
                                    random.uniform(-400.0, 400.0));
      const Eigen::Vector3d d =
          robot::loaded_posture(plain.robot.arm, joints, point_m, {.force_n = force_n}).displacement_m / units::mm;
      for (const double q : joints) loads += fmt::format("{:.12g},", q / units::deg);
      loads += fmt::format("{:.12g},{:.12g},{:.12g},{:.12g},{:.12g},{:.12g}\n", force_n.x(), force_n.y(), force_n.z(),
                           d.x(), d.y(), d.z());
    }
    const jobs::StiffnessResult found =
        jobs::run_stiffness({.loads = folder.file("loads.csv", loads), .cell = cell_path, .point_m = point_m});
    ASSERT_TRUE(found.converged());
    for (std::size_t k = 0; k < 6; ++k) {
      const double truth = plain.robot.arm.joints[k].stiffness;
      EXPECT_NEAR(found.found.joints[k].stiffness, truth, 1e-3 * truth) << "joint " << k + 1;
    }
  }
}

}  // namespace cell_frames_test
}  // namespace robomill::cell
