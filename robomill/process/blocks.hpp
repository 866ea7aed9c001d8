#pragma once
#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/modal/mode_id.hpp"
#include "robomill/modal/modes.hpp"
#include "robomill/process/forces.hpp"
#include "robomill/robot/joint_load.hpp"
#include "robomill/stability/block.hpp"
#include "robomill/stability/forced_vibration.hpp"

// Method: robomill/process/README.md, "Every block of a program (`blocks.hpp`)"

namespace robomill::process {

/// A number that is not known.
inline constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

/// What vibrates where the robot stands.
struct PostureDynamics {
  modal::ModalModel modes = {};              ///< of the tool's tip, in the robot's base axes
  std::optional<bool> measured_nearby = {};  ///< none: the dynamics do not come from measured postures
  double joint_distance_rad = 0.0;           ///< to the nearest measured posture, largest of a joint
  std::size_t unmatched = 0;                 ///< as cell::CellDynamics::unmatched
};
/// Of any posture; called by several threads at once.
using DynamicsAt = std::function<PostureDynamics(const Eigen::VectorXd& joints)>;

/// Of the cell's measured postures, or of its arm's numbers alone (posture.hpp).
/// @param pushed                    the base's axes along which cuts push by more than a little
/// @param warnings, notes, assumed  for the user are added
/// @throws InvalidInput as cell::cell_dynamics, or with the cell's file if nothing is known to vibrate; Interrupted
[[nodiscard]] ROBOMILL_API DynamicsAt dynamics_of_cell(const cell::Cell& cell, const std::array<bool, 3>& pushed,
                                                       std::vector<std::string>& warnings,
                                                       std::vector<std::string>& notes,
                                                       std::vector<Assumption>& assumed,
                                                       Progress& progress = Progress::none());
/// The same modes in every posture.
[[nodiscard]] ROBOMILL_API DynamicsAt constant_dynamics(modal::ModalModel modes);

/// Blocks share an evaluation where no joint differs by more than joint_rad, and mean cutting stiffness (in base axes),
/// depth and, where it counts, feed per tooth by no more than cut_share.
struct ROBOMILL_API BlockTolerance {
  double joint_rad = 0.0174532925199433;  ///< [rad], >= 0
  double cut_share = 0.02;                ///< >= 0
  /// @throws InvalidInput naming the member
  void validate() const;
};

struct ROBOMILL_API BlocksOptions {
  BlockTolerance alike = {};
  double tolerance = 1e-4;  ///< of the spectral radius, as LobesOptions::tolerance
  int scan_points = 9;      ///< of each scan of the limit over the tool's pose, 0: none, or odd
  /// A workpiece that vibrates is known beside that of the cut.
  bool workpiece_vibrates = false;
  /// @throws InvalidInput naming the member
  void validate() const;
};

/// How the blocks of a program are judged.
struct BlocksJudging {
  DynamicsAt dynamics = {};
  BlocksOptions options = {};
};

/// How the tip moves in one cut; NaN where that chatters or is not fed.
struct SteadyMotion {
  double surface_error_m = unknown;  ///< over all that the pass leaves, flanks that later passes take away included
  stability::ForcedVibration vibration = {};  ///< about its mean
  double vibration_share = unknown;           ///< its amplitude over the feed per tooth that it was found at
};

/// One block of a program.
struct BlockRow {
  bool cuts = false;                                 ///< else nothing below is known
  double axial_depth_m = 0.0, radial_depth_m = 0.0;  ///< where most of the cutter is in the material
  double spindle_speed_rad_per_s = 0.0;
  /// Its quantiles lie within the depths that were searched.
  stability::BlockStability stability = {};
  SteadyMotion steady = {};
  double stability_margin = unknown;  ///< 1 - depth / limit (5 % quantile); no limit: of the depth searched
  /// Of the places of the finished surface, that no later block takes away, the error of greatest magnitude; > 0:
  /// material is left standing. NaN: the block leaves none of it, chatters, or the program has no stock.
  double surface_left_m = unknown;
  double joint_torque_share = unknown;    ///< the greatest of a drive's, weight and cut; NaN: not known
  double cut_joint_torque_n_m = unknown;  ///< the greatest that the cut alone puts on a joint that turns
  std::optional<bool> measured_nearby = {};
  std::size_t unmatched = 0;   ///< as cell::CellDynamics::unmatched
  std::size_t evaluation = 0;  ///< which one it shares, from 0
  [[nodiscard]] bool unstable() const { return cuts && stability.at.spectral_radius >= 1.0; }
};

/// The limit over one coordinate of the tool's pose, with the same engagement.
struct LimitScan {
  std::string parameter = {};        ///< "x_mm", "y_mm", "z_mm" (in W) or "gamma_deg"
  std::vector<double> value = {};    ///< [m] or [rad]
  std::vector<double> limit_m = {};  ///< infinite: none; NaN: the robot cannot stand there
};

/// Blocks on end, of those that cut, in which the robot stands beyond the measured postures.
struct BeyondMeasured {
  std::size_t first = 0, last = 0;
  double farthest_rad = 0.0;  ///< from the nearest measured posture, largest of a joint
  double band = 0.0;          ///< (95 % - 5 % quantile) / limit, the largest of them; 0: none is known
};

struct ProgramBlocks {
  std::vector<BlockRow> rows = {};                   ///< one a block of the program
  std::vector<robot::LoadedBlock> joint_loads = {};  ///< one a block: weight and cut over a revolution
  std::size_t cutting = 0, unstable = 0;
  std::size_t worst = 0;                    ///< of worse()
  std::size_t evaluations = 0;              ///< different cuts that were looked at
  std::vector<LimitScan> scans = {};        ///< around the worst block
  std::vector<BeyondMeasured> beyond = {};  ///< in the program's order
  double band_within = 0.0;                 ///< as BeyondMeasured::band, the median of the blocks within; 0: none
  bool rigid_workpiece = false;  ///< the files know a workpiece that vibrates, and it takes no part in the blocks
  double seconds = 0.0;
};

/// Which of two blocks that cut is nearer to chatter: unstable before stable, then by gain margin, then by
/// stability_margin.
[[nodiscard]] ROBOMILL_API bool worse(const BlockRow& a, const BlockRow& b);

/// Stability of every block that cuts: its engagement (ProgramForces::cuts), its posture, the dynamics there.
/// Depths, speeds, tolerance and what is shared: robomill/process/README.md.
/// @param forces  with a cell, and cuts kept
/// @throws InvalidInput if an option is out of range, or dynamics are not known in a block or do not fit its cut,
/// naming block and line; Interrupted
[[nodiscard]] ROBOMILL_API ProgramBlocks judge_blocks(const ForcesResult& forces, const DynamicsAt& dynamics,
                                                      const BlocksOptions& options = {},
                                                      Progress& progress = Progress::none());

/// Sentences for the user: blocks that chatter, stretches beyond the measured postures.
[[nodiscard]] ROBOMILL_API std::vector<std::string> block_warnings(const ForcesResult& forces,
                                                                   const ProgramBlocks& blocks);
/// Sentences for the user: what the limits leave out.
[[nodiscard]] ROBOMILL_API std::vector<std::string> block_notes(const ProgramBlocks& blocks);
/// What is to be known of one block's numbers; empty: nothing.
[[nodiscard]] ROBOMILL_API std::string block_note(const BlockResult& force, const BlockRow& row);

/// A row a block.
[[nodiscard]] ROBOMILL_API std::string blocks_csv(const ForcesResult& forces, const ProgramBlocks& blocks);
/// The same by columns, with a summary and the scans.
[[nodiscard]] ROBOMILL_API std::string blocks_json(const ForcesResult& forces, const ProgramBlocks& blocks);

}  // namespace robomill::process
