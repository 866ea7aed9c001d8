#pragma once
#include "robomill/io/schema.hpp"
#include "robomill/modal/fit.hpp"

namespace robomill::modal {

/// Modes with how they were fitted.
struct ModesView {
  const ModalModel* model = nullptr;
  const FitResult* fit = nullptr;  ///< null: they were not fitted here
};
/// modes.json
[[nodiscard]] const io::Schema<ModesView>& modes_table();

}  // namespace robomill::modal
