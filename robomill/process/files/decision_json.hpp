#pragma once
#include <cstddef>
#include <optional>

#include "robomill/io/schema.hpp"
#include "robomill/process/decide.hpp"

namespace robomill::process {

/// What became of a decision beyond the choice itself.
struct DecisionOutput {
  bool collisions_checked = false;                ///< of the way that is to run
  std::optional<std::size_t> changed_lines = {};  ///< of the program's text; none: there is no new text
};

/// The decision of plan.json.
struct DecisionView {
  const Decision* decision = nullptr;
  const ForcesResult* forces = nullptr;    ///< of the decided program; without one, of the program as it was
  const DecideOptions* options = nullptr;  ///< that it was made with
  DecisionOutput output = {};
};
[[nodiscard]] const io::Schema<DecisionView>& decision_table();

}  // namespace robomill::process
