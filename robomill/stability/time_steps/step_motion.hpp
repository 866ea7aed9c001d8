#pragma once
#include <Eigen/Core>
#include <array>
#include <complex>
#include <span>
#include <vector>

#include "robomill/stability/eigen/arnoldi.hpp"
#include "robomill/stability/eigen/period_map.hpp"
#include "robomill/stability/vibration/motion.hpp"

namespace robomill::stability::detail {

/// Finds the motions that belong to multipliers: the eigenvectors go through the period once more, for the forces.
class StepMotion {
 public:
  /// Of the lanes of the last Arnoldi::find with this map; zeros where the motion overflows.
  /// @param steps   time steps of the period
  /// @param step_s  length of a time step, for each lane
  void find(const TipDynamics& tip, int steps, std::span<const double> step_s, SteppedMap& map, Arnoldi& arnoldi,
            std::span<const Dominant> dominant, std::span<Motion> out);

 private:
  void apply(SteppedMap& map, std::span<const Eigen::VectorXcd> vectors, bool imaginary);
  [[nodiscard]] Eigen::Vector2cd coefficient(const SteppedMap& map, std::size_t lane, int steps,
                                             std::complex<double> exponent) const;

  std::vector<Lanes> in_, out_;
  std::vector<std::array<Eigen::Vector2cd, lane_count>> forces_;  ///< [cut]
};

}  // namespace robomill::stability::detail
