#pragma once
#include <vector>

#include "robomill/formats/lobes_toml.hpp"
#include "robomill/plan/recommend.hpp"
#include "robomill/stability/lobes.hpp"

namespace robomill::plan {

/// The best operation of a cut whose limits were found at its speeds.
/// @param options  margins, spindle and the cutter's depth; what the cut says is put in
/// @throws InvalidInput as recommend
[[nodiscard]] Recommendation choose(const formats::LobesFile& cut, const std::vector<stability::Limit>& limits,
                                    RecommendOptions options);

}  // namespace robomill::plan
