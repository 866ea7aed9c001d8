#pragma once
#include <cstddef>
#include <span>
#include <vector>

namespace robomill::monitor {

struct FrequencyEstimate {
  double frequency_hz = 0.0;
  double std_hz = 0.0;
  double amplitude = 0.0;
};

/// The last samples of a signal, and the frequency of a line in them.
class FrequencyRing {
 public:
  FrequencyRing(double sample_rate_hz, double longest_s);
  void push(std::span<const float> samples) noexcept;
  void reset() noexcept;

  /// The maximum of |Σ w x e^(-2πi f t)| over the last `length_s`, w the Hann window, sought within ± `around_hz` of a
  /// coarse frequency. The standard deviation is the Cramér-Rao bound of a sine in white noise times the window's loss,
  ///   σ_f² = 1.9 · 24 σ²/(A² n³) (f_s/2π)²,
  /// with the noise σ² from the spectrum 4 to 8 resolutions away, and a third of the difference between the halves, as
  /// drift, added in squares. [RifeBoorstyn1974]
  [[nodiscard]] FrequencyEstimate estimate(double coarse_hz, double around_hz, double length_s) noexcept;

 private:
  [[nodiscard]] double power(double frequency_hz, std::size_t first, std::size_t count) const noexcept;
  [[nodiscard]] double peak(double coarse_hz, double around_hz, std::size_t first, std::size_t count) const noexcept;
  double rate_hz_;
  std::vector<float> ring_;    // twice, so that the last samples are in one piece
  std::vector<double> piece_;  // windowed
  std::size_t at_ = 0, size_;
};

}  // namespace robomill::monitor
