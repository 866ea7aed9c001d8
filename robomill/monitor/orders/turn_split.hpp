#pragma once
#include <complex>
#include <cstddef>
#include <cstdint>
#include <kissfft.hh>
#include <span>
#include <vector>

#include "robomill/monitor/orders/spectra.hpp"

namespace robomill::monitor {

/// Splits what a slow spindle's cut shows below 250 to 500 Hz into what repeats from turn to turn, the multiples of
/// rotation, and the rest: chatter of arms, whose modes lie at 8 to 60 Hz. Over whole turns without a window's slopes
/// these multiples are orthogonal, so four turns tell them from all else, where a Hann window takes eight; and all
/// lines of chatter count, however many sidebands share its energy. Noise and tones of a stable cut are a part of its
/// forced vibration; what rings after an entry, a change of depth or a knock falls within the window; what the machine
/// shows anyway has not risen; and where the tool leaves, what repeats goes. Nothing is allocated after construction.
class TurnSplit {
 public:
  struct Speed {
    double rotation_hz = 0.0;  ///< as tracked; 0: none, all is forgotten
    double hint_hz = 0.0;
    int teeth = 1;
  };
  TurnSplit(double sample_rate_hz, std::size_t channels, double hop_s);
  /// @param samples  all channels, channel after channel, `frames` each
  void push(std::span<const float> samples, std::size_t frames) noexcept { spectra_.push(samples, frames); }
  /// A hop; every second one is measured, none without a channel. @param bad_channels  bit c: left out
  void step(const Speed& speed, std::uint64_t bad_channels) noexcept;
  void reset() noexcept;

  [[nodiscard]] double ratio() const noexcept;                            ///< of the rest, to what repeats
  [[nodiscard]] double holding() const noexcept { return now_.holds; }    ///< of the rest, second half to the first
  [[nodiscard]] double rise() const noexcept { return rise_; }            ///< of the rest, to its least of 2 s
  [[nodiscard]] double repeating() const noexcept { return repeating_; }  ///< of what repeats, to its most of a second
  [[nodiscard]] double staying() const noexcept { return staying_; }      ///< of all, to its most of a second
  /// Of what repeats, to the least of all of late.
  [[nodiscard]] double repeating_above_quiet() const noexcept { return repeating_above_quiet_; }
  [[nodiscard]] double above_quiet() const noexcept { return above_quiet_; }  ///< of all, to its least of late
  [[nodiscard]] double loud_s() const noexcept { return loud_s_; }            ///< since it stands above that
  [[nodiscard]] double settled_s() const noexcept;                            ///< that an alarm asks of loud_s()
  /// Of the last 0.4 s, the part in which all of this was as an alarm asks.
  [[nodiscard]] double lasting() const noexcept;
  [[nodiscard]] bool holds() const noexcept;  ///< all of this is so now

 private:
  struct Energies {
    double whole = 0.0, rest = 0.0, repeated = 0.0;
    double teeth = 0.0;  ///< of what repeats, at multiples of tooth passing
    double holds = 0.0;
  };
  [[nodiscard]] std::span<float> window(double rotation_hz) noexcept;
  void fill(std::size_t channel, std::span<float> x) const noexcept;
  [[nodiscard]] double best_speed(const Speed& speed, std::uint64_t bad_channels) noexcept;
  [[nodiscard]] double at_multiples(double rotation_hz, double highest_hz) const noexcept;
  void project(std::span<const float> x, double rotation_hz, std::size_t orders) noexcept;
  [[nodiscard]] Energies measure(double rotation_hz, int teeth, std::uint64_t bad_channels) noexcept;
  void compare() noexcept;
  void follow_quiet() noexcept;

  double measured_each_s_;
  std::size_t channels_;
  Spectra spectra_;       // for its reduced rate alone
  std::vector<float> x_;  // of a channel, the window
  kissfft<float> fft_;
  std::vector<float> padded_, power_;  // to find the speed: |X|² of all channels
  std::vector<std::complex<float>> line_;
  std::vector<float> cos_, sin_, turn_cos_, turn_sin_;  // of each order
  std::vector<float> sums_;                             // Σ x cos, Σ x sin of each order, of both halves
  std::vector<Energies> past_;                          // a ring
  std::vector<char> stood_;                             // a ring
  std::size_t measured_ = 0;
  bool skip_ = false;
  Energies now_;
  double window_s_ = 0.0, loud_s_ = 0.0, quiet_ = 0.0;
  double level_s_ = 0.0;  // in which tooth passing held the energy, until a cut stood out of the quietest; < 0: one has
  double rise_ = 0.0, repeating_ = 0.0, staying_ = 0.0, above_quiet_ = 0.0, repeating_above_quiet_ = 0.0;
};

}  // namespace robomill::monitor
