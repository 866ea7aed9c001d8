#pragma once
#include <Eigen/Core>
#include <vector>

namespace robomill {

/// The middle of the values in order; of an even number the upper of the two. 0 where there are none.
[[nodiscard]] double median(std::vector<double> values);
[[nodiscard]] double median(const Eigen::Ref<const Eigen::VectorXd>& values);

}  // namespace robomill
