#pragma once
#include <optional>

#include "robomill/base/progress.hpp"
#include "robomill/modal/modes.hpp"
#include "robomill/monitor/files/monitor_events.hpp"
#include "robomill/monitor/files/monitor_toml.hpp"
#include "robomill/stability/lobes.hpp"

namespace robomill::app {

/// Names the mode that chatters and what would be quiet, from what monitor.toml says of the process.
class Advisor {
 public:
  /// Reads modes and lobes, and computes the lobes' chart.
  /// @throws InvalidInput if a file is missing or wrong, or modes come without teeth
  Advisor(const monitor::MonitorFile& file, Progress& progress);
  /// Fills in mode, speeds and depth; leaves an event alone whose frequency or teeth are not known.
  void advise(monitor::MonitorEvent& event) const;

 private:
  int teeth_ = 0;
  double hint_rad_per_s_ = 0.0;
  std::optional<modal::ModalModel> modes_;
  modal::ModalModel workpiece_;  ///< no modes: it stands still
  std::optional<stability::LobesResult> lobes_;
};

}  // namespace robomill::app
