#include "robomill/report/forces_sample.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "robomill/base/units.hpp"

namespace robomill::report {
namespace {

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

ForceRevolution sample_revolution() {
  constexpr Eigen::Index n = 361;
  ForceRevolution turn;
  turn.rotation_rad = Eigen::VectorXd::LinSpaced(n, 0.0, 2.0 * pi);
  turn.force_n.resize(3, n);
  turn.torque_n_m.resize(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Load load = load_at(turn.rotation_rad[i]);
    turn.force_n.col(i) = load.force_n;
    turn.torque_n_m[i] = load.torque_n_m;
  }
  turn.mean_n = turn.force_n.leftCols(n - 1).rowwise().mean();
  turn.rms_n = turn.force_n.leftCols(n - 1).rowwise().squaredNorm().cwiseSqrt() / std::sqrt(static_cast<double>(n - 1));
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    Eigen::Index at = 0;
    turn.force_n.row(axis).cwiseAbs().maxCoeff(&at);
    turn.peak_n[axis] = turn.force_n(axis, at);
  }
  turn.mean_torque_n_m = turn.torque_n_m.head(n - 1).mean();
  turn.peak_torque_n_m = turn.torque_n_m.maxCoeff();
  turn.power_w = turn.mean_torque_n_m * speed_rad_per_s;
  turn.chip_area_m2 = depth_m * stepover_m;
  turn.removal_rate_m3_per_s = turn.chip_area_m2 * feed_per_tooth_m * teeth * speed_rad_per_s / (2.0 * pi);
  turn.deflection_m = turn.mean_n.cwiseProduct(Eigen::Vector3d(1.9, 2.4, 0.6)) * units::um;
  turn.peak_deflection_m = 3.1 * turn.deflection_m.norm();
  turn.verdict = "The cut is stable.";
  turn.vibrating = true;
  for (int ring = 0; ring < shown_rings; ++ring) {
    const double position_rad = position_of(ring, shown_rings);
    EngagementRing found;
    found.height_m = radius_m * (1.0 - std::cos(position_rad));
    found.position_rad = position_rad;
    found.arcs = {{0.0, exit_of(position_rad)}};
    turn.engagement.push_back(found);
  }
  return turn;
}

/// Rapids at the start and the end of the spiral, one retract half-way.
bool in_air(Eigen::Index i, Eigen::Index n) {
  return i < 3 || i == n - 1 || (i >= n / 2 && i <= n / 2 + 12);
}

/// Where block i of a spiral over a dome ends.
Eigen::Vector3d tip_of(Eigen::Index i, Eigen::Index n) {
  if (i < 2) return {45.0, 0.0, i == 0 ? 30.0 : 8.0};
  if (i == n - 1) return {0.0, 0.0, 40.0};
  const double share = static_cast<double>(i - 2) / static_cast<double>(n - 4);
  const double away = 38.0 * (1.0 - share) + 2.0;
  const double turned = 24.0 * pi * share;
  const double lift = i >= n / 2 && i < n / 2 + 12 ? 12.0 : 0.0;
  return {away * std::cos(turned), 0.7 * away * std::sin(turned), 18.0 * (1.0 - std::pow(away / 40.0, 2)) + lift};
}

ForcePath sample_path(const ForceRevolution& turn) {
  constexpr Eigen::Index n = 800;
  ForcePath path;
  path.block = Eigen::VectorXd::LinSpaced(n, 1.0, static_cast<double>(n));
  path.line = path.block.array() + 11.0;
  path.tip_m.resize(3, n);
  path.mean_force_n.resize(3, n);
  for (Eigen::VectorXd* values :
       {&path.path_m, &path.time_s, &path.axial_depth_m, &path.radial_depth_m, &path.peak_force_n, &path.torque_n_m,
        &path.peak_torque_n_m, &path.power_w, &path.deflection_m}) {
    values->resize(n);
  }
  const double peak_n = turn.force_n.colwise().norm().maxCoeff();
  for (Eigen::Index i = 0; i < n; ++i) {
    path.tip_m.col(i) = tip_of(i, n) * units::mm;
    const double step_m = i > 0 ? (path.tip_m.col(i) - path.tip_m.col(i - 1)).norm() : 30.0 * units::mm;
    const bool air = in_air(i, n);
    const double at = static_cast<double>(i);
    const double corner = std::exp(-std::pow((at - 523.0) / 4.0, 2));
    const double load = air ? 0.0 : 1.0 + 0.35 * std::sin(0.031 * at) + 0.12 * std::sin(0.9 * at) + 1.4 * corner;
    path.path_m[i] = (i > 0 ? path.path_m[i - 1] : 0.0) + step_m;
    path.time_s[i] = (i > 0 ? path.time_s[i - 1] : 0.0) + step_m / (air ? 0.1 : 0.012);
    path.axial_depth_m[i] = air ? missing : depth_m * (1.0 + 0.2 * std::sin(0.031 * at));
    path.radial_depth_m[i] = air ? missing : stepover_m * load;
    path.peak_force_n[i] = load * peak_n;
    path.mean_force_n.col(i) = load * turn.mean_n;
    path.torque_n_m[i] = load * turn.mean_torque_n_m;
    path.peak_torque_n_m[i] = load * turn.peak_torque_n_m;
    path.power_w[i] = load * turn.power_w;
    path.deflection_m[i] = load * turn.deflection_m.norm() * (1.0 + 0.3 * std::cos(0.01 * at));
    path.cuts.push_back(!air);
  }
  path.troubles = {"part.ngc:412: the robot cannot reach this block"};
  path.torque_limit_n_m = 1.9 * turn.mean_torque_n_m;
  path.power_limit_w = 3.2 * turn.power_w;
  return path;
}

RedundancySweep sample_sweep() {
  constexpr Eigen::Index n = 73;
  RedundancySweep sweep;
  sweep.rotation_rad = Eigen::VectorXd::LinSpaced(n, -pi, pi);
  sweep.deflection_m.resize(n);
  sweep.condition_number.resize(n);
  double best_m = std::numeric_limits<double>::infinity();
  for (Eigen::Index i = 0; i < n; ++i) {
    const double gamma = sweep.rotation_rad[i];
    const bool reachable = gamma > -1.9 && gamma < 2.3;
    sweep.deflection_m[i] =
        reachable ? (38.0 - 9.0 * std::cos(2.0 * gamma - 0.8) - 5.0 * std::sin(gamma)) * units::um : missing;
    sweep.condition_number[i] = reachable ? 8.0 + 30.0 * std::pow(std::sin(0.7 * gamma + 0.2), 4) : missing;
    if (!(sweep.deflection_m[i] < best_m)) continue;
    best_m = sweep.deflection_m[i];
    sweep.best_rad = gamma;
  }
  sweep.used_rad = 0.0;
  return sweep;
}

}  // namespace

Forces sample_forces() {
  Forces forces;
  forces.facts = {{"Cutter", "ball end, 6 mm, 2 teeth, 30°"},
                  {"Cut", "1 mm deep, 0.5 mm beside the last pass, up"},
                  {"Feed", "0.02 mm per tooth at 18 000 rpm"}};
  forces.warnings = {"The radial coefficient is an assumption: it was not measured on this material."};
  forces.notes = {"Forces of this sample come from a formula without runout."};
  forces.revolution = sample_revolution();
  forces.path = sample_path(*forces.revolution);
  forces.spindle_rotation = sample_sweep();
  return forces;
}

}  // namespace robomill::report
