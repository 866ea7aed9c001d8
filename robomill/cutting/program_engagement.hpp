#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/cutting/engagement.hpp"
#include "robomill/cutting/workpiece.hpp"
#include "robomill/program/program.hpp"

/// Where the cutter touches material while a program runs, found from a workpiece of rays.
// Method: robomill/cutting/README.md, "Engagement along a program (`program_engagement.hpp`)"
namespace robomill::cutting {

/// A cutter's motion at one instant: the tip's velocity and how the axis turns, in W.
struct Motion {
  Eigen::Vector3d tip_m_per_s = Eigen::Vector3d::Zero();
  Eigen::Vector3d turn_rad_per_s = Eigen::Vector3d::Zero();  ///< rotation vector, across the axis
};

/// The engagement at one pose.
struct ROBOMILL_API PoseEngagement {
  Engagement engagement;                                         ///< rings that cut, with their arcs in T
  Eigen::Matrix3d work_from_feed = Eigen::Matrix3d::Identity();  ///< columns x_F, y_F, z_F in W
  double feed_speed_m_per_s = 0.0;  ///< of the point that x_F was taken at; over teeth per second it is the feed per
                                    ///< tooth
  double axial_depth_m = 0.0;       ///< extent of the engaged part along the tool's axis
  double radial_depth_m = 0.0;      ///< its extent along y_F, across feed and axis
};

struct ROBOMILL_API WalkOptions {
  double ring_width_m = 0.0;    ///< >= 0; along the profile, width of a ring <= this; 0: a dexel, and at least twelve
                                ///< rings over each of corner and bottom
  double angle_step_rad = 0.0;  ///< >= 0; first look around a ring; 0: two dexels, at most 10 degrees
  double max_step_m = 0.0;      ///< >= 0; way of the tip between two looks <= this; 0: half the cutter's radius
  double max_turn_rad = 0.05;   ///< > 0; turn of the axis between two looks <= this
  std::size_t batch = 256;      ///< results handed out at once, >= 1
  /// One a block, or none: how far the tip stands from where the program has it while the block runs, in W. Between
  /// blocks it jumps. Finite.
  std::vector<Eigen::Vector3d> tip_offset_m = {};
  /// @throws InvalidInput naming the member
  void validate() const;
};

/// Rings of a cutter, to look at poses with.
class ROBOMILL_API EngagementFinder {
 public:
  /// @throws InvalidInput for a bad cutter or bad options
  EngagementFinder(const Cutter& cutter, double dexel_m, const WalkOptions& options);
  /// A point p of the envelope, with outward normal n and velocity v, cuts where n·v > 0 and material stands at p. The
  /// material must be as the cutter has left it when it came; `ahead_m` looks that much further along v where the
  /// cutter has come a shorter way since. x_F runs along the velocity of the middle of what cuts (of the tip, while the
  /// axis holds); z_F is the axis without its part along x_F, y_F = z_F × x_F. Where the feed runs along the axis, z_F
  /// is any direction across. T has y_T = y_F, so that the tool leads but never tilts in F.
  [[nodiscard]] PoseEngagement at(const Workpiece& workpiece, const program::Pose& pose, const Motion& motion,
                                  double ahead_m) const;
  /// All rings that it looks at.
  [[nodiscard]] const std::vector<EdgeSlice>& slices() const { return slices_; }
  /// Points that it looks at, a pose.
  [[nodiscard]] double looks() const { return looks_; }

 private:
  class Gather;
  /// Even rings of one piece of the profile.
  struct Cells {
    double start_m = 0.0, width_m = 0.0;
    std::size_t begin = 0, count = 0;  ///< of slices_
    EdgeSlice first, last;             ///< at the ends, without width
    [[nodiscard]] double middle(std::size_t i) const { return start_m + (static_cast<double>(i) + 0.5) * width_m; }
  };
  Profile profile_;
  FlatEndMill mill_;
  std::vector<Cells> cells_;
  std::vector<EdgeSlice> slices_;
  double angle_step_rad_ = 0.0;  ///< largest
  double dexel_m_ = 0.0, step_m_ = 0.0, looks_ = 0.0;
  std::size_t ring_grain_ = 0;
  [[nodiscard]] EdgeSlice slice_at(const Profile::Point& at, double width_m) const;
  [[nodiscard]] EdgeSlice slice_at(double length_m, double width_m) const {
    return slice_at(profile_.at(length_m), width_m);
  }
  [[nodiscard]] double step_rad(const EdgeSlice& slice) const;
};

/// A part of a block: the cutter at its end, and what it took away.
struct BlockEngagement {
  std::size_t block = 0;           ///< of the program
  double share_to = 0.0;           ///< of the block, where the part ends
  double duration_s = 0.0;         ///< of the part
  program::Pose pose;              ///< at its end
  PoseEngagement cut;              ///< there; empty for rapid moves
  double removed_volume_m3 = 0.0;  ///< by edges and shank
  double shank_depth_m = 0.0;      ///< how deep the shank ran into material
  bool shank = false;              ///< shank_depth_m > Workpiece::dexel_m()
  bool rapid_in_material = false;  ///< a rapid move with removed_volume_m3 > dexel_m()³
};

using Deliver = std::function<void(std::span<const BlockEngagement>)>;

/// Runs the program through the workpiece, part by part, and hands out what it finds in order, a batch at a time;
/// memory does not grow with the program.
/// @throws InvalidInput for a bad cutter, bad options, a feed move without duration or more looks at the material than
/// may be taken (base/cost.hpp), Interrupted when asked to stop
ROBOMILL_API void walk(const program::Program& program, const Cutter& cutter, Workpiece& workpiece,
                       const WalkOptions& options, const Deliver& deliver, Progress& progress = Progress::none());

}  // namespace robomill::cutting
