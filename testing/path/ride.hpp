#pragma once
// Programs run through the interpolator cycle by cycle in one thread, with whatever may disturb them.
#include <Eigen/Geometry>
#include <algorithm>
#include <cstddef>
#include <memory>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/path/check.hpp"
#include "robomill/path/interpolator.hpp"
#include "robomill/path/posture.hpp"
#include "robomill/robot/serial_kinematics.hpp"
#include "testing/path/machine.hpp"
#include "testing/path/s_path.hpp"
#include "testing/robot/arms.hpp"

namespace robomill::path::test {

enum class Machine { tilt_head, hybrid, kr210 };

/// A KR210-like arm before which the part leans towards its base; all joints 2 rad/s, 5 rad/s², 100 rad/s³.
inline robot::Cell kr210_cell() {
  namespace arms = robot::testing;
  robot::Cell cell{.arm = arms::with_limits(arms::kr210()), .tool_length_m = 0.25};
  cell.workpiece =
      Eigen::Translation3d(1.6, 0.0, 1.6) * Eigen::AngleAxisd(0.5 - arms::pi / 2.0, Eigen::Vector3d::UnitY());
  for (robot::Joint& joint : cell.arm.joints) {
    joint.max_velocity = 2.0;
    joint.max_acceleration = 5.0;
    joint.max_jerk = 100.0;
  }
  return cell;
}

inline std::unique_ptr<robot::Kinematics> make_machine(Machine machine) {
  switch (machine) {
    case Machine::tilt_head:
      return std::make_unique<TiltHead>(tilt_head_limits());
    case Machine::hybrid:
      return std::make_unique<robot::HybridKinematics>(s_machine(2.0, 40.0));
    case Machine::kr210:
      break;
  }
  return std::make_unique<robot::SerialKinematics>(kr210_cell());
}

/// What happens to a ride; shares of the cycles.
struct Disturbance {
  double hold = 0.0, resume = 0.01, change_override = 0.0, largest_override = 1.5;
  double stall = 0.0;     ///< the program stops coming, for up to 400 cycles
  double blocks = 100.0;  ///< that come in a cycle at most; below 1 one comes as often
};

struct Rode {
  std::vector<Sample> samples = {};
  PathInterpolator::State state = PathInterpolator::State::waiting;  ///< the last
  PathInterpolator::Pushed pushed = {};                              ///< the last that was neither accepted nor full
  std::size_t read_at_first_motion = 0;                              ///< blocks
  std::size_t waits = 0, holds = 0;                                  ///< how often it came to wait or hold
};

/// Runs to the end of the program.
inline Rode ride(PathInterpolator& path, const program::Program& program, const Disturbance& how, Random& random) {
  using State = PathInterpolator::State;
  Rode out;
  std::size_t at = 0, stalled = 0;
  bool finished = false, failed = false;
  for (std::size_t cycle = 0; cycle < 3'000'000; ++cycle) {
    if (stalled > 0) {
      --stalled;
    } else if (random.uniform() < how.stall) {
      stalled = random.index(400);
    } else {
      const int most = how.blocks >= 1.0 ? static_cast<int>(how.blocks) : random.uniform() < how.blocks ? 1 : 0;
      for (int i = 0; i < most && !finished && !failed; ++i) {
        const bool whole = at == program.blocks.size();
        const PathInterpolator::Pushed pushed = whole ? path.finish() : path.push(program.blocks[at]);
        if (pushed.status == PathInterpolator::Pushed::Status::full) break;
        if (pushed.accepted()) {
          finished = whole;
          at += whole ? 0 : 1;
        } else {
          out.pushed = pushed;
          failed = true;
        }
      }
    }
    if (random.uniform() < how.hold) path.hold();
    if (random.uniform() < how.resume) path.resume();
    if (random.uniform() < how.change_override) path.set_override(random.uniform(-0.2, how.largest_override + 0.1));
    Sample sample;
    const State state = path.next(sample);
    if (state == State::waiting && out.state == State::running) ++out.waits;
    if (state == State::holding && out.state != State::holding) ++out.holds;
    if (out.read_at_first_motion == 0 && sample.path_m > 0.0) out.read_at_first_motion = at;
    out.samples.push_back(sample);
    out.state = state;
    if (state == State::finished || state == State::stopped) break;
  }
  return out;
}

inline CheckResult check(const program::Program& program, const robot::Kinematics& machine,
                         const SmoothingOptions& options, const std::vector<Sample>& samples) {
  program::ProgramSource source(program);
  Checker checker(source, machine, options);
  checker.add(samples);
  return checker.finish();
}

inline Posture posture_for(const program::Program& program, const robot::Kinematics& machine) {
  program::ProgramSource source(program);
  Posture out = choose_posture(source, machine).posture;
  if (out.gamma_rad.empty()) out.gamma_rad.push_back(0.0);
  return out;
}

}  // namespace robomill::path::test
