#pragma once
// What a fit says about itself.
#include "robomill/modal/fit.hpp"

namespace robomill::modal::detail {

/// Fills in relative_error, mean_relative_error and by_frf from result.model against the set.
void set_errors(FitResult& result, const FrfSet& set);

/// Adds warnings about what is physically odd in the model or badly known: not passive, not reciprocal, a displacement
/// that jumps at a blow, vague modes, FRFs that nobody measured.
void add_warnings(FitResult& result, const FrfSet& set);

}  // namespace robomill::modal::detail
