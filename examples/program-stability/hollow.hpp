#pragma once
// Passes of a ball end over a hollow, the tool leant along its way: for the example and for a benchmark.
#include <string>

namespace robomill::examples {

/// G-code of a table xyzac-trt with tip positions; to and fro along x, 0.8 mm deep amid a pass.
/// @param passes        >= 2, 0.6 mm apart
/// @param moves_a_pass  >= 1; each 1.5 mm long
[[nodiscard]] std::string hollow_program(int passes, int moves_a_pass);

/// forces.toml for it: a 10 mm ball end, aluminium, and the stock.
[[nodiscard]] std::string hollow_forces(int passes, int moves_a_pass);

}  // namespace robomill::examples
