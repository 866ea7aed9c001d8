#pragma once
#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "robomill/base/assumption.hpp"
#include "robomill/base/export.hpp"
#include "robomill/decision/finish.hpp"
#include "robomill/decision/recommend.hpp"
#include "robomill/decision/test_cuts.hpp"
#include "robomill/io/toml_source.hpp"
#include "robomill/modal/directions.hpp"
#include "robomill/process/decide_options.hpp"

// Method: robomill/jobs/README.md, "Files"

namespace robomill::jobs {

/// job.toml. Paths are resolved; an empty one is absent. lobes, forces and cell are the job itself where it holds their
/// tables. Exactly one of hits, frf, modes and assembly is given, or [dynamics] gives the structure; a job that judges
/// blocks may have none of them, nor lobes.
struct Job {
  std::filesystem::path file = {};             ///< this one …
  std::vector<io::TomlSetting> settings = {};  ///< … and keys of it that are set to other values
  std::vector<std::string> notes = {};         ///< sentences for the user
  std::vector<Assumption> assumed = {};        ///< sample values
  std::string title = {};
  std::filesystem::path hits = {}, modes = {}, lobes = {};
  std::filesystem::path assembly = {};  ///< whose tip is predicted …
  std::filesystem::path joint = {};     ///< … with the joint of this joint.json in place of its own
  std::filesystem::path measured = {};  ///< … and FRFs of the tip to compare with it
  std::filesystem::path forces = {};    ///< a cut whose forces are reported …
  std::filesystem::path cell = {};      ///< … with the robot that it bends …
  std::filesystem::path program = {};   ///< … and along a program, which a cell with [smoothing] smooths
  modal::ModalModel own_modes = {};     ///< x, y and z of [dynamics]
  std::vector<std::filesystem::path> frf = {};
  std::vector<std::string> frf_as = {};
  std::array<double, 2> band_hz = {};        ///< of the fit: from, to; 0, 0: the whole data
  modal::MissingDirections directions = {};  ///< what an unmeasured direction is taken for
  int fit_modes = 0;                         ///< 0: chosen by the fit
  decision::MachineLimits recommend = {};
  decision::FinishLimits finish = {};
  process::DecideOptions decide = {};  ///< of a job that judges blocks
  std::vector<decision::TestCut> cuts = {};
  std::vector<double> near_deg =
      {};  ///< joints to begin the program near, asked for beside the file; empty: the cell's

  /// Whether every block of a program is looked at: forces along it, and a robot.
  [[nodiscard]] bool judges_blocks() const { return !forces.empty() && !cell.empty() && !program.empty(); }
  [[nodiscard]] bool has_structure() const {
    return !hits.empty() || !frf.empty() || !modes.empty() || !assembly.empty() || !own_modes.modes.empty();
  }
  /// The document, for the readers of its other tables.
  [[nodiscard]] io::TomlSource source() const { return {file, {}, settings}; }
  ROBOMILL_API void validate() const;
};

/// @throws InvalidInput with file, line, key and value
[[nodiscard]] ROBOMILL_API Job read_job(const io::TomlSource& source);

/// Reads the recording that a test cut names.
/// @throws InvalidInput if it cannot be read, or neither it nor the cut knows its rate
[[nodiscard]] ROBOMILL_API decision::CutSignal read_cut_signal(const decision::TestCut& cut);

}  // namespace robomill::jobs
