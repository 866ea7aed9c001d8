#pragma once
#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "robomill/modal/mode_id.hpp"
#include "robomill/monitor/files/monitor_events.hpp"
#include "robomill/monitor/monitor.hpp"
#include "robomill/signal/bands.hpp"

namespace robomill::live {

/// The samples of one channel over time.
struct RecordedChannel {
  std::string name = {};   ///< "ax_m_per_s2"
  signal::Band wave = {};  ///< in the recording's unit; n runs, NaN where nothing came
};

/// Synchrosqueezed spectrum over time.
struct Spectrogram {
  std::string channel = {};
  double begin_s = NAN, step_s = NAN;  ///< of the columns; step > 0
  double max_frequency_hz = NAN;       ///< worth drawing; <= half the sample rate
  Eigen::VectorXd frequency_hz = {};   ///< of the rows, which cover 0 … max_frequency_hz; length m, increasing
  Eigen::MatrixXd level_db = {};       ///< m x columns, below the strongest of all, <= 0, NaN in gaps; empty: no signal
};

/// A stay in one state.
struct Stay {
  monitor::State state = monitor::State::stable;
  monitor::BlindReason reason = monitor::BlindReason::none;  ///< of State::blind
  double from_s = NAN, to_s = NAN;
};

/// How long the run was in a state, all stays together; of BlindReason::no_signal with the time by the clock in which
/// no samples came, while that of the stream stands still.
struct StateTime {
  monitor::State state = monitor::State::stable;
  monitor::BlindReason reason = monitor::BlindReason::none;  ///< of State::blind
  double duration_s = 0.0;
};

/// Alarms of about one frequency, each soon after the one before. Of an alarm that jumps to another frequency each is a
/// part of its own.
struct RecordedAlarm {
  std::size_t count = 0;                                              ///< alarms
  double from_s = NAN, to_s = NAN;                                    ///< first begin and last end
  double chatter_s = 0.0;                                             ///< in chatter between them
  double low_frequency_hz = NAN, high_frequency_hz = NAN;             ///< lowest and highest decided; NaN: none
  double chatter_frequency_hz = NAN, chatter_frequency_std_hz = NAN;  ///< the surest of them
  std::string channel = {};                                           ///< in which it was strongest then
  monitor::SynchronousChatter synchronous = monitor::SynchronousChatter::none;
  modal::ModeId mode = {};
  std::vector<double> line_hz = {};  ///< as MonitorEvent has it
  monitor::NoSpeed no_speed = monitor::NoSpeed::none;
  double suggested_spindle_speed_rad_per_s = NAN;  ///< NaN: none
  monitor::Explanation why = {};                   ///< of the first one's begin; Test::none: not known
};

/// A recording as the chatter monitor processed it.
struct RecordedRun {
  std::vector<std::pair<std::string, std::string>> facts = {};  ///< label and value
  std::vector<std::string> warnings = {}, notes = {};
  std::string unit = {};                       ///< of the samples
  double wave_run_s = NAN;                     ///< > 0
  std::vector<RecordedChannel> channels = {};  ///< at least one
  Spectrogram spectrogram = {};                ///< of the channel that was loudest in chatter, or the first
  int teeth = 0;                               ///< of the cutter; 0: unknown
  double decision_run_s = NAN;                 ///< > 0; of the next six, n runs each, NaN where there is no value
  signal::Band score = {};                     ///< none while the monitor is blind
  signal::Band threshold = {}, energy_entropy = {};
  signal::Band chatter_frequency_hz = {};     ///< while in chatter
  signal::Band spindle_speed_rad_per_s = {};  ///< tracked
  signal::Band spindle_speed_std_rad_per_s = {};
  std::vector<Stay> stays = {};             ///< one after the other, without gaps; some thousands at most
  std::vector<StateTime> state_times = {};  ///< of all stays, also those that are not listed; > 0
  std::size_t alarm_count = 0;
  std::vector<RecordedAlarm> alarms = {};  ///< by their begin; a hundred at most
  std::vector<std::string> events = {};    ///< as monitor::event_line writes them
  std::size_t decisions = 0;
  double compute_mean_s = NAN, compute_max_s = NAN;  ///< of one decision
};

}  // namespace robomill::live
