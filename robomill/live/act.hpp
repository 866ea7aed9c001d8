#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/base/names.hpp"
#include "robomill/monitor/files/monitor_events.hpp"
#include "robomill/monitor/files/monitor_toml.hpp"

// Method: robomill/live/README.md, "Acting"

namespace robomill::live {

/// What a rule of [act] asks of spindle and robot.
struct Command {
  enum class Kind {
    none,           ///< nothing can be done; `reason` says why. What was commanded before stays
    spindle_speed,  ///< spindle_speed_rad_per_s, and feed_override, so that feed per tooth stays
    feed,           ///< feed_override
    hold,           ///< stop along the path, then retract_m out of the cut; people resume
    release         ///< feed_override as before the alarm
  };
  Kind kind = Kind::none;
  double time_s = 0.0;                   ///< of the stream: of the decision that it follows
  double spindle_speed_rad_per_s = 0.0;  ///< 0: as it is
  double feed_override = 1.0;            ///< of the programmed feed, from now on; in (0, 1.5]
  double retract_m = 0.0;                ///< along the tool's axis; > 0 of a hold, else 0
  /// Of a speed: whether the feed changes before the spindle does, as it must where both fall: chips stay below the
  /// programmed thickness in between.
  bool feed_first = false;
  std::string reason = {};
  std::string not_claimed = {};  ///< what it does not promise
};
inline constexpr Name<Command::Kind> command_names[] = {{"none", Command::Kind::none},
                                                        {"spindle-speed", Command::Kind::spindle_speed},
                                                        {"feed", Command::Kind::feed},
                                                        {"hold", Command::Kind::hold},
                                                        {"release", Command::Kind::release}};

/// The rules of [act]: decisions and their events in the order of the stream → commands. An alarm lasts from the first
/// decision of chatter until the state has been stable for calm_s.
///
/// speed: the suggested speed, once an alarm; where chatter is still detected settle_s later, the next speed that was
/// not tried follows, no more often than there were suggestions. reduce: the feed to reduce_to, and back at the alarm's
/// end. hold: whenever chatter begins. A blind monitor commands nothing: what was commanded stays, and times stand
/// still.
class ROBOMILL_API Actor {
 public:
  /// Higher ones change nothing on a PathInterpolator.
  static constexpr double greatest_feed_override = 1.5;

  /// @param spindle_speed_rad_per_s  where the detector knows none; 0: unknown
  /// @throws InvalidInput naming a setting that is out of range, retract_m of a hold among them
  explicit Actor(const monitor::ActSettings& settings, double spindle_speed_rad_per_s = 0.0);

  /// Takes each decision. True where something may be to do although the decision changes nothing: then act() wants an
  /// event of it. @param time_s  of the stream
  [[nodiscard]] bool observe(const monitor::Decision& decision, double time_s) noexcept;
  /// Takes each event of a decision, after observe() took that and with the advice filled in; fills in `command`, and
  /// `message` with the reason.
  std::optional<Command> act(monitor::MonitorEvent& event);
  /// A speed was commanded less than settle_s ago: what the detector knows of the spindle is of before.
  [[nodiscard]] bool settling() const noexcept { return settling_s_ > 0.0; }

 private:
  [[nodiscard]] std::optional<Command> on_chatter(const monitor::MonitorEvent& event);
  [[nodiscard]] std::optional<Command> change_speed(const monitor::MonitorEvent& event);
  [[nodiscard]] std::optional<Command> nothing(std::string reason);
  [[nodiscard]] bool allowed(double speed_rad_per_s) const;
  [[nodiscard]] std::string in_force() const;

  monitor::ActSettings settings_;
  double given_rad_per_s_;
  double programmed_rad_per_s_ = 0.0;  ///< when chatter was first detected: the feed is programmed for it
  double commanded_rad_per_s_ = 0.0;   ///< 0: none
  double feed_override_ = 1.0;
  bool alarm_ = false, held_ = false, release_due_ = false;
  double observed_s_ = 0.0;
  double stable_for_s_ = -1.0;  ///< < 0: it is not
  double settling_s_ = 0.0;     ///< still
  double waiting_s_ = 0.0;      ///< in chatter, for a speed to be suggested
  std::vector<double> tried_;   ///< speeds of this alarm, that of its beginning first
  std::size_t suggested_ = 0;   ///< how many speeds, when the first one of this alarm was commanded
  bool said_ = false;           ///< … why none was
};

}  // namespace robomill::live
