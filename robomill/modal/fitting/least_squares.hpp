#pragma once
#include <ceres/ceres.h>

#include <exception>
#include <vector>

#include "robomill/base/progress.hpp"

/// How Ceres runs here: dense, on one thread, silent, and stopped when progress says so.
namespace robomill::modal::detail {

/// Keeps the curve of the cost; an Interrupted must not pass through Ceres, so it waits here.
class Watch : public ceres::IterationCallback {
 public:
  Watch(Progress& progress, std::vector<double>& cost) : progress_(progress), cost_(cost) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    cost_.push_back(2.0 * summary.cost);
    try {
      progress_.check();
    } catch (...) {
      stopped_ = std::current_exception();
      return ceres::SOLVER_ABORT;
    }
    return ceres::SOLVER_CONTINUE;
  }
  void rethrow() const {
    if (stopped_) std::rethrow_exception(stopped_);
  }

 private:
  Progress& progress_;
  std::vector<double>& cost_;
  std::exception_ptr stopped_;
};

/// Solves the problem in place. Σ |residual|² at the start and after each step is added to `cost`.
/// @param tolerance  ends when a step takes less than this share off the cost …
/// @param least_step  … or moves the unknowns by less than this share of themselves
/// @throws Interrupted  when progress says so
inline ceres::Solver::Summary solve(ceres::Problem& problem, int max_iterations, double tolerance, double least_step,
                                    std::vector<double>& cost, Progress& progress) {
  Watch watch(progress, cost);
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::DENSE_QR;
  solver.num_threads = 1;
  solver.logging_type = ceres::SILENT;
  solver.max_num_iterations = max_iterations;
  solver.function_tolerance = tolerance;
  solver.gradient_tolerance = 0.0;
  solver.parameter_tolerance = least_step;
  solver.callbacks.push_back(&watch);
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  watch.rethrow();
  return summary;
}

}  // namespace robomill::modal::detail
