// Chatter detected while it grows: three teeth at 6000 rpm, and from 3 s on a vibration that is no multiple of them.
#include <robomill/base/random.hpp>
#include <robomill/base/units.hpp>
#include <robomill/monitor/monitor.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <numbers>
#include <vector>

using namespace robomill;

constexpr double rate_hz = 10240.0, rotation_hz = 100.0, chatter_hz = 847.0, onset_s = 3.0;

// Acceleration [m/s^2] at the spindle: tooth passing with two harmonics, runout, noise, and chatter that grows to 20.
float acceleration(double time_s, Random& random) {
  const auto wave = [&](double frequency_hz) { return std::sin(2.0 * std::numbers::pi * frequency_hz * time_s); };
  const double cut = 2.0 * wave(rotation_hz) + 20.0 * wave(3 * rotation_hz) + 8.0 * wave(6 * rotation_hz) +
                     4.0 * wave(9 * rotation_hz) + random.normal();
  const double chatter = time_s < onset_s ? 0.0 : std::min(20.0, 0.2 * std::exp((time_s - onset_s) / 0.1));
  return static_cast<float>(cut + chatter * wave(chatter_hz));
}

int main() {
  monitor::ChatterMonitor monitor({.sample_rate_hz = rate_hz,
                                   .spindle_speed_rad_per_s = 6100 * units::rpm,  // as the controller shows it
                                   .teeth = 3});
  Random random(1);
  std::vector<float> samples;
  double alarm_s = 0.0, detected_hz = 0.0, speed_rad_per_s = 0.0;
  std::uint64_t frame = 0;
  while (frame < static_cast<std::uint64_t>(5.0 * rate_hz)) {
    samples.resize(monitor.frames_to_next_decision());
    for (float& sample : samples) sample = acceleration(static_cast<double>(frame++) / rate_hz, random);
    const monitor::Decision decision = monitor.push(samples);
    if (decision.changed)
      std::printf("%.3f s: %s, rms %.1f m/s2\n", decision.time_s, monitor::to_string(decision.state).data(),
                  decision.level);
    if (decision.state != monitor::State::chatter) continue;
    if (alarm_s == 0.0) alarm_s = decision.time_s;
    detected_hz = decision.chatter_frequency_hz;
    speed_rad_per_s = decision.spindle_speed_rad_per_s;
  }
  std::printf("chatter began at %.3f s, was detected %.0f ms later at %.1f Hz (is %.1f Hz); spindle at %.0f rpm\n",
              onset_s, (alarm_s - onset_s) / units::ms, detected_hz, chatter_hz, speed_rad_per_s / units::rpm);
  return alarm_s > onset_s && alarm_s < onset_s + 0.5 && std::abs(detected_hz - chatter_hz) < 1.0 ? 0 : 1;
}
