#include <benchmark/benchmark.h>

#include <kdl/chain.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainiksolverpos_lma.hpp>
#include <kdl/chainjnttojacsolver.hpp>
#include <vector>

#include "robomill/robot/arm.hpp"
#include "robomill/robot/collision.hpp"
#include "robomill/robot/dynamics.hpp"
#include "robomill/robot/hybrid.hpp"
#include "robomill/robot/inverse.hpp"
#include "robomill/robot/kinematics/choose.hpp"
#include "robomill/robot/redundancy.hpp"
#include "robomill/robot/serial_kinematics.hpp"
#include "robomill/robot/stiffness.hpp"
#include "testing/robot/arms.hpp"
#include "testing/robot/cells.hpp"
#include "testing/robot/kdl.hpp"
#include "testing/robot/kinematics.hpp"

namespace {

using namespace robomill;
using namespace robomill::robot;

std::vector<robot::Position6> positions(int count) {
  Random random(1);
  std::vector<robot::Position6> out;
  for (int k = 0; k < count; ++k) out.emplace_back(testing::random_position(random, 6));
  return out;
}

void inverse_all_solutions(benchmark::State& state) {
  const Arm arm = testing::kr210();
  const SphericalWristInverse inverse(arm);
  std::vector<Eigen::Isometry3d> poses;
  for (const robot::Position6& position : positions(1000)) {
    const Eigen::Isometry3d pose = forward(arm, position);
    if (inverse.solve(pose).count == 8) poses.push_back(pose);
  }
  std::size_t k = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(inverse.solve(poses[k]));
    k = k + 1 == poses.size() ? 0 : k + 1;
  }
}
BENCHMARK(inverse_all_solutions);

/// The peer that searches: one solution, from a start 0.1 rad away in each joint. `reached`: the share of poses that it
/// found to its default of 1e-5.
void inverse_by_kdl(benchmark::State& state) {
  const Arm arm = testing::kr210();
  const KDL::Chain chain = testing::kdl_chain(arm);
  KDL::ChainIkSolverPos_LMA peer(chain);
  const auto at = positions(1000);
  std::vector<KDL::Frame> poses(at.size());
  std::vector<KDL::JntArray> starts(at.size(), KDL::JntArray(6));
  for (std::size_t k = 0; k < at.size(); ++k) {
    KDL::JntArray joints(6);
    joints.data = at[k];
    KDL::ChainFkSolverPos_recursive(chain).JntToCart(joints, poses[k]);
    starts[k].data = at[k].array() + 0.1;
  }
  KDL::JntArray found(6);
  std::size_t k = 0, reached = 0, asked = 0;
  for (auto _ : state) {
    reached += peer.CartToJnt(starts[k], poses[k], found) >= 0 ? 1 : 0;
    ++asked;
    k = k + 1 == at.size() ? 0 : k + 1;
  }
  state.counters["reached"] = static_cast<double>(reached) / static_cast<double>(asked);
}
BENCHMARK(inverse_by_kdl);

void choose_of_eight(benchmark::State& state) {
  const Arm arm = testing::with_limits(testing::kr210());
  const robot::Position6 previous = testing::kr210_posture();
  const InverseSolutions solutions = SphericalWristInverse(arm).solve(forward(arm, previous));
  for (auto _ : state) benchmark::DoNotOptimize(choose(arm, solutions, previous));
}
BENCHMARK(choose_of_eight);

void forward_and_jacobian(benchmark::State& state) {
  const Arm arm = testing::kr210();
  const auto at = positions(1000);
  const Eigen::Vector3d tip(0.0, 0.0, 0.3);
  Posture posture;
  Eigen::Matrix<double, 6, Eigen::Dynamic> jac(6, 6);
  std::size_t k = 0;
  for (auto _ : state) {
    posture.update(arm, at[k]);
    posture.jacobian(arm, posture.flange * tip, jac);
    benchmark::DoNotOptimize(jac.data());
    k = k + 1 == at.size() ? 0 : k + 1;
  }
}
BENCHMARK(forward_and_jacobian);

void forward_and_jacobian_by_kdl(benchmark::State& state) {
  const KDL::Chain chain = testing::kdl_chain(testing::kr210());
  KDL::ChainFkSolverPos_recursive place(chain);
  KDL::ChainJntToJacSolver slope(chain);
  const auto at = positions(1000);
  KDL::JntArray joints(6);
  KDL::Frame frame;
  KDL::Jacobian jac(6);
  std::size_t k = 0;
  for (auto _ : state) {
    joints.data = at[k];
    place.JntToCart(joints, frame);
    slope.JntToJac(joints, jac);
    jac.changeRefPoint(frame.M * KDL::Vector(0.0, 0.0, 0.3));
    benchmark::DoNotOptimize(jac.data.data());
    k = k + 1 == at.size() ? 0 : k + 1;
  }
}
BENCHMARK(forward_and_jacobian_by_kdl);

void compliance_under_load(benchmark::State& state) {
  const Arm arm = testing::kr210();
  const Wrench wrench{.force_n = {100.0, -200.0, 300.0}};
  for (auto _ : state) {
    benchmark::DoNotOptimize(stiffness(arm, testing::kr210_posture(), Eigen::Vector3d(0.0, 0.0, 0.3), wrench));
  }
}
BENCHMARK(compliance_under_load);

void equilibrium_under_load(benchmark::State& state) {
  const Arm arm = testing::kr210();
  const Wrench wrench{.force_n = {100.0, -200.0, 300.0}};
  for (auto _ : state) {
    benchmark::DoNotOptimize(loaded_posture(arm, testing::kr210_posture(), Eigen::Vector3d(0.0, 0.0, 0.3), wrench));
  }
}
BENCHMARK(equilibrium_under_load);

void modes_at_the_tool(benchmark::State& state) {
  Arm arm = testing::kr210();
  for (Joint& joint : arm.joints) {
    joint.damping = 500.0;
    joint.rotor_inertia = 5.0;
    joint.link.mass_kg = 100.0;
    joint.link.center_m = Eigen::Vector3d(0.1, 0.2, 0.0);
  }
  for (auto _ : state) {
    benchmark::DoNotOptimize(tool_modes(arm, testing::kr210_posture(), Eigen::Vector3d(0.0, 0.0, 0.3)));
  }
}
BENCHMARK(modes_at_the_tool);

void redundancy_of_72(benchmark::State& state) {
  Cell cell{.arm = testing::with_limits(testing::kr210()), .tool_length_m = 0.25};
  cell.workpiece = Eigen::Translation3d(1.6, 0.2, 0.7);
  const SphericalWristInverse inverse(cell.arm);
  const RedundancyOptions options{.force_n = {300.0, -200.0, 100.0}};
  for (auto _ : state) benchmark::DoNotOptimize(redundancy(cell, inverse, {}, options));
}
BENCHMARK(redundancy_of_72)->Unit(benchmark::kMicrosecond);

/// A smooth way of 1,000 steps around a posture.
std::vector<ToolJet> way_of(const Kinematics& kinematics, const robot::Position6& middle) {
  Random random(5);
  const testing::RandomWay way(random, kinematics.forward(middle), 0.03, 0.05, 0.05);
  std::vector<ToolJet> out;
  for (int k = 0; k < 1000; ++k) out.push_back(way.jet(0.001 * k));
  return out;
}

void follow_poses(benchmark::State& state, const Kinematics& kinematics, const robot::Position6& middle) {
  const std::vector<ToolJet> way = way_of(kinematics, middle);
  robot::Position6 position = middle;
  std::size_t k = 0;
  if (kinematics.follow(ToolPose{way[0].tip_m.col(0), way[0].axis.col(0), way[0].gamma_rad(0)}, middle, position)
          .status != Reach::Status::found) {
    state.SkipWithError("the way begins out of reach");
  }
  for (auto _ : state) {
    const ToolPose pose{way[k].tip_m.col(0), way[k].axis.col(0), way[k].gamma_rad(0)};
    benchmark::DoNotOptimize(kinematics.follow(pose, position, position));
    k = k + 1 == way.size() ? 0 : k + 1;
  }
}

void follow_jets(benchmark::State& state, const Kinematics& kinematics, const robot::Position6& middle) {
  const std::vector<ToolJet> way = way_of(kinematics, middle);
  JointJet joints;
  joints.col(0) = middle;
  std::size_t k = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(kinematics.follow(way[k], joints.col(0), joints));
    k = k + 1 == way.size() ? 0 : k + 1;
  }
}

const SerialKinematics spherical_wrist({.arm = testing::with_limits(testing::kr210()), .tool_length_m = 0.25});
const SerialKinematics offset_wrist({.arm = testing::ur5e(), .tool_length_m = 0.25});
const HybridKinematics hybrid({});
const robot::Position6 bent = (robot::Position6() << 0.3, -1.2, 1.4, -0.8, 1.1, 0.2).finished();
const robot::Position6 raised = (robot::Position6() << 0.7, 0.75, 0.72, 0.0, 0.0, 0.0).finished();

BENCHMARK_CAPTURE(follow_poses, spherical_wrist, spherical_wrist, testing::kr210_posture());
BENCHMARK_CAPTURE(follow_jets, spherical_wrist, spherical_wrist, testing::kr210_posture());
BENCHMARK_CAPTURE(follow_poses, offset_wrist, offset_wrist, bent);
BENCHMARK_CAPTURE(follow_jets, offset_wrist, offset_wrist, bent);
BENCHMARK_CAPTURE(follow_poses, hybrid, hybrid, raised);
BENCHMARK_CAPTURE(follow_jets, hybrid, hybrid, raised);

/// A ball of 82,000 triangles before an arm whose links have 20,000 each.
struct DetailedCell {
  Cell cell = testing::kr210_cell();
  CellGeometry geometry = testing::block_on_table(cell);
  DetailedCell() {
    geometry.part = {{"ball", testing::sphere({0.0, 0.0, 0.0}, 0.12, 6)}};
    for (LinkBody& body : geometry.arm) {
      const Eigen::Vector3d to_m = body.capsule->to_m;
      body.mesh = testing::sphere(to_m / 2.0, 1.0, 5);
      for (Eigen::Vector3d& vertex : body.mesh.vertices_m) {
        const Eigen::Vector3d out = vertex - to_m / 2.0;
        vertex = to_m / 2.0 + 0.1 * out + to_m / 2.0 * to_m.normalized().dot(out);
      }
      body.capsule.reset();
    }
  }
};

/// The tool's tip on a line out of the ball's middle, its axis tilted from that line.
void check_collisions(benchmark::State& state, double out_m, double tilt_rad, double reach_m) {
  const DetailedCell detailed;
  const CollisionChecker checker(detailed.cell, detailed.geometry);
  std::vector<Eigen::VectorXd> at;
  Random random(3);
  while (at.size() < 200) {
    const Eigen::Vector3d out = (Eigen::Vector3d(0, 0, 3) + testing::random_vector(random)).normalized();
    const Eigen::Vector3d aside = out.cross(testing::random_vector(random)).normalized();
    const ToolPose pose{.tip_m = out_m * out, .axis = Eigen::AngleAxisd(tilt_rad, aside) * out};
    const Eigen::VectorXd position = testing::position_at(detailed.cell, pose);
    if (position.size() > 0) at.push_back(position);
  }
  std::size_t k = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(checker.check(at[k], reach_m));
    k = k + 1 == at.size() ? 0 : k + 1;
  }
}
BENCHMARK_CAPTURE(check_collisions, far, 0.4, 0.0, 0.0);
BENCHMARK_CAPTURE(check_collisions, on_the_part, 0.12, 0.0, 0.0);
BENCHMARK_CAPTURE(check_collisions, nearest_within_100_mm, 0.12, 0.0, 0.1);
BENCHMARK_CAPTURE(check_collisions, gouging_by_1_mm, 0.12, 0.3, 0.0);

void checker_of_190000_triangles(benchmark::State& state) {
  const DetailedCell detailed;
  for (auto _ : state) benchmark::DoNotOptimize(CollisionChecker(detailed.cell, detailed.geometry).notes().data());
}
BENCHMARK(checker_of_190000_triangles);

}  // namespace
