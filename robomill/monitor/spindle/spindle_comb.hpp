#pragma once
#include <complex>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "robomill/monitor/comb_cusum/comb.hpp"
#include "robomill/monitor/monitor.hpp"

namespace robomill::monitor {

/// What repeats with the spindle in all channels: a Comb each, at one angle θ that advances by 2π f/rate a sample. With
/// a_k the amplitudes of a channel, g_k the innovation of a block (n samples, a quarter of a hop, and no longer than
/// the shortest past), σ the slow rms of the residual:
///
/// Gain, after v revolutions of T samples: max(1 - exp(-n/τ), min(1, n/(T (1 + v)))), τ = 0.25 s. The first turns are
/// averaged; after four of them no sample counts for more than 4 σ.
///
/// Phase, from the harmonics of all channels with |a_k|² > 4 σ²/n; α = 0.01 rad is the angle's own unrest in a block:
///   W = Σ k² |a_k|²/σ²,   δ = Σ k Im(ā_k g_k)/σ² / W,   w = 1/(1 + 2/(n W α²)),
///   θ += 0.1 w δ,   f += 0.005 w δ/(2π n/rate),   |δ| no more than 0.2.
///
/// Lag, what follows the comb with delay: m_k the mean of g_k over the last two or three hops, 0 where they disagree.
/// As far as it is likely, its power is
///   min(|m_k|², max(25 |a_k|² Σ |a|² |m|²/Σ |a|⁴, 3e-4 P)),   P the channel's.
///
/// Nothing is allocated after construction.
class SpindleComb {
 public:
  static constexpr std::size_t most_harmonics = 320;

  struct Hop {
    std::span<const float> samples;  ///< all channels, channel after channel
    std::uint64_t bad_channels = 0;  ///< bit c: left out, its residual 0
    double rotation_hz = 0.0;        ///< f at its beginning, > 0
    bool learns = true;              ///< amplitudes follow
    bool steers = true;              ///< f does
  };

  /// @param shortest_past, longest_past  samples that learn() will be given at least and at most
  SpindleComb(const MonitorOptions& options, std::size_t shortest_past, std::size_t longest_past);

  /// A hop begins, whether or not it is run.
  void begin_hop() noexcept;
  /// Fills residual (as long as samples) and returns f at the end of the hop.
  double run(const Hop& hop, std::span<float> residual) noexcept;
  /// The power of each harmonic's lag, peak squared, into as many of `power`, 0 where there is none.
  /// @param whole  P;  @param learns  takes up a part of the lags that are the cut's
  void lags(std::size_t channel, double whole, bool learns, std::span<double> power) noexcept;
  /// Learns a channel anew, at another speed, from what ends where the next hop to be run begins: its whole blocks,
  /// whose residual is returned.
  std::span<const float> learn(std::size_t channel, std::span<const float> past, double rotation_hz) noexcept;
  /// Begins anew at the same speed.
  void forget() noexcept;
  void reset() noexcept;

  [[nodiscard]] std::span<const Comb> combs() const noexcept { return combs_; }
  [[nodiscard]] std::size_t harmonics() const noexcept { return combs_.front().harmonics(); }
  [[nodiscard]] std::size_t max_harmonics() const noexcept { return most_; }
  [[nodiscard]] double learnt_s() const noexcept { return learnt_s_; }  ///< since it began to learn
  /// It has learnt for four turns and 0.06 s.
  [[nodiscard]] bool settled() const noexcept;

 private:
  void run_block(const Hop& hop, std::span<float> residual, std::size_t first, double rotation_hz) noexcept;
  [[nodiscard]] double ahead() const noexcept;
  [[nodiscard]] std::complex<double> coherent_mean(std::size_t channel, std::size_t k) const noexcept;
  [[nodiscard]] std::span<std::complex<double>> innovation(std::size_t channel, std::size_t hop) noexcept;

  double rate_hz_, hop_s_;
  std::size_t channels_, frames_, block_, teeth_, most_;
  std::vector<Comb> combs_;
  std::vector<float> past_residual_;              // of a channel
  std::vector<double> rms_;                       // of the residual, slow
  std::vector<std::complex<double>> innovation_;  // of the last hops, each channel's
  std::size_t hop_ = 0;                           // of these
  double angle_ = 0.0;
  double revolutions_ = 0.0, learnt_s_ = 0.0;  // since it began to learn
};

}  // namespace robomill::monitor
