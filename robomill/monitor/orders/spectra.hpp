#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <kissfft.hh>
#include <span>
#include <vector>

namespace robomill::monitor {

/// As near as this [1/T] a line cannot be distinguished from an order.
inline constexpr double on_an_order = 0.75;

/// Orders of a slower rotation stand closer together than a window tells apart: they are not looked for, and what a hop
/// costs does not follow the speed.
inline constexpr double lowest_rotation_hz = 4.0;

/// One spectrum under a Hann window [Harris1978]: X(ν) = 2/Σw Σ w_j x_j exp(-2πiν(t_j - t_m)), t_m the window's middle.
/// A sine of amplitude A at ν shows |X(ν)| = A; X of a sine that grows, or drifts in frequency, keeps the phase of the
/// middle.
struct Spectrum {
  double seconds = 0.0;  ///< T
  double step_hz = 0.0;  ///< between lines, at most 1/(2T)
  /// 1/h(TΔν/2) - 1, h(u) = sinc(u)/(1 - u²) the window's kernel: what a straight line between two lines misses of the
  /// amplitude of a sine half way; at most 4.2 %.
  float dip = 0.0F;
  std::vector<std::complex<float>> line;

  /// Of a line's |X|², so that they sum up to Σ A²: T Δν/∫h².
  [[nodiscard]] double energy_share() const noexcept { return seconds * step_hz / 1.5; }
  /// The first line that counts, 2.5/T from 0: below is what a drifting offset reaches.
  [[nodiscard]] std::size_t first_line() const noexcept {
    return static_cast<std::size_t>(2.5 / (seconds * step_hz)) + 1;
  }
  /// The amplitude of a sine at this part of the way between two lines, to that by a straight line: 1 + 4 dip p (1 -
  /// p), within 0.2 %.
  [[nodiscard]] float lift(float part) const noexcept { return 1.0F + 4.0F * dip * part * (1.0F - part); }
  /// X between the lines.
  [[nodiscard]] std::complex<float> at(double frequency_hz) const noexcept {
    const double place = std::clamp(frequency_hz / step_hz, 0.0, static_cast<double>(line.size() - 2));
    const auto k = static_cast<std::size_t>(place);
    const auto part = static_cast<float>(place - static_cast<double>(k));
    return lift(part) * (line[k] + part * (line[k + 1] - line[k]));
  }
  /// |X|² of a sine at place · Δν, of a span of |X|².
  [[nodiscard]] float power_at(std::span<const float> power, double place) const noexcept {
    const auto k = static_cast<std::size_t>(place);
    const auto part = static_cast<float>(place - static_cast<double>(k));
    const float up = lift(part);
    return up * up * (power[k] + part * (power[k + 1] - power[k]));
  }
  /// Where a peak at line k stands between its neighbours, by the parabola through the logarithms of their powers: of
  /// lines 1/(2T) apart within 0.01/T.
  [[nodiscard]] double peak_hz(std::size_t k, double before, double here, double after) const noexcept {
    double off = 0.0;
    if (before > 0.0 && here >= before && here >= after && after > 0.0) {
      const double below = std::log(here / before);
      const double above = std::log(here / after);
      if (below + above > 0.0) off = std::clamp(0.5 * (below - above) / (below + above), -0.5, 0.5);
    }
    return (static_cast<double>(k) + off) * step_hz;
  }
};

/// Σ x and Σ x².
struct Sums {
  double plain = 0.0, squares = 0.0;
};
[[nodiscard]] Sums sums_of(std::span<const float> x) noexcept;

/// What a window holds in all channels together.
struct WindowEnergy {
  double whole = 0.0;    ///< Σ A² [input's unit²]
  double lines = 0.0;    ///< M = (ΣA²)²/ΣA⁴: about so many hold most of it; at most 20
  std::size_t last = 0;  ///< line that counts
};
/// @param power  Σ |X|² over the channels, line by line;  @param like  a spectrum of one: T and Δν
[[nodiscard]] WindowEnergy energy_of(std::span<const float> power, const Spectrum& like, double highest_hz) noexcept;
/// Of two energies; that to nothing is huge.
[[nodiscard]] inline double energy_ratio(double energy, double by) noexcept {
  return energy / (by + 1e-300);
}
/// power(k f) of many f at once.
/// @param dip  that of the spectra; 0: straight lines between lines
/// @param places  f/Δν, rising;  @param out  of those first places whose k f stands before the last line
/// @return how many these are
std::size_t at_multiple(std::span<const float> power, float dip, std::span<const float> places, int k, std::size_t last,
                        std::span<float> out) noexcept;

/// The spectra of the last moments of several channels. A sample rate above twice `enough_hz` is reduced by a whole
/// number, to that and more, behind a low-pass. Nothing is allocated after construction.
class Spectra {
 public:
  /// @param windows_s  lengths, the longest first
  Spectra(double sample_rate_hz, std::size_t channels, std::span<const double> windows_s, double enough_hz = 10240.0);
  /// @param samples  all channels, channel after channel, `frames` each
  void push(std::span<const float> samples, std::size_t frames) noexcept;
  /// Fills the spectra of a window, where samples have come since.
  void transform(std::size_t window) noexcept;
  /// Σ |X|² over the channels, line by line, of a window that was transformed.
  /// @param bad_channels  bit c: left out
  void power(std::size_t window, std::uint64_t bad_channels, std::span<float> out) const noexcept;
  [[nodiscard]] const Spectrum& spectrum(std::size_t window, std::size_t channel) const noexcept {
    return windows_[window].spectra[channel];
  }
  /// How the amplitude at a frequency went: |X(ν)|² of a channel in consecutive blocks of a window, oldest first,
  /// without what the multiples of a rotation hold there whose amplitude transform() has found; 0: none.
  void course(std::size_t window, std::size_t channel, double frequency_hz, double rotation_hz,
              std::span<double> blocks) const noexcept;
  /// The highest frequency that counts [Hz]; where the rate is reduced, a line there is shown 1.2 dB too small.
  [[nodiscard]] double highest_hz() const noexcept { return 0.5 * passed_ * rate_hz_; }
  [[nodiscard]] std::size_t channels() const noexcept { return channels_; }
  [[nodiscard]] double rate_hz() const noexcept { return rate_hz_; }  ///< the reduced one
  /// The last samples of a channel, oldest first; as many as the longest window's at most.
  void last(std::size_t channel, std::span<float> out) const noexcept {
    std::copy_n(ring_.data() + 2 * channel * size_ + at_ + size_ - out.size(), out.size(), out.data());
  }
  /// Seconds pushed since construction or reset().
  [[nodiscard]] double past_s() const noexcept { return static_cast<double>(pushed_) / rate_hz_; }
  void reset() noexcept;

 private:
  struct Window {
    std::size_t length;  // odd
    std::size_t padded;  // of the transform, >= 2 length
    kissfft<float> fft;  // of half the length: a real signal
    std::vector<float> shape;
    std::vector<Spectrum> spectra;  // of each channel
    bool current = false;           // no sample has come since
  };

  double rate_hz_;
  double passed_ = 1.0;  // share of half the rate that the low-pass lets through
  std::size_t channels_, factor_ = 1, size_ = 0;
  std::vector<float> low_pass_;  // taps; empty: none
  std::vector<float> past_;      // of each channel, as long as the taps, twice
  std::vector<float> ring_;      // of each channel, `size_`, twice
  std::size_t at_ = 0, past_at_ = 0, phase_ = 0;
  std::size_t pushed_ = 0;
  std::vector<float> in_;
  std::vector<Window> windows_;
};

}  // namespace robomill::monitor
