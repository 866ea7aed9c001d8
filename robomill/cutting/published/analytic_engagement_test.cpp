#include "robomill/cutting/engagement.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "robomill/cutting/published/patch.hpp"
#include "testing/cutting/cutters.hpp"
#include "testing/support.hpp"

namespace robomill::cutting {
namespace analytic_engagement_test {

using robomill::test::field_of;
using robomill::test::rejection;
using robomill::test::seeds;
using std::numbers::pi;
using testing::ball_end;
using testing::bull_nose;
using testing::degree;
using testing::flat_end;
using testing::mm;

constexpr CutterKind kinds[] = {CutterKind::flat_end, CutterKind::ball_end, CutterKind::bull_nose, CutterKind::general};
constexpr double mm2 = 1e-6;

/// The chip's area across the feed: circle's segment below the cusp, then a strip of width l.
double chip_area(double radius, double depth, double step) {
  const double cusp = radius - std::sqrt(radius * radius - 0.25 * step * step);
  const double half = std::asin(0.5 * step / radius);
  return radius * radius * (half - std::sin(half) * std::cos(half)) + step * (depth - cusp);
}

/// Whether a point of F lies in what the same cutter sweeps along x, standing at `shift` (its own position: 0).
class Body {
 public:
  Body(const Cutter& cutter, const Cut& cut) : profile_(cutter), rotation_(feed_from_tool(cut.lead_rad, cut.tilt_rad)) {
    lowest_ = 1e300;
    for (int i = 0; i <= 20000; ++i) {
      const Profile::Point p = profile_.at(profile_.length_m() * i / 20000.0);
      const double low = rotation_(2, 2) * p.height_m - p.radius_m * std::hypot(rotation_(2, 0), rotation_(2, 1));
      if (low < lowest_ - 1e-15) {
        lowest_ = low;
        touching_ = p;
      }
    }
    const double across = std::hypot(rotation_(2, 0), rotation_(2, 1));
    Eigen::Vector3d at(0.0, 0.0, touching_.height_m);
    if (across > 0.0) at.head<2>() = -rotation_.row(2).head<2>().transpose() * (touching_.radius_m / across);
    origin_ = -(rotation_ * at);
  }
  [[nodiscard]] Eigen::Vector3d point(const Profile::Point& p, double angle) const {
    return origin_ +
           rotation_ * Eigen::Vector3d(p.radius_m * std::sin(angle), p.radius_m * std::cos(angle), p.height_m);
  }
  [[nodiscard]] double along_feed(const Profile::Point& p, double angle) const {
    const double s = std::sin(p.position_rad);
    return rotation_.row(0).dot(
        Eigen::RowVector3d(s * std::sin(angle), s * std::cos(angle), -std::cos(p.position_rad)));
  }
  /// < 0 inside the body.
  [[nodiscard]] double outside(const Eigen::Vector3d& p) const {
    const Eigen::Vector3d q = rotation_.transpose() * (p - origin_);
    if (q.z() < 0.0) return -q.z();
    return std::hypot(q.x(), q.y()) - profile_.radius_m(q.z());
  }
  /// The least of it along x, a convex function: golden sections.
  [[nodiscard]] double outside_sweep(Eigen::Vector3d p) const {
    double from = p.x() - 10.0 * profile_.max_radius_m();
    double to = p.x() + 10.0 * profile_.max_radius_m();
    const double slope = rotation_(0, 2);  // how the height in T grows with x
    const double at_zero = (rotation_.transpose() * (Eigen::Vector3d(0.0, p.y(), p.z()) - origin_)).z();
    if (std::abs(slope) > 1e-12) {
      const double border = -at_zero / slope;
      (slope > 0.0 ? from : to) = border;
    } else if (at_zero < 0.0) {
      return -at_zero;
    }
    double least = 1e300;
    const double best = detail::highest_between(
        [&](double x) {
          p.x() = x;
          const double value = outside(p);
          least = std::min(least, value);
          return -value;
        },
        from, to, 70);
    static_cast<void>(best);
    return least;
  }
  [[nodiscard]] const Profile& profile() const { return profile_; }

 private:
  Profile profile_;
  Eigen::Matrix3d rotation_;
  Eigen::Vector3d origin_;
  Profile::Point touching_;
  double lowest_ = 0.0;
};

/// The conditions of a cut over a plane or over a cylinder, in coordinates turned to the surface; > 0 in the cut, how
/// far.
double in_cut(const Body& body, const Cutter& cutter, const Cut& cut, const Profile::Point& at, double angle) {
  const Eigen::Vector3d p = body.point(at, angle);
  const double side = cut.direction == MillingDirection::up ? -1.0 : 1.0;
  Eigen::Vector3d seen = p;
  double above = p.z();
  if (const double bend = cut.curvature_across_feed_per_m; bend != 0.0) {
    const Eigen::Vector2d center(0.0, -1.0 / bend);
    const double turn = side * bend * cut.radial_depth_m;  // that takes the neighbour's place to ours
    const Eigen::Vector2d from = p.tail<2>() - center;
    seen.y() = std::cos(turn) * from.x() - std::sin(turn) * from.y() + center.x();
    seen.z() = std::sin(turn) * from.x() + std::cos(turn) * from.y() + center.y();
    above = bend > 0.0 ? from.norm() - 1.0 / bend : -1.0 / bend - from.norm();
  } else if (const double along = cut.curvature_along_feed_per_m; along != 0.0) {
    const double from = std::hypot(p.x(), p.z() + 1.0 / along);
    above = along > 0.0 ? from - 1.0 / along : -1.0 / along - from;
  } else {
    seen.y() -= side * cut.radial_depth_m;
  }
  double room = std::min(cut.axial_depth_m - above, 1e-3 * body.along_feed(at, angle));
  if (cut.direction == MillingDirection::slot) return room;
  if (cut.curvature_along_feed_per_m != 0.0) {
    const double radius = 0.5 * cutter.mill.diameter_m;
    return std::min(room, std::hypot(p.y() - side * cut.radial_depth_m, above - radius) - radius);
  }
  return std::min(room, body.outside_sweep(seen));
}

bool covers(const detail::ArcList& arcs, double angle) {
  return std::ranges::any_of(arcs, [&](const detail::BoundedArc& arc) {
    return (angle > arc.entry && angle < arc.exit) || angle + 2.0 * pi < arc.exit;
  });
}

// h_min = R - sqrt(R² - l²/4): up to there, where the neighbour's border leaves x = 0, a ring cuts from +y over the
// feed to -y. h_mid = R - sqrt(R² - l²): there, where the ring's radius is l, it cuts from +y to the feed.
TEST(AnalyticEngagement, RingsOpenAtThePublishedHeights) {
  struct Case {
    double radius, depth, step, least, middle;
  };
  for (const Case& c : {Case{3.0, 1.0, 0.5, 0.01043, 0.04196}, Case{3.0, 1.2, 1.0, 0.04196, 0.17157},
                        Case{4.0, 1.2, 1.0, 0.03137, 0.12702}}) {
    const Engagement engagement = engage(
        ball_end(c.radius * mm), {.axial_depth_m = c.depth * mm, .radial_depth_m = c.step * mm}, {.slices = 4000});
    double half_turn = 0.0;
    double quarter_turn = 0.0;
    for (std::size_t i = 0; i < engagement.slices.size(); ++i) {
      if (engagement.of(i).empty()) continue;
      const double height = engagement.slices[i].height_m / mm;
      const double exit = engagement.of(i).back().exit_rad;
      if (exit >= pi - 1e-9) half_turn = std::max(half_turn, height);
      if (exit >= 0.5 * pi) quarter_turn = std::max(quarter_turn, height);
    }
    EXPECT_NEAR(half_turn, c.least, 2e-3 * c.least + 5e-6);
    EXPECT_NEAR(quarter_turn, c.middle, 5e-3 * c.middle + 5e-6);
  }
}

// Source: the chip by its closed form; the patch by integrating R / x over the crescent between two circles and a
// chord, in closed form over z and 40,000 points over y.
TEST(AnalyticEngagement, AreasOfTheBallAreThoseOfTheCrescent) {
  struct Case {
    double radius, depth, step, chip, patch;
  };
  for (const Case& c : {Case{3.0, 1.0, 0.5, 0.49826, 2.733167867}, Case{3.0, 1.2, 1.0, 1.18605, 4.610247456},
                        Case{4.0, 1.2, 1.0, 1.18956, 5.626505601}}) {
    for (const MillingDirection direction : {MillingDirection::up, MillingDirection::down}) {
      const Cut cut = {.axial_depth_m = c.depth * mm, .radial_depth_m = c.step * mm, .direction = direction};
      const Engagement engagement = engage(ball_end(c.radius * mm), cut, {.slices = 50});
      EXPECT_NEAR(chip_area_m2(engagement) / mm2, c.chip, 5e-6);
      EXPECT_NEAR(chip_area_m2(engagement), chip_area(c.radius * mm, c.depth * mm, c.step * mm), 1e-7 * c.chip * mm2);
      EXPECT_NEAR(patch_area_m2(engagement) / mm2, c.patch, 1e-7 * c.patch);
    }
  }
}

// Lead and tilt move (κ, φ) over a patch that stays where it is.
TEST(AnalyticEngagement, AreasOfTheBallDoNotDependOnLeadAndTilt) {
  for (int seed = 0; seed < seeds(500); ++seed) {
    Random random(611, static_cast<std::uint64_t>(seed));
    const double radius = random.uniform(1.0, 10.0) * mm;
    const Cutter cutter = ball_end(radius);
    Cut cut = {.axial_depth_m = random.uniform(0.02, 0.5) * radius,
               .radial_depth_m = random.uniform(0.02, 0.8) * radius,
               .direction = random.index(2) == 0 ? MillingDirection::up : MillingDirection::down};
    cut.axial_depth_m = std::max(cut.axial_depth_m,
                                 radius - std::sqrt(radius * radius - 0.25 * cut.radial_depth_m * cut.radial_depth_m));
    const double upright = patch_area_m2(engage(cutter, cut, {.slices = 400}));
    cut.lead_rad = random.uniform(-25.0, 25.0) * degree;
    cut.tilt_rad = random.uniform(-25.0, 25.0) * degree;
    const Engagement leaning = engage(cutter, cut, {.slices = 50});
    const double expected = chip_area(radius, cut.axial_depth_m, cut.radial_depth_m);
    EXPECT_NEAR(chip_area_m2(leaning), expected, 1e-4 * expected) << seed;
    EXPECT_NEAR(patch_area_m2(leaning), upright, 1e-4 * upright) << seed;
  }
}

// Every kind, lead, tilt, plane and curved: the arcs against the definition, point by point.
TEST(AnalyticEngagement, ArcsAreWhereThePointsAreInTheCut) {
  int inside = 0;
  int points = 0;
  for (int seed = 0; seed < seeds(500); ++seed) {
    Random random(612, static_cast<std::uint64_t>(seed));
    const Cutter cutter = testing::random_cutter(random, kinds[seed % 4]);
    Cut cut = testing::random_cut(random, cutter);
    const double half = 0.5 * cutter.mill.diameter_m;
    if (seed % 7 == 3) cut.axial_depth_m *= 4.0;  // up the side
    if (seed % 3 == 1) cut.curvature_across_feed_per_m = random.uniform(-0.25, 0.5) / half;
    if (seed % 12 == 5) cut.curvature_along_feed_per_m = random.uniform(-0.25, 0.5) / half;
    if (field_of([&] { static_cast<void>(engage(cutter, cut)); }) != "accepted") continue;
    const detail::Patch patch(cutter, cut);
    const Body body(cutter, cut);
    const double length =
        cutter.kind == CutterKind::ball_end && seed % 7 != 3 ? 0.5 * pi * half : body.profile().length_m();
    for (int i = 0; i < 400; ++i) {
      const Profile::Point at = body.profile().at(length * random.uniform());
      const double angle = random.uniform(0.0, 2.0 * pi);
      const double room = in_cut(body, cutter, cut, at, angle);
      if (std::abs(room) < 1e-6 * half) continue;
      EXPECT_EQ(covers(patch.arcs(at), angle), room > 0.0) << seed << ' ' << i << ' ' << room;
      inside += room > 0.0 ? 1 : 0;
      ++points;
    }
  }
  EXPECT_GT(inside, points / 50);
}

// The rings against many of their own kind, and against even ones that know nothing of where the cut begins.
TEST(AnalyticEngagement, FiftyRingsGiveTheAreas) {
  int cases = 0;
  for (int seed = 0; seed < seeds(300); ++seed) {
    Random random(613, static_cast<std::uint64_t>(seed));
    const Cutter cutter = testing::random_cutter(random, kinds[seed % 4]);
    const Cut cut = testing::random_cut(random, cutter);
    Engagement fifty;
    if (field_of([&] { fifty = engage(cutter, cut, {.slices = 50}); }) != "accepted") continue;
    const detail::Patch patch(cutter, cut);
    Engagement fine;
    fine.feed_from_tool = patch.feed_from_tool();
    fine.first_arc = {0};
    for (const Profile::Piece& piece : patch.profile().pieces()) {
      constexpr int count = 4000;
      for (int i = 0; i < count; ++i) {
        const Profile::Point at = patch.profile().at(piece.start_m + piece.length_m * (i + 0.5) / count);
        const detail::ArcList arcs = patch.arcs(at);
        if (arcs.empty()) continue;
        fine.slices.push_back({.radius_m = at.radius_m,
                               .height_m = at.height_m,
                               .position_rad = at.position_rad,
                               .width_m = piece.length_m / count});
        for (const detail::BoundedArc& arc : arcs) fine.arcs.push_back({.entry_rad = arc.entry, .exit_rad = arc.exit});
        fine.first_arc.push_back(fine.arcs.size());
      }
    }
    ++cases;
    const Engagement many = engage(cutter, cut, {.slices = 1000});
    const double tolerance = cutter.kind == CutterKind::ball_end ? 1e-4 : 2e-3;
    EXPECT_NEAR(patch_area_m2(fifty), patch_area_m2(many), tolerance * patch_area_m2(many)) << seed;
    EXPECT_NEAR(chip_area_m2(fifty), chip_area_m2(many), tolerance * chip_area_m2(many)) << seed;
    EXPECT_NEAR(patch_area_m2(many), patch_area_m2(fine), 2e-3 * patch_area_m2(fine)) << seed;
    EXPECT_NEAR(chip_area_m2(many), chip_area_m2(fine), 2e-3 * chip_area_m2(fine)) << seed;
  }
  EXPECT_GT(cases, seeds(300) / 2);
}

// Source: immersion() of milling.hpp, to the bit of acos.
TEST(AnalyticEngagement, OfAFlatEndIsItsImmersion) {
  const Cutter cutter = flat_end(10.0 * mm);
  for (const MillingDirection direction : {MillingDirection::up, MillingDirection::down, MillingDirection::slot}) {
    for (const double step : {0.3 * mm, 5.0 * mm, 7.2 * mm, 10.0 * mm}) {
      const Cut cut = {.axial_depth_m = 2.0 * mm, .radial_depth_m = step, .direction = direction};
      const Engagement engagement = engage(cutter, cut, {.slices = 20});
      const Immersion expected = immersion(direction, step, 10.0 * mm);
      ASSERT_EQ(engagement.slices.size(), 20U);
      double width = 0.0;
      for (std::size_t i = 0; i < engagement.slices.size(); ++i) {
        ASSERT_EQ(engagement.of(i).size(), 1U);
        EXPECT_NEAR(engagement.of(i)[0].entry_rad, expected.entry_rad, 1e-14);
        EXPECT_NEAR(engagement.of(i)[0].exit_rad, expected.exit_rad, 1e-14);
        EXPECT_EQ(engagement.slices[i].position_rad, 0.5 * pi);
        EXPECT_NEAR(engagement.slices[i].width_m, 0.1 * mm, 1e-15);
        width += engagement.slices[i].width_m;
      }
      EXPECT_NEAR(width, 2.0 * mm, 1e-15);
      const double chip = direction == MillingDirection::slot ? 20.0 : 2.0 * step / mm;
      EXPECT_NEAR(chip_area_m2(engagement) / mm2, chip, 1e-11);
    }
  }
}

// Two methods on one ball: its own conditions, and the support function of the same outline given by seven parameters.
TEST(AnalyticEngagement, BallAndGeneralOutlineAgree) {
  for (int seed = 0; seed < seeds(300); ++seed) {
    Random random(614, static_cast<std::uint64_t>(seed));
    const Cutter ball = testing::random_cutter(random, CutterKind::ball_end);
    Cut cut = testing::random_cut(random, ball);
    if (seed % 2 == 1) cut.curvature_across_feed_per_m = random.uniform(-0.4, 0.5) / ball.mill.diameter_m;
    Cutter general = ball;
    general.kind = CutterKind::general;
    general.corner_radius_m = general.corner_center_height_m = 0.5 * ball.mill.diameter_m;
    if (field_of([&] { static_cast<void>(engage(ball, cut)); }) != "accepted") continue;
    const detail::Patch one(ball, cut);
    const detail::Patch other(general, cut);
    for (int i = 0; i < 40; ++i) {
      const Profile::Point at = one.profile().at(0.25 * pi * ball.mill.diameter_m * random.uniform());
      const detail::ArcList a = one.arcs(at);
      const detail::ArcList b = other.arcs(at);
      EXPECT_NEAR(a.length(), b.length(), 1e-7) << seed << ' ' << i;
    }
  }
}

// Up and down are mirror images: y -> -y takes φ to π - φ and tilt to -tilt.
TEST(AnalyticEngagement, UpAndDownMirrorEachOther) {
  for (int seed = 0; seed < seeds(200); ++seed) {
    Random random(615, static_cast<std::uint64_t>(seed));
    const Cutter cutter = testing::random_cutter(random, kinds[seed % 4]);
    Cut cut = testing::random_cut(random, cutter);
    if (cut.direction == MillingDirection::slot) cut.direction = MillingDirection::up;
    Cut mirror = cut;
    mirror.direction = cut.direction == MillingDirection::up ? MillingDirection::down : MillingDirection::up;
    mirror.tilt_rad = -cut.tilt_rad;
    Engagement a;
    Engagement b;
    const std::string first = field_of([&] { a = engage(cutter, cut); });
    ASSERT_EQ(first, field_of([&] { b = engage(cutter, mirror); })) << seed;
    if (first != "accepted") continue;
    EXPECT_NEAR(chip_area_m2(a), chip_area_m2(b), 2e-3 * chip_area_m2(a)) << seed;
    const detail::Patch one(cutter, cut);
    const detail::Patch other(cutter, mirror);
    for (const EdgeSlice& slice : a.slices) {
      const Profile::Point at = {
          .radius_m = slice.radius_m, .height_m = slice.height_m, .position_rad = slice.position_rad};
      const detail::ArcList there = other.arcs(at);
      for (const detail::BoundedArc& arc : one.arcs(at)) {
        for (const double share : {0.001, 0.499, 0.999}) {
          const double angle = pi - (arc.entry + share * (arc.exit - arc.entry));
          EXPECT_TRUE(covers(there, angle - 2.0 * pi * std::floor(angle / (2.0 * pi)))) << seed;
        }
      }
      EXPECT_NEAR(one.arcs(at).length(), there.length(), 1e-6) << seed;
    }
  }
}

// A weakly curved surface is nearly a plane, and what differs does so in proportion.
TEST(AnalyticEngagement, CurvatureTendsToThePlane) {
  const Cutter cutter = ball_end(3.0 * mm);
  for (const bool along : {true, false}) {
    double before = 0.0;
    for (const double curvature : {1.0, -1.0, 0.5, 1e-4}) {
      Cut cut = {.axial_depth_m = 1.0 * mm, .radial_depth_m = 0.5 * mm, .lead_rad = 0.2, .tilt_rad = -0.1};
      const double plane = chip_area_m2(engage(cutter, cut));
      (along ? cut.curvature_along_feed_per_m : cut.curvature_across_feed_per_m) = curvature;
      const double change = chip_area_m2(engage(cutter, cut)) / plane - 1.0;
      if (curvature == 1.0) before = change;
      EXPECT_NEAR(change, before * curvature, 0.02 * std::abs(before)) << along << curvature;
      if (curvature == 1.0) {
        EXPECT_GT(std::abs(change), 1e-4);
      }
    }
  }
}

// Source: geometry. On a convex cylinder across the feed, what a revolution removes is a ring's sector less the
// circles.
TEST(AnalyticEngagement, ShallowPassBelowTheCuspStillCutsACrescent) {
  const double radius = 3.0 * mm;
  const double step = 2.0 * mm;
  const double cusp = radius - std::sqrt(radius * radius - 0.25 * step * step);
  const Cut cut = {.axial_depth_m = 0.5 * cusp, .radial_depth_m = step};
  const double half = std::acos(1.0 - 0.5 * cusp / radius);
  const double segment = radius * radius * (half - std::sin(half) * std::cos(half));
  EXPECT_NEAR(chip_area_m2(engage(ball_end(radius), cut)), segment, 1e-7 * segment);
}

TEST(AnalyticEngagement, RejectsWhatCannotBeCut) {
  const Cutter cutter = flat_end(10.0 * mm);
  const auto field = [&](auto change) {
    Cut cut = {.axial_depth_m = 1.0 * mm, .radial_depth_m = 2.0 * mm};
    change(cut);
    return field_of([&] { static_cast<void>(engage(cutter, cut)); });
  };
  EXPECT_EQ(field([](Cut&) {}), "accepted");
  EXPECT_EQ(field([](Cut& c) { c.axial_depth_m = 0.0; }), "axial_depth_m");
  EXPECT_EQ(field([](Cut& c) { c.axial_depth_m = std::nan(""); }), "axial_depth_m");
  EXPECT_EQ(field([](Cut& c) { c.axial_depth_m = 21.0 * mm; }), "axial_depth_m");
  EXPECT_EQ(field([](Cut& c) { c.axial_depth_m = 20.0 * mm; }), "accepted");
  EXPECT_EQ(field([](Cut& c) { c.radial_depth_m = 0.0; }), "radial_depth_m");
  EXPECT_EQ(field([](Cut& c) { c.radial_depth_m = 10.1 * mm; }), "radial_depth_m");
  EXPECT_EQ(field([](Cut& c) {
              c.radial_depth_m = 0.0;
              c.direction = MillingDirection::slot;
            }),
            "accepted");
  EXPECT_EQ(field([](Cut& c) { c.lead_rad = 1.55; }), "lead_rad");
  EXPECT_EQ(field([](Cut& c) { c.tilt_rad = std::nan(""); }), "tilt_rad");
  EXPECT_EQ(field([](Cut& c) { c.curvature_along_feed_per_m = 1.0; }), "curvature_along_feed_per_m");
  EXPECT_EQ(field([](Cut& c) { c.curvature_across_feed_per_m = -2000.0; }), "curvature_across_feed_per_m");
  EXPECT_EQ(
      field_of([&] { static_cast<void>(engage(cutter, {.axial_depth_m = mm, .radial_depth_m = mm}, {.slices = -1})); }),
      "slices");
}

// A ball whose edges end below its equator: what stands above them is shank.
TEST(AnalyticEngagement, ABallWithShortEdgesHasAShank) {
  Cutter cutter;
  cutter.kind = CutterKind::ball_end;
  cutter.mill = {.teeth = 2, .diameter_m = 6e-3};
  cutter.cutting_height_m = 1e-3;
  const Cut deep = {.axial_depth_m = 2e-3, .radial_depth_m = 0.5e-3};
  EXPECT_THROW(static_cast<void>(engage(cutter, deep)), InvalidInput);
  const Cut shallow = {.axial_depth_m = 0.5e-3, .radial_depth_m = 0.5e-3};
  Cutter whole = cutter;
  whole.cutting_height_m = 0.0;
  const double expected = patch_area_m2(engage(whole, shallow));
  EXPECT_NEAR(patch_area_m2(engage(cutter, shallow)), expected, 1e-5 * expected);
}

TEST(AnalyticEngagement, RejectsACutOnTheShank) {
  Cutter cutter = ball_end(3.0 * mm);
  cutter.cutting_height_m = 3.0 * mm;
  Cut cut = {.axial_depth_m = 1.5 * mm, .radial_depth_m = 2.0 * mm};
  EXPECT_NO_THROW(static_cast<void>(engage(cutter, cut)));
  cut.lead_rad = 70.0 * degree;
  const std::string said = rejection([&] { static_cast<void>(engage(cutter, cut)); });
  EXPECT_NE(said.find("lead_rad"), std::string::npos) << said;
  EXPECT_NE(said.find("lead 70.00 degrees, tilt 0.00 degrees"), std::string::npos) << said;
  cut.lead_rad = 0.0;
  cut.tilt_rad = -70.0 * degree;  // the axis leans over the cut
  EXPECT_EQ(field_of([&] { static_cast<void>(engage(cutter, cut)); }), "tilt_rad");
  cut.axial_depth_m = 3.1 * mm;
  EXPECT_EQ(field_of([&] { static_cast<void>(engage(cutter, cut)); }), "axial_depth_m");
}

}  // namespace analytic_engagement_test
}  // namespace robomill::cutting
