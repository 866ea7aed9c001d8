#pragma once
#include <cstddef>
#include <optional>

#include "robomill/io/json.hpp"
#include "robomill/process/decide.hpp"

namespace robomill::process {

/// What became of a decision beyond the choice itself.
struct DecisionOutput {
  bool collisions_checked = false;                ///< of the way that is to run
  std::optional<std::size_t> changed_lines = {};  ///< of the program's text; none: there is no new text
};

/// The decision of plan.json.
/// @param forces   of the decided program; without one, of the program as it was
/// @param options  that it was made with
[[nodiscard]] io::Json decision_object(const Decision& result, const ForcesResult& forces, const DecideOptions& options,
                                       const DecisionOutput& output);

}  // namespace robomill::process
