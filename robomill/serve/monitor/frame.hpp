#pragma once
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "robomill/io/json.hpp"
#include "robomill/modal/mode_id.hpp"
#include "robomill/monitor/files/monitor_events.hpp"
#include "robomill/monitor/monitor.hpp"

// Method: robomill/serve/README.md, "Monitor"

namespace robomill::serve {

/// What the page shows of a moment, or of all moments of a frame: the most severe state, the worst score.
struct MonitorFrame {
  double clock_s = 0.0;  ///< since the session's beginning
  double time_s = 0.0;   ///< of the stream
  monitor::State state = monitor::State::stable;
  monitor::BlindReason reason = monitor::BlindReason::none;  ///< of State::blind
  double score = NAN, threshold = NAN;                       ///< NaN: no decision
  double spindle_speed_rad_per_s = 0.0;                      ///< 0: unknown
  // Of chatter, as its event has it.
  double chatter_frequency_hz = 0.0, chatter_frequency_std_hz = 0.0;
  modal::ModeId mode = {};
  double suggested_spindle_speed_rad_per_s = 0.0;  ///< 0: none
  monitor::NoSpeed no_speed = monitor::NoSpeed::none;
  monitor::Explanation why = {};      ///< beside the frame in messages: the history of frames does without
  std::uint32_t faults = 0;           ///< of monitor::Fault: all of them
  double compute_s = 0.0;             ///< of the decision that took longest
  double pace = NAN;                  ///< seconds of the stream a second of the clock
  std::vector<float> amplitude = {};  ///< of the bands; empty: no spectrum
};

/// What it is with what followed.
/// @param alarm_below  MonitorOptions': a lower score is worse
void join(MonitorFrame& frame, const MonitorFrame& later, bool alarm_below);

/// Its spectrum as whole decibels re 1 of the input's unit: "peak_db", and of each band a letter of the alphabet A … Z,
/// a … z, 0 … 9, -, _: the last stands for the peak, each one before for 1 dB less, A for 63 dB less or more.
[[nodiscard]] io::Json frame_json(const MonitorFrame& frame);

/// The frames of the last ten minutes, joined to one a second.
class FrameRing {
 public:
  static constexpr std::size_t most_frames = 600;
  explicit FrameRing(bool alarm_below) : alarm_below_(alarm_below) {}
  void add(const MonitorFrame& frame);
  [[nodiscard]] const std::deque<MonitorFrame>& frames() const { return frames_; }

 private:
  bool alarm_below_;
  std::deque<MonitorFrame> frames_;
};

}  // namespace robomill::serve
