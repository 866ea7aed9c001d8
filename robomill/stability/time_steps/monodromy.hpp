#pragma once
#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "robomill/stability/eigen/kernels.hpp"
#include "robomill/stability/eigen/period_map.hpp"
#include "robomill/stability/time_steps/cut_steps.hpp"
#include "robomill/stability/time_steps/speed_plan.hpp"

namespace robomill::stability::detail {

/// One point of the chart, given by its speed and its depth.
struct LanePoint {
  const SpeedPlan* speed = nullptr;
  const DepthPlan* depth = nullptr;
};

/// The map of the state over one period, for eight points at once, without its matrix.
///
/// In step i the force is F = K_i q - Σ_g K_gi d_g: K is its mean over the step and d_g, the displacement one delay g
/// ago, is held. The motion within the step is solved exactly: semi-discretization of order zero. What is remembered of
/// a step is its mean displacement, (q_i + q_{i+1}) / 2 of the modes and S times the mean force; for a delay of whole
/// steps this is the published weighting, one half of either end. Only steps that some tooth looks back at are
/// remembered, so that the state is the 2n numbers of the modes and two for each of those steps.
class Monodromy final : public SteppedMap {
 public:
  /// Both must outlive this.
  Monodromy(const TipDynamics& tip, const CutSteps& cut);

  /// Takes one to eight points, whose speeds have one resolution; lanes left over repeat the last.
  void prepare(std::span<const LanePoint> points);
  /// Length of the state for the points at hand.
  [[nodiscard]] std::size_t size() const override { return modal_ + 2 * outputs_.size(); }
  [[nodiscard]] std::size_t modal_size() const override { return modal_; }
  void apply(const Lanes* in, Lanes* out) override;

  [[nodiscard]] const std::vector<int>& cut_steps() const override { return cut_numbers_; }
  [[nodiscard]] const Lanes* force(std::size_t cut) const override { return contacts_[cut].force; }

 private:
  void lay_out();
  void add_step(int number, bool cuts, int record);
  void fill_speeds(std::span<const LanePoint> points);
  void fill_contacts(std::span<const LanePoint> points);
  void build_blocks();

  const TipDynamics& tip_;
  const CutSteps& cut_;
  std::size_t modal_;
  std::vector<double> displacement_;
  std::array<Lanes, 4> compliance_ = {};
  bool compliant_;
  std::vector<char> pattern_, wanted_pattern_;  ///< [delay * steps + step]
  // What the pattern says.
  std::vector<Step> steps_;
  std::vector<Reference> references_;
  std::vector<int> cut_numbers_, coast_lengths_;
  std::vector<std::size_t> outputs_;
  // What the points say.
  Resolution resolution_ = {};
  std::vector<StepContact> contacts_;
  std::vector<Lanes> substep_, at_nodes_, response_, influence_, coasts_, blocks_;
  std::vector<Lanes> memory_, state_, work_;
};

}  // namespace robomill::stability::detail
