#pragma once
#include <Eigen/Core>

// Method: robomill/report/README.md, "Method"

namespace robomill::report {

/// A curve over equal runs of time: the lowest and the highest value in each.
struct Band {
  Eigen::VectorXd low = {}, high = {};
};

}  // namespace robomill::report
