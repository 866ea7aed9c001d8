#include "robomill/serve/monitor/frame.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include "robomill/base/units.hpp"
#include "robomill/modal/files/mode_json.hpp"

namespace robomill::serve {
namespace {

using io::Json;

constexpr std::string_view level_letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";

int severity(monitor::State state) {
  constexpr std::array<monitor::State, 4> rising = {monitor::State::stable, monitor::State::transition,
                                                    monitor::State::blind, monitor::State::chatter};
  return static_cast<int>(std::ranges::find(rising, state) - rising.begin());
}

/// Short in a message that is sent ten times a second.
Json rounded(double value, double step) {
  return io::number(std::round(value / step) * step);
}

Json rounded_positive(double value, double step) {
  return value > 0.0 ? rounded(value, step) : Json(nullptr);
}

int decibels(float amplitude) {
  return static_cast<int>(std::lround(20.0 * std::log10(static_cast<double>(amplitude))));
}

}  // namespace

void join(MonitorFrame& frame, const MonitorFrame& later, bool alarm_below) {
  MonitorFrame out = later;
  if (severity(frame.state) > severity(later.state)) {
    out.state = frame.state;
    out.reason = frame.reason;
    out.chatter_frequency_hz = frame.chatter_frequency_hz;
    out.chatter_frequency_std_hz = frame.chatter_frequency_std_hz;
    out.mode = frame.mode;
    out.suggested_spindle_speed_rad_per_s = frame.suggested_spindle_speed_rad_per_s;
    out.no_speed = frame.no_speed;
    out.why = frame.why;
  }
  const bool worse = alarm_below ? frame.score < later.score : frame.score > later.score;
  if (worse || std::isnan(later.score)) {
    out.score = frame.score;
    out.threshold = frame.threshold;
  }
  if (later.spindle_speed_rad_per_s == 0.0) out.spindle_speed_rad_per_s = frame.spindle_speed_rad_per_s;
  out.faults |= frame.faults;
  out.compute_s = std::max(frame.compute_s, later.compute_s);
  if (out.amplitude.empty()) {
    out.amplitude = std::move(frame.amplitude);
  } else if (out.amplitude.size() == frame.amplitude.size()) {
    for (std::size_t i = 0; i < out.amplitude.size(); ++i) {
      out.amplitude[i] = std::max(out.amplitude[i], frame.amplitude[i]);
    }
  }
  frame = std::move(out);
}

Json frame_json(const MonitorFrame& frame) {
  const bool chatters = frame.chatter_frequency_hz > 0.0;
  Json out;
  out["clock_s"] = rounded(frame.clock_s, 1e-3);
  out["time_s"] = rounded(frame.time_s, 1e-3);
  out["state"] = monitor::to_string(frame.state);
  out["reason"] = frame.state == monitor::State::blind ? Json(monitor::to_string(frame.reason)) : Json(nullptr);
  out["score"] = rounded(frame.score, 1e-4);
  out["threshold"] = io::number(frame.threshold);
  out["spindle_speed_rpm"] = rounded_positive(frame.spindle_speed_rad_per_s / units::rpm, 0.1);
  out["chatter_frequency_hz"] = rounded_positive(frame.chatter_frequency_hz, 0.01);
  out["chatter_frequency_std_hz"] = chatters ? rounded(frame.chatter_frequency_std_hz, 0.01) : Json(nullptr);
  modal::set_mode(out, frame.mode);
  out["suggested_spindle_speed_rpm"] = rounded_positive(frame.suggested_spindle_speed_rad_per_s / units::rpm, 0.1);
  const std::string_view no_speed = name_in(monitor::no_speed_names, frame.no_speed);
  out["no_speed"] = no_speed.empty() ? Json(nullptr) : Json(no_speed);
  out["faults"] = monitor::fault_names(frame.faults);
  out["compute_us"] = rounded_positive(frame.compute_s / units::us, 0.1);
  out["pace"] = rounded(frame.pace, 0.01);
  const auto peak = std::ranges::max_element(frame.amplitude);
  if (peak == frame.amplitude.end() || !(*peak > 0.0F)) {
    out["peak_db"] = out["spectrum"] = nullptr;
    return out;
  }
  const int peak_db = decibels(*peak);
  const int strongest = static_cast<int>(level_letters.size()) - 1;
  std::string letters;
  for (const float amplitude : frame.amplitude) {
    const int level = amplitude > 0.0F ? decibels(amplitude) - peak_db + strongest : 0;
    letters += level_letters[static_cast<std::size_t>(std::clamp(level, 0, strongest))];
  }
  out["peak_db"] = peak_db;
  out["spectrum"] = std::move(letters);
  return out;
}

void FrameRing::add(const MonitorFrame& frame) {
  constexpr double frame_s = 1.0;
  if (!frames_.empty() && std::floor(frames_.back().clock_s / frame_s) == std::floor(frame.clock_s / frame_s)) {
    join(frames_.back(), frame, alarm_below_);
  } else {
    frames_.push_back(frame);
  }
  const double oldest_s = frame.clock_s - frame_s * static_cast<double>(most_frames);
  while (frames_.size() > most_frames || frames_.front().clock_s < oldest_s) frames_.pop_front();
}

}  // namespace robomill::serve
