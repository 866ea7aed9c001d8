#include <benchmark/benchmark.h>

#include <cmath>
#include <vector>

#include "robomill/path/check.hpp"
#include "testing/path/machine.hpp"

namespace {

using namespace robomill;
using namespace robomill::path;

// A winding path in blocks of a few samples each, three axes or five.
void check_samples(benchmark::State& state) {
  const bool five = state.range(0) == 5;
  const int blocks = 5000, per_block = static_cast<int>(state.range(1));
  program::Program program;
  const auto pose = [five](double u) {
    program::Pose at;
    at.tip_m = {0.05 * std::sin(0.01 * u), 0.05 * std::cos(0.013 * u), 1e-5 * u};
    if (five) at.axis = Eigen::Vector3d(0.2 * std::sin(0.007 * u), 0.2 * std::cos(0.005 * u), 1.0).normalized();
    return at;
  };
  program.start = pose(0.0);
  for (int i = 1; i <= blocks; ++i) program.blocks.push_back({.end = pose(i), .duration_s = 1e-3 * per_block});
  const test::TiltHead machine(test::tilt_head_limits());
  SmoothingOptions options;
  options.tip_tolerance_m = options.axis_tolerance_rad = 2e-5;
  options.max_velocity_m_per_s = options.max_acceleration_m_per_s2 = options.max_jerk_m_per_s3 = 1e6;
  options.max_angular_velocity_rad_per_s = options.max_angular_acceleration_rad_per_s2 = 1e6;
  options.max_angular_jerk_rad_per_s3 = 1e7;
  std::vector<Sample> samples;
  for (int i = 0; i <= blocks * per_block; ++i) {
    const double u = static_cast<double>(i) / per_block;
    const program::Pose at = pose(u);
    Sample sample = {.time_s = i * 1e-3, .tip_m = at.tip_m, .axis = at.axis};
    sample.block = std::min<std::size_t>(blocks - 1, static_cast<std::size_t>(u));
    (void)machine.follow(robot::ToolPose{.tip_m = at.tip_m, .axis = at.axis}, robot::Position6::Zero(), sample.joints);
    samples.push_back(sample);
  }
  program::ProgramSource source(program);
  for (auto _ : state) {
    Checker checker(source, machine, options);
    checker.add(samples);
    benchmark::DoNotOptimize(checker.finish());
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(samples.size()));
}
BENCHMARK(check_samples)->Args({3, 10})->Args({5, 10})->Args({5, 2})->Unit(benchmark::kMillisecond);

}  // namespace
