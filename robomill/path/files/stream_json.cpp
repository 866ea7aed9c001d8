#include "robomill/path/files/stream_json.hpp"

#include <fmt/format.h>

#include <utility>

#include "robomill/base/printable.hpp"
#include "robomill/base/units.hpp"
#include "robomill/path/files/stream_object.hpp"

namespace robomill::path {
namespace {

using io::key;
using io::Schema;
using io::Use;

const Schema<DelayStatistics>& delay_table() {
  using Delay = DelayStatistics;
  const auto quantile = [](double share) { return [share](const Delay& delay) { return delay.quantile_s(share); }; };
  static const Schema<Delay> table(
      "stream_delay", "behind the begin of the period",
      {key(
           "mean_us", [](const Delay& delay) { return delay.mean_s(); }, "of all"),
       key("p99_us", quantile(0.99), "99 % are no larger"), key("p999_us", quantile(0.999), "99.9 % are no larger"),
       key(
           "max_us", [](const Delay& delay) { return delay.max_s(); }, "the largest")},
      Use::written);
  return table;
}

}  // namespace

const Schema<StreamedProgram>& stream_table() {
  using Stream = StreamedProgram;
  const auto counter = [](std::uint64_t StreamReport::*member) {
    return [member](const Stream& stream) { return stream.report.*member; };
  };
  static const Schema<Stream> table(
      "stream", "a program that was streamed as set-points by the clock",
      {key("program", &Stream::program, "name of its file"),
       key("cell", &Stream::cell, "name of its file"),
       key("end", &Stream::end, stream_end_names, "how it ended: at the program's end, by command, by a signal"),
       key("failure", &Stream::failure, "in words; none: it did not fail").nullable(),
       key(
           "sample_period_ms", [](const Stream& stream) { return stream.report.period_s; }, "of the set-points"),
       key("periods", counter(&StreamReport::periods), "set-points"),
       key("deadline_misses", counter(&StreamReport::misses),
           "set-points handed over to the writer's ring after the end of their period"),
       key(
           "hand_over", [](const Stream& stream) { return &stream.report.hand_over; }, delay_table(),
           "jitter: delay of the hand-over, with all computing"),
       key(
           "wake_up", [](const Stream& stream) { return &stream.report.wake_up; }, delay_table(),
           "of it until the thread is woken up"),
       key("starved", counter(&StreamReport::starved),
           "set-points that are slower than commanded, or at rest, because planning was behind"),
       key("overruns", counter(&StreamReport::overruns), "set-points lost because the ring was full"),
       key("overruns_in_motion", counter(&StreamReport::overruns_in_motion), "of them while the tool moved"),
       key("reader_holds", counter(&StreamReport::reader_holds),
           "times that the motion was held because the reader was behind by half of the ring"),
       key("schedule_shifts", counter(&StreamReport::shifts),
           "times that the thread was more than 10 periods late, and the schedule was moved on"),
       key(
           "shifted_s", [](const Stream& stream) { return stream.report.shifted_s; }, "all of them together"),
       key(
           "lines", [](const Stream& stream) { return stream.written.lines; }, "written"),
       key(
           "late_lines", [](const Stream& stream) { return stream.written.late; },
           "written after the end of their set-point's period"),
       key(
           "written", [](const Stream& stream) { return &stream.written.delay; }, delay_table(),
           "delay until the line was handed to the system"),
       key(
           "real_time", [](const Stream& stream) { return stream.scheduling.first_in_first_out; },
           "the loop ran under SCHED_FIFO"),
       key(
           "why_not_real_time", [](const Stream& stream) { return stream.scheduling.why_not; }, "none: it did")
           .nullable(),
       key(
           "memory_locked", [](const Stream& stream) { return stream.scheduling.memory_locked; }, "by mlockall"),
       key(
           "why_not_locked", [](const Stream& stream) { return stream.scheduling.why_not_locked; }, "none: it was")
           .nullable(),
       key("commands", &Stream::commands, "carried out"),
       key("rejected_commands", &Stream::rejected_commands, "not understood"),
       key("notes", &Stream::notes, "sentences for the user"),
       key("assumed", &Stream::assumed, io::assumption_table(), "what the input did not give")},
      Use::written, 1);
  return table;
}

std::string stream_json(const StreamedProgram& streamed) {
  return io::dump(stream_table().write(streamed));
}

std::string stream_text(const StreamedProgram& streamed) {
  const StreamReport& report = streamed.report;
  const auto delay = [](const DelayStatistics& d) {
    return fmt::format("mean {:.1f}, 99 % {:.0f}, 99.9 % {:.0f}, max {:.0f} us", d.mean_s() / units::us,
                       d.quantile_s(0.99) / units::us, d.quantile_s(0.999) / units::us, d.max_s() / units::us);
  };
  std::string out = fmt::format("{}{}: {} set-points, one every {:.6g} ms\n", name_in(stream_end_names, streamed.end),
                                streamed.failure.empty() ? "" : " (" + printable(streamed.failure) + ")",
                                report.periods, report.period_s / units::ms);
  out += fmt::format("misses     {} of {} set-points were handed over after the end of their period\n", report.misses,
                     report.periods);
  out += "jitter     hand-over behind the begin of the period: " + delay(report.hand_over) + "\n";
  out += "wake-up    of it: " + delay(report.wake_up) + "\n";
  out += fmt::format("lines      {} written, {} of them after the end of their period; {}\n", streamed.written.lines,
                     streamed.written.late, delay(streamed.written.delay));
  out += fmt::format(
      "starved    {} set-points\noverruns   {} set-points lost, {} of them in motion; held {} times for "
      "the reader\n",
      report.starved, report.overruns, report.overruns_in_motion, report.reader_holds);
  if (report.shifts > 0) {
    out += fmt::format("shifts     the schedule was moved on {} times, by {:.6g} s in all\n", report.shifts,
                       report.shifted_s);
  }
  const Scheduling& system = streamed.scheduling;
  out += "system     ";
  out += system.first_in_first_out ? fmt::format("SCHED_FIFO, priority {}", system.priority)
                                   : "no SCHED_FIFO: " + system.why_not;
  out += system.memory_locked ? "; memory locked\n" : "; memory not locked: " + system.why_not_locked + "\n";
  out += fmt::format("commands   {} carried out, {} rejected\n", streamed.commands, streamed.rejected_commands);
  return out;
}

}  // namespace robomill::path
