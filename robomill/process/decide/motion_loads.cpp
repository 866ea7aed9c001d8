#include "robomill/process/decide/motion_loads.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "robomill/cell/arm_modes.hpp"
#include "robomill/process/blocks/joint_torques.hpp"
#include "robomill/robot/pose.hpp"

namespace robomill::process {

bool knows_torques(const cell::Cell& cell) {
  const robot::Arm arm = cell::loaded_arm(cell);
  const std::vector<robot::JointLoad> loads = robot::joint_loads(
      arm, Eigen::VectorXd::Zero(static_cast<Eigen::Index>(arm.size())), robot::tip_point(cell.robot));
  for (std::size_t k = 0; k < loads.size(); ++k) {
    if (loads[k].status == robot::JointLoad::Status::known && arm.joints[k].max_torque > 0.0) return true;
  }
  return false;
}

MotionLoads::MotionLoads(const cell::Cell& cell, double sample_period_s, std::vector<std::size_t> block_of)
    : arm_(cell::loaded_arm(cell)),
      tip_m_(robot::tip_point(cell.robot)),
      period_s_(sample_period_s),
      block_of_(std::move(block_of)) {}

void MotionLoads::add(std::span<const path::Sample> samples) {
  for (const path::Sample& sample : samples) {
    if (sample.time_s == 0.0) {
      blocks_.clear();
      last_.clear();
    }
    if (last_.size() == 2) {
      look(block_of_.at(last_[1].block), last_[0].joints, last_[1].joints, sample.joints);
      last_.erase(last_.begin());
    }
    last_.push_back(sample);
  }
}

void MotionLoads::look(std::size_t block, const Eigen::VectorXd& before, const Eigen::VectorXd& at,
                       const Eigen::VectorXd& after) {
  robot::JointLoadOptions moving;
  moving.velocity = (after - before) / (2.0 * period_s_);
  moving.acceleration = (after - 2.0 * at + before) / (period_s_ * period_s_);
  const std::vector<robot::JointLoad> loads = robot::joint_loads(arm_, at, tip_m_, {}, moving);
  Eigen::VectorXd torque(static_cast<Eigen::Index>(loads.size()));
  for (Eigen::Index k = 0; k < torque.size(); ++k)
    torque(k) = loads[static_cast<std::size_t>(k)].torque().value_or(0.0);
  if (block >= blocks_.size()) blocks_.resize(block + 1);
  Range& range = blocks_[block];
  range.low = range.low.size() == 0 ? torque : range.low.cwiseMin(torque);
  range.high = range.high.size() == 0 ? torque : range.high.cwiseMax(torque);
}

std::vector<double> MotionLoads::shares(const ForcesResult& forces, const std::vector<robot::LoadedBlock>& cut) const {
  std::vector<double> out(cut.size(), 0.0);
  for (std::size_t i = 0; i < std::min(out.size(), blocks_.size()); ++i) {
    if (blocks_[i].low.size() == 0) continue;
    // The cut's part alone: its ranges hold the weight where the block ends.
    const std::vector<robot::JointLoad> still = robot::joint_loads(arm_, forces.program->blocks[i].joints, tip_m_);
    for (std::size_t k = 0; k < still.size(); ++k) {
      const robot::JointLoadRange& of_cut = cut[i].joints[k];
      const auto joint = static_cast<Eigen::Index>(k);
      const robot::JointLoadRange all = {.status = of_cut.status,
                                         .min = blocks_[i].low(joint) + of_cut.min - still[k].gravity,
                                         .max = blocks_[i].high(joint) + of_cut.max - still[k].gravity};
      out[i] = std::max(out[i], robot::torque_share(arm_.joints[k], all).value_or(0.0));
    }
  }
  return out;
}

}  // namespace robomill::process
