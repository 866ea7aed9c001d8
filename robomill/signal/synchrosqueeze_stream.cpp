#include "robomill/signal/synchrosqueeze_engine.hpp"

#include <algorithm>

namespace robomill::signal {
namespace {

template <class Sample>
SynchrosqueezeStream::Progress push_block(SynchrosqueezeEngine& engine, std::span<const Sample> samples,
                                          std::span<double> out) noexcept {
  SynchrosqueezeStream::Progress done;
  std::size_t room = engine.bands == 0 ? samples.size() : out.size() / engine.bands;
  for (const Sample sample : samples) {
    if (room == 0 && engine.next == 1) break;
    ++done.samples;
    if (!engine.push(static_cast<double>(sample))) continue;
    std::copy(engine.band_values.begin(), engine.band_values.end(), out.data() + done.columns * engine.bands);
    ++done.columns;
    --room;
  }
  return done;
}

}  // namespace

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
SynchrosqueezeStream::Progress SynchrosqueezeStream::push(std::span<const float> samples,
                                                          std::span<double> band_signals) noexcept {
  return push_block(*engine_, samples, band_signals);
}
SynchrosqueezeStream::Progress SynchrosqueezeStream::push(std::span<const double> samples,
                                                          std::span<double> band_signals) noexcept {
  return push_block(*engine_, samples, band_signals);
}

std::uint64_t SynchrosqueezeStream::centre() const noexcept {
  return engine_->centre;
}
std::span<const double> SynchrosqueezeStream::band_values() const noexcept {
  return engine_->band_values;
}
void SynchrosqueezeStream::transform(std::span<std::complex<double>> out) const noexcept {
  engine_->transform(out.data());
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
std::size_t SynchrosqueezeStream::latency() const noexcept {
  return engine_->n / 2 - 1;
}
void SynchrosqueezeStream::reset() noexcept {
  engine_->reset();
}

}  // namespace robomill::signal
