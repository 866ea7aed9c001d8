#pragma once
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/base/names.hpp"
#include "robomill/modal/mode_id.hpp"
#include "robomill/monitor/monitor.hpp"

// Method: robomill/monitor/README.md, "Files"

namespace robomill::monitor {

/// Why no speed is suggested although chatter's frequency is known.
enum class NoSpeed {
  none,             ///< one is suggested, or chatter's frequency or the number of teeth is not known
  arm,              ///< the mode that chatters is one of the arm: teeth pass too often for any lobe of it
  unclear,          ///< several modes explain it about as well, one of the arm among them
  mode_coupling,    ///< it needs no wave of an earlier tooth: no tooth passing ends it
  ambiguous_alias,  ///< without an anti-alias filter the line may be folded, and the modes do not say from where
  forced_vibration  ///< of every lobe tooth passing makes the tip vibrate by more than the feed per tooth
};
inline constexpr Name<NoSpeed> no_speed_names[] = {{"arm", NoSpeed::arm},
                                                   {"unclear", NoSpeed::unclear},
                                                   {"mode-coupling", NoSpeed::mode_coupling},
                                                   {"ambiguous-alias", NoSpeed::ambiguous_alias},
                                                   {"forced-vibration", NoSpeed::forced_vibration}};
/// What keeps a suggested depth from being greater.
enum class DepthLimitedBy {
  none,             ///< no depth is suggested
  stability,        ///< the chart's limit, or its end, less the margin
  forced_vibration  ///< it reaches the feed per tooth
};
inline constexpr Name<DepthLimitedBy> depth_limited_by_names[] = {
    {"stability", DepthLimitedBy::stability}, {"forced-vibration", DepthLimitedBy::forced_vibration}};

/// What a monitor reports.
struct MonitorEvent {
  /// state: it changed, chatter's frequency moved, or a rule acts. window: a decision without a change. fault: what is
  /// wrong with the input changed. stream: something befell the samples on their way (blocks lost, connection lost, …).
  /// recording: the samples before an alarm were written to a file.
  enum class Kind { state, window, fault, stream, recording };
  Kind kind = Kind::state;
  double time_s = 0.0;      ///< of the stream [s]
  Decision decision = {};   ///< the last one
  modal::ModeId mode = {};  ///< that chatters
  /// What the line of chatter is that was measured folded; of several it is not known which. Empty: as measured, or
  /// nothing is advised.
  std::vector<double> line_hz = {};
  double suggested_spindle_speed_rad_per_s = 0.0;  ///< 0: none
  double suggested_axial_depth_m = 0.0;            ///< 0: none
  DepthLimitedBy depth_limited_by = DepthLimitedBy::none;
  std::vector<double> stable_speeds_rad_per_s = {};
  NoSpeed no_speed = NoSpeed::none;
  std::string command = {};  ///< that followed by a rule of [act]; empty: none
  double compute_s = 0.0;    ///< that the decision took
  std::string what = {};     ///< of streams: "lost-blocks", …
  std::uint64_t count = 0;   ///< of streams: how many
  std::string message = {};  ///< for people
  std::string file = {};     ///< of recordings
  bool explained = false;    ///< of states and windows: the line holds Decision::why
};

inline constexpr Name<MonitorEvent::Kind> event_kind_names[] = {{"state", MonitorEvent::Kind::state},
                                                                {"window", MonitorEvent::Kind::window},
                                                                {"fault", MonitorEvent::Kind::fault},
                                                                {"stream", MonitorEvent::Kind::stream},
                                                                {"recording", MonitorEvent::Kind::recording}};
[[nodiscard]] ROBOMILL_API std::string_view to_string(MonitorEvent::Kind kind);

/// One line of JSON with its end. What is not known is null; numbers are finite.
[[nodiscard]] ROBOMILL_API std::string event_line(const MonitorEvent& event);

/// What a session writes first into a file of events that goes on from one session to the next.
struct SessionStart {
  std::string started = {};  ///< "2026-11-27T07:48:41Z"
  std::string input = {};    ///< a file or an address
  std::string config = {};   ///< monitor.toml
  std::string version = {};  ///< of robomill
  std::string message = {};  ///< for people
};
/// "started", as a line of JSON with its end.
[[nodiscard]] ROBOMILL_API std::string started_line(const SessionStart& start);
/// "stream" with `what` "events-lost", in the place of so many lines that could not be written.
[[nodiscard]] ROBOMILL_API std::string lost_events_line(std::uint64_t count);

/// For people, of MonitorEvent::line_hz: "989.0 Hz folded"; "661.0, 989.0 or 2311.0 Hz". Empty of none.
[[nodiscard]] ROBOMILL_API std::string line_text(const std::vector<double>& line_hz);

/// "not-finite", … of a mask.
[[nodiscard]] ROBOMILL_API std::vector<std::string> fault_names(std::uint32_t faults);

}  // namespace robomill::monitor
