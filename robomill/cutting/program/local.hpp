#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "robomill/program/program.hpp"

/// The cut of a finishing program from the program alone, without stock: its neighbouring passes say how far apart they
/// lie, on which side, and how the surface bends.
namespace robomill::cutting {

/// At the middle of a block. F as in program_engagement.hpp: x_F along the tip's way, z_F the axis without its part
/// along x_F.
struct LocalCut {
  enum class Neighbour {
    none,  ///< no pass within reach was cut before: a slot, a first pass
    left,  ///< at +y_F: milling down
    right  ///< at -y_F: milling up
  };
  Neighbour neighbour = Neighbour::none;  ///< where the nearest pass lies that was cut before
  double stepover_m = 0.0;                ///< distance of the tips' ways to that pass, across the feed
  double slope_rad = 0.0;                 ///< of the tips' surface across the feed: about x_F, from y_F towards z_F
  double curvature_per_m = 0.0;           ///< of the tips' surface across the feed, > 0 where it bends away from the
                                          ///< tool; 0 where there is a pass on one side alone (a plane)
  Eigen::Matrix3d work_from_feed = Eigen::Matrix3d::Identity();
};

/// What it assumes: passes run beside each other (within 60 degrees), the tool leans alike on neighbouring ones, and
/// what a pass leaves is a plane or a cylinder along the feed. Curvatures and distances are those of the surface on
/// which the tips run: for a ball of radius R on a surface of curvature k, tips' curvature k / (1 + k R) and distance
/// (1 + k R) times that on the surface.
class LocalCuts {
 public:
  /// @param reach_m  > 0, the cutter's diameter; a pass at (y, z) across the feed is a neighbour where √(y² + z²) <=
  ///     reach_m, |z| <= |y| and |y| >= 1e-3 reach_m
  /// @throws InvalidInput if reach_m is not > 0
  LocalCuts(const program::Program& program, double reach_m);
  /// Of a feed move whose tip moves; another has no neighbour. The program must still be there.
  [[nodiscard]] LocalCut at(std::size_t block) const;

 private:
  using Cell = std::uint64_t;
  [[nodiscard]] Cell cell(const Eigen::Array3d& place) const;

  const program::Program& program_;
  double reach_m_;
  Eigen::Array3d lowest_m_;
  std::unordered_map<Cell, std::vector<std::size_t>> blocks_;  ///< feed moves by the cells that they pass
};

}  // namespace robomill::cutting
