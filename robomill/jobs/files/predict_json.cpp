#include <nlohmann/json.hpp>

#include "robomill/base/units.hpp"
#include "robomill/coupling/files/segment_fields.hpp"
#include "robomill/io/json.hpp"
#include "robomill/jobs/files/plan_json.hpp"
#include "robomill/jobs/predict.hpp"
#include "robomill/modal/files/frf_files.hpp"

namespace robomill::jobs {
namespace {

using io::Json;
using io::number;

/// In the keys of assembly.toml.
Json segments_json(const std::vector<coupling::Segment>& segments) {
  Json list = Json::array();
  for (const coupling::Segment& s : segments) {
    Json row = {{"length_mm", number(s.length_m / units::mm)},
                {"diameter_mm", number(s.diameter_m / units::mm)},
                {"inner_diameter_mm", number(s.inner_diameter_m / units::mm)},
                {"youngs_modulus_gpa", number(s.youngs_modulus_pa / units::gpa)}};
    if (s.mass_kg > 0.0) row["mass_kg"] = number(s.mass_kg);
    if (s.density_kg_per_m3 > 0.0) row["density_kg_per_m3"] = number(s.density_kg_per_m3);
    row["poissons_ratio"] = number(s.poissons_ratio);
    row["loss_factor"] = number(s.loss_factor);
    if (s.flutes > 0) {
      row["flutes"] = s.flutes;
      row["flute_diameter_ratio"] = number(s.flute_diameter_ratio);
    }
    row["beam"] = name_in(coupling::beam_names, s.beam);
    list.push_back(std::move(row));
  }
  return list;
}

Json joint_json(const coupling::Joint& joint) {
  Json out;
  for (const io::Field<coupling::Joint>& field : coupling::joint_fields) out[field.key] = number(joint.*field.value);
  out["cross_stiffness_n_per_rad"] = number(joint.cross_stiffness_n_per_rad);
  out["points"] = joint.points;
  if (joint.points > 1) {
    out["insertion_length_mm"] = number(joint.insertion_length_m / units::mm);
    out["shank"] = segments_json(joint.shank);
  }
  return out;
}

Json lines_json(const std::vector<double>& lines_hz) {
  Json list = Json::array();
  for (const double line : lines_hz) list.push_back(number(line));
  return list;
}

}  // namespace

std::string tip_json(const TipPrediction& prediction) {
  modal::FrfDoubts doubts{.suspect_hz = prediction.tip.suspect_hz};
  const auto note = [&](const std::vector<std::string>& notes) {
    doubts.notes.insert(doubts.notes.end(), notes.begin(), notes.end());
  };
  if (const std::optional<coupling::HolderResult>& holder = prediction.file.holder) {
    doubts.unreliable_hz = holder->unreliable_hz;
    note(holder->notes);
  }
  note(prediction.file.notes);
  note(prediction.tip.notes);
  doubts.assumed = prediction.file.assumed;
  return modal::frf_json(prediction.tip.frfs, doubts);
}

Json prediction_object(const TipPrediction& prediction) {
  const coupling::Assembly& assembly = prediction.file.assembly;
  Json holder = Json::object();
  if (assembly.holder.receptances.frfs.empty()) {
    holder["segments"] = segments_json(assembly.holder.segments);
  } else {
    holder["receptances"] = prediction.file.receptances.filename().string();
  }
  Json peaks = Json::array();
  for (const TipPeak& peak : prediction.peaks) {
    peaks.push_back({{"frf", modal::to_string(peak.name)},
                     {"frequency_hz", number(peak.frequency_hz)},
                     {"receptance_m_per_n", number(peak.receptance_m_per_n)},
                     {"measured_frequency_hz", number(peak.measured_frequency_hz)}});
  }
  Json error = Json::object();
  for (const modal::FrfFitError& one : prediction.error) error[modal::to_string(one.name)] = number(one.relative);
  Json json;
  json["file"] = prediction.file.path.filename().string();
  json["tool"] = segments_json(assembly.tool);
  json["joint"] = assembly.joint ? joint_json(*assembly.joint) : Json();
  json["holder"] = std::move(holder);
  json["peaks"] = std::move(peaks);
  json["relative_error"] = prediction.measured ? std::move(error) : Json();
  json["suspect_hz"] = lines_json(prediction.tip.suspect_hz);
  json["unreliable_hz"] =
      lines_json(prediction.file.holder ? prediction.file.holder->unreliable_hz : std::vector<double>{});
  json["notes"] = prediction.notes;
  return json;
}

}  // namespace robomill::jobs
