#pragma once
// Which modes: the search around refine().
#include <vector>

#include "robomill/modal/fitting/lscf.hpp"
#include "robomill/modal/fitting/refine.hpp"

namespace robomill::modal::detail {

struct SearchOptions {
  int modes = 0;       // exactly so many; 0: by the information criterion
  int max_modes = 20;  // where modes is 0
  bool grow = true;    // whether modes may be added where modes is 0
  bool swap = true;    // also try to leave a local minimum
  PoleBounds bounds = {};
};

struct Found {
  Refined fit;               // to a coarse tolerance
  std::vector<double> cost;  // after each accepted iteration
  int iterations = 0;
};

/// How far two fits to the same data are apart: twice the logarithm of the ratio of likelihoods, the noise level
/// estimated, and how many independent real equations it rests on, lines whose residuals are alike counted once.
struct Evidence {
  double gain = 0.0;  // of the fit with more unknowns
  double equations = 0.0;
  /// By Schwarz's criterion, for unknowns that make a mode [Schwarz1978].
  [[nodiscard]] bool supports_mode(double more_unknowns) const;
  /// Whether noise alone would hardly do it: above mean and two standard deviations of χ².
  [[nodiscard]] bool is_significant(double more_unknowns) const;
};
[[nodiscard]] Evidence evidence(const FitData& data, const Evaluation& larger, const Evaluation& smaller);

/// Refines `start`, then adds modes where the residual is greatest, takes the weakest away and swaps, as long as the
/// criterion (or, at a given number of modes, the cost) falls. Deterministic.
[[nodiscard]] Found search(const Kernel& kernel, const Poles& start, const SearchOptions& options, Progress& progress);

/// Whether no mode stands at a bound of damping or at the edge of the band, for something that is no mode in the band.
[[nodiscard]] bool all_inside(const Poles& poles, const PoleBounds& bounds);

/// Bounds and tolerance of refine() for a search's last fit.
[[nodiscard]] RefineOptions fine_options(const SearchOptions& options);

/// Poles with the first left vector of each mode's least-squares residue matrix.
[[nodiscard]] Poles with_left_vectors(const Kernel& kernel, const Eigen::VectorXd& omega, const Eigen::VectorXd& zeta);

}  // namespace robomill::modal::detail
