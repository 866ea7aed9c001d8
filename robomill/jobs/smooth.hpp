#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "robomill/base/assumption.hpp"
#include "robomill/base/export.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/cell/files/cell_toml.hpp"
#include "robomill/path/options.hpp"
#include "robomill/path/smooth.hpp"
#include "robomill/process/smooth.hpp"
#include "robomill/program/files/program_files.hpp"
#include "robomill/robot/kinematics.hpp"

// Method: robomill/process/README.md, "Smoothed programs (`smooth.hpp`)"

namespace robomill::jobs {

/// A program's file to smooth in a cell with [smoothing].
struct SmoothJob {
  std::filesystem::path program;            ///< or the job (.toml) that names it
  std::filesystem::path cell;               ///< empty: the job's
  std::optional<path::Method> method = {};  ///< not given: the cell's
  bool compare = false;                     ///< all other methods too, which stand for options.compare
  std::vector<double> near_deg = {};        ///< joints to begin near, of a job that reads its cell; empty: the cell's
  process::SmoothOptions options = {};      ///< but for `in_words`, which are the cell's
};

/// Smooths a program as process::smooth does.
/// @throws InvalidInput with file, line, key and value, or with what cannot be reached; Interrupted
[[nodiscard]] ROBOMILL_API process::SmoothResult run_smooth(const SmoothJob& job,
                                                            Progress& progress = Progress::none());
/// The same in a cell that has been read, for any robot, from its file.
[[nodiscard]] ROBOMILL_API process::SmoothResult run_smooth(const SmoothJob& job, const cell::CellFile& cell,
                                                            Progress& progress = Progress::none());

/// A program before its machine, to be run in real time.
struct OpenedStream {
  cell::CellFile cell;
  path::SmoothingFile smoothing = {};
  std::unique_ptr<robot::Kinematics> machine = {};
  path::Posture posture = {};
  std::unique_ptr<program::ProgramFile> program = {};  ///< rewound
  std::string program_name = {};                       ///< of its file
  std::vector<std::string> notes = {};
  std::vector<Assumption> assumed = {};
};
/// Method, comparison and options but for the posture have no meaning: PathInterpolator plans.
/// @throws InvalidInput as run_smooth, or where the axis must be tilted to pass beside a singularity; Interrupted
[[nodiscard]] ROBOMILL_API OpenedStream open_stream(const SmoothJob& job, Progress& progress = Progress::none());

}  // namespace robomill::jobs
