#pragma once
#include <Eigen/Core>
#include <vector>

#include "robomill/stability/lobes.hpp"

namespace robomill::stability::testing {

/// |dominant multiplier| of one period, found by integrating the delay equation in time from a random start and fitting
/// the last periods' displacements with a two-term recurrence. Shares nothing with semi-discretization: fourth-order
/// Runge-Kutta with the delayed displacement from a cubic through stored values and slopes, the cut edge by edge in
/// axial slices, and each tooth's own delay.
/// @param steps     of a mean tooth period
/// @param periods   how many are simulated
/// @param slices    axial slices; 1 without helix
/// @param teeth_a_period  mean tooth periods in that of the multiplier; 0: one, or N for unequal pitch
/// Process damping takes the modes' velocities alone: the structure's must not jump with the force.
double time_domain_radius(const LobesProblem& problem, const OperatingPoint& point, int steps, int periods,
                          int slices = 1, int teeth_a_period = 0);

}  // namespace robomill::stability::testing
