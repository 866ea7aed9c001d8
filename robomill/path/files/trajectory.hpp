#pragma once
#include <Eigen/Geometry>
#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/path/files/end_effector.hpp"
#include "robomill/path/options.hpp"
#include "robomill/path/sample.hpp"
#include "robomill/program/program.hpp"
#include "robomill/robot/kinematics.hpp"

// Method: robomill/path/README.md, "Files"

namespace robomill::io {
class PendingFile;
}

namespace robomill::path {

/// Makers of arms whose names are known, as messages spell them.
inline constexpr const char *maker_kuka = "KUKA", *maker_abb = "ABB", *maker_universal_robots = "Universal Robots";

/// What a trajectory's file holds beside its samples.
struct ROBOMILL_API TrajectoryInfo {
  int joints = 0;                       ///< n, 1 to 6
  std::array<bool, 6> prismatic = {};   ///< joints that are lengths [m]; the others are angles [rad]
  robot::JointLimits limits = {};       ///< written to .h5
  double sample_period_s = 0.001;       ///< > 0
  double program_period_s = 0.0;        ///< of joint programs: longest time from point to point; 0: 20 ms, servoj 2 ms,
                                        ///< or the sample period where that is longer
  std::string cell = {}, program = {};  ///< names of the files it comes from
  EndEffector end_effector = {};        ///< of joint programs
  Eigen::Isometry3d workpiece = Eigen::Isometry3d::Identity();  ///< of joint programs: W in B
  std::string maker = {};  ///< of the arm, such as maker_kuka; empty: not known. Of joint programs
  /// @throws InvalidInput naming the member
  void validate() const;
};

/// Distances of a controller's motion. Deviations: from the trajectory at the same time; errors: from the program, as
/// in path::CheckResult.
struct ROBOMILL_API RunDistances {
  double joint_deviation_rad = 0.0, tip_deviation_m = 0.0, axis_deviation_rad = 0.0;
  double tip_error_m = 0.0, axis_error_rad = 0.0;
  void include(const RunDistances& other);  ///< takes the larger of each
};

/// What a joint program's file holds and what its controller makes of it: the joints between its points as the
/// controller joins them, with the numbers that it holds, by forward kinematics.
struct ROBOMILL_API ProgramRun {
  std::size_t points = 0;
  double shortest_step_s = 0.0, longest_step_s = 0.0;  ///< from point to point
  RunDistances distances = {};
  double tip_tolerance_m = 0.0, axis_tolerance_rad = 0.0;
  double would_hold_s = 0.0;    ///< of a program with a fixed cycle that does not hold: the cycle that would; 0: none
  bool fixed_cycle = false;     ///< a point a cycle: none can be added
  std::size_t most_points = 0;  ///< that such a controller loads; 0: not known
  /// That the NC program asks for while the spindle turns, as they come, each once. The joint program only switches the
  /// spindle on: it carries out one at most.
  std::vector<double> spindle_speeds_rad_per_s = {};
  /// Whether deviations and errors are within the tolerances: each <= tolerance · (1 + 1e-6).
  [[nodiscard]] bool keeps_tolerances() const;
  [[nodiscard]] bool too_long() const { return most_points > 0 && points > most_points; }
  [[nodiscard]] bool one_speed() const { return spindle_speeds_rad_per_s.size() <= 1; }
  [[nodiscard]] bool holds() const { return keeps_tolerances() && !too_long() && one_speed(); }
};

/// Samples as a file, written as they come in memory that does not grow with them. The file appears by commit(), whole,
/// or not at all.
class ROBOMILL_API SampleFile {
 public:
  SampleFile() = default;
  SampleFile(const SampleFile&) = delete;
  SampleFile& operator=(const SampleFile&) = delete;
  SampleFile(SampleFile&&) = delete;
  SampleFile& operator=(SampleFile&&) = delete;
  virtual ~SampleFile() = default;
  /// Begins anew: what was added is forgotten.
  virtual void restart() = 0;
  /// @throws InvalidInput if the place cannot be written
  virtual void add(std::span<const Sample> samples) = 0;
  /// Of a joint program, after the last sample: chooses its points so that the controller's motion keeps the tolerances
  /// of trajectory and program, and checks it. Others: nothing.
  /// @param program  that was smoothed; read anew
  /// @param refine   put points nearer to each other where that is needed, down to every sample
  /// @throws InvalidInput what the program's reader throws; Interrupted
  virtual std::optional<ProgramRun> verify(program::Source& program, const robot::Kinematics& machine,
                                           const SmoothingOptions& options, bool refine, const Progress& progress);
  /// Of files that have a header (.h5 and joint programs), before commit: what a check for collisions found, for it.
  /// Without it the header says that nothing was checked.
  virtual void state_collisions(const std::string& found);
  /// Ends the file, which is whole then under its temporary name, for whoever places it with others.
  /// @throws InvalidInput if that fails
  virtual io::PendingFile& finish() = 0;
  /// finish(), and moves the file to its place. @throws InvalidInput if that fails
  void commit();
};

/// A file for samples by its ending: the trajectory as .csv or as .h5 .hdf5 (columns time_s, q1 … qn, x_mm, y_mm, z_mm,
/// i, j, k, block, which counts from 1), or a joint program: .src (KUKA KRL), .mod (ABB RAPID), .script (Universal
/// Robots URScript), .servoj (rows of joints, one a cycle). docs/formats.md.
/// @throws InvalidInput if the ending is another one, the info is invalid, the place cannot be written or is no regular
///     file, or the machine is none that such a program can drive: six revolute joints
[[nodiscard]] ROBOMILL_API std::unique_ptr<SampleFile> open_sample_file(const std::filesystem::path& path,
                                                                        const TrajectoryInfo& info);

}  // namespace robomill::path
