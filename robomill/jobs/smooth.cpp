#include "robomill/jobs/smooth.hpp"

#include <memory>
#include <string>

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

}  // namespace

process::SmoothResult run_smooth(const SmoothJob& job, Progress& progress) {
  SmoothJob smooth = job;
  if (io::format_of(job.program) == io::Format::toml) {
    if (smooth.cell.empty()) smooth.cell = job.program;
    smooth.program = process::program_of_job(job.program);
    if (smooth.program.empty()) {
      throw InvalidInput(job.program.string(), "job.program is missing", "It names the program to smooth");
    }
  }
  cell::CellFile cell = cell::read_cell(smooth.cell, cell::Robots::any);
  if (!job.near_deg.empty()) cell::ask_for_posture(cell, job.near_deg);
  return run_smooth(smooth, cell, progress);
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
