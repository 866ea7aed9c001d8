#include "robomill/cutting/cutter.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "testing/cutting/cutters.hpp"
#include "testing/support.hpp"

namespace robomill::cutting {
namespace cutter_test {

using robomill::test::field_of;
using robomill::test::rejection;
using std::numbers::pi;
using testing::ball_end;
using testing::bull_nose;
using testing::degree;
using testing::flat_end;
using testing::mm;
using testing::tapered_ball;

constexpr CutterKind kinds[] = {CutterKind::flat_end, CutterKind::ball_end, CutterKind::bull_nose, CutterKind::general};

// Source: a quarter circle and a cylinder.
TEST(Profile, OfABallIsAQuarterCircleAndACylinder) {
  const double radius = 3.0 * mm;
  const Profile profile(ball_end(radius));
  ASSERT_EQ(profile.pieces().size(), 2U);
  EXPECT_NEAR(profile.pieces()[0].length_m, 0.5 * pi * radius, 1e-15);
  EXPECT_NEAR(profile.height_m(), 4.0 * radius, 1e-15);  // 2 D where nothing is said
  for (const double position : {0.0, 0.2, 0.9, 1.5}) {
    const Profile::Point point = profile.at(radius * position);
    EXPECT_NEAR(point.position_rad, position, 1e-14);
    EXPECT_NEAR(point.radius_m, radius * std::sin(position), 1e-16);
    EXPECT_NEAR(point.height_m, radius * (1.0 - std::cos(position)), 1e-16);
    EXPECT_NEAR(profile.radius_m(point.height_m), point.radius_m, 1e-10 * radius);
  }
  EXPECT_EQ(profile.at(0.5 * pi * radius + 1.0 * mm).position_rad, 0.5 * pi);
  EXPECT_NEAR(profile.max_radius_m(), radius, 1e-15);
}

TEST(Profile, OfAFlatEndIsABottomAndASide) {
  const Profile profile(flat_end(10.0 * mm));
  ASSERT_EQ(profile.pieces().size(), 2U);
  EXPECT_EQ(profile.at(2.0 * mm).position_rad, 0.0);
  EXPECT_EQ(profile.at(2.0 * mm).height_m, 0.0);
  EXPECT_EQ(profile.at(7.0 * mm).position_rad, 0.5 * pi);
  EXPECT_NEAR(profile.at(7.0 * mm).height_m, 2.0 * mm, 1e-15);
  EXPECT_EQ(profile.radius_m(0.0), 5.0 * mm);
  EXPECT_EQ(profile.radius_m(1.0), 5.0 * mm);  // the shank goes on
}

TEST(Profile, OfABullNoseHasItsCorner) {
  const Profile profile(bull_nose(12.0 * mm, 2.0 * mm));
  ASSERT_EQ(profile.pieces().size(), 3U);
  EXPECT_NEAR(profile.pieces()[0].length_m, 4.0 * mm, 1e-15);
  EXPECT_NEAR(profile.pieces()[1].length_m, pi * mm, 1e-15);
  const double height = 2.0 * mm * (1.0 - std::cos(0.7));
  EXPECT_NEAR(profile.radius_m(height), 4.0 * mm + 2.0 * mm * std::sin(0.7), 1e-14);
}

// Source: a sphere and the cone that touches it at κ = π/2 - α.
TEST(Profile, OfATaperedBallRunsSmoothlyIntoItsCone) {
  const double radius = 1.5 * mm;
  const double side = 10.0 * degree;
  const Cutter cutter = tapered_ball(radius, side, 12.0 * mm);
  const Profile profile(cutter);
  ASSERT_EQ(profile.pieces().size(), 2U);
  const Profile::Point end = profile.pieces()[0].last;
  EXPECT_NEAR(end.position_rad, 0.5 * pi - side, 1e-6);  // where a line only touches
  EXPECT_NEAR(end.radius_m, radius * std::cos(side), 1e-9 * radius);
  EXPECT_NEAR(end.height_m, radius * (1.0 - std::sin(side)), 1e-6 * radius);
  EXPECT_NEAR(profile.radius_m(10.0 * mm), 0.5 * cutter.mill.diameter_m + 10.0 * mm * std::tan(side), 1e-12);
  EXPECT_EQ(profile.max_radius_m(), profile.pieces().back().last.radius_m);
}

TEST(Profile, OfAConeHasASlopingBottomAndSide) {
  Cutter cutter = flat_end(8.0 * mm);
  cutter.kind = CutterKind::general;
  cutter.bottom_angle_rad = 45.0 * degree;
  cutter.side_angle_rad = 20.0 * degree;
  cutter.cutting_height_m = 10.0 * mm;
  const Profile profile(cutter);
  ASSERT_EQ(profile.pieces().size(), 2U);
  EXPECT_NEAR(profile.radius_m(3.0 * mm), 3.0 * mm, 1e-15);
  EXPECT_NEAR(profile.radius_m(9.0 * mm), 4.0 * mm + 5.0 * mm * std::tan(20.0 * degree), 1e-15);
  EXPECT_NEAR(profile.at(1.0 * mm).position_rad, 45.0 * degree, 1e-15);
  EXPECT_NEAR(profile.at(profile.length_m()).position_rad, 70.0 * degree, 1e-15);
}

// A dovetail: a corner past its equator, then a side that leans inwards.
TEST(Profile, OfADovetailIsWidestAtTheEquatorOfItsCorner) {
  const double side = -20.0 * degree;
  const double corner = 1.0 * mm;
  Cutter cutter = flat_end(20.0 * mm);
  cutter.kind = CutterKind::general;
  cutter.side_angle_rad = side;
  cutter.cutting_height_m = 8.0 * mm;
  cutter.corner_radius_m = cutter.corner_center_height_m = corner;
  cutter.corner_center_radius_m = 10.0 * mm - corner * std::tan(0.5 * (0.5 * pi - side));
  const Profile profile(cutter);
  ASSERT_EQ(profile.pieces().size(), 3U);
  EXPECT_NEAR(profile.pieces()[1].last.position_rad, 0.5 * pi - side, 1e-6);
  EXPECT_NEAR(profile.max_radius_m(), cutter.corner_center_radius_m + corner, 1e-12);
  EXPECT_LT(profile.radius_m(8.0 * mm), profile.radius_m(2.0 * mm));
  EXPECT_NEAR(profile.radius_m(corner), profile.max_radius_m(), 1e-12);
}

TEST(Profile, EndsWhereTheEdgesEndInTheCorner) {
  Cutter cutter = ball_end(3.0 * mm);
  cutter.cutting_height_m = 1.2 * mm;
  const Profile profile(cutter);
  ASSERT_EQ(profile.pieces().size(), 1U);
  EXPECT_NEAR(profile.height_m(), 1.2 * mm, 1e-15);
  EXPECT_NEAR(profile.at(profile.length_m()).position_rad, std::acos(1.0 - 0.4), 1e-14);
  EXPECT_NEAR(profile.radius_m(5.0 * mm), 3.0 * mm * std::sin(std::acos(0.6)), 1e-14);
}

// A ball given by the seven parameters is the same ball.
TEST(Profile, GeneralOutlineMakesTheOtherKinds) {
  Cutter general = ball_end(4.0 * mm);
  general.kind = CutterKind::general;
  general.corner_radius_m = general.corner_center_height_m = 4.0 * mm;
  const Profile ball(ball_end(4.0 * mm));
  const Profile same(general);
  for (int i = 0; i <= 20; ++i) {
    const double s = ball.length_m() * i / 20.0;
    EXPECT_NEAR(ball.at(s).radius_m, same.at(s).radius_m, 1e-16);
    EXPECT_NEAR(ball.at(s).height_m, same.at(s).height_m, 1e-16);
  }
  general = bull_nose(10.0 * mm, 2.0 * mm);
  const Profile bull(general);
  general.kind = CutterKind::general;
  general.corner_center_radius_m = 3.0 * mm;
  general.corner_center_height_m = 2.0 * mm;
  const Profile again(general);
  for (int i = 0; i <= 20; ++i) {
    const double s = bull.length_m() * i / 20.0;
    EXPECT_NEAR(bull.at(s).radius_m, again.at(s).radius_m, 1e-15);
    EXPECT_NEAR(bull.at(s).position_rad, again.at(s).position_rad, 1e-12);
  }
}

// Seeded property: the profile is continuous, convex, as long as its s says, and radius_m is its inverse.
TEST(Profile, IsAConvexCurveByItsLength) {
  for (int seed = 0; seed < robomill::test::seeds(2000); ++seed) {
    Random random(601, static_cast<std::uint64_t>(seed));
    const Profile profile(testing::random_cutter(random, kinds[seed % 4]));
    constexpr int count = 400;
    double length = 0.0;
    Profile::Point before = profile.at(0.0);
    EXPECT_EQ(before.radius_m, 0.0);
    EXPECT_EQ(before.height_m, 0.0);
    for (int i = 1; i <= count; ++i) {
      const Profile::Point point = profile.at(profile.length_m() * i / count);
      length += std::hypot(point.radius_m - before.radius_m, point.height_m - before.height_m);
      EXPECT_GE(point.position_rad, before.position_rad - 1e-9) << seed;
      EXPECT_GE(point.height_m, before.height_m - 1e-15) << seed;
      if (point.position_rad > 0.1) {
        EXPECT_NEAR(profile.radius_m(point.height_m), point.radius_m, 1e-9) << seed;
      }
      before = point;
    }
    EXPECT_NEAR(length, profile.length_m(), 1e-4 * profile.length_m()) << seed;
    EXPECT_NEAR(before.height_m, profile.height_m(), 1e-15) << seed;
  }
}

/// Where tooth j's edge passes a height, in T [m]: φ = rotation + standing angle - lag. Runout has no part in it.
Eigen::Vector3d edge_position_m(const FlatEndMill& mill, int tooth, const Profile::Point& point, double rotation_rad) {
  const double angle = rotation_rad + mill.standing_angle(tooth) - mill.lag_rad_per_m(tooth) * point.height_m;
  return {point.radius_m * std::sin(angle), point.radius_m * std::cos(angle), point.height_m};
}

// Two ways to one number: ds/db against the length of the edge's polygon in space, every shape.
TEST(Edge, LengthPerWidthIsThatOfTheEdgeInSpace) {
  for (int seed = 0; seed < robomill::test::seeds(400); ++seed) {
    Random random(602, static_cast<std::uint64_t>(seed));
    const Cutter cutter = testing::random_cutter(random, kinds[seed % 4]);
    const Profile profile(cutter);
    for (const Profile::Piece& piece : profile.pieces()) {
      constexpr int count = 2000;
      double polygon = 0.0;
      double integral = 0.0;
      Eigen::Vector3d before = edge_position_m(cutter.mill, 0, piece.first, 0.3);
      for (int i = 1; i <= count; ++i) {
        const Profile::Point middle = profile.at(piece.start_m + piece.length_m * (i - 0.5) / count);
        const Eigen::Vector3d here =
            edge_position_m(cutter.mill, 0, profile.at(piece.start_m + piece.length_m * i / count), 0.3);
        polygon += (here - before).norm();
        integral += edge_length_per_width(cutter.mill, 0, middle) * piece.length_m / count;
        before = here;
      }
      EXPECT_NEAR(integral, polygon, 1e-6 * polygon) << seed;
    }
  }
}

// Source: the ball's lag (1 - cos θ) tan β gives ds = R sqrt(1 + sin⁴θ tan²β) dθ; cos⁴, as [BallEndRobot] prints it, is
// far from the edge's length.
TEST(Edge, OfABallStretchesWithTheFourthPowerOfTheSine) {
  const double helix = 40.0 * degree;
  const Cutter cutter = ball_end(5.0 * mm, 2, helix);
  const Profile profile(cutter);
  for (const double position : {0.05, 0.4, 1.0, 1.5}) {
    const double expected = std::sqrt(1.0 + std::pow(std::sin(position), 4) * std::pow(std::tan(helix), 2));
    EXPECT_NEAR(edge_length_per_width(cutter.mill, 0, profile.at(5.0 * mm * position)), expected, 1e-13);
  }
  const Profile::Point point = profile.at(5.0 * mm * 0.4);
  const Eigen::Vector3d edge = edge_position_m(cutter.mill, 1, point, 0.0);
  const double angle = pi - (1.0 - std::cos(0.4)) * std::tan(helix);
  EXPECT_NEAR(edge.x(), point.radius_m * std::sin(angle), 1e-16);
  EXPECT_NEAR(edge.y(), point.radius_m * std::cos(angle), 1e-16);
  const Cutter mill = flat_end(10.0 * mm, 2, helix);
  EXPECT_NEAR(edge_length_per_width(mill.mill, 0, Profile(mill).at(8.0 * mm)), 1.0 / std::cos(helix), 1e-14);
  EXPECT_EQ(edge_length_per_width(mill.mill, 0, Profile(mill).at(3.0 * mm)), 1.0);  // of the bottom
}

TEST(Cutter, RejectsWhatIsNoCutter) {
  const auto field = [](auto change) {
    Cutter cutter = bull_nose(10.0 * mm, 2.0 * mm);
    cutter.kind = CutterKind::general;
    cutter.corner_center_radius_m = 3.0 * mm;
    cutter.corner_center_height_m = 2.0 * mm;
    change(cutter);
    return field_of([&] { cutter.validate(); });
  };
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(field([](Cutter&) {}), "accepted");
  EXPECT_EQ(field([](Cutter& c) { c.mill.teeth = 0; }), "teeth");
  EXPECT_EQ(field([](Cutter& c) { c.mill.diameter_m = nan; }), "diameter_m");
  EXPECT_EQ(field([](Cutter& c) { c.cutting_height_m = -1.0; }), "cutting_height_m");
  EXPECT_EQ(field([](Cutter& c) { c.cutting_height_m = nan; }), "cutting_height_m");
  EXPECT_EQ(field([](Cutter& c) { c.corner_radius_m = nan; }), "corner_radius_m");
  EXPECT_EQ(field([](Cutter& c) { c.corner_radius_m = -1.0 * mm; }), "corner_radius_m");
  EXPECT_EQ(field([](Cutter& c) { c.corner_center_height_m = 20.0 * mm; }), "corner_radius_m");
  EXPECT_EQ(field([](Cutter& c) { c.corner_center_height_m = nan; }), "corner_center_height_m");
  EXPECT_EQ(field([](Cutter& c) { c.corner_center_radius_m = 20.0 * mm; }), "corner_radius_m");
  EXPECT_EQ(field([](Cutter& c) { c.bottom_angle_rad = -0.1; }), "bottom_angle_rad");
  EXPECT_EQ(field([](Cutter& c) { c.side_angle_rad = 1.6; }), "side_angle_rad");
  EXPECT_EQ(field([](Cutter& c) { c.side_angle_rad = nan; }), "side_angle_rad");
  EXPECT_EQ(field_of([] { bull_nose(10.0 * mm, 5.0 * mm).validate(); }), "corner_radius_m");
  EXPECT_EQ(field_of([] { bull_nose(10.0 * mm, 0.0).validate(); }), "corner_radius_m");
  Cutter cone = flat_end(10.0 * mm);
  cone.kind = CutterKind::general;
  cone.side_angle_rad = -30.0 * degree;
  cone.cutting_height_m = 20.0 * mm;
  EXPECT_NE(rejection([&] { cone.validate(); }).find("thicker than nothing"), std::string::npos);
  cone.side_angle_rad = 0.0;
  cone.bottom_angle_rad = 60.0 * degree;
  cone.cutting_height_m = 5.0 * mm;
  EXPECT_NE(rejection([&] { cone.validate(); }).find("above the bottom"), std::string::npos);
}

}  // namespace cutter_test
}  // namespace robomill::cutting
