#pragma once
#include <cstddef>
#include <string>

#include "robomill/base/export.hpp"
#include "robomill/robot/collision.hpp"

// Method: robomill/cell/README.md, "Collisions along a trajectory (`clearance.hpp`)"

namespace robomill::path {

/// How a trajectory stands to what the cell's [geometry] describes.
struct ROBOMILL_API PathClearance {
  robot::Clearance clearance = {};  ///< of the first position that is not clear; where all are, of the nearest
  double time_s = 0.0;              ///< of that position
  std::size_t block = 0;            ///< … from 0
  std::size_t line = 0;             ///< … of the NC program; 0: not known
  double required_m = 0.0;          ///< the least distance that the cell asks for
  double reach_m = 0.0;             ///< up to which distances were looked for
  double between_m = 0.0;           ///< no point of arm or tool moves farther between two positions that were looked at
  std::size_t looks = 0;            ///< positions looked at
  [[nodiscard]] bool clear() const { return clearance.status == robot::Clearance::Status::clear; }
  /// Whether nothing can have been struck between two positions: the nearer of them is at most half of the way off.
  [[nodiscard]] bool covers_moves() const { return between_m <= 2.0 * required_m; }
};

/// "clear; the nearest are spindle and post, 31.2 mm apart, line 12 (24 positions …)", one sentence without its stop.
[[nodiscard]] ROBOMILL_API std::string clearance_text(const PathClearance& clearance);

}  // namespace robomill::path
