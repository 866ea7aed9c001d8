#pragma once
// The two programs of the example: a face by a flat end, then a hollow in it by a ball end.
#include <string>

namespace robomill::examples {

/// G-code of a table xyzac-trt with tip positions: a face 64 mm by 36 mm, taken 0.8 mm down by a 12 mm flat end that
/// leads by 3 to 5 degrees; 108 moves that cut.
[[nodiscard]] std::string face_program();
/// forces.toml for it.
[[nodiscard]] std::string face_forces();

/// A hollow 36 mm by 8 mm in that face, by an 8 mm ball end whose axis leans by 10 to 20 degrees; 312 moves that cut.
[[nodiscard]] std::string hollow_program();
[[nodiscard]] std::string hollow_forces();

}  // namespace robomill::examples
