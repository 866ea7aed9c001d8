#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "point.hpp"
#include "robomill/base/units.hpp"
#include "robomill/jobs/lobes.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

namespace robomill::app {
namespace {

void print_summary(const stability::LobesResult& result, const stability::SurfaceMap& surface) {
  for (const stability::PointResult& point : result.points) {
    fmt::print("{:.6g} rpm, {:.4g} mm: ", point.spindle_speed_rad_per_s / units::rpm, point.axial_depth_m / units::mm);
    if (std::isfinite(point.spectral_radius)) {
      fmt::print("|μ| = {:.6g} ± {:.1g}, ", point.spectral_radius, point.error_estimate);
    }
    fmt::print("{}", point.stable ? "stable" : "chatter");
    if (!std::isnan(point.gain_margin)) fmt::print(", gain margin {:.4g}", point.gain_margin);
    if (!point.stable) {
      fmt::print(" at {:.1f} Hz ({}, {})", point.chatter_frequency_hz, to_string(point.mode), to_string(point.kind));
    }
    fmt::print("\n");
  }
  const stability::Limit* lowest = nullptr;
  for (const stability::Limit& limit : result.limit) {
    if (limit.status != stability::Limit::Status::found) continue;
    if (lowest == nullptr || limit.axial_depth_m < lowest->axial_depth_m) lowest = &limit;
  }
  if (lowest == nullptr) {
    fmt::print("No chatter in the whole range.\n");
  } else {
    fmt::print("Stable at every speed up to {:.4g} mm; above that chatter at {:.6g} rpm and {:.1f} Hz ({}).\n",
               lowest->axial_depth_m / units::mm, lowest->spindle_speed_rad_per_s / units::rpm,
               lowest->chatter_frequency_hz, to_string(lowest->mode));
  }
  fmt::print("{} points of the chart in {:.2f} s, {}.\n", result.evaluations, result.seconds, to_string(result.method));
  const auto known = [](double error) { return std::isfinite(error); };
  if (std::ranges::any_of(surface.surface_location_error_m.reshaped(), known)) {
    double least = std::numeric_limits<double>::infinity();
    double most = -least;
    for (const double error : surface.surface_location_error_m.reshaped()) {
      if (!known(error)) continue;
      least = std::min(least, error);
      most = std::max(most, error);
    }
    fmt::print("Surface error of the stable cuts from {:.3g} to {:.3g} µm (positive: material left).\n",
               least / units::um, most / units::um);
  }
  if (result.uncertain > 0) {
    fmt::print("{} points are less accurate than the tolerance; their error_estimate says how much.\n",
               result.uncertain);
  }
}

std::string percent(double share) {
  return std::isfinite(share) ? fmt::format("{:.2g} %", 100.0 * share) : "-";
}

void print_sweep(const stability::SweepResult& sweep) {
  const bool angle = stability::is_angle(sweep.parameter);
  const double unit = angle ? units::deg : units::mm;
  const char* const name = angle ? "degrees" : "mm";
  const std::string_view what = name_in(stability::swept_names, sweep.parameter);
  for (const stability::PointResult& point : sweep.points) {
    fmt::print("{:.6g} rpm, {} {:.4g} {}: |μ| = {:.6g} ± {:.1g}, {}, gain margin {:.4g}\n",
               point.spindle_speed_rad_per_s / units::rpm, what, point.axial_depth_m / unit, name,
               point.spectral_radius, point.error_estimate, point.stable ? "stable" : "chatter", point.gain_margin);
  }
  for (std::size_t s = 0; s < sweep.stable.size(); ++s) {
    fmt::print("{:.6g} rpm: ", sweep.spindle_speed_rad_per_s(static_cast<Eigen::Index>(s)) / units::rpm);
    if (sweep.stable[s].empty()) fmt::print("stable at no {}", what);
    for (std::size_t i = 0; i < sweep.stable[s].size(); ++i) {
      const stability::StableInterval& interval = sweep.stable[s][i];
      fmt::print("{}{:.4g} to {:.4g}", i == 0 ? "stable from " : ", ", interval.from / unit, interval.to / unit);
    }
    fmt::print("{}\n", sweep.stable[s].empty() ? "" : std::string(" ") + name);
  }
  fmt::print("{} points of the chart in {:.2f} s.\n", sweep.evaluations, sweep.seconds);
  if (sweep.uncertain > 0) fmt::print("{} points are less accurate than the tolerance.\n", sweep.uncertain);
}

/// Every method beside the first: a row each.
void print_comparison(const stability::MethodComparison& comparison) {
  fmt::print("{:<34}{:>14}{:>14}{:>14}{:>8}{:>10}\n", "method", "lowest limit", "median error", "worst error", "differ",
             "seconds");
  for (const stability::MethodRow& row : comparison.rows) {
    if (!row.rejection.empty()) {
      fmt::print("{:<34}{}\n", to_string(row.method), row.rejection);
      continue;
    }
    std::string lowest = "none";
    double least_m = std::numeric_limits<double>::infinity();
    for (const stability::Limit& limit : row.limits) {
      if (limit.status == stability::Limit::Status::found) least_m = std::min(least_m, limit.axial_depth_m);
    }
    if (std::isfinite(least_m)) lowest = fmt::format("{:.4g} mm", least_m / units::mm);
    fmt::print("{:<34}{:>14}{:>14}{:>14}{:>8}{:>10.3f}\n", to_string(row.method), lowest, percent(row.median_error),
               percent(row.worst_error), row.differ, row.seconds);
  }
  fmt::print(
      "Limits at {} speeds; errors are against the first row, differ counts speeds at which only one has a limit.\n",
      comparison.spindle_speed_rad_per_s.size());
}

}  // namespace

Exit run(const LobesCommand& command, const Common& common, Progress& progress) {
  require_output(common, {io::Format::json}, "lobes are written as .json");
  jobs::LobesJob job = {.lobes = command.input, .compare = command.compare, .seed = common.seed};
  for (const std::string& text : command.at) job.points.push_back(parse_point(text));
  const jobs::LobesJobResult result = jobs::run_lobes(job, progress);
  write_output(common, [&result](io::Format) { return jobs::lobes_document(result); });
  if (!common.wants_summary()) return done;
  if (result.sweep) {
    print_sweep(*result.sweep);
  } else if (result.comparison) {
    print_comparison(*result.comparison);
  } else {
    print_summary(result.lobes, result.surface);
  }
  print_notes(result.cut.notes, "Note: ");
  return done;
}

}  // namespace robomill::app
