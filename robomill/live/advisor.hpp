#pragma once
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "robomill/base/assumption.hpp"
#include "robomill/base/export.hpp"
#include "robomill/decision/recommend.hpp"
#include "robomill/modal/modes.hpp"
#include "robomill/monitor/advice.hpp"
#include "robomill/monitor/files/monitor_events.hpp"
#include "robomill/stability/lobes.hpp"

// Method: robomill/live/README.md, "Method"

namespace robomill::live {

/// What is known of the cut that is monitored.
struct AdviceBasis {
  int teeth = 0;                         ///< of the cutter; 0: unknown, and there is no advice
  double spindle_speed_rad_per_s = 0.0;  ///< where the detector knows none; 0: unknown
  std::optional<modal::ModalModel> modes = {};
  modal::ModalModel workpiece = {};  ///< no modes: it stands still
  std::optional<stability::LobesResult> lobes = {};
  /// Of each limit of the lobes whether just above it modes couple, which needs no wave of an earlier tooth; empty:
  /// unknown.
  std::vector<bool> mode_coupling = {};
  /// Of each limit of the lobes the depth up to which forced vibration stays within the feed per tooth; empty: unknown.
  std::vector<double> vibration_depth_m = {};
  /// In [0, 1): share of the limit that a suggested depth keeps off …
  double depth_margin = decision::default_depth_margin;
  double speed_window = decision::default_speed_window;  ///< … at every speed within this share of the suggested one
  double lowest_rad_per_s = 0.0, highest_rad_per_s = 0.0;  ///< of the spindle, lowest < highest; 0: no bound
  /// Below it a mode is one of the arm, whose chatter no speed is suggested for; so is one below the lowest tooth
  /// passing that the spindle can give.
  double arm_below_hz = 100.0;
  std::vector<std::string> notes = {};     ///< sentences for the user on what all this is from
  std::vector<Assumption> assumed = {};    ///< of the files that all this is from
  std::vector<std::string> warnings = {};  ///< on their numbers
  /// Of samples that no anti-alias filter is stated for: their lines may be folded. 0: a filter is stated.
  double unfiltered_sample_rate_hz = 0.0;

  /// Takes the modes of a cut and computes its lobes, with what else limits it just above and below each limit.
  /// @throws Interrupted when progress asks to stop
  ROBOMILL_API void take_cut(const stability::LobesProblem& problem, const stability::LobesOptions& options,
                             Progress& progress);
};

/// Names the mode that chatters, and speeds and a depth that are stable, or why no speed is.
class ROBOMILL_API Advisor {
 public:
  explicit Advisor(AdviceBasis basis) : basis_(std::move(basis)) {}
  /// Fills in mode, aliases, speeds and depth; leaves an event alone whose frequency or teeth are not known.
  void advise(monitor::MonitorEvent& event) const;

 private:
  [[nodiscard]] monitor::NoSpeed no_speed(const monitor::Advice& advice, double spindle_speed_rad_per_s) const;
  AdviceBasis basis_;
};

}  // namespace robomill::live
