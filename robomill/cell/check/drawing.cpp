#include "robomill/cell/check/drawing.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>

#include "robomill/base/units.hpp"

namespace robomill::cell {
namespace {

using Outline = std::vector<Eigen::Vector2d>;

constexpr std::size_t most_path_points = 400;
constexpr int reach_steps = 181, reach_bins = 180, arc_steps = 120;

/// A serial arm as standard DH sees it: along each axis to where the common normal to the next one begins, then along
/// that.
void add_arm(const robot::Arm& arm, const robot::Position6& position, CellFigure& out) {
  robot::Posture posture;
  posture.update(arm, position);
  std::vector<Eigen::Vector3d>& line = out.links_m.emplace_back();
  for (Eigen::Index i = 0; i < arm.size(); ++i) {
    const Eigen::Vector3d at = posture.origin_m.col(i);
    const Eigen::Vector3d next = i + 1 < arm.size() ? Eigen::Vector3d(posture.origin_m.col(i + 1)) : out.flange_m;
    const Eigen::Vector3d axis = posture.axis.col(i);
    out.joints_m.push_back(at);
    line.push_back(at);
    line.push_back(at + axis.dot(next - at) * axis);
  }
  line.push_back(out.flange_m);
}

/// The hybrid machine: a leg each from the carriage to the platform, and the platform.
void add_legs(const robot::HybridMachine& machine, const CellStand& stand, CellFigure& out) {
  const double a = machine.base_half_width_m, b = machine.platform_half_width_m;
  const Eigen::Vector3d carriage(stand.position(3), stand.position(4), 0.0);
  const Eigen::Isometry3d platform = stand.flange * Eigen::Translation3d(0.0, 0.0, -machine.platform_to_flange_m);
  const Eigen::Vector3d from[] = {{a, 0.0, 0.0}, {-a, 0.0, 0.0}, {0.0, machine.base_offset_m, 0.0}};
  const Eigen::Vector3d to[] = {{b, 0.0, 0.0}, {-b, 0.0, 0.0}, {0.0, machine.platform_offset_m, 0.0}};
  for (std::size_t leg = 0; leg < 3; ++leg) {
    out.joints_m.push_back(carriage + from[leg]);
    out.links_m.push_back({carriage + from[leg], platform * to[leg]});
  }
  out.links_m.push_back({platform * to[0], platform * to[1], platform * to[2], platform * to[0], out.flange_m});
}

CellFigure figure_of(const CellCheck& check, const CellStand& stand) {
  CellFigure out{.name = stand.name, .flange_m = stand.flange.translation(), .tip_m = stand.tip_m};
  if (check.cell.hybrid) {
    add_legs(*check.cell.hybrid, stand, out);
  } else {
    add_arm(check.cell.robot.arm, stand.position, out);
  }
  return out;
}

/// Values spread over a joint's range, at most a turn of it.
std::vector<double> over_range(const robot::Joint& joint, int count) {
  double low = joint.min_position, high = joint.max_position;
  if (!(high - low < units::revolution)) {
    const double middle = high - low < 1e3 ? 0.5 * (low + high) : 0.0;
    low = middle - std::numbers::pi;
    high = middle + std::numbers::pi;
  }
  std::vector<double> out(static_cast<std::size_t>(count));
  for (int k = 0; k < count; ++k) out[static_cast<std::size_t>(k)] = low + (high - low) * k / (count - 1);
  return out;
}

/// Of points around a centre, by their direction, the farthest and the nearest.
class PolarRange {
 public:
  explicit PolarRange(const Eigen::Vector2d& centre) : centre_(centre), low_(reach_bins), high_(reach_bins) {}

  void add(const Eigen::Vector2d& point) {
    const Eigen::Vector2d arm = point - centre_;
    const double share = (std::atan2(arm.y(), arm.x()) + std::numbers::pi) / units::revolution;
    const auto bin = static_cast<std::size_t>(std::min(share * reach_bins, reach_bins - 1.0));
    const auto nearer = [&](const std::optional<Eigen::Vector2d>& other) {
      return !other || arm.norm() < (*other - centre_).norm();
    };
    if (nearer(low_[bin])) low_[bin] = point;
    if (!high_[bin] || !nearer(high_[bin])) high_[bin] = point;
  }

  /// Closed outlines of what was met; one that goes all the way round has a hole.
  [[nodiscard]] std::vector<Outline> outlines() const {
    const auto empty = std::ranges::find_if(high_, [](const auto& point) { return !point; });
    if (empty == high_.end()) return {ring(high_), ring(low_)};
    std::vector<Outline> out;
    const auto first = static_cast<std::size_t>(empty - high_.begin());
    Outline outer, inner;
    for (std::size_t k = 1; k <= high_.size(); ++k) {
      const std::size_t bin = (first + k) % high_.size();
      if (high_[bin]) {
        outer.push_back(*high_[bin]);
        inner.push_back(*low_[bin]);
      } else if (!outer.empty()) {
        outer.insert(outer.end(), inner.rbegin(), inner.rend());
        out.push_back(std::move(outer));
        outer.clear();
        inner.clear();
      }
    }
    return out;
  }

 private:
  using Bins = std::vector<std::optional<Eigen::Vector2d>>;
  static Outline ring(const Bins& bins) {
    Outline out;
    for (const auto& point : bins) out.push_back(*point);
    return out;
  }
  Eigen::Vector2d centre_;
  Bins low_, high_;
};

/// An arc about a centre, or the centre where it has no radius.
void add_arc(const Eigen::Vector2d& centre, double radius, double from, double to, Outline& out) {
  if (!(radius > 0.0)) {
    out.push_back(centre);
    return;
  }
  for (int k = 0; k <= arc_steps; ++k) {
    const double angle = from + (to - from) * k / arc_steps;
    out.emplace_back(centre.x() + radius * std::cos(angle), centre.y() + radius * std::sin(angle));
  }
}

/// From above: what the side view covers, swept by joint 1.
std::vector<Outline> swept(const robot::Joint& first, const Eigen::Vector2d& centre, double turning, double heading,
                           double low, double high) {
  const std::vector<double> range = over_range(first, 2);
  const double from = heading + turning * range.front(), to = heading + turning * range.back();
  const double outer = std::max(std::abs(low), std::abs(high)), inner = low > 0.0 ? low : 0.0;
  Outline out;
  add_arc(centre, outer, from, to, out);
  if (std::abs(to - from) >= units::revolution - 1e-9) {
    Outline hole;
    add_arc(centre, inner, from, to, hole);
    return inner > 0.0 ? std::vector<Outline>{out, hole} : std::vector<Outline>{out};
  }
  add_arc(centre, inner, to, from, out);
  return {out};
}

/// Where joint 5's origin can be; nothing for an arm whose axis 1 is not along z of B.
void add_reach(const robot::Arm& arm, const robot::Position6& home, CellDrawing& out) {
  robot::Posture posture;
  robot::Position6 position = home;
  const robot::Joint& first = arm.joints.front();
  position(0) = std::clamp(0.0, first.min_position, first.max_position);
  posture.update(arm, position);
  const double turning = posture.axis(2, 0);
  if (!(std::abs(turning) > 0.99)) return;
  const Eigen::Vector2d centre = posture.origin_m.col(0).head<2>();
  const auto side = [](const Eigen::Vector3d& point) { return Eigen::Vector2d(point.x(), point.z()); };
  PolarRange range(side(posture.origin_m.col(1)));
  // The plane of the arm is that of axis 1 and the wrist where the arm is farthest from it.
  double low = HUGE_VAL, high = -HUGE_VAL;
  Eigen::Vector2d heading = Eigen::Vector2d::UnitX();
  std::vector<Eigen::Vector2d> above;
  for (const double second : over_range(arm.joints[1], reach_steps)) {
    for (const double third : over_range(arm.joints[2], reach_steps)) {
      position(1) = second;
      position(2) = third;
      posture.update(arm, position);
      const Eigen::Vector3d wrist = posture.origin_m.col(4);
      range.add(side(wrist));
      above.emplace_back(wrist.head<2>() - centre);
      if (above.back().norm() > high) {
        high = above.back().norm();
        heading = above.back().normalized();
      }
    }
  }
  for (const Eigen::Vector2d& arm_m : above) {
    const double along = heading.dot(arm_m);
    low = std::min(low, along < 0.0 ? along : arm_m.norm());
  }
  out.reach_side_m = range.outlines();
  out.reach_top_m = swept(first, centre, turning, std::atan2(heading.y(), heading.x()), low, high);
}

}  // namespace

CellDrawing draw_cell(const CellCheck& check, const path::Head& program) {
  CellDrawing out;
  for (const CellStand& stand : check.stands) out.figures.push_back(figure_of(check, stand));
  const std::size_t step = std::max<std::size_t>(1, (program.pose.size() + most_path_points - 1) / most_path_points);
  for (std::size_t i = 0; i < program.pose.size(); i += step) {
    out.program_m.push_back(check.cell.robot.workpiece * program.pose[i].tip_m);
  }
  if (!check.cell.hybrid) {
    const auto home = std::ranges::find(check.stands, "home", &CellStand::name);
    add_reach(check.cell.robot.arm, home->position, out);
  }
  return out;
}

}  // namespace robomill::cell
