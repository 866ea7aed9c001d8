#pragma once
#include <kissfft.hh>

#include <array>
#include <complex>
#include <cstddef>
#include <span>
#include <vector>

namespace robomill::monitor {

/// Finds the spindle's speed in the last 0.1 to 0.8 s of a signal: the comb of harmonics k f of rotation that explains
/// its peaks better than chance would. Peaks i are the local maxima that stand e_i > 2 (natural log) above the
/// geometric mean of what lies around and are no less than 1e-5 of the greatest, w_i = min(e_i - 1.5, 4), at most 40 of
/// them, below 2.5 kHz. A peak is explained by f as far as g_i = 1 - |p_i - k f| / τ, at least 0, τ = 0.6 lines;
/// multiples of the teeth count whole, others half. Of n = (Σ w)²/Σ w² peaks a share a = Σ w g/Σ w is explained, by
/// chance c = E g; the probability of as much by chance at one of N candidates is below N exp(-n KL(a, c)) (Chernoff),
/// so that
///   score(f) = n (a ln(a/c) + (1 - a) ln((1 - a)/(1 - c))) - ln N  for a > c.
/// Nothing is allocated after construction.
class SpeedSearch {
 public:
  static constexpr std::size_t windows = 4;  ///< 0.1, 0.2, 0.4 and 0.8 s, rounded to powers of two
  SpeedSearch(double sample_rate_hz, std::size_t channels);

  /// frames × channels, channel after channel.
  void push(std::span<const float> samples, std::size_t frames) noexcept;
  [[nodiscard]] double window_s(std::size_t window) const noexcept;
  [[nodiscard]] std::size_t window_samples(std::size_t window) const noexcept { return windows_[window].length; }
  /// The last samples of a channel, as many as `out` has room for; no more than the longest window.
  void last(std::size_t channel, std::span<float> out) const noexcept;

  /// Takes the spectrum of the last samples. The search goes on from low to high [Hz of rotation] with each advance().
  void begin(std::size_t window, double low_hz, double high_hz, int teeth) noexcept;
  /// Tries up to `candidates` speeds; true: all have been tried.
  bool advance(std::size_t candidates) noexcept;
  [[nodiscard]] bool searching() const noexcept { return next_hz_ <= high_hz_; }
  [[nodiscard]] double best_hz() const noexcept { return best_hz_; }
  [[nodiscard]] double best_score() const noexcept { return best_; }
  /// Of the last spectrum.
  [[nodiscard]] double score(double rotation_hz) const noexcept;
  void reset() noexcept;

 private:
  struct Window {
    std::size_t length = 0;
    kissfft<double> fft;
    std::vector<double> shape;
  };
  struct Peak {
    double frequency_hz = 0.0, weight = 0.0;
  };
  static constexpr std::size_t most_peaks = 40;
  void find_peaks(std::size_t lines) noexcept;

  double rate_hz_;
  std::size_t channels_, size_;
  std::vector<Window> windows_;
  std::vector<float> ring_;
  std::size_t at_ = 0;
  std::vector<double> power_, sums_;
  std::vector<std::complex<double>> in_, out_;
  std::array<Peak, most_peaks> peaks_;
  std::size_t found_ = 0;  // peaks
  std::size_t length_ = 0;
  double high_hz_ = 0.0, next_hz_ = 1.0, step_ = 1.0, best_hz_ = 0.0, best_ = 0.0;
  double weight_ = 0.0, count_ = 0.0, freedom_ = 0.0;  // Σ w, n, ln N
  int teeth_ = 0;
};

}  // namespace robomill::monitor
