#pragma once
#include <array>
#include <cstddef>

#include "robomill/path/interpolator.hpp"
#include "robomill/path/realtime/look_ahead.hpp"
#include "robomill/path/speed/feed_override.hpp"

namespace robomill::path {

/// Runs a look-ahead sample by sample.
///
/// At every moment there is a way out that is known to hold: to bring the override to rest at the slope `way_out_`,
/// which every stretch allows that this would run through, all of them ready, with every cap met in time. A step is
/// taken only if another way out is known behind it; else a step of the known one is taken, after which it is still
/// known. At a rest of the plan any override will do, so that every row of motion between two rests stands for itself.
class Runner {
 public:
  using State = PathInterpolator::State;
  /// @param ahead  outlives the runner, as the kinematics do
  Runner(LookAhead& ahead, const robot::Kinematics& kinematics, double period_s, const Sample& start);
  /// @param wanted  override; 0: hold
  State next(double wanted, Sample& sample) noexcept;
  /// At rest: the next sample stands where the last one did.
  void stand(Sample& sample) noexcept { emit(sample); }
  [[nodiscard]] double feed_override() const noexcept { return override_of(state_.theta); }
  [[nodiscard]] double ready_s() const noexcept;
  [[nodiscard]] bool starved() const noexcept { return lacks_; }

 private:
  /// A cap that the override must meet where it begins.
  struct Step {
    double theta = 0.0, feed_override = 0.0, begin_s = 0.0, end_s = 0.0;
  };
  /// What lies ahead, as far as it was looked at.
  struct View {
    double slope = 0.0;
    double covered_s = 0.0;  // plan time from now
    std::size_t next = 0;    // stretch
    bool rests = false;      // … at its end
    std::size_t steps = 0;   // ever lower caps
  };
  enum class Verdict { holds, too_short, too_fast };

  bool rest(double wanted) noexcept;
  void run(double wanted) noexcept;
  bool extend(View& view) noexcept;
  /// The way towards a target, or to stay at `fixed`.
  Verdict consider(double target, const OverrideState* fixed, OverrideState& to, double& slope) noexcept;
  [[nodiscard]] bool meets(const View& view, const OverrideState& to, double passed_s) const noexcept;
  double lowered(const View& view, const OverrideState& to, double passed_s, double target) noexcept;
  void pass(double plan_s) noexcept;
  void emit(Sample& sample) noexcept;
  [[nodiscard]] State state(double wanted, LookAhead::Closed closed) const noexcept;

  LookAhead& ahead_;
  const robot::Kinematics& kinematics_;
  double period_s_;
  Sample last_;
  std::size_t count_ = 0;

  OverrideState state_;
  double way_out_ = 1.0;                         // slope
  double now_s_ = 0.0;                           // plan time
  bool resting_ = true;                          // at a rest of the plan
  double wanted_ = 0.0;                          // override
  bool starved_ = false;                         // until more is ready than `known_`
  bool lacks_ = false;                           // of the last sample, of a program that goes on
  double low_theta_ = 0.0, low_until_s_ = -1.0;  // a target that holds until then
  std::size_t known_ = 0;                        // stretches that are ready
  std::size_t stretch_ = 0, segment_ = 0, piece_ = 0;
  double moved_s_ = -1.0;  // the plan time of last_
  static constexpr std::size_t max_steps = 80;
  std::array<Step, max_steps> step_;
};

}  // namespace robomill::path
