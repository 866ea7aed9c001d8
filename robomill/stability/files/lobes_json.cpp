#include "robomill/stability/files/lobes_json.hpp"

#include <cmath>

#include "robomill/base/units.hpp"
#include "robomill/io/json.hpp"
#include "robomill/modal/files/mode_json.hpp"
#include "robomill/stability/files/lobes_object.hpp"
#include "robomill/stability/files/lobes_schema.hpp"

namespace robomill::stability {
namespace {

io::Json grid_json(const Eigen::VectorXd& values, double unit) {
  io::Json out = io::Json::array();
  for (const double value : values) out.push_back(io::number(value / unit));
  return out;
}

/// What a chart varies beside the speed.
struct Varied {
  const char* key = "axial_depth_mm";
  double unit = units::mm;
};

io::Json point_json(double spindle_speed_rad_per_s, double value, const Varied& varied = {}) {
  return {{"spindle_speed_rpm", io::number(spindle_speed_rad_per_s / units::rpm)},
          {varied.key, io::number(value / varied.unit)}};
}

/// The frequency at a limit is that of chatter; at any other point it is that of the dominant multiplier, stable or
/// not.
template <class Point>
void add_chatter(io::Json& json, const Point& point, const char* frequency = "chatter_frequency_hz") {
  json[frequency] = io::number(point.chatter_frequency_hz);
  json["kind"] = to_string(point.kind);
  modal::set_mode(json, point.mode);
}

io::Json boundary_json(const BoundaryPoint& point, const Varied& varied = {}) {
  io::Json row = point_json(point.spindle_speed_rad_per_s, point.axial_depth_m, varied);
  add_chatter(row, point);
  row["curve"] = point.curve;
  row["error_estimate"] = io::number(point.error_estimate);
  return row;
}

io::Json evaluated_json(const PointResult& point, const Varied& varied = {}) {
  io::Json row = point_json(point.spindle_speed_rad_per_s, point.axial_depth_m, varied);
  row["spectral_radius"] = io::number(point.spectral_radius);
  row["stable"] = point.stable;
  row["error_estimate"] = io::number(point.error_estimate);
  row["multiplier"] = io::complex_number(point.multiplier);
  add_chatter(row, point, "dominant_frequency_hz");
  if (!std::isnan(point.gain_margin)) row["gain_margin"] = io::number(point.gain_margin);
  if (!std::isnan(point.limit_depth_m)) {
    row["limit_depth_mm"] = io::number(point.limit_depth_m / units::mm);
    const bool limited = std::isfinite(point.limit_depth_m);
    row["margin"] = limited ? io::number(1.0 - point.axial_depth_m / point.limit_depth_m) : io::Json(nullptr);
  }
  return row;
}

io::Json map_json(const Eigen::MatrixXd& spectral_radius) {
  io::Json rows = io::Json::array();
  for (Eigen::Index i = 0; i < spectral_radius.rows(); ++i)
    rows.push_back(io::numbers(spectral_radius.row(i).transpose()));
  return rows;
}

}  // namespace

io::Json lobes_object(const LobesResult& result, const UncertainLimits& uncertain, const SurfaceMap& surface) {
  return lobes_document().write({.lobes = &result,
                                 .uncertain = uncertain.samples > 0 ? &uncertain : nullptr,
                                 .surface = surface.axial_depth_m.size() > 0 ? &surface : nullptr});
}

std::string sweep_json(const SweepResult& result) {
  const bool angle = is_angle(result.parameter);
  const std::string name(name_in(swept_names, result.parameter));
  const std::string key = name + (angle ? "_deg" : "_mm");
  const Varied varied = {.key = key.c_str(), .unit = angle ? units::deg : units::mm};
  io::Json json;
  json["sweep"] = name;
  json["spindle_speed_rpm"] = grid_json(result.spindle_speed_rad_per_s, units::rpm);
  json[key] = grid_json(result.value, varied.unit);
  json["spectral_radius"] = map_json(result.spectral_radius);
  json["boundary"] = io::Json::array();
  for (const BoundaryPoint& point : result.boundary) json["boundary"].push_back(boundary_json(point, varied));
  json["stable"] = io::Json::array();
  for (std::size_t s = 0; s < result.stable.size(); ++s) {
    io::Json intervals = io::Json::array();
    for (const StableInterval& interval : result.stable[s]) {
      intervals.push_back({io::number(interval.from / varied.unit), io::number(interval.to / varied.unit)});
    }
    const double speed = result.spindle_speed_rad_per_s(static_cast<Eigen::Index>(s));
    json["stable"].push_back({{"spindle_speed_rpm", io::number(speed / units::rpm)}, {"intervals", intervals}});
  }
  json["points"] = io::Json::array();
  for (const PointResult& point : result.points) json["points"].push_back(evaluated_json(point, varied));
  json["method"] = to_string(Method::collocation);
  json["period"] = to_string(result.period);
  json["evaluations"] = result.evaluations;
  json["unsettled"] = result.unsettled;
  json["uncertain"] = result.uncertain;
  json["seconds"] = io::number(result.seconds);
  return io::dump(json);
}

std::string comparison_json(const MethodComparison& comparison) {
  io::Json json;
  json["spindle_speed_rpm"] = io::Json::array();
  for (const double speed : comparison.spindle_speed_rad_per_s) {
    json["spindle_speed_rpm"].push_back(io::number(speed / units::rpm));
  }
  json["methods"] = io::Json::array();
  for (const MethodRow& row : comparison.rows) {
    io::Json limits = io::Json::array();
    for (const Limit& limit : row.limits) {
      const bool found = limit.status == Limit::Status::found;
      limits.push_back(found ? io::number(limit.axial_depth_m / units::mm) : io::Json(nullptr));
    }
    json["methods"].push_back({{"method", to_string(row.method)},
                               {"limit_mm", std::move(limits)},
                               {"median_error", io::number(row.median_error)},
                               {"worst_error", io::number(row.worst_error)},
                               {"differ", row.differ},
                               {"rejection", row.rejection},
                               {"seconds", io::number(row.seconds)}});
  }
  return io::dump(json);
}

}  // namespace robomill::stability
