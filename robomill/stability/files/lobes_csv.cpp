#include "robomill/stability/files/lobes_csv.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "robomill/base/units.hpp"
#include "robomill/io/csv.hpp"
#include "robomill/stability/files/chart_schema.hpp"

namespace robomill::stability {
namespace {

using io::csv_number;

constexpr double no_value = std::numeric_limits<double>::quiet_NaN();

std::string number_of(const modal::ModeId& mode) {
  return mode.known() ? std::to_string(mode.number) : std::string();
}

std::string owner_of(const modal::ModeId& mode) {
  return mode.known() ? std::string(to_string(mode.of)) : std::string();
}

/// On a straight line between the neighbours; NaN beyond the ends, and beside a limit that was not found.
double between(const Eigen::VectorXd& x, const Eigen::VectorXd& y, double at) {
  const double rounding = 1e-9 * at;
  const auto i = static_cast<Eigen::Index>(std::lower_bound(x.begin(), x.end(), at - rounding) - x.begin());
  if (i == x.size()) return no_value;
  if (x(i) <= at + rounding) return y(i);
  if (i == 0 || !std::isfinite(y(i - 1)) || !std::isfinite(y(i))) return no_value;
  return std::lerp(y(i - 1), y(i), (at - x(i - 1)) / (x(i) - x(i - 1)));
}

/// The column of what a chart varies, and its unit.
struct Column {
  std::string name;
  double unit = units::mm;
};

Column column_of(SweptParameter parameter) {
  return {.name = swept_key(parameter), .unit = is_angle(parameter) ? units::deg : units::mm};
}

}  // namespace

std::string limits_csv(const LobesResult& result, const UncertainLimits& uncertain) {
  const bool band = uncertain.samples > 0;
  std::string out = "spindle_speed_rpm,axial_depth_mm,chatter_frequency_hz,kind,mode,mode_of,error_estimate";
  out += band ? ",limit_5_percent_mm,limit_50_percent_mm,limit_95_percent_mm\n" : "\n";
  for (const Limit& limit : result.limit) {
    const double speed = limit.spindle_speed_rad_per_s;
    const bool found = limit.status == Limit::Status::found;
    const auto known = [&](double value) { return found ? value : no_value; };
    const auto quantile = [&](const Eigen::VectorXd& limits_m) {
      return "," + csv_number(between(uncertain.spindle_speed_rad_per_s, limits_m, speed), units::mm);
    };
    std::string last = csv_number(known(limit.error_estimate));
    if (band) {
      last += quantile(uncertain.limit_5_percent_m) + quantile(uncertain.limit_50_percent_m) +
              quantile(uncertain.limit_95_percent_m);
    }
    io::add_csv_row(
        out, {csv_number(speed, units::rpm), csv_number(known(limit.axial_depth_m), units::mm),
              csv_number(known(limit.chatter_frequency_hz)), found ? std::string(to_string(limit.kind)) : std::string(),
              number_of(limit.mode), owner_of(limit.mode), last});
  }
  return out;
}

std::string points_csv(const std::vector<PointResult>& points, SweptParameter parameter) {
  const Column column = column_of(parameter);
  const bool limited = parameter == SweptParameter::axial_depth;
  std::string out = "spindle_speed_rpm," + column.name + (limited ? ",limit_depth_mm" : "") +
                    ",stable,spectral_radius,error_estimate,gain_margin,dominant_frequency_hz,kind,mode,mode_of\n";
  for (const PointResult& point : points) {
    std::string value = csv_number(point.axial_depth_m, column.unit);
    if (limited) value += "," + csv_number(point.limit_depth_m, units::mm);
    io::add_csv_row(
        out, {csv_number(point.spindle_speed_rad_per_s, units::rpm), std::move(value), point.stable ? "true" : "false",
              csv_number(point.spectral_radius), csv_number(point.error_estimate), csv_number(point.gain_margin),
              csv_number(point.chatter_frequency_hz), std::string(to_string(point.kind)), number_of(point.mode),
              owner_of(point.mode)});
  }
  return out;
}

std::string sweep_csv(const SweepResult& result) {
  const Column column = column_of(result.parameter);
  std::string out = "spindle_speed_rpm,from_" + column.name + ",to_" + column.name + "\n";
  for (std::size_t s = 0; s < result.stable.size(); ++s) {
    const std::string speed = csv_number(result.spindle_speed_rad_per_s(static_cast<Eigen::Index>(s)), units::rpm);
    if (result.stable[s].empty()) io::add_csv_row(out, {speed, "", ""});
    for (const StableInterval& interval : result.stable[s]) {
      io::add_csv_row(out, {speed, csv_number(interval.from, column.unit), csv_number(interval.to, column.unit)});
    }
  }
  return out;
}

std::string comparison_csv(const MethodComparison& comparison) {
  std::string out = "method,lowest_limit_mm,median_error,worst_error,differ,seconds,rejection\n";
  for (const MethodRow& row : comparison.rows) {
    double lowest_m = no_value;
    for (const Limit& limit : row.limits) {
      if (limit.status == Limit::Status::found) lowest_m = std::fmin(lowest_m, limit.axial_depth_m);
    }
    const bool ran = row.rejection.empty();
    io::add_csv_row(out, {std::string(to_string(row.method)), csv_number(lowest_m, units::mm),
                          ran ? csv_number(row.median_error) : "", ran ? csv_number(row.worst_error) : "",
                          ran ? std::to_string(row.differ) : "", ran ? csv_number(row.seconds) : "",
                          ran ? "" : io::csv_text(row.rejection)});
  }
  return out;
}

}  // namespace robomill::stability
