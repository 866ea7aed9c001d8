#include "robomill/stability/files/lobes_schema.hpp"

#include <cmath>
#include <utility>

#include "robomill/base/units.hpp"
#include "robomill/modal/files/mode_schema.hpp"

namespace robomill::stability {
namespace {

using io::add_rows;
using io::key;
using io::Row;
using io::Schema;
using io::Use;

constexpr Name<BifurcationType> kinds[] = {
    {"hopf", BifurcationType::hopf}, {"flip", BifurcationType::flip}, {"fold", BifurcationType::fold}};
constexpr Name<Period> periods[] = {{"tooth", Period::tooth}, {"revolution", Period::revolution}};

/// How stability is lost there: the mode whose motion is greatest.
template <class T>
std::vector<Row<T>> chatter_keys(std::string frequency) {
  std::vector<Row<T>> rows = {
      key(std::move(frequency), &T::chatter_frequency_hz, "at which the motion of the dominant multiplier is greatest")
          .nullable(),
      key("kind", &T::kind, kinds, "how its multiplier leaves the unit circle")};
  add_rows(rows, modal::mode_keys<T>("that moves most"));
  return rows;
}

/// The keys of a point below those that say where it lies.
std::vector<Row<BoundaryPoint>> crossing_keys() {
  std::vector<Row<BoundaryPoint>> rows = chatter_keys<BoundaryPoint>("chatter_frequency_hz");
  rows.push_back(key("curve", &BoundaryPoint::curve, "of which curve, from 1; 0: points of each speed alone"));
  rows.push_back(key("error_estimate", &BoundaryPoint::error_estimate, "of the spectral radius").nullable());
  return rows;
}

const Schema<BoundaryPoint>& boundary_table() {
  static const Schema<BoundaryPoint> table(
      "boundary_point", "a point at which the spectral radius is 1",
      [] {
        std::vector<Row<BoundaryPoint>> rows = {
            key("spindle_speed_rpm", &BoundaryPoint::spindle_speed_rad_per_s, "spindle speed"),
            key("axial_depth_mm", &BoundaryPoint::axial_depth_m, "axial depth")};
        add_rows(rows, crossing_keys());
        return rows;
      }(),
      Use::written);
  return table;
}

const Schema<Limit>& limit_table() {
  static const Schema<Limit> table(
      "limit", "the lowest unstable depth at one speed",
      [] {
        const auto found = [](const Limit& limit) { return limit.status == Limit::Status::found; };
        std::vector<Row<Limit>> rows = {key("spindle_speed_rpm", &Limit::spindle_speed_rad_per_s, "spindle speed"),
                                        key(
                                            "axial_depth_mm",
                                            [found](const Limit& limit) {
                                              return found(limit) ? std::optional(limit.axial_depth_m) : std::nullopt;
                                            },
                                            "limit; none: no depth of the chart is unstable")
                                            .nullable()};
        for (Row<Limit>& row : chatter_keys<Limit>("chatter_frequency_hz"))
          rows.push_back(where(found, std::move(row)));
        rows.push_back(
            where(found, key("error_estimate", &Limit::error_estimate, "of the spectral radius there").nullable()));
        return rows;
      }(),
      Use::written);
  return table;
}

/// The keys of a point that was asked for, below those that say where it lies.
std::vector<Row<PointResult>> evaluation_keys() {
  std::vector<Row<PointResult>> rows = {
      key("spectral_radius", &PointResult::spectral_radius, "greatest |multiplier| of the period").nullable(),
      key("stable", &PointResult::stable, "spectral radius < 1"),
      key("error_estimate", &PointResult::error_estimate, "of the spectral radius").nullable(),
      key("multiplier", &PointResult::multiplier, "the dominant one, [re, im]")};
  add_rows(rows, chatter_keys<PointResult>("dominant_frequency_hz"));
  rows.push_back(where([](const PointResult& point) { return !std::isnan(point.gain_margin); },
                       key("gain_margin", &PointResult::gain_margin,
                           "smallest factor on the cutting stiffness at which the radius is 1; none: none up to 1,000")
                           .nullable()));
  const auto limited = [](const PointResult& point) { return !std::isnan(point.limit_depth_m); };
  rows.push_back(where(limited, key("limit_depth_mm", &PointResult::limit_depth_m,
                                    "lowest unstable depth at this speed; none: none in the chart's range")
                                    .nullable()));
  rows.push_back(where(limited, key(
                                    "margin",
                                    [](const PointResult& point) {
                                      return std::isfinite(point.limit_depth_m)
                                                 ? std::optional(1.0 - point.axial_depth_m / point.limit_depth_m)
                                                 : std::nullopt;
                                    },
                                    "1 - depth / limit")
                                    .nullable()));
  return rows;
}

const Schema<PointResult>& point_table() {
  static const Schema<PointResult> table(
      "point", "a point that was asked for",
      [] {
        std::vector<Row<PointResult>> rows = {
            key("spindle_speed_rpm", &PointResult::spindle_speed_rad_per_s, "spindle speed"),
            key("axial_depth_mm", &PointResult::axial_depth_m, "axial depth")};
        add_rows(rows, evaluation_keys());
        return rows;
      }(),
      Use::written);
  return table;
}

const Schema<UncertainLimits>& uncertainty_table() {
  static const Schema<UncertainLimits> table(
      "uncertainty", "limits of drawn problems: what is not known exactly",
      {key("samples", &UncertainLimits::samples, "problems drawn"),
       key("spindle_speed_rpm", &UncertainLimits::spindle_speed_rad_per_s, "spindle speeds"),
       key("axial_depth_mm", &UncertainLimits::axial_depth_m, "axial depths"),
       key("limit_5_percent_mm", &UncertainLimits::limit_5_percent_m, "5 % quantile of the limit at each speed")
           .nullable(),
       key("limit_50_percent_mm", &UncertainLimits::limit_50_percent_m, "median").nullable(),
       key("limit_95_percent_mm", &UncertainLimits::limit_95_percent_m, "95 % quantile").nullable(),
       key("chatter_probability", &UncertainLimits::chatter_probability, "share of the samples, a row a depth").exact(),
       key("seconds", &UncertainLimits::seconds, "computing time")},
      Use::written);
  return table;
}

const Schema<SurfaceMap>& surface_table() {
  static const Schema<SurfaceMap> table(
      "surface", "the surface that stable cuts leave, a row a depth",
      {key("spindle_speed_rpm", &SurfaceMap::spindle_speed_rad_per_s, "spindle speeds"),
       key("axial_depth_mm", &SurfaceMap::axial_depth_m, "axial depths"),
       key("surface_location_error_um", &SurfaceMap::surface_location_error_m,
           "positive: material is left; none: the cut is not stable")
           .exact()
           .nullable(),
       key("peak_to_peak_um", &SurfaceMap::peak_to_peak_m, "of the tip, the greatest of x, y and z")
           .exact()
           .nullable()},
      Use::written);
  return table;
}

/// How a chart was computed: its last keys.
template <class T>
std::vector<Row<T>> effort_keys() {
  return {key("period", &T::period, periods, "of the spectral radius"),
          key("evaluations", &T::evaluations, "spectral radii found"),
          key("unsettled", &T::unsettled, "of these, eigenvalues that did not converge"),
          key("uncertain", &T::uncertain, "points whose error estimate stays above the tolerance"),
          key("seconds", &T::seconds, "computing time")};
}

std::vector<Row<LobesResult>> chart_keys() {
  std::vector<Row<LobesResult>> rows = {
      key("spindle_speed_rpm", &LobesResult::spindle_speed_rad_per_s, "spindle speeds of the grid"),
      key("axial_depth_mm", &LobesResult::axial_depth_m, "axial depths of the grid"),
      key("spectral_radius", &LobesResult::spectral_radius, "map, a row a depth").exact().nullable().optional(),
      key("boundary", &LobesResult::boundary, boundary_table(), "curves on which the spectral radius is 1"),
      key("limit", &LobesResult::limit, limit_table(), "the limit at each speed of the grid"),
      key("points", &LobesResult::points, point_table(), "what was asked for by --at"),
      key("method", &LobesResult::method, method_names, "by which the chart was computed")};
  add_rows(rows, effort_keys<LobesResult>());
  return rows;
}

/// A point of a sweep: what stands for its axial depth is the parameter's value.
template <class Point>
struct Swept {
  const Point* point = nullptr;
  SweptParameter parameter = SweptParameter::lead;
};

template <class Point>
std::vector<Swept<Point>> swept(const std::vector<Point>& points, SweptParameter parameter) {
  std::vector<Swept<Point>> out;
  out.reserve(points.size());
  for (const Point& point : points) out.push_back({&point, parameter});
  return out;
}

/// Of the three keys that of the swept parameter.
/// @param value  (const T&) -> number or list of the object
template <class T, class Value>
std::vector<Row<T>> swept_keys(Value value, const char* meaning) {
  std::vector<Row<T>> rows;
  for (const auto& [name, parameter] : swept_names) {
    if (parameter == SweptParameter::axial_depth) continue;
    const std::string unit = is_angle(parameter) ? "_deg" : "_mm";
    const SweptParameter own = parameter;
    rows.push_back(where([own](const T& object) { return object.parameter == own; },
                         key(std::string(name) + unit, value, meaning)));
  }
  return rows;
}

template <class Point>
Schema<Swept<Point>> swept_table(const char* name, const char* meaning, const std::vector<Row<Point>>& keys) {
  std::vector<Row<Swept<Point>>> rows = {key(
      "spindle_speed_rpm", [](const Swept<Point>& at) { return at.point->spindle_speed_rad_per_s; }, "spindle speed")};
  add_rows(rows, swept_keys<Swept<Point>>([](const Swept<Point>& at) { return at.point->axial_depth_m; },
                                          "the parameter's value"));
  add_rows(rows, io::keys_of<Swept<Point>>(keys, [](const Swept<Point>& at) -> const Point& { return *at.point; }));
  return {name, meaning, std::move(rows), Use::written};
}

/// Where a sweep is stable at one speed.
struct StableAt {
  const SweepResult* sweep = nullptr;
  std::size_t speed = 0;
};

const Schema<StableAt>& stable_table() {
  static const Schema<StableAt> table(
      "stable_intervals", "where the cut is stable at one speed",
      {key(
           "spindle_speed_rpm",
           [](const StableAt& at) { return at.sweep->spindle_speed_rad_per_s(static_cast<Eigen::Index>(at.speed)); },
           "spindle speed"),
       key(
           "intervals",
           [](const StableAt& at) {
             const double unit = is_angle(at.sweep->parameter) ? units::deg : units::mm;
             std::vector<std::array<double, 2>> out;
             for (const StableInterval& interval : at.sweep->stable[at.speed])
               out.push_back({interval.from / unit, interval.to / unit});
             return out;
           },
           "[from, to] of the parameter, in the unit of its key")
           .entries(2)},
      Use::written);
  return table;
}

const Schema<MethodRow>& method_table() {
  static const Schema<MethodRow> table(
      "method", "what one method makes of the limits",
      {key("method", &MethodRow::method, method_names, "which"),
       key(
           "limit_mm", [](const MethodRow& row) { return limit_depths_of(row.limits); },
           "one a speed; none: no depth is unstable; an empty list: the method rejects the cut")
           .nullable(),
       key("median_error", &MethodRow::median_error, "of |limit / that of the first method - 1|").nullable(),
       key("worst_error", &MethodRow::worst_error, "the greatest of these").nullable(),
       key("differ", &MethodRow::differ, "speeds at which only one of the two finds a limit"),
       key("rejection", &MethodRow::rejection, "why the method rejects the cut; empty: it does not"),
       key("seconds", &MethodRow::seconds, "computing time")},
      Use::written);
  return table;
}

}  // namespace

std::vector<std::optional<double>> limit_depths_of(const std::vector<Limit>& limits) {
  std::vector<std::optional<double>> out;
  out.reserve(limits.size());
  for (const Limit& limit : limits) {
    out.push_back(limit.status == Limit::Status::found ? std::optional(limit.axial_depth_m) : std::nullopt);
  }
  return out;
}

io::Json lobes_object(const LobesResult& result, const UncertainLimits& uncertain, const SurfaceMap& surface) {
  return lobes_table().write(LobesView(result, uncertain, surface));
}

const Schema<LobesView>& lobes_table() {
  static const Schema<LobesView> table(
      "lobes", "stability lobes: the limit of the axial depth over the spindle speed",
      [] {
        std::vector<Row<LobesView>> rows = io::keys_of<LobesView>(
            chart_keys(), [](const LobesView& view) -> const LobesResult& { return *view.lobes; });
        rows.push_back(
            key("uncertainty", &LobesView::uncertain, uncertainty_table(), "quantiles, where asked for").optional());
        rows.push_back(key("surface", &LobesView::surface, surface_table(), "where asked for").optional());
        return rows;
      }(),
      Use::written, 1);
  return table;
}

const Schema<SweepResult>& sweep_table() {
  static const Schema<Swept<BoundaryPoint>> boundary =
      swept_table<BoundaryPoint>("swept_boundary_point", "a point at which the spectral radius is 1", crossing_keys());
  static const Schema<Swept<PointResult>> point =
      swept_table<PointResult>("swept_point", "a point that was asked for", evaluation_keys());
  static const Schema<SweepResult> table(
      "sweep", "stability over the spindle speed and another parameter than the axial depth",
      [] {
        std::vector<Row<SweepResult>> rows = {
            key("sweep", &SweepResult::parameter, swept_names, "which parameter")
                .words({"radial_depth", "lead", "tilt"}),
            key("spindle_speed_rpm", &SweepResult::spindle_speed_rad_per_s, "spindle speeds of the grid")};
        add_rows(rows,
                 swept_keys<SweepResult>([](const SweepResult& sweep) { return sweep.value; }, "values of the grid"));
        add_rows(rows, {key("spectral_radius", &SweepResult::spectral_radius, "map, a row a value").exact().nullable(),
                        key(
                            "boundary", [](const SweepResult& sweep) { return swept(sweep.boundary, sweep.parameter); },
                            boundary, "curves on which the spectral radius is 1"),
                        key(
                            "stable",
                            [](const SweepResult& sweep) {
                              std::vector<StableAt> out;
                              for (std::size_t s = 0; s < sweep.stable.size(); ++s) out.push_back({&sweep, s});
                              return out;
                            },
                            stable_table(), "at each speed of the grid"),
                        key(
                            "points", [](const SweepResult& sweep) { return swept(sweep.points, sweep.parameter); },
                            point, "what was asked for by --at"),
                        key(
                            "method", [](const SweepResult&) { return Method::collocation; }, method_names,
                            "by which the chart was computed")});
        add_rows(rows, effort_keys<SweepResult>());
        return rows;
      }(),
      Use::written, 1);
  return table;
}

const Schema<MethodComparison>& comparison_table() {
  static const Schema<MethodComparison> table(
      "comparison", "the limits by every method: the first is what the others are compared with",
      {key("spindle_speed_rpm", &MethodComparison::spindle_speed_rad_per_s, "spindle speeds"),
       key("methods", &MethodComparison::rows, method_table(), "one a method")},
      Use::written, 1);
  return table;
}

}  // namespace robomill::stability
