#pragma once
#include "robomill/stability/collocation/collocation_model.hpp"

namespace robomill::stability::detail {

/// How many periods of the cutter make a whole number of swings.
/// @throws InvalidInput if more than 256 would
[[nodiscard]] int common_repeats(const cutting::SpeedVariation& variation, double period_rad);

/// A cylindrical cutter in the plane.
class MillingModel final : public CollocationModel {
 public:
  /// @throws InvalidInput if swing and cut of a varied speed have no common period of a sensible length
  explicit MillingModel(const LobesProblem& problem, MeshTopology::Form least = MeshTopology::Form::chip);

  TipDynamics tip;
  cutting::SpeedVariation variation;
  CutterContacts contacts;  ///< its angles and delays; where slices count, see MeshLevel
  cutting::Milling milling;
  int repeats = 1;                 ///< of the cutter's period in that of the whole
  double fastest_rad_per_s = 0.0;  ///< of the modes
  /// By how much the cut quickens the structure: the square of its rate grows by this with the depth [rad^2/(s^2 m)].
  double quickening = 0.0;
  MeshTopology::Form least = MeshTopology::Form::chip;  ///< remember no less

  [[nodiscard]] std::size_t modes() const override { return static_cast<std::size_t>(tip.pole.size()); }
  [[nodiscard]] bool depends_on_depth() const override { return contacts.depends_on_depth(); }
  [[nodiscard]] double factor(const OperatingPoint& point) const override { return point.axial_depth_m * point.gain; }
  [[nodiscard]] int first_level(const OperatingPoint& point, double tolerance) const override;
  [[nodiscard]] std::size_t largest_state() const override { return 12000; }
  [[nodiscard]] double reported_rad() const override;
  [[nodiscard]] double whole_rad() const override { return contacts.period_rad() * repeats; }
  [[nodiscard]] Motion motion(const CollocationCase& at, double factor, std::complex<double> multiplier,
                              const Eigen::VectorXcd& vector) const override;

 private:
  void make(const OperatingPoint& point, const MeshLevel& level, const CollocationCase* beside,
            CollocationCase& out) const override;
};

}  // namespace robomill::stability::detail
