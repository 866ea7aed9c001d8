#pragma once
#include <array>
#include <cstddef>
#include <optional>
#include <span>

#include "robomill/monitor/monitor.hpp"
#include "robomill/monitor/spindle/speed.hpp"

namespace robomill::monitor {

/// Finds the spindle's speed f and follows it, hop by hop. With s the score of SpeedSearch, x what scores highest:
///
/// Found: s(x) > 1.5 in the last 0.1, 0.2, 0.4 and 0.8 s since the power jumped, within 7 % of the hint or else of the
/// speed followed last, nearer to f where it is refined; without a hint s(x) > 8 from 5 to 500 Hz, some candidates a
/// hop. Not at the mains' frequency, unless the hint gives it.
///
/// Held: where a look at the last six turns, within 10 % of f, has s(x) > max(0, s(f)) + 3, x is followed from there
/// on; one with s(f) < 0 is a misfit, six in a row lose the speed. Between looks f is corrected by the comb's phases.
///
/// Moving, for four hops: f changed by more than 0.3 %, or the x_i of the last six looks lie 0.3 to 20 % apart or on a
/// line of slope b with
///   |b| > max(4 σ_b, 3e-4 mean x),   σ_b² = Σ e²/((n - 2) Σ (i - mean i)²), e what the line leaves.
///
/// Far off: where no comb, or a weak one, is near the hint, a strong one at 0.4 to 2.5 times it says that the sample
/// rate is wrong, and hint/x of it right: s(x) > max(16, 2 s(f)).
///
/// A measured speed overrides all of this. Nothing is allocated after construction.
class SpindleTracker {
 public:
  static constexpr double lowest_hz = 5.0;    ///< of rotation
  static constexpr double hint_share = 0.07;  ///< how far a hint may be off

  /// What follows for the comb and for what was learnt of the lines that it leaves.
  struct Change {
    bool locked = false;   ///< another speed is followed than before, however near
    std::size_t past = 0;  ///< samples before this hop that the comb is to be learnt from anew; 0: it stays
    bool relearn = false;  ///< the speed is lost, or so far from the last that baselines no longer hold
  };

  explicit SpindleTracker(const MonitorOptions& options);
  /// 0: unknown. By more than 1 % another than before, it makes the speed followed last forgotten.
  void set_hint(double rotation_hz) noexcept;

  /// A hop.
  /// @param samples      all channels, channel after channel
  /// @param measured_hz  by a tachometer, 0: not known; empty: there is none
  /// @param chatters     the speed is not looked for
  Change step(std::span<const float> samples, std::optional<double> measured_hz, bool chatters) noexcept;
  /// Looks, without a tachometer, at the last hop once more: whether the speed still holds, or, where there is none,
  /// whether one near the hint has come in gently.
  Change check() noexcept;
  /// The power jumped: a speed that is not known is looked for in what comes from now on.
  void jumped() noexcept;
  void lose() noexcept;
  /// Between looks, to the speed that the comb's phases give.
  void correct(double rotation_hz) noexcept { rotation_hz_ = rotation_hz; }

  [[nodiscard]] double rotation_hz() const noexcept { return rotation_hz_; }  ///< as followed; 0: unknown
  /// The last one that was locked on, or else the hint; 0: neither.
  [[nodiscard]] double expected_hz() const noexcept { return known_hz_ > 0.0 ? known_hz_ : hint_hz_; }
  /// It does not move; or, where there is none, it has been looked for long enough to go on without.
  [[nodiscard]] bool settled() const noexcept;
  /// The last look explained something by it.
  [[nodiscard]] bool fits() const noexcept { return misfits_ == 0; }
  [[nodiscard]] double suggested_sample_rate_hz() const noexcept { return suggested_rate_hz_; }  ///< 0: none
  /// Of Change::past.
  [[nodiscard]] std::size_t shortest_past() const noexcept { return search_.window_samples(0); }
  [[nodiscard]] std::size_t longest_past() const noexcept { return search_.window_samples(longest_past_window); }
  /// The last samples of a channel; no more than the longest window of SpeedSearch.
  void last(std::size_t channel, std::span<float> out) const noexcept { search_.last(channel, out); }
  /// As after construction; the hint stays.
  void reset() noexcept;

 private:
  static constexpr std::size_t longest_past_window = 2;

  Change take_measured(double now_hz) noexcept;
  Change search_on() noexcept;
  Change look_closer() noexcept;
  Change hold() noexcept;
  void look_again() noexcept;
  void seek_everywhere() noexcept;
  void look(std::size_t window, double centre_hz, double share) noexcept;
  Change lock(double rotation_hz) noexcept;
  [[nodiscard]] bool detects_the_mains(double rotation_hz) const noexcept;
  [[nodiscard]] bool convincing() const noexcept;
  [[nodiscard]] bool drifts() const noexcept;

  double rate_hz_, hop_s_;
  std::size_t frames_;
  int teeth_;
  SpeedSearch search_;
  double hint_hz_ = 0.0, rotation_hz_ = 0.0;
  double reported_hz_ = 0.0;   // the hint that was another one last
  double known_hz_ = 0.0;      // the last rotation that was locked on
  double since_s_ = 0.0;       // what is looked at has begun
  double since_look_s_ = 0.0;  // of those that come at intervals
  double doubt_s_ = 0.0;       // until a weak comb near the hint makes the sample rate doubtful
  std::size_t window_ = 0;     // of the next look
  std::size_t misfits_ = 0;    // looks in which the speed found explained nothing
  std::size_t moving_ = 0;     // hops until a speed that changed is taken for settled
  bool everywhere_ = false;    // the search goes beyond the hint
  double suggested_rate_hz_ = 0.0;
  std::array<double, 6> seen_hz_ = {};  // what the last looks found, hop after hop; a ring
  std::size_t seen_ = 0;                // so many
};

}  // namespace robomill::monitor
