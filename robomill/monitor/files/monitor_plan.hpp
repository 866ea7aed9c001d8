#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/modal/modes.hpp"

// Method: robomill/monitor/README.md, "Planned monitors (`files/monitor_plan.hpp`)"

namespace robomill::monitor {

/// The spindle turns at one speed from a line of the program on.
struct SpeedStretch {
  double spindle_speed_rad_per_s = 0.0;  ///< > 0; required
  int line = 0;                          ///< of the program, >= 0; 0: a cut without a program
};

/// A decided cut, as its monitor must know it.
struct ROBOMILL_API MonitorPlan {
  std::vector<SpeedStretch> speeds = {};  ///< at least one, in the order of the program
  int teeth = 0;                          ///< of the cutter, in [1, 64]; required
  /// modes.json and lobes.toml of the cut, relative to the folder of monitor.toml; empty: none.
  std::filesystem::path modes_file = {}, lobes_file = {};
  /// In place of modes_file, written beside monitor.toml: where modes depend on the posture, those of the block that
  /// is nearest to chatter.
  std::optional<modal::ModalModel> modes = {};
  int modes_line = 0;                                   ///< of the program, where they are taken, >= 0; 0: not said
  double sample_rate_hz = 10'240.0;                     ///< > 0
  std::vector<std::string> channels = {"ax_m_per_s2"};  ///< columns, by name or number from 1
  double false_alarms_per_hour = 0.1;                   ///< of comb-cusum, > 0
  /// @throws InvalidInput naming the member
  void validate() const;
  /// Whether all stretches turn at one speed, to 1e-9 of it.
  [[nodiscard]] bool one_speed() const;
};

/// The name of MonitorPlan::modes beside monitor.toml.
inline constexpr const char* monitor_modes_name = "monitor_modes.json";

/// The files of a planned monitor, which stand in one folder.
struct PlannedMonitor {
  std::string toml = {};        ///< monitor.toml
  std::string modes_json = {};  ///< monitor_modes.json; empty where no modes are planned
};

/// monitor.toml of a decided cut, which `robomill monitor` runs with: the default detector, comb-cusum, with speed and
/// teeth of the cut. Of several speeds none is written: a column spindle_speed_rpm or the blocks of MQTT carry the one
/// that runs, and remarks list them by line. What only the machine knows (channels, sample rate, filter) is as by
/// default, and a remark says so.
/// @throws InvalidInput as validate
[[nodiscard]] ROBOMILL_API PlannedMonitor plan_monitor(const MonitorPlan& plan);

}  // namespace robomill::monitor
