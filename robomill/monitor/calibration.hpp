#pragma once
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/monitor/monitor.hpp"

// Method: robomill/monitor/README.md, "energy-entropy (`published/`)"

namespace robomill::monitor {

inline constexpr double unknown_s = std::numeric_limits<double>::quiet_NaN();

/// A recording with its label: chatter or stable.
struct Recording {
  std::string name;
  bool chatter = false;
  std::vector<float> samples;  ///< interleaved, MonitorOptions::channels
  double onset_s = unknown_s;  ///< of chatter [s]; NaN: unknown
};

struct CalibrationOptions {
  double false_alarm_rate = 0.05;  ///< in [0, 1); share of the setting half's stable recordings with an alarm <= this
  std::uint64_t seed = 1;          ///< of the split into halves
  /// @throws InvalidInput naming the field
  ROBOMILL_API void validate() const;
};

/// One threshold on the way from none to all alarms.
struct RocPoint {
  double threshold = 0.0;             ///< an alarm where the entropy > threshold (MonitorOptions::alarm_below: <)
  double false_alarm_rate = 0.0;      ///< of the stable recordings
  double detection_rate = 0.0;        ///< of those with chatter
  double median_delay_s = unknown_s;  ///< alarm less onset, over the detected ones with known onset; NaN: none
};

/// One recording at the calibrated threshold.
struct Alarm {
  std::string name;
  bool chatter = false;
  bool verifying = false;        ///< of the half that the threshold was not set with
  bool early = false;            ///< alarm_s < onset_s - window_s: no detection
  double alarm_s = unknown_s;    ///< when the alarm could be raised; NaN: none
  double onset_s = unknown_s;    ///< as given
  double line_hz = unknown_s;    ///< chatter's line in the spectrogram; NaN: not seen, or onset unknown
  double visible_s = unknown_s;  ///< when it became visible
  double lead_s = unknown_s;     ///< visible_s - alarm_s, of a detection
};

struct CalibratedHalf {
  int stable = 0, chatter = 0;  ///< recordings
  RocPoint chosen;              ///< at the calibrated threshold
  std::vector<RocPoint> roc;    ///< by growing false-alarm rate, then detection rate
};

struct Calibration {
  /// found: a detector, of which the other members say how it did. The others are none, and say what was reached:
  enum class Status {
    found,
    none_detects,          ///< no threshold finds chatter in the setting half at the wanted share of false alarms
    not_verified,          ///< the one that does finds none in the verifying half
    no_better_than_chance  ///< there it is raised in as large a share of the stable recordings as of those with chatter
  };
  Status status = Status::none_detects;
  MonitorOptions options;  ///< as given, kind energy-entropy, with threshold and alarm_below set
  CalibratedHalf setting, verifying;
  double median_lead_s = unknown_s;  ///< over the verifying half; NaN: no onset known, or nothing detected
  std::vector<Alarm> alarms;         ///< one a recording, in the order given
};

inline constexpr Name<Calibration::Status> calibration_status_names[] = {
    {"found", Calibration::Status::found},
    {"none-detects", Calibration::Status::none_detects},
    {"not-verified", Calibration::Status::not_verified},
    {"no-better-than-chance", Calibration::Status::no_better_than_chance}};
/// Why it is no calibration, with the counts; empty where it is one.
[[nodiscard]] ROBOMILL_API std::string reason(const Calibration& calibration);

/// Sets the published detector's threshold [EnergyEntropyChatter]: half of the stable recordings and half of those with
/// chatter, drawn by the seed, set it, the others verify it.
///
/// A recording raises an alarm at its first hop with entropy above (or below) the threshold; the first two windows,
/// which reach before its start, do not count. Of all thresholds, above and below, at which no more than the wanted
/// share of the stable recordings raises one, the one that detects most is taken, of several the earliest: the nearest
/// one detects less where it fires before chatter's onset, too. Where none detects, or what it detects is not verified,
/// the status says so: that is no detector.
///
/// Chatter's line is visible from the last sample of the third spectrogram column (Hann window, columns as the
/// detector's hops) in a row in which it is 6 dB above the median of the 16 lines on either side and 6 dB above its own
/// median while stable, before the onset. It is the line whose mean power
/// from the onset on has grown most over that median.
///
/// @throws InvalidInput if an option is out of range, a recording is shorter than three windows, cut off within a frame
///   or not finite, or fewer than two are stable or two have chatter
[[nodiscard]] ROBOMILL_API Calibration calibrate(std::span<const Recording> recordings, const MonitorOptions& options,
                                                 const CalibrationOptions& calibration = {});

}  // namespace robomill::monitor
