#pragma once
#include <string>
#include <vector>

#include "robomill/stability/compare.hpp"
#include "robomill/stability/lobes.hpp"
#include "robomill/stability/sweep.hpp"
#include "robomill/stability/uncertainty.hpp"

/// Tables of a chart; a cell without a number or a name is empty.
namespace robomill::stability {

/// A row a spindle speed: its limit, where chatter starts there and of what; with samples the quantiles of the limit,
/// on straight lines between the speeds that they are known at.
[[nodiscard]] std::string limits_csv(const LobesResult& result, const UncertainLimits& uncertain = {});

/// A row a point. @param parameter  whose value stands in place of the axial depth
[[nodiscard]] std::string points_csv(const std::vector<PointResult>& points,
                                     SweptParameter parameter = SweptParameter::axial_depth);

/// A row an interval in which a speed is stable; a speed that is stable nowhere has one without an interval.
[[nodiscard]] std::string sweep_csv(const SweepResult& result);

/// A row a method.
[[nodiscard]] std::string comparison_csv(const MethodComparison& comparison);

}  // namespace robomill::stability
