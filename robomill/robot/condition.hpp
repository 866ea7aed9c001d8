#pragma once
#include <Eigen/Core>

namespace robomill::robot {

/// condition_number() of six joints: allocates nothing, checks nothing.
double condition_of(const Eigen::Matrix<double, 6, 6>& jacobian, double characteristic_length_m) noexcept;

}  // namespace robomill::robot
