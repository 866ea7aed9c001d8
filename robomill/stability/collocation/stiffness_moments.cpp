#include "robomill/stability/collocation/stiffness_moments.hpp"

#include <array>
#include <mutex>

#include "robomill/stability/time_steps/piece_plan.hpp"

namespace robomill::stability::detail {
namespace {

NodeTable make_table(int nodes) {
  NodeTable t;
  t.nodes = static_cast<std::size_t>(nodes);
  t.moments = 2 * t.nodes - 1;
  t.rule = &gauss_rule(nodes);
  const GaussRule& exact = gauss_rule(2 * nodes - 1);
  for (std::size_t i = 0; i < t.nodes; ++i) {
    for (std::size_t l = i; l < t.nodes; ++l) {
      for (std::size_t m = 0; m < t.moments; ++m) {
        double sum = 0.0;
        for (std::size_t q = 0; q < exact.node.size(); ++q) {
          const double x = exact.node[q];
          sum += exact.weight[q] * lagrange(t.rule->node, i, x) * lagrange(t.rule->node, l, x) *
                 std::legendre(static_cast<unsigned>(m), 2.0 * x - 1.0);
        }
        t.product.push_back(static_cast<double>(2 * m + 1) * sum);
      }
    }
  }
  return t;
}

}  // namespace

const NodeTable& node_table(int nodes) {
  struct Slot {
    std::once_flag made;
    NodeTable table;
  };
  static std::array<Slot, most_nodes + 1> slots;
  Slot& slot = slots[static_cast<std::size_t>(nodes)];
  std::call_once(slot.made, [&] { slot.table = make_table(nodes); });
  return slot.table;
}

void Moments::flush() {
  for (std::size_t lane = filled_; lane < lane_count; ++lane) batch_.half.v[lane] = batch_.half_rad.v[lane] = 0.0;
  double longest = 0.0;
  for (const double half : batch_.half_rad.v) longest = std::max(longest, half);
  const int points = static_cast<int>(count_) / 2 + 3 + static_cast<int>(std::ceil(longest));
  const GaussRule& rule = gauss_rule(std::min(points, most_gauss_points));
  batch_.count = count_;
  batch_.points = rule.node.size();
  batch_.node = rule.node.data();
  batch_.weight = rule.weight.data();
  batch_.sum = sum_.data();
  if (filled_ > 0) add_moments(batch_);
  filled_ = 0;
}

void Moments::matrix(const NodeTable& t, const Eigen::Matrix3d& turn, Eigen::MatrixXd& out) const {
  std::vector<Eigen::Matrix3d> moment(count_);
  for (std::size_t m = 0; m < count_; ++m) {
    Eigen::Matrix3d k;
    for (std::size_t e = 0; e < spatial_entries; ++e) {
      double sum = 0.0;
      for (const double lane : sum_[e * count_ + m].v) sum += lane;
      k(static_cast<Eigen::Index>(e / 3), static_cast<Eigen::Index>(e % 3)) = sum;
    }
    moment[m].noalias() = turn * k * turn.transpose();
  }
  const Eigen::Index size = 3 * static_cast<Eigen::Index>(t.nodes);
  out.resize(size, size);
  std::size_t pair = 0;
  for (std::size_t i = 0; i < t.nodes; ++i) {
    for (std::size_t l = i; l < t.nodes; ++l, ++pair) {
      const double* share = t.product.data() + pair * count_;
      Eigen::Matrix3d sum = share[0] * moment[0];
      for (std::size_t m = 1; m < count_; ++m) sum += share[m] * moment[m];
      const Eigen::Index row = 3 * static_cast<Eigen::Index>(i);
      const Eigen::Index column = 3 * static_cast<Eigen::Index>(l);
      out.block<3, 3>(row, column) = sum / t.rule->weight[i];
      out.block<3, 3>(column, row) = sum / t.rule->weight[l];
    }
  }
}

}  // namespace robomill::stability::detail
