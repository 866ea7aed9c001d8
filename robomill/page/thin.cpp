#include "robomill/page/thin.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace robomill::page {

std::vector<Eigen::Index> thin(const Eigen::VectorXd& values, Eigen::Index most) {
  const Eigen::Index n = values.size();
  std::vector<Eigen::Index> keep;
  if (n <= most) {
    keep.resize(static_cast<std::size_t>(n));
    std::iota(keep.begin(), keep.end(), Eigen::Index{0});
    return keep;
  }
  const Eigen::Index runs = std::max<Eigen::Index>(most / 2, 1);
  keep.push_back(0);
  for (Eigen::Index run = 0; run < runs; ++run) {
    const Eigen::Index begin = run * n / runs;
    const Eigen::Index end = (run + 1) * n / runs;
    Eigen::Index low = begin;
    Eigen::Index high = begin;
    for (Eigen::Index i = begin; i < end; ++i) {
      if (!std::isfinite(values[i])) continue;
      if (!(values[i] >= values[low])) low = i;
      if (!(values[i] <= values[high])) high = i;
    }
    keep.push_back(std::min(low, high));
    keep.push_back(std::max(low, high));
  }
  keep.push_back(n - 1);
  keep.erase(std::unique(keep.begin(), keep.end()), keep.end());
  return keep;
}

std::vector<Eigen::Index> thin_together(const std::vector<Eigen::VectorXd>& curves, Eigen::Index most) {
  std::vector<Eigen::Index> keep;
  if (curves.empty()) return keep;
  if (curves.front().size() <= most) return thin(curves.front(), most);
  const Eigen::Index share = most / static_cast<Eigen::Index>(curves.size());
  for (const Eigen::VectorXd& curve : curves) {
    const std::vector<Eigen::Index> own = thin(curve, share);
    keep.insert(keep.end(), own.begin(), own.end());
  }
  std::sort(keep.begin(), keep.end());
  keep.erase(std::unique(keep.begin(), keep.end()), keep.end());
  return keep;
}

}  // namespace robomill::page
