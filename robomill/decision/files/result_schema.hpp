#pragma once
#include <Eigen/Core>

#include "robomill/decision/finish.hpp"
#include "robomill/decision/limit_breakdown.hpp"
#include "robomill/decision/recommend.hpp"
#include "robomill/decision/test_cuts.hpp"
#include "robomill/io/schema.hpp"

// What plan.json has of a decision, and the page of recorded cuts.

namespace robomill::decision {

[[nodiscard]] const io::Schema<Operation>& operation_table();
[[nodiscard]] const io::Schema<ComparedCut>& cut_table();
[[nodiscard]] const io::Schema<Recording>& recording_table();
[[nodiscard]] const io::Schema<Agreement>& agreement_table();
[[nodiscard]] const io::Schema<DepthCurve>& curve_table();
[[nodiscard]] const io::Schema<PartLimits>& pair_table();
[[nodiscard]] const io::Schema<LimitShare>& share_table();
/// Null: not asked for.
[[nodiscard]] const io::Schema<FinishLimits>& asked_finish_table();

/// The limit in one direction of the feed.
struct DirectionView {
  const FeedDirections* directions = nullptr;
  Eigen::Index index = 0;
};

[[nodiscard]] const io::Schema<DirectionView>& direction_table();

}  // namespace robomill::decision
