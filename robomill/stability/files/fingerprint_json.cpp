#include "robomill/stability/files/fingerprint_json.hpp"

#include "robomill/base/units.hpp"
#include "robomill/modal/files/mode_json.hpp"

namespace robomill::formats {
namespace {

/// One reading.
Json explanation_json(const stability::Explanation& e) {
  Json json;
  json["kind"] = stability::to_string(e.kind);
  json["rotations"] = e.harmonic;
  json["mirrored"] = e.mirrored;
  json["of_tooth_passing"] = e.of_tooth_passing;
  set_mode(json, e.mode);
  if (e.mode.known()) json["mode_frequency_hz"] = number(e.mode_frequency_hz);
  json["expected_hz"] = number(e.expected_hz);
  json["difference_hz"] = number(e.difference_hz);
  json["tolerance_hz"] = number(e.tolerance_hz);
  json["likelihood_per_hz"] = number(e.likelihood_per_hz);
  return json;
}

Json peak_json(const stability::ExplainedPeak& peak) {
  Json json = {{"frequency_hz", number(peak.frequency_hz)}, {"state", stability::to_string(peak.state)}};
  if (peak.state == stability::ExplainedPeak::State::named) {
    json.update(explanation_json(peak.best));
  } else {
    json["kind"] = stability::to_string(peak.best.kind);
    set_mode(json, {});
  }
  json["chatter_frequency_hz"] = number(peak.chatter_frequency_hz);
  json["others"] = Json::array();
  for (const stability::Explanation& other : peak.others) json["others"].push_back(explanation_json(other));
  return json;
}

}  // namespace

std::string fingerprint_json(const stability::Fingerprint& fingerprint, const stability::DelayVerdict* verdict) {
  Json json;
  json["spindle_speed_rpm"] = number(fingerprint.spindle_speed_rad_per_s / units::rpm);
  json["speed_from_peaks"] = fingerprint.speed_from_peaks;
  json["peaks"] = Json::array();
  for (const stability::ExplainedPeak& peak : fingerprint.peaks) json["peaks"].push_back(peak_json(peak));
  json["state"] = stability::to_string(fingerprint.state);
  set_mode(json, fingerprint.mode);
  json["chatter_frequency_hz"] = number(fingerprint.chatter_frequency_hz);
  json["chatter"] = nullptr;
  if (verdict != nullptr) {
    json["chatter"] = {{"kind", stability::to_string(verdict->kind)},
                       {"spectral_radius", number(verdict->spectral_radius)},
                       {"spectral_radius_without_delay", number(verdict->without_delay)},
                       {"chatter_frequency_hz", number(verdict->chatter_frequency_hz)}};
    set_mode(json["chatter"], verdict->mode);
  }
  return dump(json);
}

}  // namespace robomill::formats
