#pragma once
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "robomill/monitor/monitor.hpp"
#include "robomill/signal/synchrosqueeze.hpp"

namespace robomill::monitor {

/// Entropy of the bands' energies E_b >= 0, p_b = E_b / Σ E; 0 where Σ E = 0.
/// - normalised: -Σ p_b ln p_b, in [0, ln bands], no unit, blind to the amplitude;
/// - energy: -Σ E_b ln p_b = Σ E times the normalised one: in the unit of E, grows with the amplitude's square. Unlike
///   -Σ E_b ln E_b, it is never negative, and another unit of E only scales it.
[[nodiscard]] double energy_entropy(std::span<const double> energies, Entropy entropy) noexcept;

/// The published feature [EnergyEntropyChatter] of one channel: the signal synchrosqueezed with a column a sample (Hann
/// window of options.window_s, made even), `bands` equal bands reconstructed as signals, and the entropy of their
/// energies, the mean squares over the last window's worth of columns [input's unit squared]. The window, the mean
/// square and the form of the entropy are ours: the text at hand of the source has lost its equations.
///
/// The newest column stands half a window behind the newest sample. Nothing throws, and nothing is allocated, after
/// construction.
class EnergyEntropy {
 public:
  /// Uses sample_rate_hz, window_s, bands and entropy.
  /// @throws InvalidInput naming an option that is out of range
  explicit EnergyEntropy(const MonitorOptions& options);

  /// Any number of samples, finite. @return the entropy over the last window of what was pushed; silence comes before
  /// the first sample
  double push(std::span<const double> samples) noexcept;
  /// E_b, as of the last push.
  [[nodiscard]] std::span<const double> energies() const noexcept { return energies_; }
  /// Samples from the first until the value holds no silence from before it: two windows.
  [[nodiscard]] std::size_t warm_up() const noexcept { return 2 * columns_; }
  void reset() noexcept;

 private:
  Entropy entropy_;
  std::size_t columns_;  // in a window
  signal::SynchrosqueezeStream stream_;
  std::vector<double> signals_;  // the last window's columns, `bands` values each
  std::size_t oldest_ = 0;       // column
  std::vector<double> energies_;
};

}  // namespace robomill::monitor
