#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "robomill/base/units.hpp"
#include "robomill/program/program.hpp"

namespace robomill::program {

/// A move of a statement that makes several.
struct MoveStep {
  /// What holds during a move that comes later.
  struct Running {
    double speed_rad_per_s = 0.0;
    Spindle spindle = Spindle::not_given;
    Coolant coolant = {};
  };

  Block::Kind kind = Block::Kind::rapid;
  Eigen::Vector3d tip_m = Eigen::Vector3d::Zero();
  double duration_s = 0.0;
  std::optional<Eigen::Vector3d> axis = {};  ///< none: as it stands
  std::optional<Spindle> spindle = {};       ///< from here on
  OperatorStop stop = OperatorStop::none;
  std::size_t line = 0;  ///< that says it; 0: the one that was taken
  double tip_deviation_m = 0.0;
  std::optional<Running> running = {};  ///< none: what holds now
};

/// How a cycle drills its holes.
struct Drilling {
  enum class Pecks : std::uint8_t {
    none,
    out,  ///< back to the start after each, and on from a clearance above what is drilled
    chip  ///< up by the clearance
  };
  /// So far above the hole's bottom, and so far up: LinuxCNC's.
  static constexpr double clearance_m = 0.254 * units::mm;

  Pecks pecks = Pecks::none;
  std::vector<double> pecks_m = {};  ///< > 0; the last one holds for all that follow
  double dwell_s = 0.0;              ///< at the bottom
  std::optional<Spindle> back = {};  ///< from the bottom on
  bool waits = false;                ///< for the operator at the bottom
  bool feeds_out = false;

  /// Where the i-th peck from 1 on ends, below the start.
  [[nodiscard]] double depth_m(double i) const;
  /// How many reach a depth. A last one of less than a rounding is none.
  [[nodiscard]] double count(double depth_m) const;
};

/// A hole along an axis through a point; heights count from the point towards the spindle.
struct DrilledHole {
  Eigen::Vector3d point_m = Eigen::Vector3d::Zero(), axis = Eigen::Vector3d::UnitZ();
  double start_m = 0.0, bottom_m = 0.0, return_m = 0.0;  ///< bottom <= start <= return
};

/// Appends the moves of a hole: at rapid up to the start where the tool is lower, across, down to the start; the hole;
/// back. Those at feed have no time yet.
/// @param from  where the tool stands
void add_hole(const Drilling& drilling, const DrilledHole& hole, const Pose& from, Spindle turning,
              std::vector<MoveStep>& steps);

}  // namespace robomill::program
