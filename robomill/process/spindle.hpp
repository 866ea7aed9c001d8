#pragma once
#include <optional>
#include <string>
#include <vector>

#include "robomill/decision/recommend.hpp"
#include "robomill/process/forces.hpp"

namespace robomill::process {

/// A sentence where the spindle cannot turn the cutter through a cut, or through blocks of a program; else empty.
/// @param curve  of decision::MachineLimits; empty: not known
[[nodiscard]] std::string spindle_warning(const ForcesResult& forces,
                                          const std::vector<decision::SpindleCapacity>& curve);

/// What the spindle gives where the whole program runs at one speed; nothing where it does not, or without a curve.
[[nodiscard]] std::optional<decision::SpindleCapacity> capacity_along(
    const ForcesResult& forces, const std::vector<decision::SpindleCapacity>& curve);

}  // namespace robomill::process
