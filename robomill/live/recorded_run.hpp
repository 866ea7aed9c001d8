#pragma once
#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "robomill/monitor/monitor.hpp"
#include "robomill/signal/bands.hpp"

// Method: robomill/live/README.md, "Method"

namespace robomill::live {

/// The samples of one channel over time.
struct RecordedChannel {
  std::string name = {};   ///< "ax_m_per_s2"
  signal::Band wave = {};  ///< in the recording's unit; n runs
};

/// Synchrosqueezed spectrum over time.
struct Spectrogram {
  std::string channel = {};
  double begin_s = NAN, step_s = NAN;  ///< of the columns; step > 0
  Eigen::VectorXd frequency_hz = {};   ///< length m, increasing
  Eigen::MatrixXd level_db = {};       ///< m x columns, below the strongest of all, <= 0; empty: no signal
};

/// A stay in one state.
struct Stay {
  monitor::State state = monitor::State::stable;
  double from_s = NAN, to_s = NAN;
};

/// A recording as the chatter monitor processed it.
struct RecordedRun {
  std::vector<std::pair<std::string, std::string>> facts = {};  ///< label and value
  std::vector<std::string> warnings = {}, notes = {};
  std::string unit = {};                       ///< of the samples
  double wave_run_s = NAN;                     ///< > 0
  std::vector<RecordedChannel> channels = {};  ///< at least one
  Spectrogram spectrogram = {};                ///< of the channel that was loudest in chatter, or the first
  double decision_run_s = NAN;                 ///< > 0; of the next four, n runs each
  signal::Band score = {}, threshold = {}, energy_entropy = {};
  signal::Band spindle_speed_rad_per_s = {};  ///< tracked; 0 where unknown
  std::vector<Stay> stays = {};               ///< one after the other, without gaps; some thousands at most
  std::vector<std::string> events = {};       ///< as monitor::event_line writes them
  std::size_t decisions = 0;
  double compute_mean_s = NAN, compute_max_s = NAN;  ///< of one decision
};

}  // namespace robomill::live
