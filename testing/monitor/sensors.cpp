#include "testing/monitor/sensors.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "testing/monitor/machine_cuts.hpp"

namespace robomill::monitor::testing {
namespace {

using std::numbers::pi;

/// Between the values of corpus_rate_hz, by a straight line.
float between(const std::vector<float>& values, double time_s) {
  const double row = std::clamp(time_s * corpus_rate_hz, 0.0, static_cast<double>(values.size() - 1));
  const auto k = static_cast<std::size_t>(row);
  const float next = values[std::min(k + 1, values.size() - 1)];
  return values[k] + static_cast<float>(row - static_cast<double>(k)) * (next - values[k]);
}

}  // namespace

std::vector<float> sensed(const CleanCut::Columns& vibration, const Sensors& sensors) {
  CleanCut::Columns heard = vibration;
  for (const Sensors::Echo& echo : sensors.echoes) {
    const auto delay = static_cast<Eigen::Index>(echo.delay_s * corpus_rate_hz);
    if (delay >= heard.rows()) continue;
    heard.bottomRows(heard.rows() - delay) += echo.gain * vibration.topRows(vibration.rows() - delay);
  }
  const double seconds = static_cast<double>(vibration.rows()) / corpus_rate_hz;
  const auto frames = static_cast<std::size_t>(seconds * sensors.sample_rate_hz);
  std::vector<float> out;
  out.reserve(frames * static_cast<std::size_t>(sensors.mix.rows()));
  for (std::size_t i = 0; i < frames; ++i) {
    const Eigen::RowVector2d xy = at_row(heard, static_cast<double>(i) / sensors.sample_rate_hz * corpus_rate_hz);
    for (Eigen::Index c = 0; c < sensors.mix.rows(); ++c) {
      out.push_back(static_cast<float>(sensors.mix.row(c).dot(xy)));
    }
  }
  return out;
}

Truth at_rate(const Truth& truth, double sample_rate_hz) {
  Truth out = truth;
  const double seconds = static_cast<double>(truth.amplitude_m_per_s2.size()) / corpus_rate_hz;
  const auto frames = static_cast<std::size_t>(seconds * sample_rate_hz);
  const auto each = [&](const std::vector<float>& from, std::vector<float>& to) {
    if (from.empty()) return;
    to.clear();
    for (std::size_t i = 0; i < frames; ++i) to.push_back(between(from, static_cast<double>(i) / sample_rate_hz));
  };
  each(truth.amplitude_m_per_s2, out.amplitude_m_per_s2);
  each(truth.speed_rad_per_s, out.speed_rad_per_s);
  each(truth.course_hz, out.course_hz);
  out.frequency_hz = folded_hz(truth.frequency_hz, sample_rate_hz);
  for (double& line : out.lines_hz) line = folded_hz(line, sample_rate_hz);
  return out;
}

MachineTone draw_tone(double low_hz, double high_hz, double amplitude, const std::vector<double>& rotations_hz,
                      Random& random) {
  MachineTone tone = {.amplitude = amplitude};
  const auto is_order = [&](double rotation_hz) {
    const double multiple = std::round(tone.frequency_hz / rotation_hz);
    return std::abs(tone.frequency_hz - multiple * rotation_hz) < std::max(2.0, 0.1 * rotation_hz);
  };
  do {
    tone.frequency_hz = std::exp(random.uniform(std::log(low_hz), std::log(high_hz)));
  } while (std::ranges::any_of(rotations_hz, is_order));
  return tone;
}

void add_tones(const std::vector<MachineTone>& tones, double sample_rate_hz, int channels, Random& random,
               std::vector<float>& samples) {
  const auto count = static_cast<std::size_t>(channels);
  for (const MachineTone& tone : tones) {
    for (std::size_t c = 0; c < count; ++c) {
      const double gain = tone.amplitude * random.uniform(0.3, 1.0), phase = random.uniform(0.0, 2.0 * pi);
      for (std::size_t i = 0; i < samples.size() / count; ++i) {
        const double t = static_cast<double>(i) / sample_rate_hz;
        const double fade =
            std::clamp((t - tone.from_s) / tone.fade_s, 0.0, 1.0) * std::clamp((tone.to_s - t) / tone.fade_s, 0.0, 1.0);
        if (fade <= 0.0) continue;
        const double swing = 1.0 + tone.swing * std::sin(2.0 * pi * tone.swing_hz * t);
        samples[count * i + c] +=
            static_cast<float>(gain * fade * swing * std::sin(2.0 * pi * tone.frequency_hz * t + phase));
      }
    }
  }
}

void add_orders(const DriveOrders& orders, const std::vector<double>& rotation_rad,
                const std::vector<float>& speed_rad_per_s, int channels, Random& random, std::vector<float>& samples) {
  const auto count = static_cast<std::size_t>(channels);
  struct Order {
    double multiple = 0.0, amplitude = 0.0;
  };
  std::vector<Order> all = {{1.0, orders.amplitude}, {2.0, 0.4 * orders.amplitude}, {3.0, 0.2 * orders.amplitude}};
  for (int k = 1; k <= 12; ++k) all.push_back({k / 3.0, orders.thirds * random.uniform(0.3, 1.0)});
  for (const Order& order : all) {
    if (order.amplitude <= 0.0) continue;
    for (std::size_t c = 0; c < count; ++c) {
      const double gain = order.amplitude * random.uniform(0.3, 1.0), phase = random.uniform(0.0, 2.0 * pi);
      for (std::size_t i = 0; i < samples.size() / count; ++i) {
        const auto speed = static_cast<double>(speed_rad_per_s[i]);
        const double share = speed / orders.nominal_rad_per_s;
        const double ratio = order.multiple * speed / (2.0 * pi * orders.resonance_hz);
        const std::complex<double> below(1.0 - ratio * ratio, 2.0 * orders.damping_ratio * ratio);
        samples[count * i + c] += static_cast<float>(gain * share * share / std::abs(below) *
                                                     std::sin(order.multiple * rotation_rad[i] + phase));
      }
    }
  }
}

}  // namespace robomill::monitor::testing
