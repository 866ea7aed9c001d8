#pragma once
#include <Eigen/Core>
#include <vector>

#include "robomill/cutting/cutter.hpp"
#include "robomill/cutting/force.hpp"
#include "robomill/program/program.hpp"

/// A wall cut tooth by tooth with a tool that deflects: the judge of what is predicted of walls. It shares nothing with
/// stability/ but the signs of docs/frames.md.
namespace robomill::cutting::testing {

/// One way in which the tool's tip swings: m ẍ + c ẋ + k dz(x) = d·F, with the tip displaced by d x. dz(x) is x without
/// the play: 0 up to half the backlash, x ∓ backlash / 2 beyond.
struct Swing {
  double frequency_hz = 0.0, damping_ratio = 0.0, stiffness_n_per_m = 0.0;
  Eigen::Vector3d direction = Eigen::Vector3d::UnitY();  ///< d, unit, in W
  double backlash_m = 0.0;
};

/// An upright cylindrical cutter runs along +x of W beside a wall. The wall's normal, out of the cutter, is ±y.
struct WallCut {
  Cutter cutter;                     ///< a flat end; its teeth may differ
  MillingCoefficients coefficients;  ///< the last (constant) entry of each counts; edge forces per width
  double spindle_speed_rad_per_s = 0.0;
  double side = 1.0;       ///< +1: the wall stands at +y of the path (up-milling), -1: at -y (down-milling)
  double wall_y_m = 0.0;   ///< where it is asked for
  double stock_y_m = 0.0;  ///< where the material begins
  double from_x_m = 0.0, to_x_m = 0.0, bottom_m = 0.0, top_m = 0.0;  ///< of the material
  std::vector<Swing> structure = {};
  int slices = 24;  ///< of the height
  int steps_per_revolution = 1440;
  double ray_m = 5e-6;    ///< from ray to ray, along x
  double bin_m = 0.2e-3;  ///< of the result along x: at least the feed per tooth
};

/// The wall that is left: of each bin the deepest ray, so that the ridges between two teeth do not count.
struct Wall {
  Eigen::VectorXd x_m, z_m;                                ///< middles
  Eigen::MatrixXd error_m;                                 ///< z by x: material left standing, > 0
  Eigen::Vector3d mean_force_n = Eigen::Vector3d::Zero();  ///< while the tip is between the ends of the window
  struct Summary {
    double mean_m = 0.0, rms_m = 0.0, worst_m = 0.0;  ///< worst: of greatest magnitude, with its sign
  };
  /// Over a window along x.
  [[nodiscard]] Summary between(double from_x_m, double to_x_m) const;
};

/// Runs the program's feed moves through the material; rapid moves are jumps. Rays along y, one line of them a slice;
/// edges pass them as points of their slice that move with the tip, its displacement and the rotation. What a tooth
/// takes from the rays in a step, over its way, is its chip, and that makes the force under which the tool moves on.
/// @param window_x_m  over which the force is averaged
[[nodiscard]] Wall cut_wall(const program::Program& program, const WallCut& cut, const Eigen::Vector2d& window_x_m);

}  // namespace robomill::cutting::testing
