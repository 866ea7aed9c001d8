#include "report.hpp"

#include <fmt/format.h>

#include <array>
#include <cstddef>
#include <string_view>
#include <utility>

#include "robomill/base/units.hpp"
#include "robomill/live/files/recorded_run_json.hpp"

namespace robomill::app {
namespace {

std::string speed_fact(const monitor::MonitorOptions& options) {
  std::string out = options.spindle_speed_rad_per_s > 0.0
                        ? fmt::format("{:.0f} rpm as given", options.spindle_speed_rad_per_s / units::rpm)
                        : "from the signal";
  if (options.teeth > 0) out += fmt::format(", {} teeth", options.teeth);
  return out;
}

std::string detector_fact(const monitor::MonitorOptions& options) {
  std::string out = fmt::format("{}, every {:.4g} ms", monitor::to_string(options.kind), options.hop_s / units::ms);
  if (options.kind == monitor::Kind::comb_cusum) return out;
  return out + fmt::format(", windows of {:.4g} ms, {} entropy {} {:.6g}", options.window_s / units::ms,
                           monitor::to_string(options.entropy), options.alarm_below ? "below" : "above",
                           options.threshold);
}

}  // namespace

std::string unit_of(const std::vector<std::string>& channels, int tachometer_channel) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 2> units = {{{"_m_per_s2", "m/s²"}, {"_g", "g"}}};
  for (const auto& [suffix, unit] : units) {
    bool all = true;
    for (std::size_t i = 0; i < channels.size(); ++i) {
      all = all && (channels[i].ends_with(suffix) || static_cast<int>(i) == tachometer_channel);
    }
    if (all) return std::string(unit);
  }
  return {};
}

page::Report monitor_page(live::RecordedRun run, const monitor::MonitorFile& file, const std::string& source) {
  const monitor::MonitorOptions& options = file.options;
  run.facts = {{"Signal", fmt::format("{}, {:.6g} Hz", source, options.sample_rate_hz)},
               {"Detector", detector_fact(options)},
               {"Spindle speed", speed_fact(options)}};
  page::Report page;
  page.title = "Chatter monitor";
  page.monitor = live::recorded_run_json(run);
  return page;
}

std::string run_summary(const live::RecordedRun& run) {
  std::string out;
  for (const live::RecordedAlarm& alarm : run.alarms) {
    if (alarm.no_speed != monitor::NoSpeed::ambiguous_alias) continue;
    out += fmt::format(
        "Chatter at {:.1f} Hz: signal.anti_alias_filter is not stated, and the line may be {}. No mode, no speed.\n",
        alarm.chatter_frequency_hz, monitor::line_text(alarm.line_hz));
  }
  for (const live::StateTime& time : run.state_times) {
    if (time.state == monitor::State::blind) {
      out += fmt::format("Cannot tell: {}, for {:.2f} s.\n", monitor::to_string(time.reason), time.duration_s);
    } else {
      out += fmt::format("In the state {} for {:.2f} s.\n", monitor::to_string(time.state), time.duration_s);
    }
  }
  return out;
}

}  // namespace robomill::app
