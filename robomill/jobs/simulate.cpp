#include "robomill/jobs/simulate.hpp"

#include <fmt/format.h>

#include <string>

#include "robomill/base/error.hpp"
#include "robomill/jobs/files/in_words.hpp"
#include "robomill/simulation/drilling.hpp"
#include "robomill/simulation/posture.hpp"

namespace robomill::jobs {
namespace {

/// Puts modes in the place of FRFs, where there are some.
std::optional<modal::FitResult> fit_where_measured(const std::filesystem::path& path, modal::FrfSet& measured,
                                                   modal::ModalModel& model, Progress& progress) {
  if (measured.frfs.empty()) return std::nullopt;
  modal::FitResult fit = modal::fit_modes(measured, {}, progress);
  if (!fit.usable()) {
    throw InvalidInput(
        path.string(), fmt::format("the modes fitted to it differ from it by {:.3g} %", 100.0 * fit.relative_error),
        "Fit the band in which it can be trusted with robomill modes, and name the result as dynamics.modes");
  }
  model = fit.model;
  measured = {};
  return fit;
}

simulation::MillingCut milling_of(const LobesFile& file, const stability::OperatingPoint& point) {
  return {.milling = file.problem.milling,
          .structure = stability::tip_modes(file.problem),
          .spindle_speed_rad_per_s = point.spindle_speed_rad_per_s,
          .axial_depth_m = point.axial_depth_m};
}

simulation::DrillingCut drilling_of(const LobesFile& file, const stability::OperatingPoint& point) {
  simulation::DrillingCut cut;
  static_cast<cutting::Drill&>(cut) = *file.problem.drilling;
  cut.radial_width_m = point.axial_depth_m;
  cut.feed_per_revolution_m = file.feed_per_revolution_m;
  cut.structure = stability::tip_modes(file.problem);
  cut.spindle_speed_rad_per_s = point.spindle_speed_rad_per_s;
  return cut;
}

simulation::PostureCut posture_of(const LobesFile& file, const stability::OperatingPoint& point) {
  const stability::SpatialMilling& milling = *file.problem.spatial;
  cutting::Cut at_depth = milling.cut;
  at_depth.axial_depth_m = point.axial_depth_m;
  const modal::TipModes structure = stability::tip_modes(file.problem);
  simulation::PostureCut cut;
  cut.cutter = milling.cutter;
  cut.engagement = cutting::engage(milling.cutter, at_depth);
  cut.coefficients = milling.coefficients;
  cut.motion = {.feed_per_tooth_m = milling.feed_per_tooth_m, .spindle_speed_rad_per_s = point.spindle_speed_rad_per_s};
  cut.structure = milling.modes_turn_with_tool ? modal::turned(structure, cut.engagement.feed_from_tool) : structure;
  return cut;
}

/// Speed and depth of the cut are the point's, not the chart's; how it is simulated no document says.
InvalidInput about_job(const InvalidInput& error) {
  const std::string& field = error.parts().field;
  for (const char* const member : {"spindle_speed_rad_per_s", "axial_depth_m", "radial_width_m"}) {
    if (field.ends_with(member)) return within("points.", error);
  }
  for (const char* const member : {"seconds", "sample_rate_hz"}) {
    if (field == member) return within("options.", error);
  }
  return error;
}

simulation::Simulation simulated(const LobesFile& cut, const SimulateJob& job, Progress& progress) {
  try {
    if (cut.drilling) return simulation::simulate(drilling_of(cut, job.point), job.options, progress);
    if (cut.problem.spatial) return simulation::simulate(posture_of(cut, job.point), job.options, progress);
    return simulation::simulate(milling_of(cut, job.point), job.options, progress);
  } catch (const InvalidInput& error) {
    throw in_words_of(cut, about_job(error));
  }
}

}  // namespace

SimulateResult run_simulate(const SimulateJob& job, Progress& progress) {
  SimulateResult result;
  result.point = job.point;
  LobesFile& cut = result.cut;
  stability::LobesProblem& problem = cut.problem;
  cut = read_lobes(job.lobes);
  load_dynamics(cut);
  result.fit = fit_where_measured(cut.frf, problem.measured, problem.dynamics, progress);
  result.workpiece_fit =
      fit_where_measured(cut.workpiece_frf, problem.workpiece_measured, problem.workpiece_dynamics, progress);
  cut.validate();
  if (!cut.drilling && !(problem.milling.feed_per_tooth_m > 0.0)) {
    throw InvalidInput(InvalidInput::Parts{.where = job.lobes.path.string(),
                                           .field = "cut.feed_per_tooth_mm",
                                           .rule = "must be given and > 0",
                                           .hint = "Without feed nothing is cut"});
  }
  result.simulation = simulated(cut, job, progress);
  return result;
}

}  // namespace robomill::jobs
