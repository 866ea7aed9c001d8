#include "robomill/monitor/comb_cusum/comb_cusum.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "robomill/base/units.hpp"

namespace robomill::monitor {
namespace {

constexpr double drift_hz = 3.0;        // corner of the high-pass
constexpr double jump = 4.0;            // of the power: the tool enters or leaves
constexpr std::size_t entry_lasts = 8;  // hops
constexpr std::size_t steady_hops = 2;  // of a line where there is no comb
constexpr double longest_look_s = 0.3;  // for the frequency
constexpr double falling = 0.85;        // of the power to that of the hop before
constexpr double falling_fast = 0.75;   // of half a hop's power to that of the halves before
constexpr double least_share = 0.0025;  // of the whole power, below which no line counts
constexpr double comb_share = 0.1;      // of the whole power, above which the comb is asked whether it follows
constexpr double follows = 0.6;         // of the comb, in the signal

signal::SynchrosqueezeOptions transform_of(const MonitorOptions& o, std::size_t columns_a_hop) {
  signal::SynchrosqueezeOptions out;
  out.sample_rate_hz = o.sample_rate_hz;
  out.window_length = static_cast<Eigen::Index>(o.window_samples() / 2 * 2);
  out.hop = static_cast<Eigen::Index>(std::max<std::size_t>(1, o.hop_samples() / columns_a_hop));
  return out;
}

}  // namespace

CombCusum::CombCusum(const MonitorOptions& options)
    : options_(options),
      channels_(static_cast<std::size_t>(options.channels)),
      frames_(options.hop_samples()),
      lines_(static_cast<std::size_t>(transform_of(options, columns_a_hop).lines())),
      tachometer_(options.tachometer_channel < 0 ? channels_ : static_cast<std::size_t>(options.tachometer_channel)),
      spindle_(options),
      comb_(options, spindle_.shortest_past(), spindle_.longest_past()),
      lines_test_({.lines = lines_,
                   .channels = channels_,
                   .hop_s = options.hop_s,
                   .false_alarms_per_hour = options.false_alarms_per_hour}),
      past_(spindle_.longest_past() + frames_),
      input_(channels_ * frames_),
      residual_(channels_ * frames_),
      mean_(channels_),
      lags_(comb_.max_harmonics()),
      column_(lines_),
      energy_(lines_ * channels_),
      taken_(lines_ * channels_),
      power_(channels_),
      left_power_(channels_),
      late_half_(channels_),
      falls_(std::make_unique<bool[]>(channels_)),
      history_(kept * lines_, -1e9) {
  for (std::size_t c = 0; c < channels_; ++c) {
    streams_.emplace_back(transform_of(options, columns_a_hop),
                          signal::equal_bands(options.sample_rate_hz, options.bands));
    rings_.emplace_back(options.sample_rate_hz, longest_look_s);
  }
  band_power_.resize(channels_ * static_cast<std::size_t>(options.bands));
  reset();
}

void CombCusum::set_spindle_speed(double rad_per_s) noexcept {
  spindle_.set_hint(rad_per_s / units::revolution);
}

void CombCusum::reset() noexcept {
  spindle_.reset();
  comb_.reset();
  for (auto& stream : streams_) stream.reset();
  for (FrequencyRing& ring : rings_) ring.reset();
  lines_test_.relearn();
  for (auto* store : {&mean_, &left_power_, &late_half_}) std::fill(store->begin(), store->end(), 0.0);
  std::fill(history_.begin(), history_.end(), -1e9);
  slow_power_ = power_before_ = 0.0;
  entry_hops_ = jumps_ = broad_ = calm_ = steady_ = still_bad_ = 0;
  hops_ = bad_ = 0;
  narrowband_.reset();
  line_ = channel_ = 0;
  state_ = State::stable;
  found_ = {};
}

void CombCusum::take_in(const Hop& hop) noexcept {
  const double share = 1.0 - std::exp(-units::revolution * drift_hz / options_.sample_rate_hz);
  double total = 0.0;
  std::uint64_t bad = hop.bad_channels;
  if (tachometer_ < channels_) bad |= std::uint64_t{1} << tachometer_;
  // What a bad channel leaves in the window of the transform must be out of it again.
  still_bad_ = (bad_ & ~bad) != 0 && still_bad_ == 0 ? 4 : still_bad_ > 0 ? still_bad_ - 1 : 0;
  const std::uint64_t before = std::exchange(bad_, still_bad_ > 0 ? bad_ | bad : bad);
  // Of a channel that was left out, comb and baselines are of long ago.
  if ((before & ~bad_) != 0) learn_anew();
  for (std::size_t c = 0; c < channels_; ++c) {
    const auto from = hop.channel(c);
    if ((bad_ >> c & 1U) != 0) {
      std::fill_n(input_.begin() + static_cast<std::ptrdiff_t>(c * frames_), frames_, 0.0F);
      power_[c] = 0.0;
      continue;
    }
    if (hops_ == 1 || (before >> c & 1U) != 0) {
      mean_[c] = 0.0;
      for (const double x : from) mean_[c] += x / static_cast<double>(frames_);
    }
    double sum = 0.0;
    for (std::size_t i = 0; i < frames_; ++i) {
      mean_[c] += share * (from[i] - mean_[c]);
      const double x = from[i] - mean_[c];
      input_[c * frames_ + i] = static_cast<float>(x);
      sum += x * x;
    }
    power_[c] = sum / static_cast<double>(frames_);
    total += power_[c];
  }
  // Without a comb, what comes with the tool's entry cannot be distinguished from chatter until the speed is found.
  const double change = slow_power_ > 0.0 ? total / slow_power_ : 1.0;
  jumps_ = change > jump || change < 1.0 / jump ? jumps_ + 1 : 0;
  entry_hops_ = change > jump ? entry_lasts : entry_hops_ > 0 ? entry_hops_ - 1 : 0;
  if (jumps_ == 0) slow_power_ += 0.1 * (total - slow_power_);
  if (hops_ == 1) slow_power_ = total;
  if (jumps_ == 1) spindle_.jumped();
  if (jumps_ >= 2) slow_power_ = total;
  if (jumps_ == 2 && change < 1.0 && spindle_.rotation_hz() > 0.0 && state_ != State::chatter) lose();
}

// Whether what the comb leaves, or where there is none the signal itself, is what the baselines are of.
bool CombCusum::trusted() const noexcept {
  return spindle_.settled() && (spindle_.rotation_hz() == 0.0 || comb_.settled());
}

void CombCusum::lose() noexcept {
  spindle_.lose();
  lines_test_.relearn();
}

void CombCusum::take_up(const SpindleTracker::Change& change) noexcept {
  if (change.past > 0) replay(change.past);
  if (change.relearn) lines_test_.relearn();
}

bool CombCusum::speed_holds() noexcept {
  if (tachometer_ < channels_) return true;
  const SpindleTracker::Change change = spindle_.check();
  take_up(change);
  if (change.locked) return false;
  // Without a comb only a steady line counts.
  return spindle_.rotation_hz() > 0.0 || narrowband_.begun() || steady_ >= steady_hops;
}

// The comb, learnt anew at the speed now followed from so many samples.
void CombCusum::replay(std::size_t samples) noexcept {
  for (std::size_t c = 0; c < channels_; ++c) {
    // What is in the ring ends with this hop, which comb() is still to do.
    const std::span past = std::span(past_).first(samples + frames_);
    spindle_.last(c, past);
    const std::span<const float> left = comb_.learn(c, past.first(samples), spindle_.rotation_hz());
    rings_[c].push(left);
    streams_[c].reset();
    for (const float x : left.last(std::min(left.size(), 2 * (lines_ - 1)))) streams_[c].push(static_cast<double>(x));
  }
}

void CombCusum::comb() noexcept {
  const bool chatters = state_ == State::chatter;
  spindle_.correct(comb_.run({.samples = input_,
                              .bad_channels = bad_,
                              .rotation_hz = spindle_.rotation_hz(),
                              .learns = !chatters,
                              .steers = !chatters},
                             residual_));
  double before = 0.0;
  double after = 0.0;
  for (std::size_t i = 0; i < input_.size(); ++i) {
    before += static_cast<double>(input_[i] * input_[i]);
    after += static_cast<double>(residual_[i] * residual_[i]);
  }
  if (after > 1.2 * before && !chatters && jumps_ > 0) {
    // The tool has left the cut.
    std::copy(input_.begin(), input_.end(), residual_.begin());
    learn_anew();
  }
}

// What the comb lags behind by is no chatter.
void CombCusum::take_lags() noexcept {
  const double n = static_cast<double>(2 * (lines_ - 1));
  for (std::size_t c = 0; c < channels_; ++c) {
    comb_.lags(c, power_[c], state_ != State::chatter, lags_);
    for (std::size_t k = 1; k <= comb_.harmonics(); ++k) {
      if (lags_[k - 1] == 0.0) continue;
      const auto at =
          static_cast<std::size_t>(std::lround(static_cast<double>(k) * spindle_.rotation_hz() / line_hz(1)));
      const double energy = 2.5 * columns_a_hop * lags_[k - 1] * n * n;
      for (std::size_t l = at > 3 ? at - 3 : 0; l <= std::min(at + 3, lines_ - 1); ++l)
        taken_[c * lines_ + l] += energy;
    }
  }
}

void CombCusum::learn_anew() noexcept {
  comb_.forget();
  lines_test_.relearn();
}

void CombCusum::squeeze() noexcept {
  std::fill(energy_.begin(), energy_.end(), 0.0);
  std::fill(band_power_.begin(), band_power_.end(), 0.0);
  const auto bands = static_cast<std::size_t>(options_.bands);
  const double n = static_cast<double>(2 * (lines_ - 1));
  for (std::size_t c = 0; c < channels_; ++c) {
    double* energy = energy_.data() + c * lines_;
    for (std::size_t i = 0; i < frames_; ++i) {
      if (!streams_[c].push(static_cast<double>(residual_[c * frames_ + i]))) continue;
      streams_[c].squeezed(column_);
      for (std::size_t k = 0; k < lines_; ++k) {
        const std::size_t band = std::min(bands - 1, k * bands / (lines_ - 1));
        band_power_[c * bands + band] += 0.5 * std::norm(column_[k]) / (n * n * static_cast<double>(columns_a_hop));
      }
      for (std::size_t k = 1; k + 1 < lines_; ++k) {
        energy[k] += std::norm(column_[k - 1]) + std::norm(column_[k]) + std::norm(column_[k + 1]);
      }
    }
  }
}

void CombCusum::leave_power() noexcept {
  const double n = static_cast<double>(frames_);
  away_ = 0;
  for (std::size_t c = 0; c < channels_; ++c) {
    const std::span<const float> left = std::span(residual_).subspan(c * frames_, frames_);
    rings_[c].push(left);
    const auto squares = [](std::span<const float> of) {
      return std::accumulate(of.begin(), of.end(), 0.0,
                             [](double sum, float x) { return sum + static_cast<double>(x * x); });
    };
    const double early = squares(left.first(frames_ / 2)) / n;
    const double late = squares(left.subspan(frames_ / 2)) / n;
    const bool away = comb_known() && !comb_follows(c);
    if (away) ++away_;
    falls_[c] = early + late < falling * left_power_[c] || late < falling_fast * std::max(early, late_half_[c]) || away;
    left_power_[c] = early + late;
    late_half_[c] = late;
  }
}

// Where the tool leaves or the speed runs away, the signal holds less of the comb than the comb predicts: the residual
// is the comb's own. Chatter comes on top of it.
bool CombCusum::comb_follows(std::size_t channel) const noexcept {
  double own = 0.0;
  double found = 0.0;
  for (std::size_t i = channel * frames_; i < (channel + 1) * frames_; ++i) {
    const double periodic = static_cast<double>(input_[i] - residual_[i]);
    own += periodic * periodic;
    found += periodic * static_cast<double>(input_[i]);
  }
  return own < comb_share * static_cast<double>(frames_) * power_[channel] || found > follows * own;
}

void CombCusum::decide(const Hop& hop, Decision& decision) noexcept {
  ++hops_;
  take_in(hop);
  comb_.begin_hop();
  take_up(spindle_.step(input_, hop.measured_rotation_hz, state_ == State::chatter));
  if (spindle_.rotation_hz() > 0.0) {
    comb();
  } else {
    std::copy(input_.begin(), input_.end(), residual_.begin());
    decision.faults |= speed_unknown;
  }
  leave_power();
  squeeze();
  // What is so small beside the whole marks no part.
  for (std::size_t c = 0; c < channels_; ++c) {
    std::fill_n(taken_.begin() + static_cast<std::ptrdiff_t>(c * lines_), lines_,
                energy_of_power() * least_share * power_[c]);
  }
  if (spindle_.rotation_hz() > 0.0) take_lags();
  judge(decision);
  report_bands(decision);
  decision.suggested_sample_rate_hz = spindle_.suggested_sample_rate_hz();
  if (decision.suggested_sample_rate_hz > 0.0) decision.faults |= wrong_sample_rate;
  decision.spindle_speed_rad_per_s = units::revolution * spindle_.rotation_hz();
}

void CombCusum::report_bands(Decision& decision) const noexcept {
  const auto bands = static_cast<std::size_t>(options_.bands);
  decision.bands = options_.bands;
  for (std::size_t c = 0; c < channels_; ++c) {
    const std::span<const double> power = std::span(band_power_).subspan(c * bands, bands);
    decision.energy_entropy += energy_entropy(power, options_.entropy);
    for (std::size_t b = 0; b < bands; ++b) decision.band_level.at(b) += static_cast<float>(power[b]);
  }
  for (std::size_t b = 0; b < bands; ++b) decision.band_level.at(b) = std::sqrt(decision.band_level.at(b));
}

}  // namespace robomill::monitor
