#include "robomill/monitor/entropy.hpp"

#include <algorithm>
#include <cmath>

namespace robomill::monitor {
namespace {

Eigen::Index even_window(const MonitorOptions& options) {
  options.validate();
  const auto samples = static_cast<Eigen::Index>(options.window_samples());
  return samples + samples % 2;
}

signal::SynchrosqueezeStream stream_of(const MonitorOptions& options) {
  return signal::SynchrosqueezeStream({.sample_rate_hz = options.sample_rate_hz, .window_length = even_window(options)},
                                      signal::equal_bands(options.sample_rate_hz, options.bands));
}

}  // namespace

double energy_entropy(std::span<const double> energies, Entropy entropy) noexcept {
  double whole = 0.0;
  for (const double e : energies) whole += e;
  if (!(whole > 0.0)) return 0.0;
  double sum = 0.0;
  for (const double e : energies) {
    if (e > 0.0) sum -= e / whole * std::log(e / whole);
  }
  return entropy == Entropy::normalised ? sum : whole * sum;
}

EnergyEntropy::EnergyEntropy(const MonitorOptions& options)
    : entropy_(options.entropy),
      columns_(static_cast<std::size_t>(even_window(options))),
      stream_(stream_of(options)),
      signals_(columns_ * stream_.bands()),
      energies_(stream_.bands()) {}

double EnergyEntropy::push(std::span<const double> samples) noexcept {
  const std::size_t bands = energies_.size();
  while (!samples.empty()) {
    const std::span<double> room = std::span(signals_).subspan(oldest_ * bands);
    const auto done = stream_.push(samples, room);
    samples = samples.subspan(done.samples);
    oldest_ = (oldest_ + done.columns) % columns_;
  }
  std::fill(energies_.begin(), energies_.end(), 0.0);
  for (std::size_t column = 0; column < columns_; ++column) {
    // From the oldest on, so that the same samples give the same bits wherever they lie in the store.
    const double* values = signals_.data() + (oldest_ + column) % columns_ * bands;
    for (std::size_t b = 0; b < bands; ++b) energies_[b] += values[b] * values[b];
  }
  for (double& energy : energies_) energy /= static_cast<double>(columns_);
  return energy_entropy(energies_, entropy_);
}

void EnergyEntropy::reset() noexcept {
  stream_.reset();
  std::fill(signals_.begin(), signals_.end(), 0.0);
  std::fill(energies_.begin(), energies_.end(), 0.0);
  oldest_ = 0;
}

}  // namespace robomill::monitor
