#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>

#include "robomill/base/units.hpp"
#include "robomill/report/json.hpp"
#include "robomill/report/thin.hpp"

namespace robomill::report {
namespace {

using Json = nlohmann::ordered_json;
using Indices = std::vector<Eigen::Index>;

constexpr double mm2 = units::mm * units::mm;
constexpr Eigen::Index most_points = 4000;
constexpr std::size_t worst_blocks = 10;

Json triple(const Eigen::Vector3d& si, double unit = 1.0) {
  return Json::array({number(si.x(), unit), number(si.y(), unit), number(si.z(), unit)});
}

Json engagement_json(const std::vector<EngagementRing>& rings) {
  Json list = Json::array();
  for (const EngagementRing& ring : rings) {
    Json arcs = Json::array();
    for (const EngagementArc& arc : ring.arcs) {
      arcs.push_back(
          {{"entry_deg", number(arc.entry_rad, units::deg)}, {"exit_deg", number(arc.exit_rad, units::deg)}});
    }
    list.push_back({{"height_mm", number(ring.height_m, units::mm)},
                    {"position_deg", number(ring.position_rad, units::deg)},
                    {"arcs", std::move(arcs)}});
  }
  return list;
}

Json revolution_json(const ForceRevolution& turn) {
  const std::vector<Eigen::VectorXd> force = {turn.force_n.row(0).transpose(), turn.force_n.row(1).transpose(),
                                              turn.force_n.row(2).transpose()};
  const Indices keep = thin_together({force[0], force[1], force[2], turn.torque_n_m}, most_points);
  return {{"on", turn.on_workpiece ? "workpiece" : "tool"},
          {"rotation_deg", numbers(turn.rotation_rad, keep, units::deg)},
          {"fx_n", numbers(force[0], keep)},
          {"fy_n", numbers(force[1], keep)},
          {"fz_n", numbers(force[2], keep)},
          {"torque_n_m", numbers(turn.torque_n_m, keep)},
          {"mean_n", triple(turn.mean_n)},
          {"peak_n", triple(turn.peak_n)},
          {"rms_n", triple(turn.rms_n)},
          {"mean_torque_n_m", number(turn.mean_torque_n_m)},
          {"peak_torque_n_m", number(turn.peak_torque_n_m)},
          {"power_w", number(turn.power_w)},
          {"chip_area_mm2", number(turn.chip_area_m2, mm2)},
          {"removal_rate_mm3_per_s", number(turn.removal_rate_m3_per_s, units::mm3)},
          {"engagement", engagement_json(turn.engagement)},
          {"deflection_um", triple(turn.deflection_m, units::um)},
          {"peak_deflection_um", number(turn.peak_deflection_m, units::um)},
          {"vibrating", turn.vibrating},
          {"verdict", text(turn.verdict)},
          {"chatter_frequency_hz", number(turn.chatter_frequency_hz)}};
}

/// A count, with all its digits.
Json whole(double value) {
  return static_cast<std::int64_t>(value);
}

Json wholes(const Eigen::VectorXd& values, const Indices& keep) {
  Json list = Json::array();
  for (const Eigen::Index i : keep) list.push_back(whole(values[i]));
  return list;
}

bool cuts(const ForcePath& path, Eigen::Index i) {
  return path.cuts[static_cast<std::size_t>(i)];
}

Json value_at(const Eigen::VectorXd& values, Eigen::Index i, double unit = 1.0) {
  return values.size() > 0 ? number(values[i], unit) : Json(nullptr);
}

/// The highest value of the blocks that cut, and its block; null where none is known.
Json highest_json(const ForcePath& path, const Eigen::VectorXd& values, double unit = 1.0) {
  Eigen::Index at = -1;
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    if (!cuts(path, i) || !std::isfinite(values[i])) continue;
    if (at < 0 || values[i] > values[at]) at = i;
  }
  if (at < 0) return nullptr;
  return {{"value", number(values[at], unit)}, {"block", whole(path.block[at])}, {"line", whole(path.line[at])}};
}

/// The blocks with the highest peak force, the worst first.
Json worst_json(const ForcePath& path) {
  Indices order;
  order.reserve(path.cuts.size());
  for (Eigen::Index i = 0; i < path.block.size(); ++i) {
    if (cuts(path, i) && std::isfinite(path.peak_force_n[i])) order.push_back(i);
  }
  std::ranges::stable_sort(order,
                           [&](Eigen::Index a, Eigen::Index b) { return path.peak_force_n[a] > path.peak_force_n[b]; });
  order.resize(std::min(order.size(), worst_blocks));
  Json rows = Json::array();
  for (const Eigen::Index i : order) {
    rows.push_back({{"block", whole(path.block[i])},
                    {"line", whole(path.line[i])},
                    {"tip_mm", triple(path.tip_m.col(i), units::mm)},
                    {"axial_depth_mm", number(path.axial_depth_m[i], units::mm)},
                    {"radial_depth_mm", number(path.radial_depth_m[i], units::mm)},
                    {"peak_force_n", number(path.peak_force_n[i])},
                    {"mean_force_n", triple(path.mean_force_n.col(i))},
                    {"torque_n_m", number(path.torque_n_m[i])},
                    {"power_w", number(path.power_w[i])},
                    {"deflection_um", value_at(path.deflection_m, i, units::um)}});
  }
  return rows;
}

Json curves_json(const ForcePath& path) {
  const bool bends = path.deflection_m.array().isFinite().any();
  std::vector<Eigen::VectorXd> curves = {path.peak_force_n, path.torque_n_m, path.peak_torque_n_m, path.power_w};
  if (bends) curves.push_back(path.deflection_m);
  const Indices keep = thin_together(curves, most_points);
  return {{"path_mm", numbers(path.path_m, keep, units::mm)},
          {"block", wholes(path.block, keep)},
          {"line", wholes(path.line, keep)},
          {"peak_force_n", numbers(path.peak_force_n, keep)},
          {"torque_n_m", numbers(path.torque_n_m, keep)},
          {"peak_torque_n_m", numbers(path.peak_torque_n_m, keep)},
          {"power_w", numbers(path.power_w, keep)},
          {"deflection_um", bends ? numbers(path.deflection_m, keep, units::um) : Json(nullptr)}};
}

/// Where the tip goes. The ends of moves in air stay as far as there is room, so that no grey line cuts a corner.
Json track_json(const ForcePath& path) {
  const Eigen::Index n = path.block.size();
  Indices keep = thin_together(
      {path.peak_force_n, path.tip_m.row(0).transpose(), path.tip_m.row(1).transpose(), path.tip_m.row(2).transpose()},
      most_points);
  if (n > most_points) {
    Indices turns;
    for (Eigen::Index i = 1; i < n && std::ssize(turns) < most_points / 2; ++i) {
      if (cuts(path, i) == cuts(path, i - 1)) continue;
      turns.push_back(i - 1);
      turns.push_back(i);
    }
    keep.insert(keep.end(), turns.begin(), turns.end());
    std::ranges::sort(keep);
    keep.erase(std::unique(keep.begin(), keep.end()), keep.end());
  }
  Json cutting = Json::array();
  for (const Eigen::Index i : keep) cutting.push_back(cuts(path, i));
  return {{"x_mm", numbers(path.tip_m.row(0).transpose(), keep, units::mm)},
          {"y_mm", numbers(path.tip_m.row(1).transpose(), keep, units::mm)},
          {"z_mm", numbers(path.tip_m.row(2).transpose(), keep, units::mm)},
          {"block", wholes(path.block, keep)},
          {"line", wholes(path.line, keep)},
          {"peak_force_n", numbers(path.peak_force_n, keep)},
          {"cuts", std::move(cutting)}};
}

Json path_json(const ForcePath& path) {
  const Eigen::Index n = path.block.size();
  if (n == 0) return nullptr;
  return {{"blocks", n},
          {"cutting_blocks", std::accumulate(path.cuts.begin(), path.cuts.end(), Eigen::Index{0})},
          {"length_mm", number(path.path_m[n - 1], units::mm)},
          {"time_s", value_at(path.time_s, n - 1)},
          {"torque_limit_n_m", number(path.torque_limit_n_m)},
          {"power_limit_w", number(path.power_limit_w)},
          {"power_time_s", number(path.power_time_s)},
          {"highest",
           {{"peak_force_n", highest_json(path, path.peak_force_n)},
            {"torque_n_m", highest_json(path, path.torque_n_m)},
            {"peak_torque_n_m", highest_json(path, path.peak_torque_n_m)},
            {"power_w", highest_json(path, path.power_w)},
            {"deflection_um", highest_json(path, path.deflection_m, units::um)}}},
          {"worst", worst_json(path)},
          {"troubles", texts(path.troubles)},
          {"curves", curves_json(path)},
          {"track", track_json(path)}};
}

Json sweep_json(const RedundancySweep& sweep) {
  if (sweep.rotation_rad.size() == 0) return nullptr;
  const bool conditioned = sweep.condition_number.size() > 0;
  // What would be read off the curve at the two marks, between its points.
  const auto deflection_at = [&](double at_rad) {
    const Eigen::VectorXd& x = sweep.rotation_rad;
    const auto above = std::ranges::lower_bound(x, at_rad) - x.begin();
    if (!std::isfinite(at_rad) || above == x.size()) return missing;
    if (x[above] == at_rad) return sweep.deflection_m[above];
    if (above == 0) return missing;
    const double share = (at_rad - x[above - 1]) / (x[above] - x[above - 1]);
    return (1.0 - share) * sweep.deflection_m[above - 1] + share * sweep.deflection_m[above];
  };
  return {{"rotation_deg", numbers(sweep.rotation_rad, units::deg)},
          {"deflection_um", numbers(sweep.deflection_m, units::um)},
          {"condition_number", conditioned ? numbers(sweep.condition_number) : Json(nullptr)},
          {"best_deg", number(sweep.best_rad, units::deg)},
          {"best_um", number(deflection_at(sweep.best_rad), units::um)},
          {"used_deg", number(sweep.used_rad, units::deg)},
          {"used_um", number(deflection_at(sweep.used_rad), units::um)}};
}

}  // namespace

Json forces_json(const Forces& forces) {
  std::vector<std::string> warnings = forces.warnings;
  if (forces.path && forces.path->block.size() == 0) {
    // A program of which no block could be computed has no part of its own to say why.
    warnings.insert(warnings.end(), forces.path->troubles.begin(), forces.path->troubles.end());
  }
  return {{"facts", facts_json(forces.facts)},
          {"warnings", texts(warnings)},
          {"notes", texts(forces.notes)},
          {"revolution", forces.revolution ? revolution_json(*forces.revolution) : Json(nullptr)},
          {"program", forces.path ? path_json(*forces.path) : Json(nullptr)},
          {"spindle_rotation", forces.spindle_rotation ? sweep_json(*forces.spindle_rotation) : Json(nullptr)}};
}

}  // namespace robomill::report
