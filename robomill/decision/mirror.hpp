#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

namespace robomill::decision {

/// A place of the finished surface, in any axes that all places share.
struct WallPlace {
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< unit, out of the cutter into the part
  double error_m = 0.0;                              ///< > 0: material is left standing along the normal
  double width_m = 0.0;                              ///< of the surface that it stands for, >= 0
};

/// What places ask of an offset o of the tool's tip: to minimise Σ w (e − n·o)².
struct MirrorCondition {
  Eigen::Matrix3d normals_m = Eigen::Matrix3d::Zero();  ///< Σ w n nᵀ
  Eigen::Vector3d wanted_m2 = Eigen::Vector3d::Zero();  ///< Σ w n e
  double squares_m3 = 0.0;                              ///< Σ w e²
  double width_m = 0.0;                                 ///< Σ w; 0: nothing is asked
  MirrorCondition& operator+=(const MirrorCondition& other);
  /// The least offset that minimises the sum. Directions that normals span weakly, of which the places see less than
  /// 5 % of what they see of the best one (kinks below 25 degrees), are left out: errors there would be divided by
  /// almost nothing.
  [[nodiscard]] Eigen::Vector3d offset_m() const;
  /// Root mean square of e − n·o; 0 where nothing is asked.
  [[nodiscard]] double rms_m(const Eigen::Vector3d& offset_m) const;
};
[[nodiscard]] MirrorCondition condition_of(std::span<const WallPlace> places);

/// Whether two walls that face each other want opposite offsets: places have normals both along one direction and
/// against it, and the offset that suits both best leaves more than half of their errors.
[[nodiscard]] bool opposite_walls(std::span<const WallPlace> places);

/// One block of a path.
struct MirrorBlock {
  bool feed = false;               ///< else a rapid move, which nothing is blended along
  double length_m = 0.0;           ///< of the tip's way
  MirrorCondition condition = {};  ///< width 0: not to be compensated
};

struct MirrorOptions {
  double max_offset_m = 0.5e-3;  ///< > 0; longer offsets are cut off there
  double blend_m = 0.0;          ///< >= 0; way over which an offset dies away along blocks that are not compensated
  /// @throws InvalidInput naming the member
  void validate() const;
};

/// Offsets of a path's points: of its start, then of the end of each block.
struct MirrorOffsets {
  std::vector<Eigen::Vector3d> point_m = {};
  std::vector<bool> bounded = {};  ///< point by point: cut off at max_offset_m
  std::vector<bool> blended = {};  ///< block by block: not compensated, and moved all the same
};

/// One offset for each point of a path: that which suits the blocks on both sides of it, so that along a smooth pass
/// it is the mean of theirs and in a corner both walls get what they ask for. Along blocks that are not compensated
/// it dies away over blend_m, up to the next rapid move.
/// @throws InvalidInput if an option is out of range
[[nodiscard]] MirrorOffsets mirror_offsets(std::span<const MirrorBlock> blocks, const MirrorOptions& options);

}  // namespace robomill::decision
