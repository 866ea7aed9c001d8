#pragma once
// A lobes file that tests of whole jobs share.
#include <string>

namespace robomill::test_support {

/// A cut with three teeth, without dynamics, which the job gives.
/// @param table  the lines of [lobes]
inline std::string lobes_file(const std::string& table) {
  return R"([tool]
teeth = 3
diameter_mm = 12
[cut]
direction = "up"
radial_depth_mm = 1.8
feed_per_tooth_mm = 0.01
[coefficients]
tangential_n_per_mm2 = 712
radial_n_per_mm2 = 287
[lobes]
)" + table;
}

}  // namespace robomill::test_support
