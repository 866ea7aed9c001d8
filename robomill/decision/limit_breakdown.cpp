#include "robomill/decision/limit_breakdown.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "robomill/base/units.hpp"
#include "robomill/decision/choose.hpp"

namespace robomill::decision {
namespace {

constexpr Eigen::Index feed_directions = 36;
constexpr int speeds_a_direction = 40;
/// Depths at which the comparisons beside the main lobes look for the limit, before they refine it.
constexpr int comparison_depths = 30;
constexpr int comparison_speeds = 100;

stability::LobesOptions comparison_options(stability::LobesOptions options) {
  options.grid[1] = std::min(options.grid[1], comparison_depths);
  return options;
}

DepthCurve spindle_curve(const cutting::Milling& milling, const MachineLimits& machine,
                         const stability::LobesOptions& chart, const std::string& label, bool torque) {
  const auto torque_of = mean_torque_of(milling);
  const double deepest_m = 10.0 * chart.axial_depth_m[1];  // beyond any chart
  DepthCurve curve;
  curve.label = label;
  const auto n = static_cast<Eigen::Index>(machine.spindle.size());
  curve.spindle_speed_rad_per_s.resize(n);
  curve.axial_depth_m.resize(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const SpindleCapacity& p = machine.spindle[static_cast<std::size_t>(i)];
    curve.spindle_speed_rad_per_s(i) = p.spindle_speed_rad_per_s;
    const double able_n_m = torque ? p.torque_n_m : p.power_w / p.spindle_speed_rad_per_s;
    curve.axial_depth_m(i) = depth_of_torque_m(torque_of, able_n_m, deepest_m);
  }
  return curve;
}

}  // namespace

std::string limited_by_text(const Operation& operation) {
  switch (operation.limited_by) {
    case LimitedBy::chatter:
      return fmt::format("chatter of {} at {:.1f} Hz", to_string(operation.mode), operation.chatter_frequency_hz);
    case LimitedBy::depth_range:
      return fmt::format("the depth range of the lobes: no chatter found up to its end, {:.3g} mm",
                         operation.limit_depth_m / units::mm);
    case LimitedBy::cutter:
      return "the cutter's depth";
    case LimitedBy::spindle_torque:
      return "the spindle's torque";
    case LimitedBy::spindle_power:
      return "the spindle's power";
    case LimitedBy::surface_error:
      return "the permitted surface error";
    case LimitedBy::deflection:
      return "the permitted deflection";
    case LimitedBy::forced_vibration:
      return fmt::format(
          "forced vibration: within the speed window its amplitude, {:.3g} µm at this speed, may be the feed per tooth "
          "at most, {:.3g} µm",
          operation.vibration.amplitude_m / units::um, operation.feed_per_tooth_m / units::um);
  }
  return {};
}

std::vector<PartLimits> limits_of_pairs(const stability::LobesProblem& problem, const stability::LobesOptions& options,
                                        Progress& progress) {
  std::vector<PartLimits> out;
  const int modes = static_cast<int>(problem.dynamics.modes.size());
  if (modes < 3 || !problem.keep_modes.empty()) return out;
  const stability::LobesOptions coarse = comparison_options(options);
  const Eigen::Index count = std::min<Eigen::Index>(coarse.grid[0], comparison_speeds);
  const Eigen::VectorXd axis =
      Eigen::VectorXd::LinSpaced(count, coarse.spindle_speed_rad_per_s[0], coarse.spindle_speed_rad_per_s[1]);
  const std::vector<double> speeds(axis.begin(), axis.end());
  for (int k = 1; k <= modes; k += 2) {
    stability::LobesProblem part_problem = problem;
    part_problem.keep_modes = k < modes ? std::vector<int>{k, k + 1} : std::vector<int>{k};
    const std::vector<stability::Limit> limits = stability::limit_depths(part_problem, coarse, speeds, progress);
    PartLimits part;
    part.label = k < modes ? fmt::format("modes {}–{}", k, k + 1) : fmt::format("mode {}", k);
    if (!problem.workpiece_dynamics.modes.empty()) part.label += " and the workpiece's";
    part.modes = part_problem.keep_modes;
    part.spindle_speed_rad_per_s = axis;
    part.limit_depth_m.resize(static_cast<Eigen::Index>(limits.size()));
    for (std::size_t i = 0; i < limits.size(); ++i) {
      const bool found = limits[i].status == stability::Limit::Status::found;
      part.limit_depth_m(static_cast<Eigen::Index>(i)) =
          found ? limits[i].axial_depth_m : std::numeric_limits<double>::quiet_NaN();
    }
    out.push_back(std::move(part));
  }
  return out;
}

FeedDirections limits_over_feed(const stability::LobesProblem& problem, const stability::LobesOptions& options,
                                std::optional<double> at_rad_per_s, Progress& progress) {
  FeedDirections out;
  const stability::LobesOptions coarse = comparison_options(options);
  const double low = coarse.spindle_speed_rad_per_s[0];
  const double high = coarse.spindle_speed_rad_per_s[1];
  std::vector<double> speeds;
  speeds.reserve(speeds_a_direction + 1);
  for (int i = 0; i < speeds_a_direction; ++i)
    speeds.push_back(std::lerp(low, high, static_cast<double>(i) / (speeds_a_direction - 1)));
  if (at_rad_per_s) {
    speeds.push_back(*at_rad_per_s);
    out.limit_at_speed_m.resize(feed_directions);
  }
  out.direction_rad.resize(feed_directions);
  out.lowest_limit_m.setConstant(feed_directions, std::numeric_limits<double>::quiet_NaN());
  stability::LobesProblem turned = problem;
  // Turning the feed by half a turn turns forces and displacements alike: the limit is the same.
  constexpr Eigen::Index half = feed_directions / 2;
  for (Eigen::Index i = 0; i < half; ++i) {
    turned.feed_direction_rad = std::numbers::pi * static_cast<double>(i) / half;
    out.direction_rad(i) = turned.feed_direction_rad;
    out.direction_rad(i + half) = turned.feed_direction_rad + std::numbers::pi;
    const std::vector<stability::Limit> limits = stability::limit_depths(turned, coarse, speeds, progress);
    for (std::size_t k = 0; k < limits.size(); ++k) {
      const double depth = limits[k].status == stability::Limit::Status::found
                               ? limits[k].axial_depth_m
                               : std::numeric_limits<double>::quiet_NaN();
      if (k < speeds_a_direction) {
        out.lowest_limit_m(i) = std::fmin(out.lowest_limit_m(i), depth);
      } else {
        out.limit_at_speed_m(i) = depth;
      }
    }
  }
  out.lowest_limit_m.tail(half) = out.lowest_limit_m.head(half);
  if (at_rad_per_s) out.limit_at_speed_m.tail(half) = out.limit_at_speed_m.head(half);
  return out;
}

std::vector<DepthCurve> other_limits(const cutting::Milling& milling, const MachineLimits& machine,
                                     const stability::LobesOptions& chart) {
  std::vector<DepthCurve> curves;
  if (machine.spindle.size() > 1) {
    curves.push_back(spindle_curve(milling, machine, chart, "spindle torque", true));
    curves.push_back(spindle_curve(milling, machine, chart, "spindle power", false));
  }
  if (machine.max_axial_depth_m > 0.0) {
    const std::array<double, 2>& speeds = chart.spindle_speed_rad_per_s;
    curves.push_back({.label = "cutter's depth",
                      .spindle_speed_rad_per_s = Eigen::Vector2d(speeds[0], speeds[1]),
                      .axial_depth_m = Eigen::Vector2d::Constant(machine.max_axial_depth_m)});
  }
  return curves;
}

LimitShare limit_share(const std::vector<stability::Limit>& limits, const modal::ModalModel& tool,
                       const modal::ModalModel& workpiece) {
  const auto zeros = [](const modal::ModalModel& model) {
    return Eigen::VectorXd::Zero(static_cast<Eigen::Index>(model.modes.size())).eval();
  };
  LimitShare share = {zeros(tool), zeros(workpiece)};
  for (const stability::Limit& limit : limits) {
    if (limit.status != stability::Limit::Status::found || !limit.mode.known()) continue;
    Eigen::VectorXd& owner = limit.mode.of == modal::ModeOwner::tool ? share.tool : share.workpiece;
    owner(limit.mode.number - 1) += 1.0;
  }
  const double total = share.tool.sum() + share.workpiece.sum();
  if (total == 0.0) return {};
  share.tool /= total;
  share.workpiece /= total;
  return share;
}

}  // namespace robomill::decision
