#pragma once
#include <complex>
#include <vector>

#include "robomill/stability/collocation/collocation_case.hpp"
#include "robomill/stability/collocation/eigen_motion.hpp"
#include "robomill/stability/sensitivity.hpp"

namespace robomill::stability::detail {

/// Whether mode_sensitivities knows the case: equal teeth that look back a period, an even speed.
[[nodiscard]] bool knows_sensitivities(const LobesProblem& problem, const CollocationCase& at);

/// ∂ ln|μ| of each mode that takes part, from the eigenvectors of a motion.
[[nodiscard]] std::vector<LimitSensitivity::OfMode> mode_sensitivities(const LobesProblem& problem,
                                                                       const CollocationCase& at,
                                                                       const EigenMotion& motion);

/// The same by differences of radii at a point, for any case.
[[nodiscard]] std::vector<LimitSensitivity::OfMode> mode_differences(const LobesProblem& problem,
                                                                     const OperatingPoint& point, int level,
                                                                     double tolerance);

}  // namespace robomill::stability::detail
