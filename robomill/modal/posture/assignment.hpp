#pragma once
#include <Eigen/Core>
#include <vector>

namespace robomill::modal::detail {

/// Pairs rows with columns, each at most once, min(rows, columns) pairs, so that the sum of their costs is least: the
/// Hungarian method by shortest augmenting paths, rows² · columns steps.
/// @param cost  finite
/// @return of each row its column, -1 where it has none
[[nodiscard]] std::vector<Eigen::Index> assign(const Eigen::MatrixXd& cost);

}  // namespace robomill::modal::detail
