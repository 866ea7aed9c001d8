#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/io/toml/file.hpp"
#include "robomill/io/usual_ranges.hpp"
#include "robomill/jobs/coefficients.hpp"
#include "robomill/jobs/files/assumed.hpp"
#include "robomill/jobs/forces.hpp"
#include "robomill/process/files/forces_toml.hpp"

namespace robomill::jobs {
namespace {

/// A start for the angle of the record alone, of usual size.
cutting::MillingCoefficients usual_coefficients() {
  return {.tangential_n_per_m2 = {1e9}, .radial_n_per_m2 = {0.4e9}};
}

/// Share of the variance of all components together that the fit explains.
double r_squared_of_all(const Eigen::Matrix3Xd& force_n, const cutting::SignalFit& fit) {
  const Eigen::Vector3d mean_n = force_n.rowwise().mean();
  return 1.0 - fit.residual_n.squaredNorm() / (force_n.colwise() - mean_n).squaredNorm();
}

/// Coefficients are worth no more than the model that they belong to.
void add_warnings(const cutting::MeasuredForce& mean, cutting::SignalFit& fit) {
  constexpr double trusted = 0.9, much_more = 3.0;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    if (!(fit.r_squared(axis) < trusted)) continue;
    fit.notes.push_back(fmt::format(
        "{}the fit explains {:.0f} % of the variance in {}: the rest is no noise that the deviations hold, but a "
        "resonance of the dynamometer, runout or another engagement. Mean forces of slots at several feeds "
        "(robomill coefficients slots.csv) do not feel a resonance.",
        io::warning_label, 100.0 * std::max(fit.r_squared(axis), 0.0), "xyz"[axis]));
    break;
  }
  const double noise_of_mean_n = mean.scatter_n.norm() / std::sqrt(3.0 * mean.revolutions);
  if (fit.noise_n > much_more * noise_of_mean_n) {
    fit.notes.push_back(
        fmt::format("{:.3g} N are left about the fit, and the noise of the mean revolution is {:.3g} N: most of it is "
                    "what the model lacks, which the standard deviations take for noise.",
                    fit.noise_n, noise_of_mean_n));
  }
}

/// Why no cut has these coefficients; empty: one may.
/// @param on_tool_n  what they were found from
std::string rejection_of(const process::Cut& cut, const cutting::Engagement& engagement,
                         const Eigen::Matrix3Xd& on_tool_n, const cutting::SignalFit& fit) {
  constexpr double least_r_squared = 0.5;
  const double explained = r_squared_of_all(on_tool_n, fit);
  if (!(explained >= least_r_squared)) {
    return fmt::format(
        "the fit explains {:.0f} % of the force's variance, less than {:.0f} %: another cut was recorded, "
        "or other axes",
        100.0 * std::max(explained, 0.0), 100.0 * least_r_squared);
  }
  try {
    // Cutter, engagement and motion were taken before: what is rejected here are the coefficients.
    static_cast<void>(cutting::cutting_force(cut.cutter, engagement, fit.coefficients, cut.motion, {.steps = 8}));
  } catch (const InvalidInput& error) {
    return fmt::format("no cut has these coefficients: {}", error.what());
  }
  return {};
}

/// What of the document has no part in the coefficients.
std::vector<std::string> left_out(const process::ForcesFile& file) {
  std::vector<std::string> tables;
  if (!file.joints_rad.empty()) tables.emplace_back("[robot]");
  if (!file.dynamics.modes.empty()) tables.emplace_back("[dynamics]");
  if (!file.workpiece_dynamics.modes.empty()) tables.emplace_back("[workpiece_dynamics]");
  if (tables.empty()) return {};
  return {
      fmt::format("{} of {} is left out: the coefficients are those of a rigid machine, and take what it deflects "
                  "and vibrates for cutting.",
                  fmt::join(tables, " and "), file.path.filename().string())};
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
  process::Cut cut = static_cast<const process::Cut&>(file);
  cut.joints_rad.clear();
  cut.dynamics = cut.workpiece_dynamics = {};
  if (file.document->has("coefficients")) {
    cut.notes.push_back(
        fmt::format("[coefficients] of {} have no part in those found.", file.path.filename().string()));
  }
  std::ranges::move(left_out(file), std::back_inserter(cut.notes));
  cut.assumed = assumed_of(file, false);
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
  add_warnings(mean, out.fit);
  out.rejected = rejection_of(cut, engagement, on_tool_n, out.fit);
  if (out.rejected.empty()) {
    out.forces = beside(cut, out.fit.coefficients, record, job.stretch);
  } else {
    out.forces.revolution.reset();
    out.forces.measured.reset();
  }
  // They stand with the coefficients, and not twice.
  add_assumed(out.assumed, std::exchange(out.forces.assumed, {}));
  if (!file.document->has("force_on")) out.assumed.push_back(measured_acts_on_tool(file));
  return out;
}

}  // namespace robomill::jobs
