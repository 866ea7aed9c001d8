#include "robomill/stability/files/peak_classification_json.hpp"

#include <utility>

#include "robomill/base/units.hpp"
#include "robomill/io/csv.hpp"
#include "robomill/io/json.hpp"
#include "robomill/modal/files/mode_json.hpp"

namespace robomill::stability {
namespace {

/// One reading.
io::Json explanation_json(const Explanation& e) {
  io::Json json;
  json["kind"] = to_string(e.kind);
  json["rotations"] = e.harmonic;
  json["mirrored"] = e.mirrored;
  json["of_tooth_passing"] = e.of_tooth_passing;
  modal::set_mode(json, e.mode);
  if (e.mode.known()) json["mode_frequency_hz"] = io::number(e.mode_frequency_hz);
  json["expected_hz"] = io::number(e.expected_hz);
  json["difference_hz"] = io::number(e.difference_hz);
  json["tolerance_hz"] = io::number(e.tolerance_hz);
  json["likelihood_per_hz"] = io::number(e.likelihood_per_hz);
  return json;
}

io::Json peak_json(const ExplainedPeak& peak) {
  io::Json json = {{"frequency_hz", io::number(peak.frequency_hz)}, {"state", to_string(peak.state)}};
  if (peak.state == ExplainedPeak::State::named) {
    json.update(explanation_json(peak.best));
  } else {
    json["kind"] = to_string(peak.best.kind);
    modal::set_mode(json, {});
  }
  json["chatter_frequency_hz"] = io::number(peak.chatter_frequency_hz);
  json["others"] = io::Json::array();
  for (const Explanation& other : peak.others) json["others"].push_back(explanation_json(other));
  return json;
}

}  // namespace

std::string peak_classification_json(const PeakClassification& classification, const ChatterMechanism* verdict) {
  io::Json json;
  json["spindle_speed_rpm"] = io::number(classification.spindle_speed_rad_per_s / units::rpm);
  json["speed_from_peaks"] = classification.speed_from_peaks;
  json["peaks"] = io::Json::array();
  for (const ExplainedPeak& peak : classification.peaks) json["peaks"].push_back(peak_json(peak));
  json["state"] = to_string(classification.state);
  modal::set_mode(json, classification.mode);
  json["chatter_frequency_hz"] = io::number(classification.chatter_frequency_hz);
  json["chatter"] = nullptr;
  if (verdict != nullptr) {
    json["chatter"] = {{"kind", to_string(verdict->kind)},
                       {"spectral_radius", io::number(verdict->spectral_radius)},
                       {"spectral_radius_without_delay", io::number(verdict->without_delay)},
                       {"chatter_frequency_hz", io::number(verdict->chatter_frequency_hz)}};
    modal::set_mode(json["chatter"], verdict->mode);
  }
  return io::dump(json);
}

std::string peaks_csv(const PeakClassification& classification) {
  using io::csv_number;
  std::string out =
      "frequency_hz,state,kind,rotations,mirrored,of_tooth_passing,mode,mode_of,mode_frequency_hz,expected_hz,"
      "difference_hz,tolerance_hz,chatter_frequency_hz,other_readings\n";
  for (const ExplainedPeak& peak : classification.peaks) {
    const Explanation& e = peak.best;
    const bool named = peak.state == ExplainedPeak::State::named;
    const bool moded = named && e.mode.known();
    const auto where_named = [named](std::string cell) { return named ? std::move(cell) : std::string(); };
    io::add_csv_row(out,
                    {csv_number(peak.frequency_hz), std::string(to_string(peak.state)), std::string(to_string(e.kind)),
                     where_named(std::to_string(e.harmonic)), where_named(e.mirrored ? "true" : "false"),
                     where_named(e.of_tooth_passing ? "true" : "false"), moded ? std::to_string(e.mode.number) : "",
                     moded ? std::string(to_string(e.mode.of)) : "", moded ? csv_number(e.mode_frequency_hz) : "",
                     where_named(csv_number(e.expected_hz)), where_named(csv_number(e.difference_hz)),
                     where_named(csv_number(e.tolerance_hz)), csv_number(peak.chatter_frequency_hz),
                     std::to_string(peak.others.size())});
  }
  return out;
}

}  // namespace robomill::stability
