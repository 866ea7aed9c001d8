#include "robomill/signal/synchrosqueeze_engine.hpp"

#include <algorithm>

namespace robomill::signal {
SynchrosqueezeStream::SynchrosqueezeStream(const SynchrosqueezeOptions& options, const Eigen::VectorXd& edges_hz) {
  options.validate();
  engine_ = std::make_unique<SynchrosqueezeEngine>(options, edges_hz);
}
SynchrosqueezeStream::~SynchrosqueezeStream() = default;
SynchrosqueezeStream::SynchrosqueezeStream(SynchrosqueezeStream&& other) noexcept = default;
SynchrosqueezeStream& SynchrosqueezeStream::operator=(SynchrosqueezeStream&& other) noexcept = default;

bool SynchrosqueezeStream::push(double sample) noexcept {
  return engine_->push(sample);
}
SynchrosqueezeStream::Progress SynchrosqueezeStream::push(std::span<const double> samples,
                                                          std::span<double> band_signals) noexcept {
  Progress done;
  std::size_t room = engine_->bands == 0 ? samples.size() : band_signals.size() / engine_->bands;
  for (const double sample : samples) {
    if (room == 0 && engine_->next == 1) break;
    ++done.samples;
    if (!engine_->push(sample)) continue;
    std::copy(engine_->band_values.begin(), engine_->band_values.end(),
              band_signals.data() + done.columns * engine_->bands);
    ++done.columns;
    --room;
  }
  return done;
}

std::uint64_t SynchrosqueezeStream::centre() const noexcept {
  return engine_->centre;
}
std::span<const double> SynchrosqueezeStream::band_values() const noexcept {
  return engine_->band_values;
}
void SynchrosqueezeStream::squeezed(std::span<std::complex<double>> out) const noexcept {
  engine_->squeezed(out.data());
}
std::size_t SynchrosqueezeStream::bands() const noexcept {
  return engine_->bands;
}
std::size_t SynchrosqueezeStream::lines() const noexcept {
  return engine_->lines;
}
void SynchrosqueezeStream::reset() noexcept {
  engine_->reset();
}

}  // namespace robomill::signal
