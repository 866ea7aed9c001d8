#include <Eigen/LU>
#include <array>
#include <cmath>

#include "robomill/stability/time_steps/lane_math.hpp"
#include "robomill/stability/time_steps/node_steps.hpp"

namespace robomill::stability::detail {
namespace {

using Complex = std::complex<double>;

/// ∫_0^1 exp(x (1 - σ)) w(σ) dσ for w = (1 - σ)^2, σ (1 - σ), σ^2.
std::array<Complex, 3> weights(Complex x) {
  // φ_j = ∫ exp(x (1 - σ)) σ^(j-1) / (j-1)! dσ, with φ_{j+1} = (φ_j - 1/j!) / x: downwards from a series where x is
  // small, as upwards it would lose digits.
  std::array<Complex, 4> phi;
  if (std::abs(x) < 1.0) {
    Complex term = 1.0 / 6.0;
    phi[3] = term;
    for (int j = 1; j < 20; ++j) {
      term *= x / (j + 3.0);
      phi[3] += term;
    }
    phi[2] = x * phi[3] + 0.5;
    phi[1] = x * phi[2] + 1.0;
  } else {
    phi[1] = (std::exp(x) - 1.0) / x;
    phi[2] = (phi[1] - 1.0) / x;
    phi[3] = (phi[2] - 0.5) / x;
  }
  const Complex square = 2.0 * phi[3];
  return {phi[1] - 2.0 * phi[2] + square, phi[2] - square, square};
}

/// Duhamel's integral of each mode over a step, with K' and the slip u = V z - d both linear in time: their product
/// brings three force vectors, K_0 u_0, K_0 u_1 + K_1 u_0 and K_1 u_1, and nothing but a system of 2 x 2 for the slip
/// u_1 at the end.
///
/// K' within the step is the line with its mean over each half. [Ding2010] takes the line through the values at both
/// ends; the halves keep the order where a tooth enters or leaves within the step.
class FullSteps final : public NodeSteps {
 public:
  using NodeSteps::NodeSteps;

 private:
  struct Cut {
    Lanes start[4] = {}, end[4] = {};  ///< K' at the ends of the line
    Lanes implicit[4] = {};            ///< (I - C_01 K_0 - C_11 K_1)^-1
  };
  void build(std::span<const NodePoint> points) override;
  void cut_step(std::size_t cut, const Lanes* position, const Lanes* before, const Lanes* after, Lanes* z) override;

  std::vector<Cut> cuts_;
  std::vector<Lanes> step_;                      ///< 2n: exp(pole h)
  std::array<std::vector<Lanes>, 3> influence_;  ///< 2n x 2, of each force vector on the modes
};

void FullSteps::build(std::span<const NodePoint> points) {
  const std::size_t modal = modal_size();
  step_.resize(modal);
  for (auto& influence : influence_) influence.resize(2 * modal);
  cuts_.resize(contacts().size());
  const Eigen::Matrix2d one = Eigen::Matrix2d::Identity();
  for (std::size_t lane = 0; lane < lane_count; ++lane) {
    const double h = points[lane].step_s;
    std::array<Eigen::Matrix2d, 3> response;  // displacement at the end, of each force vector
    response.fill(Eigen::Matrix2d::Zero());
    for (Eigen::Index k = 0; k < tip().pole.size(); ++k) {
      const std::size_t row = 2 * static_cast<std::size_t>(k);
      const Complex factor = std::exp(tip().pole(k) * h);
      step_[row].v[lane] = factor.real();
      step_[row + 1].v[lane] = factor.imag();
      const std::array<Complex, 3> weight = weights(tip().pole(k) * h);
      for (std::size_t i = 0; i < 3; ++i) {
        const Eigen::Vector2cd gain = tip().left.col(k) * (h * weight[i]);
        response[i] += 2.0 * (tip().right.col(k) * gain.transpose()).real();
        for (std::size_t axis = 0; axis < 2; ++axis) {
          const Complex entry = gain(static_cast<Eigen::Index>(axis));
          influence_[i][2 * row + axis].v[lane] = entry.real();
          influence_[i][2 * row + 2 + axis].v[lane] = entry.imag();
        }
      }
    }
    for (std::size_t cut = 0; cut < cuts_.size(); ++cut) {
      const Eigen::Matrix2d& left = contacts()[cut].left[lane];
      const Eigen::Matrix2d& right = contacts()[cut].right[lane];
      const Eigen::Matrix2d start = 1.5 * left - 0.5 * right;
      const Eigen::Matrix2d end = 1.5 * right - 0.5 * left;
      set(cuts_[cut].start, lane, start);
      set(cuts_[cut].end, lane, end);
      set(cuts_[cut].implicit, lane, (one - response[1] * start - response[2] * end).inverse());
    }
  }
}

void FullSteps::cut_step(std::size_t cut, const Lanes* position, const Lanes* before, const Lanes* after, Lanes* z) {
  const std::size_t modal = modal_size();
  const Cut& c = cuts_[cut];
  // What is known at the start: two force vectors, but for the part of the second that the end has in it.
  const Lanes slip[2] = {difference(position[0], before[0]), difference(position[1], before[1])};
  Lanes first[2] = {}, mixed[2] = {};
  add_product(c.start, slip, first);
  add_product(c.end, slip, mixed);
  turn(step_.data(), modal, z);
  const auto add = [&](std::size_t i, const Lanes* force) {
    const Lanes* influence = influence_[i].data();
    for (std::size_t r = 0; r < modal; ++r) {
      add_product(z[r], influence[2 * r], force[0]);
      add_product(z[r], influence[2 * r + 1], force[1]);
    }
  };
  add(0, first);
  add(1, mixed);
  Lanes explicit_part[2];
  displacement(z, explicit_part);
  const Lanes known[2] = {difference(explicit_part[0], after[0]), difference(explicit_part[1], after[1])};
  Lanes end_slip[2] = {}, last[2] = {};
  add_product(c.implicit, known, end_slip);
  mixed[0] = mixed[1] = Lanes{};
  add_product(c.start, end_slip, mixed);
  add_product(c.end, end_slip, last);
  add(1, mixed);
  add(2, last);
}

}  // namespace

std::unique_ptr<NodeSteps> full_steps(const TipDynamics& tip, int steps) {
  return std::make_unique<FullSteps>(tip, steps);
}

}  // namespace robomill::stability::detail
