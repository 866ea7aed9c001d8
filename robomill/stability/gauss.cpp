#include "robomill/stability/gauss.hpp"

namespace robomill::stability::detail {

double lagrange(const std::vector<double>& node, std::size_t l, double x) {
  double product = 1.0;
  for (std::size_t j = 0; j < node.size(); ++j) {
    if (j != l) product *= (x - node[j]) / (node[l] - node[j]);
  }
  return product;
}

}  // namespace robomill::stability::detail
