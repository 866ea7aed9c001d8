#pragma once
#include <functional>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/decision/finish.hpp"
#include "robomill/decision/recommend.hpp"
#include "robomill/stability/lobes.hpp"

// Method: robomill/decision/README.md, "The recommendation (`recommend.hpp`)"

namespace robomill::decision {

/// Mean torque of a cut at a depth [m], as RecommendOptions::mean_torque_n_m takes it: that of
/// cutting::mean_torque_n_m.
[[nodiscard]] ROBOMILL_API std::function<double(double)> mean_torque_of(const cutting::Milling& milling);

/// The best operation of a cut whose limits were found at its speeds, with the surface that forced vibration leaves at
/// it and at the alternatives; that surface is unknown where tool or workpiece are measured FRFs without modes.
/// @param limits   of the problem, within lobes
/// @param options  radial depth, margins, spindle and the cutter's depth; what else the cut says is put in
/// @param finish   what the surface may be; the limits of depth in between follow at every speed
/// @throws InvalidInput as recommend; where finish limits something that cannot be computed
/// @throws Interrupted  when progress asks to stop
[[nodiscard]] ROBOMILL_API Recommendation choose(const stability::LobesProblem& problem,
                                                 const stability::LobesOptions& lobes,
                                                 const std::vector<stability::Limit>& limits, RecommendOptions options,
                                                 const FinishLimits& finish = {},
                                                 Progress& progress = Progress::none());

}  // namespace robomill::decision
