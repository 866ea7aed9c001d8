#pragma once
// What a fit says about itself.
#include "robomill/modal/fit.hpp"

namespace robomill::modal::detail {

/// Fills in relative_error, mean_relative_error and by_frf from result.model against the set.
void set_errors(FitResult& result, const FrfSet& set);

/// Fills in at_bounds: modes whose damping ratio is the bound of the method that fitted, or whose frequency is an end
/// of the band.
void find_bounds(FitResult& result, const FitOptions& options);

/// Adds warnings about what the fit leaves, modes at bounds, and what is physically odd in the model or badly known:
/// not passive, not reciprocal, a displacement that jumps at a blow, vague modes, FRFs that nobody measured.
void add_warnings(FitResult& result, const FrfSet& set);

}  // namespace robomill::modal::detail
