#include "robomill/path/published/fir_corner.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "robomill/base/random.hpp"

namespace robomill::path {
namespace fir_corner_test {

using Eigen::Vector3d;

// Two blocks that overlap, at distance from their corner and from their lines.
struct Corner {
  Boxes block, next;
  Vector3d way, next_way;
  double overlap_s = 0.0;
  [[nodiscard]] Vector3d at(double t) const {  // from the corner; t from where the next one begins
    return way * (share_at(block, block.sum_s() - overlap_s + t)[0] - 1.0) + next_way * share_at(next, t)[0];
  }
  [[nodiscard]] double miss() const {
    double least = 1e9;
    for (int i = 0; i <= 2000; ++i) least = std::min(least, at(overlap_s * i / 2000.0).norm());
    return least;
  }
  [[nodiscard]] double deviation() const {
    double most = 0.0;
    for (int i = 0; i <= 2000; ++i) {
      const Vector3d x = at(overlap_s * i / 2000.0);
      const auto from_line = [&x](const Vector3d& to) {
        const double share = std::clamp(x.dot(to) / to.squaredNorm(), 0.0, 1.0);
        return (x - share * to).norm();
      };
      most = std::max(most, std::min(from_line(-way), from_line(next_way)));
    }
    return most;
  }
};

Corner random_corner(Random& random, bool same_filters) {
  const auto vector = [&] { return Vector3d(random.normal(), random.normal(), random.normal()).normalized(); };
  Corner c;
  const double t2 = random.uniform(0.05, 0.2), t3 = random.uniform(0.02, 0.2);
  const double v = random.uniform(0.02, 0.1);
  c.block.add(random.uniform(0.5, 1.0));
  c.block.add(t2);
  c.block.add(t3);
  c.next.add(random.uniform(0.5, 1.0));
  c.next.add(same_filters ? t2 : random.uniform(0.05, 0.2));
  c.next.add(same_filters ? t3 : random.uniform(0.02, 0.2));
  c.way = v * c.block.width_s[0] * vector();
  c.next_way = (same_filters ? v : random.uniform(0.02, 0.1)) * c.next.width_s[0] * vector();
  return c;
}

// The law against the path itself: exact for equal speeds and filters.
TEST(FirCorner, MissesTheCornerByTheLaw) {
  Random random(1);
  for (int round = 0; round < 100; ++round) {
    Corner c = random_corner(random, true);
    const double speed = corner_speed(c.way / c.block.width_s[0], c.next_way / c.next.width_s[0], false);
    const double tolerance = random.uniform(1e-6, 5e-4);
    c.overlap_s = largest_overlap_s_of(c.block, c.next, speed, tolerance);
    Boxes filters;
    filters.add(c.block.width_s[1]);
    filters.add(c.block.width_s[2]);
    const double expected = corner_error(filters, speed, c.overlap_s);
    EXPECT_LE(expected, tolerance * (1.0 + 1e-9));
    if (c.overlap_s < filters.sum_s() * (1.0 - 1e-9)) {
      EXPECT_NEAR(expected, tolerance, 1e-9 * tolerance);
    }
    EXPECT_NEAR(c.miss(), expected, 1e-6 * expected);
    EXPECT_LE(c.deviation(), expected * (1.0 + 1e-6));
  }
}

// For other speeds and filters it is a bound.
TEST(FirCorner, BoundsTheMissOfUnequalBlocks) {
  Random random(2);
  double closest = 0.0;
  for (int round = 0; round < 300; ++round) {
    Corner c = random_corner(random, false);
    const double speed = corner_speed(c.way / c.block.width_s[0], c.next_way / c.next.width_s[0], false);
    const double tolerance = random.uniform(1e-6, 5e-4);
    c.overlap_s = largest_overlap_s_of(c.block, c.next, speed, tolerance);
    EXPECT_LE(c.miss(), tolerance * (1.0 + 1e-6));
    EXPECT_LE(c.deviation(), tolerance * (1.0 + 1e-6));
    closest = std::max(closest, c.miss() / tolerance);
  }
  EXPECT_GT(closest, 0.9);  // and no idle one
}

// On a reversal V is 2 v; as printed √3 v, so that a tolerance of 0.02 mm makes 0.02 · 2/√3 = 0.0231 mm.
TEST(FirCorner, AsPrintedAReversalMissesItsToleranceBy15Percent) {
  Corner c;
  for (Boxes* boxes : {&c.block, &c.next}) {
    boxes->add(0.6);
    boxes->add(0.1);
    boxes->add(0.05);
  }
  const Vector3d v(0.05, 0.0, 0.0);
  c.way = 0.6 * v;
  c.next_way = -0.6 * v;
  EXPECT_NEAR(corner_speed(v, -v, false), 0.1, 1e-15);
  c.overlap_s = largest_overlap_s_of(c.block, c.next, corner_speed(v, -v, true), 2e-5);
  EXPECT_NEAR(c.miss(), 0.0231e-3, 0.5e-7);
  EXPECT_NEAR(c.miss(), 2e-5 * 2.0 / std::sqrt(3.0), 1e-10);
  c.overlap_s = largest_overlap_s_of(c.block, c.next, corner_speed(v, -v, false), 2e-5);
  EXPECT_NEAR(c.miss(), 2e-5, 1e-10);
}

TEST(FirCorner, GoingStraightOnTheWholeFiltersOverlap) {
  Corner c;
  for (Boxes* boxes : {&c.block, &c.next}) {
    boxes->add(0.6);
    boxes->add(0.1);
    boxes->add(0.05);
  }
  EXPECT_NEAR(largest_overlap_s_of(c.block, c.next, 0.0, 2e-5), 0.15, 1e-15);
  EXPECT_NEAR(largest_overlap_s_of(c.block, c.next, 1e-9, 2e-5), 0.15, 1e-15);
}

TEST(FirCorner, EndTangentIsTheAxisVelocityAtUnitTime) {
  Random random(4);
  for (int round = 0; round < 50; ++round) {
    const auto vector = [&] { return Vector3d(random.normal(), random.normal(), random.normal()).normalized(); };
    const Vector3d a = vector(), b = vector();
    const double angle = std::atan2(a.cross(b).norm(), a.dot(b)), e = 1e-6;
    const Vector3d before = Eigen::AngleAxisd(angle * (1.0 - e), a.cross(b).normalized()) * a;
    EXPECT_LT(((b - before) / e - end_tangent(a, b)).norm(), 1e-5);
  }
  EXPECT_EQ(end_tangent(Vector3d::UnitX(), Vector3d::UnitX()).norm(), 0.0);
}

}  // namespace fir_corner_test
}  // namespace robomill::path
