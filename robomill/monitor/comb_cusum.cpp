#include "robomill/monitor/comb_cusum.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

namespace robomill::monitor {
namespace {

constexpr double turn = 2.0 * std::numbers::pi;
constexpr double drift_hz = 3.0;        // corner of the high-pass
constexpr double comb_s = 0.25;         // memory of the comb
constexpr double jump = 4.0;            // of the power: the tool enters or leaves
constexpr std::size_t entry_lasts = 8;  // hops
constexpr std::size_t steady_hops = 2;  // of a tone where there is no comb
constexpr std::size_t coherent = 3;     // hops in which a part of the residual stays in phase with the spindle
constexpr double longest_look_s = 0.3;  // for the frequency
constexpr double falling = 0.85;        // of the power to that of the hop before
constexpr double falling_fast = 0.75;   // of half a hop's power to that of the halves before
constexpr double least_share = 0.0025;  // of the whole power, below which no line counts
constexpr double comb_share = 0.1;      // of the whole power, above which the comb is asked whether it follows
constexpr double follows = 0.6;         // of the comb, in the signal
constexpr double settle_s = 0.06;       // of the comb, and settle_turns
constexpr double angle_unrest = 0.01;   // of the angle in a block [rad]

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
      block_(std::max<std::size_t>(8, frames_ / 4)),
      lines_(static_cast<std::size_t>(transform_of(options, columns_a_hop).lines())),
      tachometer_(options.tachometer_channel < 0 ? channels_ : static_cast<std::size_t>(options.tachometer_channel)),
      spindle_(options),
      lines_test_({.lines = lines_,
                   .channels = channels_,
                   .hop_s = options.hop_s,
                   .false_alarms_per_hour = options.false_alarms_per_hour}),
      past_(spindle_.longest_past() + frames_),
      past_residual_(past_.size()),
      input_(channels_ * frames_),
      residual_(channels_ * frames_),
      mean_(channels_),
      rms_(channels_),
      column_(lines_),
      energy_(lines_ * channels_),
      taken_(lines_ * channels_),
      power_(channels_),
      left_power_(channels_),
      late_half_(channels_),
      falls_(std::make_unique<bool[]>(channels_)),
      history_(kept * lines_, -1e9),
      hidden_harmonics_(most_harmonics, options.teeth) {
  const auto most =
      std::min(most_harmonics, static_cast<std::size_t>(0.5 * options.sample_rate_hz / SpindleTracker::lowest_hz));
  for (std::size_t c = 0; c < channels_; ++c) {
    combs_.emplace_back(most);
    streams_.emplace_back(transform_of(options, columns_a_hop),
                          signal::equal_bands(options.sample_rate_hz, options.bands));
    rings_.emplace_back(options.sample_rate_hz, longest_look_s);
  }
  innovation_.resize(channels_ * coherent * most);
  band_power_.resize(channels_ * static_cast<std::size_t>(options.bands));
  reset();
}

void CombCusum::set_spindle_speed(double rad_per_s) noexcept {
  spindle_.set_hint(rad_per_s / turn);
}

void CombCusum::reset() noexcept {
  spindle_.reset();
  for (Comb& each : combs_) each.reset();
  for (auto& stream : streams_) stream.reset();
  for (FrequencyRing& ring : rings_) ring.reset();
  lines_test_.relearn();
  for (auto* store : {&mean_, &rms_, &left_power_, &late_half_}) std::fill(store->begin(), store->end(), 0.0);
  std::fill(history_.begin(), history_.end(), -1e9);
  std::fill(innovation_.begin(), innovation_.end(), 0.0);
  angle_ = revolutions_ = learnt_s_ = slow_power_ = power_before_ = 0.0;
  entry_hops_ = jumps_ = broad_ = calm_ = steady_ = still_bad_ = 0;
  hops_ = bad_ = 0;
  tone_.reset();
  spill_.reset();
  hidden_harmonics_.reset();
  line_ = channel_ = 0;
  state_ = State::stable;
  hidden_ = Hidden::none;
  found_ = {};
}

void CombCusum::take_in(const Hop& hop) noexcept {
  const double share = 1.0 - std::exp(-turn * drift_hz / options_.sample_rate_hz);
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
  // Without a comb, what comes with the tool's entry cannot be told from chatter until the speed is found.
  const double change = slow_power_ > 0.0 ? total / slow_power_ : 1.0;
  jumps_ = change > jump || change < 1.0 / jump ? jumps_ + 1 : 0;
  entry_hops_ = change > jump ? entry_lasts : entry_hops_ > 0 ? entry_hops_ - 1 : 0;
  if (jumps_ == 0) slow_power_ += 0.1 * (total - slow_power_);
  if (hops_ == 1) slow_power_ = total;
  if (jumps_ == 1) spindle_.jumped();
  if (jumps_ >= 2) slow_power_ = total;
  if (jumps_ == 2 && change < 1.0 && spindle_.rotation_hz() > 0.0 && state_ != State::chatter) lose();
}

// Of the comb and of what it leaves.
bool CombCusum::trusted() const noexcept {
  if (!spindle_.settled()) return false;
  return spindle_.rotation_hz() == 0.0 || (revolutions_ >= settle_turns && learnt_s_ >= settle_s);
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
  // Without a comb only a steady tone counts.
  return spindle_.rotation_hz() > 0.0 || tone_.begun() || steady_ >= steady_hops;
}

// The comb, learnt anew from so many samples at the speed now followed.
void CombCusum::replay(std::size_t samples) noexcept {
  const std::size_t count = samples / block_ * block_;
  const double step = turn * spindle_.rotation_hz() / options_.sample_rate_hz;
  const double per_turn = options_.sample_rate_hz / spindle_.rotation_hz();
  const double n = static_cast<double>(block_);
  std::fill(innovation_.begin(), innovation_.end(), 0.0);
  for (std::size_t c = 0; c < channels_; ++c) {
    combs_[c].reset();
    combs_[c].set_harmonics(static_cast<std::size_t>(0.49 * options_.sample_rate_hz / spindle_.rotation_hz()));
    const std::span past = std::span(past_).subspan(0, count + frames_);
    // What is in the ring ends with this hop, which comb() is still to do.
    spindle_.last(c, past);
    const std::span left = std::span(past_residual_).subspan(0, count);
    // Twice, so that the beginning is foretold as well as the end.
    for (int pass = 0; pass < 2; ++pass) {
      double angle = 0.0;
      double turns = pass == 0 ? 0.0 : static_cast<double>(count) / per_turn;
      for (std::size_t at = 0; at < count; at += block_, angle += step * n, turns += n / per_turn) {
        combs_[c].run(past.subspan(at, block_), left.subspan(at, block_), angle, step,
                      std::min(1.0, n / per_turn / (1.0 + turns)), 1e30);
      }
      angle_ = std::fmod(angle, turn);
      revolutions_ = static_cast<double>(count) / per_turn;
    }
    double sum = 0.0;
    for (const float x : left) sum += static_cast<double>(x * x);
    rms_[c] = std::sqrt(sum / static_cast<double>(count));
    streams_[c].reset();
    rings_[c].push(left);
    const std::size_t window = std::min(count, 2 * (lines_ - 1));
    for (const float x : left.subspan(count - window)) streams_[c].push(static_cast<double>(x));
  }
  learnt_s_ = static_cast<double>(count) / options_.sample_rate_hz;
}

void CombCusum::comb_block(std::size_t first, std::size_t count) noexcept {
  const double step = turn * spindle_.rotation_hz() / options_.sample_rate_hz;
  const double per_turn = options_.sample_rate_hz / spindle_.rotation_hz();
  const double n = static_cast<double>(count);
  const double steady = 1.0 - std::exp(-n / (comb_s * options_.sample_rate_hz));
  const double fast = std::min(1.0, n / per_turn / (1.0 + revolutions_));
  const double gain = state_ == State::chatter && hidden_ == Hidden::none ? 0.0 : std::max(steady, fast);
  for (std::size_t c = 0; c < channels_; ++c) {
    const std::size_t at = c * frames_ + first;
    if ((bad_ >> c & 1U) != 0) {
      std::fill_n(residual_.begin() + static_cast<std::ptrdiff_t>(at), count, 0.0F);
      continue;
    }
    const bool young = revolutions_ < settle_turns;
    combs_[c].run(std::span(input_).subspan(at, count), std::span(residual_).subspan(at, count), angle_, step, gain,
                  young ? 1e30 : 4.0 * rms_[c]);
    double sum = 0.0;
    for (std::size_t i = at; i < at + count; ++i) sum += static_cast<double>(residual_[i] * residual_[i]);
    const double now = std::sqrt(sum / n);
    rms_[c] += young ? 0.5 * (now - rms_[c]) : 0.03 * (std::min(now, 3.0 * rms_[c]) - rms_[c]);
    std::complex<double>* sums =
        innovation_.data() + (c * coherent + hops_ % coherent) * (innovation_.size() / channels_ / coherent);
    for (std::size_t k = 1; k <= combs_[c].harmonics(); ++k) {
      if (first == 0) sums[k - 1] = 0.0;
      sums[k - 1] += combs_[c].innovation(k) * (n / static_cast<double>(frames_));
    }
  }
  angle_ = std::fmod(angle_ + step * n, turn);
  revolutions_ += n / per_turn;
}

void CombCusum::follow_speed() noexcept {
  if (revolutions_ < 3.0) return;
  double moved = 0.0;
  double weight = 0.0;
  for (std::size_t c = 0; c < channels_; ++c) {
    const double noise = rms_[c] * rms_[c] + 1e-300;
    const double least = 4.0 * noise / static_cast<double>(block_);
    for (std::size_t k = 1; k <= combs_[c].harmonics(); ++k) {
      const std::complex<double> a = combs_[c].amplitude(k);
      if (std::norm(a) < least) continue;
      const double order = static_cast<double>(k);
      // r is a exp(i k δ) - a: what runs ahead has conj(a) g with a positive imaginary part.
      moved += order * (std::conj(a) * combs_[c].innovation(k)).imag() / noise;
      weight += order * order * std::norm(a) / noise;
    }
  }
  if (weight <= 0.0) return;
  // The angle's own unrest against the variance of what is measured.
  const double trust = 1.0 / (1.0 + 2.0 / (static_cast<double>(block_) * weight * angle_unrest * angle_unrest));
  const double ahead = trust * std::clamp(moved / weight, -0.2, 0.2);
  const double block_s = static_cast<double>(block_) / options_.sample_rate_hz;
  angle_ += 0.1 * ahead;
  if (state_ != State::chatter) spindle_.correct(0.005 * ahead / (turn * block_s));
}

void CombCusum::leftover() noexcept {
  const std::size_t most = innovation_.size() / channels_ / coherent;
  const double n = static_cast<double>(2 * (lines_ - 1));
  for (std::size_t c = 0; c < channels_; ++c) {
    const std::complex<double>* sums = innovation_.data() + c * coherent * most;
    // The mean of the last two or three hops, where they agree.
    const std::size_t now = hops_ % coherent;
    const auto steady = [&](std::size_t k) {
      const std::complex<double> last = sums[now * most + k - 1];
      const std::complex<double> before = sums[(now + 2) % coherent * most + k - 1];
      const std::complex<double> first = sums[(now + 1) % coherent * most + k - 1];
      const std::complex<double> two = 0.5 * (last + before);
      const std::complex<double> three = (last + before + first) / 3.0;
      const bool pair = std::norm(two) > 0.7 * 0.5 * (std::norm(last) + std::norm(before));
      const bool all = std::norm(three) > 0.5 * (std::norm(last) + std::norm(before) + std::norm(first)) / 3.0;
      return pair && std::norm(two) > std::norm(three) ? two : all ? three : std::complex<double>(0.0);
    };
    double lag = 0.0;
    double whole = 1e-300;
    for (std::size_t k = 1; k <= combs_[c].harmonics(); ++k) {
      const double own = std::norm(combs_[c].amplitude(k));
      lag += own * std::norm(steady(k));
      whole += own * own;
    }
    const double noise = 4.0 * rms_[c] * rms_[c] / static_cast<double>(frames_ * coherent);
    for (std::size_t k = 1; k <= combs_[c].harmonics(); ++k) {
      const std::complex<double> mean = steady(k);
      const double here = std::norm(mean);
      if (here <= 4.0 * noise) continue;
      const double own = std::norm(combs_[c].amplitude(k));
      const double likely = std::min(here, std::max(25.0 * lag / whole * own, 0.0003 * power_[c]));
      const auto at =
          static_cast<std::size_t>(std::lround(static_cast<double>(k) * spindle_.rotation_hz() / line_hz(1)));
      const double energy = 2.5 * columns_a_hop * likely * n * n;
      for (std::size_t l = at > 3 ? at - 3 : 0; l <= std::min(at + 3, lines_ - 1); ++l)
        taken_[c * lines_ + l] += energy;
      if (state_ == State::chatter) continue;
      const bool cutting = options_.teeth == 0 || k % static_cast<std::size_t>(options_.teeth) == 0;
      if (cutting || own > 0.5 * here) combs_[c].correct(k, 0.3 * std::sqrt(likely / here) * mean);
    }
  }
}

void CombCusum::comb() noexcept {
  for (std::size_t first = 0; first < frames_; first += block_) {
    comb_block(first, std::min(block_, frames_ - first));
    follow_speed();
  }
  double before = 0.0;
  double after = 0.0;
  for (std::size_t i = 0; i < input_.size(); ++i) {
    before += static_cast<double>(input_[i] * input_[i]);
    after += static_cast<double>(residual_[i] * residual_[i]);
  }
  if (after > 1.2 * before && state_ != State::chatter && jumps_ > 0) {
    // The tool has left the cut.
    std::copy(input_.begin(), input_.end(), residual_.begin());
    learn_anew();
  }
}

void CombCusum::learn_anew() noexcept {
  for (Comb& each : combs_) each.reset();
  std::fill(innovation_.begin(), innovation_.end(), 0.0);
  revolutions_ = learnt_s_ = 0.0;
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

// Where the tool leaves or the speed runs away, the signal holds less of the comb than the comb foretells: what is left
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
  learnt_s_ += options_.hop_s;
  const auto pulses = tachometer_ < channels_ ? hop.channel(tachometer_) : std::span<const double>();
  take_up(spindle_.step(input_, pulses, state_ == State::chatter));
  if (spindle_.rotation_hz() > 0.0) {
    comb();
  } else {
    std::copy(input_.begin(), input_.end(), residual_.begin());
    decision.faults |= speed_unknown;
  }
  leave_power();
  squeeze();
  // What is so small beside the whole marks no part.
  const double n = static_cast<double>(2 * (lines_ - 1));
  for (std::size_t c = 0; c < channels_; ++c) {
    std::fill_n(taken_.begin() + static_cast<std::ptrdiff_t>(c * lines_), lines_,
                2.0 * columns_a_hop * n * n * least_share * power_[c]);
  }
  if (spindle_.rotation_hz() > 0.0) leftover();
  judge(decision);
  tell_bands(decision);
  decision.suggested_sample_rate_hz = spindle_.suggested_sample_rate_hz();
  if (decision.suggested_sample_rate_hz > 0.0) decision.faults |= wrong_sample_rate;
  decision.spindle_speed_rad_per_s = turn * spindle_.rotation_hz();
}

void CombCusum::tell_bands(Decision& decision) const noexcept {
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
