#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "robomill/monitor/orders/spectra.hpp"

namespace robomill::monitor {

/// The spindle's speed as a distribution over g = ln f, carried from hop to hop.
///
/// A window of length T with power |X(ν)|², summed over the channels, speaks for f by the share of its energy that the
/// multiples k f hold, less what a comb holds by chance, c = 3/(2 f T):
///   s(f) = (Σ_k |X(k f)|²/Σ A² - c)/(1 - c),   ln L(f) = -w (M - 1 + q(f)) ln(1.02 - max(0, s)).
/// M = (ΣA²)²/ΣA⁴ is about how many lines the window holds: one line alone, such as chatter's, says nothing about the
/// speed, but for the share q(f) of the energy at low multiples of tooth passing. w is twice the hop over T, since
/// windows overlap. Between hops the speed may drift, by a Cauchy distribution of 0.08 % a hop, and with a probability
/// of 1e-3 it is drawn anew from the prior: a Cauchy distribution about the hint. Candidates near the mains' frequency
/// count no lines below 190 Hz, unless the hint is there. Beyond the candidates whose belief is above 1e-15 none is
/// looked at: ln L = 0. About a hint below lowest_rotation_hz nothing is learnt from the windows.
///
/// Nothing is allocated after construction.
class SpeedPosterior {
 public:
  static constexpr double reach = 0.15;  ///< of the hint, to each side

  struct Setup {
    double hop_s = 0.025;
    double highest_hz = 5120.0;  ///< of the orders that are looked at
    double std_ratio = 0.015;    ///< width of the prior
    int teeth = 0;               ///< 0: unknown
  };
  explicit SpeedPosterior(const Setup& setup);
  /// What is given as the speed [Hz]; 0: unknown. Within 15 % of the hint before it, what is believed of the speed
  /// stays.
  void set_hint(double rotation_hz) noexcept;
  /// Begins anew about the hint.
  void reset() noexcept;
  [[nodiscard]] double hint_hz() const noexcept { return hint_hz_; }

  /// How the speed may change in a hop.
  enum class Motion {
    free,  ///< it drifts, and may be drawn anew
    near,  ///< it drifts: what it is now still explains as much of the signal as before
    held   ///< by no more than 0.3 % from where it was held first: while chatter is on, whose lines would draw it away
  };
  /// A hop passes.
  void predict(Motion motion) noexcept;
  /// What a window says.
  /// @param power  |X|², of all channels, line by line;  @param like  one of their spectra: T and Δν
  void observe(std::span<const float> power, const Spectrum& like) noexcept;
  /// A measurement of f [Hz]: ln L = ln(exp(-d²/2) + 1e-4), d = ln(f/measured)/std, since pulses may be miscounted.
  void observe(double rotation_hz, double std_ratio) noexcept;
  /// After the windows of a hop: fills what follows.
  void conclude() noexcept;
  /// The most likely speed, by the peaks ν_k of the orders that stand within 0.5/T of it, to the power of the long
  /// window: f = Σ k |X_k|² ν_k/Σ k² |X_k|².
  void refine(std::span<const float> power, const Spectrum& like) noexcept;

  [[nodiscard]] double rotation_hz() const noexcept { return rotation_hz_; }  ///< the most likely; 0: no hint
  [[nodiscard]] double std_ratio() const noexcept { return std_ratio_; }      ///< spread about it, of f
  [[nodiscard]] double known() const noexcept { return known_; }  ///< probability that f is within 0.4 % of it
  [[nodiscard]] double share() const noexcept { return share_; }  ///< s at it, in the window observed last

 private:
  static constexpr double step = 8e-4;
  static constexpr std::size_t side = static_cast<std::size_t>(reach / step);
  static constexpr std::size_t size = 2 * side + 1;

  [[nodiscard]] double candidate_hz(double place) const noexcept;
  [[nodiscard]] bool of_the_mains(double rotation_hz) const noexcept;

  Setup setup_;
  double hint_hz_ = 0.0, rotation_hz_ = 0.0, std_ratio_ = 0.0, share_ = 0.0, known_ = 0.0;
  double lines_ = 0.0;        // M - 1, in the window observed last
  double held_place_ = -1.0;  // < 0: not held
  std::vector<double> prior_, belief_, drift_, evidence_;
  std::vector<double> wide_;   // beliefs between zeros on both sides
  std::vector<double> ratio_;  // of each candidate to the hint
  // Of those looked at: place in lines, energy at one order, at all, at low ones, of hum; of each: s.
  std::vector<float> place_, here_, held_, low_, hum_, shares_;
};

}  // namespace robomill::monitor
