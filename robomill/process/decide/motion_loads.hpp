#pragma once
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "robomill/cell/cell.hpp"
#include "robomill/path/sample.hpp"
#include "robomill/process/forces.hpp"
#include "robomill/robot/joint_load.hpp"

namespace robomill::process {

/// Whether some drive has a torque limit and a load that is known.
[[nodiscard]] bool knows_torques(const cell::Cell& cell);

/// What the joints bear while the robot runs a trajectory: weight, inertia and Coriolis forces, with speeds and
/// accelerations by central differences of its samples.
class MotionLoads {
 public:
  /// @param sample_period_s  of the trajectory, > 0
  /// @param block_of         of each block that samples name the one that `shares` counts it to
  MotionLoads(const cell::Cell& cell, double sample_period_s, std::vector<std::size_t> block_of);
  /// In order of time; a sample at time 0 begins anew.
  void add(std::span<const path::Sample> samples);
  /// Of each block the greatest share of its torque that a drive gives, with the force of the cut over a revolution; 0
  /// where no sample lies in it or nothing is known.
  /// @param forces  of the program that runs
  /// @param cut     ProgramBlocks::joint_loads of it
  [[nodiscard]] std::vector<double> shares(const ForcesResult& forces,
                                           const std::vector<robot::LoadedBlock>& cut) const;

 private:
  struct Range {
    Eigen::VectorXd low = {}, high = {};  ///< of the torque of each joint; empty: no sample
  };
  void look(std::size_t block, const Eigen::VectorXd& before, const Eigen::VectorXd& at, const Eigen::VectorXd& after);

  robot::Arm arm_;
  Eigen::Vector3d tip_m_;
  double period_s_;
  std::vector<std::size_t> block_of_;
  std::vector<path::Sample> last_ = {};  ///< two at most
  std::vector<Range> blocks_ = {};
};

}  // namespace robomill::process
