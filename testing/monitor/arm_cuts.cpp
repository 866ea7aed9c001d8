#include "testing/monitor/arm_cuts.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "robomill/base/error.hpp"
#include "testing/monitor/arm_sensors.hpp"
#include "testing/monitor/sensors.hpp"

namespace robomill::monitor::testing {
namespace {

constexpr std::array<double, 3> arm_noises = {0.03, 0.1, 0.3};
constexpr double highest_arm_chatter_hz = 100.0;
constexpr double highest_line_hz = 150.0;  // a sideband of the arm's chatter, and not the tool's mode

/// What vibrates: without the load that comes and goes with the depth, below 3 Hz.
CleanCut without_load(CleanCut seen) {
  for (CleanCut::Columns* x : {&seen.acceleration_m_per_s2, &seen.forced_m_per_s2}) {
    for (Eigen::Index c = 0; c < 2; ++c) {
      TwoPoles load(3.0, 0.7, corpus_rate_hz);
      for (Eigen::Index i = 0; i < x->rows(); ++i) (*x)(i, c) -= load.next((*x)(i, c));
    }
  }
  return seen;
}

/// Root of the mean square of those rows in which the tool cuts at its full depth.
double forced_level(const CleanCut& vibration) {
  double squares = 0.0, count = 1e-300;
  for (std::size_t i = 0; i < vibration.depth_share.size(); ++i) {
    if (vibration.depth_share[i] < 0.999F) continue;
    squares += vibration.forced_m_per_s2.row(static_cast<Eigen::Index>(i)).squaredNorm();
    count += 2.0;
  }
  return std::sqrt(squares / count);
}

/// What regeneration adds from turn to turn stays small in the last third of a stable cut: after the entry's ringing.
bool settles_in_the_end(const ArmCut& cut) {
  const std::vector<float>& amplitude = cut.recorded.truth.amplitude_m_per_s2;
  const std::vector<float>& depth = cut.seen.depth_share;
  const auto last = std::find_if(depth.rbegin(), depth.rend(), [](float d) { return d > 0.999F; }).base();
  const auto end = last - depth.begin();
  const auto first = std::ranges::find_if(depth, [](float d) { return d > 0.0F; }) - depth.begin();
  double sum = 0.0;
  const auto from = end - (end - first) / 3;
  for (auto i = from; i < end; ++i) sum += std::pow(static_cast<double>(amplitude[static_cast<std::size_t>(i)]), 2);
  return std::sqrt(sum / static_cast<double>(end - from)) < 0.15 * cut.level;
}

/// Whether what was planned came true, as the sensor shows it.
bool arm_came_true(const ArmCut& cut) {
  const Truth& truth = cut.recorded.truth;
  if (!truth.chatter) return settles_in_the_end(cut);
  return truth.final_m_per_s2 > 0.5 * cut.level && truth.final_m_per_s2 < 20.0 * cut.level &&
         truth.displacement_hz > 7.0 && truth.displacement_hz < highest_arm_chatter_hz &&
         truth.frequency_hz < highest_line_hz && truth.end_s - truth.t10_s > 0.6 && !truth.lines_hz.empty() &&
         truth.comb_gain > 0.3;
}

}  // namespace

ArmCut draw_arm_cut(ArmSensor sensor, std::uint64_t seed) {
  Random random(seed, 4000 + static_cast<std::uint64_t>(sensor));
  const bool chatter = seed % 2 == 1;
  ArmCut out;
  RecordedCut& r = out.recorded;
  r.kind = name_in(arm_sensor_names, sensor);
  r.noise = static_cast<int>(seed / 2 % 3);
  const ArmSensing sensing = draw_sensing(sensor, seed / 6, random);
  for (int tries = 0; tries < 200; ++tries) {
    out.arm = draw_arm_plan(chatter, random);
    const CleanCut clean = simulate(out.arm.plan);
    if (clean.diverged) continue;
    out.seen = seen_by(sensing, clean);
    const CleanCut vibration = without_load(out.seen);
    out.level = forced_level(vibration);
    r.truth = truth_of(out.arm.plan, vibration, chatter);
    if (!arm_came_true(out)) continue;
    r.course = out.arm.course;
    r.teeth = out.arm.plan.teeth();
    r.sample_rate_hz = sensing.sampled.sample_rate_hz;
    r.channels = static_cast<int>(sensing.sampled.mix.rows());
    r.samples = sensed(out.seen.acceleration_m_per_s2, sensing.sampled);
    r.truth = at_rate(r.truth, r.sample_rate_hz);
    disturb_arm_cut(out, sensing, arm_noises.at(static_cast<std::size_t>(r.noise)), random, random, r.samples);
    const double off = random.uniform() < 0.2 ? 0.0 : random.uniform(-0.05, 0.05);
    r.hint_rad_per_s = out.arm.speed_rad_per_s * (1.0 + off);
    return out;
  }
  throw InvalidInput("seed", static_cast<double>(seed), "", "gave no cut of an arm that does as planned");
}

RecordedCut arm_cut_of_three_sensors(std::uint64_t seed) {
  ArmCut cut = draw_arm_cut(ArmSensor::spindle_accelerometer, seed);
  RecordedCut out = cut.recorded;
  const CleanCut clean = simulate(cut.arm.plan);
  const std::size_t frames = out.samples.size() / static_cast<std::size_t>(out.channels);
  std::vector<std::vector<float>> shown;
  Random random(seed, 5000);
  for (const ArmSensor sensor : {ArmSensor::spindle_accelerometer, ArmSensor::wrist_accelerometer, ArmSensor::force}) {
    ArmSensing sensing = draw_sensing(sensor, seed / 6, random);
    sensing.sampled.sample_rate_hz = out.sample_rate_hz;
    cut.seen = seen_by(sensing, clean);
    cut.level = forced_level(without_load(cut.seen));
    Random events(seed, 5001);
    shown.push_back(sensed(cut.seen.acceleration_m_per_s2, sensing.sampled));
    disturb_arm_cut(cut, sensing, arm_noises.at(static_cast<std::size_t>(out.noise)), random, events, shown.back());
  }
  out.kind = "three sensors";
  out.channels = 6;
  out.sensors = {0, 0, 1, 1, 2, 2};
  out.samples.clear();
  for (std::size_t i = 0; i < frames; ++i) {
    for (const std::vector<float>& one : shown) out.samples.insert(out.samples.end(), {one[2 * i], one[2 * i + 1]});
  }
  return out;
}

RecordedCut arm_cut(ArmSensor sensor, std::uint64_t seed) {
  return draw_arm_cut(sensor, seed).recorded;
}

}  // namespace robomill::monitor::testing
