#include "testing/page/smooth_sample.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "robomill/base/units.hpp"
#include "robomill/path/files/motion_json.hpp"
#include "robomill/path/files/smooth_json.hpp"
#include "testing/path/zigzag.hpp"

namespace robomill::page {
namespace {

using path::Motion;

struct Kind {
  path::Method method;
  double speed_m_per_s;
  std::array<double, 2> averages_s;
};
constexpr std::array<Kind, 3> kinds = {Kind{path::Method::verified, 0.03, {0.03, 0.03}},
                                       Kind{path::Method::paper, 0.024, {0.04, 0.03}},
                                       Kind{path::Method::no_joint_jerk, 0.034, {0.02, 0.01}}};

struct Recorded {
  path::ProgramOutline outline;
  std::vector<Motion> motions;
};

/// With drives that are behind by a fifth of a step.
Recorded record() {
  const program::Program program = path::test::zigzag_program();
  program::ProgramSource source(program);
  Recorded out{.outline = path::outline(source, path::test::zigzag_tolerance_m), .motions = {}};
  for (const Kind& kind : kinds) {
    path::MotionRecorder recorder(5, {true, true, true, false, false, false}, path::test::zigzag_period_s,
                                  out.outline.corners);
    path::Sample last;
    recorder.restart([&last](const path::Sample& sample) -> robot::Position6 {
      robot::Position6 behind =
          sample.time_s > 0.0 ? robot::Position6(0.2 * (sample.joints - last.joints)) : robot::Position6::Zero();
      last = sample;
      return behind;
    });
    recorder.add(path::test::averaged_motion(program, kind.speed_m_per_s, kind.averages_s));
    out.motions.push_back(recorder.motion());
  }
  return out;
}

/// One for both documents.
const Recorded& recorded() {
  static const Recorded once = record();
  return once;
}

path::Usage usage(double max, double limit) {
  return {.max = max, .limit = limit, .violations = max > limit ? 7U : 0U, .at_s = 0.4, .block = 2};
}

double largest(const signal::Band& band) {
  return std::max(band.high.maxCoeff(), -band.low.minCoeff());
}

path::CheckResult check_of(const Motion& motion) {
  path::CheckResult check;
  check.tip_velocity = usage(largest(motion.tip_speed_m_per_s), 0.05);
  check.tip_acceleration = usage(0.41, 0.5);
  check.tip_jerk = usage(8.2, 10.0);
  check.axis_velocity = usage(largest(motion.axis_speed_rad_per_s), 0.2);
  check.axis_acceleration = usage(0.9, 2.0);
  check.axis_jerk = usage(12.0, 40.0);
  check.feed = usage(0.98, 1.0);
  check.tip_error_m = usage(0.021e-3, path::test::zigzag_tolerance_m);
  check.axis_error_rad = usage(1e-4, 0.1 * units::deg);
  const path::test::TiltHead machine = path::test::zigzag_machine();
  const robot::JointLimits& limits = machine.limits();
  for (const path::JointMotion& joint : motion.joints) {
    const auto at = static_cast<Eigen::Index>(check.joints.size());
    check.joints.push_back({.position = {.max = -0.2},
                            .velocity = usage(largest(joint.velocity), limits.max_velocity[at]),
                            .acceleration = usage(largest(joint.acceleration), limits.max_acceleration[at]),
                            .jerk = usage(largest(joint.jerk), limits.max_jerk[at])});
  }
  return check;
}

path::SmoothedBy method_of(const Motion& motion, path::Method method) {
  path::SmoothedBy by{.method = method};
  path::Summary& summary = by.summary;
  summary.duration_s = motion.run_s * static_cast<double>(motion.tip_speed_m_per_s.low.size());
  if (method == path::Method::verified) {
    summary.lower_bound_s = 0.9 * summary.duration_s;
  } else {
    summary.sum_t2_s = 2.355;
  }
  summary.blocks = path::test::zigzag_program().blocks.size();
  summary.samples = static_cast<std::size_t>(summary.duration_s / path::test::zigzag_period_s);
  summary.plan_s = 0.3;
  summary.emit_s = 3e-6 * static_cast<double>(summary.samples);
  summary.check = check_of(motion);
  for (const path::JointMotion& joint : motion.joints) by.tracking_error.push_back(largest(joint.tracking_error));
  return by;
}

}  // namespace

std::string sample_smooth(const std::string& text) {
  const auto said = [&](const char* own) { return text.empty() ? std::string(own) : text; };
  path::SmoothedProgram smoothed;
  smoothed.program = said("zigzag.ngc");
  smoothed.cell = said("cell.toml");
  smoothed.prismatic = {true, true, true, false, false, false};
  smoothed.written = true;
  smoothed.notes = {said("A sample, not a prediction.")};
  smoothed.skipped = {{.line = 4, .what = said("M8")}};
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    smoothed.methods.push_back(method_of(recorded().motions[i], kinds.at(i).method));
  }
  return path::smooth_json(smoothed);
}

std::string sample_motion() {
  return path::motion_json(recorded().outline, recorded().motions);
}

}  // namespace robomill::page
