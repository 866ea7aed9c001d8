// Which method computes: the one place that knows them all by name.
#include <string>

#include "robomill/base/error.hpp"
#include "robomill/stability/collocation/collocation.hpp"
#include "robomill/stability/point_evaluator.hpp"
#include "robomill/stability/time_steps/discretizations.hpp"

namespace robomill::stability::detail {

void require_known(const LobesProblem& problem, Method method) {
  if (!problem.in_three_directions() || method == Method::collocation) return;
  throw InvalidInput("method", std::string(to_string(method)) + " is for an upright flat end in x and y",
                     "Take method = \"collocation\"");
}

std::unique_ptr<Scheme> make_scheme(const LobesProblem& problem, const LobesOptions& options) {
  require_known(problem, options.method);
  if (problem.has_measured()) {
    throw InvalidInput(
        "dynamics.frf",
        std::string("does not go with ") + std::string(to_string(options.method)) + ", which needs modes",
        "Take method = \"multi-frequency\", or fit modes first: robomill modes");
  }
  switch (options.method) {
    case Method::semi_discretization:
      return semi_discretization(problem, options.intervals);
    case Method::semi_discretization_first_order:
      return first_order_semi_discretization(problem, options.intervals);
    case Method::full_discretization:
      return full_discretization(problem, options.intervals);
    default:
      return collocation(problem, options.tolerance);
  }
}

}  // namespace robomill::stability::detail
