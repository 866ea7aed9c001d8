#include "robomill/robot/collision/solid.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/robot/collision/inside.hpp"
#include "robomill/robot/collision/revolution.hpp"
#include "testing/robot/arms.hpp"
#include "testing/robot/solids.hpp"
#include "testing/support.hpp"

namespace robomill::robot {
namespace solid_test {

using robomill::test::seeds;
using testing::box;
using testing::random_pose;
using testing::random_vector;

using Triangle = std::array<Eigen::Vector3d, 3>;

double to_segment_m(const Eigen::Vector3d& at, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const double t = std::clamp((at - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  return (at - a - t * (b - a)).norm();
}

/// Distance of two segments: of their lines where both nearest points are within, else at an end.
double segments_m(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                  const Eigen::Vector3d& d) {
  double out = std::min({to_segment_m(a, c, d), to_segment_m(b, c, d), to_segment_m(c, a, b), to_segment_m(d, a, b)});
  Eigen::Matrix<double, 3, 2> along;
  along << b - a, c - d;
  const Eigen::Vector2d st = (along.transpose() * along).ldlt().solve(along.transpose() * (c - a));
  if ((st.array() > 0.0).all() && (st.array() < 1.0).all()) out = std::min(out, (along * st - (c - a)).norm());
  return out;
}

/// Where a point's foot on the triangle's plane is within it, its distance to the plane.
double to_face_m(const Eigen::Vector3d& at, const Triangle& of) {
  Eigen::Matrix<double, 3, 2> along;
  along << of[1] - of[0], of[2] - of[0];
  const Eigen::Vector2d uv = along.householderQr().solve(at - of[0]);
  if (uv.minCoeff() < 0.0 || uv.sum() > 1.0) return std::numeric_limits<double>::infinity();
  return (along * uv - (at - of[0])).norm();
}

bool pierces(const Eigen::Vector3d& from, const Eigen::Vector3d& to, const Triangle& of) {
  Eigen::Matrix3d columns;
  columns << of[1] - of[0], of[2] - of[0], from - to;
  const Eigen::Vector3d uvt = columns.partialPivLu().solve(from - of[0]);
  return uvt.minCoeff() >= 0.0 && uvt.x() + uvt.y() <= 1.0 && uvt.z() <= 1.0;
}

/// From the definition: faces against corners, edges against edges.
double triangles_m(const Triangle& a, const Triangle& b) {
  double out = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < 3; ++i) {
    const Eigen::Vector3d &a0 = a[i], &a1 = a[(i + 1) % 3], &b0 = b[i], &b1 = b[(i + 1) % 3];
    if (pierces(a0, a1, b) || pierces(b0, b1, a)) return 0.0;
    out = std::min({out, to_face_m(a0, b), to_face_m(b0, a)});
    for (std::size_t j = 0; j < 3; ++j) out = std::min(out, segments_m(a0, a1, b[j], b[(j + 1) % 3]));
  }
  return out;
}

Triangle corners(const io::TriangleMesh& mesh, std::size_t i) {
  const auto& [a, b, c] = mesh.triangles[i];
  return {mesh.vertices_m[a], mesh.vertices_m[b], mesh.vertices_m[c]};
}

double meshes_m(const io::TriangleMesh& a, const io::TriangleMesh& b) {
  double out = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < a.triangles.size(); ++i) {
    for (std::size_t j = 0; j < b.triangles.size(); ++j) {
      out = std::min(out, triangles_m(corners(a, i), corners(b, j)));
    }
  }
  return out;
}

// Sizes from 10 µm, below which FCL in metres would take triangles for lines, to 1 m.
TEST(Solid, DistancesOfRandomMeshesAreThoseOfAllPairsOfTriangles) {
  Random random(1);
  int apart = 0;
  for (int k = 0; k < seeds(4000); ++k) {
    const double size_m = std::pow(10.0, random.uniform(-5.0, 0.0));
    const int count = 1 + static_cast<int>(random.index(30));
    const io::TriangleMesh a = testing::random_triangles(random, count, size_m, 0.3 * size_m),
                           b = testing::random_triangles(random, count, size_m, 0.3 * size_m);
    const Eigen::Isometry3d pose = random_pose(random, 1.5 * size_m);
    const double expected_m = meshes_m(a, testing::moved(b, pose));
    const Solid first(a), second(b);
    const double found_m = first.distance_m(second, pose, 10.0);
    ASSERT_NEAR(found_m, expected_m, 1e-9 * size_m + 1e-13) << k;
    EXPECT_LE(first.bound_m(second, pose), expected_m + 1e-12);
    // A limit cuts off what is farther, and nothing else.
    EXPECT_NEAR(first.distance_m(second, pose, 0.7 * expected_m), 0.7 * expected_m, 1e-12);
    if (expected_m > 0.0) {
      EXPECT_NEAR(first.distance_m(second, pose, 1.3 * expected_m), expected_m, 1e-9 * size_m + 1e-13);
      ++apart;
    }
  }
  EXPECT_GT(apart, seeds(4000) / 5);
}

// A capsule and a sphere: the distance of a point to a line less both radii. The sphere's facets lie inside it.
TEST(Solid, CapsuleAndSphereAreAsFarAsTheClosedForm) {
  Random random(2);
  const double sphere_m = 0.08;
  const io::TriangleMesh mesh = testing::sphere({0.1, -0.2, 0.3}, sphere_m, 4);
  const double facets_m = testing::facets_within_m(mesh, {0.1, -0.2, 0.3}, sphere_m);
  const Solid sphere(mesh);
  for (int k = 0; k < seeds(3000); ++k) {
    const Capsule capsule{.from_m = 0.3 * random_vector(random),
                          .to_m = 0.3 * random_vector(random),
                          .diameter_m = random.uniform(0.01, 0.2)};
    const Eigen::Isometry3d pose = random_pose(random, 0.2);
    const double expected_m = to_segment_m({0.1, -0.2, 0.3}, pose * capsule.from_m, pose * capsule.to_m) - sphere_m -
                              capsule.diameter_m / 2.0;
    const double found_m = sphere.distance_m(Solid(capsule), pose, 10.0);
    EXPECT_GE(found_m, std::max(0.0, expected_m - 2e-7));
    EXPECT_LE(found_m, std::max(0.0, expected_m + facets_m));
  }
}

// Two capsules, also such as are parallel or shrunk to a ball.
TEST(Solid, CapsulesAreAsFarAsTheClosedForm) {
  Random random(3);
  for (int k = 0; k < seeds(3000); ++k) {
    Capsule a{random_vector(random), random_vector(random), random.uniform(0.01, 0.5)};
    Capsule b{random_vector(random), random_vector(random), random.uniform(0.01, 0.5)};
    if (k % 3 == 1) b.to_m = b.from_m;
    if (k % 3 == 2) b.to_m = b.from_m + 2.0 * (a.to_m - a.from_m);
    const double expected_m =
        (k % 3 == 1 ? to_segment_m(b.from_m, a.from_m, a.to_m) : segments_m(a.from_m, a.to_m, b.from_m, b.to_m)) -
        (a.diameter_m + b.diameter_m) / 2.0;
    EXPECT_NEAR(Solid(a).distance_m(Solid(b), Eigen::Isometry3d::Identity(), 10.0), std::max(0.0, expected_m), 4e-7);
  }
}

// A cylinder against a ball: the distance of a point to a cylinder in closed form; the mesh stands off 20 µm at most.
TEST(Solid, CylindersStandOffByTheExcessAtMost) {
  Random random(4);
  for (int k = 0; k < seeds(2000); ++k) {
    const double radius_m = random.uniform(0.002, 0.1), height_m = random.uniform(0.01, 0.3);
    const Solid cylinder(revolve({{0.0, radius_m}, {height_m, radius_m}}, 20e-6));
    const Eigen::Vector3d at_m = 0.3 * random_vector(random);
    const Solid ball(Capsule{at_m, at_m, 1e-3});
    const double beside_m = std::max(0.0, std::hypot(at_m.x(), at_m.y()) - radius_m),
                 above_m = std::max({0.0, at_m.z() - height_m, -at_m.z()});
    const double expected_m = std::max(0.0, std::hypot(beside_m, above_m) - 0.5e-3);
    const double found_m = cylinder.distance_m(ball, Eigen::Isometry3d::Identity(), 10.0);
    EXPECT_LE(found_m, expected_m + 2e-7);
    EXPECT_GE(found_m, expected_m - 20.2e-6);
  }
}

TEST(Solid, SeesWhatIsInsideAClosedMesh) {
  const Solid block(box({-1, -1, -1}, {1, 1, 1})), pea(testing::sphere({0.3, 0.2, 0.1}, 0.05, 1));
  const Solid line(Capsule{{0, 0, 0}, {0.5, 0, 0}, 0.1});
  EXPECT_EQ(block.distance_m(pea, Eigen::Isometry3d::Identity(), 0.01), 0.0);
  EXPECT_EQ(pea.distance_m(block, Eigen::Isometry3d::Identity(), 0.01), 0.0);
  EXPECT_EQ(block.distance_m(line, Eigen::Isometry3d::Identity(), 0.01), 0.0);
  EXPECT_EQ(line.distance_m(block, Eigen::Isometry3d::Identity(), 0.01), 0.0);

  // Two pieces of one mesh, of which the second is inside.
  io::TriangleMesh two = box({5, 5, 5}, {6, 6, 6});
  const io::TriangleMesh inner = testing::sphere({0.3, 0.2, 0.1}, 0.05, 1);
  const auto first = static_cast<std::uint32_t>(two.vertices_m.size());
  two.vertices_m.insert(two.vertices_m.end(), inner.vertices_m.begin(), inner.vertices_m.end());
  for (const auto& [a, b, c] : inner.triangles) two.triangles.push_back({a + first, b + first, c + first});
  EXPECT_EQ(block.distance_m(Solid(two), Eigen::Isometry3d::Identity(), 0.01), 0.0);

  // Without its top the block is open: a surface, which is 0.65 m away.
  io::TriangleMesh open = box({-1, -1, -1}, {1, 1, 1});
  open.triangles.resize(10);
  EXPECT_EQ(Solid(open).open_edges(), 4U);
  EXPECT_EQ(Solid(open).distance_m(pea, Eigen::Isometry3d::Identity(), 0.01), 0.01);
}

// The sphere's facets are inside it, so that points between its two radii are left out. Some points have x and y of a
// vertex, so that their ray goes through it.
TEST(InsideTest, IsThatOfASphereAndABox) {
  Random random(6);
  const io::TriangleMesh ball = testing::sphere({0.1, 0.2, 0.3}, 0.5, 3),
                         block = box({-0.3, -0.2, -0.1}, {0.4, 0.5, 0.6});
  const InsideTest in_ball(ball), in_block(block);
  EXPECT_EQ(open_edges(ball), 0U);
  int inside = 0, through_vertices = 0;
  for (int k = 0; k < seeds(100000); ++k) {
    Eigen::Vector3d at = Eigen::Vector3d(0.1, 0.2, 0.3) + 0.3 * random_vector(random);
    if (k % 2 == 0) at.head<2>() = ball.vertices_m[random.index(ball.vertices_m.size())].head<2>();
    const double from_center = (at - Eigen::Vector3d(0.1, 0.2, 0.3)).norm();
    if (from_center < 0.49 || from_center > 0.5) {
      ASSERT_EQ(in_ball.inside(at), from_center < 0.5) << at.transpose();
      inside += from_center < 0.5 ? 1 : 0;
      through_vertices += k % 2 == 0 && from_center < 0.5 ? 1 : 0;
    }
    Eigen::Vector3d cell = at;
    if (k % 3 == 0) cell.y() = cell.x() + 0.1;  // beside the diagonals of the box's faces
    const bool within =
        (cell.array() > Eigen::Array3d(-0.3, -0.2, -0.1)).all() && (cell.array() < Eigen::Array3d(0.4, 0.5, 0.6)).all();
    ASSERT_EQ(in_block.inside(cell), within) << cell.transpose();
  }
  EXPECT_GT(inside, seeds(100000) / 10);
  EXPECT_GT(through_vertices, seeds(100000) / 50);
}

std::vector<OutlinePoint> ball_end(double radius_m, double height_m, int points) {
  std::vector<OutlinePoint> out;
  for (int i = 0; i <= points; ++i) {
    const double angle = std::numbers::pi / 2.0 * i / points;
    out.push_back({.height_m = radius_m * (1.0 - std::cos(angle)), .radius_m = radius_m * std::sin(angle)});
  }
  out.push_back({.height_m = height_m, .radius_m = radius_m});
  return out;
}

TEST(ConvexRevolution, HasTheDepthOfABallEnd) {
  Random random(7);
  const ConvexRevolution ball(ball_end(5e-3, 20e-3, 200), 1.0);
  const Eigen::Vector3d low(0, 0, 5e-3), high(0, 0, 1.0);
  for (int k = 0; k < 2000; ++k) {
    const Eigen::Vector3d at = Eigen::Vector3d(0, 0, 8e-3) + 3e-3 * random_vector(random);
    const double expected_m = 5e-3 - to_segment_m(at, low, high);
    // Chords of the arc lie inside it, by r (1 − cos of half their angle).
    if (expected_m > 0.0) {
      EXPECT_NEAR(ball.depth_m(at), expected_m, 5e-3 * 8e-6);
    } else {
      EXPECT_LE(ball.depth_m(at), 0.0);
    }
  }
  EXPECT_NEAR(ball.greatest_depth_m(), 5e-3, 5e-8);
}

/// The greatest depth over a triangle, from points of it: none may be deeper, and one nearly as deep.
void expect_most(const ConvexRevolution& solid, const Triangle& triangle) {
  const double most_m = solid.most_over_triangle_m(triangle, -1e9);
  const double size_m = std::max((triangle[1] - triangle[0]).norm(), (triangle[2] - triangle[0]).norm());
  constexpr int n = 60;
  double sampled_m = -1e9;
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; i + j <= n; ++j) {
      const Eigen::Vector3d at =
          triangle[0] + (triangle[1] - triangle[0]) * (i / double{n}) + (triangle[2] - triangle[0]) * (j / double{n});
      sampled_m = std::max(sampled_m, solid.depth_m(at));
    }
  }
  EXPECT_GE(most_m, sampled_m - 1.1e-7);
  EXPECT_LE(most_m, sampled_m + 2.0 * size_m / n);
  Eigen::AlignedBox3d around;
  for (const Eigen::Vector3d& corner : triangle) around.extend(corner);
  EXPECT_GE(solid.bound_over_box_m(around.center(), (around.sizes() / 2.0).asDiagonal()), most_m - 1e-12);
}

TEST(ConvexRevolution, FindsTheDeepestPointOfATriangle) {
  Random random(8);
  for (int k = 0; k < seeds(2000); ++k) {
    const double radius_m = random.uniform(2e-3, 10e-3), corner_m = random.uniform(0.0, radius_m);
    const ConvexRevolution solid({{0.0, radius_m - corner_m}, {corner_m, radius_m}, {30e-3, radius_m}}, 0.0);
    const double size_m = std::pow(10.0, random.uniform(-4.0, -1.0));
    const Eigen::Vector3d at = 5e-3 * random_vector(random);
    expect_most(solid, {at, at + size_m * random_vector(random), at + size_m * random_vector(random)});
  }
}

// Of a mesh, the tree finds what all triangles one by one give.
TEST(Solid, DepthIsThatOfAllTriangles) {
  Random random(9);
  int deep = 0;
  for (int k = 0; k < seeds(400); ++k) {
    const io::TriangleMesh mesh = testing::random_triangles(random, 200, 20e-3, 5e-3);
    const ConvexRevolution cutter(ball_end(random.uniform(1e-3, 6e-3), 20e-3, 16), 0.0);
    const Eigen::Isometry3d pose = random_pose(random, 10e-3);
    double expected_m = -1e9;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      Triangle triangle = corners(mesh, i);
      for (Eigen::Vector3d& corner : triangle) corner = pose * corner;
      expected_m = std::max(expected_m, cutter.most_over_triangle_m(triangle, -1e9));
    }
    const double above_m = 50e-6, found_m = Solid(mesh).depth_in_m(cutter, pose, above_m);
    if (expected_m > above_m + 2e-7) {
      EXPECT_NEAR(found_m, expected_m, 2.1e-7);
      ++deep;
    } else {
      EXPECT_LE(found_m, above_m + 2e-7);
    }
  }
  EXPECT_GT(deep, seeds(400) / 5);
}

TEST(Solid, DepthOfACutterAllInsideIsItsOwn) {
  const Solid block(box({-1, -1, -1}, {1, 1, 1}));
  const ConvexRevolution cutter({{0.0, 5e-3}, {30e-3, 5e-3}}, 0.0);
  EXPECT_NEAR(block.depth_in_m(cutter, Eigen::Isometry3d::Identity(), 50e-6), 5e-3, 1e-9);
}

TEST(Revolve, ClosesItsMeshAroundTheSolid) {
  const std::vector<std::vector<OutlinePoint>> outlines = {
      {{0.0, 0.02}, {0.05, 0.02}}, {{0.0, 0.0}, {0.02, 0.03}, {0.02, 0.01}, {0.06, 0.0}}, ball_end(5e-3, 20e-3, 8)};
  for (const auto& outline : outlines) {
    const io::TriangleMesh mesh = revolve(outline, 20e-6);
    EXPECT_EQ(open_edges(mesh), 0U);
    double enclosed = 0.0, expected = 0.0;
    for (const auto& [a, b, c] : mesh.triangles) {
      enclosed += mesh.vertices_m[a].dot(mesh.vertices_m[b].cross(mesh.vertices_m[c])) / 6.0;
    }
    for (std::size_t i = 1; i < outline.size(); ++i) {
      const double r = outline[i - 1].radius_m, s = outline[i].radius_m;
      expected += std::numbers::pi / 3.0 * (outline[i].height_m - outline[i - 1].height_m) * (r * r + r * s + s * s);
    }
    EXPECT_GT(enclosed, expected);
    EXPECT_LT(enclosed, expected * 1.006);
  }
}

}  // namespace solid_test
}  // namespace robomill::robot
