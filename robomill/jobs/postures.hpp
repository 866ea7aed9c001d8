#pragma once
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/cell/dynamics.hpp"
#include "robomill/jobs/files/lobes_toml.hpp"
#include "robomill/robot/pose.hpp"
#include "robomill/stability/lobes.hpp"

// Method: robomill/jobs/README.md, "Postures side by side (`postures.hpp`)"

namespace robomill::jobs {

/// One cut in each posture that a cell was measured in.
struct PosturesJob {
  std::filesystem::path cell;  ///< cell.toml with [[postures]]
  std::filesystem::path cut;   ///< lobes.toml or a job.toml; its structure gives way to that of the postures
};

/// The limits in one of the cell's [[postures]].
struct PostureLimits {
  std::size_t number = 0;  ///< its place in the cell, from 1
  cell::ModesOfPosture posture;
  robot::ToolPose pose;                  ///< in the robot's base axes
  std::vector<stability::Limit> limits;  ///< one a speed
};

/// Postures that differ in one direction alone: within 1 mm and 0.5° in the others.
struct PostureDirection {
  std::string name;                   ///< "x", "y", "z" of the tip in base axes, "gamma": a turn about the tool's axis
  std::vector<std::size_t> postures;  ///< their numbers, by rising value
  double spread = 0.0;     ///< (greatest - least limit) / their mean, the mean over `speeds`; NaN where these are 0
  std::size_t speeds = 0;  ///< at which each posture has a limit
};

struct PosturesResult {
  LobesFile cut;  ///< as of the first posture; its notes are for the user
  std::vector<double> spindle_speed_rad_per_s;
  std::vector<PostureLimits> postures;
  std::vector<PostureDirection> directions;
};

/// The nominal limits of a cut at the speeds of its chart in each of the cell's [[postures]], by the model that
/// lobes.toml with dynamics.cell takes, and how far they lie apart by direction.
/// @throws InvalidInput with file, line, key and value; Interrupted
[[nodiscard]] ROBOMILL_API PosturesResult run_postures(const PosturesJob& job, Progress& progress = Progress::none());

}  // namespace robomill::jobs
