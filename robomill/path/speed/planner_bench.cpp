#include "robomill/path/speed/planner.hpp"

#include <benchmark/benchmark.h>

#include <cmath>
#include <memory>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/path/emitter.hpp"
#include "robomill/path/posture.hpp"
#include "robomill/robot/serial_kinematics.hpp"
#include "testing/path/s_path.hpp"
#include "testing/robot/arms.hpp"

namespace {

using namespace robomill;
namespace arms = robot::testing;

/// 4,000 curved blocks of 0.1 to 1 mm, the axis swinging.
program::Program dense() {
  program::Program out;
  Random random(41);
  double s = 0.0;
  const auto pose = [](double at) {
    const Eigen::Vector3d tip(0.05 * std::cos(20.0 * at), 0.05 * std::sin(20.0 * at), 0.004 * std::sin(300.0 * at));
    return program::Pose{
        .tip_m = tip, .axis = Eigen::Vector3d(0.2 * std::sin(25.0 * at), 0.15 * std::cos(40.0 * at), 1.0).normalized()};
  };
  out.start = pose(0.0);
  for (std::size_t i = 1; i <= 4000; ++i) {
    s += random.uniform(1e-4, 1e-3) / 1.5;
    program::Block block{.line = i, .end = pose(s)};
    block.duration_s = (block.end.tip_m - out.begin_of(i - 1).tip_m).norm() / 0.05;
    out.blocks.push_back(block);
  }
  return out;
}

struct Case {
  program::Program program = dense();
  std::unique_ptr<robot::Kinematics> machine;
  robot::Position6 start = robot::Position6::Zero();
  double gamma_rad = 0.0;
};

const Case& hybrid() {
  static const Case made = [] {
    Case out;
    out.machine = std::make_unique<robot::HybridKinematics>(path::test::s_machine(2.0, 40.0));
    return out;
  }();
  return made;
}

const Case& arm() {
  static const Case made = [] {
    Case out;
    robot::Cell cell{.arm = arms::with_limits(arms::kr210()), .tool_length_m = 0.25};
    // A spindle across the last axis, the part before the arm.
    cell.arm.flange = cell.arm.flange * Eigen::Translation3d(0.0, 0.0, 0.15) *
                      Eigen::AngleAxisd(-arms::pi / 2.0, Eigen::Vector3d::UnitY());
    cell.workpiece = Eigen::Translation3d(1.6, 0.6, 1.6);
    for (robot::Joint& joint : cell.arm.joints) {
      joint.max_velocity = 1.8;
      joint.max_acceleration = 5.0;
      joint.max_jerk = 100.0;
    }
    out.machine = std::make_unique<robot::SerialKinematics>(cell);
    program::ProgramSource source(out.program);
    const path::PostureChoice choice = path::choose_posture(source, *out.machine);
    out.start = choice.posture.start;
    out.gamma_rad = choice.posture.gamma_rad.at(0);
    return out;
  }();
  return made;
}

using Chosen = const Case& (*)();

/// @return  whether the whole program was planned
template <class Take>
bool plan(const Case& of, path::Planner& planner, Take&& take) {
  bool ok = planner.begin(of.program.start, of.gamma_rad, of.start).ok();
  const auto hold = [&](const path::Planner::Status& status) {
    ok = ok && status.ok();
    take();
    while (ok && planner.busy()) {
      ok = planner.resume().ok();
      take();
    }
  };
  for (std::size_t i = 0; ok && i < of.program.blocks.size(); ++i) {
    hold(planner.push(of.program.blocks[i], i, of.gamma_rad));
  }
  if (ok) hold(planner.finish());
  return ok;
}

void plan_program(benchmark::State& state, Chosen chosen, const path::PlannerOptions& options) {
  const Case& of = chosen();
  const path::SmoothingOptions o = path::test::published_options(path::Method::verified);
  std::size_t segments = 0;
  double time_s = 0.0;
  for (auto _ : state) {
    path::Planner planner(*of.machine, o, options);
    segments = 0;
    time_s = 0.0;
    const bool ok = plan(of, planner, [&] {
      segments += planner.motion().size();
      for (const path::Segment& segment : planner.motion()) time_s += path::duration_s(segment);
      planner.motion().clear();
      planner.path().clear();
    });
    if (!ok) state.SkipWithError("rejected");
  }
  const auto blocks = static_cast<double>(of.program.blocks.size());
  state.counters["segments_per_block"] = static_cast<double>(segments) / blocks;
  state.counters["program_s"] = time_s;
  state.counters["s_per_block"] =
      benchmark::Counter(blocks, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK_CAPTURE(plan_program, arm_verified, &arm, path::PlannerOptions{})->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(plan_program, arm_optimal, &arm, path::PlannerOptions::optimal())->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(plan_program, arm_real_time, &arm, path::PlannerOptions::real_time())->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(plan_program, hybrid_verified, &hybrid, path::PlannerOptions{})->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(plan_program, hybrid_optimal, &hybrid, path::PlannerOptions::optimal())
    ->Unit(benchmark::kMillisecond);

void emit_samples(benchmark::State& state, Chosen chosen) {
  const Case& of = chosen();
  path::Planner planner(*of.machine, path::test::published_options(path::Method::verified), {});
  std::vector<path::Segment> motion;
  std::vector<path::Polynomial> curve;
  const bool ok = plan(of, planner, [&] {
    motion.insert(motion.end(), planner.motion().begin(), planner.motion().end());
    curve.insert(curve.end(), planner.path().begin(), planner.path().end());
    planner.motion().clear();
    planner.path().clear();
  });
  if (!ok) return state.SkipWithError("rejected");
  std::vector<path::Sample> samples;
  for (auto _ : state) {
    samples.clear();
    path::Emitter emitter(*of.machine, 1e-3, of.start);
    benchmark::DoNotOptimize(emitter.add(curve, motion, samples));
  }
  state.counters["s_per_sample"] = benchmark::Counter(
      static_cast<double>(samples.size()), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK_CAPTURE(emit_samples, arm, &arm)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(emit_samples, hybrid, &hybrid)->Unit(benchmark::kMillisecond);

void blend_program(benchmark::State& state) {
  const program::Program& program = hybrid().program;
  std::vector<path::Polynomial> some(path::Blend::max_polynomials);
  for (auto _ : state) {
    path::Blend blend(path::test::published_options(path::Method::verified), 1000);
    blend.begin(program.start, 0.0);
    std::size_t taken = 0;
    const auto take = [&] {
      blend.find_widths();
      for (; taken < blend.ready(); ++taken) benchmark::DoNotOptimize(blend.polynomials(taken, some.data()));
      blend.forget(taken);
    };
    for (std::size_t i = 0; i < program.blocks.size(); ++i) {
      benchmark::DoNotOptimize(blend.add(program.blocks[i], i, 0.0));
      if (blend.room() < 100) take();
    }
    blend.stop(0.0);
    take();
  }
  state.counters["s_per_block"] =
      benchmark::Counter(static_cast<double>(program.blocks.size()),
                         benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK(blend_program)->Unit(benchmark::kMillisecond);

}  // namespace
