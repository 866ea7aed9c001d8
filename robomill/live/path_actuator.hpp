#pragma once
#include <atomic>

#include "robomill/base/export.hpp"
#include "robomill/live/act.hpp"
#include "robomill/path/interpolator.hpp"

// Method: robomill/live/README.md, "Acting"

namespace robomill::live {

/// Runs a PathInterpolator as commands say. apply() comes from one thread, the monitor's, and next() from the one that
/// runs the path; the rest from any. Nothing allocates, throws or waits.
class ROBOMILL_API PathActuator {
 public:
  /// Takes the tool out of the cut, which an interpolator cannot: the controller's.
  class Retract {
   public:
    virtual ~Retract() = default;
    /// Along the tool's axis, now: the path is at rest. Called once a hold, by the thread that calls next().
    virtual void retract(double distance_m) noexcept = 0;
  };

  /// @param path     outlives this, as does retract; its next(), hold(), resume() and set_override() are called here
  /// @param retract  may be null: then no hold is taken
  explicit PathActuator(path::PathInterpolator& path, Retract* retract = nullptr) noexcept
      : path_(path), retract_(retract) {}
  PathActuator(const PathActuator&) = delete;
  PathActuator& operator=(const PathActuator&) = delete;

  /// Takes effect at the next next(). False where it cannot be taken: a hold without a retract.
  bool apply(const Command& command) noexcept;
  /// The path's next sample, as PathInterpolator::next.
  path::PathInterpolator::State next(path::Sample& sample) noexcept;

  /// The operator's share of the feed, of which commands take theirs; not a number: stays.
  void set_operator_override(double share) noexcept;
  /// As measured [rad/s]. A feed that rises with the speed follows it, and stays until this is called.
  void set_spindle_speed(double rad_per_s) noexcept;
  /// After a hold, by people: the tool is back where the path was left.
  void resume() noexcept;

 private:
  /// What was commanded, as one word.
  struct Feed {
    float share = 1.0F;
    float with_rad_per_s = 0.0F;  ///< of the spindle, whose rise it follows; 0: at once
  };
  static_assert(std::atomic<Feed>::is_always_lock_free && std::atomic<double>::is_always_lock_free);

  path::PathInterpolator& path_;
  Retract* retract_;
  std::atomic<Feed> feed_{Feed{}};
  std::atomic<double> hold_m_{0.0};  ///< the retract of a hold; 0: none
  std::atomic<double> operator_share_{1.0}, measured_rad_per_s_{0.0};
  // Of the thread that calls next().
  double share_ = 1.0;
  bool held_ = false, retracted_ = false;
};

}  // namespace robomill::live
