#pragma once
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/export.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/cell/cell.hpp"
#include "robomill/cutting/cutter.hpp"
#include "robomill/path/files/smooth_json.hpp"
#include "robomill/path/files/smoothing_toml.hpp"
#include "robomill/path/files/trajectory.hpp"
#include "robomill/path/options.hpp"
#include "robomill/path/posture.hpp"
#include "robomill/path/record/motion_recorder.hpp"
#include "robomill/path/record/outline.hpp"
#include "robomill/path/sample.hpp"
#include "robomill/robot/kinematics.hpp"

// Method: robomill/process/README.md, "Smoothed programs (`smooth.hpp`)"

namespace robomill::process {

/// What to make of a program that is smoothed.
struct SmoothOptions {
  std::filesystem::path output = {};           ///< of the trajectory, by its ending; empty: none
  std::vector<path::Method> compare = {};      ///< methods that run too, after the smoothing's own
  bool keep_violations = false;                ///< write a trajectory that breaks limits all the same
  bool record = true;                          ///< curves for a report
  double program_period_s = 0.0;               ///< of joint programs; 0: path::TrajectoryInfo's
  bool place = true;                           ///< at the end; else place() is the caller's to call
  std::optional<path::Posture> posture = {};   ///< not given: chosen
  bool check_collisions = true;                ///< of the trajectory, where the cell has a geometry
  std::optional<cutting::Cutter> cutter = {};  ///< for that check; not given: the shank stands for it
  path::SampleSink observe = {};  ///< takes the samples too, of the smoothing's own method; time 0 begins anew
  /// Puts an error about a member of the smoothing into the words of its file; empty: there is none.
  std::function<InvalidInput(const InvalidInput&)> in_words = {};
};

struct SmoothResult {
  path::SmoothedProgram smoothed = {};
  std::filesystem::path output = {};                  ///< of the trajectory, as the options say
  bool stale = false;                                 ///< a file of an earlier run stood there and goes
  std::shared_ptr<path::SampleFile> trajectory = {};  ///< whole, beside its place
  path::SmoothingFile smoothing = {};
  path::PostureChoice posture = {};
  path::ProgramOutline outline = {};       ///< this and the next only where it is recorded
  std::vector<path::Motion> motions = {};  ///< one a method
  /// Where the robot stands as each block of the program ends, of the method asked for.
  std::vector<robot::Position6> block_joints = {};
  program::ProgramReading reading = {};  ///< how the program was read: blocks of another reading are other chords

  [[nodiscard]] const path::SmoothedBy& first() const { return smoothed.methods.front(); }
  /// Whether the trajectory asked for breaks no limit.
  [[nodiscard]] bool trajectory_holds() const { return first().summary.check.violations() == 0; }
  /// Whether no collision was found on its way; true too where nothing was checked.
  [[nodiscard]] bool clear() const { return !smoothed.clearance || smoothed.clearance->clear(); }
  /// … and the joint program made of it, where there is one, keeps the tolerances as its controller runs it, at one
  /// spindle speed.
  [[nodiscard]] bool holds() const {
    return trajectory_holds() && clear() && (!smoothed.robot_program || smoothed.robot_program->holds());
  }
};

/// How a program that is smoothed so is read: chords within a tenth of the tip's tolerance.
[[nodiscard]] ROBOMILL_API program::ProgramReading smoothed_reading(const cell::Cell& cell,
                                                                    const path::SmoothingOptions& options);

/// Smooths a program and writes its trajectory, or the joint program made of it, if it holds every limit and collides
/// with nothing that the cell's geometry describes; if not, a file that stands in its place from an earlier run is
/// taken away.
/// @param program    read as smoothed_reading() says
/// @param path       of its file, for messages; files and reports name the last part
/// @param smoothing  checked by path::read_smoothing, or for the limits of the cell's joints by the caller
/// @throws InvalidInput with the program, or with what cannot be reached; Interrupted
[[nodiscard]] ROBOMILL_API SmoothResult smooth(program::Source& program, const std::filesystem::path& path,
                                               const cell::Cell& cell, const path::SmoothingFile& smoothing,
                                               const SmoothOptions& options, Progress& progress = Progress::none());

/// The machine of a cell with the posture in which a program is smoothed, as smooth() chooses it.
struct PreparedMachine {
  std::unique_ptr<robot::Kinematics> machine = {};
  path::PostureChoice posture = {};
};
/// @throws InvalidInput as smooth(); Interrupted
[[nodiscard]] ROBOMILL_API PreparedMachine prepare_machine(program::Source& program, const std::filesystem::path& path,
                                                           const cell::Cell& cell, const path::SmoothingFile& smoothing,
                                                           Progress& progress = Progress::none());

/// Moves a trajectory that was not placed to its place, or takes away what stands there from an earlier
/// run. Once. @throws InvalidInput if that fails
ROBOMILL_API void place(const SmoothResult& result);

/// What a trajectory that was not checked for collisions takes for granted.
[[nodiscard]] ROBOMILL_API Assumption unchecked_collisions(const cell::Cell& cell);

/// A sentence: why a method of a comparison is not among the results.
[[nodiscard]] ROBOMILL_API std::string left_out_note(path::Method method, const InvalidInput& error);

/// The most of a joint's velocity, acceleration or jerk limit that a trajectory uses.
[[nodiscard]] ROBOMILL_API double joint_share(const path::CheckResult& check);

}  // namespace robomill::process
