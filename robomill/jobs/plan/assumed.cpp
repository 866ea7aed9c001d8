#include "robomill/jobs/plan/assumed.hpp"

#include <vector>

#include "robomill/jobs/files/assumed.hpp"
#include "robomill/process/decide/motion_loads.hpp"

namespace robomill::jobs {

void gather_assumed(PlanResult& result, const cell::Cell* cell) {
  std::vector<Assumption> of_job;
  if (result.recommends()) {
    if (result.job.recommend.max_axial_depth_m <= 0.0) {
      of_job.push_back({.what = "Depth of the cutter", .taken = "not limited", .key = "tool.max_axial_depth_mm"});
    }
    if (result.job.recommend.spindle.empty()) {
      of_job.push_back({.what = "Torque and power of the spindle", .taken = "not limited", .key = "spindle.curve"});
    }
  }
  if (result.decision) add_assumed(of_job, result.decision->assumed);
  for (Assumption& one : of_job) one.file = result.job.file.filename().string();
  add_assumed(result.assumed, result.job.assumed);
  add_assumed(result.assumed, of_job);
  if (result.recommends()) add_assumed(result.assumed, assumed_of(result.cut, CutUse::motion));
  const PlannedProgram& shown = result.shown();
  if (shown.forces) add_assumed(result.assumed, shown.forces->assumed);
  if (shown.path) add_assumed(result.assumed, shown.path->smoothed.assumed);
  if (cell != nullptr && shown.blocks && !cell->end_effector.mass_kg && process::knows_torques(*cell)) {
    // What the drives bear is looked at, without the spindle's weight.
    add_assumed(result.assumed, {{.what = "Mass on the flange",
                                  .taken = "none",
                                  .key = "tool.mass_kg",
                                  .file = cell->path.filename().string()}});
  }
  if (cell == nullptr || result.job.program.empty()) return;
  const Assumption unchecked = process::unchecked_collisions(*cell);
  std::erase(result.assumed, unchecked);
  if (!collisions_checked(result)) result.assumed.push_back(unchecked);
}

}  // namespace robomill::jobs
