#pragma once
#include <filesystem>
#include <optional>

#include "robomill/base/export.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/cell/cell.hpp"
#include "robomill/cutting/files/force_record.hpp"
#include "robomill/process/files/forces_toml.hpp"
#include "robomill/process/forces.hpp"
#include "robomill/process/measured.hpp"
#include "robomill/program/files/program_files.hpp"

// Method: robomill/process/README.md, "Forces (`forces.hpp`)"

namespace robomill::jobs {

/// Forces of forces.toml: over one revolution, or, with a program, block by block along it.
/// @param program  empty: one revolution
/// @param cell     empty: the one that forces.toml names, if any
/// @throws InvalidInput with file, line, key and value; Interrupted
[[nodiscard]] ROBOMILL_API process::ForcesResult run_forces(const io::TomlSource& forces,
                                                            const std::filesystem::path& program,
                                                            const std::filesystem::path& cell,
                                                            Progress& progress = Progress::none());
/// The same of files that have been read, forces.toml for what the program asks (ForcesFile::job).
/// @param cell  none: the one that forces.toml names, if any
[[nodiscard]] ROBOMILL_API process::ForcesResult run_forces(const process::ForcesFile& forces,
                                                            const std::filesystem::path& program,
                                                            std::optional<cell::Cell> cell,
                                                            Progress& progress = Progress::none());
/// The same along a program that is run so.
/// @param reading  of the program; none: the cell's
[[nodiscard]] ROBOMILL_API process::ForcesResult run_forces_along(
    const process::ForcesFile& forces, const std::filesystem::path& program, std::optional<cell::Cell> cell,
    const process::ProgramRun& run, const std::optional<program::ProgramReading>& reading = {},
    Progress& progress = Progress::none());

/// A force record that a revolution is compared with.
struct MeasuredForceJob {
  std::filesystem::path record;
  cutting::ForceRecordOptions reading = {};
  process::RecordStretch stretch = {};
};
/// Forces over one revolution beside a record.
/// @throws InvalidInput as run_forces, read_force_record and compare_with_record
[[nodiscard]] ROBOMILL_API process::ForcesResult run_measured_forces(const std::filesystem::path& forces,
                                                                     const MeasuredForceJob& job,
                                                                     const std::filesystem::path& cell = {},
                                                                     Progress& progress = Progress::none());

/// What is assumed of a record where forces.toml has no force_on.
[[nodiscard]] ROBOMILL_API Assumption measured_acts_on_tool(const process::ForcesFile& file);

}  // namespace robomill::jobs
