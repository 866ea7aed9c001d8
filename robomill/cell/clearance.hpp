#pragma once
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "robomill/base/assumption.hpp"
#include "robomill/cell/cell.hpp"
#include "robomill/cutting/cutter.hpp"
#include "robomill/path/files/path_clearance.hpp"
#include "robomill/path/sample.hpp"
#include "robomill/robot/collision.hpp"

// Method: robomill/cell/README.md, "Collisions along a trajectory (`clearance.hpp`)"

namespace robomill::cell {

/// Checks postures of a cell whose file has [geometry]; none where it has not.
/// @param cutter   whose outline the edges have; null: not known, then the shank reaches down to the tip, and may stand
///                 in the part
/// @param assumed  takes what is taken for a cutter that is not known
/// @throws InvalidInput as robot::CollisionChecker
[[nodiscard]] std::unique_ptr<robot::CollisionChecker> clearance_checker(const Cell& cell,
                                                                         const cutting::Cutter* cutter,
                                                                         std::vector<Assumption>& assumed);

/// Keeps of a trajectory, sample by sample, the positions that a check of it must look at: those after which some
/// point of arm or tool has moved on by a step, and those where blocks end. Never more than `most_looks`: with more the
/// step is doubled.
class PathLooks {
 public:
  static constexpr std::size_t most_looks = 200'000;
  /// @param checker  outlives this
  /// @param step_m   > 0
  PathLooks(const robot::CollisionChecker& checker, int joints, double step_m);
  /// In order of time.
  void add(std::span<const path::Sample> samples);
  void restart();
  /// The nearest of all positions, or the first that is not clear.
  /// @param reach_m  how far to look for the nearest bodies
  [[nodiscard]] path::PathClearance check(double clearance_m, double reach_m) const;

 private:
  struct Look {
    robot::Position6 joints = robot::Position6::Zero();
    double time_s = 0.0;
    std::size_t block = 0;
    double way_m = 0.0;  ///< from the look before, at most
    bool ends_block = false;
  };
  void keep(const path::Sample& sample, double way_m, bool ends_block);
  /// Looks between two samples. @return the way from the last of them to the second sample
  double between(const path::Sample& from, const path::Sample& to, double way_m);
  void thin();

  const robot::CollisionChecker* checker_;
  Eigen::Index joints_;
  double first_step_m_, step_m_;
  std::optional<path::Sample> last_ = {};  ///< added, and perhaps not kept
  double since_m_ = 0.0;                   ///< way from the look that was kept last to `last_`
  std::vector<Look> looks_ = {};
};

/// The longest step between two looks at a cell: twice its clearance, within 0.5 and 5 mm.
[[nodiscard]] double look_step_m(const robot::CellGeometry& geometry);

/// "spindle collides with post", "holder comes within 0.4 mm of vise".
[[nodiscard]] std::string near_miss_text(const robot::Clearance& clearance);

}  // namespace robomill::cell
