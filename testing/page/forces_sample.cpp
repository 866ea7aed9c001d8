#include "testing/page/forces_sample.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <utility>
#include <vector>

#include "robomill/base/units.hpp"

namespace robomill::page {
namespace {

using Json = nlohmann::ordered_json;
using std::numbers::pi;

constexpr int teeth = 2;
constexpr int rings = 240;  ///< that the force is summed over
constexpr int shown_rings = 24;
constexpr double radius_m = 3.0 * units::mm;
constexpr double depth_m = 1.0 * units::mm;
constexpr double stepover_m = 0.5 * units::mm;
constexpr double feed_per_tooth_m = 0.02 * units::mm;
constexpr double speed_rad_per_s = 18000.0 * units::rpm;
constexpr double tangential_n_per_m2 = 1770.0 * units::n_per_mm2;
constexpr double radial_n_per_m2 = 560.0 * units::n_per_mm2;
constexpr double edge_n_per_m = 13.0 * units::n_per_mm;

/// Up-milling: of a ring, the pass beside leaves what lies between φ = 0 and cos φ = 1 - l / (R sin κ).
double exit_of(double position_rad) {
  return std::acos(std::max(-1.0, 1.0 - stepover_m / (radius_m * std::sin(position_rad))));
}

double position_of(int ring, int count) {
  const double deepest_rad = std::acos(1.0 - depth_m / radius_m);
  return deepest_rad * (static_cast<double>(ring) + 0.5) / count;
}

struct Load {
  Eigen::Vector3d force_n = Eigen::Vector3d::Zero();
  double torque_n_m = 0.0;
};

/// One tooth's share on one ring at φ.
void add_element(double position_rad, double phi, Load& sum) {
  const double length_m = radius_m * std::acos(1.0 - depth_m / radius_m) / rings;
  const double chip_m = feed_per_tooth_m * std::sin(phi) * std::sin(position_rad);
  const double tangential_n = (tangential_n_per_m2 * chip_m + edge_n_per_m) * length_m;
  const double radial_n = (radial_n_per_m2 * chip_m + edge_n_per_m) * length_m;
  const double inward_n = radial_n * std::sin(position_rad);
  sum.force_n.x() -= tangential_n * std::cos(phi) + inward_n * std::sin(phi);
  sum.force_n.y() -= -tangential_n * std::sin(phi) + inward_n * std::cos(phi);
  sum.force_n.z() += radial_n * std::cos(position_rad);
  sum.torque_n_m += tangential_n * radius_m * std::sin(position_rad);
}

Load load_at(double rotation_rad) {
  Load sum;
  for (int tooth = 0; tooth < teeth; ++tooth) {
    for (int ring = 0; ring < rings; ++ring) {
      const double position_rad = position_of(ring, rings);
      const double lag_rad = (1.0 - std::cos(position_rad)) * std::tan(30.0 * units::deg);
      const double turned = rotation_rad + 2.0 * pi * tooth / teeth - lag_rad;
      const double phi = turned - 2.0 * pi * std::floor(turned / (2.0 * pi));
      if (phi < exit_of(position_rad)) add_element(position_rad, phi, sum);
    }
  }
  return sum;
}

/// Forces and torque over the rotation; length n of each.
struct Turn {
  Eigen::VectorXd rotation_deg = Eigen::VectorXd::LinSpaced(361, 0.0, 360.0);
  Eigen::Matrix3Xd force_n = Eigen::Matrix3Xd(3, 361);
  Eigen::VectorXd torque_n_m = Eigen::VectorXd(361);

  Turn() {
    for (Eigen::Index i = 0; i < rotation_deg.size(); ++i) {
      const Load load = load_at(rotation_deg[i] * units::deg);
      force_n.col(i) = load.force_n;
      torque_n_m[i] = load.torque_n_m;
    }
  }
  [[nodiscard]] Eigen::Vector3d mean_n() const { return force_n.leftCols(360).rowwise().mean(); }
  [[nodiscard]] Eigen::Vector3d deflection_um() const { return mean_n().cwiseProduct(Eigen::Vector3d(1.9, 2.4, 0.6)); }
  [[nodiscard]] double mean_torque_n_m() const { return torque_n_m.head(360).mean(); }
  [[nodiscard]] double power_w() const { return mean_torque_n_m() * speed_rad_per_s; }
};

Json list(const Eigen::VectorXd& values) {
  return std::vector<double>(values.begin(), values.end());
}

Json engagement_json() {
  Json engagement = Json::array();
  for (int ring = 0; ring < shown_rings; ++ring) {
    const double position_rad = position_of(ring, shown_rings);
    engagement.push_back({{"height_mm", radius_m * (1.0 - std::cos(position_rad)) / units::mm},
                          {"radius_mm", radius_m * std::sin(position_rad) / units::mm},
                          {"position_deg", position_rad / units::deg},
                          {"arcs_deg", Json::array({Json::array({0.0, exit_of(position_rad) / units::deg})})}});
  }
  return engagement;
}

Json revolution_json(const Turn& turn) {
  const Eigen::Matrix3Xd once = turn.force_n.leftCols(360);
  Eigen::Vector3d peak_n;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    Eigen::Index at = 0;
    once.row(axis).cwiseAbs().maxCoeff(&at);
    peak_n[axis] = once(axis, at);
  }
  const double chip_area_m2 = depth_m * stepover_m;
  const double feed_m_per_s = feed_per_tooth_m * teeth * speed_rad_per_s / (2.0 * pi);
  Json out = {{"mean_n", list(turn.mean_n())},
              {"peak_n", list(peak_n)},
              {"rms_n", list(once.rowwise().squaredNorm().cwiseSqrt() / std::sqrt(360.0))},
              {"torque_n_m", turn.mean_torque_n_m()},
              {"peak_torque_n_m", turn.torque_n_m.maxCoeff()},
              {"power_w", turn.power_w()},
              {"chip_area_mm2", chip_area_m2 / (units::mm * units::mm)},
              {"removal_rate_mm3_per_s", chip_area_m2 * feed_m_per_s / units::mm3},
              {"deflection_um", list(turn.deflection_um())},
              {"peak_deflection_um", 3.1 * turn.deflection_um().norm()},
              {"vibration",
               {{"verdict", "stable"},
                {"chatter_frequency_hz", nullptr},
                {"chatter_amplitude_um", 0.0},
                {"spectral_radius", 0.62},
                {"missed_share", 0.0},
                {"error_estimate", 1e-4}}},
              {"engagement", engagement_json()},
              {"rotation_deg", list(turn.rotation_deg)},
              {"torque_by_rotation_n_m", list(turn.torque_n_m)}};
  const std::string names[] = {"fx_n", "fy_n", "fz_n"};
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    out[names[axis]] = list(turn.force_n.row(axis));
    out["vibrating_" + names[axis]] = list(1.02 * turn.force_n.row(axis));
  }
  return out;
}

/// Rapids at the start and the end of the spiral, one retract half-way.
bool in_air(int i, int n) {
  return i < 3 || i == n - 1 || (i >= n / 2 && i <= n / 2 + 12);
}

/// Where block i of a spiral over a dome ends [mm].
Eigen::Vector3d tip_of(int i, int n) {
  if (i < 2) return {45.0, 0.0, i == 0 ? 30.0 : 8.0};
  if (i == n - 1) return {0.0, 0.0, 40.0};
  const double share = static_cast<double>(i - 2) / static_cast<double>(n - 4);
  const double away = 38.0 * (1.0 - share) + 2.0;
  const double turned = 24.0 * pi * share;
  const double lift = i >= n / 2 && i < n / 2 + 12 ? 12.0 : 0.0;
  return {away * std::cos(turned), 0.7 * away * std::sin(turned), 18.0 * (1.0 - std::pow(away / 40.0, 2)) + lift};
}

Json blocks_json(const Turn& turn) {
  constexpr int n = 800;
  const double peak_n = turn.force_n.colwise().norm().maxCoeff();
  Json blocks = Json::array();
  Eigen::Vector3d tip_mm(45.0, 0.0, 60.0);
  double path_mm = 0.0;
  double time_s = 0.0;
  for (int i = 0; i < n; ++i) {
    const double step_mm = (tip_of(i, n) - tip_mm).norm();
    tip_mm = tip_of(i, n);
    const bool air = in_air(i, n);
    const double corner = std::exp(-std::pow((i - 523.0) / 4.0, 2));
    const double load = air ? 0.0 : 1.0 + 0.35 * std::sin(0.031 * i) + 0.12 * std::sin(0.9 * i) + 1.4 * corner;
    path_mm += step_mm;
    time_s += step_mm / (air ? 100.0 : 12.0);
    blocks.push_back({{"block", i + 1},
                      {"line", i + 12},
                      {"x_mm", tip_mm.x()},
                      {"y_mm", tip_mm.y()},
                      {"z_mm", tip_mm.z()},
                      {"axial_depth_mm", air ? 0.0 : depth_m / units::mm * (1.0 + 0.2 * std::sin(0.031 * i))},
                      {"radial_depth_mm", stepover_m / units::mm * load},
                      {"mean_fx_n", load * turn.mean_n().x()},
                      {"mean_fy_n", load * turn.mean_n().y()},
                      {"mean_fz_n", load * turn.mean_n().z()},
                      {"peak_f_n", load * peak_n},
                      {"revolution_torque_n_m", load * turn.mean_torque_n_m()},
                      {"peak_torque_n_m", load * turn.torque_n_m.maxCoeff()},
                      {"sustained_power_w", load * turn.power_w()},
                      {"peak_deflection_um", load * turn.deflection_um().norm() * (1.0 + 0.3 * std::cos(0.01 * i))},
                      {"cuts", !air},
                      {"path_mm", path_mm},
                      {"time_s", time_s}});
  }
  return blocks;
}

Json program_json(const Turn& turn) {
  Json blocks = blocks_json(turn);
  const auto higher = [](const char* column) {
    return [column](const Json& a, const Json& b) { return a[column] > b[column]; };
  };
  auto worst = blocks.get<std::vector<Json>>();
  std::ranges::stable_sort(worst, higher("peak_f_n"));
  worst.resize(10);
  for (Json& block : worst) {
    for (const char* column :
         {"torque_n_m", "power_w", "peak_power_w", "cutting_time_s", "feed_per_tooth_mm", "removed_mm3"})
      block[column] = 0.1;
    for (const char* column :
         {"deflection_um", "deflection_x_um", "deflection_y_um", "deflection_z_um", "condition_number"})
      block[column] = nullptr;
  }
  Json highest = Json::object();
  for (const char* column :
       {"peak_f_n", "revolution_torque_n_m", "peak_torque_n_m", "sustained_power_w", "peak_deflection_um"}) {
    const Json& most = *std::ranges::min_element(blocks, higher(column));
    highest[column] = {{"value", most[column]}, {"block", most["block"]}, {"line", most["line"]}};
  }
  const auto cutting = std::ranges::count_if(blocks, [](const Json& block) { return block["cuts"].get<bool>(); });
  return {{"cutting_blocks", cutting},
          {"power_time_s", 0.1},
          {"torque_limit_n_m", 1.9 * turn.mean_torque_n_m()},
          {"power_limit_w", 3.2 * turn.power_w()},
          {"highest", std::move(highest)},
          {"worst", worst},
          {"blocks", std::move(blocks)}};
}

Json sweep_json() {
  Json rotation = Json::array();
  Json deflection = Json::array();
  Json along_normal = Json::array();
  Json limit_distance = Json::array();
  Json condition = Json::array();
  double best_deg = 0.0;
  double best_um = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 73; ++i) {
    const double gamma = (5.0 * i - 180.0) * units::deg;
    const bool reachable = gamma > -1.9 && gamma < 2.3;
    const double bent_um = 38.0 - 9.0 * std::cos(2.0 * gamma - 0.8) - 5.0 * std::sin(gamma);
    rotation.push_back(gamma / units::deg);
    deflection.push_back(reachable ? Json(bent_um) : Json());
    along_normal.push_back(reachable ? Json(0.7 * bent_um) : Json());
    limit_distance.push_back(reachable ? Json(40.0) : Json());
    condition.push_back(reachable ? Json(8.0 + 30.0 * std::pow(std::sin(0.7 * gamma + 0.2), 4)) : Json());
    if (!reachable || bent_um >= best_um) continue;
    best_um = bent_um;
    best_deg = gamma / units::deg;
  }
  return {{"rotation_deg", std::move(rotation)},
          {"deflection_um", std::move(deflection)},
          {"along_normal_um", std::move(along_normal)},
          {"limit_distance_deg", std::move(limit_distance)},
          {"condition_number", std::move(condition)},
          {"best_deg", best_deg},
          {"best_deflection_um", best_um},
          {"used_deg", 0.0}};
}

}  // namespace

std::string sample_forces(const std::string& text) {
  const auto named = [&](const char* own) { return text.empty() ? std::string(own) : text; };
  const auto fact = [&](const char* label, const char* value) -> Json {
    return {{"label", named(label)}, {"value", named(value)}};
  };
  const Turn turn;
  Json out = {{"document", "forces/1"}, {"force_on", "tool"}};
  out.update(revolution_json(turn));
  out["spindle_rotation"] = sweep_json();
  out.update(program_json(turn));
  out["facts"] = Json::array({fact("Cutter", "ball end, 6 mm, 2 teeth, 30°"),
                              fact("Cut", "1 mm deep, 0.5 mm beside the last pass, up"),
                              fact("Feed", "0.02 mm per tooth at 18 000 rpm")});
  out["warnings"] =
      Json::array({named("The radial coefficient is an assumption: it was not measured on this material.")});
  out["assumed"] = Json::array();
  out["notes"] = Json::array({named("Forces of this sample come from a formula without runout.")});
  return out.dump();
}

}  // namespace robomill::page
