#include "robomill/modal/impact/hit_trigger.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "robomill/base/error.hpp"

namespace robomill::modal {
namespace {

constexpr double stretch_s = 5e-3, pre_share = 0.05;
constexpr double hold_off_s = 0.5;  ///< after a trigger without another, at least; never shorter than the record
constexpr std::size_t fewest_stretch_frames = 16, fewest_pre_frames = 256;
/// Of the noise's standard deviation; a hit below it is rejected in any case.
constexpr double noise_factor = 10.0;
constexpr double excursion_factor = 2.0;
/// Of the last hit's peak, at first and then halved again and again: who handles the hammer makes no record.
constexpr double peak_share = 0.05, peak_half_life_s = 10.0;

std::size_t frames_of(double seconds, double rate_hz) {
  return static_cast<std::size_t>(std::llround(seconds * rate_hz));
}

/// Of the first `count`; the upper of the two in the middle.
template <std::size_t n>
double middle(std::array<double, n> values, std::size_t count) {
  const auto begin = values.begin();
  const auto at = begin + static_cast<std::ptrdiff_t>(count / 2);
  std::nth_element(begin, at, begin + static_cast<std::ptrdiff_t>(count));
  return *at;
}

}  // namespace

void HitTriggerOptions::validate() const {
  constexpr double fastest_hz = 1e7, longest_s = 1e3;
  if (!(sample_rate_hz > 0.0 && sample_rate_hz <= fastest_hz)) {
    throw InvalidInput("sample_rate_hz", sample_rate_hz, "Hz", "must be > 0 and at most 1e7");
  }
  if (channels < 1 || channels > 256) throw InvalidInput("channels", channels, "", "must lie between 1 and 256");
  if (force_channel < 0 || force_channel >= channels) {
    throw InvalidInput("force_channel", force_channel, "", "must be one of the channels");
  }
  if (!std::isfinite(force_factor) || force_factor == 0.0) {
    throw InvalidInput("force_factor", force_factor, "N", "must be finite and not 0");
  }
  if (!(level_n >= 0.0 && std::isfinite(level_n))) throw InvalidInput("level_n", level_n, "N", "must be >= 0");
  if (!(record_s > 0.0 && record_s <= longest_s)) {
    throw InvalidInput("record_s", record_s, "s", "must be > 0 and at most 1000");
  }
  if (record_frames() < fewest_frames) {
    throw InvalidInput("record_s", record_s, "s",
                       fmt::format("is {} samples; a record needs at least {}", record_frames(), fewest_frames),
                       "Make it longer, or frequency_resolution_hz finer");
  }
  if (record_frames() * static_cast<std::size_t>(channels) > most_values) {
    throw InvalidInput("record_s", record_s, "s",
                       fmt::format("is {} samples of {} channels; at most {} values may be in a record",
                                   record_frames(), channels, most_values),
                       "Make it shorter, or frequency_resolution_hz coarser");
  }
}

std::size_t HitTriggerOptions::record_frames() const {
  return frames_of(record_s, sample_rate_hz);
}

std::size_t HitTriggerOptions::pre_frames() const {
  const std::size_t share = frames_of(pre_share * record_s, sample_rate_hz);
  return std::min(std::max(share, fewest_pre_frames), record_frames() / 4);
}

HitTrigger::HitTrigger(const HitTriggerOptions& options, Calls calls) : options_(options), calls_(std::move(calls)) {
  options_.validate();
  channels_ = static_cast<std::size_t>(options_.channels);
  record_frames_ = options_.record_frames();
  pre_frames_ = options_.pre_frames();
  hold_off_frames_ = frames_of(hold_off_s, options_.sample_rate_hz);
  stretch_frames_ = std::max(fewest_stretch_frames, frames_of(stretch_s, options_.sample_rate_hz));
  before_.resize(pre_frames_ * channels_);
  record_.samples.reserve(record_frames_ * channels_);
}

double HitTrigger::level_n() const {
  return stretch_count_ < fewest_stretches ? std::numeric_limits<double>::quiet_NaN() : level_n_;
}

void HitTrigger::add(std::span<const float> samples) {
  for (std::size_t at = 0; at + channels_ <= samples.size(); at += channels_) take(samples.data() + at);
}

void HitTrigger::gap(std::uint64_t frames) {
  if (frames == 0) return;
  if (recording_) discard();
  frame_ += frames;
  sound_since_ = frame_;
  in_stretch_ = 0;
  beyond_ = false;
}

void HitTrigger::take(const float* frame) {
  if (!std::all_of(frame, frame + channels_, [](float value) { return std::isfinite(value); })) {
    gap(1);
    return;
  }
  const double force_n = options_.force_factor * static_cast<double>(frame[options_.force_channel]);
  const double excursion_n = std::abs(force_n - offset_n_);
  const bool was_beyond = std::exchange(beyond_, excursion_n > level_n());
  if (!recording_ && beyond_ && !was_beyond && frame_ >= held_until_) begin();
  if (recording_) {
    record_.samples.insert(record_.samples.end(), frame, frame + channels_);
    highest_n_ = std::max(highest_n_, excursion_n);
  } else if (frame_ >= held_until_) {
    learn(force_n);
  }
  std::copy_n(frame, channels_, before_.begin() + static_cast<std::ptrdiff_t>(frame_ % pre_frames_ * channels_));
  ++frame_;
  if (recording_ && record_.samples.size() == record_frames_ * channels_) end();
}

/// Sums about the stretch's first value: an offset far above the noise loses no digits.
void HitTrigger::learn(double force_n) {
  if (in_stretch_ == 0) {
    origin_n_ = low_n_ = high_n_ = force_n;
    sum_n_ = squares_n2_ = 0.0;
  }
  const double from_origin_n = force_n - origin_n_;
  sum_n_ += from_origin_n;
  squares_n2_ += from_origin_n * from_origin_n;
  low_n_ = std::min(low_n_, force_n);
  high_n_ = std::max(high_n_, force_n);
  if (++in_stretch_ == stretch_frames_) end_stretch();
}

void HitTrigger::end_stretch() {
  const double count = static_cast<double>(in_stretch_);
  const double mean_n = sum_n_ / count;
  const std::size_t at = stretch_count_ % stretches;
  means_n_[at] = origin_n_ + mean_n;
  deviations_n_[at] = std::sqrt(std::max(0.0, squares_n2_ / count - mean_n * mean_n));
  excursions_n_[at] = std::max(high_n_ - means_n_[at], means_n_[at] - low_n_);
  ++stretch_count_;
  in_stretch_ = 0;
  const std::size_t known = std::min(stretch_count_, stretches);
  offset_n_ = middle(means_n_, known);
  if (options_.level_n > 0.0) {
    level_n_ = options_.level_n;
    return;
  }
  const double since_s = (static_cast<double>(frame_) - last_frame_) / options_.sample_rate_hz;
  level_n_ = std::max({noise_factor * middle(deviations_n_, known),
                       excursion_factor * *std::max_element(excursions_n_.begin(), excursions_n_.end()),
                       peak_share * last_peak_n_ * std::exp2(-since_s / peak_half_life_s)});
}

void HitTrigger::begin() {
  record_.trigger_frame = frame_;
  record_.first_frame = frame_ - std::min<std::uint64_t>(frame_, pre_frames_);
  record_.samples.clear();
  held_until_ = frame_ + hold_off_frames_;
  highest_n_ = 0.0;
  in_stretch_ = 0;
  if (calls_.triggered) calls_.triggered();
  if (frame_ - sound_since_ < pre_frames_) {
    discard();
    return;
  }
  recording_ = true;
  const auto split = before_.begin() + static_cast<std::ptrdiff_t>(frame_ % pre_frames_ * channels_);
  record_.samples.insert(record_.samples.end(), split, before_.end());
  record_.samples.insert(record_.samples.end(), before_.begin(), split);
}

void HitTrigger::end() {
  recording_ = false;
  last_peak_n_ = highest_n_;
  last_frame_ = static_cast<double>(record_.trigger_frame);
  if (options_.level_n <= 0.0) level_n_ = std::max(level_n_, peak_share * last_peak_n_);
  if (calls_.record) calls_.record(record_);
}

void HitTrigger::discard() {
  recording_ = false;
  record_.samples.clear();
  if (calls_.discarded) calls_.discarded(record_);
}

}  // namespace robomill::modal
