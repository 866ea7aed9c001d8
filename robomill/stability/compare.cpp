#include "robomill/stability/compare.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "robomill/base/error.hpp"
#include "robomill/stability/chart/chart.hpp"

namespace robomill::stability {
namespace {

void judge(const std::vector<Limit>& reference, MethodRow& row) {
  std::vector<double> errors;
  for (std::size_t i = 0; i < row.limits.size(); ++i) {
    const bool here = row.limits[i].status == Limit::Status::found;
    const bool there = reference[i].status == Limit::Status::found;
    if (here != there) ++row.differ;
    if (!here || !there || !(reference[i].axial_depth_m > 0.0)) continue;
    errors.push_back(std::abs(row.limits[i].axial_depth_m / reference[i].axial_depth_m - 1.0));
  }
  row.median_error = row.worst_error = std::numeric_limits<double>::quiet_NaN();
  if (errors.empty()) return;
  std::ranges::sort(errors);
  row.median_error = errors[errors.size() / 2];
  row.worst_error = errors.back();
}

}  // namespace

MethodComparison compare_methods(const LobesProblem& problem, const LobesOptions& options, int speeds,
                                 Progress& progress) {
  problem.validate();
  options.validate();
  if (speeds < 2) throw InvalidInput("speeds", speeds, "", "must be at least 2");
  MethodComparison result;
  result.spindle_speed_rad_per_s = detail::even(options.spindle_speed_rad_per_s, speeds);
  std::vector<Method> methods = {Method::collocation,         Method::multi_frequency,
                                 Method::semi_discretization, Method::semi_discretization_first_order,
                                 Method::full_discretization, Method::zeroth_order};
  if (problem.has_measured()) methods = {Method::multi_frequency, Method::zeroth_order};
  for (const Method method : methods) {
    MethodRow row;
    row.method = method;
    LobesOptions own = options;
    own.method = method;
    own.output = Output::boundary;
    const auto begin = std::chrono::steady_clock::now();
    try {
      row.limits = limit_depths(problem, own, result.spindle_speed_rad_per_s, progress);
    } catch (const InvalidInput& error) {
      if (result.rows.empty()) throw;  // the reference must stand
      row.rejection = error.what();
    }
    row.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    judge(result.rows.empty() ? row.limits : result.rows.front().limits, row);
    result.rows.push_back(row);
  }
  return result;
}

}  // namespace robomill::stability
