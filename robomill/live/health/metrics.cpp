#include "robomill/live/health/metrics.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string_view>

#include "robomill/base/units.hpp"
#include "robomill/io/system/append.hpp"

namespace robomill::live {
namespace {

void row(std::string& out, std::string_view name, std::string_view type, std::string_view help, double value) {
  if (!std::isfinite(value)) return;
  io::append(out, "# HELP robomill_{0} {1}\n# TYPE robomill_{0} {2}\nrobomill_{0} {3}\n", name, help, type, value);
}

}  // namespace

void MetricValues::set_state(const monitor::Decision& decision) {
  state = static_cast<int>(decision.state);
  chatter_frequency_hz = decision.chatter_frequency_hz;
}

void MetricValues::add_blind(monitor::BlindReason reason, double seconds) {
  blind_s.at(static_cast<std::size_t>(reason)).fetch_add(seconds);
}

double MetricValues::blind_for_s(monitor::BlindReason reason) const {
  return blind_s.at(static_cast<std::size_t>(reason));
}

void MetricValues::set(const monitor::Decision& decision) {
  set_state(decision);
  score = decision.score;
  threshold = decision.threshold;
  energy_entropy = decision.energy_entropy;
  level = decision.level;
  spindle_speed_rpm = decision.spindle_speed_rad_per_s / units::rpm;
  faults = decision.faults;
  ++decisions;
}

std::string MetricValues::text() const {
  std::string out;
  const auto gauge = [&out](std::string_view name, std::string_view help, double value) {
    row(out, name, "gauge", help, value);
  };
  const auto counter = [&out](std::string_view name, std::string_view help, const std::atomic<std::uint64_t>& value) {
    row(out, name, "counter", help, static_cast<double>(value.load()));
  };
  gauge("state", "0 stable, 1 transition, 2 chatter, 3 blind", state);
  gauge("score", "of the detector", score);
  gauge("threshold", "that the score is held against", threshold);
  gauge("energy_entropy", "of the bands", energy_entropy);
  gauge("level", "rms of all channels, in the unit of the input", level);
  gauge("chatter_frequency_hz", "0 where there is none", chatter_frequency_hz);
  gauge("spindle_speed_rpm", "as tracked, 0 where it is unknown", spindle_speed_rpm);
  gauge("faults", "bits of what is wrong with the input", static_cast<double>(faults.load()));
  gauge("stream_seconds", "time of the stream processed so far", stream_s);
  gauge("compute_seconds", "that the last decision took", compute_s);
  gauge("behind_seconds", "by which decisions are behind the samples", behind_s);
  gauge("queued_hops", "waiting for the detector", static_cast<double>(queued_hops.load()));
  gauge("connected", "1 while a broker is", connected ? 1.0 : 0.0);
  counter("decisions_total", "hops decided", decisions);
  counter("alarms_total", "times that the state became chatter", alarms);
  counter("events_total", "written", events);
  gauge("unsaved_events", "waiting until their file can be written", static_cast<double>(unsaved_events.load()));
  counter("lost_events_total", "that were too many to wait for that", lost_events);
  counter("event_log_failures_total", "times that the file of the events could not be written any more", log_failures);
  counter("dropped_hops_total", "left out since input was faster than the detector", dropped_hops);
  counter("lost_blocks_total", "that never came", lost_blocks);
  counter("refused_messages_total", "that were no blocks of samples", rejected_messages);
  io::append(out,
             "# HELP robomill_blind_seconds_total for which nothing could be said of the cut\n# TYPE "
             "robomill_blind_seconds_total counter\n");
  for (const monitor::BlindReason reason : monitor::blind_reasons) {
    io::append(out, "robomill_blind_seconds_total{{reason=\"{}\"}} {}\n", monitor::to_string(reason),
               blind_for_s(reason));
  }
  return out;
}

}  // namespace robomill::live
