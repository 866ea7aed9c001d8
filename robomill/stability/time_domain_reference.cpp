#include "robomill/stability/time_domain_reference.hpp"

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

/// Force on the tool in the fixed axes, tooth by tooth and slice by slice.
Eigen::Vector2d cutting_force(const LobesProblem& problem, const OperatingPoint& point, int slices, double time,
                              const Eigen::Vector2d& q, const History& history) {
  const cutting::FlatEndMill& tool = problem.milling.tool;
  const cutting::ForceCoefficients& k = problem.milling.coefficients;
  const double c = std::cos(problem.feed_direction_rad), s = std::sin(problem.feed_direction_rad);
  const Eigen::Vector2d feed(c, s), side(-s, c);
  const double thickness = point.axial_depth_m / slices;
  Eigen::Vector2d force = Eigen::Vector2d::Zero();
  double standing = 0.0;
  for (int j = 0; j < tool.teeth; ++j) {
    const double pitch = tool.pitch_rad.empty() ? revolution / tool.teeth : tool.pitch_rad[static_cast<std::size_t>(j)];
    Eigen::Vector2d change = Eigen::Vector2d::Zero();
    bool looked = false;
    for (int i = 0; i < slices; ++i) {
      double angle = point.spindle_speed_rad_per_s * time + standing -
                     2.0 * std::tan(tool.helix_rad) / tool.diameter_m * thickness * (i + 0.5);
      angle -= revolution * std::floor(angle / revolution);
      if (angle < problem.milling.immersion.entry_rad || angle > problem.milling.immersion.exit_rad) continue;
      if (!looked) change = q - history.at(time - pitch / point.spindle_speed_rad_per_s);
      looked = true;
      const Eigen::Vector2d radius = std::sin(angle) * feed + std::cos(angle) * side;
      const Eigen::Vector2d path = std::cos(angle) * feed - std::sin(angle) * side;
      const double chip = change.dot(radius);
      force -= (k.tangential_n_per_m2 * path + k.radial_n_per_m2 * radius) * (thickness * chip);
    }
    standing += pitch;
  }
  return force;
}

}  // namespace

double time_domain_radius(const LobesProblem& problem, const OperatingPoint& point, int steps, int periods,
                          int slices) {
  const Structure structure(problem.dynamics);
  const cutting::FlatEndMill& tool = problem.milling.tool;
  const bool equal = tool.has_equal_pitch();
  const int period = equal ? steps : steps * tool.teeth;
  const double h = revolution / tool.teeth / point.spindle_speed_rad_per_s / steps;
  History history;
  history.step = h;
  Random random(7);
  Eigen::VectorXcd z(static_cast<Eigen::Index>(structure.pole.size()));
  for (Eigen::Index k = 0; k < z.size(); ++k) z(k) = {1e-3 * random.normal(), 1e-3 * random.normal()};
  const auto slope = [&](double time, const Eigen::VectorXcd& state) {
    const Eigen::Vector2d q = structure.displacement(state);
    return structure.slope(state, cutting_force(problem, point, slices, time, q, history));
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
