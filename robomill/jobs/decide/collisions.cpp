#include "robomill/jobs/decide/collisions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "robomill/base/parallel.hpp"
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

std::vector<NearMiss> near_misses(const robot::CollisionChecker* checker, const CellFile& cell, const Stands& stands) {
  if (checker == nullptr) return {};
  const double step_m = std::clamp(2.0 * cell.geometry->clearance_m, shortest_step_m, longest_step_m);
  std::vector<robot::Clearance> clearance(stands.joints.size());
  parallel_for(clearance.size(), 8, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const robot::Position6 from = i == 0 ? stands.start.value_or(stands.joints[0]) : stands.joints[i - 1];
      clearance[i] = checker->check_move(from, stands.joints[i], step_m).clearance;
    }
  });
  std::vector<NearMiss> out;
  for (std::size_t i = 0; i < clearance.size(); ++i) {
    if (clearance[i].status != robot::Clearance::Status::clear) out.push_back({.block = i, .clearance = clearance[i]});
  }
  return out;
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
