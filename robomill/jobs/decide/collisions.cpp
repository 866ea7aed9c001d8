#include "robomill/jobs/decide/collisions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "robomill/base/units.hpp"

namespace robomill::jobs {
namespace {

constexpr int points_an_arc = 32;
/// Longest and shortest way of any point between two looks at a move.
constexpr double longest_step_m = 5e-3, shortest_step_m = 0.5e-3;

std::vector<robot::OutlinePoint> outline_of(const cutting::Cutter& cutter) {
  const cutting::Profile profile(cutter);
  std::vector<robot::OutlinePoint> out = {{.height_m = 0.0, .radius_m = profile.pieces().front().first.radius_m}};
  for (const cutting::Profile::Piece& piece : profile.pieces()) {
    const int points = piece.arc_radius_m > 0.0 ? points_an_arc : 1;
    for (int k = 1; k <= points; ++k) {
      const cutting::Profile::Point at = profile.at(piece.start_m + piece.length_m * k / points);
      out.push_back({.height_m = at.height_m, .radius_m = at.radius_m});
    }
  }
  return out;
}

}  // namespace

std::unique_ptr<robot::CollisionChecker> collision_checker(const CellFile& cell, const cutting::Cutter& cutter) {
  if (!cell.geometry) return nullptr;
  robot::CellGeometry geometry = *cell.geometry;
  geometry.tool.edges = outline_of(cutter);
  return std::make_unique<robot::CollisionChecker>(cell.cell, geometry);
}

std::optional<NearMiss> first_near_miss(const robot::CollisionChecker& checker, const robot::CellGeometry& geometry,
                                        const std::vector<robot::Position6>& joints) {
  const double step_m = std::clamp(2.0 * geometry.clearance_m, shortest_step_m, longest_step_m);
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const robot::Clearance clearance =
        i == 0 ? checker.check(joints[i]) : checker.check_move(joints[i - 1], joints[i], step_m).clearance;
    if (clearance.status != robot::Clearance::Status::clear) return NearMiss{.block = i, .clearance = clearance};
  }
  return std::nullopt;
}

std::string near_miss_text(const robot::Clearance& clearance) {
  using Status = robot::Clearance::Status;
  switch (clearance.status) {
    case Status::gouge:
      return fmt::format("{} gouges {} by {:.3g} mm", clearance.first, clearance.second, clearance.depth_m / units::mm);
    case Status::collision:
      return fmt::format("{} collides with {}", clearance.first, clearance.second);
    case Status::too_near:
      return fmt::format("{} comes within {:.3g} mm of {}", clearance.first, clearance.distance_m / units::mm,
                         clearance.second);
    case Status::clear:
      break;
  }
  return "clear";
}

}  // namespace robomill::jobs
