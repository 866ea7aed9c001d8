#include "testing/stability/time_domain_reference.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <complex>
#include <numbers>

#include "robomill/base/random.hpp"

namespace robomill::stability::testing {
namespace {

constexpr double revolution = 2.0 * std::numbers::pi;

/// The structure in its own axes: what a modal model says, without projection or scaling.
struct Structure {
  std::vector<std::complex<double>> pole;
  std::vector<Eigen::Vector2cd> left, right;

  explicit Structure(const modal::ModalModel& model) {
    for (const modal::Mode& mode : model.modes) {
      pole.push_back(modal::pole(mode));
      left.emplace_back(mode.left);
      right.emplace_back(mode.right);
    }
  }
  Eigen::Vector2d displacement(const Eigen::VectorXcd& z) const {
    Eigen::Vector2d q = Eigen::Vector2d::Zero();
    for (std::size_t k = 0; k < pole.size(); ++k) q += 2.0 * (right[k] * z(static_cast<Eigen::Index>(k))).real();
    return q;
  }
  Eigen::VectorXcd slope(const Eigen::VectorXcd& z, const Eigen::Vector2d& force) const {
    Eigen::VectorXcd dz(z.size());
    for (std::size_t k = 0; k < pole.size(); ++k) {
      const Eigen::Index i = static_cast<Eigen::Index>(k);
      dz(i) = pole[k] * z(i) + left[k](0) * force(0) + left[k](1) * force(1);
    }
    return dz;
  }
};

/// Displacements and their slopes at all past steps; zero before the start.
struct History {
  double step = 0.0;
  std::vector<Eigen::Vector2d> value, slope;

  Eigen::Vector2d at(double time) const {
    const double where = time / step;
    const double index = std::floor(where);
    if (index < 0.0) return Eigen::Vector2d::Zero();
    const std::size_t i = std::min(static_cast<std::size_t>(index), value.size() - 2);
    const double s = where - static_cast<double>(i);
    return (1.0 + 2.0 * s) * (1.0 - s) * (1.0 - s) * value[i] + s * (1.0 - s) * (1.0 - s) * step * slope[i] +
           s * s * (3.0 - 2.0 * s) * value[i + 1] + s * s * (s - 1.0) * step * slope[i + 1];
  }
};

/// How far the spindle has turned, by the varied speed's integral.
double turned(const LobesProblem& problem, double mean_speed, double time) {
  const cutting::SpeedVariation& v = problem.milling.speed_variation;
  if (v.amplitude_ratio == 0.0) return mean_speed * time;
  const double swing = v.frequency_ratio * mean_speed;
  return mean_speed * (time + v.amplitude_ratio / swing * (1.0 - std::cos(swing * time)));
}

/// When it had turned by less.
double time_before(const LobesProblem& problem, double mean_speed, double time, double less) {
  if (problem.milling.speed_variation.amplitude_ratio == 0.0) return time - less / mean_speed;
  const double wanted = turned(problem, mean_speed, time) - less;
  double early = time - 20.0 * less / mean_speed, late = time;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (early + late);
    (turned(problem, mean_speed, middle) < wanted ? early : late) = middle;
  }
  return 0.5 * (early + late);
}

/// The rotation since the surface under tooth j at height z was left, by trying every tooth before it; negative where
/// there is no chip.
double rotation_since(const LobesProblem& problem, int j, double z, double angle) {
  const cutting::FlatEndMill& tool = problem.milling.tool;
  const auto helix = [&](int k) {
    return tool.tooth_helix_rad.empty() ? tool.helix_rad : tool.tooth_helix_rad[static_cast<std::size_t>(k)];
  };
  const auto pitch = [&](int k) {
    return tool.pitch_rad.empty() ? revolution / tool.teeth : tool.pitch_rad[static_cast<std::size_t>(k)];
  };
  const auto stands = [&](int k) {
    double at = -2.0 * std::tan(helix(k)) / tool.diameter_m * z;
    for (int i = 0; i < k; ++i) at += pitch(i);
    return at;
  };
  const auto radius = [&](int k) { return tool.runout_m * std::cos(stands(k) - tool.runout_angle_rad); };
  double thinnest = 1e9, since = -1.0;
  for (int m = 1; m <= tool.teeth; ++m) {
    const int other = (j + m) % tool.teeth;
    double delay = stands(other) - stands(j);
    while (delay <= 0.0) delay += revolution;
    const double chip = radius(j) - radius(other) +
                        problem.milling.feed_per_tooth_m * tool.teeth * delay / revolution * std::sin(angle);
    if (chip < thinnest - 1e-15 || (chip < thinnest + 1e-15 && delay < since)) {
      thinnest = chip;
      since = delay;
    }
  }
  return tool.runout_m > 0.0 && thinnest <= 0.0 ? -1.0 : since;
}

/// Force on the tool in the fixed axes, tooth by tooth and slice by slice.
Eigen::Vector2d cutting_force(const LobesProblem& problem, const OperatingPoint& point, int slices, double time,
                              const Eigen::Vector2d& q, const Eigen::Vector2d& velocity, const History& history) {
  const cutting::FlatEndMill& tool = problem.milling.tool;
  const cutting::ForceCoefficients& k = problem.milling.coefficients;
  const cutting::ProcessDamping& damping = problem.milling.process_damping;
  const double c = std::cos(problem.feed_direction_rad), s = std::sin(problem.feed_direction_rad);
  const Eigen::Vector2d feed(c, s), side(-s, c);
  const double thickness = point.axial_depth_m / slices;
  Eigen::Vector2d force = Eigen::Vector2d::Zero();
  double standing = 0.0;
  for (int j = 0; j < tool.teeth; ++j) {
    const double pitch = tool.pitch_rad.empty() ? revolution / tool.teeth : tool.pitch_rad[static_cast<std::size_t>(j)];
    const double helix =
        tool.tooth_helix_rad.empty() ? tool.helix_rad : tool.tooth_helix_rad[static_cast<std::size_t>(j)];
    double looked = -1.0;
    Eigen::Vector2d change = Eigen::Vector2d::Zero();
    for (int i = 0; i < slices; ++i) {
      const double z = thickness * (i + 0.5);
      double angle =
          turned(problem, point.spindle_speed_rad_per_s, time) + standing - 2.0 * std::tan(helix) / tool.diameter_m * z;
      angle -= revolution * std::floor(angle / revolution);
      if (angle < problem.milling.immersion.entry_rad || angle > problem.milling.immersion.exit_rad) continue;
      const double since = rotation_since(problem, j, z, angle);
      if (since < 0.0) continue;
      if (since != looked) change = q - history.at(time_before(problem, point.spindle_speed_rad_per_s, time, since));
      looked = since;
      const Eigen::Vector2d radius = std::sin(angle) * feed + std::cos(angle) * side;
      const Eigen::Vector2d path = std::cos(angle) * feed - std::sin(angle) * side;
      const double chip = change.dot(radius);
      force -= (k.tangential_n_per_m2 * path + k.radial_n_per_m2 * radius) * (thickness * chip);
      const double surface_speed = 0.5 * tool.diameter_m * point.spindle_speed_rad_per_s;
      const double pressed = 0.5 * damping.indentation_n_per_m3 * damping.wear_land_m * damping.wear_land_m *
                             thickness * velocity.dot(radius) / surface_speed;
      force -= pressed * (radius + damping.friction * path);
    }
    standing += pitch;
  }
  return force;
}

}  // namespace

double time_domain_radius(const LobesProblem& problem, const OperatingPoint& point, int steps, int periods, int slices,
                          int teeth_a_period) {
  const Structure structure(problem.dynamics);
  const cutting::FlatEndMill& tool = problem.milling.tool;
  const int period = steps * (teeth_a_period > 0 ? teeth_a_period : tool.has_equal_pitch() ? 1 : tool.teeth);
  const double h = revolution / tool.teeth / point.spindle_speed_rad_per_s / steps;
  History history;
  history.step = h;
  Random random(7);
  Eigen::VectorXcd z(static_cast<Eigen::Index>(structure.pole.size()));
  for (Eigen::Index k = 0; k < z.size(); ++k) z(k) = {1e-3 * random.normal(), 1e-3 * random.normal()};
  const auto slope = [&](double time, const Eigen::VectorXcd& state) {
    const Eigen::Vector2d q = structure.displacement(state);
    const Eigen::Vector2d velocity = structure.displacement(structure.slope(state, Eigen::Vector2d::Zero()));
    return structure.slope(state, cutting_force(problem, point, slices, time, q, velocity, history));
  };
  for (int i = 0; i <= period * periods; ++i) {
    const double t = i * h;
    history.value.push_back(structure.displacement(z));
    history.slope.push_back(structure.displacement(slope(t + 1e-9 * h, z)));
    // Inside the step, so that a tooth that enters or leaves on a step's end belongs to one side only.
    const Eigen::VectorXcd a = slope(t + 1e-9 * h, z);
    const Eigen::VectorXcd b = slope(t + 0.5 * h, z + 0.5 * h * a);
    const Eigen::VectorXcd c = slope(t + 0.5 * h, z + 0.5 * h * b);
    const Eigen::VectorXcd d = slope(t + h - 1e-9 * h, z + h * c);
    z += h / 6.0 * (a + 2.0 * b + 2.0 * c + d);
  }
  // q_{n+2} = p q_{n+1} + r q_n holds for one pair of multipliers, |μ|² = -r; the samples of the last two periods fit
  // p, r.
  const std::size_t n = static_cast<std::size_t>(period);
  const std::size_t end = history.value.size();
  Eigen::MatrixXd before(2 * static_cast<Eigen::Index>(n), 2);
  Eigen::VectorXd after(before.rows());
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Index row = 2 * static_cast<Eigen::Index>(i);
    before.block<2, 1>(row, 0) = history.value[end - 2 * n + i];
    before.block<2, 1>(row, 1) = history.value[end - 3 * n + i];
    after.segment<2>(row) = history.value[end - n + i];
  }
  const Eigen::Vector2d fit = before.colPivHouseholderQr().solve(after);
  const double discriminant = 0.25 * fit(0) * fit(0) + fit(1);
  if (discriminant < 0.0) return std::sqrt(-fit(1));
  return std::abs(0.5 * fit(0)) + std::sqrt(discriminant);
}

}  // namespace robomill::stability::testing
