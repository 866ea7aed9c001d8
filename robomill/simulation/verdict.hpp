#pragma once
#include <Eigen/Core>
#include <complex>
#include <vector>

#include "robomill/simulation/simulation.hpp"

namespace robomill::simulation::detail {

/// The multiplier of largest size that advances one snapshot (a column) to the next, by projection on the snapshots'
/// own principal directions [Schmid2010]. 0 where there is no motion.
/// @param snapshots  rows x columns, columns >= 3
[[nodiscard]] std::complex<double> dominant_multiplier(const Eigen::MatrixXd& snapshots);

/// What once-a-period sampling says.
struct Judgement {
  Verdict verdict = Verdict::undecided;
  double growth_per_period = 0.0;
};
/// @param samples  one column a period: displacements at the same phases of each
[[nodiscard]] Judgement judge(const Eigen::MatrixXd& samples, const SmallVibration& small);

struct SpectralLine {
  double frequency_hz = 0.0, amplitude_m = 0.0;
};
/// The strongest motion that does not repeat every `period` samples; nothing where there are fewer than four periods.
/// @param motion  one row a sample, one column a direction
[[nodiscard]] SpectralLine strongest_line(const Eigen::MatrixXd& motion, Eigen::Index period, double sample_rate_hz);

}  // namespace robomill::simulation::detail
