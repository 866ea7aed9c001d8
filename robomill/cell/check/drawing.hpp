#pragma once
#include "robomill/cell/check.hpp"
#include "robomill/path/postures/posture_walk.hpp"

namespace robomill::cell {

/// The machine at its stands, where its wrist can be, and the program's path.
[[nodiscard]] CellDrawing draw_cell(const CellCheck& check, const path::Head& program);

}  // namespace robomill::cell
