#pragma once
#include <memory>
#include <string_view>

#include "robomill/stability/point_evaluator.hpp"

namespace robomill::stability::detail {

/// Two more discretizations in time, for comparison; equal pitch alone. Both are of the order 2.
/// @param intervals  steps in a tooth period
/// @throws InvalidInput where the problem has delays or velocities that they do not know
std::unique_ptr<Scheme> first_order_semi_discretization(const LobesProblem& problem, int intervals);
std::unique_ptr<Scheme> full_discretization(const LobesProblem& problem, int intervals);

/// @throws InvalidInput where the delays change with height or time, or velocities cut
void reject_changing_delays(const cutting::Milling& milling, std::string_view method);

}  // namespace robomill::stability::detail
