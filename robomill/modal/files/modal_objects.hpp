#pragma once
#include "robomill/io/json.hpp"
#include "robomill/modal/fit.hpp"
#include "robomill/modal/hits.hpp"

namespace robomill::modal {

/// modes.json, for a file of its own and for plan.json. @throws InvalidInput if the model is not valid
[[nodiscard]] io::Json modes_object(const ModalModel& model);
[[nodiscard]] io::Json modes_object(const FitResult& fit);

/// Verdicts, grades and notes of tip.json, for plan.json.
[[nodiscard]] io::Json hits_object(const FrfResult& result);

}  // namespace robomill::modal
