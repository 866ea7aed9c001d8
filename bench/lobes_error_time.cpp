// Error of the limit against the time it takes, for every method of the stability lobes and its own measure of effort:
// CSV on standard output, drawn by bench/lobes_error_time.py. Two-degree benchmark at a/D = 0.05, one thread.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <vector>

#include "robomill/base/parallel.hpp"
#include "robomill/stability/lobes.hpp"
#include "testing/stability/problems.hpp"

namespace {

using namespace robomill;
using stability::Limit;
using stability::LobesOptions;
using stability::Method;

struct Try {
  Method method;
  double tolerance;
  int intervals;
};

std::vector<Limit> limits(const LobesOptions& options, const std::vector<double>& speeds) {
  return stability::limit_depths(stability::testing::benchmark(0.05), options, speeds);
}

double median_error(const std::vector<Limit>& found, const std::vector<Limit>& exact) {
  std::vector<double> errors;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    errors.push_back(std::abs(found[i].axial_depth_m / exact[i].axial_depth_m - 1.0));
  }
  std::ranges::nth_element(errors, errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2));
  return errors[errors.size() / 2];
}

}  // namespace

int main() {
  set_thread_count(1);
  std::vector<double> speeds;
  for (int i = 0; i < 40; ++i) speeds.push_back((5000.0 + 125.0 * i) * stability::testing::rpm);
  LobesOptions options;
  options.axial_depth_m = {0.0, 0.03};
  options.grid = {2, 60};
  options.tolerance = 1e-10;
  const std::vector<Limit> exact = limits(options, speeds);

  std::vector<Try> tries;
  for (const double tolerance : {1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-8}) {
    tries.push_back({Method::collocation, tolerance, 40});
    tries.push_back({Method::multi_frequency, tolerance, 40});
  }
  for (const int intervals : {20, 40, 80, 160, 320, 640}) {
    tries.push_back({Method::semi_discretization, 1e-8, intervals});
    tries.push_back({Method::semi_discretization_first_order, 1e-8, intervals});
    tries.push_back({Method::full_discretization, 1e-8, intervals});
  }
  tries.push_back({Method::zeroth_order, 1e-8, 40});

  fmt::print("method,effort,median_error,microseconds_per_limit\n");
  for (const Try& one : tries) {
    options.method = one.method;
    options.tolerance = one.tolerance;
    options.intervals = one.intervals;
    double best = 1e9;
    std::vector<Limit> found;
    for (int repeat = 0; repeat < 3; ++repeat) {
      const auto begin = std::chrono::steady_clock::now();
      found = limits(options, speeds);
      best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    }
    const bool by_intervals = one.method != Method::collocation && one.method != Method::multi_frequency;
    fmt::print("{},{:g},{:.3g},{:.4g}\n", to_string(one.method), by_intervals ? one.intervals : one.tolerance,
               median_error(found, exact), 1e6 * best / static_cast<double>(speeds.size()));
  }
}
