#include "robomill/live/inputs.hpp"

#include <fmt/format.h>

#include <cmath>
#include <exception>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/monitor/files/stream_block.hpp"

namespace robomill::live {
namespace {

/// A block's rate may be a measured one.
constexpr double rate_tolerance = 0.01;
/// Of lost samples: longer gaps are left out.
constexpr double longest_filled_s = 1.0;

}  // namespace

std::function<void(std::uint64_t)> report_dropped(Notices& notices, MetricValues& metrics) {
  return [&notices, &metrics](std::uint64_t hops) {
    metrics.dropped_hops += hops;
    notices.add("dropped-hops", "samples come faster than they can be processed; whole hops are left out", hops);
  };
}

SourceInput::SourceInput(std::unique_ptr<io::SampleSource> source, const monitor::MonitorFile& file, HopQueue& queue,
                         Notices& notices, MetricValues& metrics, bool can_wait)
    : source_(std::move(source)),
      queue_(&queue),
      notices_(&notices),
      intake_(queue, static_cast<std::size_t>(file.options.channels), file.options.hop_samples(), can_wait,
              report_dropped(notices, metrics)),
      hop_frames_(file.options.hop_samples()),
      channels_(static_cast<std::size_t>(file.options.channels)) {
  if (!can_wait) rate_.emplace(file.options.sample_rate_hz, file.timeout_s);
  if (!source_->notes().empty()) notices_->add("recording", fmt::format("{}", fmt::join(source_->notes(), "; ")));
  thread_ = std::jthread([this] { read(); });
}

void SourceInput::report_faults() {
  if (source_->unreadable_rows() != reported_rows_) {
    notices_->add("unreadable-rows",
                  fmt::format("rows that cannot be read, from line {} on", source_->first_unreadable_line()),
                  source_->unreadable_rows() - reported_rows_);
    reported_rows_ = source_->unreadable_rows();
  }
  if (source_->misaligned_frames() != reported_misaligned_) {
    notices_->add(
        "misaligned",
        "frames do not begin at the first byte of a sample and are left out; was a byte lost on the way, or is "
        "the format another?",
        source_->misaligned_frames() - reported_misaligned_);
    reported_misaligned_ = source_->misaligned_frames();
  }
}

void SourceInput::read() {
  try {
    io::SampleBlock block;
    while (source_->next(hop_frames_, block)) {
      if (rate_) {
        const std::optional<double> measured_hz =
            rate_->add(block.samples.size() / channels_, ArrivalRate::Clock::now());
        if (measured_hz) notices_->add("sample-rate", rate_->message(*measured_hz));
      }
      report_faults();
      intake_.speed(block.followed);
      if (!intake_.add(block.samples)) return;
    }
    intake_.finish();
  } catch (const std::exception& error) {
    notices_->add("input-failed", error.what());
  }
  queue_->close();
}

StreamIntake::StreamIntake(const monitor::MonitorFile& file, HopQueue& queue, Notices& notices, MetricValues& metrics)
    : columns_(file.columns),
      sample_rate_hz_(file.options.sample_rate_hz),
      notices_(&notices),
      metrics_(&metrics),
      intake_(queue, static_cast<std::size_t>(file.options.channels), file.options.hop_samples(), false,
              report_dropped(notices, metrics)),
      rate_(file.options.sample_rate_hz, file.timeout_s) {}

void StreamIntake::reject(const std::string& why) {
  ++metrics_->rejected_messages;
  notices_->add("refused-messages", why);
}

bool StreamIntake::pick(int channels) {
  if (channels == picked_channels_) return true;
  try {
    pick_ = io::pick_channels(columns_, static_cast<std::size_t>(channels), "a message");
    picked_channels_ = channels;
    return true;
  } catch (const InvalidInput& error) {
    reject(error.what());
    return false;
  }
}

void StreamIntake::message(std::span<const std::byte> payload) {
  monitor::DecodedBlock decoded = monitor::decode_stream_block(payload);
  if (!decoded.block) {
    reject(fmt::format("a message {}", decoded.rejection));
    return;
  }
  if (std::abs(decoded.block->sample_rate_hz / sample_rate_hz_ - 1.0) > rate_tolerance) {
    reject(fmt::format("a message was sampled at {:.6g} Hz, not at signal.sample_rate_hz = {:.6g} Hz",
                       decoded.block->sample_rate_hz, sample_rate_hz_));
    return;
  }
  if (!pick(decoded.block->channels)) return;
  order_.take(std::move(*decoded.block), given_);
  give();
}

void StreamIntake::give_up() {
  order_.give_up(given_);
  give();
}

void StreamIntake::give() {
  const auto most_filled = static_cast<std::uint64_t>(longest_filled_s * sample_rate_hz_);
  std::uint64_t frames = 0;
  for (const BlockOrder::Given& given : given_) {
    const monitor::StreamBlock& block = given.block;
    if (!pick(block.channels)) continue;
    if (given.restarted) intake_.restart();
    // Lost blocks are taken to have been as long as this one.
    if (given.lost_before > 0) intake_.gap(given.lost_before * block.frames(), most_filled);
    intake_.speed(block.spindle_speed_rad_per_s);
    const auto channels = static_cast<std::size_t>(block.channels);
    picked_.clear();
    for (std::size_t frame = 0; frame < block.frames(); ++frame) {
      for (const std::size_t column : pick_) picked_.push_back(block.samples[frame * channels + column]);
    }
    intake_.add(picked_);
    frames += (1 + given.lost_before) * block.frames();
  }
  if (!given_.empty()) {
    const std::optional<double> measured_hz = rate_.add(frames, ArrivalRate::Clock::now());
    if (measured_hz) notices_->add("sample-rate", rate_.message(*measured_hz));
  }
  given_.clear();
  report_counts();
}

void StreamIntake::report_counts() {
  const OrderCounts& now = order_.counts();
  const auto report = [this](const char* what, const char* message, std::uint64_t count, std::uint64_t& reported) {
    if (count == reported) return;
    notices_->add(what, message, count - reported);
    reported = count;
  };
  metrics_->lost_blocks = now.lost;
  report("lost-blocks", "blocks of the stream never came", now.lost, reported_.lost);
  report("doubled-blocks", "blocks came twice", now.doubled, reported_.doubled);
  report("late-blocks", "blocks came after they had been given up", now.late, reported_.late);
  report("reordered-blocks", "blocks came in another order and were put back", now.reordered, reported_.reordered);
  report("stream-restarted", "the sender counts its blocks anew", now.restarts, reported_.restarts);
}

}  // namespace robomill::live
