#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "robomill/base/progress.hpp"
#include "robomill/modal/fit.hpp"
#include "robomill/modal/frf.hpp"
#include "robomill/modal/modes.hpp"

namespace robomill::modal {

/// How the particle swarm searches. The numbers are the published ones where the source states them; those that a
/// document sets have their defaults in FitOptions.
struct PsoOptions {
  /// Modes in all, dealt evenly over the excitations, the first ones getting the rest. 0: of every excitation one a
  /// peak, and one more at the broadest as long as the misfit is above 1 % and that takes a fifth of it away.
  int modes = 0;
  /// Where to look, for every excitation [Hz]; empty: peaks are picked.
  std::vector<double> peaks_hz = {};
  /// A frequency stays within this share of the named one; of a picked peak within its half-power half width, which is
  /// kept between 1 % and this. In (0, 1); not stated.
  double frequency_half_width = FitOptions{}.pso_frequency_half_width;
  /// Upper bound of every damping ratio, in (0, 1]. Stated is 1, but four of the eight published ratios are exactly
  /// 0.1.
  double max_damping_ratio = FitOptions{}.pso_max_damping_ratio;
  /// The swarm sees about so many lines, evenly over the logarithm of frequency, and 15 more around every peak; >= 20,
  /// 0: all lines; not stated. Evenly spaced lines show next to nothing of the lowest modes.
  int lines = 320;
  int particles = FitOptions{}.pso_particles;            ///< >= 2
  int max_iterations = FitOptions{}.pso_max_iterations;  ///< >= 1
  double inertia_start =
      FitOptions{}.pso_inertia_start;  ///< falls linearly from here at the first iteration, in [0, 1]
  double inertia_end =
      FitOptions{}.pso_inertia_end;  ///< to here at inertia_iterations, where it stays, in [0, inertia_start]
  /// Iterations over which the inertia falls, >= 1, at most max_iterations. Stated are all 8,000 (eq. 4-25): it would
  /// stand at 0.88 where the published fits stop (281 and 284 iterations), and a swarm with pulls of 2 contracts only
  /// below 0.5 ([Poli2009]).
  int inertia_iterations = FitOptions{}.pso_inertia_iterations;
  double cognitive = FitOptions{}.pso_cognitive;  ///< c1, pull of a particle's own best, in [0, 100]
  double social = FitOptions{}.pso_social;        ///< c2, pull of the swarm's best, in [0, 100]
  /// No velocity component exceeds this share of its unknown's range, in [0, 1]; not stated. 0: no bound, and the first
  /// velocities are those of 0.1. With the published inertia and pulls a free swarm's steps grow until it lies at its
  /// bounds.
  double velocity_fraction = FitOptions{}.pso_velocity_fraction;
  /// Converged when, the inertia having come down, the best misfit fell by no more than stall_tolerance of itself over
  /// stall_iterations; not stated.
  int stall_iterations = 20;      ///< >= 1
  double stall_tolerance = 1e-3;  ///< >= 0
  std::uint64_t seed = 1;

  /// @throws InvalidInput naming the field
  void validate() const;
};

/// Of the iteration's moves; iterations count from 1.
[[nodiscard]] double inertia(const PsoOptions& options, int iteration);

/// The fit of one excitation's FRFs.
struct PsoRun {
  enum class Stop { converged, max_iterations };
  Dof excitation;
  std::vector<double> peaks_hz;  ///< of each mode searched for, by rising frequency
  std::vector<double> best;      ///< best misfit of the first swarm and after each iteration: length iterations + 1
  std::size_t terms = 0;         ///< pairs of line and FRF that the misfit is the mean of
  int iterations = 0;
  Stop stop = Stop::max_iterations;
};

struct PsoResult {
  ModalModel model;          ///< all runs' modes, by rising frequency
  std::vector<PsoRun> runs;  ///< one an excitation, in the order of model.excitations
  std::vector<double> best;  ///< mean misfit over all FRFs and the swarms' lines: the runs' best, a finished run
                             ///< holding its last
  int iterations = 0;        ///< of the longest run
  bool converged = false;    ///< whether every run stopped for that reason
  std::vector<std::string> notes;
};

/// Fits modes by particle swarm, one swarm for each excitation.
///
/// An excitation's unknowns are, for each mode, frequency, damping ratio in (0, 1), and real and imaginary part of left
/// vector's component there and of the right vector's components, these within ±1 in units of sqrt(4 |H| ζ ω) of its
/// peak. (The published ten unknowns include left's component in the direction that was not hit; it enters no FRF of
/// that hit, so it is left out: eight for two responses.) The swarm minimises the mean over its lines and the FRFs of
/// |H_fit - H| / |H|:
///   v = w v + c1 r1 (own best - x) + c2 r2 (swarm's best - x), held to velocity_fraction of each range;  x += v,
/// with r1, r2 uniform in [0, 1) for every component (velocity_fraction 0: v is not held); a particle that meets a
/// bound stops there in that component.
///
/// Each excitation's modes are a set of their own, as in the source: in the model, left is zero at the other
/// excitations, right is zero at responses not measured with it, and a physical mode that both hits excite stands there
/// twice. The result depends on the seed and not on the number of threads.
/// @param frfs  receptances, cut to the band to be fitted
/// @throws InvalidInput if the FRFs or the options are not valid, an excitation has no peak, there are fewer modes than
///         excitations, or more unknowns than the data has numbers
/// @throws Interrupted  when progress says so
/// Source: [RobotMillingChatter] ch. 4; [Kennedy1995]; inertia [Shi1998]
[[nodiscard]] PsoResult fit_pso(const FrfSet& frfs, const PsoOptions& options, Progress& progress = Progress::none());

}  // namespace robomill::modal
