#pragma once
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "robomill/monitor/monitor.hpp"
#include "testing/monitor/recording.hpp"

/// How well a detector finds the chatter of the corpus.
namespace robomill::monitor::testing {

/// One decision of any detector.
struct DetectorDecision {
  double time_s = 0.0;  ///< of the last sample it used
  bool chatter = false, stable = true, blind = false;
  double frequency_hz = 0.0;  ///< 0: none
};
using Detector = std::function<std::vector<DetectorDecision>(const RecordedCut&)>;

struct CutScore {
  std::string kind = {}, course = {};
  int noise = 0;
  bool chatter = false;
  bool found = false;  ///< chatter was reported between truth.start_s and truth.end_s
  int false_alarms =
      0;  ///< changes to chatter before truth.start_s, 0.1 s and more after truth.end_s, or in a stable cut
  double delay_s = 0.0;  ///< first report since truth.start_s, less truth.t10_s; only where found
  /// Of the frequencies reported while chatter's amplitude was above half the final one: median distance to the nearest
  /// line within 10 dB of the strongest, and to the strongest; of lines that move, to where they were within the last
  /// 0.2 s; NaN: none reported.
  double frequency_error_hz = 0.0, strongest_error_hz = 0.0;
  /// From truth.end_s to the first report of stable; NaN where chatter does not end 0.5 s before the recording.
  double recovery_s = 0.0;
  int decisions = 0, blind = 0;  ///< of all decisions, those in which it was blind
};
[[nodiscard]] CutScore score(const RecordedCut& cut, std::span<const DetectorDecision> decisions);

/// Over many cuts; median and 95 % of what is known.
struct Summary {
  int cuts = 0, chatter = 0, found = 0, false_alarms = 0;
  int with_false_alarms = 0;  ///< cuts with one or more
  double delay_median_s = 0.0, delay_95_s = 0.0;
  double frequency_median_hz = 0.0, frequency_95_hz = 0.0;
  double recovery_median_s = 0.0, recovery_95_s = 0.0;
  double blind_share = 0.0;  ///< of all decisions
};
[[nodiscard]] Summary summarise(std::span<const CutScore> scores);
/// Where a rate lies with a confidence of 95 % [ClopperPearson1934]: of the rates at which so many events in so many
/// independent trials, or fewer, come in 2.5 % of the cases, and so many or more.
struct RateInterval {
  double low = 0.0, high = 1.0;
};
[[nodiscard]] RateInterval rate_interval(int events, int trials);
/// The share-th of sorted values, by straight lines; NaN of none. Values that are NaN do not count.
[[nodiscard]] double quantile(std::vector<double> values, double share);

/// What ChatterMonitor is given of a recording: its hint and teeth, and its tachometer where it has one.
[[nodiscard]] MonitorOptions monitor_options(const RecordedCut& cut);
/// ChatterMonitor as it stands, so given.
[[nodiscard]] std::vector<DetectorDecision> monitor_decisions(const RecordedCut& cut);
[[nodiscard]] std::vector<DetectorDecision> decisions_with(const MonitorOptions& options, const RecordedCut& cut);
/// The same of without_tachometer(cut).
[[nodiscard]] std::vector<DetectorDecision> monitor_decisions_without_tachometer(const RecordedCut& cut);
/// The recording with its tachometer's channel left out.
[[nodiscard]] RecordedCut without_tachometer(const RecordedCut& cut);
/// Root mean square of 50 ms, each 25 ms, against mean plus five standard deviations of the second before.
[[nodiscard]] std::vector<DetectorDecision> rms_five_sigma(const RecordedCut& cut);
/// Each sample less the mean of the four revolutions before (at the true speed, which no monitor knows); where
/// the rms of 50 ms of that exceeds 0.6 of the signal's twice running, chatter.
[[nodiscard]] std::vector<DetectorDecision> comb_rms_ratio(const RecordedCut& cut);

}  // namespace robomill::monitor::testing
