#pragma once
#include <chrono>
#include <string>

#include "robomill/monitor/monitor.hpp"

namespace robomill::app {

/// One line: time, state, level, score, the bands as a bar of block characters over 48 dB, speed and frequency.
[[nodiscard]] std::string watch_line(const monitor::Decision& decision, double time_s);

/// The line on standard error, drawn anew at most ten times a second; where that is no terminal, one a second of the
/// stream.
class Watch {
 public:
  Watch();
  ~Watch();
  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;
  void show(const monitor::Decision& decision, double time_s);

 private:
  bool terminal_ = false, drawn_ = false;
  std::chrono::steady_clock::time_point shown_ = {};
  double shown_s_ = -1e300;
  monitor::State shown_state_ = monitor::State::stable;
};

}  // namespace robomill::app
