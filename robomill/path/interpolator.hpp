#pragma once
#include <cstddef>
#include <memory>

#include "robomill/base/export.hpp"
#include "robomill/path/options.hpp"
#include "robomill/path/sample.hpp"
#include "robomill/program/program.hpp"
#include "robomill/robot/kinematics.hpp"

// Method: robomill/path/README.md, "In real time"

namespace robomill::path {

struct ROBOMILL_API InterpolatorOptions {
  double look_ahead_s = 4.0;  ///< > 0; of planned motion for which there is room, at 100 %; or up to twice it
  std::size_t look_ahead_segments = 2048;  ///< >= 64; … and for as many segments of it
  /// @throws InvalidInput naming the member
  void validate() const;
};

/// Runs a program while it is still being read: one thread pushes blocks, another takes a sample every period.
///
/// The pushing thread plans windows of the blended path with a reserve of acceleration and jerk, runs along the plan
/// ahead of the machine and measures how fast, and how fast changing, the plan may be run at every place. The other
/// thread runs it, at a feed override between 0 and 1.5 that it changes within those bounds; it never takes a step from
/// which it could not still come to rest before the plan ends, or slow down to what lies ahead. So feed hold, override
/// and a look-ahead that runs dry all end in the same way: along the path, within every limit, without a jump; and it
/// goes on when asked, or when blocks come. Where limits hold the plan back an override above 100 % changes nothing.
///
/// Threads: push() and finish() from one, next() from one other, the rest from any. Nothing allocates or throws after
/// construction; next(), hold(), resume(), stop() and set_override() are wait-free. Memory is that of the look-ahead.
class ROBOMILL_API PathInterpolator {
 public:
  /// accepted: taken. full: nothing was taken, try again later. closed: after finish() or stop(). invalid: the block is
  /// not finite, its axis is no unit vector or its duration is negative. antipodal: turns the axis by half a circle, to
  /// where no one way leads. unreachable: see `reach`; blocks before it may be meant, which were not yet looked at.
  /// What was planned before is still run, to a stop within limits.
  struct Pushed {
    enum class Status { accepted, full, closed, invalid, antipodal, unreachable };
    Status status = Status::accepted;
    std::size_t block = 0, line = 0;  ///< from 0; in the program's file
    robot::Reach reach = {};
    [[nodiscard]] bool accepted() const noexcept { return status == Status::accepted; }
  };
  /// running: moves. waiting: at rest, for blocks. holding: at rest, by hold() or an override of 0. finished: at rest
  /// at the program's end. stopped: at rest, and nothing follows: by stop(), or push() has reported why.
  enum class State { running, waiting, holding, finished, stopped };

  /// @param kinematics  outlives the interpolator
  /// @param start       where the program begins; gamma_rad the flange's turn there, joints how the machine stands
  /// @throws InvalidInput if an option or a limit is invalid, or the start cannot be taken
  PathInterpolator(const robot::Kinematics& kinematics, const SmoothingOptions& smoothing, const program::Pose& start,
                   double gamma_rad, const robot::Position6& joints, const InterpolatorOptions& options = {});
  ~PathInterpolator();
  PathInterpolator(const PathInterpolator&) = delete;
  PathInterpolator& operator=(const PathInterpolator&) = delete;
  PathInterpolator(PathInterpolator&&) = delete;
  PathInterpolator& operator=(PathInterpolator&&) = delete;

  /// The next block; the flange's turn stays, or becomes gamma_rad at its end.
  Pushed push(const program::Block& block) noexcept;
  Pushed push(const program::Block& block, double gamma_rad) noexcept;
  /// Nothing follows. `full` until all is planned: call again.
  Pushed finish() noexcept;

  /// Where the machine is to stand one period after the last call. path_m counts along the planned path, time_s from
  /// the first call.
  State next(Sample& sample) noexcept;

  void hold() noexcept;
  void resume() noexcept;
  /// As hold(), and for good: no resume() follows it. At rest the state is `stopped`, and stays so.
  void stop() noexcept;
  /// Of the programmed feed, within [0, 1.5]; not a number: stays.
  void set_override(double share) noexcept;
  /// The feed override at which the plan was run last.
  [[nodiscard]] double feed_override() const noexcept;
  /// Plan time that is ready [s]; by the thread that calls next().
  [[nodiscard]] double ready_s() const noexcept;
  /// Whether the last sample is slower than commanded, or at rest, because too little of a program that goes on was
  /// planned; by the thread that calls next().
  [[nodiscard]] bool starved() const noexcept;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace robomill::path
