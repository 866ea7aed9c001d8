#pragma once
// Which modes: the search around refine().
#include <vector>

#include "robomill/modal/lscf.hpp"
#include "robomill/modal/refine.hpp"

namespace robomill::modal::detail {

struct SearchOptions {
  int modes = 0;       // exactly so many; 0: by the information criterion
  int max_modes = 20;  // where modes is 0
  bool grow = true;    // whether modes may be added where modes is 0
  bool swap = true;    // also try to leave a local minimum
  double omega_low = 0.0, omega_high = 1.0, zeta_low = 1e-6, zeta_high = 0.4;
};

struct Found {
  Refined fit;               // to a coarse tolerance
  std::vector<double> cost;  // after each accepted iteration
  int iterations = 0;
};

/// Whether the information criterion -2 log likelihood + unknowns · log(equations) is lower for `larger`, which has so
/// many real unknowns more than `smaller`; the noise level is estimated, lines that are not independent are counted
/// once [Schwarz1978].
[[nodiscard]] bool worth_it(const FitData& data, const Evaluation& larger, const Evaluation& smaller,
                            double more_unknowns);

/// Refines `start`, then adds modes where the residual is greatest, takes the weakest away and swaps, as long as the
/// criterion (or, at a given number of modes, the cost) falls. Deterministic.
[[nodiscard]] Found search(const Kernel& kernel, const Poles& start, const SearchOptions& options, Progress& progress);

/// Bounds and tolerance of refine() for a search's last fit.
[[nodiscard]] RefineOptions fine_options(const SearchOptions& options);

/// Poles with the first left vector of each mode's least-squares residue matrix.
[[nodiscard]] Poles with_left_vectors(const Kernel& kernel, const Eigen::VectorXd& omega, const Eigen::VectorXd& zeta);

}  // namespace robomill::modal::detail
