#include "robomill/jobs/plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/cell/files/cell_toml.hpp"
#include "robomill/cell/posture_choice.hpp"
#include "robomill/decision/choose.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/usual_ranges.hpp"
#include "robomill/jobs/files/assumed.hpp"
#include "robomill/jobs/forces.hpp"
#include "robomill/jobs/plan_stages.hpp"
#include "robomill/modal/directions.hpp"
#include "robomill/modal/files/frf_files.hpp"
#include "robomill/modal/files/hits_toml.hpp"
#include "robomill/modal/files/modes_files.hpp"
#include "robomill/path/files/smoothing_toml.hpp"
#include "robomill/process/blocks/dynamics.hpp"
#include "robomill/process/decide/motion_loads.hpp"
#include "robomill/process/files/structure_schema.hpp"
#include "robomill/process/spindle.hpp"

namespace robomill::jobs {
namespace {

template <class T>
void append(std::vector<T>& to, const std::vector<T>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

/// What warns among a file's notes, which are not the plan's otherwise.
void append_warnings(std::vector<std::string> notes, std::vector<std::string>& warnings) {
  append(warnings, io::take_warnings(notes));
}

/// Where prediction and measurement are further apart than this, the lobes are those of another tip.
constexpr double far_apart = 0.2;

void warn_of_distance(const TipPrediction& prediction, std::vector<std::string>& warnings) {
  for (const modal::FrfFitError& error : prediction.error) {
    if (!(error.relative > far_apart)) continue;
    std::string text = fmt::format("The predicted {} differs from the measured one by {:.0f} %",
                                   modal::to_string(error.name), 100.0 * error.relative);
    // Of a round tool the peaks stand in x alone, for both.
    const auto peak = std::ranges::find_if(
        prediction.peaks, [&](const coupling::TipPeak& p) { return prediction.round || p.name == error.name; });
    if (peak != prediction.peaks.end()) {
      text += fmt::format(": its first peak is predicted at {:.6g} Hz, ", peak->frequency_hz);
      text += std::isfinite(peak->measured_frequency_hz)
                  ? fmt::format("the measured one next to it stands at {:.6g} Hz", peak->measured_frequency_hz)
                  : std::string("where no measured one is near");
    }
    warnings.push_back(text + ". Plan from the measurement, or find the joint with robomill joint.");
  }
}

void warn_of_prediction(PlanResult& result) {
  const TipPrediction& prediction = *result.prediction;
  result.notes.push_back(
      prediction.measured ? "The FRFs are predicted from the assembly; the measured ones are only compared with them."
                          : "The FRFs are predicted from the assembly, not measured.");
  if (!prediction.file.cutting_note.empty()) result.notes.push_back(prediction.file.cutting_note);
  append_warnings(prediction.file.notes, result.warnings);
  append(result.notes, prediction.file.joint_notes);
  append(result.warnings, prediction.file.joint_warnings);
  warn_of_distance(prediction, result.warnings);
  if (!prediction.tip.suspect_hz.empty()) {
    result.warnings.push_back(fmt::format(
        "At {} lines, from {:.6g} Hz on, the measured holder would create energy: what is predicted there is suspect.",
        prediction.tip.suspect_hz.size(), prediction.tip.suspect_hz.front()));
  }
  if (prediction.file.holder && !prediction.file.holder->unreliable_hz.empty()) {
    const std::vector<double>& lines = prediction.file.holder->unreliable_hz;
    result.warnings.push_back(
        fmt::format("At {} lines, from {:.6g} Hz on, a small error of the holder's measurement became a large one of "
                    "its receptances: they are unreliable there.",
                    lines.size(), lines.front()));
  }
}

void measure(PlanResult& result, Progress& progress) {
  if (!result.job.hits.empty()) {
    const modal::HitsFile hits = modal::read_hits(result.job.hits);
    std::vector<std::string> notes = hits.notes;
    append(result.warnings, io::take_warnings(notes));
    append(result.notes, notes);
    add_assumed(result.assumed, hits.assumed);
    for (const modal::Hit& hit : hits.hits) {
      result.hit_directions.push_back(
          fmt::format("{}{}", hit.against_axis ? "-" : "", modal::to_string(hit.excitation)));
    }
    result.hits = modal::estimate_frfs(hits.hits, hits.options, progress);
    append(result.notes, result.hits->notes);
    result.frfs = result.hits->set;
    if (!result.hits->added_decay_removed) result.added_decay_per_s = result.hits->added_decay_per_s;
  } else if (!result.job.frf.empty()) {
    const modal::FrfFile file = modal::read_frfs(result.job.frf, result.job.frf_as);
    append(result.notes, file.notes);
    add_assumed(result.assumed, file.assumed);
    result.frfs = file.set;
    result.added_decay_per_s = file.added_decay_per_s;
  } else if (!result.job.assembly.empty()) {
    result.prediction =
        predict_tip(result.job.assembly, result.job.measured, {}, progress, result.job.joint, TipUse::cutting);
    result.frfs = result.prediction->tip.frfs;
    add_assumed(result.assumed, result.prediction->file.assumed);
    warn_of_prediction(result);
  }
}

void fit(PlanResult& result, std::uint64_t seed, Progress& progress) {
  // Of FRFs the modes are doubled, where the directions are equal, and not what they are fitted to.
  modal::FrfSet measured = result.frfs.value_or(modal::FrfSet{});
  if (!result.frfs) {
    result.model = result.job.modes.empty() ? result.job.own_modes : modal::read_modes(result.job.modes, result.notes);
  }
  const modal::MissingDirections& directions = result.job.directions;
  const auto assumed = process::complete_directions(result.model, measured, directions, result.job.file, "job");
  if (assumed) add_assumed(result.assumed, {*assumed});
  if (!result.frfs) return;
  modal::FitOptions options;
  options.seed = seed;
  options.modes = result.job.fit_modes;
  if (const std::array<double, 2>& band_hz = result.job.band_hz; band_hz[1] > 0.0) {
    options.band_low_hz = band_hz[0];
    options.band_high_hz = band_hz[1];
  } else if (result.hits) {
    const auto [low_hz, high_hz] = result.hits->band_hz();
    options.band_low_hz = low_hz;
    options.band_high_hz = high_hz;
  }
  options.exponential_decay_per_s = result.added_decay_per_s;
  result.fit = result.prediction ? coupling::fit_tip(*result.frfs, options, progress)
                                 : modal::fit_modes(*result.frfs, options, progress);
  if (directions.equal) result.fit = modal::with_equal_directions(*std::move(result.fit));
  result.model = result.fit->model;
  append(result.warnings, result.fit->warnings);
  if (result.fit->status == modal::FitResult::Status::not_converged) {
    result.warnings.push_back("The fit of the modes did not converge: look at the FRFs before using a number.");
  }
}

/// What the job's and the cutter's length of the edges say differently.
void warn_of_edges(const process::ForcesFile& forces, PlanResult& result) {
  const double edges_m = forces.cutter.cutting_height_m, deepest_m = result.job.recommend.max_axial_depth_m;
  const bool stated = forces.document->has("tool.cutting_height_mm");
  constexpr double rounding = 1e-6;
  if (!stated || !(deepest_m > edges_m * (1.0 + rounding))) return;
  result.warnings.push_back(
      fmt::format("tool.max_axial_depth_mm is {:.6g} in {}, and the edges reach {:.6g} mm up in {} "
                  "(tool.cutting_height_mm): a deeper cut runs the shank into material.",
                  deepest_m / units::mm, result.job.file.filename().string(), edges_m / units::mm,
                  forces.path.filename().string()));
}

/// The job's cell, for forces or for what smooths its program; only serial arms have forces.
std::optional<cell::CellFile> cell_of(const Job& job) {
  if (job.cell.empty() || (job.forces.empty() && job.program.empty())) return std::nullopt;
  io::require_file(job.cell);
  cell::CellFile cell = cell::read_cell(job.source(), job.forces.empty() ? cell::Robots::any : cell::Robots::serial);
  if (!job.near_deg.empty()) cell::ask_for_posture(cell, job.near_deg);
  return cell;
}

/// Whether the job's program is to be smoothed.
bool wants_path(const Job& job, const std::optional<cell::CellFile>& cell) {
  if (job.program.empty() || !cell) return false;
  if (path::has_smoothing(*cell->document)) return true;
  if (!job.forces.empty()) return false;
  throw InvalidInput(job.cell.string(), "has no [smoothing]",
                     "job.program without job.forces is smoothed: write the tolerances and limits there");
}

/// The program as the robot will run it.
void smooth(PlanResult& result, const cell::CellFile& cell, const std::filesystem::path& folder, Progress& progress) {
  SmoothJob smooth = {.program = result.job.program, .cell = cell.path, .options = {.place = false}};
  if (!folder.empty()) {
    io::make_folder(folder);
    smooth.options.output = folder / "trajectory.csv";
  }
  if (cell.geometry && !result.job.forces.empty()) {
    smooth.options.cutter = process::read_forces(result.job.source(), process::ForcesJob::program).cutter;
  }
  result.programmed.path = run_smooth(smooth, cell, progress);
}

/// Of the program that is to run, as it was or as it was decided.
void warn_of_path(PlanResult& result) {
  if (!result.shown().path || result.shown().path->holds()) return;
  const process::SmoothResult& path = *result.shown().path;
  const char* removed = path.stale ? ", and the one of an earlier run was removed" : "";
  if (!path.clear()) {
    result.warnings.push_back(fmt::format("There is no trajectory{}. On its way {}.", removed,
                                          path::clearance_text(*path.smoothed.clearance)));
    return;
  }
  result.warnings.push_back(fmt::format(
      "The smoothed program breaks limits {} times: there is no trajectory{}. See the limits of each joint.",
      path.first().summary.check.violations(), removed));
}

/// Forces along the program, the robot as the smoothed path has it, where there is one.
process::ForcesResult forces_along(const PlanResult& result, const process::ForcesFile& file,
                                   const std::optional<cell::CellFile>& cell, Progress& progress) {
  process::ProgramRun run = {.keep_cuts = true, .deflect = true};
  const std::optional<process::SmoothResult>& path = result.programmed.path;
  if (!path || path->block_joints.empty()) {
    return run_forces_along(file, result.job.program, cell, run, {}, progress);
  }
  run.joints = path->block_joints;
  return run_forces_along(file, result.job.program, cell, run, path->reading, progress);
}

/// What vibrates along the program: the cell's measured postures, else the job's structure in every posture, else the
/// cell's arm.
process::DynamicsAt dynamics_along(PlanResult& result, const cell::Cell& cell, Progress& progress) {
  const auto assume = [&](const char* taken) {
    result.assumed.push_back({.what = "Dynamics along the program",
                              .taken = taken,
                              .key = "postures",
                              .file = cell.path.filename().string()});
  };
  if (!result.programmed.forces->cut.dynamics.modes.empty()) {
    result.notes.emplace_back("[dynamics] of forces.toml takes no part in the stability of the program's blocks.");
  }
  if (!cell.postures.empty() || !result.job.has_structure()) {
    if (result.job.has_structure()) {
      result.notes.emplace_back(
          "The dynamics of the program's blocks are those of the cell's postures, not the job's.");
    } else if (cell.postures.empty()) {
      assume("those of the cell's arm alone; nothing was measured");
    }
    return process::dynamics_of_cell(cell, process::pushed_axes(*result.programmed.forces), result.warnings,
                                     result.notes, result.assumed, progress);
  }
  assume("the job's, the same in every posture, in the robot's base axes");
  return process::constant_dynamics(result.model);
}

/// The stability of every block, and the conditions to cut the program at.
void judge(PlanResult& result, const cell::Cell& cell, const std::filesystem::path& folder, Progress& progress) {
  const LobesFile& cut = result.cut;
  const process::BlocksOptions options = {.workpiece_vibrates = !cut.workpiece_modes.empty() ||
                                                                !cut.workpiece_frf.empty() ||
                                                                !cut.problem.workpiece_dynamics.modes.empty()};
  const process::DynamicsAt dynamics = dynamics_along(result, cell, progress);
  result.judging = {.dynamics = dynamics, .options = options};
  result.programmed.blocks = process::judge_blocks(*result.programmed.forces, dynamics, options, progress);
  if (result.job.decide.free.empty()) return;
  if (result.programmed.blocks->cutting == 0) {
    result.notes.emplace_back("No block of the program cuts: there are no conditions to decide.");
    return;
  }
  decide_conditions(result, cell, dynamics, options, folder, progress);
}

/// Forces, and with a program and a robot the stability of every block and the conditions to cut it at.
void load_and_judge(PlanResult& result, const std::optional<cell::CellFile>& cell, const std::filesystem::path& folder,
                    Progress& progress) {
  if (result.job.forces.empty()) return;
  const bool along = !result.job.program.empty();
  io::require_file(result.job.forces);
  const process::ForcesFile file =
      process::read_forces(result.job.source(), along ? process::ForcesJob::program : process::ForcesJob::revolution);
  warn_of_edges(file, result);
  if (!result.job.judges_blocks()) {
    result.programmed.forces = run_forces(file, result.job.program, cell, progress);
  } else {
    result.programmed.forces = forces_along(result, file, cell, progress);
  }
  const bool usable = !result.fit || result.fit->usable();
  if (result.job.judges_blocks() && usable) judge(result, *cell, folder, progress);
  const auto add_capacity = [&](process::ForcesResult& forces) {
    forces.spindle = process::capacity_along(forces, result.job.recommend.spindle);
  };
  add_capacity(*result.programmed.forces);
  if (result.decided) add_capacity(*result.decided->forces);
  std::string weak = process::spindle_warning(*result.shown().forces, result.job.recommend.spindle);
  if (!weak.empty()) result.warnings.push_back(std::move(weak));
}

/// lobes.toml, and what a plan asks of it.
void read_cut(PlanResult& result) {
  io::require_file(result.job.lobes);
  result.cut = read_lobes(result.job.source());
  append(result.notes, result.cut.notes);
  append(result.warnings, io::take_warnings(result.notes));
  require_plane(result.cut, "plan chooses depth and speed of such a cut; robomill lobes judges any");
  if (!(result.cut.problem.milling.feed_per_tooth_m > 0.0)) {
    throw InvalidInput(result.job.lobes.string(), "cut.feed_per_tooth_mm is missing",
                       "plan needs it for the removal rate");
  }
  try {
    decision::require_finishable(result.cut.problem, result.job.finish);
  } catch (const InvalidInput& error) {
    throw InvalidInput(InvalidInput::Parts{.where = result.job.file.string(),
                                           .field = "finishing",
                                           .rule = error.parts().rule,
                                           .hint = error.parts().hint});
  }
}

/// Adds what the stages that ran have assumed, and the job itself.
/// @param cell  that the job runs in; null: none
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

}  // namespace

PlanResult run_job(const io::TomlSource& job, std::uint64_t seed, Progress& progress,
                   const std::filesystem::path& folder, bool accept_fit, const std::vector<double>& near_deg) {
  PlanResult result;
  result.job = read_job(job);
  append_warnings(result.job.notes, result.warnings);
  result.job.near_deg = near_deg;
  // Everything that is quick to reject is read before the long work starts.
  if (result.recommends()) read_cut(result);
  const std::optional<cell::CellFile> cell = cell_of(result.job);
  if (cell && result.job.forces.empty())
    append_warnings(cell->notes, result.warnings);  // else they come with the forces
  const bool with_path = wants_path(result.job, cell);
  if (result.job.has_structure()) {
    measure(result, progress);
    fit(result, seed, progress);
  }
  if (result.fit && accept_fit) result.fit->accepted = true;
  const bool usable = !result.fit || result.fit->usable();
  if (usable && with_path) smooth(result, *cell, folder, progress);
  load_and_judge(result, cell, folder, progress);
  if (!usable) {
    result.recommendation.reason = fmt::format(
        "The modes do not describe the FRFs: the fit differs from them by {:.3g} %, and from {:.3g} % on nothing is "
        "computed from it. Fit a better band (job.band_hz), or accept it with --accept-fit.",
        100.0 * result.fit->relative_error, 100.0 * modal::unusable_fit_error);
  } else if (result.recommends()) {
    choose_conditions(result, seed, progress);
  } else {
    result.notes.emplace_back(
        "The job names no lobes.toml: there are no lobes, no recommended speed and depth, and test cuts are not "
        "compared.");
  }
  warn_of_path(result);
  gather_assumed(result, cell ? &*cell : nullptr);
  return result;
}

PlanResult run_structure(const std::filesystem::path& job, std::uint64_t seed, Progress& progress) {
  PlanResult result;
  result.job = read_job(job);
  measure(result, progress);
  fit(result, seed, progress);
  if (result.fit && !result.fit->usable()) {
    throw InvalidInput(job.string(),
                       fmt::format("gives modes that do not describe its FRFs: the fit differs from them by {:.3g} %",
                                   100.0 * result.fit->relative_error),
                       "Fit a better band: job.band_hz");
  }
  return result;
}

process::JudgedProgram judged_program(const PlanResult& result) {
  const PlannedProgram& shown = result.shown();
  if (!shown.forces || !shown.blocks || !result.judging || !shown.forces->cell || !shown.forces->program) {
    throw InvalidInput("plan", "must be of a job with forces, a cell and a program whose blocks were judged");
  }
  process::JudgedProgram out = {.forces = *shown.forces, .blocks = *shown.blocks, .judging = *result.judging};
  // The decided program is turned already.
  if (result.decided) out.gamma_offset_rad = result.decision->gamma_offset_rad;
  if (result.decision && result.decision->gamma_map) out.map_blocks = result.decision->gamma_map->block;
  return out;
}

bool collisions_checked(const PlanResult& result) {
  if (result.shown().path) return result.shown().path->smoothed.clearance.has_value();
  return result.decision && result.decision->collisions_checked;
}

bool reached(const PlanResult& result) {
  if (result.decision && !result.decision->collision.empty()) return false;
  if (result.decision && result.decision->status == process::Decision::Status::infeasible) return false;
  const PlannedProgram& shown = result.shown();
  if (shown.path && !shown.path->holds()) return false;
  if (shown.blocks && !result.recommends()) return true;  // an unstable block is an answer
  return result.recommendation.status == decision::Recommendation::Status::found;
}

}  // namespace robomill::jobs
