#include "robomill/robot/collision.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <string>
#include <thread>
#include <vector>

#include "robomill/base/random.hpp"
#include "testing/robot/cells.hpp"
#include "testing/support.hpp"

namespace robomill::robot {
namespace collision_test {

using robomill::test::field_of;
using robomill::test::rejection;
using robomill::test::seeds;
using Status = Clearance::Status;
using testing::block_on_table;
using testing::kr210_cell;
using testing::position_at;
constexpr double pi = std::numbers::pi;

/// The tool upright over the block. @param tip_m  in W
Eigen::VectorXd upright(const Cell& cell, const Eigen::Vector3d& tip_m, const Eigen::Vector3d& axis = {0, 0, 1}) {
  return position_at(cell, {.tip_m = tip_m, .axis = axis});
}

// Milled is the block's top: the tip may go down to the tolerance, and its depth is how far it went.
TEST(Collision, FlatCutterGougesByItsDepth) {
  const Cell cell = kr210_cell();
  const CollisionChecker checker(cell, block_on_table(cell));
  for (const double below_m : {-1e-3, 0.0, 49e-6, 51e-6, 1e-3, 4e-3}) {
    const Clearance found = checker.check(upright(cell, {0.02, -0.03, -below_m}));
    if (below_m < 50e-6) {
      EXPECT_EQ(found.status, Status::clear) << found.first << " " << found.second;
      EXPECT_EQ(found.depth_m, 0.0);
    } else {
      EXPECT_EQ(found.status, Status::gouge);
      EXPECT_EQ(found.first, "cutter");
      EXPECT_EQ(found.second, "block");
      EXPECT_NEAR(found.depth_m, below_m, 2e-7);
    }
  }
  // Beside the block, 20 µm and 0.3 mm into its side.
  EXPECT_EQ(checker.check(upright(cell, {0.105 - 20e-6, 0.0, -5e-3})).status, Status::clear);
  const Clearance beside = checker.check(upright(cell, {0.105 - 300e-6, 0.0, -5e-3}));
  EXPECT_EQ(beside.status, Status::gouge);
  EXPECT_NEAR(beside.depth_m, 300e-6, 2e-7);
}

// A flat cutter tilted by θ with its tip h above the plane: its lower corner reaches below. Shrunk by d the corner is
// at (R − d) from the axis and d above the end, so that h − (R − d) sin θ + d cos θ = 0 where it leaves the plane.
TEST(Collision, TiltedCutterGougesWithItsCorner) {
  const Cell cell = kr210_cell();
  const CollisionChecker checker(cell, block_on_table(cell));
  for (const double tilt : {0.05, 0.1, 0.2}) {
    for (const double above_m : {0.0, 0.1e-3, 0.3e-3, 2e-3}) {
      const Clearance found = checker.check(upright(cell, {0.0, 0.0, above_m}, {std::sin(tilt), 0.0, std::cos(tilt)}));
      const double depth_m = (5e-3 * std::sin(tilt) - above_m) / (std::sin(tilt) + std::cos(tilt));
      EXPECT_EQ(found.status, depth_m > 50e-6 ? Status::gouge : Status::clear) << tilt << " " << above_m;
      if (depth_m > 50e-6) {
        EXPECT_NEAR(found.depth_m, depth_m, 3e-7);
      }
    }
  }
}

// What the edges must not touch at all; and what the rest keeps the clearance to.
TEST(Collision, EdgesMustNotEnterFixturesNorTheRestComeNear) {
  const Cell cell = kr210_cell();
  CellGeometry geometry = block_on_table(cell);
  geometry.fixtures.push_back({"clamp", testing::box({0.05, -0.02, 0.0}, {0.09, 0.02, 0.03})});
  geometry.fixtures.push_back({"post", testing::box({-0.09, -0.02, 0.0}, {-0.05, 0.02, 0.055})});
  const CollisionChecker checker(cell, geometry);
  // The edges are 20 mm high and of radius 5 mm, the shank alike up to 50 mm: it passes the clamp's top at 30 mm.
  const Clearance touching = checker.check(upright(cell, {0.05 - 5e-3 - 1e-3, 0.0, 0.0}));
  EXPECT_EQ(touching.status, Status::too_near);
  EXPECT_EQ(touching.first, "clamp");
  EXPECT_EQ(touching.second, "shank");
  EXPECT_NEAR(touching.distance_m, 1e-3, 21e-6);
  EXPECT_EQ(checker.check(upright(cell, {0.05 - 5e-3 - 2.1e-3, 0.0, 0.0})).status, Status::clear);
  // Tipped over the clamp from 12 mm above: the edges alone go in.
  const Clearance inside = checker.check(upright(cell, {0.07, 0.0, 0.03 - 0.5e-3}));
  EXPECT_EQ(inside.status, Status::collision);
  EXPECT_EQ(inside.first, "cutter");
  EXPECT_EQ(inside.second, "clamp");
  EXPECT_NEAR(inside.depth_m, 0.5e-3, 2e-7);
  EXPECT_EQ(inside.distance_m, 0.0);
  EXPECT_EQ(checker.check(upright(cell, {0.07, 0.0, 0.03})).status, Status::clear);
  // Beside the post, which is higher than the shank is long: the holder, 15 mm in radius from 50 mm on, is in it.
  const Clearance holder = checker.check(upright(cell, {-0.05 + 14e-3, 0.0, 0.0}));
  EXPECT_EQ(holder.status, Status::collision);
  EXPECT_EQ(holder.first, "post");
  EXPECT_EQ(holder.second, "holder");
}

TEST(Collision, ForearmThroughATable) {
  const Cell cell = kr210_cell();
  const Eigen::VectorXd position = testing::kr210_posture();
  const Eigen::Vector3d elbow = testing::link_frame(cell.arm, 4, position).translation(),
                        wrist = testing::link_frame(cell.arm, 5, position).translation();
  const Eigen::Vector3d middle = (elbow + wrist) / 2.0, aside = (wrist - elbow).unitOrthogonal();
  CellGeometry geometry = block_on_table(cell);
  geometry.part.clear();
  geometry.fixtures.clear();
  const auto found = [&](const io::TriangleMesh& mesh, double reach_m) {
    geometry.cell = {{"table", mesh}};
    return CollisionChecker(cell, geometry).check(position, reach_m);
  };
  const Eigen::Vector3d half(0.4, 0.4, 0.01);
  const Clearance through = found(testing::box(middle - half, middle + half), 0.0);
  EXPECT_EQ(through.status, Status::collision);
  EXPECT_EQ(through.first, "table");
  EXPECT_EQ(through.second, "link 4");
  // A ball beside it: the distance of the lines less both radii.
  const io::TriangleMesh ball = testing::sphere(middle + 0.3 * aside, 0.05, 4);
  const double facets_m = testing::facets_within_m(ball, middle + 0.3 * aside, 0.05);
  const Clearance beside = found(ball, 0.5);
  EXPECT_EQ(beside.status, Status::clear);
  EXPECT_EQ(beside.second, "link 4");
  EXPECT_NEAR(beside.distance_m, 0.3 - 0.05 - 0.1 + facets_m / 2.0, facets_m / 2.0 + 1e-6);
}

TEST(Collision, KnowsNeighboursPairsToIgnoreAndTheArmItself) {
  const Cell cell = kr210_cell();
  const Eigen::VectorXd position = testing::kr210_posture();
  const auto fat = [](int link) {
    return LinkBody{.link = link, .name = fmt::format("link {}", link), .capsule = Capsule{{0, 0, 0}, {0, 0, 0}, 8.0}};
  };
  CellGeometry geometry{.arm = {}, .tool = testing::end_mill(), .clearance_m = 1e-3};
  const auto status = [&] { return CollisionChecker(cell, geometry).check(position).status; };
  geometry.arm = {fat(5), fat(6)};  // the tool's own link and its neighbour
  EXPECT_EQ(status(), Status::clear);
  geometry.arm = {fat(4)};
  EXPECT_EQ(status(), Status::collision);
  geometry.ignored = {{"link 4", "cutter"}, {"holder", "link 4"}, {"link 4", "shank"}};
  EXPECT_EQ(CollisionChecker(cell, geometry).check(position).first, "spindle");
  geometry.ignored.emplace_back("link 4", "spindle");
  EXPECT_EQ(status(), Status::clear);

  geometry.ignored.clear();
  for (const std::string tool : {"cutter", "shank", "holder", "spindle"}) {
    for (const std::string link : {"link 1", "link 2", "link 3"}) {
      geometry.ignored.emplace_back(tool, link);
    }
  }
  geometry.arm = {fat(1), fat(2), fat(3)};
  EXPECT_EQ(status(), Status::clear);
  geometry.self_collision = true;
  const Clearance self = CollisionChecker(cell, geometry).check(position);
  EXPECT_EQ(self.status, Status::collision);
  EXPECT_EQ(self.first + self.second, "link 1link 3");
}

/// A cell whose bodies have distances in closed form: a ball, a box in W, a box in B, links that are capsules.
struct PlainCell {
  Cell cell = kr210_cell();
  CellGeometry geometry;
  Eigen::Vector3d ball_m = {0.05, 0.02, 0.0};
  double radius_m = 0.12, facets_m = 0.0;
  Eigen::AlignedBox3d plate{Eigen::Vector3d(-0.25, -0.2, -0.15), Eigen::Vector3d(0.25, 0.2, -0.11)};
  Eigen::AlignedBox3d wall{Eigen::Vector3d(1.0, -0.9, 0.0), Eigen::Vector3d(2.2, -0.45, 1.6)};

  PlainCell() {
    geometry = block_on_table(cell);
    const io::TriangleMesh ball = testing::sphere(ball_m, radius_m, 4);
    facets_m = testing::facets_within_m(ball, ball_m, radius_m);
    geometry.part = {{"ball", ball}};
    geometry.fixtures = {{"plate", testing::box(plate.min(), plate.max())}};
    geometry.cell = {{"wall", testing::box(wall.min(), wall.max())}};
  }
  /// Of a point of B from all that stands, the ball round. < 0 in the ball alone.
  [[nodiscard]] double from_standing_m(const Eigen::Vector3d& at) const {
    const Eigen::Vector3d in_w = cell.workpiece.inverse() * at;
    return std::min({(in_w - ball_m).norm() - radius_m, plate.exteriorDistance(in_w), wall.exteriorDistance(at)});
  }
};

constexpr double sample_m = 6e-3;  // no point of a surface is farther than this from a sample of it

/// Points of a solid of revolution's surface, in E.
void sample_section(double low_m, double high_m, double low_r_m, double high_r_m, double tool_length_m,
                    std::vector<Eigen::Vector3d>& out) {
  const auto ring = [&](double height_m, double r_m) {
    const int n = std::max(1, static_cast<int>(std::ceil(2.0 * pi * r_m / sample_m)));
    for (int k = 0; k < n; ++k) {
      out.emplace_back(r_m * std::cos(2.0 * pi * k / n), r_m * std::sin(2.0 * pi * k / n), tool_length_m - height_m);
    }
  };
  const auto disc = [&](double height_m, double r_m) {
    const int n = static_cast<int>(std::ceil(r_m / sample_m));
    for (int k = 0; k <= n; ++k) ring(height_m, r_m * k / n);
  };
  disc(low_m, low_r_m);
  disc(high_m, high_r_m);
  const int n = static_cast<int>(std::ceil((high_m - low_m) / sample_m));
  for (int k = 0; k <= n; ++k) ring(low_m + (high_m - low_m) * k / n, low_r_m + (high_r_m - low_r_m) * k / n);
}

std::vector<Eigen::Vector3d> sample_tool(const Cell& cell, const ToolGeometry& tool) {
  std::vector<Eigen::Vector3d> out;
  const double shank_m = tool.edges.back().radius_m;
  double height_m = tool.stickout_m;
  sample_section(tool.edges.back().height_m, height_m, shank_m, shank_m, cell.tool_length_m, out);
  for (const auto* list : {&tool.holder, &tool.spindle}) {
    for (const ToolSection& section : *list) {
      sample_section(height_m, height_m + section.length_m, section.lower_diameter_m / 2.0,
                     section.upper_diameter_m / 2.0, cell.tool_length_m, out);
      height_m += section.length_m;
    }
  }
  return out;
}

double to_segment_m(const Eigen::Vector3d& at, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const double t = std::clamp((at - a).dot(b - a) / std::max(1e-30, (b - a).squaredNorm()), 0.0, 1.0);
  return (at - a - t * (b - a)).norm();
}

/// The least distance that points of all that is checked have, 0 where one is inside another body; without the edges.
double by_points_m(const PlainCell& plain, const std::vector<Eigen::Vector3d>& tool, const Eigen::VectorXd& position) {
  double out = std::numeric_limits<double>::infinity();
  const Eigen::Isometry3d flange = forward(plain.cell.arm, position);
  for (const LinkBody& body : plain.geometry.arm) {
    const Eigen::Isometry3d frame = testing::link_frame(plain.cell.arm, body.link, position);
    const Eigen::Vector3d from = frame * body.capsule->from_m, to = frame * body.capsule->to_m;
    const double radius_m = body.capsule->diameter_m / 2.0;
    const int n = 1 + static_cast<int>((to - from).norm() / sample_m);
    for (int k = 0; k <= n && body.link > 0; ++k) {
      out = std::min(out, plain.from_standing_m(from + (to - from) * (k / double(n))) - radius_m);
    }
    if (body.link > 4) continue;
    for (const Eigen::Vector3d& point : tool) out = std::min(out, to_segment_m(flange * point, from, to) - radius_m);
  }
  for (const Eigen::Vector3d& point : tool) out = std::min(out, plain.from_standing_m(flange * point));
  return std::max(0.0, out);
}

/// A tool over the ball, the plate or the wall, in any attitude that mills.
Eigen::VectorXd random_stand(const PlainCell& plain, Random& random) {
  for (;;) {
    const double tilt = random.uniform(0.0, 1.2), turn = random.uniform(-pi, pi);
    const ToolPose pose{.tip_m = {random.uniform(-0.3, 0.3), random.uniform(-0.5, 0.3), random.uniform(-0.1, 0.3)},
                        .axis = {std::sin(tilt) * std::cos(turn), std::sin(tilt) * std::sin(turn), std::cos(tilt)},
                        .gamma_rad = random.uniform(-pi, pi)};
    Eigen::VectorXd out = position_at(plain.cell, pose, random.index(8));
    if (out.size() > 0) return out;
  }
}

// Points of every body against the other bodies' closed forms: none may be nearer than what the check says, and one
// must be nearly as near.
TEST(Collision, AgreesWithPointsOfAllBodies) {
  const PlainCell plain;
  const CollisionChecker checker(plain.cell, plain.geometry);
  const std::vector<Eigen::Vector3d> tool = sample_tool(plain.cell, plain.geometry.tool);
  Random random(11);
  int collisions = 0, near = 0, apart = 0;
  for (int k = 0; k < seeds(2000); ++k) {
    const Eigen::VectorXd position = k % 4 == 0 ? testing::random_position(random, 6) : random_stand(plain, random);
    const Clearance found = checker.check(position, 5.0);
    if (found.first == "cutter" || found.depth_m > 0.0) continue;  // of the edges: below
    const double expected_m = by_points_m(plain, tool, position);
    ASSERT_LE(found.distance_m, expected_m + plain.facets_m + 1e-6) << k << " " << found.first << " " << found.second;
    if (found.status == Status::collision) {
      // Surfaces may cut each other between two samples.
      ASSERT_LE(expected_m, sample_m) << k << " " << found.first << " " << found.second;
      ++collisions;
    } else {
      ASSERT_GE(found.distance_m, expected_m - sample_m) << k << " " << found.first << " " << found.second;
      EXPECT_EQ(found.status == Status::too_near, found.distance_m < 2e-3);
      (expected_m < 0.1 ? near : apart) += 1;
    }
    // A shorter look says the same of what is within it.
    const Clearance shorter = checker.check(position);
    if (found.status == Status::clear) {
      EXPECT_EQ(shorter.status, Status::clear);
    }
    if (found.status == Status::too_near) {
      EXPECT_EQ(shorter.distance_m, found.distance_m);
    }
  }
  EXPECT_GT(collisions, seeds(2000) / 10);
  EXPECT_GT(near, seeds(2000) / 10);
  EXPECT_GT(apart, seeds(2000) / 20);
}

// The depth of points of the ball in the cylinder that the edges sweep, in closed form.
TEST(Collision, DepthsAgreeWithPointsOfThePart) {
  PlainCell plain;
  plain.geometry.arm.clear();
  plain.geometry.tool.holder.clear();
  plain.geometry.tool.spindle.clear();
  plain.geometry.tool.stickout_m = plain.geometry.tool.edges.back().height_m;
  const CollisionChecker checker(plain.cell, plain.geometry);
  Random random(12);
  int gouges = 0;
  for (int k = 0; k < seeds(1000); ++k) {
    const Eigen::Vector3d out = testing::random_vector(random).normalized();
    const Eigen::Vector3d axis = (out + 0.7 * testing::random_vector(random).normalized()).normalized();
    const ToolPose pose{.tip_m = plain.ball_m + (plain.radius_m + random.uniform(-3e-3, 3e-3)) * out, .axis = axis};
    if (pose.tip_m.z() < 0.02 || axis.z() < 0.1) continue;  // away from the plate, within reach
    const Eigen::VectorXd position = position_at(plain.cell, pose);
    if (position.size() == 0) continue;
    double expected_m = 0.0;  // of the ball's points in the cylinder
    constexpr int n = 40;
    for (int i = 0; i <= n; ++i) {
      for (int j = 0; j < n; ++j) {
        for (int m = 0; m <= n; ++m) {
          const double r = 5e-3 * i / n, angle = 2.0 * pi * j / n, height = 20e-3 * m / n;
          const Eigen::Vector3d u = axis.unitOrthogonal(), v = axis.cross(u);
          const Eigen::Vector3d at = pose.tip_m + height * axis + r * (std::cos(angle) * u + std::sin(angle) * v);
          if ((at - plain.ball_m).norm() > plain.radius_m) continue;
          expected_m = std::max(expected_m, std::min({5e-3 - r, height, 20e-3 - height}));
        }
      }
    }
    const Clearance found = checker.check(position);
    const double spacing_m = 0.8e-3;
    if (expected_m > plain.facets_m + 100e-6) {
      ASSERT_EQ(found.status, Status::gouge) << k;
      EXPECT_NEAR(found.depth_m, expected_m, spacing_m);
      ++gouges;
    } else if (found.status == Status::gouge) {
      EXPECT_LE(found.depth_m, spacing_m);
    }
  }
  EXPECT_GT(gouges, seeds(1000) / 10);
}

TEST(Collision, DoesNotDependOnWhereTheCellStands) {
  const PlainCell plain;
  const CollisionChecker here(plain.cell, plain.geometry);
  Random random(13);
  const Eigen::Isometry3d move = testing::random_pose(random, 3.0);
  PlainCell elsewhere = plain;
  elsewhere.cell.workpiece = move * plain.cell.workpiece;
  elsewhere.cell.arm.joints.front().before = move * plain.cell.arm.joints.front().before;
  for (Body& body : elsewhere.geometry.cell) body.mesh = testing::moved(body.mesh, move);
  for (LinkBody& body : elsewhere.geometry.arm) {
    if (body.link == 0) body.pose = move * body.pose;
  }
  const CollisionChecker there(elsewhere.cell, elsewhere.geometry);
  int statuses[4] = {0, 0, 0, 0};
  for (int k = 0; k < seeds(2000); ++k) {
    Eigen::VectorXd position = random_stand(plain, random);
    if (k % 2 == 0) {  // a tip in the ball
      const Eigen::Vector3d out = (Eigen::Vector3d(0, 0, 1.5) + testing::random_vector(random)).normalized();
      const Eigen::VectorXd milling = position_at(
          plain.cell, {.tip_m = plain.ball_m + (plain.radius_m - random.uniform(0.0, 3e-3)) * out, .axis = out});
      if (milling.size() > 0) position = milling;
    }
    const Clearance a = here.check(position, 0.3), b = there.check(position, 0.3);
    EXPECT_EQ(a.status, b.status);
    EXPECT_NEAR(a.distance_m, b.distance_m, 1e-9);
    EXPECT_NEAR(a.depth_m, b.depth_m, 2e-7);
    ++statuses[static_cast<std::size_t>(a.status)];
  }
  for (const Status status : {Status::clear, Status::gouge, Status::collision}) {
    EXPECT_GT(statuses[static_cast<std::size_t>(status)], 0);
  }
}

TEST(Collision, GivesTheSameInSeveralThreads) {
  const PlainCell plain;
  const CollisionChecker checker(plain.cell, plain.geometry);
  Random random(14);
  std::vector<Eigen::VectorXd> positions;
  for (int k = 0; k < 200; ++k) positions.push_back(random_stand(plain, random));
  std::vector<Clearance> one, four(positions.size());
  for (const Eigen::VectorXd& position : positions) one.push_back(checker.check(position, 0.2));
  {
    std::vector<std::jthread> threads;
    for (std::size_t first = 0; first < 4; ++first) {
      threads.emplace_back([&, first] {
        for (std::size_t i = first; i < positions.size(); i += 4) four[i] = checker.check(positions[i], 0.2);
      });
    }
  }
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].status, four[i].status);
    EXPECT_EQ(one[i].first + one[i].second, four[i].first + four[i].second);
    EXPECT_EQ(one[i].distance_m, four[i].distance_m);
    EXPECT_EQ(one[i].depth_m, four[i].depth_m);
  }
}

// With a clearance of half a step, a move whose looks are clear has no collision at any of 500 positions between.
TEST(Collision, MovesMissNoCollisionBetweenTheirLooks) {
  PlainCell plain;
  plain.geometry.part.clear();  // gouges are no matter of clearance
  plain.geometry.clearance_m = 10e-3;
  const CollisionChecker checker(plain.cell, plain.geometry);
  Random random(15);
  int clear = 0, stopped = 0;
  for (int k = 0; k < seeds(2000); ++k) {
    const Eigen::VectorXd from = random_stand(plain, random);
    const Eigen::VectorXd to = from + 0.3 * Eigen::VectorXd::NullaryExpr(6, [&] { return random.uniform(-1.0, 1.0); });
    if (checker.check(from).status != Status::clear) continue;
    const MoveClearance move = checker.check_move(from, to, 20e-3);
    double least_m = 1.0;
    for (int i = 0; i <= 500; ++i) {
      const Clearance between = checker.check(from + i / 500.0 * move.fraction * (to - from));
      const bool before_stop = i < 500 || move.fraction == 1.0;
      // The edges have no clearance: they are seen at a look alone.
      if (before_stop && between.first != "cutter") {
        EXPECT_NE(between.status, Status::collision) << k << " " << i;
      }
      least_m = std::min(least_m, between.distance_m);
    }
    if (move.clearance.status == Status::clear) {
      EXPECT_EQ(move.fraction, 1.0);
      EXPECT_GE(move.clearance.distance_m, least_m - 1e-12);
      ++clear;
    } else {
      EXPECT_EQ(checker.check((1.0 - move.fraction) * from + move.fraction * to).status, move.clearance.status);
      ++stopped;
    }
  }
  EXPECT_GT(clear, seeds(2000) / 20);
  EXPECT_GT(stopped, seeds(2000) / 20);
}

// Of arms of any kind: the way that points of the bodies really go, as a sum over short pieces.
TEST(Collision, NoPointGoesFartherThanTheLongestWay) {
  Random random(16);
  for (int k = 0; k < seeds(300); ++k) {
    Cell cell = kr210_cell();
    if (k % 2 == 1) cell.arm = testing::random_chain(random, 1 + static_cast<int>(random.index(7)));
    const auto joints = static_cast<int>(cell.arm.size());
    CellGeometry geometry{.tool = testing::end_mill(), .clearance_m = 0.0};
    const Eigen::Isometry3d pose = testing::random_pose(random, 0.2);
    const int link = 1 + static_cast<int>(random.index(static_cast<std::uint64_t>(joints)));
    const io::TriangleMesh mesh = testing::random_triangles(random, 5, 0.3, 0.1);
    geometry.arm = {{.link = link, .name = "link", .pose = pose, .mesh = mesh}};
    const CollisionChecker checker(cell, geometry);
    const Eigen::VectorXd from = testing::random_position(random, joints),
                          to = from + 0.5 * Eigen::VectorXd(testing::random_position(random, joints));
    const double bound_m = checker.longest_way_m(from, to);
    const Eigen::Vector3d on_tool(0.075, 0.0, cell.tool_length_m - 0.33);  // the spindle's rim
    std::vector<double> way_m(mesh.vertices_m.size() + 1, 0.0);
    std::vector<Eigen::Vector3d> before;
    for (int i = 0; i <= 400; ++i) {
      const Eigen::VectorXd here = from + (to - from) * (i / 400.0);
      const Eigen::Isometry3d frame = testing::link_frame(cell.arm, link, here) * pose;
      std::vector<Eigen::Vector3d> points = {forward(cell.arm, here) * on_tool};
      for (const Eigen::Vector3d& vertex : mesh.vertices_m) points.emplace_back(frame * vertex);
      for (std::size_t p = 0; i > 0 && p < points.size(); ++p) way_m[p] += (points[p] - before[p]).norm();
      before = std::move(points);
    }
    EXPECT_LE(*std::ranges::max_element(way_m), bound_m);
    if (k % 2 == 0) {
      EXPECT_LE(bound_m, 40.0 * way_m[0] + 10.0);
    }
    const MoveClearance move = checker.check_move(from, to, bound_m / 9.5);
    if (move.fraction == 1.0) {
      EXPECT_EQ(move.looks, 11);
    }
  }
}

TEST(Collision, MovesStopAtTheFirstLookThatIsNotClear) {
  const Cell cell = kr210_cell();
  const CollisionChecker checker(cell, block_on_table(cell));
  const Eigen::VectorXd above = upright(cell, {0, 0, 0.1}), below = upright(cell, {0, 0, -0.06});
  const MoveClearance down = checker.check_move(above, below, 1e-3);
  EXPECT_EQ(down.clearance.status, Status::gouge);
  EXPECT_NEAR(down.fraction, 0.1 / 0.16, 0.02);
  EXPECT_GT(down.looks, 100);
  const MoveClearance stay = checker.check_move(above, above, 1e-3);
  EXPECT_EQ(stay.looks, 2);
  EXPECT_EQ(stay.clearance.status, Status::clear);
  EXPECT_EQ(field_of([&] { static_cast<void>(checker.check_move(above, below, 0.0)); }), "step_m");
  EXPECT_EQ(field_of([&] { static_cast<void>(checker.check_move(above, below, 1e-9)); }), "step_m");
}

TEST(Collision, SaysWhichMeshesAreOpen) {
  const Cell cell = kr210_cell();
  CellGeometry geometry = block_on_table(cell);
  EXPECT_TRUE(CollisionChecker(cell, geometry).notes().empty());
  geometry.part.front().mesh.triangles.pop_back();
  const CollisionChecker checker(cell, geometry);
  ASSERT_EQ(checker.notes().size(), 1U);
  EXPECT_NE(checker.notes().front().find("block is not closed, 3 of its edges"), std::string::npos);
  EXPECT_EQ(checker.check(upright(cell, {0.02, -0.03, -1e-3})).status, Status::gouge);
}

TEST(Collision, RejectsWhatCannotBe) {
  const Cell cell = kr210_cell();
  const CellGeometry good = block_on_table(cell);
  const auto field = [&](const std::function<void(CellGeometry&)>& change) {
    CellGeometry geometry = good;
    change(geometry);
    return field_of([&] { static_cast<void>(CollisionChecker(cell, geometry)); });
  };
  EXPECT_EQ(field([](CellGeometry&) {}), "accepted");
  EXPECT_EQ(field([](CellGeometry& g) { g.clearance_m = -1.0; }), "clearance_m");
  EXPECT_EQ(field([](CellGeometry& g) { g.gouge_tolerance_m = std::nan(""); }), "gouge_tolerance_m");
  EXPECT_EQ(field([](CellGeometry& g) { g.part.front().mesh.triangles.clear(); }), "part[1].mesh");
  EXPECT_EQ(field([](CellGeometry& g) { g.cell.front().mesh.triangles.front()[1] = 8; }), "cell[1].mesh");
  EXPECT_EQ(field([](CellGeometry& g) { g.fixtures.front().mesh.vertices_m[3].z() = NAN; }), "fixtures[1].mesh");
  EXPECT_EQ(field([](CellGeometry& g) { g.fixtures.front().name = "block"; }), "name");
  EXPECT_EQ(field([](CellGeometry& g) { g.fixtures.front().name = "holder"; }), "name");
  EXPECT_EQ(field([](CellGeometry& g) { g.arm[1].link = 7; }), "arm[2].link");
  EXPECT_EQ(field([](CellGeometry& g) { g.arm[1].capsule.reset(); }), "arm[2].mesh");
  EXPECT_EQ(field([](CellGeometry& g) { g.arm[1].capsule->diameter_m = 0.0; }), "arm[2].capsule.diameter_m");
  EXPECT_EQ(field([](CellGeometry& g) { g.tool.edges.clear(); }), "tool.edges");
  EXPECT_EQ(field([](CellGeometry& g) { g.tool.edges.front().height_m = 1e-3; }), "tool.edges[1].height_m");
  EXPECT_EQ(field([](CellGeometry& g) { g.tool.edges = {{0, 5e-3}, {5e-3, 3e-3}, {20e-3, 5e-3}}; }), "tool.edges[3]");
  EXPECT_EQ(field([](CellGeometry& g) {
              g.tool.edges = {{0, 5e-3}, {20e-3, 5e-3}, {19e-3, 5e-3}};
            }),
            "tool.edges[3].height_m");
  EXPECT_EQ(field([](CellGeometry& g) { g.tool.stickout_m = 19e-3; }), "tool.stickout_m");
  EXPECT_EQ(field([](CellGeometry& g) { g.tool.holder[1].length_m = 0.0; }), "tool.holder[2].length_m");
  EXPECT_EQ(field([](CellGeometry& g) { g.ignored = {{"link 2", "spindel"}}; }), "ignored[1]");
  EXPECT_EQ(field([](CellGeometry& g) { g = {.tool = g.tool, .clearance_m = 0.0}; }), "part");
  const CollisionChecker checker(cell, good);
  EXPECT_EQ(field_of([&] { static_cast<void>(checker.check(Eigen::VectorXd::Zero(5))); }), "position");
  EXPECT_EQ(field_of([&] { static_cast<void>(checker.check(Eigen::VectorXd::Constant(6, NAN))); }), "position");
}

}  // namespace collision_test
}  // namespace robomill::robot
