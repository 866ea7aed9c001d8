#include "robomill/live/files/recorded_run_json.hpp"

#include <cmath>
#include <utility>

#include "robomill/base/units.hpp"
#include "robomill/io/json.hpp"
#include "robomill/signal/files/bands_json.hpp"

namespace robomill::live {
namespace {

using io::Json;
using io::number;
using signal::band_json;

/// Whole decibels: finer ones no colour shows. A row a frequency.
Json spectrogram_json(const Spectrogram& spectrogram) {
  if (spectrogram.level_db.size() == 0) return nullptr;
  Json rows = Json::array();
  for (Eigen::Index i = 0; i < spectrogram.level_db.rows(); ++i) {
    Json row = Json::array();
    for (Eigen::Index k = 0; k < spectrogram.level_db.cols(); ++k) {
      row.push_back(static_cast<int>(std::lround(spectrogram.level_db(i, k))));
    }
    rows.push_back(std::move(row));
  }
  return {{"channel", spectrogram.channel},
          {"begin_s", number(spectrogram.begin_s)},
          {"step_s", number(spectrogram.step_s)},
          {"frequency_hz", io::numbers(spectrogram.frequency_hz)},
          {"level_db", std::move(rows)}};
}

Json decisions_json(const RecordedRun& run) {
  return {{"run_s", number(run.decision_run_s)},
          {"score", band_json(run.score)},
          {"threshold", band_json(run.threshold)},
          {"energy_entropy", band_json(run.energy_entropy)},
          {"spindle_speed_rpm", band_json(run.spindle_speed_rad_per_s, units::rpm)}};
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
    stays.push_back(
        {{"state", monitor::to_string(stay.state)}, {"from_s", number(stay.from_s)}, {"to_s", number(stay.to_s)}});
  }
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
                   {"stays", std::move(stays)},
                   {"events", std::move(events)}});
}

}  // namespace robomill::live
