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

Json name_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::stable:
      return "stable";
    case Verdict::borderline:
      return "borderline";
    case Verdict::chatter:
      return "chatter";
    case Verdict::unknown:
      break;
  }
  return nullptr;
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

const char* name_of(PeakKind kind) {
  switch (kind) {
    case PeakKind::rotation:
      return "rotation";
    case PeakKind::tooth_passing:
      return "tooth_passing";
    case PeakKind::chatter:
      return "chatter";
    case PeakKind::cut_or_chatter:
      return "cut_or_chatter";
    case PeakKind::other:
      break;
  }
  return "other";
}

Json recommendation_json(const Recommendation& r) {
  Json json = {{"spindle_speed_rpm", number(r.spindle_speed_rad_per_s, units::rpm)},
               {"axial_depth_mm", number(r.axial_depth_m, units::mm)},
               {"feed_per_tooth_mm", number(r.feed_per_tooth_m, units::mm)},
               {"margin", number(r.margin)},
               {"removal_rate_mm3_per_s", number(r.removal_rate_m3_per_s, units::mm3)},
               {"feed_mm_per_min", number(r.feed_m_per_s, units::mm / units::minute)},
               {"cutting_speed_m_per_min", number(r.cutting_speed_m_per_s, 1.0 / units::minute)},
               {"torque_n_m", number(r.torque_n_m)},
               {"power_w", number(r.power_w)},
               {"surface_error_um", number(r.surface_error_m, units::um)},
               {"peak_deflection_um", number(r.peak_deflection_m, units::um)},
               {"limited_by", text(r.limited_by)},
               {"chatter_frequency_hz", number(r.chatter_frequency_hz)}};
  modal::set_mode(json, r.mode);
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

Json curve_json(const DepthCurve& curve) {
  return {{"label", text(curve.label)},
          {"spindle_speed_rpm", numbers(curve.spindle_speed_rad_per_s, units::rpm)},
          {"axial_depth_mm", numbers(curve.axial_depth_m, units::mm)}};
}

Json cut_json(const TestCut& cut) {
  return {{"spindle_speed_rpm", number(cut.spindle_speed_rad_per_s, units::rpm)},
          {"axial_depth_mm", number(cut.axial_depth_m, units::mm)},
          {"result", name_of(cut.result)},
          {"predicted", name_of(cut.predicted)},
          {"limit_mm", number(cut.limit_depth_m, units::mm)},
          {"agrees", cut.agrees ? Json(*cut.agrees) : Json(nullptr)},
          {"note", text(cut.note)}};
}

Json recording_json(const Recording& recording) {
  const std::vector<Eigen::Index> keep = thin(recording.amplitude);
  Json peaks = Json::array();
  for (const Peak& peak : recording.peaks) {
    peaks.push_back({{"frequency_hz", number(peak.frequency_hz)},
                     {"amplitude", number(peak.amplitude)},
                     {"kind", name_of(peak.kind)},
                     {"text", text(peak.text)}});
  }
  const double rotation_hz = recording.spindle_speed_rad_per_s / (2.0 * std::numbers::pi);
  return {{"file", text(recording.file)},
          {"spindle_speed_rpm", number(recording.spindle_speed_rad_per_s, units::rpm)},
          {"teeth", recording.teeth},
          {"rotation_hz", number(rotation_hz)},
          {"tooth_passing_hz", number(rotation_hz * recording.teeth)},
          {"axial_depth_mm", number(recording.axial_depth_m, units::mm)},
          {"amplitude_unit", text(recording.amplitude_unit)},
          {"frequency_hz", numbers(recording.frequency_hz, keep)},
          {"amplitude", numbers(recording.amplitude, keep)},
          {"peaks", std::move(peaks)},
          {"verdict", name_of(recording.verdict)},
          {"reason", text(recording.reason)}};
}

Json feed_json(const FeedDirections& feed) {
  return {{"direction_deg", numbers(feed.direction_rad, units::deg)},
          {"lowest_limit_mm", numbers(feed.lowest_limit_m, units::mm)},
          {"limit_at_speed_mm",
           feed.limit_at_speed_m.size() > 0 ? numbers(feed.limit_at_speed_m, units::mm) : Json(nullptr)},
          {"spindle_speed_rpm", number(feed.spindle_speed_rad_per_s, units::rpm)},
          {"used_direction_deg", number(feed.used_direction_rad, units::deg)},
          {"searched_depth_mm", number(feed.searched_depth_m, units::mm)}};
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
  const Agreement counts = agreement(report.cuts);
  Json json = Json::object();
  json["title"] = text(report.title);
  json["created"] = text(report.created);
  json["facts"] = facts_json(report.facts);
  json["warnings"] = texts(report.warnings);
  json["notes"] = texts(report.notes);
  json["recommendation"] = report.recommendation ? recommendation_json(*report.recommendation) : Json(nullptr);
  json["alternatives"] = list_of(report.alternatives, recommendation_json);
  json["finishing"] = {{"max_surface_error_um", number(report.max_surface_error_m, units::um)},
                       {"max_deflection_um", number(report.max_deflection_m, units::um)}};
  json["no_recommendation"] = text(report.no_recommendation);
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
  json["other_limits"] = list_of(report.other_limits, [](const DepthCurve& curve) { return curve_json(curve); });
  json["cuts"] = list_of(report.cuts, cut_json);
  json["agreement"] = {{"agree", counts.agree}, {"disagree", counts.disagree}, {"not_compared", counts.not_compared}};
  json["feed_directions"] = report.feed_directions ? feed_json(*report.feed_directions) : Json(nullptr);
  json["forces"] = report.forces ? forces_json(*report.forces) : Json(nullptr);
  json["smooth"] = report.smooth ? smooth_json(*report.smooth) : Json(nullptr);
  json["monitor"] = report.monitor ? monitor_json(*report.monitor) : Json(nullptr);
  json["calibration"] = report.calibration.empty() ? Json(nullptr) : Json::parse(report.calibration);
  json["recordings"] = list_of(report.recordings, recording_json);
  json["files"] = list_of(report.files, [](const StageFile& file) {
    return Json{{"stage", text(file.stage)}, {"file", text(file.file)}, {"description", text(file.description)}};
  });
  return json;
}

std::string report_json(const Report& report) {
  return shop_units(report).dump() + "\n";
}

}  // namespace robomill::report
