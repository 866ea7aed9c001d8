#pragma once
#include <kissfft.hh>

#include <array>
#include <complex>
#include <cstddef>
#include <span>
#include <vector>

namespace robomill::monitor {

/// Finds the spindle's speed in the last 0.1 to 0.8 s of a signal: the comb of harmonics k f of rotation that stands
/// best above its surroundings. With the powers P of a Hann window's lines, whitened by the geometric mean of what lies
/// around, w = min(max(log P - mean log P, 0), 5),
///   score(f) = Σ_k c_k (w(k f) - mean w) / (σ_w √Σ c_k²),
/// c_k = 1 for multiples of the teeth and 0.35 for others. Nothing is allocated after construction.
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
  [[nodiscard]] double whitened(double frequency_hz) const noexcept;
  void whiten(std::size_t lines) noexcept;

  double rate_hz_;
  std::size_t channels_, size_;
  std::vector<Window> windows_;
  std::vector<float> ring_;
  std::size_t at_ = 0;
  std::vector<double> power_, sums_;
  std::vector<std::complex<double>> in_, out_;
  std::size_t length_ = 0;
  double high_hz_ = 0.0, next_hz_ = 1.0, step_hz_ = 1.0, best_hz_ = 0.0, best_ = 0.0, mean_ = 0.0, deviation_ = 1.0;
  int teeth_ = 0;
};

}  // namespace robomill::monitor
