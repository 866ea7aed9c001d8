#include "testing/monitor/arm_sensors.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "testing/monitor/machine_cuts.hpp"

namespace robomill::monitor::testing {
namespace {

using std::numbers::pi;

/// Interleaved samples with what is true at their frames.
struct ArmFrames {
  const ArmCut& cut;
  double rate_hz = 0.0;
  std::size_t channels = 1;
  std::vector<float>& samples;
  [[nodiscard]] std::size_t count() const { return samples.size() / channels; }
  [[nodiscard]] double seconds() const { return static_cast<double>(count()) / rate_hz; }
  [[nodiscard]] std::size_t row(std::size_t frame) const {
    const auto row = static_cast<std::size_t>(static_cast<double>(frame) * corpus_rate_hz / rate_hz);
    return std::min(row, cut.seen.depth_share.size() - 1);
  }
  [[nodiscard]] bool cuts(std::size_t frame) const { return cut.seen.depth_share[row(frame)] > 0.0F; }
  /// When the tool is in contact first and last.
  [[nodiscard]] std::array<double, 2> contact_s() const {
    const std::vector<float>& depth = cut.seen.depth_share;
    const auto is_cutting = [](float d) { return d > 0.0F; };
    const auto first = std::ranges::find_if(depth, is_cutting) - depth.begin();
    const auto last = std::find_if(depth.rbegin(), depth.rend(), is_cutting).base() - depth.begin();
    return {static_cast<double>(first) / corpus_rate_hz, static_cast<double>(last) / corpus_rate_hz};
  }
};

CleanCut::Columns low_passed(CleanCut::Columns x, const ArmSensing::LowPass& low_pass) {
  for (Eigen::Index c = 0; c < 2; ++c) {
    TwoPoles filter(low_pass.frequency_hz, low_pass.damping_ratio, corpus_rate_hz);
    for (Eigen::Index i = 0; i < x.rows(); ++i) x(i, c) = filter.next(x(i, c));
  }
  return x;
}

/// White, red, and, while cutting, what an uneven material does to the arm's modes.
void add_arm_noise(const ArmFrames& frames, double noise, Random& random) {
  for (std::size_t c = 0; c < frames.channels; ++c) {
    std::vector<TwoPoles> modes;
    for (int k = 0; k < frames.cut.arm.arm_modes; ++k) {
      const modal::Mode& mode = frames.cut.arm.dynamics.modes[static_cast<std::size_t>(k)];
      modes.emplace_back(mode.frequency_hz, mode.damping_ratio, frames.rate_hz);
    }
    const double keep = std::exp(-2.0 * pi * 3.0 / frames.rate_hz), share = 0.5 / std::sqrt(modes.size());
    double red = 0.0;
    for (std::size_t i = 0; i < frames.count(); ++i) {
      red = keep * red + std::sqrt(1.0 - keep * keep) * random.normal();
      double value = 0.75 * random.normal() + 0.35 * red;
      for (TwoPoles& mode : modes) {
        value += share / mode.noise_gain() * mode.next(frames.cuts(i) ? random.normal() : 0.0);
      }
      frames.samples[frames.channels * i + c] += static_cast<float>(noise * value);
    }
  }
}

/// What turns with the spindle without cutting, and hum of the mains.
void add_unbalance_and_hum(const ArmFrames& frames, double unbalance, double hum, Random& random) {
  const double hum_hz = 50.0 * random.uniform(0.998, 1.002);
  for (std::size_t c = 0; c < frames.channels; ++c) {
    const double phase = random.uniform(0.0, 2.0 * pi), hum_phase = random.uniform(0.0, 2.0 * pi);
    for (std::size_t i = 0; i < frames.count(); ++i) {
      const double angle = 2.0 * pi * hum_hz * static_cast<double>(i) / frames.rate_hz + hum_phase;
      const double value = unbalance * std::sin(frames.cut.seen.rotation_rad[frames.row(i)] + phase) +
                           hum * (std::sin(angle) + 0.5 * std::sin(2.0 * angle) + 0.3 * std::sin(3.0 * angle));
      frames.samples[frames.channels * i + c] += static_cast<float>(value);
    }
  }
}

/// Drives, pumps and fans that run throughout, and axes that move for a while in the cut.
std::vector<MachineTone> tones_of_drives(const ArmFrames& frames, Random& random) {
  const std::vector<double> rotations = {frames.cut.arm.speed_rad_per_s / (2.0 * pi)};
  const double highest_hz = std::min(500.0, 0.45 * frames.rate_hz), level = frames.cut.level;
  std::vector<MachineTone> out;
  for (std::uint64_t left = 1 + random.index(3); left > 0; --left) {
    out.push_back(draw_tone(8.0, highest_hz, level * log_uniform(0.01, 0.15, random), rotations, random));
    out.back().swing = random.uniform(0.0, 0.4);
    out.back().swing_hz = random.uniform(0.2, 2.0);
  }
  const auto [first_s, last_s] = frames.contact_s();
  for (std::uint64_t left = random.index(3); left > 0; --left) {
    MachineTone tone = draw_tone(8.0, 0.5 * highest_hz, level * log_uniform(0.03, 0.25, random), rotations, random);
    tone.from_s = random.uniform(first_s + 0.3, std::max(first_s + 0.4, last_s - 0.3));
    tone.to_s = tone.from_s + random.uniform(0.3, 2.0);
    tone.fade_s = log_uniform(0.02, 0.15, random);
    out.push_back(tone);
  }
  return out;
}

/// A blow makes the arm ring, and what carries the sensor.
void add_arm_knocks(const ArmFrames& frames, double per_s, double most_levels, Random& random) {
  for (double t = -std::log(1.0 - random.uniform()) / per_s; t < frames.seconds();
       t -= std::log(1.0 - random.uniform()) / per_s) {
    const double peak = frames.cut.level * log_uniform(0.5, most_levels, random);
    const double local_hz = random.uniform(0.2, 0.4) * frames.rate_hz,
                 local_decay = local_hz * random.uniform(0.1, 0.3);
    for (std::size_t c = 0; c < frames.channels; ++c) {
      const double local = peak * random.uniform(0.0, 0.6);
      std::vector<double> shares;
      for (int k = 0; k < frames.cut.arm.arm_modes; ++k) shares.push_back(peak * random.uniform(-0.6, 0.6));
      for (auto i = static_cast<std::size_t>(t * frames.rate_hz); i < frames.count(); ++i) {
        const double since_s = static_cast<double>(i) / frames.rate_hz - t;
        if (since_s > 3.0) break;
        double value = local * std::exp(-local_decay * since_s) * std::sin(2.0 * pi * local_hz * since_s);
        for (std::size_t k = 0; k < shares.size(); ++k) {
          const std::complex<double> pole = modal::pole(frames.cut.arm.dynamics.modes[k]);
          value += shares[k] * std::exp(pole.real() * since_s) * std::sin(pole.imag() * since_s);
        }
        frames.samples[frames.channels * i + c] += static_cast<float>(value);
      }
    }
  }
}

/// Of a joint that moves with the feed: its gear and its motor's poles make tones that follow its slowly changing
/// speed.
void add_gear_ripple(const ArmFrames& frames, std::size_t channel, Random& random) {
  const double level = frames.cut.level, motor_hz = log_uniform(0.3, 12.0, random);
  const double swing = random.uniform(0.0, 0.4), swing_hz = log_uniform(0.05, 0.4, random);
  const double pole_pairs = 3.0 + static_cast<double>(random.index(3));
  // A strain wave gear twice a turn of its motor; cogging and the commutation of three phases.
  const std::array<double, 4> multiples = {1.0, 2.0, 2.0 * pole_pairs, 6.0 * pole_pairs};
  std::array<double, 4> amplitudes = {};
  for (double& a : amplitudes) a = level * log_uniform(0.02, 0.2, random);
  double angle = random.uniform(0.0, 2.0 * pi);
  const double phase = random.uniform(0.0, 2.0 * pi);
  for (std::size_t i = 0; i < frames.count(); ++i) {
    const double t = static_cast<double>(i) / frames.rate_hz;
    const double now_hz = motor_hz * (1.0 + swing * std::sin(2.0 * pi * swing_hz * t + phase));
    angle += 2.0 * pi * now_hz / frames.rate_hz;
    double value = 0.0;
    for (std::size_t k = 0; k < multiples.size(); ++k) value += amplitudes[k] * std::sin(multiples[k] * angle);
    frames.samples[frames.channels * i + channel] += static_cast<float>(value);
  }
}

/// What a drive's trace has beside: the load of gravity, ripple of the switching, folded, and the converter's steps.
void add_drive_trace(const ArmFrames& frames, Random& random) {
  const double level = frames.cut.level, step = level * log_uniform(0.003, 0.03, random);
  const double folded = folded_hz(random.uniform(4000.0, 16000.0), frames.rate_hz);
  const double ripple = level * log_uniform(0.01, 0.1, random);
  for (std::size_t c = 0; c < frames.channels; ++c) {
    if (random.uniform() < 0.7) add_gear_ripple(frames, c, random);
    const double holding = level * random.uniform(-8.0, 8.0), drift = level * random.uniform(0.0, 1.0);
    const double drift_hz = log_uniform(0.03, 0.2, random), gain = ripple * random.uniform(0.3, 1.0);
    const double phase = random.uniform(0.0, 2.0 * pi);
    for (std::size_t i = 0; i < frames.count(); ++i) {
      const double t = static_cast<double>(i) / frames.rate_hz;
      const double value =
          holding + drift * std::sin(2.0 * pi * drift_hz * t + phase) + gain * std::sin(2.0 * pi * folded * t + phase);
      float& sample = frames.samples[frames.channels * i + c];
      sample = static_cast<float>(step * std::round((static_cast<double>(sample) + value) / step));
    }
  }
}

}  // namespace

TwoPoles::TwoPoles(double frequency_hz, double damping_ratio, double sample_rate_hz) {
  const double angle = 2.0 * pi * frequency_hz / sample_rate_hz;
  const double radius = std::exp(-damping_ratio * angle);
  turn_ = 2.0 * radius * std::cos(angle * std::sqrt(1.0 - damping_ratio * damping_ratio));
  square_ = radius * radius;
  gain_ = 1.0 - turn_ + square_;
}

double TwoPoles::noise_gain() const {
  const double sum = 1.0 + square_;
  return gain_ * std::sqrt(sum / ((1.0 - square_) * (sum * sum - turn_ * turn_)));
}

ArmSensing draw_sensing(ArmSensor sensor, std::uint64_t choice, Random& random) {
  ArmSensing out = {.sensor = sensor, .sampled = {.sample_rate_hz = 5120.0}};
  double& rate_hz = out.sampled.sample_rate_hz;
  if (sensor == ArmSensor::wrist_accelerometer) {
    rate_hz = 2048.0;
    out.low_passes.push_back({random.uniform(80.0, 200.0), 0.5});
  }
  if (sensor == ArmSensor::force && choice % 2 == 0) rate_hz = 1024.0;
  if (!out.of_drives()) {
    out.low_passes.push_back({0.35 * rate_hz});
    return out;
  }
  rate_hz = std::array{250.0, 500.0, 1000.0}.at(choice % 3);
  out.low_passes.push_back({random.uniform(60.0, 150.0)});
  // A stiffness of 1e6 N/m, a lever of half a metre, a gear of 100; an estimated torque is smoothed once more.
  out.scale = 5e3;
  if (sensor == ArmSensor::drive_current) {
    out.scale /= random.uniform(0.3, 1.0);
  } else {
    out.low_passes.push_back({random.uniform(60.0, 100.0)});
  }
  out.sampled.mix.resize(2 + static_cast<Eigen::Index>(random.index(5)), 2);
  for (Eigen::Index c = 0; c < out.sampled.mix.rows(); ++c) {
    const double direction = random.uniform(0.0, 2.0 * pi), gain = log_uniform(0.2, 1.0, random);
    out.sampled.mix.row(c) << gain * std::cos(direction), gain * std::sin(direction);
  }
  return out;
}

CleanCut seen_by(const ArmSensing& sensing, const CleanCut& clean) {
  CleanCut out = clean;
  if (sensing.of_drives()) {
    out.acceleration_m_per_s2 = sensing.scale * clean.displacement_m;
    out.forced_m_per_s2 = sensing.scale * clean.forced_displacement_m;
  } else if (sensing.sensor == ArmSensor::force) {
    out.acceleration_m_per_s2 = clean.force_n;
    out.forced_m_per_s2 = clean.forced_force_n;
  }
  for (const ArmSensing::LowPass& low_pass : sensing.low_passes) {
    out.acceleration_m_per_s2 = low_passed(out.acceleration_m_per_s2, low_pass);
    out.forced_m_per_s2 = low_passed(out.forced_m_per_s2, low_pass);
  }
  return out;
}

void disturb_arm_cut(const ArmCut& cut, const ArmSensing& sensing, double noise, Random& random, Random& events,
                     std::vector<float>& samples) {
  const ArmFrames frames = {.cut = cut,
                            .rate_hz = sensing.sampled.sample_rate_hz,
                            .channels = static_cast<std::size_t>(sensing.sampled.mix.rows()),
                            .samples = samples};
  const double level = cut.level, turning = sensing.of_drives() ? 0.2 : 1.0;
  add_arm_noise(frames, noise * level, random);
  add_unbalance_and_hum(frames, turning * level * events.uniform(0.01, 0.1), level * events.uniform(0.005, 0.03),
                        events);
  add_tones(tones_of_drives(frames, events), frames.rate_hz, static_cast<int>(frames.channels), events, samples);
  add_arm_knocks(frames, events.uniform(0.05, 0.4), sensing.of_drives() ? 3.0 : 8.0, events);
  if (sensing.of_drives()) add_drive_trace(frames, random);
}

}  // namespace robomill::monitor::testing
