#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "robomill/path/blend.hpp"
#include "robomill/path/check.hpp"
#include "robomill/path/options.hpp"
#include "robomill/path/speed/bound.hpp"
#include "robomill/path/speed/segment.hpp"
#include "robomill/path/speed/speed.hpp"
#include "robomill/robot/kinematics.hpp"

namespace robomill::path {

struct PlannerOptions {
  std::size_t window = 1000;     ///< segments whose speed is sought together
  std::size_t commit = 800;      ///< of them, taken over before the next window; < window
  std::size_t look_ahead = 512;  ///< nodes of the path gathered before the widths of corners are found
  double spacing = 0.5;          ///< segments in a corner: its half width times this
  SpeedOptions speed = {};
  double share = 0.998;  ///< of speed limits that is planned for; accelerations its square, jerks its cube
  bool local_slow_down =
      true;  ///< a proposed row is revised by slowing down about the places; false: by solving it again
  double acceleration_share = 1.0, jerk_share = 1.0;  ///< of those, what is left once a reserve is taken off
  double tolerance_share = 1.0;                       ///< of the tolerances that is used where no correction says less

  /// For a whole program in memory.
  [[nodiscard]] static PlannerOptions optimal();
  /// For a controller: short windows.
  [[nodiscard]] static PlannerOptions real_time();
  /// real_time() less what a PathInterpolator needs for holding and for the override.
  [[nodiscard]] static PlannerOptions interpolated();
};

/// What slows or narrows places where a trajectory broke a limit before.
struct SpeedCorrections {
  static constexpr double cells_per_m = violation_cells_per_m;
  std::map<std::size_t, double> tolerance = {};  ///< by block: the share of the tolerances that may be used
  std::map<std::int64_t, double> speed = {};     ///< by cell of the path: of all speeds; acceleration takes its square,
                                                 ///< jerk its cube
};

/// Turns blocks into motion: the blended path (Blend) and the speed along it (SpeedSolver), window by window, in memory
/// that does not grow with the program. Every window ends at a safe terminal speed from which the next can go on
/// whatever comes; before a stop the row ends at rest. Nothing throws, and after construction nothing is allocated.
class Planner {
 public:
  /// What it makes.
  enum class Task {
    motion,     ///< each row is taken over as soon as it is planned
    proposals,  ///< motion too, but revise() may plan a row again before it is taken over
    points      ///< the path's points for the bound, no motion
  };
  struct Status {
    enum class Kind { ok, out_of_reach, outside_limits, singular, jump, antipodal, full };
    Kind kind = Kind::ok;
    std::size_t block = 0, line = 0;
    robot::Reach reach = {};
    [[nodiscard]] bool ok() const noexcept { return kind == Kind::ok; }
  };

  /// @param kinematics  outlives the planner, as corrections do
  /// @throws InvalidInput if the options or the machine's limits are invalid
  Planner(const robot::Kinematics& kinematics, const SmoothingOptions& options, const PlannerOptions& planner,
          const SpeedCorrections* corrections = nullptr, Task task = Task::motion);

  Status begin(const program::Pose& pose, double gamma_rad, const robot::Position6& start) noexcept;
  /// What was planned is in motion() and path() (or points()), which the caller takes and clears before anything else
  /// is called.
  Status push(const program::Block& block, std::size_t index, double gamma_rad) noexcept;
  /// Nothing follows: the tool stops.
  Status finish() noexcept;
  /// More is ready to be planned than motion() holds: call resume() before the next push().
  [[nodiscard]] bool busy() const noexcept { return busy_; }
  Status resume() noexcept;
  /// A row is proposed: the end of motion() may still be revised, resume() takes it over.
  [[nodiscard]] bool proposes() const noexcept { return proposed_; }
  /// How much of motion() stays; what lies behind is planned again with the next row.
  [[nodiscard]] std::size_t kept() const noexcept { return proposed_ ? kept_ : motion_.size(); }
  /// Plans the proposed row again, as slow as the corrections now say.
  /// @return false where they ask nothing more of it, or only of what was taken over with the row before
  bool revise() noexcept;
  /// Whether samples of a segment of motion() may break a limit that the segment's points do not: something comes near
  /// to a limit there, and since it was looked at last, revise() changed it.
  [[nodiscard]] bool suspect(std::size_t segment) const noexcept {
    return segment >= proposed_at_ && before_[segment - proposed_at_ + (frozen_ > 0 ? 1 : 0)].suspect;
  }
  /// Nodes of the path that are held: how far push() runs ahead of motion().
  [[nodiscard]] std::size_t held() const noexcept { return blend_.end() - blend_.first(); }

  [[nodiscard]] const ChannelLimits& limits() const noexcept { return limits_; }
  [[nodiscard]] std::vector<Segment>& motion() noexcept { return motion_; }
  [[nodiscard]] std::vector<Polynomial>& path() noexcept { return path_; }
  [[nodiscard]] std::vector<BoundPoint>& points() noexcept { return points_; }
  [[nodiscard]] std::size_t motion_capacity() const noexcept { return planner_.window + 64; }
  [[nodiscard]] std::size_t path_capacity() const noexcept { return path_capacity_; }
  /// Of the path that a segment lies across, save at the end of a row.
  static constexpr std::size_t max_pieces = 24;

 private:
  Status advance() noexcept;
  [[nodiscard]] bool idle() const noexcept;
  void wait() noexcept;
  void take_polynomials() noexcept;
  Status lay_segments() noexcept;
  Status lay(Segment::Kind kind, double length_m) noexcept;
  void come_to_rest(double at_m, double dwell_s) noexcept;
  Status look(SpeedSegment& segment, double length_m, bool& even) noexcept;
  void limit_speed(SpeedSegment& segment) const noexcept;
  [[nodiscard]] double corrected_speed(double begin_m, double end_m) const noexcept;
  bool slow_down(std::size_t segment, double speed) noexcept;
  Status look_at(const Polynomial& polynomial, double x_m, PathPoint& out, robot::JointJet& joints) noexcept;
  [[nodiscard]] double spacing_m(double u_m) noexcept;
  [[nodiscard]] std::size_t row_points() const noexcept;
  [[nodiscard]] double middle_share(double length_m) const noexcept;
  [[nodiscard]] double snapped_m(double length_m) const noexcept;
  void begin_safe_speed(std::size_t size) noexcept;
  void hand_over(bool to_rest) noexcept;
  void solve(bool to_rest) noexcept;
  bool solve_row() noexcept;
  void find_suspects() noexcept;
  [[nodiscard]] bool tense(std::size_t segment) const noexcept;
  bool slow_down_locally() noexcept;
  void slow_down_around_corrections(double ramp_m) noexcept;
  void write(std::size_t count) noexcept;
  void take_over() noexcept;

  const robot::Kinematics& kinematics_;
  PlannerOptions planner_;
  const SpeedCorrections* corrections_;
  Task task_;
  ChannelLimits limits_;
  Blend blend_;
  SpeedSolver solver_;
  std::size_t path_capacity_ = 0;
  std::vector<Polynomial> ahead_;  ///< the path from where segments are being laid
  std::size_t ahead_at_ = 0;       ///< in ahead_: what holds u_m_
  std::size_t pieces_taken_ = 0;   ///< of the Blend
  std::size_t near_node_ = 0;      ///< of the Blend, about where u_m_ is
  std::vector<SpeedSegment> row_;  ///< whose speed is not yet taken over; after a first commit two before it, frozen
  std::vector<double> begin_m_;    ///< of the row's segments
  std::size_t frozen_ = 0, safe_to_ = 0;
  /// Of the row that was solved last: its segments, those that the solver could move and those that are taken over;
  /// segments whose safe terminal speed was set before it.
  std::size_t solved_ = 0, moved_ = 0, taken_ = 0, safe_before_ = 0;
  struct Before {
    double begin_b = 0.0, found_b = 0.0, speed = 1.0;
    bool suspect = false;
  };
  std::vector<Before> before_;  ///< of the row, for revise()
  robot::Position6 near_ = robot::Position6::Zero();
  double u_m_ = 0.0, chain_begin_m_ = 0.0;  ///< where segments are laid; where the tool rested last
  double rest_m_ = 0.0, largest_segment_m_ = 0.0, axis_weight_m_ = 0.0;
  double waiting_s_ = 0.0;  ///< of dwells since the tool stopped
  bool resting_ = true, busy_ = false, proposed_ = false;
  std::size_t kept_ = 0, proposed_at_ = 0;  ///< of motion_: what stays; where the proposed row begins
  std::vector<Segment> motion_;
  std::vector<BoundPoint> points_;
  std::vector<Polynomial> path_;
};

}  // namespace robomill::path
