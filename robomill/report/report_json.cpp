#include <cmath>
#include <complex>
#include <numbers>
#include <utility>

#include "robomill/base/units.hpp"
#include "robomill/modal/files/mode_json.hpp"
#include "robomill/report/json.hpp"
#include "robomill/report/thin.hpp"

namespace robomill::report {
namespace {

using Json = nlohmann::ordered_json;

Json complex_number(std::complex<double> value) {
  return Json::array({number(value.real()), number(value.imag())});
}

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

const char* name_of(BoundaryKind kind) {
  switch (kind) {
    case BoundaryKind::hopf:
      return "hopf";
    case BoundaryKind::flip:
      return "flip";
    case BoundaryKind::fold:
      break;
  }
  return "fold";
}

/// A document of another writer, its numbers to six digits.
Json document(const std::string& text) {
  if (text.empty()) return nullptr;
  const auto round = [](auto& self, Json& value) -> void {
    if (value.is_number_float()) {
      value = number(value.get<double>());
    } else if (value.is_structured()) {
      for (Json& part : value) self(self, part);
    }
  };
  Json json = Json::parse(text);
  round(round, json);
  return json;
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

Json vector_json(const std::vector<modal::Dof>& dofs, const Eigen::VectorXcd& values, bool as_excitation) {
  Json by_dof = Json::object();
  for (std::size_t i = 0; i < dofs.size(); ++i) {
    by_dof[modal::to_string(dofs[i], as_excitation)] = complex_number(values[static_cast<Eigen::Index>(i)]);
  }
  return by_dof;
}

void add_modes(Json& list, const modal::ModalModel& model, modal::ModeOwner owner, const Eigen::VectorXd& limit_share) {
  for (std::size_t k = 0; k < model.modes.size(); ++k) {
    const modal::Mode& mode = model.modes[k];
    const auto index = static_cast<Eigen::Index>(k);
    list.push_back(
        {{"mode", k + 1},
         {"mode_of", modal::to_string(owner)},
         {"frequency_hz", number(mode.frequency_hz)},
         {"damping_ratio", number(mode.damping_ratio)},
         {"std", {{"frequency_hz", number(mode.frequency_std_hz)}, {"damping_ratio", number(mode.damping_ratio_std)}}},
         {"left", vector_json(model.excitations, mode.left, true)},
         {"right", vector_json(model.responses, mode.right, false)},
         {"limit_share", index < limit_share.size() ? number(limit_share[index]) : Json(nullptr)}});
  }
}

/// The tool's, then the workpiece's.
Json modes_json(const Report& report) {
  Json list = Json::array();
  if (report.model) add_modes(list, *report.model, modal::ModeOwner::tool, report.limit_share);
  if (report.workpiece_model) {
    add_modes(list, *report.workpiece_model, modal::ModeOwner::workpiece, report.workpiece_limit_share);
  }
  return list;
}

Json fit_json(const FitSummary& fit) {
  Json order = Json::array();
  Json frequency = Json::array();
  Json stable = Json::array();
  for (const StabilisationPole& pole : fit.stabilisation) {
    order.push_back(pole.order);
    frequency.push_back(number(pole.frequency_hz));
    stable.push_back(pole.stable);
  }
  return {{"method", text(fit.method)},
          {"relative_error", number(fit.relative_error)},
          {"mean_relative_error", number(fit.mean_relative_error)},
          {"band_from_hz", number(fit.band_from_hz)},
          {"band_to_hz", number(fit.band_to_hz)},
          {"converged", fit.converged},
          {"convergence", numbers(fit.convergence)},
          {"stabilisation", fit.stabilisation.empty() ? Json(nullptr)
                                                      : Json({{"order", std::move(order)},
                                                              {"frequency_hz", std::move(frequency)},
                                                              {"stable", std::move(stable)}})}};
}

Json boundary_json(const std::vector<BoundaryPoint>& boundary) {
  Json speed = Json::array();
  Json depth = Json::array();
  Json frequency = Json::array();
  Json kind = Json::array();
  Json mode = Json::array();
  Json mode_of = Json::array();
  for (const BoundaryPoint& point : boundary) {
    speed.push_back(number(point.spindle_speed_rad_per_s, units::rpm));
    depth.push_back(number(point.axial_depth_m, units::mm));
    frequency.push_back(number(point.chatter_frequency_hz));
    kind.push_back(name_of(point.kind));
    Json named;
    modal::set_mode(named, point.mode);
    mode.push_back(named["mode"]);
    mode_of.push_back(named["mode_of"]);
  }
  return {{"spindle_speed_rpm", std::move(speed)},
          {"axial_depth_mm", std::move(depth)},
          {"chatter_frequency_hz", std::move(frequency)},
          {"kind", std::move(kind)},
          {"mode", std::move(mode)},
          {"mode_of", std::move(mode_of)}};
}

Json map_json(const Lobes& lobes) {
  if (lobes.spectral_radius.size() == 0) return nullptr;
  Json rows = Json::array();
  for (Eigen::Index i = 0; i < lobes.spectral_radius.rows(); ++i) {
    rows.push_back(numbers(lobes.spectral_radius.row(i).transpose()));
  }
  return {{"spindle_speed_rpm", numbers(lobes.map_speed_rad_per_s, units::rpm)},
          {"axial_depth_mm", numbers(lobes.map_depth_m, units::mm)},
          {"spectral_radius", std::move(rows)}};
}

Json band_json(const LimitBand& band) {
  if (band.spindle_speed_rad_per_s.size() == 0) return nullptr;
  return {{"label", text(band.label)},
          {"spindle_speed_rpm", numbers(band.spindle_speed_rad_per_s, units::rpm)},
          {"low_mm", numbers(band.low_m, units::mm)},
          {"high_mm", numbers(band.high_m, units::mm)}};
}

Json lobes_json(const Lobes& lobes) {
  return {{"label", text(lobes.label)},
          {"modes", lobes.modes},
          {"spindle_speed_rpm", numbers(lobes.spindle_speed_rad_per_s, units::rpm)},
          {"limit_mm", numbers(lobes.limit_depth_m, units::mm)},
          {"searched_depth_mm", number(lobes.searched_depth_m, units::mm)},
          {"band", band_json(lobes.band)},
          {"boundary", boundary_json(lobes.boundary)},
          {"map", map_json(lobes)}};
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
  json["modes"] = modes_json(report);
  json["fit"] = report.fit ? fit_json(*report.fit) : Json(nullptr);
  json["lobes"] = list_of(report.lobes, lobes_json);
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
