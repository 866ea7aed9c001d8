#include <benchmark/benchmark.h>

#include <cmath>
#include <vector>

#include "robomill/path/posture.hpp"
#include "robomill/robot/serial_kinematics.hpp"
#include "testing/robot/arms.hpp"

namespace {

using namespace robomill;
namespace arms = robot::testing;

/// A program of `blocks` moves of some millimetres that wind round a cone.
program::Program winding(int blocks) {
  program::Program out;
  const auto pose = [](double at) {
    const double lean = 0.4 + 0.3 * std::sin(0.37 * at);
    return program::Pose{.tip_m = {0.06 * std::cos(at), 0.06 * std::sin(at), 0.01 * std::sin(3.0 * at)},
                         .axis = {std::sin(lean) * std::cos(at), std::sin(lean) * std::sin(at), std::cos(lean)}};
  };
  out.start = pose(0.0);
  for (int k = 1; k <= blocks; ++k) out.blocks.push_back({.end = pose(0.1 * k), .duration_s = 1.0});
  return out;
}

void choose_posture_of_program(benchmark::State& state, bool free_gamma) {
  robot::Cell cell{.arm = arms::with_limits(arms::kr210()), .tool_length_m = 0.25};
  // A spindle across the last axis: turning about the tool then moves the wrist.
  cell.arm.flange = cell.arm.flange * Eigen::Translation3d(0.0, 0.0, 0.15) *
                    Eigen::AngleAxisd(-arms::pi / 2.0, Eigen::Vector3d::UnitY());
  cell.workpiece = Eigen::Translation3d(1.6, 0.6, 1.6);
  const robot::SerialKinematics machine(cell);
  const program::Program program = winding(4000);
  program::ProgramSource source(program);
  for (auto _ : state) {
    benchmark::DoNotOptimize(path::choose_posture(source, machine, {.free_gamma = free_gamma}).margin.least);
  }
}
BENCHMARK_CAPTURE(choose_posture_of_program, constant_gamma, false)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(choose_posture_of_program, free_gamma, true)->Unit(benchmark::kMillisecond);

}  // namespace
