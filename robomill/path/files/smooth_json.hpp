#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "robomill/base/assumption.hpp"
#include "robomill/base/export.hpp"
#include "robomill/path/files/path_clearance.hpp"
#include "robomill/path/files/trajectory.hpp"
#include "robomill/path/options.hpp"
#include "robomill/path/posture.hpp"
#include "robomill/path/smooth.hpp"
#include "robomill/program/program.hpp"

// Method: robomill/path/README.md, "Files"

namespace robomill::path {

/// One method's trajectory.
struct SmoothedBy {
  Method method = Method::verified;
  Summary summary = {};
  std::vector<double> tracking_error = {};  ///< one a joint: the largest [rad or m]; empty where not asked for
};

/// A smoothed program as smooth.json holds it.
struct SmoothedProgram {
  std::string program = {}, cell = {};  ///< names of the files
  std::array<bool, 6> prismatic = {};   ///< joints that are lengths [m]
  /// The lowest and the highest turn of the flange about the tool's axis; none where the machine has no such freedom.
  std::optional<std::array<double, 2>> gamma_rad = {};
  std::optional<PostureChoice> posture = {};     ///< none where it was given
  bool written = false;                          ///< whether there is a trajectory
  std::vector<SmoothedBy> methods = {};          ///< the first is the one asked for; the others stand beside it
  std::optional<ProgramRun> robot_program = {};  ///< of the first, where it is written as one
  std::optional<PathClearance> clearance = {};   ///< of the first, by the cell's [geometry]; none: not checked
  std::vector<program::Skipped> skipped = {};
  std::vector<std::string> notes = {};
  std::vector<Assumption> assumed = {};
};

/// smooth.json: of the first method, and under "methods" of each where there are several. docs/formats.md.
/// @throws InvalidInput if there is no method
[[nodiscard]] ROBOMILL_API std::string smooth_json(const SmoothedProgram& smoothed);

}  // namespace robomill::path
