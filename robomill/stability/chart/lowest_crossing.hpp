#pragma once
#include <functional>
#include <span>
#include <vector>

#include "robomill/stability/point_evaluator.hpp"

namespace robomill::stability::detail {

/// Radii along one line of the chart: depths, or gains.
using LookAlong = std::function<void(std::span<const double> at, const Ask& ask, std::span<Outcome> out)>;

struct CrossingOptions {
  double tolerance = 1e-4;  ///< |radius - 1| there
  int coarse_level = 1, level = 2;
  std::size_t at_a_time = 1;  ///< marks that are worth looking at together
  bool cheap_lanes = false;   ///< eight places cost what one does
  bool estimate = true;       ///< of the error, where it ends
};

/// The lowest place where the radius is 1.
struct Crossing {
  enum class Status { found, none, at_start } status = Status::none;
  double at = 0.0;
  double slope = 0.0;    ///< d ln radius / d ln at; 0 where not found
  Outcome outcome = {};  ///< with estimate and motion
};

/// The marks are looked at from the lowest up to the first that is unstable, and between two of them where a parabola
/// through three of them has its top near 1. What was found is refined by Newton's rule within its bracket.
/// @param marks  increasing, > 0
Crossing lowest_crossing(const LookAlong& look, const std::vector<double>& marks, const CrossingOptions& options);

}  // namespace robomill::stability::detail
