#pragma once
#include <vector>

#include "robomill/base/progress.hpp"
#include "robomill/modal/fitting/fit_kernel.hpp"

namespace robomill::modal::detail {

/// Of every ω, in units of FitData, and of every ζ.
struct PoleBounds {
  double omega_low = 0.0, omega_high = 1.0, zeta_low = 1e-6, zeta_high = 0.4;
};

struct RefineOptions {
  PoleBounds bounds = {};
  int max_iterations = 100;
  double tolerance = 1e-12;  // ends when an iteration takes less than this share off the cost
};

struct Refined {
  Poles poles;
  Evaluation at;  // with derivatives
  bool converged = false;
  int iterations = 0;
  std::vector<double> cost;  // at the start and after each iteration
};

/// Bounded nonlinear least squares over poles and left vectors by Levenberg and Marquardt; right vectors and residuals
/// are eliminated [GolubPereyra2003].
[[nodiscard]] Refined refine(const Kernel& kernel, Poles start, const RefineOptions& options, Progress& progress);

}  // namespace robomill::modal::detail
