#include "robomill/robot/collision.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/robot/collision/body_names.hpp"
#include "robomill/robot/collision/revolution.hpp"
#include "robomill/robot/collision/solid.hpp"

namespace robomill::robot {
namespace {

constexpr double round_excess_m = 20e-6;  // of meshes around cylinders and cones
constexpr double touch_m = 1e-9;          // edges that stand no deeper than this touch
constexpr double most_looks = 1e6;

enum class BodyRole { part, fixture, link, tool, edges };  // cell is a fixture

struct PlacedBody {
  std::string name;
  BodyRole role;
  int frame;  // 0: B; k: after joint k; n + 1: E
  Eigen::Isometry3d pose;
  Solid solid;
};

struct BodyPair {
  std::size_t first, second;
  bool of_edges;  // which may come as near as they like
};

/// From the frame of the tool, its tip at the origin and z towards the spindle, to E.
Eigen::Isometry3d tool_in_flange(const Cell& cell) {
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  out.linear().diagonal() << 1.0, -1.0, -1.0;
  out.translation().z() = cell.tool_length_m;
  return out;
}

/// The outline of sections one above the other. @param height_m  where the first begins; then, where the last ends
std::vector<OutlinePoint> outline_of(const std::vector<ToolSection>& sections, double& height_m) {
  std::vector<OutlinePoint> out;
  for (const ToolSection& section : sections) {
    out.push_back({.height_m = height_m, .radius_m = section.lower_diameter_m / 2.0});
    height_m += section.length_m;
    out.push_back({.height_m = height_m, .radius_m = section.upper_diameter_m / 2.0});
  }
  return out;
}

void require_position(const char* field, const Eigen::Ref<const Eigen::VectorXd>& position, Eigen::Index joints) {
  if (position.size() != joints || !position.allFinite()) {
    throw InvalidInput(field, fmt::format("must hold one finite number a joint, {}", joints));
  }
}

}  // namespace

struct CollisionChecker::State {
  Arm arm;
  double clearance_m = 0.0, gouge_tolerance_m = 0.0;
  std::vector<PlacedBody> bodies;
  std::vector<BodyPair> pairs;               // whose distance counts
  std::vector<std::size_t> closed_to_edges;  // bodies that the edges must not enter
  std::size_t edges = 0;                     // which body they are
  ConvexRevolution cutter;
  std::vector<double> from_origin_m, from_axis_m;  // of joint k, the farthest of what stands on its frame; k from 0
  std::vector<std::string> notes;

  State(const Cell& cell, const CellGeometry& geometry)
      : arm(cell.arm),
        clearance_m(geometry.clearance_m),
        gouge_tolerance_m(std::max(0.0, geometry.gouge_tolerance_m)),
        cutter(geometry.tool.edges, gouge_tolerance_m) {
    add_cell(cell, geometry);
    add_tool(tool_in_flange(cell), geometry.tool);
    for (const LinkBody& body : geometry.arm) {
      add(body.name, BodyRole::link, body.link, body.pose, body.capsule ? Solid(*body.capsule) : Solid(body.mesh));
    }
    add_pairs(geometry);
    measure_reach();
    for (const PlacedBody& body : bodies) {
      if (body.solid.open_edges() == 0) continue;
      notes.push_back(
          fmt::format("{} is not closed, {} of its edges are open: only its surface is checked, and what is "
                      "wholly inside is not seen",
                      body.name, body.solid.open_edges()));
    }
  }

  [[nodiscard]] int flange_frame() const { return static_cast<int>(arm.size()) + 1; }
  void add(const std::string& name, BodyRole role, int frame, const Eigen::Isometry3d& pose, Solid body) {
    bodies.push_back({name, role, frame, pose, std::move(body)});
  }

  void add_cell(const Cell& cell, const CellGeometry& geometry) {
    const auto all = [&](const std::vector<Body>& list, BodyRole role, const Eigen::Isometry3d& pose) {
      for (const Body& body : list) add(body.name, role, 0, pose, Solid(body.mesh));
    };
    all(geometry.part, BodyRole::part, cell.workpiece);
    all(geometry.fixtures, BodyRole::fixture, cell.workpiece);
    all(geometry.cell, BodyRole::fixture, Eigen::Isometry3d::Identity());
  }

  void add_tool(const Eigen::Isometry3d& pose, const ToolGeometry& tool) {
    const auto turned = [&](const char* name, BodyRole role, const std::vector<OutlinePoint>& outline) {
      if (!outline.empty()) add(name, role, flange_frame(), pose, Solid(revolve(outline, round_excess_m)));
    };
    edges = bodies.size();
    turned(cutter_name, BodyRole::edges, tool.edges);
    double height_m = tool.edges.back().height_m;
    const double shank_m = tool.shank_diameter_m > 0.0 ? tool.shank_diameter_m : 2.0 * tool.edges.back().radius_m;
    if (tool.stickout_m > height_m && shank_m > 0.0) {
      const ToolSection shank{
          .length_m = tool.stickout_m - height_m, .lower_diameter_m = shank_m, .upper_diameter_m = shank_m};
      turned(shank_name, BodyRole::tool, outline_of({shank}, height_m));
    }
    height_m = tool.stickout_m;
    turned(holder_name, BodyRole::tool, outline_of(tool.holder, height_m));
    turned(spindle_name, BodyRole::tool, outline_of(tool.spindle, height_m));
    for (const Body& body : tool.spindle_bodies) {
      add(body.name, BodyRole::tool, flange_frame(), Eigen::Isometry3d::Identity(), Solid(body.mesh));
    }
  }

  [[nodiscard]] bool is_checked(const PlacedBody& a, const PlacedBody& b, const CellGeometry& geometry) const {
    const bool ignored = std::ranges::any_of(geometry.ignored, [&](const auto& pair) {
      return (pair.first == a.name && pair.second == b.name) || (pair.first == b.name && pair.second == a.name);
    });
    if (ignored) return false;
    const auto stands = [](const PlacedBody& body) {
      return body.role == BodyRole::part || body.role == BodyRole::fixture;
    };
    const auto on_tool = [](const PlacedBody& body) {
      return body.role == BodyRole::tool || body.role == BodyRole::edges;
    };
    if (stands(a) && stands(b)) return false;
    if (stands(a) || stands(b)) return (stands(a) ? b : a).frame > 0;
    if (on_tool(a) && on_tool(b)) return false;
    // The tool is on the last link; the one below it is its neighbour.
    if (on_tool(a) || on_tool(b)) return (on_tool(a) ? b : a).frame < flange_frame() - 2;
    return geometry.self_collision && std::abs(a.frame - b.frame) > 1;
  }

  void add_pairs(const CellGeometry& geometry) {
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      for (std::size_t j = i + 1; j < bodies.size(); ++j) {
        if (!is_checked(bodies[i], bodies[j], geometry)) continue;
        if (i != edges && j != edges) {
          pairs.push_back({i, j, false});
          continue;
        }
        const std::size_t other = i == edges ? j : i;
        if (bodies[other].role == BodyRole::link) {
          pairs.push_back({i, j, true});
        } else {
          closed_to_edges.push_back(other);
        }
      }
    }
  }

  void measure_reach() {
    from_origin_m.assign(arm.joints.size(), 0.0);
    from_axis_m = from_origin_m;
    for (const PlacedBody& body : bodies) {
      if (body.frame == 0) continue;
      const bool tool = body.frame == flange_frame();
      const auto joint = static_cast<std::size_t>(tool ? body.frame - 2 : body.frame - 1);
      const Eigen::Isometry3d pose = tool ? arm.flange * body.pose : body.pose;
      from_origin_m[joint] = std::max(from_origin_m[joint], body.solid.farthest_m(pose));
      from_axis_m[joint] = std::max(from_axis_m[joint], body.solid.farthest_m(pose, arm.joints[joint].axis));
    }
  }

  [[nodiscard]] std::vector<Eigen::Isometry3d> poses(const Eigen::Ref<const Eigen::VectorXd>& position) const {
    std::array<Eigen::Isometry3d, max_joints + 2> frames;
    frames[0].setIdentity();
    for (std::size_t k = 0; k < arm.joints.size(); ++k) {
      const Joint& joint = arm.joints[k];
      const double q = position(static_cast<Eigen::Index>(k));
      frames[k + 1] = frames[k] * joint.before;
      if (joint.prismatic) {
        frames[k + 1].translate(q * joint.axis);
      } else {
        frames[k + 1].rotate(Eigen::AngleAxisd(q, joint.axis));
      }
    }
    const std::size_t n = arm.joints.size();
    frames[n + 1] = frames[n] * arm.flange;
    std::vector<Eigen::Isometry3d> out;
    out.reserve(bodies.size());
    for (const PlacedBody& body : bodies) out.push_back(frames[static_cast<std::size_t>(body.frame)] * body.pose);
    return out;
  }

  void say(Clearance& out, Clearance::Status status, std::size_t first, std::size_t second) const {
    out.status = status;
    out.first = bodies[first].name;
    out.second = bodies[second].name;
  }

  /// The nearest pair; whether one intersects.
  bool find_nearest(const std::vector<Eigen::Isometry3d>& poses, Clearance& out) const {
    const BodyPair* nearest = nullptr;
    for (const BodyPair& pair : pairs) {
      const double within_m = pair.of_edges ? 0.0 : out.distance_m;
      const Solid &a = bodies[pair.first].solid, &b = bodies[pair.second].solid;
      const Eigen::Isometry3d relative = poses[pair.first].inverse() * poses[pair.second];
      if (a.bound_m(b, relative) > within_m) continue;
      const double distance_m = a.distance_m(b, relative, std::max(within_m, touch_m));
      if (distance_m == 0.0) {
        out.distance_m = 0.0;
        say(out, Clearance::Status::collision, pair.first, pair.second);
        return true;
      }
      if (distance_m >= within_m) continue;
      out.distance_m = distance_m;
      nearest = &pair;
    }
    if (nearest == nullptr) return false;
    const bool near = out.distance_m < clearance_m;
    say(out, near ? Clearance::Status::too_near : Clearance::Status::clear, nearest->first, nearest->second);
    return false;
  }

  /// What the edges stand in: fixtures first, then the part.
  void find_depth(const std::vector<Eigen::Isometry3d>& poses, Clearance& out) const {
    const auto look = [&](BodyRole role, double tolerance_m, Clearance::Status status) {
      for (const std::size_t other : closed_to_edges) {
        if (bodies[other].role != role) continue;
        const Eigen::Isometry3d to_cutter = poses[edges].inverse() * poses[other];
        if (bodies[edges].solid.bound_m(bodies[other].solid, to_cutter) > 0.0) continue;
        const double depth_m = bodies[other].solid.depth_in_m(cutter, to_cutter, std::max(tolerance_m, out.depth_m));
        if (depth_m <= std::max(tolerance_m, out.depth_m)) continue;
        out.depth_m = depth_m;
        say(out, status, edges, other);
      }
    };
    look(BodyRole::fixture, touch_m, Clearance::Status::collision);
    if (out.status == Clearance::Status::collision) {
      out.distance_m = 0.0;
      return;
    }
    look(BodyRole::part, gouge_tolerance_m, Clearance::Status::gouge);
  }

  [[nodiscard]] Clearance check(const Eigen::Ref<const Eigen::VectorXd>& position, double reach_m) const {
    Clearance out;
    out.distance_m = std::max(clearance_m, reach_m);
    const std::vector<Eigen::Isometry3d> at = poses(position);
    if (!find_nearest(at, out)) find_depth(at, out);
    return out;
  }
};

CollisionChecker::CollisionChecker(const Cell& cell, const CellGeometry& geometry) {
  cell.validate();
  geometry.validate(cell);
  state_ = std::make_unique<const State>(cell, geometry);
}

CollisionChecker::~CollisionChecker() = default;
CollisionChecker::CollisionChecker(CollisionChecker&&) noexcept = default;
CollisionChecker& CollisionChecker::operator=(CollisionChecker&&) noexcept = default;

Clearance CollisionChecker::check(const Eigen::Ref<const Eigen::VectorXd>& position, double reach_m) const {
  require_position("position", position, state_->arm.size());
  require_non_negative("reach_m", reach_m, "m");
  return state_->check(position, reach_m);
}

double CollisionChecker::longest_way_m(const Eigen::Ref<const Eigen::VectorXd>& from,
                                       const Eigen::Ref<const Eigen::VectorXd>& to) const {
  require_position("from", from, state_->arm.size());
  require_position("to", to, state_->arm.size());
  const std::vector<Joint>& joints = state_->arm.joints;
  double way_m = 0.0, beyond_m = 0.0;  // of what joint k moves, the farthest from its origin, frames above k alone
  for (std::size_t k = joints.size(); k-- > 0;) {
    const auto at = static_cast<Eigen::Index>(k);
    const double turn = std::abs(to(at) - from(at));
    way_m += joints[k].prismatic ? turn : turn * std::max(state_->from_axis_m[k], beyond_m);
    const double travel_m = joints[k].prismatic ? std::max(std::abs(from(at)), std::abs(to(at))) : 0.0;
    beyond_m = std::max(state_->from_origin_m[k], beyond_m) + travel_m + joints[k].before.translation().norm();
  }
  return way_m;
}

MoveClearance CollisionChecker::check_move(const Eigen::Ref<const Eigen::VectorXd>& from,
                                           const Eigen::Ref<const Eigen::VectorXd>& to, double step_m) const {
  require_positive("step_m", step_m, "m");
  const double steps = std::max(1.0, std::ceil(longest_way_m(from, to) / step_m));
  if (steps > most_looks) {
    throw InvalidInput("step_m", step_m, "m", fmt::format("must leave at most {:.6g} looks in a move", most_looks));
  }
  MoveClearance out;
  for (int k = 0; k <= static_cast<int>(steps); ++k) {
    const double fraction = k / steps;
    const Clearance here = state_->check((1.0 - fraction) * from + fraction * to, 0.0);
    ++out.looks;
    const bool clear = here.status == Clearance::Status::clear;
    if (k == 0 || !clear || here.distance_m < out.clearance.distance_m) out.clearance = here;
    if (clear) continue;
    out.fraction = fraction;
    return out;
  }
  return out;
}

const std::vector<std::string>& CollisionChecker::notes() const {
  return state_->notes;
}

}  // namespace robomill::robot
