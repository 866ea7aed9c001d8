#include "robomill/jobs/forces.hpp"

#include <utility>

#include "robomill/cell/files/cell_toml.hpp"
#include "robomill/io/toml/file.hpp"
#include "robomill/jobs/files/assumed.hpp"

namespace robomill::jobs {
namespace {

std::optional<cell::Cell> cell_of(const process::ForcesFile& forces, std::optional<cell::Cell> cell) {
  if (!cell && !forces.cell.empty()) cell = cell::read_cell(forces.cell);
  return cell;
}

/// The cut, with all that its file leaves to a default.
process::Cut cut_of(const process::ForcesFile& forces, bool with_cell) {
  process::Cut cut = static_cast<const process::Cut&>(forces);
  cut.assumed = assumed_of(forces, with_cell);
  return cut;
}

}  // namespace

process::ForcesResult run_forces(const io::TomlSource& forces, const std::filesystem::path& program,
                                 const std::filesystem::path& cell, Progress& progress) {
  using process::ForcesJob;
  const std::filesystem::path along = program.empty() ? process::program_of_job(forces) : program;
  process::ForcesFile file = process::read_forces(forces, along.empty() ? ForcesJob::revolution : ForcesJob::program);
  if (!cell.empty()) file.cell = cell;
  return run_forces(file, along, std::nullopt, progress);
}

process::ForcesResult run_forces(const process::ForcesFile& forces, const std::filesystem::path& program,
                                 std::optional<cell::Cell> cell, Progress& progress) {
  if (!program.empty()) return run_forces_along(forces, program, std::move(cell), {}, {}, progress);
  cell = cell_of(forces, std::move(cell));
  process::Cut cut = cut_of(forces, cell.has_value());
  return process::forces_of_revolution(std::move(cut), std::move(cell), progress);
}

process::ForcesResult run_forces_along(const process::ForcesFile& forces, const std::filesystem::path& program,
                                       std::optional<cell::Cell> cell, const process::ProgramRun& run,
                                       const std::optional<program::ProgramReading>& reading, Progress& progress) {
  cell = cell_of(forces, std::move(cell));
  const program::ProgramReading of_cell = cell ? cell::program_reading(*cell) : program::ProgramReading{};
  process::Cut cut = cut_of(forces, cell.has_value());
  progress.start("reading the program", 1);
  return forces.located([&] {
    return process::forces_along(std::move(cut), program::read_program(program, reading.value_or(of_cell)), program,
                                 std::move(cell), run, progress);
  });
}

process::ForcesResult run_measured_forces(const std::filesystem::path& forces, const MeasuredForceJob& job,
                                          const std::filesystem::path& cell, Progress& progress) {
  process::ForcesFile file = process::read_forces(forces, process::ForcesJob::revolution);
  if (!cell.empty()) file.cell = cell;
  const cutting::ForceRecordFile record = cutting::read_force_record(job.record, job.reading);
  process::ForcesResult result = run_forces(file, {}, std::nullopt, progress);
  if (!file.document->has("force_on")) result.assumed.push_back(measured_acts_on_tool(file));
  process::compare_with_record(result, record, job.stretch);
  return result;
}

Assumption measured_acts_on_tool(const process::ForcesFile& file) {
  return {.what = "What the measured force acts on",
          .taken = "the tool; a dynamometer under the workpiece measures the force on the workpiece",
          .key = "force_on",
          .file = file.path.filename().string()};
}

}  // namespace robomill::jobs
