#pragma once
#include <Eigen/Core>
#include <vector>

namespace robomill::page {

/// Indices that draw a long curve like the whole one: all of them up to `most`; else the ends and, of each of most / 2
/// equal runs, the lowest and the highest finite value. No maximum and no minimum is lost. Increasing.
[[nodiscard]] std::vector<Eigen::Index> thin(const Eigen::VectorXd& values, Eigen::Index most = 6000);

/// The same for several curves over one axis, equally long: the maxima and minima of each are kept. At most some `most`
/// indices; increasing.
[[nodiscard]] std::vector<Eigen::Index> thin_together(const std::vector<Eigen::VectorXd>& curves,
                                                      Eigen::Index most = 6000);

}  // namespace robomill::page
