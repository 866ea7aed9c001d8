#include "robomill/monitor/published/entropy_detector.hpp"

#include <algorithm>
#include <cmath>

namespace robomill::monitor {

EntropyDetector::EntropyDetector(const MonitorOptions& options)
    : options_(options), spindle_speed_rad_per_s_(options.spindle_speed_rad_per_s) {
  for (int c = 0; c < options.channels; ++c) channels_.emplace_back(options);
  warm_up_ = channels_.front().warm_up();
}

void EntropyDetector::reset() noexcept {
  for (EnergyEntropy& channel : channels_) channel.reset();
  seen_ = 0;
  state_ = State::stable;
}

void EntropyDetector::decide(const Hop& hop, Decision& decision) noexcept {
  const auto bands = static_cast<std::size_t>(options_.bands);
  double loudest = -1.0;
  decision.bands = options_.bands;
  for (std::size_t c = 0; c < channels_.size(); ++c) {
    const double entropy = channels_[c].push(hop.channel(c));
    if (static_cast<int>(c) == options_.tachometer_channel || (hop.bad_channels >> c & 1U) != 0) continue;
    decision.energy_entropy += entropy;
    double sum = 0.0;
    for (std::size_t b = 0; b < bands; ++b) {
      sum += channels_[c].energies()[b];
      decision.band_level.at(b) += static_cast<float>(channels_[c].energies()[b]);
    }
    if (sum > loudest) {
      loudest = sum;
      decision.channel = static_cast<int>(c);
    }
  }
  for (std::size_t b = 0; b < bands; ++b) decision.band_level.at(b) = std::sqrt(decision.band_level.at(b));
  seen_ += hop.frames;
  decision.score = decision.energy_entropy;
  decision.threshold = options_.threshold;
  const bool nothing_begins = hop.still && state_ != State::chatter;
  const bool beyond = seen_ >= warm_up_ && (options_.alarm_below ? decision.score < options_.threshold
                                                                 : decision.score > options_.threshold);
  state_ = beyond && !nothing_begins ? State::chatter : state_ == State::chatter ? State::transition : State::stable;
  decision.state = state_;
  if (hop.still) {
    decision.reason = BlindReason::standstill;
  } else {
    decision.spindle_speed_rad_per_s = spindle_speed_rad_per_s_;
  }
}

}  // namespace robomill::monitor
