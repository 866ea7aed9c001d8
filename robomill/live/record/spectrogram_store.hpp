#pragma once
#include <complex>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "robomill/live/recorded_run.hpp"
#include "robomill/signal/bands.hpp"
#include "robomill/signal/synchrosqueeze.hpp"

namespace robomill::live {

/// One channel's spectrogram, of which the part worth drawing is chosen at the end. Cells hold the strongest of what
/// falls into them: up to 600 columns; rows a line each up to the 256th, then 128 an octave, so that any part of them
/// from 0 up has at least some 128 rows where it has as many lines.
class SpectrogramStore {
 public:
  /// @param window_samples  of the transform
  SpectrogramStore(double sample_rate_hz, std::size_t window_samples);
  /// @param sample  not finite: none came
  void add(double sample);
  /// Samples that never came.
  void skip(std::uint64_t samples);

  /// Below lie 99.9 % of the energy above the noise, whose power a line is the median over the lines, doubled [Hz];
  /// half the sample rate where nothing stands out.
  [[nodiscard]] double energy_limit_hz() const;
  /// The rows up to a frequency, at most 257, without the channel's name; no levels where there was no signal.
  [[nodiscard]] Spectrogram part(double max_frequency_hz) const;

 private:
  void push(double value);
  [[nodiscard]] double line_hz() const;

  signal::SynchrosqueezeOptions options_;
  signal::SynchrosqueezeStream stream_;
  double drift_share_, offset_ = 0.0;
  bool any_ = false;
  std::vector<std::complex<double>> lines_;
  std::vector<std::size_t> first_line_;  ///< of each row, and the number of lines
  std::vector<double> peak_, energy_;    ///< of a column, and of all; a value a row
  signal::Bands cells_;
};

}  // namespace robomill::live
