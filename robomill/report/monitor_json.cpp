#include <cmath>
#include <utility>

#include "robomill/base/units.hpp"
#include "robomill/report/json.hpp"

namespace robomill::report {
namespace {

using Json = nlohmann::ordered_json;

/// Whole decibels: finer ones no colour shows. A row a frequency.
Json spectrogram_json(const MonitorRun& run) {
  const Spectrogram& spectrogram = run.spectrogram;
  if (spectrogram.level_db.size() == 0) return nullptr;
  Json rows = Json::array();
  for (Eigen::Index i = 0; i < spectrogram.level_db.rows(); ++i) {
    Json row = Json::array();
    for (Eigen::Index k = 0; k < spectrogram.level_db.cols(); ++k) {
      row.push_back(static_cast<int>(std::lround(spectrogram.level_db(i, k))));
    }
    rows.push_back(std::move(row));
  }
  return {{"channel", text(run.spectrogram_channel)},
          {"begin_s", number(spectrogram.begin_s)},
          {"step_s", number(spectrogram.step_s)},
          {"frequency_hz", numbers(spectrogram.frequency_hz)},
          {"level_db", std::move(rows)}};
}

Json optional_band(const signal::Band& band, bool points, double unit) {
  return band.low.size() > 0 ? band_json(band, points, unit) : Json(nullptr);
}

Json decisions_json(const MonitorRun& run) {
  // All curves are drawn over one axis, in the way that the least smooth of them needs.
  const bool points = is_single(run.score) && is_single(run.threshold) &&
                      (run.energy_entropy.low.size() == 0 || is_single(run.energy_entropy)) &&
                      (run.spindle_speed_rad_per_s.low.size() == 0 || is_single(run.spindle_speed_rad_per_s));
  return {{"time_s", run_times_json(run.score.low.size(), points, run.decision_run_s)},
          {"score", band_json(run.score, points)},
          {"threshold", band_json(run.threshold, points)},
          {"energy_entropy", optional_band(run.energy_entropy, points, 1.0)},
          {"spindle_speed_rpm", optional_band(run.spindle_speed_rad_per_s, points, units::rpm)}};
}

}  // namespace

Json monitor_json(const MonitorRun& run) {
  Json channels = Json::array();
  bool points = true;
  for (const MonitorChannel& channel : run.channels) points = points && is_single(channel.wave);
  for (const MonitorChannel& channel : run.channels) {
    channels.push_back({{"name", text(channel.name)}, {"wave", band_json(channel.wave, points)}});
  }
  Json stays = Json::array();
  for (const MonitorStay& stay : run.stays) {
    stays.push_back(
        {{"state", monitor::to_string(stay.state)}, {"from_s", number(stay.from_s)}, {"to_s", number(stay.to_s)}});
  }
  Json events = Json::array();
  for (const std::string& event : run.events) events.push_back(Json::parse(event));
  return {{"facts", facts_json(run.facts)},
          {"warnings", texts(run.warnings)},
          {"notes", texts(run.notes)},
          {"detector", text(run.detector)},
          {"unit", text(run.unit)},
          {"entropy_unit", text(run.entropy_unit)},
          {"wave_time_s", run_times_json(run.channels.front().wave.low.size(), points, run.wave_run_s)},
          {"channels", std::move(channels)},
          {"spectrogram", spectrogram_json(run)},
          {"decisions", decisions_json(run)},
          {"decision_count", run.decisions},
          {"compute_mean_us", number(run.compute_mean_s, units::us)},
          {"compute_max_us", number(run.compute_max_s, units::us)},
          {"stays", std::move(stays)},
          {"events", std::move(events)}};
}

}  // namespace robomill::report
