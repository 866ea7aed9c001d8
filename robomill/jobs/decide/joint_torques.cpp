#include "robomill/jobs/decide/joint_torques.hpp"

#include <algorithm>

#include "robomill/base/parallel.hpp"
#include "robomill/jobs/decide/motion_loads.hpp"
#include "robomill/robot/pose.hpp"

namespace robomill::jobs {
namespace {

/// Of a revolution, at which the force of the cut is taken.
constexpr int torque_steps = 36;

/// One block after another, with memory of its own.
class TorqueSampler {
 public:
  TorqueSampler(const ForcesResult& forces, const robot::Arm& arm)
      : forces_(forces), arm_(arm), kernel_(forces.file.cutter, forces.file.coefficients, {.steps = torque_steps}) {}

  robot::LoadedBlock at(std::size_t block, bool cuts) {
    const BlockResult& row = forces_.program->blocks[block];
    std::vector<robot::Wrench> wrenches(1);
    if (cuts) {
      const cutting::PoseEngagement& cut = forces_.program->cuts[block];
      kernel_.revolution(cut.engagement,
                         {.feed_per_tooth_m = row.force.feed_per_tooth_m,
                          .spindle_speed_rad_per_s = row.force.spindle_speed_rad_per_s},
                         revolution_);
      const Eigen::Matrix3d base_from_feed = forces_.cell->cell.workpiece.linear() * cut.work_from_feed;
      wrenches.clear();
      for (const auto& force : revolution_.force_n.colwise()) wrenches.push_back({.force_n = base_from_feed * force});
    }
    return {.joints = robot::joint_load_ranges(arm_, row.joints, robot::tip_point(forces_.cell->cell), wrenches),
            .cuts = cuts};
  }

 private:
  const ForcesResult& forces_;
  const robot::Arm& arm_;
  cutting::ForceKernel kernel_;
  cutting::CuttingForce revolution_ = {};
};

}  // namespace

std::vector<robot::LoadedBlock> joint_torques(const ForcesResult& forces, const ProgramBlocks& blocks) {
  const robot::Arm arm = loaded_arm(*forces.cell);
  std::vector<robot::LoadedBlock> out(blocks.rows.size());
  parallel_for(out.size(), 64, [&](std::size_t begin, std::size_t end) {
    TorqueSampler sampler(forces, arm);
    for (std::size_t i = begin; i < end; ++i) out[i] = sampler.at(i, blocks.rows[i].cuts);
  });
  return out;
}

double greatest_torque_share(const robot::Arm& arm, const robot::LoadedBlock& block) {
  double share = 0.0;
  for (std::size_t k = 0; k < block.joints.size(); ++k) {
    share = std::max(share, robot::torque_share(arm.joints[k], block.joints[k]).value_or(0.0));
  }
  return share;
}

}  // namespace robomill::jobs
