#include "robomill/path/speed/feed_override.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace robomill::path {
namespace {

/// Of a limit: what is used, the rest being for rounding and for what differences of samples see more than derivatives.
constexpr double used = 0.985, used_velocity = 0.9995;
/// Caps come in steps, so that few differ.
constexpr double caps_per_unit = 50.0;
/// The brake in whole periods lags behind the one in continuous time, by less than this many.
constexpr double lag_periods = 6.0;
/// Overrides at which a slope is looked for; between them it may be 0.3 % too large.
constexpr int looked_at = 10;

const double root = std::sqrt(override_limits::alpha);
const double theta_of_one = std::atanh(root) / root;

double gain(double s) {
  const double below = std::min(s, 1.0);
  return 1.0 - override_limits::alpha * below * below;
}

/// What one channel demands, in units of its limits; time in s.
struct Share {
  double velocity, acceleration, jerk;  // |x'| / A, |x''| / A, |x'''| / J
  double to_jerk, velocity_to_jerk;     // |x''| / J, |x'| / J
};

/// A jerk beyond what a plan may have is one that the planner's points have missed, shorter than a period perhaps: the
/// differences of samples see a step of acceleration then, which sinks with s² only.
double jerk_at(const Share& c, double s) {
  return c.jerk * s * s * (c.jerk > override_limits::beta ? 1.0 : s);
}

/// Largest slope at an override; <= 0: none.
double slope_at(const Share& c, double s) {
  const double g = gain(s), bend = s < 1.0 ? 2.0 * override_limits::alpha * s : 0.0;
  const double by_acceleration = (used - c.acceleration * s * s) / std::max(c.velocity * g, 1e-12);
  const double left = used - jerk_at(c, s);
  if (left <= 0.0) return 0.0;
  const double b = 3.0 * c.to_jerk * s * g, a = c.velocity_to_jerk * g * (override_limits::kappa + bend);
  return std::min(by_acceleration, 2.0 * left / std::max(b + std::sqrt(b * b + 4.0 * a * left), 1e-12));
}

}  // namespace

void Demand::add(const Demand& other) noexcept {
  for (std::size_t k = 0; k < channel_count; ++k) {
    velocity[k] = std::max(velocity[k], other.velocity[k]);
    acceleration[k] = std::max(acceleration[k], other.acceleration[k]);
    jerk[k] = std::max(jerk[k], other.jerk[k]);
  }
  feed = std::max(feed, other.feed);
}

Stretch stretch_of(const Demand& demand, const ChannelLimits& limits, double max_slope) noexcept {
  std::array<Share, channel_count> channel = {};
  double cap = override_limits::max;
  for (std::size_t k = 0; k < channel_count; ++k) {
    Share& c = channel[k];
    c = {.velocity = demand.velocity[k] / limits.acceleration[k],
         .acceleration = demand.acceleration[k] / limits.acceleration[k],
         .jerk = demand.jerk[k] / limits.jerk[k],
         .to_jerk = demand.acceleration[k] / limits.jerk[k],
         .velocity_to_jerk = demand.velocity[k] / limits.jerk[k]};
    cap = std::min({cap, used_velocity * limits.velocity[k] / std::max(demand.velocity[k], 1e-12),
                    std::sqrt(override_limits::alpha / std::max(c.acceleration, 1e-12)),
                    c.jerk > override_limits::beta ? std::sqrt(override_limits::beta / c.jerk)
                                                   : std::cbrt(override_limits::beta / std::max(c.jerk, 1e-12))});
  }
  const auto step = [](double s) { return std::max(std::floor(s * caps_per_unit), 1.0) / caps_per_unit; };
  cap = step(cap);
  double slope = max_slope;
  for (int i = 1; i <= looked_at; ++i) {
    const double s = std::min(cap, 1.0) * i / looked_at;
    for (const Share& c : channel) slope = std::min(slope, slope_at(c, s));
  }
  // Above override 1 the slope found has to do.
  const auto holds = [&](double s) {
    return std::all_of(channel.begin(), channel.end(), [&](const Share& c) { return slope_at(c, s) >= slope; });
  };
  while (cap > 1.0 && !holds(cap)) cap = std::max(1.0, cap - 2.0 / caps_per_unit);
  const double feed = used_velocity / std::max(demand.feed, 1e-12);
  return {.slope = slope, .cap = cap, .feed = feed < 1.0 ? std::min(cap, step(feed)) : cap};
}

double override_of(double theta) noexcept {
  if (theta >= theta_of_one) return 1.0 + (1.0 - override_limits::alpha) * (theta - theta_of_one);
  return theta > 0.0 ? std::tanh(root * theta) / root : 0.0;
}

double theta_of(double feed_override) noexcept {
  if (feed_override >= 1.0) return theta_of_one + (feed_override - 1.0) / (1.0 - override_limits::alpha);
  return feed_override > 0.0 ? std::atanh(root * feed_override) / root : 0.0;
}

double OverrideState::peak(double slope) const noexcept {
  return speed > 0.0 ? theta + 0.5 * speed * speed / (override_limits::kappa * slope * slope) : theta;
}

OverrideState approach(const OverrideState& from, double target, double slope, double period_s) noexcept {
  const double error = target - from.theta, sign = error < 0.0 ? -1.0 : 1.0;
  const double jerk = override_limits::kappa * slope * slope, v = sign * from.speed, step = jerk * period_s;
  if (std::abs(error) < 1e-12 && std::abs(v) < 1e-9) return {.theta = target, .speed = 0.0};
  // The speed w from which, a period later and with a period to spare, it can still stop:
  // (v + w) T / 2 + w T / 2 + w² / (2 jerk) = |error|.
  const double left = std::abs(error) - 0.5 * v * period_s;
  double w =
      left > 0.0 ? 2.0 * left / (period_s + std::sqrt(period_s * period_s + 2.0 * left / jerk)) : left / period_s;
  w = std::clamp(std::min(w, slope), v - step, v + step);
  return {.theta = from.theta + sign * 0.5 * (v + w) * period_s, .speed = sign * w};
}

double travel_s(const OverrideState& from, double base, double until, double slope, double period_s) noexcept {
  const double jerk = override_limits::kappa * slope * slope, w = from.speed, height = from.theta - base;
  if (from.peak(slope) <= until) return 0.0;
  const double least = w < 0.0 ? 0.5 * w * w / jerk - 0.5 * w * period_s : 0.0;
  if (std::abs(w) > slope * (1.0 + 1e-12) || height < least * (1.0 - 1e-9) - 1e-12) {
    return std::numeric_limits<double>::infinity();
  }
  // Down to a speed p at −jerk, on at it, and back to rest at +jerk. θ̇ falls and s is concave in θ, so a phase's plan
  // time is at most its time times s of its mean θ.
  const double p = std::min(slope, std::sqrt(jerk * height + 0.5 * w * w));
  const double first_end = height + 0.5 * (w * w - p * p) / jerk, last_begin = 0.5 * p * p / jerk;
  const double drop = std::max(0.0, until - base);
  double out = lag_periods * period_s * override_of(from.peak(slope));
  const auto pass = [&](double time, double mean) { out += time * override_of(base + mean); };
  const double first_s =
      drop >= first_end ? (w + std::sqrt(std::max(0.0, w * w + 2.0 * jerk * (height - drop)))) / jerk : (w + p) / jerk;
  pass(first_s, height + first_s * (0.5 * w - jerk * first_s / 6.0));
  if (drop >= first_end) return out;
  const double lowest = std::max(drop, last_begin);
  if (first_end > lowest) {
    const double half_s = 0.5 * (first_end - lowest) / p;
    pass(half_s, 0.75 * first_end + 0.25 * lowest);
    pass(half_s, 0.25 * first_end + 0.75 * lowest);
  }
  if (drop >= last_begin) return out;
  const double begin_s = p / jerk, end_s = std::sqrt(2.0 * drop / jerk);
  pass(begin_s - end_s, jerk / 6.0 * (begin_s * begin_s + begin_s * end_s + end_s * end_s));
  return out;
}

double passed_s(const OverrideState& from, const OverrideState& to, double period_s) noexcept {
  const double begin = override_of(from.theta);
  if (from.speed == 0.0 && to.speed == 0.0) return period_s * begin;
  const double middle = from.theta + period_s * (0.375 * from.speed + 0.125 * to.speed);
  return period_s / 6.0 * (begin + 4.0 * override_of(middle) + override_of(to.theta));
}

}  // namespace robomill::path
