#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/io/toml/file.hpp"
#include "robomill/io/usual_ranges.hpp"
#include "robomill/jobs/files/lobes_toml.hpp"
#include "robomill/jobs/planned_cut.hpp"
#include "robomill/modal/files/frf_files.hpp"
#include "robomill/modal/files/modes_files.hpp"
#include "robomill/process/files/structure_schema.hpp"

namespace robomill::jobs {
namespace {

std::shared_ptr<const cell::ModesOfPosture> posture_of(const LobesFile& file, Progress& progress) {
  auto posture = std::make_shared<cell::ModesOfPosture>();
  const auto find = [&] { *posture = cell::posture_modes(file.cell, file.joints, file.posture_axes, progress); };
  if (file.document) {
    file.document->locate(find);
  } else {
    find();
  }
  return posture;
}

}  // namespace

void take_posture(LobesFile& file, std::shared_ptr<const cell::ModesOfPosture> posture) {
  file.problem.dynamics = posture->prediction.modes;
  // An upright cut in the plane of base x and y asks for nothing of base z.
  const bool along_z = file.problem.in_three_directions() || file.posture_axes != cell::PostureAxes::base;
  for (const std::string& text : cell::posture_warnings(*posture, {true, true, along_z})) {
    file.notes.push_back(fmt::format("{}{}", io::warning_label, text));
  }
  file.notes.insert(file.notes.end(), posture->notes.begin(), posture->notes.end());
  add_assumed(file.assumed, posture->assumed);
  constexpr double noticed_rad = 5.0 * units::deg;
  if (file.posture_axes == cell::PostureAxes::base && posture->axis_off_z_rad > noticed_rad) {
    file.notes.push_back(
        fmt::format("The cut's z is the base's z, from which the tool's axis stands off by {:.3g} deg in this posture.",
                    posture->axis_off_z_rad / units::deg));
  }
  const bool known = std::ranges::any_of(file.problem.dynamics.modes,
                                         [](const modal::Mode& mode) { return std::isfinite(mode.frequency_std_hz); });
  if (known && file.uncertainty.samples == 0 && file.sweep == stability::SweptParameter::axial_depth) {
    file.uncertainty.samples = 100;
    file.uncertainty.grid = {40, 30};
  }
  file.posture = std::move(posture);
}

void load_dynamics(LobesFile& file, Progress& progress) {
  if (!file.job.empty() && !file.dropped_dynamics) {
    return take_plan(file, run_structure(file.job, default_seed, progress));
  }
  if (!file.cell.empty()) take_posture(file, posture_of(file, progress));
  if (!file.modes.empty()) file.problem.dynamics = modal::read_modes(file.modes, file.notes);
  if (!file.workpiece_modes.empty()) {
    file.problem.workpiece_dynamics = modal::read_modes(file.workpiece_modes, file.notes);
  }
  const auto measured = [&file](const std::filesystem::path& path) {
    modal::FrfFile frfs = modal::read_frfs({path});
    file.notes.insert(file.notes.end(), frfs.notes.begin(), frfs.notes.end());
    add_assumed(file.assumed, frfs.assumed);
    if (frfs.added_decay_per_s > 0.0) {
      throw InvalidInput(path.string(), "still holds the damping of an exponential window",
                         "Fit modes, which can do without it, or estimate the FRFs with remove_added_damping");
    }
    return std::move(frfs.set);
  };
  if (!file.frf.empty()) file.problem.measured = measured(file.frf);
  if (!file.workpiece_frf.empty()) file.problem.workpiece_measured = measured(file.workpiece_frf);
  const auto along_axis = [](const modal::Dof& dof) { return dof.axis == modal::Axis::z; };
  if (file.problem.in_three_directions() && !file.problem.dynamics.modes.empty() &&
      std::ranges::none_of(file.problem.dynamics.responses, along_axis)) {
    add_assumed(file.assumed, {{.what = "Direction z, not measured",
                                .taken = "rigid",
                                .key = "dynamics",
                                .file = file.path.filename().string()}});
  }
  if (file.drilling) return;
  const auto assumed = process::complete_directions(file.problem.dynamics, file.problem.measured, file.directions,
                                                    file.path, "dynamics");
  if (assumed) add_assumed(file.assumed, {*assumed});
}

}  // namespace robomill::jobs
