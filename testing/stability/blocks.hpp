#pragma once
#include "robomill/base/random.hpp"
#include "robomill/stability/spatial.hpp"
#include "testing/stability/problems.hpp"
#include "testing/stability/spatial_cases.hpp"

/// Blocks of programs on a robot, that tests and benchmarks share.
namespace robomill::stability::testing {

/// Half of the modes are the arm's (10 to 80 Hz), half those of spindle, holder and tool (300 to 2,500 Hz), in
/// directions of their own; they know deviations of 1 % of frequency, 10 % of damping and 8 % of residue.
inline modal::ModalModel robot_like_modes(Random& random, int count) {
  std::vector<RealMode> modes;
  for (int k = 0; k < count; ++k) {
    const Eigen::Vector3d direction = Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized();
    if (k < count / 2) {
      modes.push_back({random.uniform(10.0, 80.0), random.uniform(0.02, 0.06), random.uniform(50.0, 400.0), direction});
    } else {
      modes.push_back({random.uniform(300.0, 2500.0), random.uniform(0.01, 0.05), random.uniform(0.2, 2.0), direction});
    }
  }
  modal::ModalModel model = spatial_model(modes);
  for (modal::Mode& mode : model.modes) {
    mode.frequency_std_hz = 0.01 * mode.frequency_hz;
    mode.damping_ratio_std = 0.1 * mode.damping_ratio;
    mode.residue_std_ratio = 0.08;
  }
  return model;
}

struct BlockCase {
  LobesProblem problem;
  double spindle_speed_rad_per_s = 0.0, depth_m = 0.0;
};

/// A ball or a flat end of 10 mm with a given engagement.
inline BlockCase block_case(Random& random, int modes) {
  BlockCase block;
  block.problem = spatial_references()[random.index(5)].problem;
  SpatialMilling& milling = *block.problem.spatial;
  milling.cutter.mill.diameter_m = 10e-3;
  milling.cut.axial_depth_m = random.uniform(0.2e-3, 1.5e-3);
  if (milling.cut.direction != cutting::MillingDirection::slot) {
    milling.cut.radial_depth_m = random.uniform(0.5e-3, 3e-3);
  }
  milling.engagement = cutting::engage(milling.cutter, milling.cut, {.slices = 40});
  block.problem.dynamics = robot_like_modes(random, modes);
  block.spindle_speed_rad_per_s = random.uniform(6000.0, 18000.0) * rpm;
  block.depth_m = engaged_height_m(*milling.engagement);
  return block;
}

}  // namespace robomill::stability::testing
