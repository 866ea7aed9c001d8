#include "robomill/cell/clearance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "robomill/base/parallel.hpp"
#include "robomill/base/units.hpp"

namespace robomill::cell {
namespace {

constexpr int points_an_arc = 32;
constexpr double longest_step_m = 5e-3, shortest_step_m = 0.5e-3;
constexpr double line_m = 0.1e-3;  // of a tool whose diameter nobody said

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

/// What stands for a cutter that nobody described: the shank down to the tip, which may stand in the part.
void take_shank(robot::CellGeometry& geometry, const Cell& cell, std::vector<Assumption>& assumed) {
  const double diameter_m = geometry.tool.shank_diameter_m;
  const double radius_m = diameter_m > 0.0 ? diameter_m / 2.0 : line_m / 2.0;
  geometry.tool.edges = {{.height_m = 0.0, .radius_m = radius_m},
                         {.height_m = geometry.tool.stickout_m, .radius_m = radius_m}};
  for (const robot::Body& part : geometry.part) geometry.ignored.emplace_back("cutter", part.name);
  assumed.push_back(
      {.what = "Cutter in the check for collisions",
       .taken = (diameter_m > 0.0 ? fmt::format("the shank down to the tip, {:.4g} mm thick", diameter_m / units::mm)
                                  : std::string("a line as long as the stick-out")) +
                (geometry.part.empty() ? "" : "; gouges of the part were not looked for"),
       .key = diameter_m > 0.0 ? "" : "geometry.shank_diameter_mm",
       .file = diameter_m > 0.0 ? "" : cell.path.filename().string()});
}

}  // namespace

std::unique_ptr<robot::CollisionChecker> clearance_checker(const Cell& cell, const cutting::Cutter* cutter,
                                                           std::vector<Assumption>& assumed) {
  if (!cell.geometry) return nullptr;
  robot::CellGeometry geometry = *cell.geometry;
  if (cutter != nullptr) {
    geometry.tool.edges = outline_of(*cutter);
  } else {
    take_shank(geometry, cell, assumed);
  }
  return std::make_unique<robot::CollisionChecker>(cell.robot, geometry);
}

PathLooks::PathLooks(const robot::CollisionChecker& checker, int joints, double step_m)
    : checker_(&checker), joints_(joints), first_step_m_(step_m), step_m_(step_m) {}

void PathLooks::restart() {
  looks_.clear();
  last_.reset();
  since_m_ = 0.0;
  step_m_ = first_step_m_;
}

void PathLooks::keep(const path::Sample& sample, double way_m, bool ends_block) {
  looks_.push_back({.joints = sample.joints,
                    .time_s = sample.time_s,
                    .block = sample.block,
                    .way_m = way_m,
                    .ends_block = ends_block});
  since_m_ = 0.0;
  if (looks_.size() >= most_looks) thin();
}

void PathLooks::thin() {
  // Where blocks alone fill the list their ends are thinned too.
  const bool ends_too = std::ranges::count(looks_, true, &Look::ends_block) > static_cast<long>(most_looks / 2);
  step_m_ *= 2.0;
  std::vector<Look> kept;
  double way_m = 0.0;
  for (std::size_t i = 0; i < looks_.size(); ++i) {
    way_m += looks_[i].way_m;
    const double next_m = i + 1 < looks_.size() ? looks_[i + 1].way_m : 0.0;
    const bool needed = i == 0 || way_m + next_m > step_m_ || (looks_[i].ends_block && !ends_too);
    if (!needed && i + 1 < looks_.size()) continue;
    kept.push_back(looks_[i]);
    kept.back().way_m = way_m;
    way_m = 0.0;
  }
  looks_ = std::move(kept);
}

double PathLooks::between(const path::Sample& from, const path::Sample& to, double way_m) {
  if (!(way_m > step_m_)) return way_m;
  // Samples that are farther apart than a step: the joints run evenly from one to the other.
  if (since_m_ > 0.0) keep(from, since_m_, false);
  const double pieces = std::ceil(way_m / step_m_);
  path::Sample at = to;
  for (double k = 1.0; k < pieces; ++k) {
    at.joints = from.joints + k / pieces * (to.joints - from.joints);
    at.time_s = from.time_s + k / pieces * (to.time_s - from.time_s);
    keep(at, way_m / pieces, false);
  }
  return way_m / pieces;
}

void PathLooks::add(std::span<const path::Sample> samples) {
  for (const path::Sample& sample : samples) {
    if (!last_) {
      keep(sample, 0.0, false);
    } else {
      const double way_m = checker_->longest_way_m(last_->joints.head(joints_), sample.joints.head(joints_));
      const bool ends_block = sample.block != last_->block;
      if (since_m_ > 0.0 && (ends_block || since_m_ + way_m > step_m_)) keep(*last_, since_m_, ends_block);
      since_m_ += between(*last_, sample, way_m);
    }
    last_ = sample;
  }
}

path::PathClearance PathLooks::check(double clearance_m, double reach_m) const {
  std::vector<Look> looks = looks_;
  if (last_ && since_m_ > 0.0) {
    looks.push_back({.joints = last_->joints, .time_s = last_->time_s, .block = last_->block, .way_m = since_m_});
  }
  std::vector<robot::Clearance> found(looks.size());
  parallel_for(looks.size(), 8, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) found[i] = checker_->check(looks[i].joints.head(joints_), reach_m);
  });
  path::PathClearance out{.required_m = clearance_m, .reach_m = std::max(clearance_m, reach_m), .looks = looks.size()};
  std::size_t worst = 0;
  bool clear = true;
  for (std::size_t i = 0; i < looks.size(); ++i) {
    out.between_m = std::max(out.between_m, looks[i].way_m);
    if (!clear) continue;
    clear = found[i].status == robot::Clearance::Status::clear;
    if (!clear || found[i].distance_m < found[worst].distance_m) worst = i;
  }
  if (looks.empty()) return out;
  out.clearance = found[worst];
  out.time_s = looks[worst].time_s;
  out.block = looks[worst].block;
  return out;
}

double look_step_m(const robot::CellGeometry& geometry) {
  return std::clamp(2.0 * geometry.clearance_m, shortest_step_m, longest_step_m);
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

}  // namespace robomill::cell
