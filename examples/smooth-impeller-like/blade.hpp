#pragma once
// Finishing passes along one blade of an invented impeller, as a CAM system would write them: for the example and for
// a benchmark.
#include <string>

namespace robomill::examples {

/// G-code of a table xyzac-trt with tip positions, 1,800 mm/min; to and fro along the blade, the tool along its
/// rulings.
/// @param passes        >= 2; from the shroud to the hub
/// @param moves_a_pass  >= 1; of equal steps along the blade
[[nodiscard]] std::string blade_program(int passes, int moves_a_pass);

}  // namespace robomill::examples
