#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "robomill/monitor/orders/spectra.hpp"

namespace robomill::monitor {

/// Tracks the spindle's rotation f near a hint, by the lines at its multiples.
///
/// A line at ν with power P over the noise's floor F counts v(ν) = log₁₀(P/2F)/2, from 0 (3 dB) to 1 (23 dB): however
/// strong it is, it counts no more, so a chatter line that meets a multiple of a wrong speed draws it by one part in
/// some twenty. On the flank of a peak P', within 1/T, it counts 0.15 log₁₀(P'/P) less: a wrong speed meets the low
/// orders at their flanks. A candidate's evidence is the mean of v over its first orders, at most 24, those of tooth
/// passing twice and the first of these four times, with a memory of 1 s. The most likely speed is where
///   30 e(f) - ln(1 + (ln(f/hint)/σ)²)
/// is greatest: the prior is a Cauchy distribution of the hint's relative deviation σ. Nothing is allocated after
/// construction.
class SpeedTracker {
 public:
  static constexpr double reach = 0.15;  ///< of the hint, to each side

  struct Setup {
    double hop_s = 0.025;
    double std_ratio = 0.015;  ///< σ
    int teeth = 0;             ///< 0: unknown
    std::size_t lines = 0;     ///< of the spectra, at most
  };
  explicit SpeedTracker(const Setup& setup);
  /// What is given as the speed [Hz]; 0: unknown. Within 15 % of the hint before it, what was learnt stays.
  void set_hint(double rotation_hz) noexcept;
  /// Begins anew about the hint.
  void reset() noexcept;
  [[nodiscard]] double hint_hz() const noexcept { return hint_hz_; }
  /// A measurement of f [Hz], good for the next hop: ln L = ln(exp(-d²/2) + 1e-4), d = ln(f/measured)/std, since pulses
  /// may be miscounted.
  void measured(double rotation_hz, double std_ratio) noexcept;
  /// A hop.
  /// @param power  |X|², of all channels, line by line; @param floor  the noise's; @param like  one of their spectra
  void step(std::span<const float> power, std::span<const float> floor, const Spectrum& like) noexcept;

  [[nodiscard]] double rotation_hz() const noexcept { return rotation_hz_; }  ///< the most likely; 0: no hint
  [[nodiscard]] double std_ratio() const noexcept { return std_ratio_; }      ///< spread about it, of f
  /// By how much its evidence exceeds the median of all candidates', 0 to 1; 1 where a measurement agrees.
  [[nodiscard]] double belief() const noexcept { return belief_; }
  /// The same of the last window alone: the lines are where the tracked speed has them, however strong others are.
  [[nodiscard]] double seen() const noexcept { return seen_; }
  /// For a speed at which a line is a multiple of tooth passing: the mean of log₁₀(P'/P)/2 over the orders there, at
  /// most 24, and the same orders at the tracked speed; of all such speeds the most, -1: there is none near the hint.
  [[nodiscard]] double lead_of_an_order(double line_hz, std::span<const float> power,
                                        const Spectrum& like) const noexcept;

 private:
  static constexpr double step_ratio = 5e-4;
  static constexpr std::size_t side = static_cast<std::size_t>(reach / step_ratio);
  static constexpr std::size_t size = 2 * side + 1;

  void gather(std::span<const float> power, std::span<const float> floor, const Spectrum& like) noexcept;
  void conclude() noexcept;
  void refine(std::span<const float> power, const Spectrum& like) noexcept;

  Setup setup_;
  double hint_hz_ = 0.0, rotation_hz_ = 0.0, std_ratio_ = 0.0, belief_ = 0.0, seen_ = 0.0;
  double measured_hz_ = 0.0, measured_std_ratio_ = 0.0;  // 0: not, in this hop
  double gathered_ = 0.0;                                // of a memory that has been filled for ever: 1
  std::size_t lines_seen_ = 0;                           // of the last window
  std::vector<double> prior_;                            // logarithm
  std::vector<double> ratio_;                            // of each candidate to the hint
  std::vector<double> total_;
  std::vector<float> evidence_, sum_, place_, here_, sorted_;  // of each candidate
  std::vector<float> worth_;                                   // v of each line
};

}  // namespace robomill::monitor
