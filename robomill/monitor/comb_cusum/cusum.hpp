#pragma once
#include <cstddef>
#include <span>
#include <vector>

namespace robomill::monitor {

/// Sequential test of many energies at once (lines of a spectrum, harmonics of a comb), hop by hop, each against its
/// own slowly learnt baseline. With x the log of an energy, b and s the robust mean and spread of x in the past,
///   z = (x - b) min(1, s0/s) - max(0, median z) - u/√n,   ρ = e^(z - γ),
/// where the median over the lines takes off what rises everywhere at once (a knock, the tool that enters), n is the
/// number of hops that b was learnt from and γ is Euler's constant (an exponential variable's log of mean less mean of
/// log). If stationary noise has the mean energy 1, its energy in a line is exponential, and the log likelihood of
/// chatter that multiplies it by q is (1 - 1/q) ρ - log q. That is summed, no hop adding more than half of what an
/// alarm takes:
///   S = max(0, S + min(Σ_channels (1 - 1/q) ρ - log q, h/2)) [Page1954].
/// Where more than a quarter of a line's evidence comes from channels whose power falls, nothing is added, however high
/// it stands: what was struck rings off, and beats from one channel into another.
/// The other side is summed alike, S- for energies divided by q, with log q - (q - 1) ρ: where it passes h, the line
/// has fallen for good, and its baseline by q. The probability that S of one line passes h at one look is below e^-h
/// (Wald), so that h = log(lines × looks an hour / false alarms an hour).
class Cusum {
 public:
  struct Setup {
    std::size_t lines = 0, channels = 1;
    double hop_s = 0.025;
    double false_alarms_per_hour = 0.1;
    double baseline_s = 2.0;  ///< time constant of the baselines
  };
  explicit Cusum(const Setup& setup);

  struct Verdict {
    double score = 0.0;       ///< max S
    std::size_t line = 0;     ///< where
    std::size_t channel = 0;  ///< in which that line stands highest
    double height = 0.0;      ///< z there
    double common = 0.0;      ///< median z
    bool ready = false;       ///< there are baselines
  };
  /// Measures; the baselines stay until learn().
  /// @param energy   lines × channels, channel after channel
  /// @param taken    as long: the part of it that is known not to be chatter
  /// @param falls    a channel each: its power falls, so that what stands high may be ringing off
  Verdict step(std::span<const double> energy, std::span<const double> taken, std::span<const bool> falls) noexcept;
  /// Lets the baselines follow what step() has measured.
  void learn() noexcept;
  /// Forget the baselines, learn them fast.
  void relearn() noexcept;
  /// What a line and its neighbours have now is their baseline: the cut's own.
  void accept(std::size_t line) noexcept;
  /// Sums begin anew.
  void clear() noexcept;
  [[nodiscard]] double threshold() const noexcept { return threshold_; }
  [[nodiscard]] std::size_t lines() const noexcept { return lines_; }
  [[nodiscard]] double height(std::size_t channel, std::size_t line) const noexcept {
    return z_[channel * lines_ + line];
  }
  [[nodiscard]] double log_energy(std::size_t channel, std::size_t line) const noexcept {
    return log_[channel * lines_ + line];
  }
  [[nodiscard]] double sum(std::size_t line) const noexcept { return up_[line]; }

 private:
  double measure(std::span<const double> energy, std::span<const double> taken) noexcept;

  std::size_t lines_, channels_;
  double threshold_, slow_;
  std::vector<double> energy_, mean_, log_, base_, spread_, z_, up_, down_, sorted_;
  double learnt_ = 0.0;  // hops since the baselines began
};

}  // namespace robomill::monitor
