#pragma once
#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/cutting/milling.hpp"
#include "robomill/decision/recommend.hpp"
#include "robomill/stability/lobes.hpp"

// Method: robomill/decision/README.md, "What makes the limit (`limit_breakdown.hpp`)"

namespace robomill::decision {

/// "chatter of mode 8 at 543.7 Hz": what limits an operation.
[[nodiscard]] ROBOMILL_API std::string limited_by_text(const Operation& operation);

/// Limits of some modes alone.
struct PartLimits {
  std::string label = {};                        ///< "modes 1–2"
  std::vector<int> modes = {};                   ///< from 1
  Eigen::VectorXd spindle_speed_rad_per_s = {};  ///< length n, increasing
  Eigen::VectorXd limit_depth_m = {};            ///< length n; NaN: none up to the deepest cut of the lobes
};
/// Of each pair of neighbouring modes, over the speeds of the options; none of fewer than three modes, or where some
/// are left out.
/// @throws InvalidInput as stability::limit_depths; Interrupted
[[nodiscard]] ROBOMILL_API std::vector<PartLimits> limits_of_pairs(const stability::LobesProblem& problem,
                                                                   const stability::LobesOptions& options,
                                                                   Progress& progress);

/// The limit over the direction of the feed. NaN: none up to the deepest cut of the lobes.
struct FeedDirections {
  Eigen::VectorXd direction_rad = {};     ///< length n, increasing, counter-clockwise from x of the FRFs
  Eigen::VectorXd lowest_limit_m = {};    ///< length n, lowest over all speeds
  Eigen::VectorXd limit_at_speed_m = {};  ///< length n, at the speed asked for; empty where there is none
};
/// A robot is not the same in every direction.
/// @param at_rad_per_s  a speed whose limit is wanted too
/// @throws InvalidInput as stability::limit_depths; Interrupted
[[nodiscard]] ROBOMILL_API FeedDirections limits_over_feed(const stability::LobesProblem& problem,
                                                           const stability::LobesOptions& options,
                                                           std::optional<double> at_rad_per_s, Progress& progress);

/// Depth over spindle speed that something else than chatter limits.
struct DepthCurve {
  std::string label = {};                        ///< "spindle torque"
  Eigen::VectorXd spindle_speed_rad_per_s = {};  ///< length n, increasing
  Eigen::VectorXd axial_depth_m = {};            ///< length n
};
/// Of the spindle's torque and power, and of the cutter, as far as they are given.
/// @param chart  whose speeds the cutter's depth is drawn over
[[nodiscard]] ROBOMILL_API std::vector<DepthCurve> other_limits(const cutting::Milling& milling,
                                                                const MachineLimits& machine,
                                                                const stability::LobesOptions& chart);

/// Each mode's share of the speeds at which some mode limits the depth, in [0, 1]; empty where none does.
struct LimitShare {
  Eigen::VectorXd tool, workpiece;  ///< one a mode of each
};
[[nodiscard]] ROBOMILL_API LimitShare limit_share(const std::vector<stability::Limit>& limits,
                                                  const modal::ModalModel& tool, const modal::ModalModel& workpiece);

}  // namespace robomill::decision
