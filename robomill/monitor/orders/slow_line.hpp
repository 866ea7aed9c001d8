#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "robomill/monitor/orders/spectra.hpp"

namespace robomill::monitor {

/// Follows the strongest low line beside the orders of a slow spindle, in a window of eight turns: chatter of arms,
/// whose modes lie at 8 to 60 Hz. There orders stand so few lines apart that a family cannot be told from its floor;
/// but chatter of a soft machine comes to be as strong as forced vibration, and lasts. What rings after an entry, a
/// change of depth or a knock is as strong, and falls as soon as the window holds it. Nothing is allocated after
/// construction.
class SlowLine {
 public:
  /// @param like  the spectra with the most lines
  SlowLine(const Spectrum& like, double highest_hz, double hop_s);
  /// A hop.
  /// @param power  |X|², of all channels, line by line;  @param full  the window is filled
  void step(std::span<const float> power, const Spectrum& like, double rotation_hz, bool full) noexcept;
  /// Forgets; also where another window is used.
  void reset() noexcept;

  [[nodiscard]] double frequency_hz() const noexcept { return frequency_hz_; }  ///< 0: none
  [[nodiscard]] double energy() const noexcept { return energy_; }              ///< beyond the skirts of the orders
  [[nodiscard]] double ratio() const noexcept;                                  ///< of it, to that of the orders
  [[nodiscard]] double share() const noexcept;                                  ///< of it, of all
  /// Of the hops in the last 0.6 windows, those in which ratio() and share() stood above what an alarm takes.
  [[nodiscard]] double lasting() const noexcept;
  /// Of the energy at its frequency: to the most in the last half window; to the least in 1.7 s and a window of 2 s.
  [[nodiscard]] double holding() const noexcept { return holding_; }
  [[nodiscard]] double rise() const noexcept { return rise_; }
  /// The same, to the most of the last second.
  [[nodiscard]] double left() const noexcept { return left_of_it_; }

  static constexpr double highest_line_hz = 200.0;
  static constexpr double least_ratio = 0.2, least_share = 0.1;

 private:
  [[nodiscard]] std::size_t pairs() const noexcept { return (lines_ + 1) / 2; }
  void measure(std::span<const float> power, const Spectrum& like, double rotation_hz) noexcept;
  void compare(const Spectrum& like) noexcept;

  double hop_s_, highest_hz_;
  std::size_t lines_;        // of a spectrum in the ring
  std::vector<float> past_;  // spectra, pairs of lines summed, `hops_kept_` of them; a ring
  std::vector<float> rest_;  // of each line, above the skirts
  std::vector<char> stood_;  // of each hop; a ring
  std::size_t hops_kept_, hops_ = 0;
  std::size_t used_ = 0;  // lines, in this window
  double seconds_ = 0.0;  // of the window
  double frequency_hz_ = 0.0, energy_ = 0.0, synchronous_ = 0.0, whole_ = 0.0;
  double holding_ = 0.0, rise_ = 0.0, left_of_it_ = 0.0;
};

}  // namespace robomill::monitor
