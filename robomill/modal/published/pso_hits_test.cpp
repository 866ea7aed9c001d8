// The swarm on hits of a hammer, and on nothing but hits.
#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "examples/first-lobes/hammer.hpp"
#include "robomill/modal/fit.hpp"
#include "robomill/modal/hits.hpp"
#include "testing/robot_modes.hpp"
#include "testing/support.hpp"

namespace robomill::modal {
namespace pso_hits_test {

/// Hits simulated on the published robot as in examples/first-lobes, 5 to 1,000 Hz.
const FrfSet& simulated_hits() {
  static const FrfSet set = [] {
    const std::vector<Hit> hits = examples::simulate_hits(data::robot_modes(), 5, 0.05, examples::Hammer{}, 1);
    HitOptions options;
    options.min_frequency_hz = 5.0;
    options.max_frequency_hz = 1000.0;
    return estimate_frfs(hits, options).set;
  }();
  return set;
}

FitResult fit_simulated_hits(int modes, int seed) {
  FitOptions options;
  options.method = FitMethod::pso;
  options.modes = modes;
  options.seed = static_cast<std::uint64_t>(seed);
  return fit_modes(simulated_hits(), options);
}

// As published: four modes an excitation. No frequency is given.
TEST(PsoHits, FitThePublishedRobotWithEverySeed) {
  for (int seed = 1; seed <= test::seeds(20); ++seed) {
    const FitResult fit = fit_simulated_hits(8, seed);
    EXPECT_LT(fit.mean_relative_error, 0.03) << seed;
    EXPECT_EQ(fit.status, FitResult::Status::converged) << seed;
  }
}

// Nothing is given but the hits.
TEST(PsoHits, CountModes) {
  const FitResult fit = fit_simulated_hits(0, 1);
  EXPECT_LT(fit.mean_relative_error, 0.03);
  EXPECT_EQ(fit.model.modes.size(), 8u);
}

}  // namespace pso_hits_test
}  // namespace robomill::modal
