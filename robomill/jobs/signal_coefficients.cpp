#include <fmt/format.h>

#include <algorithm>
#include <numbers>
#include <string>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/io/toml/file.hpp"
#include "robomill/io/usual_ranges.hpp"
#include "robomill/jobs/coefficients.hpp"
#include "robomill/jobs/forces.hpp"
#include "robomill/process/files/forces_toml.hpp"

namespace robomill::jobs {
namespace {

/// A start for the angle of the record alone, of usual size.
cutting::MillingCoefficients usual_coefficients() {
  return {.tangential_n_per_m2 = {1e9}, .radial_n_per_m2 = {0.4e9}};
}

/// Coefficients are worth no more than the model that they belong to.
void add_warning(cutting::SignalFit& fit) {
  constexpr double trusted = 0.9;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    if (!(fit.r_squared(axis) < trusted)) continue;
    fit.notes.push_back(fmt::format(
        "{}the fit explains {:.0f} % of the variance in {}: the rest is no noise that the deviations hold, but a "
        "resonance of the dynamometer, runout or another engagement. Mean forces of slots at several feeds "
        "(robomill coefficients slots.csv) do not feel a resonance.",
        io::warning_label, 100.0 * std::max(fit.r_squared(axis), 0.0), "xyz"[axis]));
    return;
  }
}

process::ForcesResult beside(process::Cut cut, const cutting::MillingCoefficients& coefficients,
                             const cutting::ForceRecordFile& record, const process::RecordStretch& stretch) {
  cut.coefficients = coefficients;
  process::ForcesResult out = process::forces_of_revolution(std::move(cut), std::nullopt);
  process::compare_with_record(out, record, stretch);
  return out;
}

}  // namespace

SignalCoefficientsResult run_signal_coefficients(const SignalCoefficientsJob& job) {
  const process::ForcesFile file = process::read_forces(job.cut, process::ForcesJob::identification);
  const cutting::ForceRecordFile record = cutting::read_force_record(job.record, job.reading);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (record.channels[axis] == "none") {
      throw InvalidInput("channels", fmt::format("must have all three components: {} is missing", "xyz"[axis]));
    }
  }
  process::Cut cut = file;
  cut.joints_rad.clear();
  cut.dynamics = cut.workpiece_dynamics = {};
  cut.notes.clear();
  cut.assumed.clear();
  SignalCoefficientsResult out;
  out.record = job.record;
  // One step a sample: more would count each of them several times in the deviations.
  process::Cut sampled = cut;
  const double samples = 2.0 * std::numbers::pi * record.record.sample_rate_hz / cut.motion.spindle_speed_rad_per_s;
  sampled.force.steps = static_cast<int>(std::clamp(samples, 8.0, 1e4));
  out.forces = beside(std::move(sampled), usual_coefficients(), record, job.stretch);
  const cutting::MeasuredForce& mean = out.forces.measured->force;
  const cutting::Engagement engagement = cutting::engage(cut.cutter, cut.cut, {.slices = cut.slices});
  const Eigen::Matrix3Xd on_tool_n = (cut.on_workpiece ? -1.0 : 1.0) * mean.force_n;
  out.fit =
      cutting::identify_from_signal(cut.cutter, engagement, cut.motion, mean.rotation_rad, on_tool_n,
                                    {.degrees = {.tangential = job.degree, .radial = job.degree, .axial = job.degree}});
  add_warning(out.fit);
  add_assumed(out.assumed, file.assumed);
  add_assumed(out.assumed, record.assumed);
  if (!file.document->has("force_on")) out.assumed.push_back(measured_acts_on_tool(file));
  try {
    out.forces = beside(cut, out.fit.coefficients, record, job.stretch);
  } catch (const InvalidInput& error) {
    out.forces.notes.push_back(fmt::format("The coefficients found give no forces to compare with: {}", error.what()));
    out.forces.revolution.reset();
    out.forces.measured.reset();
  }
  return out;
}

}  // namespace robomill::jobs
