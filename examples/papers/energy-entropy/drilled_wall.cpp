#include "examples/papers/energy-entropy/drilled_wall.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace robomill::examples {
namespace {

constexpr int parts = 8;  ///< of a sample, so that a corner meets every angle

}  // namespace

Eigen::MatrixXd drilled_wall(const Hole& hole, const Eigen::Ref<const Eigen::MatrixXd>& path_m, Eigen::Index angles) {
  constexpr double turn = 2.0 * std::numbers::pi;
  const auto& depth = hole.cut.schedule.depth;
  const double begin_s = hole_contact_s - depth[0].time_s + depth[1].time_s;
  const double speed = hole.cut.spindle_speed_rad_per_s, radius_m = 0.5 * hole.cut.diameter_m;
  const auto turns = static_cast<Eigen::Index>((depth[2].time_s - depth[1].time_s) * speed / turn);
  Eigen::MatrixXd out = Eigen::MatrixXd::Constant(angles, turns, std::numeric_limits<double>::quiet_NaN());
  const auto steps = static_cast<Eigen::Index>(static_cast<double>(turns) * turn / speed * hole_rate_hz * parts);
  for (Eigen::Index k = 0; k < steps; ++k) {
    const double since_s = static_cast<double>(k) / (hole_rate_hz * parts);
    const double at = (begin_s + since_s) * hole_rate_hz, rotation = speed * since_s;
    const auto row = static_cast<Eigen::Index>(at);
    const double share = at - static_cast<double>(row);
    const Eigen::RowVector2d axis_m = (1.0 - share) * path_m.row(row).head<2>() + share * path_m.row(row + 1).head<2>();
    const Eigen::Index column = std::min(turns - 1, static_cast<Eigen::Index>(rotation / turn));
    for (int lip = 0; lip < hole.cut.lips; ++lip) {
      const double standing = turn * lip / hole.cut.lips;
      const double reach_m = radius_m + hole.cut.runout_m * std::cos(standing);
      const double x_m = axis_m(0) + reach_m * std::sin(rotation + standing);
      const double y_m = axis_m(1) + reach_m * std::cos(rotation + standing);
      const double angle = std::atan2(x_m, y_m) / turn;
      const auto cell =
          std::min(angles - 1, static_cast<Eigen::Index>((angle - std::floor(angle)) * static_cast<double>(angles)));
      out(cell, column) = std::fmax(out(cell, column), std::hypot(x_m, y_m) - radius_m);  // NaN is left
    }
  }
  return out;
}

}  // namespace robomill::examples
