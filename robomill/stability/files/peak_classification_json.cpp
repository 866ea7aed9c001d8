#include "robomill/stability/files/peak_classification_json.hpp"

#include "robomill/base/units.hpp"
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

}  // namespace robomill::stability
