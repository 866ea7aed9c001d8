#pragma once
// The programmed blocks near the tool, and how far a pose is from them.
#include <Eigen/Core>
#include <cstddef>
#include <limits>
#include <vector>

#include "robomill/program/program.hpp"

namespace robomill::path {

/// A programmed block as a line of the tip and a great-circle arc of the axis.
struct CheckedBlock {
  program::Block::Kind kind = program::Block::Kind::dwell;
  Eigen::Vector3d tip_begin_m = Eigen::Vector3d::Zero(), tip_end_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d tip_direction = Eigen::Vector3d::Zero();  ///< unit; zero where the tip stands
  double length_m = 0.0;                                    ///< 0 where the tip stands
  Eigen::Vector3d axis_begin = Eigen::Vector3d::UnitZ(), axis_end = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d across = Eigen::Vector3d::Zero();          ///< unit; the axis' direction of motion where it begins
  Eigen::Vector3d end_tangent = Eigen::Vector3d::Zero();     ///< … where it ends
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();          ///< of the plane of its great circle
  double angle_rad = 0.0;                                    ///< 0 where the axis stands
  double tip_feed_m_per_s = 0.0, axis_feed_rad_per_s = 0.0;  ///< infinite for a rapid, 0 where it stands
  double dwell_s = 0.0;
  double tip_deviation_m = 0.0, axis_deviation_rad = 0.0;  ///< of the block from the programmed curve

  [[nodiscard]] bool moves() const { return length_m > 0.0 || angle_rad > 0.0; }
  /// Of a point from the curve that the line stands for, at most.
  [[nodiscard]] double tip_distance_m(const Eigen::Vector3d& tip_m) const;
  /// Of a unit vector from the curve that the arc stands for, at most.
  [[nodiscard]] double axis_distance_rad(const Eigen::Vector3d& axis) const;
  /// The axis programmed for the point of the line that is nearest to a tip; length_m > 0.
  [[nodiscard]] Eigen::Vector3d axis_beside(const Eigen::Vector3d& tip_m) const;
};

/// Angle between two unit vectors whose difference has this length.
[[nodiscard]] double angle_of_chord(double chord);

/// Distance of a point from the chord between two others.
[[nodiscard]] double chord_distance(const Eigen::Vector3d& point, const Eigen::Vector3d& from,
                                    const Eigen::Vector3d& to);

/// How near the trajectory came to something that it must pass; lengths in m, or chords between unit vectors.
struct Pass {
  double best = std::numeric_limits<double>::infinity();
  double wake = 0.0;  ///< the travelled length before which nothing nearer can come
  double at_s = 0.0;
};

/// The end of a block, and its dwell.
struct Corner {
  Pass tip, axis;
  double still_s = 0.0;  ///< longest that the tool stood still here
};

/// A run of blocks of a program, read along.
class BlockWindow {
 public:
  static constexpr std::size_t room = 1024;

  /// @param source  outlives the window; read from its beginning
  explicit BlockWindow(program::Source& source);
  [[nodiscard]] std::size_t low() const { return low_; }    ///< the first block held
  [[nodiscard]] std::size_t high() const { return high_; }  ///< the one after the last one held
  [[nodiscard]] bool full() const { return high_ - low_ == room; }
  [[nodiscard]] const program::Pose& start() const { return start_; }
  [[nodiscard]] const program::Pose& end() const { return end_; }  ///< of the last block read
  [[nodiscard]] const CheckedBlock& segment(std::size_t block) const { return slots_[block % room].segment; }
  [[nodiscard]] CheckedBlock& segment(std::size_t block) { return slots_[block % room].segment; }
  [[nodiscard]] Corner& corner(std::size_t block) { return slots_[block % room].corner; }
  /// Reads one block more; false at the program's end. Must not be full.
  bool read();
  /// Forgets the lowest block.
  void drop() { ++low_; }

 private:
  struct Slot {
    CheckedBlock segment;
    Corner corner;
  };
  program::Source& source_;
  program::Pose start_, end_;
  std::vector<Slot> slots_;
  std::size_t low_ = 0, high_ = 0;
};

}  // namespace robomill::path
