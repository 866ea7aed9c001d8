#include <fmt/format.h>

#include "robomill/io/json.hpp"
#include "robomill/modal/files/frf_files.hpp"
#include "robomill/modal/files/frf_parts.hpp"
#include "robomill/modal/files/modal_objects.hpp"

namespace robomill::modal {
namespace {

io::Json set_json(const FrfSet& set) {
  set.validate();
  io::Json json;
  json["frequency_hz"] = io::numbers(set.frequency_hz);
  json["receptance_m_per_n"] = io::Json::object();
  json["coherence"] = io::Json::object();
  json["deviation_m_per_n"] = io::Json::object();
  for (const Frf& frf : set.frfs) {
    const std::string name = to_string(frf.name);
    json["receptance_m_per_n"][name] = io::complex_numbers(frf.receptance);
    if (frf.coherence.size() > 0) json["coherence"][name] = io::numbers(frf.coherence);
    if (frf.deviation.size() > 0) json["deviation_m_per_n"][name] = io::numbers(frf.deviation);
  }
  return json;
}

io::Json peaks_json(const std::vector<FrfPeak>& peaks) {
  io::Json rows = io::Json::array();
  for (const FrfPeak& peak : peaks) {
    rows.push_back(
        {{"frequency_hz", io::number(peak.frequency_hz)}, {"receptance_m_per_n", io::number(peak.receptance_m_per_n)}});
  }
  return rows;
}

io::Json grade_json(const FrfGrade& grade) {
  return {{"grade", to_string(grade.grade)},
          {"hits", grade.hits},
          {"mean_coherence", io::number(grade.mean_coherence)},
          {"relative_noise", io::number(grade.relative_noise)},
          {"reciprocity_error", io::number(grade.reciprocity_error)},
          {"excited_band_hz", io::Json::array({io::number(grade.excited_low_hz), io::number(grade.excited_high_hz)})},
          {"lowest_trustworthy_frequency_hz", io::number(grade.lowest_trustworthy_frequency_hz)},
          {"peaks", peaks_json(grade.peaks)},
          {"faults", grade.faults},
          {"remedies", grade.remedies}};
}

/// root[key][name], where there is one.
Eigen::VectorXd optional_numbers(const io::JsonNode& root, const char* key, const std::string& name) {
  if (!root.has(key) || !root.at(key).has(name.c_str())) return {};
  const io::JsonNode node = root.at(key).at(name);
  return node.json().is_null() ? Eigen::VectorXd() : node.numbers();
}

}  // namespace

FrfParts read_frf_json(const std::filesystem::path& path) {
  const io::Json json = io::read_json(path);
  FrfParts out{.file = path};
  const io::JsonNode root(json, path.string(), out.notes);
  out.frequency_hz = root.at("frequency_hz").numbers();
  const io::JsonNode receptances = root.at("receptance_m_per_n");
  receptances.require_object();
  for (const auto& item : receptances.json().items()) {
    const io::JsonNode node = receptances.at(item.key());
    const Eigen::VectorXd re = node.at("re").numbers();
    const Eigen::VectorXd im = node.at("im").numbers();
    if (re.size() != im.size()) throw node.reject("must have as many real as imaginary parts");
    FrfPart part{.name = frf_name_at(fmt::format("{}: {}", path.string(), node.path()), item.key()),
                 .values = re.cast<std::complex<double>>()};
    part.values.imag() = im;
    part.coherence = optional_numbers(root, "coherence", item.key());
    part.deviation = optional_numbers(root, "deviation_m_per_n", item.key());
    out.frfs.push_back(std::move(part));
  }
  if (root.has("added_decay_per_s") && !root.at("added_decay_per_s").json().is_null()) {
    out.added_decay_per_s = root.at("added_decay_per_s").number();
    if (out.added_decay_per_s < 0.0) throw root.at("added_decay_per_s").reject("must be >= 0");
  }
  return out;
}

io::Json hits_object(const FrfResult& result) {
  io::Json json;
  json["hits"] = io::Json::array();
  for (const HitVerdict& hit : result.hits) {
    json["hits"].push_back({{"file", hit.file},
                            {"accepted", hit.accepted},
                            {"reasons", hit.reasons},
                            {"peak_force_n", io::number(hit.peak_force_n)},
                            {"pulse_width_s", io::number(hit.pulse_width_s)},
                            {"second_pulse_ratio", io::number(hit.second_pulse_ratio)}});
  }
  json["grades"] = io::Json::object();
  for (const FrfGrade& grade : result.grades) json["grades"][to_string(grade.name)] = grade_json(grade);
  json["lowest_trustworthy_frequency_hz"] = io::number(result.lowest_trustworthy_frequency_hz);
  json["added_decay_per_s"] = io::number(result.added_decay_removed ? 0.0 : result.added_decay_per_s);
  json["notes"] = result.notes;
  return json;
}

std::string frf_json(const FrfSet& set) {
  return io::dump(set_json(set));
}

std::string frf_json(const FrfResult& result) {
  io::Json json = set_json(result.set);
  json.update(hits_object(result));
  return io::dump(json);
}

std::string frf_json(const FrfSet& set, const FrfDoubts& doubts) {
  io::Json json = set_json(set);
  json["suspect_hz"] = doubts.suspect_hz;
  json["unreliable_hz"] = doubts.unreliable_hz;
  json["notes"] = doubts.notes;
  json["assumed"] = io::assumed_json(doubts.assumed);
  return io::dump(json);
}

}  // namespace robomill::modal
