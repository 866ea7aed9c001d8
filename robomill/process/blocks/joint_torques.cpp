#include "robomill/process/blocks/joint_torques.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "robomill/base/parallel.hpp"
#include "robomill/cell/arm_modes.hpp"
#include "robomill/robot/pose.hpp"

namespace robomill::process {
namespace {

/// Of a revolution, at which the force of the cut is taken.
constexpr int torque_steps = 36;

/// One block after another, with memory of its own.
class TorqueSampler {
 public:
  TorqueSampler(const ForcesResult& forces, const robot::Arm& arm)
      : forces_(forces), arm_(arm), kernel_(forces.cut.cutter, forces.cut.coefficients, {.steps = torque_steps}) {}

  void look(std::size_t block, BlockRow& judged, robot::LoadedBlock& load) {
    const BlockResult& row = forces_.program->blocks[block];
    load = {.joints = std::vector<robot::JointLoadRange>(arm_.joints.size()), .cuts = judged.cuts};
    if (!row.joints.allFinite()) return;  // the robot cannot stand there
    const Eigen::Vector3d tip_m = robot::tip_point(forces_.cell->robot);
    std::vector<robot::Wrench> wrenches(1);
    if (judged.cuts) {
      const cutting::PoseEngagement& cut = forces_.program->cuts[block];
      kernel_.revolution(cut.engagement,
                         {.feed_per_tooth_m = row.force.feed_per_tooth_m,
                          .spindle_speed_rad_per_s = row.force.spindle_speed_rad_per_s},
                         revolution_);
      const Eigen::Matrix3d base_from_feed = forces_.cell->robot.workpiece.linear() * cut.work_from_feed;
      wrenches.clear();
      for (const auto& force : revolution_.force_n.colwise()) wrenches.push_back({.force_n = base_from_feed * force});
    }
    load.joints = robot::joint_load_ranges(arm_, row.joints, tip_m, wrenches);
    if (!judged.cuts) return;
    judged.cut_joint_torque_n_m = cut_torque_n_m(row.joints, tip_m, wrenches);
    if (const double share = greatest_torque_share(arm_, load); share > 0.0) judged.joint_torque_share = share;
  }

 private:
  /// max |J^T F| over joints that turn, and over the revolution.
  double cut_torque_n_m(const Eigen::VectorXd& joints, const Eigen::Vector3d& tip_m,
                        const std::vector<robot::Wrench>& wrenches) const {
    const Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian = robot::jacobian(arm_, joints, tip_m);
    double greatest = 0.0;
    for (Eigen::Index k = 0; k < jacobian.cols(); ++k) {
      if (arm_.joints[static_cast<std::size_t>(k)].prismatic) continue;
      const Eigen::Vector3d lever = jacobian.col(k).head<3>();
      for (const robot::Wrench& wrench : wrenches) greatest = std::max(greatest, std::abs(lever.dot(wrench.force_n)));
    }
    return greatest;
  }

  const ForcesResult& forces_;
  const robot::Arm& arm_;
  cutting::ForceKernel kernel_;
  cutting::CuttingForce revolution_ = {};
};

}  // namespace

void add_joint_torques(const ForcesResult& forces, ProgramBlocks& out) {
  const robot::Arm arm = cell::loaded_arm(*forces.cell);
  out.joint_loads.resize(out.rows.size());
  parallel_for(out.rows.size(), 64, [&](std::size_t begin, std::size_t end) {
    TorqueSampler sampler(forces, arm);
    for (std::size_t i = begin; i < end; ++i) sampler.look(i, out.rows[i], out.joint_loads[i]);
  });
}

double greatest_torque_share(const robot::Arm& arm, const robot::LoadedBlock& block) {
  double share = 0.0;
  for (std::size_t k = 0; k < block.joints.size(); ++k) {
    share = std::max(share, robot::torque_share(arm.joints[k], block.joints[k]).value_or(0.0));
  }
  return share;
}

}  // namespace robomill::process
