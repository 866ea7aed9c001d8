#include <fmt/format.h>

#include "robomill/io/json.hpp"
#include "robomill/modal/files/frf_files.hpp"
#include "robomill/modal/files/frf_parts.hpp"

namespace robomill::formats {
namespace {

Json set_json(const modal::FrfSet& set) {
  set.validate();
  Json json;
  json["frequency_hz"] = numbers(set.frequency_hz);
  json["receptance_m_per_n"] = Json::object();
  json["coherence"] = Json::object();
  json["deviation_m_per_n"] = Json::object();
  for (const modal::Frf& frf : set.frfs) {
    const std::string name = modal::to_string(frf.name);
    json["receptance_m_per_n"][name] = complex_numbers(frf.receptance);
    if (frf.coherence.size() > 0) json["coherence"][name] = numbers(frf.coherence);
    if (frf.deviation.size() > 0) json["deviation_m_per_n"][name] = numbers(frf.deviation);
  }
  return json;
}

Json peaks_json(const std::vector<modal::FrfPeak>& peaks) {
  Json rows = Json::array();
  for (const modal::FrfPeak& peak : peaks) {
    rows.push_back(
        {{"frequency_hz", number(peak.frequency_hz)}, {"receptance_m_per_n", number(peak.receptance_m_per_n)}});
  }
  return rows;
}

Json grade_json(const modal::FrfGrade& grade) {
  return {{"grade", modal::to_string(grade.grade)},
          {"hits", grade.hits},
          {"mean_coherence", number(grade.mean_coherence)},
          {"relative_noise", number(grade.relative_noise)},
          {"reciprocity_error", number(grade.reciprocity_error)},
          {"excited_band_hz", Json::array({number(grade.excited_low_hz), number(grade.excited_high_hz)})},
          {"lowest_trustworthy_frequency_hz", number(grade.lowest_trustworthy_frequency_hz)},
          {"peaks", peaks_json(grade.peaks)},
          {"faults", grade.faults},
          {"remedies", grade.remedies}};
}

void add_hits(Json& json, const modal::FrfResult& result) {
  json["hits"] = Json::array();
  for (const modal::HitVerdict& hit : result.hits) {
    json["hits"].push_back({{"file", hit.file},
                            {"accepted", hit.accepted},
                            {"reasons", hit.reasons},
                            {"peak_force_n", number(hit.peak_force_n)},
                            {"pulse_width_s", number(hit.pulse_width_s)},
                            {"second_pulse_ratio", number(hit.second_pulse_ratio)}});
  }
  json["grades"] = Json::object();
  for (const modal::FrfGrade& grade : result.grades) json["grades"][modal::to_string(grade.name)] = grade_json(grade);
  json["lowest_trustworthy_frequency_hz"] = number(result.lowest_trustworthy_frequency_hz);
  json["added_decay_per_s"] = number(result.added_decay_removed ? 0.0 : result.added_decay_per_s);
  json["notes"] = result.notes;
}

/// root[key][name], where there is one.
Eigen::VectorXd optional_numbers(const JsonNode& root, const char* key, const std::string& name) {
  if (!root.has(key) || !root.at(key).has(name.c_str())) return {};
  const JsonNode node = root.at(key).at(name);
  return node.json().is_null() ? Eigen::VectorXd() : node.numbers();
}

}  // namespace

FrfParts read_frf_json(const std::filesystem::path& path) {
  const Json json = read_json(path);
  const JsonNode root(json, path.string());
  FrfParts out{.file = path, .frequency_hz = root.at("frequency_hz").numbers()};
  const JsonNode receptances = root.at("receptance_m_per_n");
  receptances.require_object();
  for (const auto& item : receptances.json().items()) {
    const JsonNode node = receptances.at(item.key());
    const Eigen::VectorXd re = node.at("re").numbers();
    const Eigen::VectorXd im = node.at("im").numbers();
    if (re.size() != im.size()) throw node.refuse("must have as many real as imaginary parts");
    FrfPart part{.name = frf_name_at(fmt::format("{}: {}", path.string(), node.path()), item.key()),
                 .values = re.cast<std::complex<double>>()};
    part.values.imag() = im;
    part.coherence = optional_numbers(root, "coherence", item.key());
    part.deviation = optional_numbers(root, "deviation_m_per_n", item.key());
    out.frfs.push_back(std::move(part));
  }
  if (root.has("added_decay_per_s") && !root.at("added_decay_per_s").json().is_null()) {
    out.added_decay_per_s = root.at("added_decay_per_s").number();
    if (out.added_decay_per_s < 0.0) throw root.at("added_decay_per_s").refuse("must be >= 0");
  }
  return out;
}

std::string frf_json(const modal::FrfSet& set) {
  return dump(set_json(set));
}

std::string frf_json(const modal::FrfResult& result) {
  Json json = set_json(result.set);
  add_hits(json, result);
  return dump(json);
}

std::string frf_json(const modal::FrfSet& set, const FrfDoubts& doubts) {
  Json json = set_json(set);
  json["suspect_hz"] = doubts.suspect_hz;
  json["unreliable_hz"] = doubts.unreliable_hz;
  json["notes"] = doubts.notes;
  return dump(json);
}

std::string hits_json(const modal::FrfResult& result) {
  Json json = Json::object();
  add_hits(json, result);
  return dump(json);
}

}  // namespace robomill::formats
