#pragma once
// One part of the FRFs fitted by lscf, or by lscf and then nonlinear least squares.
#include "robomill/modal/fit.hpp"
#include "robomill/modal/fitting/fit_parts.hpp"

namespace robomill::modal::detail {

/// Sets the weights of the part's data before any fit. @param weighting  not automatic
void set_first_weights(Part& part, const FrfSet& set, Weighting weighting);

/// Poles of the stabilisation diagram and their least-squares residues. @param modes  so many at most; 0: all
[[nodiscard]] PartFit fit_lscf(Part& part, const FitOptions& options, int modes, Progress& progress);

/// Also re-estimates the weights where they are `estimated`, and drops the residuals where they are not worth it.
[[nodiscard]] PartFit fit_hybrid(Part& part, const FrfSet& set, const FitOptions& options, int modes,
                                 Weighting weighting, Progress& progress);

}  // namespace robomill::modal::detail
