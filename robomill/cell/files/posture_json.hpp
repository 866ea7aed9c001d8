#pragma once
#include "robomill/cell/dynamics.hpp"
#include "robomill/io/schema.hpp"
#include "robomill/modal/files/modes_schema.hpp"

namespace robomill::cell {

/// What lobes.json and modes.json say of the posture that their modes are of.
[[nodiscard]] const io::Schema<ModesOfPosture>& posture_table();

/// modes.json: of a fit, or of a posture.
struct ModesDocument {
  modal::ModesView modes = {};
  const ModesOfPosture* posture = nullptr;  ///< null: of no cell
};
[[nodiscard]] const io::Schema<ModesDocument>& modes_document_table();

}  // namespace robomill::cell
