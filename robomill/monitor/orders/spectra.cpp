#include "robomill/monitor/orders/spectra.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace robomill::monitor {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double near_block = 4.0;         // 1/T of a block, to each side, that a multiple of rotation shows
constexpr std::size_t taps_a_factor = 24;  // of the low-pass, for each sample left out
constexpr double most_lines = 20.0;        // M
constexpr double peaked = 0.53;            // ∫h⁴/(∫h²)²
constexpr double passed = 0.85;            // of half the reduced rate
constexpr std::size_t lanes = 8;           // numbers side by side, of which none waits for the one before

std::vector<float> low_pass(std::size_t factor) {
  // A windowed sinc (Hann) whose half is at the reduced Nyquist frequency's 0.925th part.
  const std::size_t taps = taps_a_factor * factor + 1;
  const double cut = 0.5 * (1.0 + passed) / (2.0 * static_cast<double>(factor));  // of the sample rate
  std::vector<double> h(taps);
  double sum = 0.0;
  for (std::size_t i = 0; i < taps; ++i) {
    const double t = static_cast<double>(i) - 0.5 * static_cast<double>(taps - 1);
    const double sinc = t == 0.0 ? 2.0 * cut : std::sin(2.0 * pi * cut * t) / (pi * t);
    h[i] = sinc * (0.5 + 0.5 * std::cos(2.0 * pi * t / static_cast<double>(taps + 1)));
    sum += h[i];
  }
  std::vector<float> out(taps);
  std::ranges::transform(h, out.begin(), [&](double tap) { return static_cast<float>(tap / sum); });
  return out;
}

/// The least even 2^a 3^b 5^c, which transform fastest, that is n or more.
std::size_t smooth(std::size_t n) {
  for (n += n % 2;; n += 2) {
    std::size_t rest = n;
    for (const std::size_t prime : {2U, 3U, 5U}) {
      while (rest % prime == 0) rest /= prime;
    }
    if (rest == 1) return n;
  }
}

template <std::size_t n>
void interpolate(const float* power, float dip, const float* places, float order, float* out) {
  float part[n], here[n], next[n];
  std::int32_t line[n];
  for (std::size_t i = 0; i < n; ++i) {
    const float at = order * places[i];
    line[i] = static_cast<std::int32_t>(at);
    part[i] = at - static_cast<float>(line[i]);
  }
  for (std::size_t i = 0; i < n; ++i) {
    here[i] = power[line[i]];
    next[i] = power[line[i] + 1];
  }
  for (std::size_t i = 0; i < n; ++i) {
    const float lift = 1.0F + 4.0F * dip * part[i] * (1.0F - part[i]);
    out[i] = lift * lift * (here[i] + part[i] * (next[i] - here[i]));
  }
}

}  // namespace

Sums sums_of(std::span<const float> x) noexcept {
  std::array<double, lanes> plain = {};
  std::array<double, lanes> squares = {};
  for (; x.size() >= lanes; x = x.subspan(lanes)) {
    for (std::size_t i = 0; i < lanes; ++i) {
      const auto one = static_cast<double>(x[i]);
      plain[i] += one;
      squares[i] += one * one;
    }
  }
  Sums out;
  for (std::size_t i = 0; i < lanes; ++i) {
    const double one = i < x.size() ? static_cast<double>(x[i]) : 0.0;
    out.plain += plain[i] + one;
    out.squares += squares[i] + one * one;
  }
  return out;
}

WindowEnergy energy_of(std::span<const float> power, const Spectrum& like, double highest_hz) noexcept {
  WindowEnergy out;
  out.last = std::min(power.size() - 2, static_cast<std::size_t>(highest_hz / like.step_hz));
  if (out.last < like.first_line()) return out;
  const auto [sum, squares] = sums_of(power.subspan(like.first_line(), out.last + 1 - like.first_line()));
  out.whole = sum * like.energy_share();
  out.lines = std::min(most_lines, sum * sum / (squares + 1e-300) * like.seconds * like.step_hz * peaked);
  return out;
}

std::size_t at_multiple(std::span<const float> power, float dip, std::span<const float> places, int k, std::size_t last,
                        std::span<float> out) noexcept {
  const auto order = static_cast<float>(k);
  const auto end = std::ranges::lower_bound(places, static_cast<float>(last) / order);
  const auto count = static_cast<std::size_t>(end - places.begin());
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes)
    interpolate<lanes>(power.data(), dip, places.data() + i, order, out.data() + i);
  for (; i < count; ++i) interpolate<1>(power.data(), dip, places.data() + i, order, out.data() + i);
  return count;
}

Spectra::Spectra(double sample_rate_hz, std::size_t channels, std::span<const double> windows_s, double enough_hz)
    : channels_(channels), factor_(std::max<std::size_t>(1, static_cast<std::size_t>(sample_rate_hz / enough_hz))) {
  rate_hz_ = sample_rate_hz / static_cast<double>(factor_);
  if (factor_ > 1) {
    low_pass_ = low_pass(factor_);
    passed_ = passed;
  }
  past_.resize(2 * low_pass_.size() * channels);
  for (const double seconds : windows_s) {
    const std::size_t length = static_cast<std::size_t>(seconds * rate_hz_) / 2 * 2 + 1;
    const std::size_t padded = 2 * smooth(length);
    Window& window = windows_.emplace_back(
        Window{length, padded, kissfft<float>(padded / 2, false), std::vector<float>(length), {}});
    double sum = 0.0;
    for (std::size_t i = 0; i < length; ++i) {
      const double w = 0.5 - 0.5 * std::cos(2.0 * pi * static_cast<double>(i + 1) / static_cast<double>(length + 1));
      window.shape[i] = static_cast<float>(w);
      sum += w;
    }
    for (float& w : window.shape) w *= static_cast<float>(2.0 / sum);
    window.spectra.resize(channels);
    for (Spectrum& spectrum : window.spectra) {
      spectrum.seconds = static_cast<double>(length + 1) / rate_hz_;
      spectrum.step_hz = rate_hz_ / static_cast<double>(padded);
      const double half_way = 0.5 * spectrum.seconds * spectrum.step_hz;
      spectrum.dip = static_cast<float>(pi * half_way * (1.0 - half_way * half_way) / std::sin(pi * half_way) - 1.0);
      spectrum.line.resize(padded / 2);
    }
  }
  size_ = windows_.front().length;
  ring_.resize(2 * size_ * channels);
  in_.resize(windows_.front().padded);
}

void Spectra::reset() noexcept {
  std::ranges::fill(past_, 0.0F);
  std::ranges::fill(ring_, 0.0F);
  at_ = past_at_ = phase_ = pushed_ = 0;
  for (Window& window : windows_) window.current = false;
}

void Spectra::push(std::span<const float> samples, std::size_t frames) noexcept {
  for (Window& window : windows_) window.current = false;
  const std::size_t taps = low_pass_.size();
  for (std::size_t i = 0; i < frames; ++i) {
    if (taps > 0) {
      for (std::size_t c = 0; c < channels_; ++c) {
        float* past = past_.data() + 2 * c * taps;
        past[past_at_] = past[past_at_ + taps] = samples[c * frames + i];
      }
      past_at_ = past_at_ + 1 == taps ? 0 : past_at_ + 1;
      phase_ = phase_ + 1 == factor_ ? 0 : phase_ + 1;
      if (phase_ != 0) continue;
    }
    for (std::size_t c = 0; c < channels_; ++c) {
      float x = 0.0F;
      if (taps > 0) {
        const float* past = past_.data() + 2 * c * taps + past_at_;
        for (std::size_t j = 0; j < taps; ++j) x += low_pass_[j] * past[j];
      } else {
        x = samples[c * frames + i];
      }
      float* ring = ring_.data() + 2 * c * size_;
      ring[at_] = ring[at_ + size_] = x;
    }
    at_ = at_ + 1 == size_ ? 0 : at_ + 1;
    ++pushed_;
  }
}

void Spectra::course(std::size_t window_index, std::size_t channel, double frequency_hz, double rotation_hz,
                     std::span<double> blocks) const noexcept {
  const Window& window = windows_[window_index];
  const Spectrum& spectrum = window.spectra[channel];
  const float* last = ring_.data() + 2 * channel * size_ + at_ + size_ - window.length;
  const std::size_t each = window.length / blocks.size();
  const double turn = 2.0 * pi * frequency_hz / rate_hz_;  // a sample
  const std::complex<double> step = std::polar(1.0, -turn);
  const double near_hz = near_block * rate_hz_ / static_cast<double>(each);
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const double begins = static_cast<double>(b * each) - 0.5 * static_cast<double>(window.length - 1);
    std::complex<double> phase = std::polar(1.0, -turn * begins);
    std::complex<double> sum = 0.0;
    for (std::size_t i = b * each; i < (b + 1) * each; ++i) {
      sum += static_cast<double>(last[i]) * phase;
      phase *= step;
    }
    sum *= 2.0 / static_cast<double>(each);
    const double middle = begins + 0.5 * static_cast<double>(each - 1);
    const double first = rotation_hz > 0.0 ? std::ceil((frequency_hz - near_hz) / rotation_hz) : 0.0;
    const double last_hz = std::min(frequency_hz + near_hz, 0.5 * rate_hz_);
    for (double k = std::max(1.0, first); rotation_hz > 0.0 && k * rotation_hz <= last_hz; ++k) {
      const double apart_hz = k * rotation_hz - frequency_hz;
      if (std::abs(apart_hz) * spectrum.seconds < on_an_order) continue;
      const double half_turn = pi * apart_hz / rate_hz_;  // a sample
      const double seen =
          std::sin(half_turn * static_cast<double>(each)) / (static_cast<double>(each) * std::sin(half_turn));
      sum -= seen * std::complex<double>(spectrum.at(k * rotation_hz)) * std::polar(1.0, 2.0 * half_turn * middle);
    }
    blocks[b] = std::norm(sum);
  }
}

void Spectra::transform(std::size_t window_index) noexcept {
  Window& window = windows_[window_index];
  if (window.current) return;
  window.current = true;
  const std::size_t half = window.length / 2;
  for (std::size_t c = 0; c < channels_; ++c) {
    const float* last = ring_.data() + 2 * c * size_ + at_ + size_ - window.length;
    // The middle stands at 0, so that the phases are its own.
    std::fill(in_.begin() + static_cast<std::ptrdiff_t>(half + 1),
              in_.begin() + static_cast<std::ptrdiff_t>(window.padded - half), 0.0F);
    for (std::size_t i = 0; i <= half; ++i) in_[i] = window.shape[half + i] * last[half + i];
    for (std::size_t i = 0; i < half; ++i) in_[window.padded - half + i] = window.shape[i] * last[i];
    window.fft.transform_real(in_.data(), window.spectra[c].line.data());
    window.spectra[c].line[0] = {};
  }
}

void Spectra::power(std::size_t window, std::uint64_t bad_channels, std::span<float> out) const noexcept {
  std::ranges::fill(out, 0.0F);
  for (std::size_t c = 0; c < channels_; ++c) {
    if ((bad_channels >> c & 1U) != 0) continue;
    const std::vector<std::complex<float>>& line = windows_[window].spectra[c].line;
    for (std::size_t i = 1; i < out.size(); ++i) out[i] += std::norm(line[i]);
  }
}

}  // namespace robomill::monitor
