#pragma once
#include <vector>

#include "robomill/base/progress.hpp"
#include "robomill/formats/lobes_toml.hpp"
#include "robomill/plan/finish.hpp"
#include "robomill/plan/recommend.hpp"
#include "robomill/stability/lobes.hpp"

namespace robomill::plan {

/// The best operation of a cut whose limits were found at its speeds, with the surface that forced vibration leaves at
/// it and at the alternatives; that surface is unknown where tool or workpiece are measured FRFs without modes.
/// @param options  margins, spindle and the cutter's depth; what the cut says is put in
/// @param finish   what the surface may be; the limits of depth in between follow at every speed
/// @throws InvalidInput as recommend; where finish limits something that cannot be computed
/// @throws Interrupted  when progress asks to stop
[[nodiscard]] Recommendation choose(const formats::LobesFile& cut, const std::vector<stability::Limit>& limits,
                                    RecommendOptions options, const FinishLimits& finish = {},
                                    Progress& progress = Progress::none());

}  // namespace robomill::plan
