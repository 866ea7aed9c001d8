#include "robomill/stability/files/lobes_schema.hpp"

#include <cmath>
#include <utility>

#include "robomill/base/units.hpp"
#include "robomill/modal/mode_id.hpp"

namespace robomill::stability {
namespace {

using io::computed;
using io::Holds;
using io::Json;
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
  Row<T> owner = computed<T>(
                     "mode_of", Holds::word,
                     [](const T& at) { return at.mode.known() ? Json(modal::to_string(at.mode.of)) : Json(); },
                     "structure whose mode it is")
                     .nullable();
  owner.key.words = {"tool", "workpiece"};
  return {
      key(std::move(frequency), &T::chatter_frequency_hz, "at which the motion of the dominant multiplier is greatest")
          .nullable(),
      key("kind", &T::kind, kinds, "how its multiplier leaves the unit circle"),
      computed<T>(
          "mode", Holds::integer, [](const T& at) { return at.mode.known() ? Json(at.mode.number) : Json(); },
          "that moves most, from 1")
          .nullable(),
      std::move(owner)};
}

template <class T>
void append(std::vector<Row<T>>& rows, std::vector<Row<T>> more) {
  for (Row<T>& row : more) rows.push_back(std::move(row));
}

const Schema<BoundaryPoint>& boundary_table() {
  static const Schema<BoundaryPoint> table(
      "boundary_point", "a point at which the spectral radius is 1",
      [] {
        std::vector<Row<BoundaryPoint>> rows = {
            key("spindle_speed_rpm", &BoundaryPoint::spindle_speed_rad_per_s, "spindle speed"),
            key("axial_depth_mm", &BoundaryPoint::axial_depth_m, "axial depth")};
        append(rows, chatter_keys<BoundaryPoint>("chatter_frequency_hz"));
        rows.push_back(key("curve", &BoundaryPoint::curve, "of which curve, from 1; 0: points of each speed alone"));
        rows.push_back(key("error_estimate", &BoundaryPoint::error_estimate, "of the spectral radius").nullable());
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
                                        computed<Limit>(
                                            "axial_depth_mm", Holds::number,
                                            [found](const Limit& limit) {
                                              return found(limit) ? io::number(limit.axial_depth_m / units::mm)
                                                                  : Json();
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

const Schema<PointResult>& point_table() {
  static const Schema<PointResult> table(
      "point", "a point that was asked for",
      [] {
        const auto known = [](double PointResult::*member) {
          return [member](const PointResult& point) { return !std::isnan(point.*member); };
        };
        std::vector<Row<PointResult>> rows = {
            key("spindle_speed_rpm", &PointResult::spindle_speed_rad_per_s, "spindle speed"),
            key("axial_depth_mm", &PointResult::axial_depth_m, "axial depth"),
            key("spectral_radius", &PointResult::spectral_radius, "greatest |multiplier| of the period").nullable(),
            key("stable", &PointResult::stable, "spectral radius < 1"),
            key("error_estimate", &PointResult::error_estimate, "of the spectral radius").nullable(),
            key("multiplier", &PointResult::multiplier, "the dominant one, [re, im]")};
        append(rows, chatter_keys<PointResult>("dominant_frequency_hz"));
        rows.push_back(
            where(known(&PointResult::gain_margin),
                  key("gain_margin", &PointResult::gain_margin,
                      "smallest factor on the cutting stiffness at which the radius is 1; none: none up to 1,000")));
        rows.push_back(where(known(&PointResult::limit_depth_m),
                             key("limit_depth_mm", &PointResult::limit_depth_m,
                                 "lowest unstable depth at this speed; none: none in the chart's range")));
        rows.push_back(where(known(&PointResult::limit_depth_m),
                             computed<PointResult>(
                                 "margin", Holds::number,
                                 [](const PointResult& point) {
                                   return std::isfinite(point.limit_depth_m)
                                              ? io::number(1.0 - point.axial_depth_m / point.limit_depth_m)
                                              : Json();
                                 },
                                 "1 - depth / limit")));
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
       key("chatter_probability", &UncertainLimits::chatter_probability, "share of the samples, a row a depth"),
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
           .nullable(),
       key("peak_to_peak_um", &SurfaceMap::peak_to_peak_m, "of the tip, the greatest of x, y and z").nullable()},
      Use::written);
  return table;
}

const Schema<LobesResult>& chart_table() {
  static const Schema<LobesResult> table(
      "chart", "a stability chart",
      {key("spindle_speed_rpm", &LobesResult::spindle_speed_rad_per_s, "spindle speeds of the grid"),
       key("axial_depth_mm", &LobesResult::axial_depth_m, "axial depths of the grid"),
       key("spectral_radius", &LobesResult::spectral_radius, "map, a row a depth").nullable().optional(),
       key("boundary", &LobesResult::boundary, boundary_table(), "curves on which the spectral radius is 1"),
       key("limit", &LobesResult::limit, limit_table(), "the limit at each speed of the grid"),
       key("points", &LobesResult::points, point_table(), "what was asked for by --at"),
       key("method", &LobesResult::method, method_names, "by which the chart was computed"),
       key("period", &LobesResult::period, periods, "of the spectral radius"),
       key("evaluations", &LobesResult::evaluations, "spectral radii found"),
       key("unsettled", &LobesResult::unsettled, "of these, eigenvalues that did not converge"),
       key("uncertain", &LobesResult::uncertain, "points whose error estimate stays above the tolerance"),
       key("seconds", &LobesResult::seconds, "computing time")},
      Use::written);
  return table;
}

}  // namespace

io::Document<LobesView> lobes_document() {
  static const Schema<LobesView> table(
      "lobes", "stability lobes: lobes.json",
      [] {
        std::vector<Row<LobesView>> rows = keys_of<LobesView>(
            chart_table().rows(), [](const LobesView& view) -> const LobesResult& { return *view.lobes; });
        rows.push_back(part("uncertainty", &LobesView::uncertain, uncertainty_table(), "quantiles, where asked for"));
        rows.push_back(part("surface", &LobesView::surface, surface_table(), "where asked for"));
        return rows;
      }(),
      Use::written);
  return {table, 1};
}

}  // namespace robomill::stability
