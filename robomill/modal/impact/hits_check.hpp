#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/modal/hits.hpp"
#include "robomill/modal/impact/hits_pulse.hpp"

namespace robomill::modal {

/// What no hit may be, each by itself and all together.
/// @throws InvalidInput naming the hit's file
void require_sound(const std::vector<Hit>& hits);

/// Why a hit is no hit of its own: its force and a response are those of an earlier one, sample for sample. Two sensors
/// of one hit may stand in two.
[[nodiscard]] std::optional<std::string> repetition(const std::vector<Hit>& hits, std::size_t which);

/// Whether a sound hit is worth averaging, and why not.
[[nodiscard]] HitVerdict judge_hit(const Hit& hit, const Pulse& pulse, const HitOptions& options);

/// The error for hits of which none was accepted.
[[nodiscard]] InvalidInput none_accepted(const std::vector<HitVerdict>& verdicts);

/// Whether a response moved well above what is left of it at the record's end, before the hit.
[[nodiscard]] bool moved_before(const Hit& hit, const Pulse& pulse, const Dof& response);

}  // namespace robomill::modal
