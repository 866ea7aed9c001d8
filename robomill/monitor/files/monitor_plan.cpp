#include "robomill/monitor/files/monitor_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/cutting/cut_limits.hpp"
#include "robomill/modal/files/modes_files.hpp"
#include "robomill/monitor/files/monitor_toml.hpp"

namespace robomill::monitor {
namespace {

/// More changes of speed are counted, not listed.
constexpr std::size_t most_listed = 200;

bool same_speed(const SpeedStretch& a, const SpeedStretch& b) {
  return std::abs(a.spindle_speed_rad_per_s - b.spindle_speed_rad_per_s) <= 1e-9 * b.spindle_speed_rad_per_s;
}

/// The file without its paths, which no validation needs.
MonitorFile monitor_file(const MonitorPlan& plan) {
  MonitorFile file;
  file.columns.channels = plan.channels;
  file.columns.sample_rate_hz = plan.sample_rate_hz;
  file.options.sample_rate_hz = plan.sample_rate_hz;
  file.options.channels = static_cast<int>(plan.channels.size());
  file.options.teeth = plan.teeth;
  file.options.false_alarms_per_hour = plan.false_alarms_per_hour;
  // A spindle that turns as slowly as it should does not stand still.
  double& min_speed_rad_per_s = file.options.min_speed_rad_per_s;
  for (const SpeedStretch& each : plan.speeds) {
    min_speed_rad_per_s = std::min(min_speed_rad_per_s, 0.5 * each.spindle_speed_rad_per_s);
  }
  min_speed_rad_per_s = std::max(min_speed_rad_per_s, slowest_min_speed_rad_per_s);
  if (plan.one_speed()) file.options.spindle_speed_rad_per_s = plan.speeds.front().spindle_speed_rad_per_s;
  return file;
}

/// A line for every change of speed.
std::string speeds_text(const std::vector<SpeedStretch>& speeds) {
  std::string out;
  std::size_t listed = 0, more = 0;
  for (std::size_t i = 0; i < speeds.size(); ++i) {
    if (i > 0 && same_speed(speeds[i], speeds[i - 1])) continue;
    if (listed == most_listed) {
      ++more;
      continue;
    }
    ++listed;
    out += fmt::format("  from line {}: {:.6g} rpm\n", speeds[i].line, speeds[i].spindle_speed_rad_per_s / units::rpm);
  }
  if (more > 0) out += fmt::format("  and {} changes more\n", more);
  return out;
}

std::string remarks_of(const MonitorPlan& plan) {
  std::string out =
      "robomill plan: what is known of the cut. Of the machine: set sample_rate_hz and channels to the sensor's, and\n"
      "anti_alias_filter = true where a filter ahead of the converter takes off what lies above half the rate.\n";
  if (plan.modes) {
    out += "The modes are those of the posture nearest to chatter";
    out += plan.modes_line > 0 ? fmt::format(", in line {} of the program.\n", plan.modes_line) : ".\n";
  }
  if (!plan.one_speed()) {
    out +=
        "The program runs at several spindle speeds. A column spindle_speed_rpm, or the blocks of MQTT, must carry "
        "the\n"
        "one that runs: without it the state is blind until the signal itself shows the rotation.\n" +
        speeds_text(plan.speeds);
  }
  return out;
}

}  // namespace

bool MonitorPlan::one_speed() const {
  return !speeds.empty() &&
         std::ranges::all_of(speeds, [&](const SpeedStretch& each) { return same_speed(each, speeds.front()); });
}

void MonitorPlan::validate() const {
  if (speeds.empty()) throw InvalidInput("speeds", "must hold at least one");
  for (std::size_t i = 0; i < speeds.size(); ++i) {
    const std::string path = fmt::format("speeds[{}].", i + 1);
    cutting::require_spindle_speed(path + "spindle_speed_rad_per_s", speeds[i].spindle_speed_rad_per_s);
    if (speeds[i].line < 0) throw InvalidInput(path + "line", speeds[i].line, "", "must be >= 0");
  }
  if (teeth < 1) throw InvalidInput("teeth", teeth, "", "must be at least 1");
  if (modes && !modes_file.empty()) throw InvalidInput("modes_file", "must not stand beside modes");
  if (modes_line < 0) throw InvalidInput("modes_line", modes_line, "", "must be >= 0");
  const MonitorFile file = monitor_file(*this);
  file.columns.validate();
  file.options.validate();
}

PlannedMonitor plan_monitor(const MonitorPlan& plan) {
  plan.validate();
  MonitorFile file = monitor_file(plan);
  file.modes = plan.modes ? std::filesystem::path(monitor_modes_name) : plan.modes_file;
  file.lobes = plan.lobes_file;
  PlannedMonitor out{.toml = monitor_toml(file, remarks_of(plan))};
  if (plan.modes) out.modes_json = modal::modes_json(*plan.modes);
  return out;
}

}  // namespace robomill::monitor
