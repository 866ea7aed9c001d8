#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/monitor/monitor.hpp"
#include "robomill/report/fact.hpp"
#include "robomill/signal/bands.hpp"

// Method: robomill/report/README.md, "Method"

/// A recording as the chatter monitor processed it, as a part of the report.
namespace robomill::report {

/// The samples of one channel over time.
struct MonitorChannel {
  std::string name = {};   ///< "ax_m_per_s2"
  signal::Band wave = {};  ///< in the recording's unit; n runs
};

/// Synchrosqueezed spectrum over time.
struct Spectrogram {
  double begin_s = missing, step_s = missing;  ///< of the columns; step > 0
  Eigen::VectorXd frequency_hz = {};           ///< length m, increasing
  Eigen::MatrixXd level_db = {};               ///< m x columns, below the strongest of all, <= 0
};

/// A stay in one state.
struct MonitorStay {
  monitor::State state = monitor::State::stable;
  double from_s = missing, to_s = missing;
};

struct MonitorRun {
  std::vector<Fact> facts = {};
  std::vector<std::string> warnings = {}, notes = {};
  std::string detector = {};                  ///< "comb-cusum"
  std::string unit = {};                      ///< of the samples
  std::string entropy_unit = {};              ///< empty where it has none
  double wave_run_s = missing;                ///< > 0
  std::vector<MonitorChannel> channels = {};  ///< at least one
  Spectrogram spectrogram = {};               ///< of the channel that was loudest in chatter, or the first
  std::string spectrogram_channel = {};
  double decision_run_s = missing;                               ///< > 0; of the next five, n runs each
  signal::Band score = {}, threshold = {}, energy_entropy = {};  ///< energy_entropy empty where the detector has none
  signal::Band spindle_speed_rad_per_s = {};                     ///< tracked; 0 where unknown
  std::vector<MonitorStay> stays = {};                           ///< one after the other, without gaps
  std::vector<std::string> events = {};                          ///< as monitor::event_line writes them
  std::size_t decisions = 0;
  double compute_mean_s = missing, compute_max_s = missing;  ///< of one decision

  /// @throws InvalidInput naming the member if lengths do not match or a number is infinite
  ROBOMILL_API void validate() const;
};

}  // namespace robomill::report
