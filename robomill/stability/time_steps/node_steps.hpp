#pragma once
#include <Eigen/Core>
#include <array>
#include <complex>
#include <memory>
#include <span>
#include <vector>

#include "robomill/stability/eigen/period_map.hpp"
#include "robomill/stability/time_steps/cut_steps.hpp"
#include "robomill/stability/vibration/tip_dynamics.hpp"

namespace robomill::stability::detail {

/// One point of the chart for NodeSteps.
struct NodePoint {
  double step_s = 0.0;                ///< length of a time step
  const DepthPlan* halves = nullptr;  ///< the stiffness of the cut, its mean over each half of a step
};

/// The map over one tooth period in equal steps, for eight points at once, that remembers the displacements q_i at the
/// borders of the steps and takes them as linear between. Equal pitch alone: the delay is the period.
///
/// F = K (q - q_d) with q = V z + S F is solved for F = K' (V z - q_d), K' = (I - K S)^-1 K. The state is the 2n
/// numbers of the modes and two displacements for each border of a step in which some tooth cuts. Where the structure
/// has a static compliance S, q_i = V z_i + S F_i with F_i of the stiffness in the halves beside the border, averaged.
class NodeSteps : public SteppedMap {
 public:
  /// tip must outlive this.
  NodeSteps(const TipDynamics& tip, int steps);

  /// Takes one to eight points; lanes left over repeat the last.
  void prepare(std::span<const NodePoint> points);
  [[nodiscard]] std::size_t size() const override { return modal_ + 2 * records_; }
  [[nodiscard]] std::size_t modal_size() const override { return modal_; }
  void apply(const Lanes* in, Lanes* out) override;
  [[nodiscard]] const std::vector<int>& cut_steps() const override { return cut_numbers_; }
  [[nodiscard]] const Lanes* force(std::size_t cut) const override { return contacts_[cut].force; }

 protected:
  /// A step that cuts.
  struct Contact {
    std::array<Eigen::Matrix2d, lane_count> left, right;  ///< K', mean over each half of the step [N/m]
    Lanes mean[4] = {};                                   ///< over the step
    Lanes force[2] = {};                                  ///< out: mean over the step [N]
  };
  /// Makes what cut_step needs of contacts() and the points, of which there are eight.
  virtual void build(std::span<const NodePoint> points) = 0;
  /// Takes z over a step that cuts.
  /// @param position  V z at its start
  /// @param before, after  the displacement one period ago, at its start and end
  virtual void cut_step(std::size_t cut, const Lanes* position, const Lanes* before, const Lanes* after, Lanes* z) = 0;

  [[nodiscard]] const TipDynamics& tip() const { return tip_; }
  [[nodiscard]] const std::vector<Contact>& contacts() const { return contacts_; }
  /// V z, V being 2 x 2n.
  void displacement(const Lanes* z, Lanes* out) const;

 private:
  /// A step that cuts, or several that do not.
  struct Segment {
    int number = 0;         ///< of its first step
    int coast = 0;          ///< how many steps without contact; 0: one that cuts
    std::size_t index = 0;  ///< among the cuts, or among the coasts
  };
  void lay_out();
  void fill_contacts(std::span<const NodePoint> points);
  void fill_coasts(std::span<const NodePoint> points);
  void fill_compliance();
  void record(int node, const Lanes* in, Lanes* out);
  void find_forces(const Lanes* in, const Lanes* out);
  [[nodiscard]] std::size_t record_of(int node) const;

  const TipDynamics& tip_;
  int steps_;
  std::size_t modal_;
  bool compliant_;
  std::vector<double> displacement_;
  std::vector<char> pattern_, wanted_pattern_;  ///< [step]: whether it cuts
  // What the pattern says.
  std::vector<Segment> segments_;
  std::vector<int> cut_numbers_, coast_lengths_, record_of_node_;
  std::size_t records_ = 0;
  // What the points say.
  std::vector<Contact> contacts_;
  std::vector<Lanes> coasts_;      ///< 2n for each coast: factor of each mode
  std::vector<Lanes> compliance_;  ///< [record][4]: S K'
  std::vector<Lanes> state_;       ///< z
  std::vector<Lanes> position_;    ///< [step + 1][2]: V z at the borders beside a cut
};

/// Semi-discretization of first order [Insperger2008]: K' is its mean over the step, the motion within is exact.
std::unique_ptr<NodeSteps> first_order_steps(const TipDynamics& tip, int steps);
/// Full-discretization [Ding2010]: the modal state is linear within the step under the integral, and so is K'.
std::unique_ptr<NodeSteps> full_steps(const TipDynamics& tip, int steps);

}  // namespace robomill::stability::detail
