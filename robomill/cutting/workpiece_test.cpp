#include "robomill/cutting/workpiece.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "robomill/base/parallel.hpp"
#include "robomill/base/random.hpp"
#include "robomill/cutting/dexels/workpiece_sweep.hpp"
#include "testing/support.hpp"

namespace robomill::cutting {
namespace workpiece_test {

using Eigen::Vector3d;
using program::Pose;
using std::numbers::pi;

Cutter ball_end(double radius_m) {
  Cutter cutter;
  cutter.kind = CutterKind::ball_end;
  cutter.mill = {.teeth = 2, .diameter_m = 2.0 * radius_m};
  return cutter;
}

Cutter flat_end(double radius_m) {
  Cutter cutter = ball_end(radius_m);
  cutter.kind = CutterKind::flat_end;
  return cutter;
}

Cutter bull_nose(double radius_m, double corner_m) {
  Cutter cutter = ball_end(radius_m);
  cutter.kind = CutterKind::bull_nose;
  cutter.corner_radius_m = corner_m;
  return cutter;
}

/// Bottom, corner and side tangent to each other, as taper mills have them.
Cutter taper(double radius_m) {
  Cutter cutter = ball_end(radius_m);
  cutter.kind = CutterKind::general;
  const double a = cutter.bottom_angle_rad = 0.09;
  const double b = cutter.side_angle_rad = 0.07;
  const double corner = cutter.corner_radius_m = 0.4 * radius_m;
  const double foot = radius_m * (1.0 - std::tan(a) * std::tan(b));
  const double right = corner - foot * std::cos(b);
  cutter.corner_center_radius_m = (corner * std::sin(b) - right * std::cos(a)) / std::cos(a + b);
  cutter.corner_center_height_m = (corner * std::cos(b) - right * std::sin(a)) / std::cos(a + b);
  return cutter;
}

Vector3d direction(Random& random) {
  return Vector3d(random.normal(), random.normal(), random.normal()).normalized();
}

/// How far a point stands out of the swept cutter with edges, where it does: least over λ, on a grid.
double outside(const Profile& profile, const Pose& pose, const Vector3d& way, const Vector3d& p) {
  double least = 1e300;
  constexpr int steps = 2000;
  for (int i = 0; i <= steps; ++i) {
    const Vector3d q = p - pose.tip_m - (i / static_cast<double>(steps)) * way;
    const double z = q.dot(pose.axis);
    const double r = (q - z * pose.axis).norm();
    const double height = profile.height_m();
    least = std::min(least, std::max({-z, z - height, r - profile.radius_m(std::clamp(z, 0.0, height))}));
  }
  return least;
}

int column_axis(int axis) {
  return axis == 0 ? 1 : 0;
}

int row_axis(int axis) {
  return axis == 2 ? 1 : 2;
}

/// One ray, the third of eight.
Span meet(const SweptSolid& solid, int axis, const Vector3d& p) {
  Lanes columns = {};
  for (std::size_t i = 0; i < lane_count; ++i) {
    columns.v[i] = p[column_axis(axis)] + 1e-4 * (static_cast<double>(i) - 2.0);
  }
  std::array<Span, lane_count> spans = {};
  solid.meet(p[row_axis(axis)], columns, spans);
  return spans[2];
}

// The span that a ray has in the sweep ends on the surface: just within it is in, just beyond it is out; where there is
// none, no point of the ray is in.
void expect_spans(const Cutter& cutter, int seed, int cases) {
  const Profile profile(cutter);
  Random random(5, static_cast<std::uint64_t>(seed));
  const double size = profile.height_m();
  int met = 0;
  for (int i = 0; i < cases; ++i) {
    Pose pose = {.tip_m = 2.0 * size * direction(random), .axis = direction(random)};
    if (i % 5 == 0) pose.axis = Vector3d::UnitZ();
    Vector3d way = size * random.uniform(0.0, 1.5) * direction(random);
    if (i % 7 == 0) way = Vector3d::Zero();
    if (i % 7 == 1) way = way.norm() * pose.axis;
    if (i % 7 == 2) way = way.norm() * Vector3d::UnitX();
    const int axis = static_cast<int>(random.index(3));
    const double height = random.uniform(-0.1, 1.1) * size;
    const Vector3d p = pose.tip_m + height * pose.axis + random.uniform() * way +
                       1.3 * profile.max_radius_m() * random.uniform() * direction(random);
    Span span;
    for (SweptSolid& solid : swept_cutter(profile, pose, way, 0.0).edges) {
      solid.aim(axis);
      const Span part = meet(solid, axis, p);
      if (part.empty()) continue;
      span = {.from = std::min(span.from, part.from), .to = std::max(span.to, part.to)};
      const Span extent = solid.extent(axis);
      EXPECT_LE(extent.from, part.from + 1e-12);
      EXPECT_GE(extent.to, part.to - 1e-12);
      const Span columns = solid.columns(p[row_axis(axis)]);
      EXPECT_LE(columns.from, p[column_axis(axis)] + 1e-12);
      EXPECT_GE(columns.to, p[column_axis(axis)] - 1e-12);
    }
    const auto at = [&](double t) {
      Vector3d q = p;
      q[axis] = t;
      return outside(profile, pose, way, q);
    };
    if (span.empty()) {
      for (int k = -20; k <= 20; ++k) EXPECT_GT(at(p[axis] + 0.1 * k * size), -1e-3 * size) << i;
      continue;
    }
    ++met;
    const double step = 2e-3 * size;
    EXPECT_GT(at(span.from - step), 0.0) << i;
    EXPECT_GT(at(span.to + step), 0.0) << i;
    if (span.to - span.from < 4.0 * step) continue;
    EXPECT_LT(at(span.from + step), 1e-4 * size) << i;
    EXPECT_LT(at(span.to - step), 1e-4 * size) << i;
  }
  EXPECT_GT(met, cases / 4);
}

TEST(SweptSolid, BallEndMeetsRaysWhereItsPointsAre) {
  expect_spans(ball_end(3e-3), 1, test::seeds(20000));
}
TEST(SweptSolid, FlatEndMeetsRaysWhereItsPointsAre) {
  expect_spans(flat_end(3e-3), 2, test::seeds(20000));
}
TEST(SweptSolid, BullNoseMeetsRaysWhereItsPointsAre) {
  expect_spans(bull_nose(3e-3, 1e-3), 3, test::seeds(20000));
}
TEST(SweptSolid, TaperMeetsRaysWhereItsPointsAre) {
  expect_spans(taper(3e-3), 4, test::seeds(20000));
}

// A flat end mill given as a general cutter goes the numerical way and must come to the same.
TEST(SweptSolid, ClosedFormAndNewtonAgree) {
  const Profile profile(flat_end(3e-3));
  Random random(8);
  for (int i = 0; i < 5000; ++i) {
    const Pose pose = {.tip_m = Vector3d::Zero(), .axis = direction(random)};
    const Vector3d way = 3e-3 * random.uniform() * direction(random);
    const Vector3d p = 6e-3 * random.uniform() * direction(random);
    SweptSolid closed = SweptSolid::cylinder(pose, 0.0, profile.height_m(), 3e-3, way);
    SweptSolid newton = SweptSolid::convex(pose, profile, way);
    closed.aim(1);
    newton.aim(1);
    const Span a = meet(closed, 1, p);
    const Span b = meet(newton, 1, p);
    if (a.empty() || a.to - a.from < 1e-5) continue;  // a ray that only just touches
    ASSERT_FALSE(b.empty()) << i;
    EXPECT_NEAR(a.from, b.from, 1e-9) << i;
    EXPECT_NEAR(a.to, b.to, 1e-9) << i;
  }
}

Stock box(const Vector3d& low, const Vector3d& high) {
  Stock stock;
  stock.min_m = low;
  stock.max_m = high;
  return stock;
}

// Volume of a tooth's feed: the chip area across the feed times the feed. The neighbouring pass lies at -l; below the
// cusp between them, h_min, the chip is the circle's segment, above it the pass' arcs shifted by l: area of the segment
// below h_min + l (h - h_min).
TEST(Workpiece, VolumeOfAPassIsChipAreaTimesFeed) {
  struct Case {
    double radius, depth, stepover, lead, tilt;
  };
  for (const Case& c : {Case{3e-3, 1e-3, 0.5e-3, 0.0, 0.0}, Case{3e-3, 1.2e-3, 1e-3, 0.2, -0.3},
                        Case{4e-3, 1.2e-3, 1e-3, -0.35, 0.15}}) {
    const double r = c.radius;
    const double h_min = r - std::sqrt(r * r - 0.25 * c.stepover * c.stepover);
    const double segment = r * r * std::acos(1.0 - h_min / r) - (r - h_min) * std::sqrt(h_min * (2.0 * r - h_min));
    const double area = segment + c.stepover * (c.depth - h_min);
    const double half = std::sqrt(c.depth * (2.0 * r - c.depth));
    Workpiece part(box({-0.05e-3, -half - c.stepover - 0.1e-3, -0.1e-3}, {half + 0.45e-3, half + 0.1e-3, c.depth}),
                   5e-6);
    const Profile profile(ball_end(r));
    const Vector3d axis = Eigen::AngleAxisd(c.tilt, Vector3d::UnitX()) *
                          (Eigen::AngleAxisd(c.lead, Vector3d::UnitY()) * Vector3d::UnitZ());
    const auto pose = [&](double x, double y) {  // the ball's centre at height r
      return Pose{.tip_m = Vector3d(x, y, r) - r * axis, .axis = axis};
    };
    part.remove(profile, pose(-2.0 * r, -c.stepover), pose(2.0 * r, -c.stepover));
    part.remove(profile, pose(-2.0 * r, 0.0), pose(0.0, 0.0));
    const double feed = 0.2e-3;
    const Removal removal = part.remove(profile, pose(0.0, 0.0), pose(feed, 0.0));
    EXPECT_NEAR(removal.volume_m3(), area * feed, 5e-5 * area * feed) << r;
    EXPECT_NEAR(removal.edges_m3.z(), area * feed, 3e-6 * area * feed) << r;
    EXPECT_NEAR(removal.edges_m3.y(), area * feed, 4e-4 * area * feed) << r;
    EXPECT_NEAR(removal.edges_m3.x(), area * feed, 4e-4 * area * feed) << r;
    EXPECT_EQ(removal.shank_depth_m, 0.0);
  }
  // The published area of the first.
  const double h_min = 3.0 - std::sqrt(9.0 - 0.0625);
  const double segment = 9.0 * std::acos(1.0 - h_min / 3.0) - (3.0 - h_min) * std::sqrt(h_min * (6.0 - h_min));
  EXPECT_NEAR(segment + 0.5 * (1.0 - h_min), 0.49826, 5e-6);
}

// Each direction of rays sees what the others see, and what was there less what is left.
TEST(Workpiece, DirectionsAgreeAndVolumesAddUp) {
  for (const Cutter& cutter : {ball_end(3e-3), flat_end(3e-3), bull_nose(3e-3, 1e-3), taper(3e-3)}) {
    Workpiece part(box({0.0, 0.0, 0.0}, {0.02, 0.015, 0.01}), 0.2e-3);
    const Vector3d before = part.volumes_m3();
    EXPECT_LT((before / 3e-6 - Vector3d::Ones()).norm(), 1e-12);
    const Profile profile(cutter);
    Random random(9);
    Vector3d removed = Vector3d::Zero();
    Pose at = {.tip_m = {0.0, 0.0, 0.01}, .axis = Vector3d::UnitZ()};
    for (int i = 0; i < 15; ++i) {
      const Pose next = {.tip_m = {random.uniform(0.0, 0.02), random.uniform(0.0, 0.015), random.uniform(0.004, 0.01)},
                         .axis = (Vector3d::UnitZ() + 0.5 * direction(random)).normalized()};
      const Removal removal = part.remove(profile, at, next);
      removed += removal.edges_m3 + removal.shank_m3;
      EXPECT_LT((removal.edges_m3.array() - removal.edges_m3.mean()).abs().maxCoeff(), 6e-10) << i;
      at = next;
    }
    EXPECT_LT((before - part.volumes_m3() - removed).norm(), 1e-15);
    EXPECT_GT(removed.mean(), 0.2 * before.mean());
    EXPECT_LT((removed.array() - removed.mean()).abs().maxCoeff(), 1e-3 * removed.mean());
  }
}

// A move cut in two takes what it takes in one.
TEST(Workpiece, TwoHalvesAreTheWhole) {
  for (const Cutter& cutter : {ball_end(3e-3), bull_nose(3e-3, 1e-3)}) {
    const Profile profile(cutter);
    const Vector3d axis = Vector3d(0.2, -0.3, 1.0).normalized();
    const Pose from = {.tip_m = {-0.004, 0.002, 0.003}, .axis = axis};
    const Pose to = {.tip_m = {0.012, 0.007, 0.005}, .axis = axis};
    Workpiece whole(box({0.0, 0.0, 0.0}, {0.01, 0.01, 0.01}), 0.1e-3);
    Workpiece halves(box({0.0, 0.0, 0.0}, {0.01, 0.01, 0.01}), 0.1e-3);
    const Removal one = whole.remove(profile, from, to);
    const Pose middle = between(from, to, 0.37);
    const Removal first = halves.remove(profile, from, middle);
    const Removal second = halves.remove(profile, middle, to);
    EXPECT_LT((one.edges_m3 - first.edges_m3 - second.edges_m3).norm(), 1e-9 * one.edges_m3.norm());
  }
}

// Turning about the tip: a flat end mill of no depth sweeps nothing but what its side passes; the volume against a
// hundred times finer steps.
TEST(Workpiece, TurningAxisComesWithinTheDexel) {
  const Profile profile(ball_end(3e-3));
  const Pose from = {.tip_m = {0.0, 0.01, 0.006}, .axis = Vector3d(0.0, 0.0, 1.0)};
  const Pose to = {.tip_m = {0.02, 0.01, 0.004}, .axis = Vector3d(0.3, 0.5, 1.0).normalized()};
  Workpiece coarse(box({0.0, 0.0, 0.0}, {0.02, 0.02, 0.01}), 0.2e-3);
  Workpiece fine(box({0.0, 0.0, 0.0}, {0.02, 0.02, 0.01}), 0.2e-3);
  const double whole = coarse.remove(profile, from, to).volume_m3();
  double parts = 0.0;
  for (int i = 0; i < 400; ++i) {
    parts += fine.remove(profile, between(from, to, i / 400.0), between(from, to, (i + 1) / 400.0)).volume_m3();
  }
  EXPECT_NEAR(whole, parts, 1e-2 * parts);
}

TEST(Workpiece, SameBitsAtAnyThreadCount) {
  const auto run = [](int threads) {
    set_thread_count(threads);
    Workpiece part(box({0.0, 0.0, 0.0}, {0.02, 0.015, 0.01}), 0.1e-3);
    const Profile profile(bull_nose(3e-3, 1e-3));
    Removal sum;
    for (int i = 0; i < 4; ++i) {
      const Pose from = {.tip_m = {-0.004, 0.002 * i, 0.006}, .axis = Vector3d(0.1, 0.1 * i, 1.0).normalized()};
      const Pose to = {.tip_m = {0.024, 0.002 * i, 0.005}, .axis = Vector3d(-0.1, 0.1, 1.0).normalized()};
      const Removal removal = part.remove(profile, from, to);
      sum.edges_m3 += removal.edges_m3;
      sum.shank_m3 += removal.shank_m3;
    }
    set_thread_count(0);
    return std::pair(sum.edges_m3, part.volumes_m3());
  };
  const auto one = run(1);
  EXPECT_EQ(one, run(2));
  EXPECT_EQ(one, run(8));
}

TEST(Workpiece, SameBitsFromEveryInstructionSet) {
  const Kernels best = best_kernels();
  const auto run = [](Kernels chosen) {
    kernels() = chosen;
    Workpiece part(box({0.0, 0.0, 0.0}, {0.02, 0.015, 0.01}), 0.2e-3);
    for (const Cutter& cutter : {ball_end(3e-3), flat_end(2e-3)}) {
      const Profile profile(cutter);
      part.remove(profile, {.tip_m = {-0.004, 0.003, 0.006}, .axis = Vector3d(0.1, 0.3, 1.0).normalized()},
                  {.tip_m = {0.024, 0.009, 0.005}, .axis = Vector3d(-0.1, 0.1, 1.0).normalized()});
      part.remove(profile, {.tip_m = {-0.004, 0.012, 0.006}}, {.tip_m = {0.024, 0.009, 0.005}});
    }
    return part.volumes_m3();
  };
  const Vector3d baseline = run(Kernels::baseline);
  EXPECT_LT(baseline.x(), 2.9e-6);
  if (best != Kernels::baseline) {
    EXPECT_EQ(baseline, run(Kernels::avx2));
  }
  if (best == Kernels::avx512) {
    EXPECT_EQ(baseline, run(Kernels::avx512));
  }
  kernels() = best;
}

// The shank of a short cutter runs through what its edges do not reach.
TEST(Workpiece, DistinguishesTheShankFromTheEdges) {
  Cutter cutter = flat_end(3e-3);
  cutter.cutting_height_m = 2e-3;
  Workpiece part(box({0.0, 0.0, 0.0}, {0.02, 0.02, 0.01}), 0.1e-3);
  const Removal removal =
      part.remove(Profile(cutter), {.tip_m = {-0.004, 0.001, 0.005}}, {.tip_m = {0.024, 0.001, 0.005}});
  EXPECT_NEAR(removal.edges_m3.mean(), 0.02 * 0.004 * 0.002, 1e-3 * 1.6e-7);
  EXPECT_NEAR(removal.shank_m3.mean(), 0.02 * 0.004 * 0.003, 1e-3 * 2.4e-7);
  EXPECT_NEAR(removal.shank_depth_m, 3e-3, 0.2e-3);
}

// Depth below a flat top, and in a groove that a ball has left, against their distances.
TEST(Workpiece, DepthInterpolatesBetweenRays) {
  Workpiece part(box({0.0, 0.0, 0.0}, {0.02, 0.02, 0.01}), 0.25e-3);
  EXPECT_NEAR(part.depth_m({0.01, 0.0103, 0.00991}), 0.09e-3, 1e-15);
  EXPECT_NEAR(part.depth_m({0.01, 0.0103, 0.01007}), -0.07e-3, 1e-15);
  EXPECT_NEAR(part.depth_m({0.01, 0.00004, 0.005}), 0.04e-3, 1e-15);
  EXPECT_LT(part.depth_m({0.03, 0.01, 0.005}), 0.0);
  const double dexel = part.dexel_m();
  part.remove(Profile(ball_end(3e-3)), {.tip_m = {-0.01, 0.01, 0.0075}}, {.tip_m = {0.03, 0.01, 0.0075}});
  Random random(4);
  for (int i = 0; i < 2000; ++i) {
    const double angle = random.uniform(-0.5, 0.5);
    const double off = random.uniform(-0.5e-3, 0.5e-3);
    const Vector3d p(random.uniform(0.005, 0.015), 0.01 + (3e-3 + off) * std::sin(angle),
                     0.0105 - (3e-3 + off) * std::cos(angle));
    if (p.z() > 0.01 - dexel) continue;
    // Along z or y the distance is longer than across the surface, by at most √2, less a chord's sagitta.
    const double depth = part.depth_m(p);
    EXPECT_GT(depth * off, -1e-6 * dexel) << off;
    EXPECT_NEAR(std::abs(depth), std::abs(off), 0.45 * std::abs(off) + 5e-6) << angle;
  }
}

// Where a box is far off, every point of it has the depth that is cut off outside.
TEST(Workpiece, NothingOfABoxFarOffIsNearMaterial) {
  const Workpiece part(box({0.0, 0.0, 0.0}, {0.004, 0.003, 0.002}), 0.25e-3);
  Random random(7);
  int far = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vector3d middle(random.uniform(-0.005, 0.009), random.uniform(-0.005, 0.009), random.uniform(-0.005, 0.009));
    const Vector3d reach(random.uniform(0.0, 0.002), random.uniform(0.0, 0.002), random.uniform(0.0, 0.002));
    if (!part.is_far_off(middle - reach, middle + reach)) continue;
    ++far;
    for (int k = 0; k < 8; ++k) {
      const Vector3d at(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0));
      EXPECT_EQ(part.depth_m(middle + reach.cwiseProduct(at)), part.farthest_m());
    }
  }
  EXPECT_GT(far, 200);
  EXPECT_TRUE(part.is_far_off({0.0, 0.0, 0.003}, {0.004, 0.003, 0.004}));
  EXPECT_FALSE(part.is_far_off({0.0, 0.0, 0.0026}, {0.004, 0.003, 0.004}));
}

TEST(Stock, HoldsItsVolume) {
  Stock stock;
  stock.shape = Stock::Shape::cylinder;
  stock.center_m = {0.01, -0.02};
  stock.radius_m = 0.01;
  stock.bottom_m = -0.005;
  stock.top_m = 0.015;
  const double cylinder = pi * 1e-4 * 0.02;
  EXPECT_LT((Workpiece(stock, 0.1e-3).volumes_m3().array() / cylinder - 1.0).abs().maxCoeff(), 1e-3);
  stock.shape = Stock::Shape::turned;  // a cone on a foot that is wider, with a neck between
  stock.outline_m = {{0.012, 0.0}, {0.012, 0.003}, {0.004, 0.003}, {0.01, 0.009}, {0.0, 0.02}};
  const auto frustum = [](double a, double b, double height) { return pi / 3.0 * height * (a * a + a * b + b * b); };
  const double turned = frustum(0.012, 0.012, 0.003) + frustum(0.004, 0.01, 0.006) + frustum(0.01, 0.0, 0.011);
  EXPECT_LT((Workpiece(stock, 0.1e-3).volumes_m3().array() / turned - 1.0).abs().maxCoeff(), 1e-3);
}

TEST(Stock, RejectsNamingTheMember) {
  Stock stock;
  EXPECT_EQ(test::field_of([&] { stock.validate(); }), "max_m[1]");
  stock = box({0.0, 0.0, 0.0}, {1.0, 1.0, std::nan("")});
  EXPECT_EQ(test::field_of([&] { stock.validate(); }), "max_m[3]");
  stock = box({0.0, 0.0, 0.0}, {1.0, 1.0, 1.0});
  EXPECT_EQ(test::field_of([&] { Workpiece(stock, 0.0); }), "dexel_m");
  EXPECT_EQ(test::field_of([&] { Workpiece(stock, 1e-5); }), "dexel_m");
  stock.shape = Stock::Shape::cylinder;
  EXPECT_EQ(test::field_of([&] { stock.validate(); }), "radius_m");
  stock.radius_m = 1.0;
  EXPECT_EQ(test::field_of([&] { stock.validate(); }), "top_m");
  stock.shape = Stock::Shape::turned;
  EXPECT_EQ(test::field_of([&] { stock.validate(); }), "outline_m");
  stock.outline_m = {{1.0, 0.0}, {1.0, -1.0}};
  EXPECT_EQ(test::field_of([&] { stock.validate(); }), "outline_m.z");
  stock.outline_m = {{0.0, 0.0}, {0.0, 1.0}};
  EXPECT_EQ(test::field_of([&] { stock.validate(); }), "outline_m.r");
}

}  // namespace workpiece_test
}  // namespace robomill::cutting
