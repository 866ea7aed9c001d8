#include "robomill/monitor/calibration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "robomill/base/error.hpp"
#include "robomill/base/parallel.hpp"
#include "robomill/base/random.hpp"
#include "robomill/monitor/entropy.hpp"
#include "robomill/monitor/published/visibility.hpp"

namespace robomill::monitor {
namespace {

/// The entropy of a recording, hop by hop, and what stands in its label.
struct Course {
  bool chatter = false;
  double onset_s = unknown_s;
  std::vector<double> time_s, entropy;
  Visibility visible;
};
using Courses = std::vector<const Course*>;

Course course_of(const Recording& recording, const MonitorOptions& o) {
  Course course = {recording.chatter, recording.onset_s, {}, {}, visibility(recording, o)};
  const auto channels = static_cast<std::size_t>(o.channels);
  const std::size_t hop = o.hop_samples(), frames = recording.samples.size() / channels;
  std::vector<double> part(hop);
  for (std::size_t c = 0; c < channels; ++c) {
    if (static_cast<int>(c) == o.tachometer_channel) continue;
    EnergyEntropy feature(o);
    std::size_t at = 0;  // of the course
    for (std::size_t end = hop; end <= frames; end += hop) {
      for (std::size_t j = 0; j < hop; ++j) {
        part[j] = static_cast<double>(recording.samples[(end - hop + j) * channels + c]);
      }
      const double value = feature.push(part);
      if (end < feature.warm_up()) continue;
      if (at == course.entropy.size()) {
        course.entropy.push_back(0.0);
        course.time_s.push_back(static_cast<double>(end - 1) / o.sample_rate_hz);
      }
      course.entropy[at++] += value;
    }
  }
  return course;
}

bool beyond(double value, double threshold, bool below) {
  return below ? value < threshold : value > threshold;
}

std::optional<double> alarm_of(const Course& course, double threshold, bool below) {
  for (std::size_t m = 0; m < course.entropy.size(); ++m) {
    if (beyond(course.entropy[m], threshold, below)) return course.time_s[m];
  }
  return std::nullopt;
}

bool is_early(const Course& course, double alarm_s, const MonitorOptions& o) {
  return alarm_s < course.onset_s - o.window_s;  // not where the onset is NaN
}

double median_or_unknown(std::vector<double> values) {
  if (values.empty()) return unknown_s;
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

RocPoint rates(const Courses& half, double threshold, bool below, const MonitorOptions& o) {
  double stable = 0.0, alarms = 0.0, chatter = 0.0, detected = 0.0;
  std::vector<double> delays;
  for (const Course* course : half) {
    const std::optional<double> alarm = alarm_of(*course, threshold, below);
    (course->chatter ? chatter : stable) += 1.0;
    if (!alarm) continue;
    if (!course->chatter) {
      alarms += 1.0;
    } else if (!is_early(*course, *alarm, o)) {
      detected += 1.0;
      if (std::isfinite(course->onset_s)) delays.push_back(*alarm - course->onset_s);
    }
  }
  return {threshold, alarms / stable, detected / chatter, median_or_unknown(std::move(delays))};
}

/// The value of each course that is furthest on the side of the alarm, the furthest first.
std::vector<double> extremes(const Courses& half, bool below) {
  std::vector<double> out;
  for (const Course* course : half) {
    const auto [least, most] = std::minmax_element(course->entropy.begin(), course->entropy.end());
    out.push_back(below ? *least : *most);
  }
  std::sort(out.begin(), out.end(), [below](double a, double b) { return beyond(a, b, below); });
  return out;
}

std::vector<RocPoint> roc_of(const Courses& half, bool below, const MonitorOptions& o) {
  std::vector<RocPoint> roc;
  std::vector<double> thresholds = extremes(half, below);
  thresholds.erase(std::unique(thresholds.begin(), thresholds.end()), thresholds.end());
  roc.reserve(thresholds.size() + 1);
  for (const double threshold : thresholds) roc.push_back(rates(half, threshold, below, o));
  // And one that every course goes beyond.
  roc.push_back(rates(half, std::nextafter(thresholds.back(), below ? 1e300 : -1e300), below, o));
  return roc;
}

CalibratedHalf calibrated(const Courses& half, const MonitorOptions& o) {
  const auto chatter = std::count_if(half.begin(), half.end(), [](const Course* course) { return course->chatter; });
  return {static_cast<int>(half.size()) - static_cast<int>(chatter), static_cast<int>(chatter),
          rates(half, o.threshold, o.alarm_below, o), roc_of(half, o.alarm_below, o)};
}

void require_recordings(std::span<const Recording> recordings, const MonitorOptions& o) {
  int count[2] = {0, 0};
  for (const Recording& recording : recordings) {
    ++count[recording.chatter ? 1 : 0];
    const auto channels = static_cast<std::size_t>(o.channels);
    if (recording.samples.size() % channels != 0) throw InvalidInput(recording.name, "ends within a frame");
    if (recording.samples.size() / channels < 3 * o.window_samples()) {
      throw InvalidInput(recording.name, "must be at least three windows long");
    }
    if (!std::all_of(recording.samples.begin(), recording.samples.end(), [](float x) { return std::isfinite(x); })) {
      throw InvalidInput(recording.name, "must be finite");
    }
  }
  if (count[1] == 0) throw InvalidInput("recordings", "hold no chatter", "Without it no threshold can be set.");
  if (count[0] == 0) throw InvalidInput("recordings", "hold no stable cut", "Without it no threshold can be set.");
  for (const bool chatter : {false, true}) {
    if (count[chatter ? 1 : 0] >= 2) continue;
    throw InvalidInput("recordings", 1.0, chatter ? "with chatter" : "stable",
                       "must be at least two, one to set the threshold and one to verify it");
  }
}

/// Which recordings verify: half of the stable ones, and half of those with chatter, rounded down.
std::vector<bool> drawn_to_verify(std::span<const Recording> recordings, std::uint64_t seed) {
  std::vector<bool> verifies(recordings.size(), false);
  Random random(seed);
  for (const bool chatter : {false, true}) {
    std::vector<std::size_t> order;
    for (std::size_t r = 0; r < recordings.size(); ++r) {
      if (recordings[r].chatter == chatter) order.push_back(r);
    }
    for (std::size_t k = 0; k < order.size() / 2; ++k) {
      std::swap(order[k], order[k + random.index(order.size() - k)]);
      verifies[order[k]] = true;
    }
  }
  return verifies;
}

/// Whether one threshold finds more than another, or as much and earlier.
bool better(const RocPoint& one, const RocPoint& other) {
  if (one.detection_rate != other.detection_rate) return one.detection_rate > other.detection_rate;
  return one.median_delay_s < other.median_delay_s;
}

/// Threshold and direction.
void set_threshold(const Courses& setting, double false_alarm_rate, MonitorOptions& o) {
  RocPoint best = {.detection_rate = -1.0};
  for (const bool below : {false, true}) {
    for (const RocPoint& point : roc_of(setting, below, o)) {
      if (point.false_alarm_rate > false_alarm_rate || !better(point, best)) continue;
      best = point;
      o.alarm_below = below;
    }
  }
  o.threshold = best.threshold;
}

Calibration::Status status_of(const Calibration& calibration) {
  using Status = Calibration::Status;
  const RocPoint &set = calibration.setting.chosen, &verified = calibration.verifying.chosen;
  if (!(set.detection_rate > 0.0)) return Status::none_detects;
  if (!(verified.detection_rate > 0.0)) return Status::not_verified;
  if (verified.detection_rate <= verified.false_alarm_rate) return Status::no_better_than_chance;
  return Status::found;
}

}  // namespace

std::string reason(const Calibration& calibration) {
  const auto share_of = [](double rate, int count) {
    return fmt::format("{} of {}", std::lround(rate * static_cast<double>(count)), count);
  };
  const CalibratedHalf &setting = calibration.setting, &verifying = calibration.verifying;
  switch (calibration.status) {
    case Calibration::Status::found:
      return {};
    case Calibration::Status::none_detects:
      return fmt::format(
          "no threshold finds chatter in the setting half ({} recordings with chatter) at the wanted share of false "
          "alarms",
          setting.chatter);
    case Calibration::Status::not_verified:
      return share_of(verifying.chosen.detection_rate, verifying.chatter) +
             " recordings with chatter found in the verifying half";
    case Calibration::Status::no_better_than_chance:
      return fmt::format(
          "an alarm says nothing: in the verifying half {} recordings with chatter are found, and {} stable "
          "ones raise a false alarm",
          share_of(verifying.chosen.detection_rate, verifying.chatter),
          share_of(verifying.chosen.false_alarm_rate, verifying.stable));
  }
  return {};
}

void CalibrationOptions::validate() const {
  if (!(false_alarm_rate >= 0.0 && false_alarm_rate < 1.0)) {
    throw InvalidInput("false_alarm_rate", false_alarm_rate, "", "must be in [0, 1)");
  }
}

Calibration calibrate(std::span<const Recording> recordings, const MonitorOptions& options,
                      const CalibrationOptions& calibration) {
  Calibration out;
  out.options = options;
  out.options.kind = Kind::energy_entropy;
  out.options.threshold = 0.0;  // set below
  out.options.validate();
  calibration.validate();
  require_recordings(recordings, out.options);
  std::vector<Course> courses(recordings.size());
  parallel_for(recordings.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t r = begin; r < end; ++r) courses[r] = course_of(recordings[r], out.options);
  });
  const std::vector<bool> verifies = drawn_to_verify(recordings, calibration.seed);
  Courses setting, verifying;
  for (std::size_t r = 0; r < courses.size(); ++r) (verifies[r] ? verifying : setting).push_back(&courses[r]);

  set_threshold(setting, calibration.false_alarm_rate, out.options);
  out.setting = calibrated(setting, out.options);
  out.verifying = calibrated(verifying, out.options);
  out.status = status_of(out);
  std::vector<double> leads;
  for (std::size_t r = 0; r < courses.size(); ++r) {
    const Course& course = courses[r];
    Alarm alarm = {.name = recordings[r].name,
                   .chatter = course.chatter,
                   .verifying = verifies[r],
                   .onset_s = course.onset_s,
                   .line_hz = course.visible.line_hz,
                   .visible_s = course.visible.visible_s};
    if (const auto at = alarm_of(course, out.options.threshold, out.options.alarm_below)) {
      alarm.alarm_s = *at;
      alarm.early = is_early(course, *at, options);
      if (!alarm.early) alarm.lead_s = alarm.visible_s - alarm.alarm_s;
    }
    if (alarm.verifying && std::isfinite(alarm.lead_s)) leads.push_back(alarm.lead_s);
    out.alarms.push_back(std::move(alarm));
  }
  out.median_lead_s = median_or_unknown(std::move(leads));
  return out;
}

}  // namespace robomill::monitor
