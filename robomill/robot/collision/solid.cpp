#include "robomill/robot/collision/solid.hpp"

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/math/bv/OBBRSS.h>
#include <fcl/narrowphase/distance.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "robomill/robot/collision/revolution.hpp"

namespace robomill::robot {
namespace {

using TreeModel = fcl::BVHModel<fcl::OBBRSS<double>>;

// FCL takes triangles below 3e-8 units² for lines: in metres, those of 0.2 mm. Its meshes are in millimetres.
constexpr double fcl_per_m = 1e3;
constexpr double contact_m = 1e-9;     // what FCL is asked for at least: it wants a distance above 0
constexpr double line_width_m = 1e-7;  // of a capsule's line, which to FCL is a triangle

Eigen::Isometry3d in_fcl_units(Eigen::Isometry3d pose) {
  pose.translation() *= fcl_per_m;
  return pose;
}

io::TriangleMesh line_mesh(const Capsule& capsule) {
  const Eigen::Vector3d along = capsule.to_m - capsule.from_m;
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();
  if (along.norm() > line_width_m) direction = along.normalized();
  const Eigen::Vector3d end = along.norm() > line_width_m ? capsule.to_m : capsule.from_m + line_width_m * direction;
  return {.vertices_m = {capsule.from_m, end, end + line_width_m * direction.unitOrthogonal()},
          .triangles = {{0, 1, 2}}};
}

/// A vertex of every connected piece of a mesh.
std::vector<Eigen::Vector3d> pieces_m(const io::TriangleMesh& mesh) {
  std::vector<std::uint32_t> up(mesh.vertices_m.size());  // towards the piece's first vertex
  std::iota(up.begin(), up.end(), 0U);
  const auto first = [&](std::uint32_t vertex) {
    while (up[vertex] != vertex) vertex = up[vertex] = up[up[vertex]];
    return vertex;
  };
  for (const auto& triangle : mesh.triangles) {
    for (std::size_t i = 1; i < 3; ++i) up[first(triangle[i])] = first(triangle[0]);
  }
  std::vector<bool> seen(up.size(), false);
  std::vector<Eigen::Vector3d> out;
  for (const auto& triangle : mesh.triangles) {
    const std::uint32_t piece = first(triangle[0]);
    if (!seen[piece]) out.push_back(mesh.vertices_m[piece]);
    seen[piece] = true;
  }
  return out;
}

}  // namespace

struct Solid::Tree {
  TreeModel model;
  explicit Tree(const io::TriangleMesh& mesh) {
    std::vector<fcl::Vector3d> vertices;
    vertices.reserve(mesh.vertices_m.size());
    for (const Eigen::Vector3d& vertex : mesh.vertices_m) vertices.emplace_back(fcl_per_m * vertex);
    std::vector<fcl::Triangle> triangles;
    triangles.reserve(mesh.triangles.size());
    for (const auto& triangle : mesh.triangles) triangles.emplace_back(triangle[0], triangle[1], triangle[2]);
    model.beginModel(static_cast<int>(triangles.size()), static_cast<int>(vertices.size()));
    model.addSubModel(vertices, triangles);
    model.endModel();
  }
  [[nodiscard]] std::array<Eigen::Vector3d, 3> corners_m(int triangle) const {
    std::array<Eigen::Vector3d, 3> out;
    for (std::size_t i = 0; i < 3; ++i) {
      out[i] = model.vertices[model.tri_indices[triangle][static_cast<int>(i)]] / fcl_per_m;
    }
    return out;
  }
};

Solid::Solid(io::TriangleMesh mesh)
    : mesh_(std::make_unique<const io::TriangleMesh>(std::move(mesh))), tree_(std::make_unique<const Tree>(*mesh_)) {
  for (const Eigen::Vector3d& vertex : mesh_->vertices_m) box_.extend(vertex);
  const Eigen::Vector3d center = box_.center();
  for (const Eigen::Vector3d& vertex : mesh_->vertices_m) radius_m_ = std::max(radius_m_, (vertex - center).norm());
  pieces_m_ = pieces_m(*mesh_);
  open_edges_ = robot::open_edges(*mesh_);
  if (open_edges_ == 0) inside_ = std::make_unique<const InsideTest>(*mesh_);
}

Solid::Solid(const Capsule& capsule) : Solid(line_mesh(capsule)) {
  open_edges_ = 0;  // nothing can be inside a line, and what is inside the capsule is near it
  rounding_m_ = capsule.diameter_m / 2.0;
}

Solid::~Solid() = default;
Solid::Solid(Solid&&) noexcept = default;

double Solid::bound_m(const Solid& other, const Eigen::Isometry3d& other_pose) const {
  const Eigen::Vector3d there = other_pose * other.box_.center(), here = other_pose.inverse() * box_.center();
  const double apart =
      std::max(box_.exteriorDistance(there) - other.radius_m_, other.box_.exteriorDistance(here) - radius_m_);
  return std::max(0.0, apart - rounding_m_ - other.rounding_m_);
}

double Solid::farthest_m(const Eigen::Isometry3d& pose) const {
  double out = 0.0;
  for (const Eigen::Vector3d& vertex : mesh_->vertices_m) out = std::max(out, (pose * vertex).norm());
  return out + rounding_m_;
}

double Solid::farthest_m(const Eigen::Isometry3d& pose, const Eigen::Vector3d& line) const {
  double out = 0.0;
  for (const Eigen::Vector3d& vertex : mesh_->vertices_m) out = std::max(out, line.cross(pose * vertex).norm());
  return out + rounding_m_;
}

bool Solid::contains_piece(const Solid& other, const Eigen::Isometry3d& other_pose) const {
  return inside_ && std::ranges::any_of(other.pieces_m_, [&](const Eigen::Vector3d& at_m) {
           return inside_->inside(other_pose * at_m);
         });
}

double Solid::distance_m(const Solid& other, const Eigen::Isometry3d& other_pose, double within_m) const {
  const double rounding_m = rounding_m_ + other.rounding_m_;
  fcl::DistanceResultd result(fcl_per_m * std::max(within_m + rounding_m, contact_m));
  fcl::distance(&tree_->model, fcl::Transform3d::Identity(), &other.tree_->model, in_fcl_units(other_pose),
                fcl::DistanceRequestd(), result);
  const double apart_m = result.min_distance / fcl_per_m - rounding_m;
  if (apart_m <= 0.0) return 0.0;
  if (contains_piece(other, other_pose) || other.contains_piece(*this, other_pose.inverse())) return 0.0;
  return std::min(apart_m, within_m);
}

double Solid::depth_in_m(const ConvexRevolution& cutter, const Eigen::Isometry3d& pose, double above_m) const {
  if (contains(pose.inverse() * cutter.deepest_m())) return cutter.greatest_depth_m();
  double best = above_m;
  const TreeModel& model = tree_->model;
  const auto bound = [&](int node) {
    const fcl::OBB<double>& box = model.getBV(node).bv.obb;
    const Eigen::Matrix3d half = pose.linear() * box.axis * (box.extent / fcl_per_m).asDiagonal();
    return cutter.bound_over_box_m(pose * (box.To / fcl_per_m), half);
  };
  struct Open {
    int node;
    double bound_m;
  };
  std::vector<Open> open = {{0, bound(0)}};
  while (!open.empty()) {
    const Open at = open.back();
    open.pop_back();
    if (at.bound_m <= best) continue;
    const auto& node = model.getBV(at.node);
    if (node.isLeaf()) {
      std::array<Eigen::Vector3d, 3> corners = tree_->corners_m(node.primitiveId());
      for (Eigen::Vector3d& corner : corners) corner = pose * corner;
      best = std::max(best, cutter.most_over_triangle_m(corners, best));
      continue;
    }
    Open left{node.leftChild(), bound(node.leftChild())}, right{node.rightChild(), bound(node.rightChild())};
    if (left.bound_m > right.bound_m) std::swap(left, right);  // the better one is looked at first
    open.push_back(left);
    open.push_back(right);
  }
  return best;
}

}  // namespace robomill::robot
