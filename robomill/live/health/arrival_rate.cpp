#include "robomill/live/health/arrival_rate.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

namespace robomill::live {
namespace {

constexpr double settling_s = 2.0, measured_s = 10.0;
constexpr double tolerance = 0.1;

}  // namespace

std::optional<double> ArrivalRate::add(std::uint64_t frames, Clock::time_point now) {
  const auto since = [now](Clock::time_point then) { return std::chrono::duration<double>(now - then).count(); };
  if (!std::exchange(begun_, true) || since(last_) > longest_pause_s_) {
    settled_ = false;
    begin_ = now;
  }
  last_ = now;
  const double passed_s = since(begin_);
  if (!settled_) {
    if (passed_s < settling_s) return std::nullopt;
    settled_ = true;
    begin_ = now;
    frames_ = 0;
    return std::nullopt;
  }
  frames_ += frames;
  if (passed_s < measured_s) return std::nullopt;
  const double measured_hz = static_cast<double>(std::exchange(frames_, 0)) / passed_s;
  begin_ = now;
  if (std::abs(measured_hz / sample_rate_hz_ - 1.0) <= tolerance) return std::nullopt;
  return measured_hz;
}

std::string ArrivalRate::message(double measured_hz) const {
  return fmt::format(
      "frames arrive at {:.4g} Hz, not at signal.sample_rate_hz = {:.6g} Hz; is the rate, the number of columns or the "
      "format another?",
      measured_hz, sample_rate_hz_);
}

}  // namespace robomill::live
