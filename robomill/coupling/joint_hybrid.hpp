#pragma once
#include <Eigen/Core>

#include "robomill/coupling/joint_model.hpp"

namespace robomill::coupling::detail {

/// The measured FRF and how far each line is to be trusted.
struct JointData {
  Eigen::VectorXcd measured;
  Eigen::ArrayXd deviation;  ///< σ of each line, E|e|² = σ², as far as it is known before the fit
  bool known = false;        ///< whether deviation is the measurement's own, to be left as it is
  double noise_floor = 0.0;  ///< no line is truer than this share of itself
};

/// What the measured FRF brings with it; 1 % of itself where it says nothing.
[[nodiscard]] JointData joint_data(const modal::Frf& frf, const std::vector<Eigen::Index>& lines, double noise_floor);

/// σ² = a² + b² |H|² fitted to what the model misses at each line, by maximum likelihood [Zhou2019]; with known
/// deviations those. Never below the noise floor.
void update_deviation(const JointModel& model, const JointValues& joint, JointData& data);

/// (H model - H) / σ, real parts first.
[[nodiscard]] Eigen::VectorXd joint_residuals(const JointModel& model, const JointValues& joint, const JointData& data);

/// Differential evolution on thinned lines, then least squares on all of them, twice: with the deviations as given and
/// with those of the first fit, which data keeps.
/// @param options  with its bounds set
[[nodiscard]] JointSearch search_by_evolution(const JointModel& model, JointData& data, const JointFitOptions& options,
                                              Progress& progress);

/// Lines for the search: half of them evenly over the logarithm and the number of lines, half where H changes most.
[[nodiscard]] std::vector<Eigen::Index> thinned_lines(const Eigen::ArrayXd& omega, const Eigen::VectorXcd& measured,
                                                      std::size_t count);

}  // namespace robomill::coupling::detail
