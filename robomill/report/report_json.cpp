#include <cmath>
#include <complex>
#include <utility>

#include "robomill/base/units.hpp"
#include "robomill/report/json.hpp"
#include "robomill/report/thin.hpp"

namespace robomill::report {
namespace {

using Json = nlohmann::ordered_json;

Json name_of(Grade grade) {
  switch (grade) {
    case Grade::good:
      return "good";
    case Grade::fair:
      return "fair";
    case Grade::poor:
      return "poor";
    case Grade::unknown:
      break;
  }
  return nullptr;
}

constexpr std::size_t most_rows = 6000;

/// Of a long list of rows those that hold an extreme of some column, run by run.
Json thinned(Json rows) {
  if (!rows.is_array() || rows.size() <= most_rows || !rows.front().is_object()) return rows;
  std::vector<Eigen::VectorXd> columns;
  for (const auto& [key, value] : rows.front().items()) {
    if (!value.is_number()) continue;
    Eigen::VectorXd& column = columns.emplace_back(static_cast<Eigen::Index>(rows.size()));
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const Json& cell = rows[i][key];
      column[static_cast<Eigen::Index>(i)] = cell.is_number() ? cell.get<double>() : missing;
    }
  }
  Json kept = Json::array();
  for (const Eigen::Index i : thin_together(columns, most_rows)) {
    kept.push_back(std::move(rows[static_cast<std::size_t>(i)]));
  }
  return kept;
}

/// What a page needs of a document of another writer: numbers to six digits, long lists thinned.
Json shown(Json value) {
  if (value.is_number_float()) return number(value.get<double>());
  if (!value.is_structured()) return value;
  value = thinned(std::move(value));
  for (Json& part : value) part = shown(std::move(part));
  return value;
}

Json document(const std::string& text) {
  return text.empty() ? Json(nullptr) : shown(Json::parse(text));
}

bool is_rotation(modal::Axis axis) {
  return axis >= modal::Axis::rx;
}

/// The unit that a receptance of this name is drawn in, and that unit in SI.
std::pair<const char*, double> unit_of(const modal::FrfName& name) {
  const bool rotates = is_rotation(name.response.axis);
  const bool moment = is_rotation(name.excitation.axis);
  if (rotates) return moment ? std::pair{"rad/(N m)", 1.0} : std::pair{"rad/N", 1.0};
  return moment ? std::pair{"µm/(N m)", units::um} : std::pair{"µm/N", units::um};
}

Json curve_json(const Eigen::VectorXcd& values, const std::vector<Eigen::Index>& keep, double unit) {
  if (values.size() == 0) return nullptr;
  Json magnitude = Json::array();
  Json phase = Json::array();
  for (const Eigen::Index i : keep) {
    magnitude.push_back(number(std::abs(values[i]), unit));
    phase.push_back(number(std::arg(values[i]), units::deg));
  }
  return {{"magnitude", std::move(magnitude)}, {"phase_deg", std::move(phase)}};
}

Json frf_json(const Report& report, const FrfPlot& frf) {
  const auto [unit_name, unit] = unit_of(frf.name);
  const bool own_axis = frf.measured_frequency_hz.size() > 0;
  const Eigen::VectorXcd& shown = frf.predicted.size() > 0               ? frf.predicted
                                  : frf.measured.size() > 0 && !own_axis ? frf.measured
                                                                         : frf.fitted;
  const std::vector<Eigen::Index> keep = thin(shown.cwiseAbs());
  const std::vector<Eigen::Index> keep_measured = own_axis ? thin(frf.measured.cwiseAbs()) : keep;
  const std::optional<Prediction>& prediction = report.prediction;
  return {
      {"name", modal::to_string(frf.name)},
      {"unit", unit_name},
      {"frequency_hz", numbers(report.frf_frequency_hz, keep)},
      {"measured_frequency_hz", own_axis ? numbers(frf.measured_frequency_hz, keep_measured) : Json(nullptr)},
      {"measured", curve_json(frf.measured, keep_measured, unit)},
      {"predicted", curve_json(frf.predicted, keep, unit)},
      {"fitted", curve_json(frf.fitted, keep, unit)},
      {"suspect_bands_hz", prediction ? bands_json(report.frf_frequency_hz, prediction->suspect_hz) : Json::array()},
      {"unreliable_bands_hz",
       prediction ? bands_json(report.frf_frequency_hz, prediction->unreliable_hz) : Json::array()},
      {"coherence", frf.coherence.size() > 0 ? numbers(frf.coherence, keep) : Json(nullptr)},
      {"grade", name_of(frf.grade)},
      {"findings", texts(frf.findings)},
      {"remedies", texts(frf.remedies)},
      {"trusted_from_hz", number(frf.trusted_from_hz)},
      {"trusted_to_hz", number(frf.trusted_to_hz)},
      {"relative_error", number(frf.relative_error)},
      {"prediction_error", number(frf.prediction_error)}};
}

template <class T, class F>
Json list_of(const std::vector<T>& items, F&& item_json) {
  Json list = Json::array();
  for (const T& item : items) list.push_back(item_json(item));
  return list;
}

}  // namespace

Json shop_units(const Report& report) {
  report.validate();
  Json json = Json::object();
  json["title"] = text(report.title);
  json["created"] = text(report.created);
  json["plan"] = document(report.plan);
  json["assembly"] = report.prediction ? assembly_json(*report.prediction) : Json(nullptr);
  json["frfs"] = list_of(report.frfs, [&](const FrfPlot& frf) { return frf_json(report, frf); });
  json["hits"] = list_of(report.hits, [](const HitRow& hit) {
    return Json{{"file", text(hit.file)},
                {"direction", text(hit.direction)},
                {"accepted", hit.accepted},
                {"reasons", texts(hit.reasons)}};
  });
  json["modes"] = document(report.modes);
  json["workpiece_modes"] = document(report.workpiece_modes);
  json["lobes"] = document(report.lobes);
  json["forces"] = report.forces ? forces_json(*report.forces) : Json(nullptr);
  json["smooth"] = report.smooth ? smooth_json(*report.smooth) : Json(nullptr);
  json["monitor"] = report.monitor ? monitor_json(*report.monitor) : Json(nullptr);
  json["calibration"] = document(report.calibration);
  json["recordings"] = document(report.recordings);
  json["files"] = list_of(report.files, [](const StageFile& file) {
    return Json{{"stage", text(file.stage)}, {"file", text(file.file)}, {"description", text(file.description)}};
  });
  return json;
}

std::string report_json(const Report& report) {
  return shop_units(report).dump() + "\n";
}

}  // namespace robomill::report
