#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/cutting/cutter.hpp"
#include "robomill/jobs/files/cell_toml.hpp"
#include "robomill/path/files/smooth_json.hpp"
#include "robomill/path/files/trajectory.hpp"
#include "robomill/path/options.hpp"
#include "robomill/path/posture.hpp"
#include "robomill/path/record/motion_recorder.hpp"
#include "robomill/path/record/outline.hpp"
#include "robomill/path/sample.hpp"

// Method: robomill/jobs/README.md, "Smoothed programs (`smooth.hpp`)"

namespace robomill::jobs {

/// A program to smooth and what to make of it.
struct SmoothJob {
  std::filesystem::path program, cell;
  std::filesystem::path output = {};          ///< of the trajectory, by its ending; empty: none
  std::optional<path::Method> method = {};    ///< not given: the cell's
  bool compare = false;                       ///< all other methods too
  bool keep_violations = false;               ///< write a trajectory that breaks limits all the same
  bool record = true;                         ///< curves for a report
  double program_period_s = 0.0;              ///< of joint programs; 0: path::TrajectoryInfo's
  bool place = true;                          ///< at the end; else place() is the caller's to call
  std::string program_name = {};              ///< as files and reports name it; empty: its file's name
  std::optional<path::Posture> posture = {};  ///< not given: chosen
  /// Check the trajectory for collisions where the cell has [geometry].
  bool check_collisions = true;
  std::optional<cutting::Cutter> cutter = {};  ///< for that check; not given: the shank stands for it
  std::vector<double> near_deg = {};  ///< joints to begin near, of a job that reads its cell; empty: the cell's
  path::SampleSink observe = {};      ///< takes the samples too, of the method asked for; time 0 begins anew
};

struct SmoothResult {
  path::SmoothedProgram smoothed = {};
  std::filesystem::path output = {};                  ///< of the trajectory, as the job says
  bool stale = false;                                 ///< a file of an earlier run stood there and goes
  std::shared_ptr<path::SampleFile> trajectory = {};  ///< whole, beside its place
  path::SmoothingOptions options = {};
  path::PostureChoice posture = {};
  path::ProgramOutline outline = {};       ///< this and the next only of a job that records
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

/// Smooths a program and writes its trajectory, or the joint program made of it, if it holds every limit and collides
/// with nothing that the cell's [geometry] describes; if not, a file that stands in its place from an earlier run is
/// taken away.
/// @throws InvalidInput with file, line, key and value, or with what cannot be reached; Interrupted
[[nodiscard]] ROBOMILL_API SmoothResult run_smooth(const SmoothJob& job, Progress& progress = Progress::none());
/// The same in a cell that has been read, for any robot, from its file.
[[nodiscard]] ROBOMILL_API SmoothResult run_smooth(const SmoothJob& job, CellFile cell,
                                                   Progress& progress = Progress::none());

/// Moves the trajectory of a job that does not place it to its place, or takes away what stands there from an earlier
/// run. Once. @throws InvalidInput if that fails
ROBOMILL_API void place(const SmoothResult& result);

/// What a trajectory that was not checked for collisions takes for granted.
[[nodiscard]] ROBOMILL_API Assumption unchecked_collisions(const CellFile& cell);

/// The most of a joint's velocity, acceleration or jerk limit that a trajectory uses.
[[nodiscard]] ROBOMILL_API double joint_share(const path::CheckResult& check);

}  // namespace robomill::jobs
