#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/cell/cell.hpp"
#include "robomill/path/posture.hpp"
#include "robomill/robot/inverse.hpp"
#include "robomill/robot/kinematics.hpp"
#include "robomill/robot/pose.hpp"

// Method: robomill/cell/README.md, "A cell before it is used (`check.hpp`)"

namespace robomill::cell {

/// What to look at in a cell.
struct CellCheckJob {
  std::filesystem::path cell = {};
  std::vector<double> joints = {};     ///< one more position to show, a value a joint [rad or m]; empty: none
  std::filesystem::path program = {};  ///< that must be reached; empty: the workpiece's origin, the spindle along its z
  std::size_t most_proposals = 3;      ///< workpiece poses to look for where the cell's own does not serve
};

/// A position of the joints and the tool that it makes.
struct CellStand {
  std::string name = {};  ///< "home", "joint 2 at its lower limit", …
  robot::Position6 position = robot::Position6::Zero();
  Eigen::Isometry3d flange = Eigen::Isometry3d::Identity();                          ///< in B, before any mount
  Eigen::Vector3d tip_m = Eigen::Vector3d::Zero(), axis = Eigen::Vector3d::UnitZ();  ///< in B
  robot::ToolPose tool = {};                                                         ///< in the program's frame W
  robot::Position6 to_limit = robot::Position6::Constant(1e300);  ///< of each joint to its nearer limit; < 0: beyond
  int nearest_joint = -1;  ///< the one nearest to its limit by its share of half the range, from 0; -1: no limits
  double condition_number = 1.0;  ///< 1 / Kinematics::regularity
};

/// A joint beyond its limit.
struct BeyondLimit {
  int joint = 0;  ///< from 0
  double position = 0.0, limit = 0.0;
  [[nodiscard]] bool above() const { return position > limit; }
};

/// A pose that the tool cannot take. Of all ways to it, and of all turns about the tool's axis that the cell leaves
/// free, the one that misses by least.
struct Miss {
  std::size_t block = 0;   ///< from 1, at its end; 0: the program's start, or the workpiece's origin
  std::size_t line = 0;    ///< in the program's file; 0: none
  robot::ToolPose pose{};  ///< in W
  robot::Reach::Status status = robot::Reach::Status::out_of_reach;
  std::vector<BeyondLimit> beyond = {};                 ///< outside limits: all of them
  double out_of_reach_m = 0.0, out_of_reach_rad = 0.0;  ///< out of reach: one of them, where it is known
  double condition_number = 0.0;                        ///< singular
};

/// Whether tool and workpiece come together where the workpiece stands.
struct Placement {
  Eigen::Isometry3d workpiece = Eigen::Isometry3d::Identity();  ///< W in B
  std::size_t poses = 0;            ///< looked at: the start and the end of each block, or the origin alone
  std::vector<Miss> misses = {};    ///< those that could not be taken, at most a hundred …
  bool complete = true;             ///< … else the poses after these were not looked at
  std::string no_way = {};          ///< each pose can be taken, but not one after the other: where and why
  path::PostureChoice choice = {};  ///< of a program that can be followed: how; without a program its start alone
  [[nodiscard]] bool works() const { return misses.empty() && no_way.empty(); }
};

/// A pose of the workpiece that serves, found near the given one.
struct Proposal {
  Placement placement = {};
  Eigen::Vector3d shift_m = Eigen::Vector3d::Zero();  ///< of the program's middle, in B
  double turn_rad = 0.0;                              ///< about B's z, through there
};

/// The machine as lines in B.
struct CellFigure {
  std::string name = {};
  std::vector<std::vector<Eigen::Vector3d>> links_m = {};  ///< a broken line each
  std::vector<Eigen::Vector3d> joints_m = {};              ///< of each joint a point of its axis
  Eigen::Vector3d flange_m = Eigen::Vector3d::Zero(), tip_m = Eigen::Vector3d::Zero();
};

/// What a picture of the cell shows.
struct CellDrawing {
  std::vector<CellFigure> figures = {};  ///< home, and at the workpiece where that is reached
  /// Where the wrist can be (the origin of joint 5), as closed outlines: with joint 1 at 0 seen along B's y (x, z), and
  /// from above (x, y) over all of joint 1. A second outline in one is a hole in it. Empty where axis 1 is not along z.
  std::vector<std::vector<Eigen::Vector2d>> reach_side_m = {}, reach_top_m = {};
  std::vector<Eigen::Vector3d> program_m = {};  ///< some points of its path, in B
};

struct CellCheck {
  Cell cell = {};
  int joints = 6;
  std::array<bool, 6> prismatic = {};
  robot::JointLimits limits = {};
  std::string program = {};               ///< its file's name; empty: none
  bool whole = true;                      ///< the program was read to its end
  std::vector<CellStand> stands = {};     ///< as asked for, home, at the workpiece
  std::vector<CellStand> at_limits = {};  ///< from home each joint at each of its limits
  Placement placement = {};
  std::vector<Proposal> proposals = {};  ///< the smallest change first; empty where the cell's own pose serves
  CellDrawing drawing = {};
  std::vector<std::string> notes = {};
};

/// Reads a cell, with any robot, and looks at it: where its joints put the tool, and whether the tool comes to the
/// workpiece or through the program. Where it does not, other poses of the workpiece are tried, in growing steps of
/// shift and of turn about B's z (10° count as 100 mm), and those proposed pass the same check.
/// @throws InvalidInput with file, line, key and value; Interrupted
[[nodiscard]] ROBOMILL_API CellCheck run_cell_check(const CellCheckJob& job, Progress& progress = Progress::none());
/// The same of a cell that has been read, for any robot, from its file.
[[nodiscard]] ROBOMILL_API CellCheck run_cell_check(const CellCheckJob& job, Cell cell,
                                                    Progress& progress = Progress::none());

/// "joint 5 is 12.3° above its upper limit of 125°; …", "out of reach by 123 mm", "singular (condition number 5e4)".
/// @param prismatic  of each joint
[[nodiscard]] ROBOMILL_API std::string what_misses(const Miss& miss, const std::array<bool, 6>& prismatic);

/// What the command line prints, and a report shows where no script runs.
[[nodiscard]] ROBOMILL_API std::string summary(const CellCheck& check);

}  // namespace robomill::cell
