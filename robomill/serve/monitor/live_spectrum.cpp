#include "robomill/serve/monitor/live_spectrum.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "robomill/signal/spectrum.hpp"

namespace robomill::serve {
namespace {

constexpr double window_s = 0.1, highest_hz = 10e3;
constexpr long shortest_window = 32;

/// Lines 1 … last in bands that are a line wide, or `share` of their place.
std::vector<Eigen::Index> bands_of(Eigen::Index last, double share) {
  std::vector<Eigen::Index> first;
  for (Eigen::Index line = 1; line <= last;) {
    first.push_back(line);
    line += std::max<Eigen::Index>(1, static_cast<Eigen::Index>(share * static_cast<double>(line)));
  }
  first.push_back(last + 1);
  return first;
}

}  // namespace

LiveSpectrum::LiveSpectrum(const monitor::MonitorOptions& options)
    : sample_rate_hz_(options.sample_rate_hz), channels_(static_cast<std::size_t>(options.channels)) {
  for (int channel = 0; channel < options.channels && shown_.size() < most_channels; ++channel) {
    if (channel != options.tachometer_channel) shown_.push_back(static_cast<std::size_t>(channel));
  }
  const Eigen::Index length = std::max(2 * std::lround(window_s * sample_rate_hz_ / 2.0), shortest_window);
  window_.assign(shown_.size(), Eigen::VectorXd::Zero(length));
  const double line_hz = sample_rate_hz_ / static_cast<double>(length);
  const auto last = std::min(length / 2, static_cast<Eigen::Index>(highest_hz / line_hz));
  for (double share = 0.0; first_line_.empty() || first_line_.size() > most_bands + 1; share += 1.0 / 1024.0) {
    first_line_ = bands_of(last, share);
  }
  for (const Eigen::Index line : first_line_) edges_hz_.push_back((static_cast<double>(line) - 0.5) * line_hz);
}

void LiveSpectrum::add(std::span<const float> samples) {
  if (shown_.empty()) return;
  const Eigen::Index length = window_.front().size();
  for (; samples.size() >= channels_; samples = samples.subspan(channels_)) {
    for (std::size_t i = 0; i < shown_.size(); ++i) {
      const float sample = samples[shown_[i]];
      window_[i](filled_) = std::isfinite(sample) ? static_cast<double>(sample) : 0.0;
    }
    if (++filled_ == length) transform();
  }
}

void LiveSpectrum::transform() {
  const Eigen::Index half = window_.front().size() / 2;
  const std::size_t bands = first_line_.size() - 1;
  strongest_.resize(bands, 0.0F);
  for (Eigen::VectorXd& window : window_) {
    const Eigen::VectorXd amplitude = signal::amplitude_spectrum(window, sample_rate_hz_).amplitude;
    for (std::size_t band = 0; band < bands; ++band) {
      const double highest = amplitude.segment(first_line_[band], first_line_[band + 1] - first_line_[band]).maxCoeff();
      strongest_[band] = std::max(strongest_[band], static_cast<float>(highest));
    }
    window.head(half) = window.tail(half).eval();
  }
  filled_ = half;
}

std::vector<float> LiveSpectrum::take() {
  return std::exchange(strongest_, {});
}

}  // namespace robomill::serve
