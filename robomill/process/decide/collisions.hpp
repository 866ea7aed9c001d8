#pragma once
#include <memory>
#include <string>
#include <vector>

#include "robomill/cell/cell.hpp"
#include "robomill/cell/clearance.hpp"
#include "robomill/cutting/cutter.hpp"
#include "robomill/process/decide/apply.hpp"
#include "robomill/robot/collision.hpp"

namespace robomill::process {

/// Checks postures of a cell whose file has [geometry], with the cutter's own outline; none where it has not.
/// @throws InvalidInput as robot::CollisionChecker
[[nodiscard]] std::unique_ptr<robot::CollisionChecker> collision_checker(const cell::Cell& cell,
                                                                         const cutting::Cutter& cutter);

/// Where a program comes too near to something.
struct NearMiss {
  std::size_t block = 0;
  robot::Clearance clearance = {};
};
/// Of each block in order, from where the program begins along the joints at the blocks' ends, moved evenly from one to
/// the next.
/// @param checker  null: no obstacles are known, and nothing is near
/// @param cell     the checker's
[[nodiscard]] std::vector<NearMiss> near_misses(const robot::CollisionChecker* checker, const cell::Cell& cell,
                                                const Stands& stands);

}  // namespace robomill::process
