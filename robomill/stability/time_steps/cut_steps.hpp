#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

#include "robomill/cutting/milling.hpp"
#include "robomill/stability/lobes.hpp"

namespace robomill::stability::detail {

/// A delay in time steps, whole - fraction: what was whole steps ago counts 1 - fraction, the step after it fraction.
struct Delay {
  int whole = 0;          ///< >= 1
  double fraction = 0.0;  ///< in [0, 1)
};

/// The stiffness of the cut at one axial depth, constant over each time step.
struct DepthPlan {
  double axial_depth_m = 0.0;
  std::vector<Eigen::Matrix2d> stiffness;  ///< [delay * steps + step], mean over the step [N/m]
  std::vector<char> cuts;                  ///< [delay * steps + step]: whether that one is not zero
  double largest_n_per_m = 0.0;            ///< greatest norm of their sum over delays
};

/// A period of the cut, divided into equal time steps: one tooth period with one delay for equal pitch, otherwise one
/// revolution with a delay for each pitch that occurs. Nothing here depends on the spindle speed.
class CutSteps {
 public:
  /// @param intervals  steps in a mean tooth period
  CutSteps(const cutting::Milling& milling, int intervals);

  [[nodiscard]] int steps() const { return steps_; }
  [[nodiscard]] double step_rad() const { return step_rad_; }
  [[nodiscard]] const std::vector<Delay>& delays() const { return delays_; }
  [[nodiscard]] Period period() const { return period_; }
  [[nodiscard]] bool grows_with_depth() const { return !per_depth_.empty(); }
  /// Fills out, whose storage is used again.
  void at_depth(double axial_depth_m, DepthPlan& out) const;

 private:
  void fill(double axial_depth_m, std::vector<Eigen::Matrix2d>& stiffness) const;

  cutting::Milling milling_;
  Period period_ = Period::tooth;
  int steps_ = 0;
  double step_rad_ = 0.0;
  std::vector<Delay> delays_;
  std::vector<int> delay_of_tooth_;
  std::vector<Eigen::Matrix2d> per_depth_;  ///< without helix the stiffness grows with the depth [N/m^2]; else empty
};

/// With a helix the stiffness takes time to find; here it is kept for depths that will be asked for often.
class KnownDepths {
 public:
  /// Does nothing without helix, or where it would cost much memory.
  void expect(const CutSteps& cut, std::span<const double> depths_m);
  /// nullptr where it is not kept.
  [[nodiscard]] const DepthPlan* find(double axial_depth_m) const;

 private:
  std::vector<DepthPlan> plans_;
};

}  // namespace robomill::stability::detail
