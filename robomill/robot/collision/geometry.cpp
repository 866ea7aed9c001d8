#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/robot/collision.hpp"
#include "robomill/robot/collision/body_names.hpp"

namespace robomill::robot {
namespace {

// A turn of the outline that rounding alone can make is none.
constexpr double least_turn = 1e-9;

std::string nth(const char* list, std::size_t i) {
  return fmt::format("{}[{}]", list, i + 1);
}

void validate_mesh(const std::string& field, const io::TriangleMesh& mesh) {
  if (mesh.triangles.empty()) throw InvalidInput(field, "must hold at least one triangle");
  const auto beyond = [&](const auto& triangle) {
    return std::ranges::any_of(triangle, [&](std::size_t vertex) { return vertex >= mesh.vertices_m.size(); });
  };
  if (std::ranges::any_of(mesh.triangles, beyond))
    throw InvalidInput(field, "has a triangle of a vertex that is not there");
  const auto finite = [](const Eigen::Vector3d& vertex) { return vertex.allFinite(); };
  if (!std::ranges::all_of(mesh.vertices_m, finite)) throw InvalidInput(field, "must have finite vertices");
}

void validate_bodies(const char* list, const std::vector<Body>& bodies) {
  for (std::size_t i = 0; i < bodies.size(); ++i) validate_mesh(nth(list, i) + ".mesh", bodies[i].mesh);
}

void validate_link_body(const LinkBody& body, Eigen::Index joints) {
  if (body.link < 0 || body.link > joints) {
    throw InvalidInput("link", body.link, "", fmt::format("must be 0 for the base, or 1 to {}", joints));
  }
  if (!body.pose.matrix().allFinite()) throw InvalidInput("pose", "must be finite");
  if (body.capsule.has_value() != body.mesh.triangles.empty()) {
    throw InvalidInput("mesh", "must be given, or a capsule, and not both");
  }
  if (!body.capsule) {
    validate_mesh("mesh", body.mesh);
    return;
  }
  if (!body.capsule->from_m.allFinite() || !body.capsule->to_m.allFinite()) {
    throw InvalidInput("capsule", "must have finite ends");
  }
  require_positive("capsule.diameter_m", body.capsule->diameter_m, "m");
}

void validate_edges(const std::vector<OutlinePoint>& edges) {
  if (edges.size() < 2) throw InvalidInput("edges", "must hold the outline that the cutter's edges sweep");
  bool wide = false;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    try {
      require_non_negative("radius_m", edges[i].radius_m, "m");
      require_non_negative("height_m", edges[i].height_m, "m");
      const double below_m = i == 0 ? 0.0 : edges[i - 1].height_m;
      if (i == 0 && edges[i].height_m > 0.0) {
        throw InvalidInput("height_m", edges[i].height_m, "m", "must be 0 at the tip");
      }
      if (edges[i].height_m < below_m) {
        throw InvalidInput("height_m", edges[i].height_m, "m", "must not fall along the outline");
      }
    } catch (const InvalidInput& error) {
      throw within(nth("edges", i) + ".", error);
    }
    wide = wide || edges[i].radius_m > 0.0;
  }
  if (!wide || !(edges.back().height_m > 0.0)) throw InvalidInput("edges", "must enclose a volume");
  Eigen::Vector2d before(1.0, 0.0);  // of the outline's direction (radius, height); it starts outwards
  for (std::size_t i = 1; i < edges.size(); ++i) {
    Eigen::Vector2d along(edges[i].radius_m - edges[i - 1].radius_m, edges[i].height_m - edges[i - 1].height_m);
    if (along.norm() == 0.0) continue;
    along.normalize();
    if (before.x() * along.y() - before.y() * along.x() < -least_turn) {
      throw InvalidInput(nth("edges", i), "must leave the outline convex",
                         "Give the head's outline alone; what is thinner above it is shank");
    }
    before = along;
  }
}

void validate_sections(const char* list, const std::vector<ToolSection>& sections) {
  for (std::size_t i = 0; i < sections.size(); ++i) {
    try {
      const ToolSection& section = sections[i];
      require_positive("length_m", section.length_m, "m");
      require_non_negative("lower_diameter_m", section.lower_diameter_m, "m");
      require_non_negative("upper_diameter_m", section.upper_diameter_m, "m");
      if (section.lower_diameter_m + section.upper_diameter_m == 0.0) {
        throw InvalidInput("lower_diameter_m", 0.0, "m", "must be > 0, or the upper one");
      }
    } catch (const InvalidInput& error) {
      throw within(nth(list, i) + ".", error);
    }
  }
}

void validate_tool(const ToolGeometry& tool) {
  validate_edges(tool.edges);
  require_positive("stickout_m", tool.stickout_m, "m", "From the tip to the holder");
  if (tool.stickout_m < tool.edges.back().height_m) {
    throw InvalidInput(
        "stickout_m", tool.stickout_m, "m",
        fmt::format("must be at least the height of the cutter's edges, {:.6g} m", tool.edges.back().height_m));
  }
  require_non_negative("shank_diameter_m", tool.shank_diameter_m, "m");
  validate_sections("holder", tool.holder);
  validate_sections("spindle", tool.spindle);
  validate_bodies("spindle_bodies", tool.spindle_bodies);
}

}  // namespace

std::vector<std::string> body_names(const CellGeometry& geometry) {
  std::vector<std::string> names = {cutter_name, shank_name, holder_name};
  if (!geometry.tool.spindle.empty()) names.emplace_back(spindle_name);
  for (const auto* list : {&geometry.part, &geometry.fixtures, &geometry.cell, &geometry.tool.spindle_bodies}) {
    for (const Body& body : *list) names.push_back(body.name);
  }
  for (const LinkBody& body : geometry.arm) names.push_back(body.name);
  return names;
}

void CellGeometry::validate(const Cell& in) const {
  validate_bodies("part", part);
  validate_bodies("fixtures", fixtures);
  validate_bodies("cell", cell);
  for (std::size_t i = 0; i < arm.size(); ++i) {
    try {
      validate_link_body(arm[i], in.arm.size());
    } catch (const InvalidInput& error) {
      throw within(nth("arm", i) + ".", error);
    }
  }
  try {
    validate_tool(tool);
  } catch (const InvalidInput& error) {
    throw within("tool.", error);
  }
  if (part.empty() && fixtures.empty() && cell.empty() && arm.empty()) {
    throw InvalidInput("part", "must be given, or fixtures, cell or arm: there is nothing to strike");
  }
  require_non_negative("clearance_m", clearance_m, "m", "Of everything but the cutter's edges");
  if (!part.empty())
    require_non_negative("gouge_tolerance_m", gouge_tolerance_m, "m", "Of the part's mesh and the cut");

  std::set<std::string> names;
  for (const std::string& name : body_names(*this)) {
    if (name.empty()) throw InvalidInput("name", "must be given of every body");
    if (!names.insert(name).second)
      throw InvalidInput("name", fmt::format("\"{}\" must be the name of one body alone", name));
  }
  for (std::size_t i = 0; i < ignored.size(); ++i) {
    for (const std::string& name : {ignored[i].first, ignored[i].second}) {
      if (!names.contains(name))
        throw InvalidInput(nth("ignored", i), fmt::format("names \"{}\", which is no body", name));
    }
  }
}

}  // namespace robomill::robot
