#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "robomill/cutting/cutter.hpp"
#include "robomill/jobs/files/cell_toml.hpp"
#include "robomill/robot/collision.hpp"
#include "robomill/robot/kinematics.hpp"

namespace robomill::jobs {

/// Checks postures of a cell whose file has [geometry], with the cutter's own outline; none where it has not.
/// @throws InvalidInput as robot::CollisionChecker
[[nodiscard]] std::unique_ptr<robot::CollisionChecker> collision_checker(const CellFile& cell,
                                                                         const cutting::Cutter& cutter);

/// Where a program first comes too near to something.
struct NearMiss {
  std::size_t block = 0;
  robot::Clearance clearance = {};
};
/// Along the joints at the end of each block, moved evenly from one to the next.
[[nodiscard]] std::optional<NearMiss> first_near_miss(const robot::CollisionChecker& checker,
                                                      const robot::CellGeometry& geometry,
                                                      const std::vector<robot::Position6>& joints);

/// "holder comes within 0.4 mm of vise".
[[nodiscard]] std::string near_miss_text(const robot::Clearance& clearance);

}  // namespace robomill::jobs
