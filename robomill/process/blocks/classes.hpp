#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "robomill/cutting/force.hpp"
#include "robomill/cutting/program_engagement.hpp"
#include "robomill/process/blocks.hpp"

namespace robomill::process {

/// ∫∫ f nᵀ dφ db over the engaged part, in W [N/m]: times N/(2π) the mean cutting stiffness of the cut. f is the
/// force on the tool of a chip of one metre.
[[nodiscard]] Eigen::Matrix3d mean_stiffness(const cutting::PoseEngagement& cut,
                                             const cutting::MillingCoefficients& coefficients);

/// What makes two blocks alike.
struct CutLook {
  double spindle_speed_rad_per_s = 0.0, axial_depth_m = 0.0;
  double feed_per_tooth_m = 0.0;                        ///< 0 in all of them: it does not count
  Eigen::Matrix3d stiffness = Eigen::Matrix3d::Zero();  ///< mean_stiffness
  /// stiffness · x_F, its sign does not count: a flat end's slot has much the same stiffness in any direction, and not
  /// the same force before the structure. Turned by half a turn the slot and what it leaves turn with it.
  Eigen::Vector3d along_feed = Eigen::Vector3d::Zero();
  Eigen::VectorXd joints = {};
};

/// Sorts blocks into classes as they come: a block joins the class of the latest first block that it is like, of as
/// many as a zigzag needs; else it opens one. Time a block does not grow with the blocks.
class Classes {
 public:
  explicit Classes(const BlockTolerance& tolerance) : tolerance_(tolerance) {}
  /// The class of the block; classes().back() is the block itself where it opened one.
  std::size_t add(std::size_t block, const CutLook& look);
  /// The first block of each.
  [[nodiscard]] const std::vector<std::size_t>& first_blocks() const { return first_; }

 private:
  [[nodiscard]] bool alike(const CutLook& a, const CutLook& b) const;
  static constexpr std::size_t remembered = 512;
  BlockTolerance tolerance_;
  std::vector<std::size_t> first_ = {};
  std::vector<CutLook> latest_ = {};  ///< of class k at k % remembered
};

}  // namespace robomill::process
