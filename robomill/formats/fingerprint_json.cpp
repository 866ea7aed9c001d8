#include "robomill/formats/fingerprint_json.hpp"

#include "robomill/formats/json.hpp"
#include "robomill/formats/units.hpp"

namespace robomill::formats {
namespace {

Json explanation_json(const stability::Explanation& e, const modal::ModalModel& modes) {
  Json json;
  json["kind"] = stability::to_string(e.kind);
  if (e.kind == stability::Explanation::Kind::unexplained) return json;
  json["rotations"] = e.harmonic;
  json["mirrored"] = e.mirrored;
  json["of_tooth_passing"] = e.of_tooth_passing;
  if (e.mode == 0) {
    json["mode"] = nullptr;
  } else {
    json["mode"] = e.mode;
    json["mode_frequency_hz"] = number(modes.modes.at(static_cast<std::size_t>(e.mode - 1)).frequency_hz);
  }
  json["expected_hz"] = number(e.expected_hz);
  json["difference_hz"] = number(e.difference_hz);
  json["tolerance_hz"] = number(e.tolerance_hz);
  return json;
}

}  // namespace

std::string fingerprint_json(const stability::Fingerprint& fingerprint, const modal::ModalModel& modes,
                             const stability::DelayVerdict* verdict) {
  Json json;
  json["spindle_speed_rpm"] = number(fingerprint.spindle_speed_rad_per_s / units::rpm);
  json["speed_from_peaks"] = fingerprint.speed_from_peaks;
  json["peaks"] = Json::array();
  for (const stability::ExplainedPeak& peak : fingerprint.peaks) {
    Json row = {{"frequency_hz", number(peak.frequency_hz)}};
    row.update(explanation_json(peak.best, modes));
    row["others"] = Json::array();
    for (const stability::Explanation& other : peak.others) row["others"].push_back(explanation_json(other, modes));
    json["peaks"].push_back(row);
  }
  const bool chatters = fingerprint.mode != 0;
  json["mode"] = chatters ? Json(fingerprint.mode) : Json(nullptr);
  json["chatter_frequency_hz"] = chatters ? number(fingerprint.chatter_frequency_hz) : Json(nullptr);
  json["chatter"] = nullptr;
  if (verdict != nullptr) {
    json["chatter"] = {{"kind", stability::to_string(verdict->kind)},
                       {"spectral_radius", number(verdict->spectral_radius)},
                       {"spectral_radius_without_delay", number(verdict->without_delay)},
                       {"chatter_frequency_hz", number(verdict->chatter_frequency_hz)},
                       {"mode", verdict->mode}};
  }
  return dump(json);
}

}  // namespace robomill::formats
