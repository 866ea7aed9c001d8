#pragma once
// Columns of the synchrosqueezed transform, one sample after another: what SynchrosqueezeStream and the batch functions
// run on.
#include <kissfft.hh>

#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "robomill/base/lanes.hpp"
#include "robomill/signal/synchrosqueeze.hpp"
#include "robomill/signal/synchrosqueeze_kernels.hpp"

namespace robomill::signal {

/// Close columns slide: N/2 + 1 lines of the rectangular window take in a sample with one turn each, and a window is
/// the sum of a few neighbouring lines. Otherwise x g + i x g' goes through one FFT a column.
///
/// Rounding of the sliding lines is bounded: a quarter of the lines is summed anew from zero over each N samples, so
/// that no line carries more than 4 N samples' rounding.
class SynchrosqueezeEngine {
 public:
  /// Of options that are valid.
  SynchrosqueezeEngine(const SynchrosqueezeOptions& options, const Eigen::VectorXd& edges_hz);

  /// True: a column is ready.
  bool push(double sample) noexcept;
  /// Takes in a sample without looking whether a column is ready: for the N samples before a first column.
  void fill(double sample) noexcept { take(sample); }

  void transform(std::complex<double>* out) const noexcept;
  void squeezed(std::complex<double>* out) const noexcept;
  void reset() noexcept;

  std::size_t n = 0, lines = 0, bands = 0;
  std::uint64_t hop = 1;
  std::uint64_t centre = 0;         // of the newest column
  std::uint64_t next = 0;           // samples until the next column is ready
  std::vector<double> band_values;  // of the newest column

 private:
  using Store = std::vector<Lanes>;

  void take(double sample) noexcept;
  void renew() noexcept;
  void column() noexcept;
  void fft_column() noexcept;
  void finish_bands() noexcept;
  void set_tables(const SynchrosqueezeOptions& options);
  void set_bands(const SynchrosqueezeOptions& options, const Eigen::VectorXd& edges_hz);

  bool first_ = true;  // no column yet
  bool slides_ = true;
  std::size_t groups_ = 0;        // of lines
  std::size_t slide_groups_ = 0;  // with those before line 0 and after the last
  double scale_ = 1.0;            // 1/(N g(0))

  std::vector<double> ring_;  // the last N samples, each twice
  std::size_t newest_ = 0;    // in its first half

  Store re_, im_, turn_re_, turn_im_;
  Store fresh_re_, fresh_im_;  // the lines that are being summed anew
  std::size_t fresh_groups_ = 0, fresh_at_ = 0, fresh_samples_ = 0;

  Store line_, weight_, sign_, v_re_, v_im_, a_re_, a_im_, target_, share_;
  Squeeze squeeze_ = {};
  std::vector<std::uint8_t> band_of_line_, lowest_, highest_;
  std::vector<double> edge_;
  Store band_sums_, far_;

  kissfft<double> fft_;
  std::vector<double> g_, slope_;  // slope: g' N/(2π f_s)
  std::vector<std::complex<double>> in_, out_;
};

/// The band of each line; `bands` where none has it.
std::vector<std::uint8_t> bands_of_lines(const SynchrosqueezeOptions& options, const Eigen::VectorXd& edges_hz);

}  // namespace robomill::signal
