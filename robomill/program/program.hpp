#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "robomill/base/export.hpp"

/// Work frame W: the program's own, fixed in the part; docs/frames.md.
namespace robomill::program {

/// Where the tool stands, in W.
struct Pose {
  Eigen::Vector3d tip_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  ///< unit vector from the tip to the spindle
};

/// One straight move; the tip runs along a line, the axis along a great circle, both evenly in time.
struct Block {
  enum class Kind { rapid, feed };
  Kind kind = Kind::feed;
  std::size_t line = 0;  ///< in the program's file, from 1
  Pose end;
  double duration_s = 0.0;               ///< of a feed move; 0 for a rapid: as fast as the machine can
  double spindle_speed_rad_per_s = 0.0;  ///< as commanded; 0 where the program has not said
};

/// What a reader left out.
struct Skipped {
  std::size_t line = 0;
  std::string what;
};

/// An NC program as data.
struct ROBOMILL_API Program {
  Pose start;                 ///< where the first block begins
  std::vector<Block> blocks;  ///< no block without motion
  std::vector<Skipped> skipped = {};
  /// Where block i begins.
  [[nodiscard]] const Pose& begin_of(std::size_t block) const { return block == 0 ? start : blocks[block - 1].end; }
};

/// Between two poses, share in [0, 1]: line of the tip, great circle of the axis.
[[nodiscard]] ROBOMILL_API Pose between(const Pose& from, const Pose& to, double share);

/// Angle between two unit vectors [rad], in [0, π], accurate at both ends.
[[nodiscard]] ROBOMILL_API double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b);

}  // namespace robomill::program
