#pragma once
#include <Eigen/Core>
#include <numbers>
#include <vector>

#include "robomill/stability/lobes.hpp"

/// Cuts in three directions that tests and benchmarks share.
namespace robomill::stability::testing {

/// A real mode along d: L = d, R = -i d / (2 m ω_d).
struct RealMode {
  double frequency_hz, damping_ratio, modal_mass_kg;
  Eigen::Vector3d direction;
};

inline modal::ModalModel spatial_model(const std::vector<RealMode>& modes) {
  modal::ModalModel model;
  model.excitations = model.responses = {{.axis = modal::Axis::x}, {.axis = modal::Axis::y}, {.axis = modal::Axis::z}};
  for (const RealMode& real : modes) {
    modal::Mode mode;
    mode.frequency_hz = real.frequency_hz;
    mode.damping_ratio = real.damping_ratio;
    mode.left = real.direction.cast<std::complex<double>>();
    mode.right = real.direction * std::complex<double>(0.0, -0.5 / (real.modal_mass_kg * modal::pole(mode).imag()));
    model.modes.push_back(mode);
  }
  return model;
}

/// x 850 Hz 3 %, y 900 Hz 3 %, z 2,200 Hz 2 %, of these modal masses [kg].
inline modal::ModalModel xyz(double x_kg, double y_kg, double z_kg) {
  return spatial_model({{850.0, 0.03, x_kg, Eigen::Vector3d::UnitX()},
                        {900.0, 0.03, y_kg, Eigen::Vector3d::UnitY()},
                        {2200.0, 0.02, z_kg, Eigen::Vector3d::UnitZ()}});
}

/// Lengths in mm, coefficients in N/mm², angles in degrees.
struct CutInShopUnits {
  double axial_depth, stepover;
  cutting::MillingDirection direction;
  double lead, tilt;
};

inline LobesProblem spatial_problem(cutting::CutterKind kind, double diameter_mm, int teeth, const CutInShopUnits& cut,
                                    const Eigen::Vector3d& coefficients, const modal::ModalModel& dynamics) {
  constexpr double degree = std::numbers::pi / 180.0;
  SpatialMilling milling;
  milling.cutter.kind = kind;
  milling.cutter.mill = {.teeth = teeth, .diameter_m = 1e-3 * diameter_mm, .helix_rad = 30.0 * degree};
  milling.cut.axial_depth_m = 1e-3 * cut.axial_depth;
  milling.cut.radial_depth_m = 1e-3 * cut.stepover;
  milling.cut.direction = cut.direction;
  milling.cut.lead_rad = cut.lead * degree;
  milling.cut.tilt_rad = cut.tilt * degree;
  milling.coefficients.tangential_n_per_m2 = {1e6 * coefficients.x()};
  milling.coefficients.radial_n_per_m2 = {1e6 * coefficients.y()};
  milling.coefficients.axial_n_per_m2 = {1e6 * coefficients.z()};
  LobesProblem problem;
  problem.spatial = milling;
  problem.dynamics = dynamics;
  return problem;
}

/// A radius at a point, and the lowest unstable depth at a speed; 0: not known.
struct SpatialReference {
  LobesProblem problem;
  double speed_rpm, depth_mm, spectral_radius;
  double limit_speed_rpm, limit_mm, chatter_frequency_hz;
};

/// Of an independent converged solver: radii to 1e-9, limits to 1e-7 mm.
inline std::vector<SpatialReference> spatial_references() {
  using Kind = cutting::CutterKind;
  using Direction = cutting::MillingDirection;
  const modal::ModalModel light = spatial_model({{850.0, 0.02, 0.06, Eigen::Vector3d::UnitX()},
                                                 {900.0, 0.04, 0.06, Eigen::Vector3d::UnitY()},
                                                 {2200.0, 0.03, 0.06, Eigen::Vector3d::UnitZ()}});
  const modal::ModalModel oblique = spatial_model({{1200.0, 0.03, 0.06, Eigen::Vector3d::Ones().normalized()}});
  return {
      {spatial_problem(Kind::ball_end, 6, 2, {0.3, 6, Direction::slot, 0, 0}, {1500, 600, 300}, xyz(.12, .12, .1)),
       12000, 0.3, 0.977148949, 12000, 0.3295839, 2271.2},
      {spatial_problem(Kind::ball_end, 6, 2, {0.6, 0.8, Direction::up, -10, 15}, {1500, 900, 300}, light), 20000, 0.6,
       1.287170672, 12000, 0.1651169, 0},
      {spatial_problem(Kind::ball_end, 10, 4, {0.8, 2, Direction::down, 0, 0}, {1000, 300, 200}, xyz(.15, .15, .15)),
       10000, 0.8, 1.157413297, 10000, 0.3746887, 0},
      {spatial_problem(Kind::ball_end, 6, 2, {0.15, 6, Direction::slot, 15, 0}, {1500, 600, 300}, oblique), 13500, 0.15,
       1.034890084, 16000, 0.6248149, 0},
      {spatial_problem(Kind::flat_end, 10, 4, {0.4, 3, Direction::up, 10, 5}, {1000, 400, 200}, xyz(.2, .2, .2)), 8000,
       0.4, 0.760276662, 8000, 0.9932483, 0}};
}

}  // namespace robomill::stability::testing
