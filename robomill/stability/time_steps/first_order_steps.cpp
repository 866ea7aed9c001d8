#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "robomill/base/linear_algebra.hpp"
#include "robomill/stability/gauss.hpp"
#include "robomill/stability/time_steps/lane_math.hpp"
#include "robomill/stability/time_steps/node_steps.hpp"
#include "robomill/stability/time_steps/speed_plan.hpp"

namespace robomill::stability::detail {
namespace {

/// z' = P z - A d_before - B d_after: a step with constant stiffness under a delayed displacement that is linear in
/// time, exact as Monodromy's blocks are.
class FirstOrderSteps final : public NodeSteps {
 public:
  using NodeSteps::NodeSteps;

 private:
  void build(std::span<const NodePoint> points) override;
  void cut_step(std::size_t cut, const Lanes* position, const Lanes* before, const Lanes* after, Lanes* z) override;
  void build_block(const SpeedPlan& speed, const Eigen::Matrix2d& stiffness);

  std::array<SpeedPlan, lane_count> speeds_;
  std::vector<Lanes> blocks_;  ///< [cut][2n][2n + 4]
  std::vector<Lanes> start_;   ///< z and what is remembered, at the start of the step
  Eigen::MatrixXd system_, nodes_, forces_, block_, next_;
};

/// Leaves [P, -A, -B] in block_.
void FirstOrderSteps::build_block(const SpeedPlan& speed, const Eigen::Matrix2d& stiffness) {
  const Eigen::Index modal = speed.at_nodes.cols();
  const Eigen::Index count = speed.at_nodes.rows();
  const GaussRule& rule = gauss_rule(speed.resolution.nodes);
  // f = K (V z + G f - d) at the Gauss points.
  nodes_.resize(count, modal + 4);
  nodes_.leftCols(modal) = speed.at_nodes;
  system_ = Eigen::MatrixXd::Identity(count, count);
  for (Eigen::Index j = 0; j < count / 2; ++j) {
    const double at = rule.node[static_cast<std::size_t>(j)];
    nodes_.block<2, 2>(2 * j, modal) = -(1.0 - at) * Eigen::Matrix2d::Identity();
    nodes_.block<2, 2>(2 * j, modal + 2) = -at * Eigen::Matrix2d::Identity();
    system_.middleRows<2>(2 * j).noalias() -= stiffness * speed.response.middleRows<2>(2 * j);
    nodes_.middleRows<2>(2 * j) = (stiffness * nodes_.middleRows<2>(2 * j)).eval();
  }
  forces_ = linear_algebra::solve(system_, nodes_);
  block_.noalias() = speed.influence * forces_;
  for (Eigen::Index k = 0; k < modal / 2; ++k) {
    const std::complex<double> factor = speed.substep(k);
    block_(2 * k, 2 * k) += factor.real();
    block_(2 * k, 2 * k + 1) -= factor.imag();
    block_(2 * k + 1, 2 * k) += factor.imag();
    block_(2 * k + 1, 2 * k + 1) += factor.real();
  }
  for (int i = 0; i < speed.resolution.halvings; ++i) {
    // Two in a row: the first ends, the second starts, at the mean of the ends.
    const auto from = block_.middleCols<2>(modal);
    const auto to = block_.middleCols<2>(modal + 2);
    next_.resize(modal, modal + 4);
    next_.noalias() = block_.leftCols(modal) * block_;
    const Eigen::MatrixX2d middle = 0.5 * (next_.middleCols<2>(modal + 2) + from);
    next_.middleCols<2>(modal) += middle;
    next_.middleCols<2>(modal + 2) = middle + to;
    block_.swap(next_);
  }
}

void FirstOrderSteps::build(std::span<const NodePoint> points) {
  const std::size_t modal = modal_size();
  const std::size_t columns = modal + 4;
  start_.resize(columns);
  blocks_.resize(contacts().size() * modal * columns);
  if (contacts().empty()) return;
  const SpeedPlan* speed = nullptr;
  for (std::size_t lane = 0; lane < lane_count; ++lane) {
    const Resolution needed = resolution(tip(), points[lane].step_s, points[lane].halves->largest_n_per_m);
    const auto fits = [&](const SpeedPlan& plan) {
      return plan.step_s == points[lane].step_s && plan.resolution.nodes == needed.nodes &&
             plan.resolution.halvings == needed.halvings;
    };
    if (speed == nullptr || !fits(*speed)) {
      if (!fits(speeds_[lane])) plan_speed(tip(), points[lane].step_s, needed, speeds_[lane]);
      speed = &speeds_[lane];
    }
    for (std::size_t cut = 0; cut < contacts().size(); ++cut) {
      build_block(*speed, 0.5 * (contacts()[cut].left[lane] + contacts()[cut].right[lane]));
      Lanes* to = blocks_.data() + cut * modal * columns;
      for (std::size_t r = 0; r < modal; ++r) {
        for (std::size_t c = 0; c < columns; ++c) {
          (to++)->v[lane] = block_(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(c));
        }
      }
    }
  }
}

void FirstOrderSteps::cut_step(std::size_t cut, const Lanes*, const Lanes* before, const Lanes* after, Lanes* z) {
  const std::size_t modal = modal_size();
  std::copy(z, z + modal, start_.begin());
  std::copy(before, before + 2, start_.begin() + static_cast<std::ptrdiff_t>(modal));
  std::copy(after, after + 2, start_.begin() + static_cast<std::ptrdiff_t>(modal + 2));
  const Lanes* block = blocks_.data() + cut * modal * (modal + 4);
  for (std::size_t r = 0; r < modal; ++r) {
    Lanes sum = {};
    for (const Lanes& entry : start_) add_product(sum, *block++, entry);
    z[r] = sum;
  }
}

}  // namespace

std::unique_ptr<NodeSteps> first_order_steps(const TipDynamics& tip, int steps) {
  return std::make_unique<FirstOrderSteps>(tip, steps);
}

}  // namespace robomill::stability::detail
