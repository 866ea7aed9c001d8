#pragma once
// Seeded random five-axis programs: blocks of 0.05 to 50 mm, corners of any angle, reversals, pure rotations, moves
// that do not move, dwells and rapids, in a box around the origin with the axis within a cone about z.
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "robomill/base/random.hpp"
#include "robomill/program/program.hpp"

namespace robomill::path::test {

struct MixedProgram {
  int least_blocks = 10, most_blocks = 300;
  double half_box_m = 0.04;
  double cone_rad = 0.35;
  double feed_m_per_s = 0.05;  ///< the largest; blocks have 0.2 to 1 of it
};

inline program::Program mixed_program(Random& random, const MixedProgram& options) {
  program::Program program;
  const auto axis_near = [&](const Eigen::Vector3d& from, double most) {
    for (;;) {
      const Eigen::Vector3d turn(random.normal(), random.normal(), random.normal());
      const Eigen::Vector3d to =
          Eigen::AngleAxisd(random.uniform(0.0, most), turn.normalized()) * Eigen::Vector3d(from);
      if (to.z() > std::cos(options.cone_rad)) return to.normalized().eval();
    }
  };
  const auto within = [&](const Eigen::Vector3d& tip) { return tip.cwiseAbs().maxCoeff() < options.half_box_m; };
  program::Pose at;
  program.start = at;
  Eigen::Vector3d heading = Eigen::Vector3d::UnitX();
  const int count =
      options.least_blocks +
      static_cast<int>(random.index(static_cast<std::uint64_t>(options.most_blocks - options.least_blocks + 1)));
  const bool dense = random.uniform() < 0.4;
  double feed = options.feed_m_per_s;
  for (int i = 1; i <= count; ++i) {
    const auto line = static_cast<std::size_t>(i);
    const double kind = random.uniform();
    if (random.uniform() < 0.1) feed = options.feed_m_per_s * random.uniform(0.2, 1.0);
    if (kind < 0.02) {
      program.blocks.push_back(
          {.kind = program::Block::Kind::dwell, .line = line, .end = at, .duration_s = random.uniform(0.01, 0.2)});
      continue;
    }
    program::Pose to = at;
    if (kind < 0.04) {  // the tool turns on its tip
      to.axis = axis_near(at.axis, 0.3);
    } else if (kind < 0.05) {  // nothing moves
    } else {
      double length = dense ? random.uniform(1e-4, 1e-3) : 5e-5 * std::pow(1000.0, random.uniform());
      if (kind < 0.08) {
        heading = -heading;
      } else if (!dense || kind < 0.2) {
        heading =
            (heading + random.uniform(0.0, 2.0) * Eigen::Vector3d(random.normal(), random.normal(), random.normal()))
                .normalized();
      } else {
        heading = (heading + 0.1 * Eigen::Vector3d(random.normal(), random.normal(), random.normal())).normalized();
      }
      for (int tries = 0; !within(at.tip_m + length * heading); ++tries) {
        heading = Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized();
        length = std::min(length, 0.5 * options.half_box_m);
      }
      to.tip_m = at.tip_m + length * heading;
      const double lean = std::min(0.3, random.uniform(0.0, 8.0) * length);
      if (kind < 0.8) to.axis = axis_near(at.axis, lean);
    }
    const double way_m = (to.tip_m - at.tip_m).norm(), angle = program::angle_between(at.axis, to.axis);
    const double duration = std::max({way_m / feed, angle / 0.3, 1e-4});
    const bool rapid = kind > 0.98;
    program.blocks.push_back({.kind = rapid ? program::Block::Kind::rapid : program::Block::Kind::feed,
                              .line = line,
                              .end = to,
                              .duration_s = rapid ? 0.0 : duration});
    at = to;
  }
  return program;
}

}  // namespace robomill::path::test
