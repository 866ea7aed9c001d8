#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/cutting/force.hpp"
#include "robomill/cutting/program_engagement.hpp"
#include "robomill/program/program.hpp"

// Method: robomill/cutting/README.md, "Forces along a program (`program_forces.hpp`)"

namespace robomill::cutting {

/// What one block of a program asks of tool, spindle and part. Forces on the tool, in W. Means are over the time in
/// which it cuts, so that a way through air makes them no smaller.
struct BlockForce {
  std::size_t block = 0;        ///< of the program, from 0
  double cutting_time_s = 0.0;  ///< in which teeth are in the material; 0: the block does not cut
  double axial_depth_m = 0.0;   ///< greatest extent of the engaged part along the tool's axis
  double radial_depth_m = 0.0;  ///< … across the feed
  double feed_per_tooth_m = 0.0;
  double spindle_speed_rad_per_s = 0.0;
  Eigen::Vector3d mean_force_n = Eigen::Vector3d::Zero();
  double peak_force_n = 0.0;  ///< largest magnitude at any rotation
  double mean_torque_n_m = 0.0;
  double revolution_torque_n_m = 0.0;  ///< largest mean over one revolution
  double peak_torque_n_m = 0.0;        ///< largest at any rotation
  double power_w = 0.0;
  double peak_power_w = 0.0;  ///< largest mean over one revolution
  /// Largest mean over options.power_time_s that ends while this block cuts; air and what was cut before it count.
  double sustained_power_w = 0.0;
  /// Of the means over one revolution the one that options.weight finds heaviest.
  Eigen::Vector3d heaviest_force_n = Eigen::Vector3d::Zero();
  double removed_volume_m3 = 0.0;
  double shank_depth_m = 0.0;      ///< how deep the shank ran into material, where > a dexel; else 0
  bool rapid_in_material = false;  ///< a rapid move went through material
  [[nodiscard]] bool cuts() const { return cutting_time_s > 0.0; }
};

/// A part of a block that cuts, as it is found.
struct PartOfBlock {
  std::size_t block = 0;      ///< of the program
  const PoseEngagement& cut;  ///< at the part's end
  double feed_per_tooth_m = 0.0;
  Eigen::Vector3d mean_force_n = Eigen::Vector3d::Zero();  ///< over a revolution, in W
};

struct ROBOMILL_API ProgramForceOptions {
  double spindle_speed_rad_per_s = 0.0;  ///< Ω [rad/s]; 0: what the program says
  double power_time_s = 0.1;             ///< > 0: over which sustained_power_w is a mean
  /// How heavy a force is in a block, say the deflection that it makes there. Empty: its magnitude.
  std::function<double(std::size_t block, const Eigen::Vector3d& force_n)> weight = {};
  /// Sees every part that cuts, in their order; what it refers to lasts as long as the call.
  std::function<void(const PartOfBlock& part)> observe = {};
  ForceOptions force = {.steps = 180};
  WalkOptions walk = {};
  /// @throws InvalidInput naming the member
  void validate() const;
};

/// Gets the force of a block once the program is past it.
using DeliverForce = std::function<void(const BlockForce& force)>;

/// Runs the program through the workpiece and hands out a force for each of its blocks, in their order; memory does not
/// grow with the program. The feed per tooth is that of the middle of what cuts. A feed move without a spindle speed is
/// rejected.
/// @throws InvalidInput for a bad cutter, coefficients or options; Interrupted when asked to stop
ROBOMILL_API void program_forces(const program::Program& program, const Cutter& cutter,
                                 const MillingCoefficients& coefficients, Workpiece& workpiece,
                                 const ProgramForceOptions& options, const DeliverForce& deliver,
                                 Progress& progress = Progress::none());
/// The same, all of them.
[[nodiscard]] ROBOMILL_API std::vector<BlockForce> program_forces(const program::Program& program, const Cutter& cutter,
                                                                  const MillingCoefficients& coefficients,
                                                                  Workpiece& workpiece,
                                                                  const ProgramForceOptions& options,
                                                                  Progress& progress = Progress::none());

/// The same for a finishing program of a ball end, from the program alone: every block cuts `axial_depth_m` deep beside
/// its neighbouring pass, on the plane or the cylinder that LocalCuts makes out; a block without one is a slot. The
/// middle of a block stands for all of it, and options.walk has no part. Where blocks pass is held (LocalCuts).
/// @throws InvalidInput as above, and for a cutter that is no ball end
ROBOMILL_API void local_program_forces(const program::Program& program, const Cutter& cutter,
                                       const MillingCoefficients& coefficients, double axial_depth_m,
                                       const ProgramForceOptions& options, const DeliverForce& deliver,
                                       Progress& progress = Progress::none());
/// The same, all of them.
[[nodiscard]] ROBOMILL_API std::vector<BlockForce> local_program_forces(
    const program::Program& program, const Cutter& cutter, const MillingCoefficients& coefficients,
    double axial_depth_m, const ProgramForceOptions& options, Progress& progress = Progress::none());

}  // namespace robomill::cutting
