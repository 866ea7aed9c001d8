#include "robomill/cell/files/posture_json.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <string>

#include "robomill/base/units.hpp"
#include "robomill/modal/files/modal_objects.hpp"

namespace robomill::cell {
namespace {

const char* source_text(modal::PostureReport::Source source) {
  switch (source) {
    case modal::PostureReport::Source::calibrated:
      return "calibrated";
    case modal::PostureReport::Source::interpolated:
      return "interpolated";
    case modal::PostureReport::Source::cell:
      break;
  }
  return "cell";
}

/// Of each force column the direct receptance.
io::Json columns_object(const ModesOfPosture& posture) {
  io::Json out = io::Json::object();
  for (std::size_t axis = 0; axis < posture.report.direct.size(); ++axis) {
    const modal::PostureReport::Direct& direct = posture.report.direct[axis];
    out[std::string(1, "xyz"[axis])] = {
        {"measured", direct.measured},
        {"relative_error", io::number(direct.error)},
        {"left_out_relative_error", io::number(direct.left_out_error)},
        {"held_out_relative_error", io::number(direct.held_out_error)},
        {"deviation", io::number(posture.direct_deviation(static_cast<Eigen::Index>(axis)))}};
  }
  return out;
}

}  // namespace

std::string unmeasured_axes_text(const modal::PostureReport& report, const Eigen::Vector3d& deviation,
                                 const std::array<bool, 3>& asked) {
  if (report.source == modal::PostureReport::Source::cell) return {};
  std::string axes, directs;
  double worst = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t axis = 0; axis < report.direct.size(); ++axis) {
    if (report.direct[axis].measured || !asked[axis]) continue;
    const std::string separator = axes.empty() ? "" : " and ";
    axes += separator + "xyz"[axis];
    directs += separator + std::string(2, "xyz"[axis]);
    worst = std::fmax(worst, deviation(static_cast<Eigen::Index>(axis)));
  }
  if (axes.empty()) return {};
  const std::string off = std::isfinite(worst) ? fmt::format(
                                                     " and is likely off by {:.0f} %, which the deviations of "
                                                     "the modes include",
                                                     100.0 * worst)
                                               : std::string();
  return fmt::format(
      "Nobody hit along the base's {0}: {1} follows from the other columns{2}. A limit or deflection of a cut that "
      "pushes along {0} (a ball end, a leaning tool, axial forces) depends on it: hit along {0} too.",
      axes, directs, off);
}

io::Json posture_object(const ModesOfPosture& posture) {
  io::Json joints = io::Json::array(), modes = io::Json::array();
  for (const double joint : posture.joints) joints.push_back(io::number(joint / units::deg));
  for (const modal::Mode& mode : posture.prediction.modes.modes) {
    modes.push_back({{"frequency_hz", io::number(mode.frequency_hz)},
                     {"frequency_std_hz", io::number(mode.frequency_std_hz)},
                     {"damping_ratio", io::number(mode.damping_ratio)},
                     {"damping_std", io::number(mode.damping_ratio_std)},
                     {"residue_std", io::number(mode.residue_std_ratio)}});
  }
  return {{"joints_deg", joints},
          {"modes", modes},
          {"measured_nearby", posture.prediction.measured_nearby},
          {"distance_deg", io::number(posture.prediction.distance_rad / units::deg)},
          {"region_deg", io::number(posture.report.region_rad / units::deg)},
          {"nearest", posture.prediction.nearest},
          {"unmatched_modes", posture.unmatched},
          {"source", source_text(posture.report.source)},
          {"measured_postures", posture.report.postures},
          {"structure",
           {{"bearings", posture.report.bearings},
            {"bracket", posture.report.bracket},
            {"tool_modes", posture.report.tool_modes}}},
          {"columns", columns_object(posture)},
          {"relative_error", io::number(posture.report.error)},
          {"left_out_relative_error", io::number(posture.report.left_out_error)}};
}

std::vector<std::string> posture_warnings(const ModesOfPosture& posture, const std::array<bool, 3>& asked) {
  std::vector<std::string> out = posture.warnings;
  const modal::PosturePrediction& there = posture.prediction;
  if (posture.unmatched > 0) {
    out.push_back(fmt::format(
        "{} of the {} modes of the nearest posture ({}) have no counterpart in the others and are left out: limits "
        "computed from the rest are too deep where these would chatter.",
        posture.unmatched, posture.unmatched + there.modes.modes.size(), there.nearest));
  }
  const std::string unmeasured = unmeasured_axes_text(posture.report, posture.direct_deviation, asked);
  if (!unmeasured.empty()) out.push_back(unmeasured);
  if (there.measured_nearby || posture.report.postures == 0) return out;
  const double away_deg = there.distance_rad / units::deg;
  out.push_back(
      posture.report.postures == 1
          ? fmt::format("The posture lies {:.3g} deg from the only measured one. Its deviations grow with that.",
                        away_deg)
          : fmt::format(
                "The posture lies outside the measured region: {:.3g} deg from the nearest measured one (at most "
                "{:.3g} deg within it). Its deviations grow with that.",
                away_deg, posture.report.region_rad / units::deg));
  return out;
}

std::string posture_modes_json(const ModesOfPosture& posture) {
  io::Json json = modal::modes_object(posture.prediction.modes);
  json["posture"] = posture_object(posture);
  json["warnings"] = posture_warnings(posture);
  json["notes"] = posture.notes;
  json["assumed"] = io::assumed_json(posture.assumed);
  return io::dump(json);
}

}  // namespace robomill::cell
