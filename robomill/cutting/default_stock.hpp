#pragma once
#include <cstddef>

#include "robomill/base/export.hpp"
#include "robomill/cutting/workpiece.hpp"

// Method: robomill/cutting/README.md, "Workpiece (`workpiece.hpp`, `dexels/`)"

namespace robomill::cutting {

/// The stock where a job gives none, and where its height comes from.
struct ROBOMILL_API DefaultStock {
  enum class Top {
    axial_depth,  ///< the given depth above the highest pass
    program_zero  ///< z = 0: every pass lies below it, and the program moves above it
  };
  Stock stock;
  Top top = Top::program_zero;
  double highest_pass_m = 0.0;         ///< z of it
  std::size_t highest_pass_block = 0;  ///< of the program, from 0
};

/// A box about the tips of all feed moves, larger by the cutter's radius in x and y, from a dexel below the lowest tip
/// up to where the program says that material stands. A pass is a feed move across the tool's axis (|way along the
/// axis| < 0.7 · way), or the end of a plunge; moves that only lead down to a pass (plunge, ramp, helix) are none, for
/// they begin in air.
/// @param axial_depth_m  that the highest pass cuts; 0: not known
/// @throws InvalidInput if the program has no feed move, a length is out of range, or the height cannot be determined:
/// no depth is given and the highest pass does not lie below a z = 0 that the program moves above
[[nodiscard]] ROBOMILL_API DefaultStock default_stock(const program::Program& program, const Cutter& cutter,
                                                      double dexel_m, double axial_depth_m);

}  // namespace robomill::cutting
