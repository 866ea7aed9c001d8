#include "robomill/jobs/smooth.hpp"

#include <memory>
#include <string>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/cell/posture_choice.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/toml/file.hpp"
#include "robomill/path/files/smoothing_toml.hpp"
#include "robomill/process/files/forces_toml.hpp"
#include "robomill/program/files/program_files.hpp"
#include "robomill/robot/kinematics.hpp"

namespace robomill::jobs {
namespace {

/// All other methods, but for those that the cell's [smoothing] does not suit: they are noted.
std::vector<path::Method> others(const cell::CellFile& cell, const robot::Kinematics& machine, path::Method first,
                                 std::vector<std::string>& notes) {
  std::vector<path::Method> out;
  for (const auto& [name, method] : path::method_names) {
    if (method == first) continue;
    try {
      static_cast<void>(path::read_smoothing(*cell.document, machine.limits(), machine.joints(), method));
      out.push_back(method);
    } catch (const InvalidInput& error) {
      notes.push_back(process::left_out_note(method, error));
    }
  }
  return out;
}

/// The same with the program's own file and the cell's.
SmoothJob resolved(const SmoothJob& job) {
  SmoothJob smooth = job;
  if (io::format_of(job.program) != io::Format::toml) return smooth;
  if (smooth.cell.empty()) smooth.cell = job.program;
  smooth.program = process::program_of_job(job.program);
  if (smooth.program.empty()) {
    throw InvalidInput(job.program.string(), "job.program is missing", "It names the program to smooth");
  }
  return smooth;
}

cell::CellFile cell_of(const SmoothJob& smooth) {
  cell::CellFile cell = cell::read_cell(smooth.cell, cell::Robots::any);
  if (!smooth.near_deg.empty()) cell::ask_for_posture(cell, smooth.near_deg);
  return cell;
}

}  // namespace

process::SmoothResult run_smooth(const SmoothJob& job, Progress& progress) {
  const SmoothJob smooth = resolved(job);
  return run_smooth(smooth, cell_of(smooth), progress);
}

OpenedStream open_stream(const SmoothJob& job, Progress& progress) {
  const SmoothJob smooth = resolved(job);
  OpenedStream out{.cell = cell_of(smooth)};
  const std::unique_ptr<robot::Kinematics> limits = cell::kinematics(out.cell);
  out.smoothing = path::read_smoothing(*out.cell.document, limits->limits(), limits->joints(), path::Method::verified);
  out.program = program::open_program(smooth.program, process::smoothed_reading(out.cell, out.smoothing.options));
  out.program_name = smooth.program.filename().string();
  process::PreparedMachine prepared =
      process::prepare_machine(*out.program, smooth.program, out.cell, out.smoothing, progress);
  if (!prepared.posture.posture.tilts.empty()) {
    throw InvalidInput(smooth.program.string(),
                       "passes a singularity of the wrist that only a tilt of the axis avoids: it cannot be streamed",
                       "robomill smooth without --stream tilts it; or move the workpiece");
  }
  out.notes = out.cell.notes;
  for (const std::string& note : cell::posture_notes(prepared.posture)) out.notes.push_back(note);
  out.machine = std::move(prepared.machine);
  out.posture = std::move(prepared.posture.posture);
  out.program->rewind();
  const program::Remarks remarks = out.program->remarks();
  out.notes.insert(out.notes.end(), remarks.notes.begin(), remarks.notes.end());
  out.assumed = cell::assumed_along_program(out.cell, true);
  add_assumed(out.assumed, remarks.assumed);
  out.assumed.push_back({.what = "Collisions", .taken = "none; a stream is not checked, robomill smooth -o FILE is"});
  return out;
}

process::SmoothResult run_smooth(const SmoothJob& job, const cell::CellFile& cell, Progress& progress) {
  const std::unique_ptr<robot::Kinematics> machine = cell::kinematics(cell);
  const path::SmoothingFile smoothing =
      path::read_smoothing(*cell.document, machine->limits(), machine->joints(), job.method);
  process::SmoothOptions options = job.options;
  options.in_words = [&](const InvalidInput& error) { return cell.document->located(error); };
  std::vector<std::string> notes;
  if (job.compare) options.compare = others(cell, *machine, smoothing.options.method, notes);
  const std::unique_ptr<program::ProgramFile> program =
      program::open_program(job.program, process::smoothed_reading(cell, smoothing.options));
  process::SmoothResult result = process::smooth(*program, job.program, cell, smoothing, options, progress);
  std::vector<std::string>& all = result.smoothed.notes;
  all.insert(all.begin(), notes.begin(), notes.end());
  return result;
}

}  // namespace robomill::jobs
