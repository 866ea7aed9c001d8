#include "robomill/modal/fitting/refine.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "robomill/base/linear_algebra.hpp"
#include "robomill/modal/fitting/least_squares.hpp"

namespace robomill::modal::detail {
namespace {

using Eigen::Index;

// Ceres sees no lines: only cost, gradient and JᵀJ of a residual matter to Gauss and Newton, so it gets the shortest
// residual that has the same ones. With JᵀJ = V Λ Vᵀ that is (Λ^-1/2 Vᵀ Jᵀr, rest) with the Jacobian (Λ^1/2 Vᵀ, 0).
class ReducedCost : public ceres::CostFunction {
 public:
  ReducedCost(const Kernel& kernel, const Poles& shape) : kernel_(kernel), shape_(shape) {
    unknowns_ = parameter_count(kernel.data(), shape.size());
    mutable_parameter_block_sizes()->push_back(static_cast<int>(unknowns_));
    set_num_residuals(static_cast<int>(unknowns_) + 1);
  }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const Eigen::VectorXd at = Eigen::Map<const Eigen::VectorXd>(parameters[0], unknowns_);
    const bool derivatives = jacobians != nullptr && jacobians[0] != nullptr;
    const Evaluation e = kernel_.evaluate(from_parameters(at, shape_), derivatives);
    if (!std::isfinite(e.cost)) return false;
    Eigen::Map<Eigen::VectorXd> out(residuals, unknowns_ + 1);
    out.setZero();
    out(unknowns_) = std::sqrt(e.cost);
    if (!derivatives) return true;
    const Eigen::VectorXd scale =
        e.hessian.diagonal().unaryExpr([](double d) { return d > 0.0 ? 1.0 / std::sqrt(d) : 0.0; });
    const linear_algebra::SymmetricEigenPairs eigen =
        linear_algebra::symmetric_eigen_pairs(scale.asDiagonal() * e.hessian * scale.asDiagonal());
    const Eigen::VectorXd size = eigen.values.cwiseMax(1e-15).cwiseSqrt();
    const Eigen::VectorXd along =
        size.cwiseInverse().asDiagonal() * (eigen.vectors.transpose() * (scale.asDiagonal() * e.gradient));
    out.head(unknowns_) = -along;
    out(unknowns_) = std::sqrt(std::max(0.0, e.cost - along.squaredNorm()));
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> jacobian(
        jacobians[0], unknowns_ + 1, unknowns_);
    jacobian.setZero();
    const Eigen::VectorXd unscale = scale.unaryExpr([](double s) { return s > 0.0 ? 1.0 / s : 0.0; });
    jacobian.topRows(unknowns_) = size.asDiagonal() * eigen.vectors.transpose() * unscale.asDiagonal();
    return true;
  }

 private:
  const Kernel& kernel_;
  const Poles& shape_;
  Index unknowns_ = 0;
};

}  // namespace

Refined refine(const Kernel& kernel, Poles start, const RefineOptions& options, Progress& progress) {
  Refined result;
  start.fix_gauge();
  start.omega = start.omega.cwiseMax(options.bounds.omega_low).cwiseMin(options.bounds.omega_high);
  start.zeta = start.zeta.cwiseMax(options.bounds.zeta_low).cwiseMin(options.bounds.zeta_high);
  result.poles = start;
  result.converged = true;
  if (start.size() > 0 && options.max_iterations > 0) {
    Eigen::VectorXd parameters = to_parameters(start);
    ceres::Problem problem;
    problem.AddResidualBlock(new ReducedCost(kernel, start), nullptr, parameters.data());
    const int stride = static_cast<int>(parameters.size() / start.size());
    for (int k = 0; k < static_cast<int>(start.size()); ++k) {
      problem.SetParameterLowerBound(parameters.data(), k * stride, options.bounds.omega_low);
      problem.SetParameterUpperBound(parameters.data(), k * stride, options.bounds.omega_high);
      problem.SetParameterLowerBound(parameters.data(), k * stride + 1, options.bounds.zeta_low);
      problem.SetParameterUpperBound(parameters.data(), k * stride + 1, options.bounds.zeta_high);
    }
    const ceres::Solver::Summary summary =
        solve(problem, options.max_iterations, options.tolerance, 1e-14, result.cost, progress);
    result.poles = from_parameters(parameters, start);
    result.converged = summary.termination_type == ceres::CONVERGENCE;
    result.iterations = static_cast<int>(summary.iterations.size()) - 1;
  }
  result.poles.fix_gauge();
  result.at = kernel.evaluate(result.poles, true);
  return result;
}

}  // namespace robomill::modal::detail
