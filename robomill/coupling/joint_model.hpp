#pragma once
#include <Eigen/Core>
#include <array>
#include <memory>
#include <vector>

#include "robomill/coupling/beam_element.hpp"
#include "robomill/coupling/distributed.hpp"
#include "robomill/coupling/joint_fit.hpp"

namespace robomill::coupling::detail {

/// k_u, c_u, k_θ, c_θ.
using JointValues = std::array<double, joint_unknowns>;

/// What a search ends with.
struct JointSearch {
  JointValues joint{};
  double start = 0.0;             ///< the least misfit of the random start
  std::vector<double> best = {};  ///< the misfit after each iteration
  JointFitResult::Status status = JointFitResult::Status::not_converged;
};

/// The tip's receptance in one plane as a function of the joint alone. With the tool's beam element (g, t, k), the
/// holder's receptance B and τ the first row of t,
///   H = g_11 + τ (1 + (B + C) k)⁻¹ (B + C) τᵀ,  C = Kc⁻¹,
/// becomes
///   H = H_rigid + vᵀ (Z + Kc)⁻¹ w,  vᵀ = τ (1 + B k)⁻¹,  w = (1 + k B)⁻¹ τᵀ,  Z = k (1 + B k)⁻¹,
/// with Z the dynamic stiffness of tool and holder joined rigidly against their being moved apart at the joint. The
/// rigid joint is Kc → ∞, without a difference of large numbers.
class JointModel {
 public:
  /// @param tool, base  by line
  /// @param frequency_hz  of the lines, > 0
  /// @throws InvalidInput where a line has no receptance, as at a resonance without damping
  JointModel(const std::vector<BeamElement>& tool, const std::vector<Eigen::Matrix2cd>& base,
             const Eigen::VectorXd& frequency_hz, double cross_stiffness_n_per_rad);
  /// Of a joint spread over the shank: H by the climb from its deep end, line by line.
  /// @throws InvalidInput as above
  JointModel(std::shared_ptr<const DistributedTip> tip, const Eigen::VectorXd& frequency_hz,
             double cross_stiffness_n_per_rad);
  /// Of some lines alone, by their numbers.
  [[nodiscard]] JointModel part(const std::vector<Eigen::Index>& lines) const;

  [[nodiscard]] Eigen::Index lines() const { return lines_; }
  /// [rad/s], by line.
  [[nodiscard]] Eigen::Map<const Eigen::ArrayXd> omega() const { return {omega_.data(), lines_}; }
  /// Whether the joint is passive: k_uθ² < k_u k_θ.
  [[nodiscard]] bool allows(const JointValues& joint) const { return joint[0] * joint[2] > cross_ * cross_; }

  /// H, and what it loses for a larger Kc: ∂H/∂K_u = -along[0], ∂H/∂K_θ = -along[1], K = k + iωc. Arrays of at least
  /// lines() numbers, kept between calls so that an evaluation allocates nothing.
  struct Response {
    Eigen::ArrayXd real, imag;
    std::array<Eigen::ArrayXd, 2> along_real, along_imag;
    void resize(Eigen::Index padded, bool derivatives);
  };
  void receptance(const JointValues& joint, Response& response) const;
  void sensitivity(const JointValues& joint, Response& response) const;

 private:
  JointModel() = default;
  void resize(Eigen::Index lines);
  template <bool derivatives>
  void evaluate(const JointValues& joint, Response& response) const;
  void evaluate_distributed(const JointValues& joint, Response& response, bool derivatives) const;

  enum Constant { rigid, v_u, v_theta, w_u, w_theta, z_u, z_theta, z_cross, z_cross_back, z_product, constants };
  Eigen::Index lines_ = 0;
  double cross_ = 0.0;
  std::vector<double> omega_;
  std::array<std::vector<double>, constants> real_, imag_;  // padded to whole vectors
  std::shared_ptr<const DistributedTip> distributed_;       // null: a joint at the mouth
  std::vector<std::size_t> line_of_;                        // of distributed_
};

}  // namespace robomill::coupling::detail
