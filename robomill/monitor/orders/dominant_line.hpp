#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "robomill/monitor/orders/spectra.hpp"

namespace robomill::monitor {

/// Follows the strongest line of the last 0.3 s that forced vibration cannot explain. It needs no speed: chatter of
/// turning, of slow spindles and of arms comes to hold nearly all energy, and is still growing when it has. A tone of a
/// drive, or tooth passing as the tool enters, comes to its level within a window and stays there.
class DominantLine {
 public:
  static constexpr double least_share = 0.7;  ///< of all energy: the line dominates
  static constexpr int kept_of = 12;     ///< hops, over which it must keep its frequency: 8 %, 3 % or 8 Hz above 100 Hz
  static constexpr double past_s = 1.7;  ///< over which its energy must have risen

  /// What of forced vibration is left out.
  struct Forced {
    double rotation_hz = 0.0;  ///< 0: unknown
    int teeth = 0;             ///< 0: unknown
    double off_ratio = 0.04;   ///< by which the rotation may be off
    double comb_hz = 0.0;      ///< of a comb that was found without a hint: its second to sixth multiple
  };
  DominantLine(std::size_t lines, double hop_s);
  /// A hop.
  /// @param power  |X|² of the last 0.3 s, all channels, up to the highest line that counts
  /// @param whole  Σ A² of it
  /// @param full   the window is filled
  void step(std::span<const float> power, const Spectrum& like, double whole, const Forced& forced, bool full) noexcept;
  void reset() noexcept;

  [[nodiscard]] double frequency_hz() const noexcept { return frequency_hz_; }  ///< 0: none
  [[nodiscard]] double share() const noexcept { return share_; }                ///< of all energy
  [[nodiscard]] int kept() const noexcept;           ///< hops of the last kept_of in which it stood where it does
  [[nodiscard]] double rise() const noexcept;        ///< of its energy over the least in past_s; 0: not known
  [[nodiscard]] double rise_since() const noexcept;  ///< the same since a window after it began to dominate

 private:
  void leave_out(double frequency_hz, double off_hz, const Spectrum& like, std::size_t lines) noexcept;
  void leave_out_forced(const Spectrum& like, std::size_t lines, const Forced& forced) noexcept;
  void follow(double energy, bool full) noexcept;

  double hop_s_;
  std::vector<float> rest_;          // of the power, without what is left out
  std::vector<double> frequencies_;  // of the last kept_of hops; a ring
  std::vector<double> energies_;     // of the last past_s; a ring, < 0: none
  std::size_t at_ = 0, energy_at_ = 0;
  double frequency_hz_ = 0.0, share_ = 0.0, energy_ = 0.0;
  double since_energy_ = 0.0;        // the least since a window after it began to dominate; 0: not known
  std::size_t since_ = 0, gap_ = 0;  // hops since it began; hops without it
};

}  // namespace robomill::monitor
