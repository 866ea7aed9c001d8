#include <nlohmann/json.hpp>

#include "robomill/base/units.hpp"
#include "robomill/coupling/files/assembly_json.hpp"
#include "robomill/io/json.hpp"
#include "robomill/jobs/files/plan_json.hpp"
#include "robomill/jobs/predict.hpp"
#include "robomill/modal/files/frf_files.hpp"

namespace robomill::jobs {
namespace {

using io::Json;
using io::number;

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
    holder["segments"] = coupling::segments_json(assembly.holder.segments);
  } else {
    holder["receptances"] = prediction.file.receptances.filename().string();
  }
  Json peaks = Json::array();
  for (const coupling::TipPeak& peak : prediction.peaks) {
    peaks.push_back({{"frf", modal::to_string(peak.name)},
                     {"frequency_hz", number(peak.frequency_hz)},
                     {"receptance_m_per_n", number(peak.receptance_m_per_n)},
                     {"measured_frequency_hz", number(peak.measured_frequency_hz)}});
  }
  Json error = Json::object();
  for (const modal::FrfFitError& one : prediction.error) error[modal::to_string(one.name)] = number(one.relative);
  Json json;
  json["file"] = prediction.file.path.filename().string();
  json["tool"] = coupling::segments_json(assembly.tool);
  json["joint"] = assembly.joint ? coupling::joint_json(*assembly.joint) : Json();
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
