#include "robomill/live/files/recorded_run_json.hpp"

#include <cmath>
#include <string>
#include <utility>

#include "robomill/base/units.hpp"
#include "robomill/io/json.hpp"
#include "robomill/modal/files/mode_json.hpp"
#include "robomill/signal/files/bands_json.hpp"

namespace robomill::live {
namespace {

using io::Json;
using io::number;
using io::positive;
using signal::band_json;

Json state_json(monitor::State state, monitor::BlindReason reason) {
  return {{"state", monitor::to_string(state)},
          {"reason", state == monitor::State::blind ? Json(monitor::to_string(reason)) : Json(nullptr)}};
}

/// Whole decibels: finer ones no colour shows. A row a frequency.
Json spectrogram_json(const Spectrogram& spectrogram) {
  if (spectrogram.level_db.size() == 0) return nullptr;
  Json rows = Json::array();
  for (Eigen::Index i = 0; i < spectrogram.level_db.rows(); ++i) {
    Json row = Json::array();
    for (Eigen::Index k = 0; k < spectrogram.level_db.cols(); ++k) {
      const double level = spectrogram.level_db(i, k);
      row.push_back(std::isnan(level) ? Json(nullptr) : Json(static_cast<int>(std::lround(level))));
    }
    rows.push_back(std::move(row));
  }
  return {{"channel", spectrogram.channel},
          {"begin_s", number(spectrogram.begin_s)},
          {"step_s", number(spectrogram.step_s)},
          {"max_frequency_hz", number(spectrogram.max_frequency_hz)},
          {"frequency_hz", io::numbers(spectrogram.frequency_hz)},
          {"level_db", std::move(rows)}};
}

Json decisions_json(const RecordedRun& run) {
  return {{"run_s", number(run.decision_run_s)},
          {"score", band_json(run.score)},
          {"threshold", band_json(run.threshold)},
          {"energy_entropy", band_json(run.energy_entropy)},
          {"chatter_frequency_hz", band_json(run.chatter_frequency_hz)},
          {"spindle_speed_rpm", band_json(run.spindle_speed_rad_per_s, units::rpm)},
          {"spindle_speed_std_rpm", band_json(run.spindle_speed_std_rad_per_s, units::rpm)}};
}

Json alarm_json(const RecordedAlarm& alarm) {
  const std::string no_speed(name_in(monitor::no_speed_names, alarm.no_speed));
  const bool hidden = alarm.synchronous != monitor::SynchronousChatter::none;
  Json out = {{"count", alarm.count},
              {"from_s", number(alarm.from_s)},
              {"to_s", number(alarm.to_s)},
              {"chatter_s", number(alarm.chatter_s)},
              {"low_frequency_hz", number(alarm.low_frequency_hz)},
              {"high_frequency_hz", number(alarm.high_frequency_hz)},
              {"chatter_frequency_hz", number(alarm.chatter_frequency_hz)},
              {"chatter_frequency_std_hz", number(alarm.chatter_frequency_std_hz)},
              {"channel", alarm.channel.empty() ? Json(nullptr) : Json(alarm.channel)},
              {"hidden", hidden ? Json(monitor::to_string(alarm.synchronous)) : Json(nullptr)},
              {"suggested_spindle_speed_rpm", positive(alarm.suggested_spindle_speed_rad_per_s, units::rpm)},
              {"line_frequencies_hz", alarm.line_hz},
              {"no_speed", no_speed.empty() ? Json(nullptr) : Json(no_speed)}};
  modal::set_mode(out, alarm.mode);
  return out;
}

}  // namespace

std::string recorded_run_json(const RecordedRun& run) {
  Json facts = Json::array();
  for (const auto& [label, value] : run.facts) facts.push_back({{"label", label}, {"value", value}});
  Json channels = Json::array();
  for (const RecordedChannel& channel : run.channels) {
    channels.push_back({{"name", channel.name}, {"wave", band_json(channel.wave)}});
  }
  Json stays = Json::array();
  for (const Stay& stay : run.stays) {
    stays.push_back(state_json(stay.state, stay.reason));
    stays.back()["from_s"] = number(stay.from_s);
    stays.back()["to_s"] = number(stay.to_s);
  }
  Json state_times = Json::array();
  for (const StateTime& time : run.state_times) {
    state_times.push_back(state_json(time.state, time.reason));
    state_times.back()["duration_s"] = number(time.duration_s);
  }
  Json alarms = Json::array();
  for (const RecordedAlarm& alarm : run.alarms) alarms.push_back(alarm_json(alarm));
  Json events = Json::array();
  for (const std::string& event : run.events) {
    events.push_back(Json::parse(event, nullptr, false));
    if (events.back().is_discarded()) throw InvalidInput("events", "must be lines of JSON");
  }
  return io::dump({{"facts", std::move(facts)},
                   {"warnings", run.warnings},
                   {"notes", run.notes},
                   {"unit", run.unit},
                   {"wave_run_s", number(run.wave_run_s)},
                   {"channels", std::move(channels)},
                   {"spectrogram", spectrogram_json(run.spectrogram)},
                   {"decisions", decisions_json(run)},
                   {"decision_count", run.decisions},
                   {"compute_mean_us", number(run.compute_mean_s / units::us)},
                   {"compute_max_us", number(run.compute_max_s / units::us)},
                   {"teeth", run.teeth > 0 ? Json(run.teeth) : Json(nullptr)},
                   {"stays", std::move(stays)},
                   {"state_times", std::move(state_times)},
                   {"alarm_count", run.alarm_count},
                   {"alarms", std::move(alarms)},
                   {"events", std::move(events)}});
}

}  // namespace robomill::live
