#include "testing/monitor/modelled_chatter.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace robomill::monitor::testing {
namespace {

using std::numbers::pi;

constexpr double visit_s = 0.015, wander_s = 0.05;

double amplitude(const ModelledChatter& c, double time_s) {
  const double grown = 1.0 / (1.0 + std::exp(-c.growth_per_s * (time_s - c.half_s)));
  const double left = time_s < c.end_s ? 1.0 : std::exp(-c.decay_per_s * (time_s - c.end_s));
  return c.final_m_per_s2 * grown * left;
}

double drift_hz(const ModelledChatter& c, double time_s) {
  return c.drift_hz_per_s * (std::clamp(time_s, c.drift_from_s, c.drift_to_s) - c.drift_from_s);
}

std::size_t visited(const ModelledChatter& c, double time_s) {
  std::size_t mode = c.visits.front().mode;
  for (const ModelledChatter::Visit& v : c.visits) {
    if (v.from_s <= time_s) mode = v.mode;
  }
  return mode;
}

}  // namespace

Truth add_chatter(const ModelledChatter& c, const CutPlan& plan, Random& random, CleanCut& clean) {
  const Eigen::Index n = clean.acceleration_m_per_s2.rows();
  const double dt = 1.0 / corpus_rate_hz, teeth = plan.teeth();
  const double tooth_hz = teeth * static_cast<double>(clean.speed_rad_per_s.front()) / (2.0 * pi);
  double lowest_hz = 1e300;
  for (const auto& mode : c.modes) lowest_hz = std::min(lowest_hz, mode.frequency_hz);
  lowest_hz += std::min(0.0, drift_hz(c, 1e300));
  const double upper = c.sideband, lower = lowest_hz - tooth_hz > 20.0 ? c.sideband : 0.0;
  const double scale = 2.0 / std::sqrt(1.0 + upper * upper + lower * lower);

  Truth truth;
  truth.chatter = true;
  truth.speed_rad_per_s = clean.speed_rad_per_s;
  std::vector<double> phase, weight(c.modes.size(), 0.0);
  for (std::size_t m = 0; m < c.modes.size(); ++m) phase.push_back(random.uniform(0.0, 2.0 * pi));
  weight[c.visits.front().mode] = 1.0;
  const double between_channels = random.uniform(0.0, pi), tooth_phase = random.uniform(0.0, 2.0 * pi);
  const double keep = std::exp(-dt / wander_s), follow = 1.0 - std::exp(-dt / visit_s);
  double wander = 0.0, last_contact_s = -1e300;
  for (Eigen::Index i = 0; i < n; ++i) {
    const double t = static_cast<double>(i) * dt;
    if (clean.depth_share[static_cast<std::size_t>(i)] > 0.0F) last_contact_s = t;
    const double a = t - last_contact_s < 1.0 ? amplitude(c, t) : 0.0;
    wander = keep * wander + std::sqrt(1.0 - keep * keep) * c.wander_hz * random.normal();
    const std::size_t now = visited(c, t);
    const double moved = drift_hz(c, t) + wander;
    const double tooth = teeth * clean.rotation_rad[static_cast<std::size_t>(i)] + tooth_phase;
    double power = 0.0;
    for (std::size_t m = 0; m < c.modes.size(); ++m) {
      weight[m] += follow * ((m == now ? 1.0 : 0.0) - weight[m]);
      phase[m] += 2.0 * pi * dt * (c.modes[m].frequency_hz + moved);
      power += weight[m] * weight[m];
      for (Eigen::Index k = 0; k < 2; ++k) {
        const double share = k == 0 ? std::cos(c.modes[m].direction_rad) : std::sin(c.modes[m].direction_rad);
        const double p = phase[m] + (k == 0 ? 0.0 : between_channels);
        clean.acceleration_m_per_s2(i, k) +=
            a * weight[m] * scale * share * (std::cos(p) + upper * std::cos(p + tooth) + lower * std::cos(p - tooth));
      }
    }
    truth.amplitude_m_per_s2.push_back(static_cast<float>(a * std::sqrt(power)));
    truth.course_hz.push_back(static_cast<float>(c.modes[now].frequency_hz + moved));
  }
  find_times(truth, reference_level(plan, clean));
  truth.frequency_hz = c.modes[c.visits.front().mode].frequency_hz;
  truth.lines_hz = {truth.frequency_hz};
  const double least = std::sqrt(0.1);  // 10 dB
  if (upper > least) truth.lines_hz.push_back(truth.frequency_hz + tooth_hz);
  if (lower > least) truth.lines_hz.push_back(truth.frequency_hz - tooth_hz);
  return truth;
}

}  // namespace robomill::monitor::testing
