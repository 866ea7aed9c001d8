#include "watch.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "robomill/base/units.hpp"

namespace robomill::app {
namespace {

constexpr std::array<const char*, 9> blocks = {" ", "▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
constexpr double range_db = 48.0;

std::string bar(const monitor::Decision& decision) {
  const int bands = std::clamp(decision.bands, 0, static_cast<int>(decision.band_level.size()));
  const auto end = decision.band_level.begin() + bands;
  const double greatest = bands > 0 ? static_cast<double>(*std::max_element(decision.band_level.begin(), end)) : 0.0;
  std::string out;
  for (auto level = decision.band_level.begin(); level != end; ++level) {
    const double db =
        greatest > 0.0 && *level > 0.0F ? 20.0 * std::log10(static_cast<double>(*level) / greatest) : -1e3;
    const double share = std::clamp(1.0 + db / range_db, 0.0, 1.0);
    out += blocks[static_cast<std::size_t>(std::ceil(share * 8.0))];
  }
  return out;
}

}  // namespace

std::string watch_line(const monitor::Decision& decision, double time_s) {
  std::string state(monitor::to_string(decision.state));
  if (decision.state == monitor::State::blind) state += fmt::format(" ({})", monitor::to_string(decision.reason));
  std::string line = fmt::format("{:9.3f} s  {:<10}  level {:<9.4g}  score {:7.3g} of {:<7.3g} [{}]", time_s, state,
                                 decision.level, decision.score, decision.threshold, bar(decision));
  if (decision.spindle_speed_rad_per_s > 0.0) {
    line += fmt::format("  {:.0f} rpm", decision.spindle_speed_rad_per_s / units::rpm);
  }
  if (decision.chatter_frequency_hz > 0.0) line += fmt::format("  {:.1f} Hz", decision.chatter_frequency_hz);
  return line;
}

Watch::Watch() : terminal_(isatty(STDERR_FILENO) != 0) {}

Watch::~Watch() {
  if (drawn_) std::fputs("\n", stderr);
}

void Watch::show(const monitor::Decision& decision, double time_s) {
  if (!terminal_) {
    // A change may be shown as a decision and as an event.
    const bool again = time_s == shown_s_ && decision.state == shown_state_;
    if (again || (time_s - shown_s_ < 1.0 && !decision.changed)) return;
    shown_s_ = time_s;
    shown_state_ = decision.state;
    fmt::print(stderr, "{}\n", watch_line(decision, time_s));
    return;
  }
  const auto now = std::chrono::steady_clock::now();
  if (now - shown_ < std::chrono::milliseconds(100) && !decision.changed) return;
  shown_ = now;
  drawn_ = true;
  fmt::print(stderr, "\r{}\033[K", watch_line(decision, time_s));
  std::fflush(stderr);
}

}  // namespace robomill::app
