// Cuts whose engagement is handed in.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "robomill/base/error.hpp"
#include "robomill/cutting/program_engagement.hpp"
#include "robomill/modal/tip.hpp"
#include "robomill/stability/collocation/mesh/given_engagement.hpp"
#include "robomill/stability/sweep.hpp"
#include "testing/stability/problems.hpp"
#include "testing/stability/spatial_cases.hpp"

namespace robomill::stability {
namespace given_engagement_test {

using cutting::MillingDirection;
using Eigen::Vector3d;
using testing::rpm;
using testing::SpatialReference;

LobesProblem given(const LobesProblem& problem, int rings) {
  LobesProblem out = problem;
  out.spatial->engagement = cutting::engage(problem.spatial->cutter, problem.spatial->cut, {.slices = rings});
  return out;
}

TEST(GivenEngagement, HasTheRadiiOfTheCutThatItIsOf) {
  for (const SpatialReference& known : testing::spatial_references()) {
    const LobesProblem problem = given(known.problem, 60);
    const double height_m = engaged_height_m(*problem.spatial->engagement);
    const PointResult point = evaluate_point(problem, {}, {known.speed_rpm * rpm, height_m});
    EXPECT_NEAR(point.spectral_radius, known.spectral_radius, 3e-4 * known.spectral_radius);
  }
}

// An upright flat end's arcs are the same at every height: clipped or carried on, the limit is that of the cut.
TEST(GivenEngagement, AFlatEndsLimitDoesNotDependOnTheDepthItWasSeenAt) {
  LobesProblem flat = testing::spatial_references()[4].problem;
  flat.spatial->cut.lead_rad = flat.spatial->cut.tilt_rad = 0.0;
  LobesOptions options;
  options.axial_depth_m = {0.0, 3e-3};
  options.grid = {2, 31};
  const double limit_m = limit_depths(flat, options, {8000 * rpm}).front().axial_depth_m;
  ASSERT_GT(limit_m, 0.1e-3);
  for (const double share : {0.4, 1.0, 2.5}) {
    flat.spatial->cut.axial_depth_m = share * limit_m;
    const Limit found = limit_depths(given(flat, 60), options, {8000 * rpm}).front();
    EXPECT_NEAR(found.axial_depth_m, limit_m, 1e-4 * limit_m) << share;
  }
}

// Width and place of what is cut are continuous and grow with the depth, to the end of the edges.
TEST(GivenEngagement, GrowsWithItsDepthWithoutJumps) {
  for (const SpatialReference& known : testing::spatial_references()) {
    const LobesProblem problem = given(known.problem, 60);
    const detail::GivenEngagement found(problem.spatial->cutter, *problem.spatial->engagement);
    double before_m2 = 0.0;
    const double step_m = found.depth_m() / 200.0;
    for (int i = 1; i <= 500; ++i) {
      const double area_m2 = cutting::patch_area_m2(found.at(step_m * i, 12));
      EXPECT_GE(area_m2, before_m2 * (1.0 - 1e-12));
      const double widest_m = known.problem.spatial->cutter.mill.diameter_m * std::numbers::pi;
      // A ball's profile rises flatly at its pole: the height of a step is little of its length there.
      EXPECT_LE(area_m2 - before_m2, 16.0 * widest_m * step_m) << i;
      before_m2 = area_m2;
    }
    EXPECT_NEAR(cutting::patch_area_m2(found.at(found.depth_m(), 12)),
                cutting::patch_area_m2(*problem.spatial->engagement), 1e-3 * before_m2);
    const double all_m2 = cutting::patch_area_m2(found.at(1.0, 12));
    EXPECT_NEAR(cutting::patch_area_m2(found.at(2.0, 12)), all_m2, 1e-12 * all_m2);
  }
}

/// The engagement of a cut along x, seen in a workpiece of rays; the work frame is F of the cut.
cutting::PoseEngagement seen_in_rays(const SpatialMilling& milling, double dexel_m) {
  const cutting::Cut& cut = milling.cut;
  const double radius_m = 0.5 * milling.cutter.mill.diameter_m;
  const Vector3d axis = cutting::feed_from_tool(cut.lead_rad, cut.tilt_rad) * Vector3d::UnitZ();
  // The cutter's lowest point runs along the x axis.
  Vector3d tip = Vector3d(0.0, 0.0, radius_m) - radius_m * axis;
  if (milling.cutter.kind == cutting::CutterKind::flat_end) {
    tip = Vector3d(0.0, 0.0, radius_m * std::hypot(axis.x(), axis.y()));
  }
  const auto pose = [&](double x, double y) { return program::Pose{.tip_m = tip + Vector3d(x, y, 0.0), .axis = axis}; };
  const double reach_m = 1.4 * radius_m;
  cutting::Stock stock;
  stock.min_m = {-reach_m, -reach_m, -0.3e-3};
  stock.max_m = {reach_m, reach_m, cut.axial_depth_m};
  cutting::Workpiece part(stock, dexel_m);
  const cutting::Profile profile(milling.cutter);
  if (cut.direction != MillingDirection::slot) {
    const double side_m = cut.direction == MillingDirection::up ? -cut.radial_depth_m : cut.radial_depth_m;
    part.remove(profile, pose(-4.0 * radius_m, side_m), pose(4.0 * radius_m, side_m));
  }
  part.remove(profile, pose(-4.0 * radius_m, 0.0), pose(-2.0 * dexel_m, 0.0));
  return cutting::EngagementFinder(milling.cutter, part.dexel_m(), {})
      .at(part, pose(0.0, 0.0), {.tip_m_per_s = {0.02, 0.0, 0.0}}, 0.0);
}

TEST(GivenEngagement, OfAWorkpieceOfRaysIsNearTheAnalyticOne) {
  for (const SpatialReference& known : testing::spatial_references()) {
    const cutting::PoseEngagement seen = seen_in_rays(*known.problem.spatial, 0.05e-3);
    LobesProblem problem = known.problem;
    problem.spatial->engagement = seen.engagement;
    problem.dynamics = modal::turned(problem.dynamics, seen.work_from_feed.transpose());
    const double height_m = engaged_height_m(seen.engagement);
    EXPECT_NEAR(height_m, seen.axial_depth_m, 1e-12);
    const PointResult point = evaluate_point(problem, {}, {known.speed_rpm * rpm, height_m});
    EXPECT_NEAR(point.spectral_radius, known.spectral_radius, 0.02 * known.spectral_radius);
    const double margin = gain_margin(problem, {known.limit_speed_rpm * rpm, height_m}, 1e-5).gain;
    const double expected = gain_margin(known.problem, {known.limit_speed_rpm * rpm, 1e-3 * known.depth_mm}, 1e-5).gain;
    EXPECT_NEAR(margin, expected, 0.02 * expected);
  }
}

// Rings that are taken together against those that are not.
TEST(GivenEngagement, MergedRingsMoveTheRadiusLittle) {
  for (const SpatialReference& known : testing::spatial_references()) {
    const SpatialMilling& milling = *known.problem.spatial;
    const cutting::Engagement fine = cutting::engage(milling.cutter, milling.cut, {.slices = 200});
    const cutting::Engagement merged = detail::merged_rings(milling.cutter, fine);
    EXPECT_LT(merged.slices.size(), fine.slices.size());
    EXPECT_NEAR(cutting::patch_area_m2(merged), cutting::patch_area_m2(fine), 1e-4 * cutting::patch_area_m2(fine));
    EXPECT_NEAR(cutting::chip_area_m2(merged), cutting::chip_area_m2(fine), 2e-3 * cutting::chip_area_m2(fine));
  }
}

TEST(GivenEngagement, RejectsWhatIsNone) {
  const LobesProblem good = given(testing::spatial_references()[0].problem, 30);
  const auto field = [&](const auto& spoil) -> std::string {
    LobesProblem bad = good;
    spoil(*bad.spatial->engagement);
    try {
      bad.validate();
    } catch (const InvalidInput& error) {
      return error.parts().field;
    }
    return "accepted";
  };
  EXPECT_EQ(field([](cutting::Engagement&) {}), "accepted");
  EXPECT_EQ(field([](cutting::Engagement& e) { e = {}; }), "accepted");
  EXPECT_EQ(field([](cutting::Engagement& e) { e.first_arc.pop_back(); }), "engagement.first_arc");
  EXPECT_EQ(field([](cutting::Engagement& e) { e.slices[0].width_m = -1.0; }), "engagement.slices.width_m");
  EXPECT_EQ(field([](cutting::Engagement& e) { e.slices[0].position_rad = 4.0; }), "engagement.slices.position_rad");
  EXPECT_EQ(field([](cutting::Engagement& e) { e.arcs[0].exit_rad = e.arcs[0].entry_rad; }),
            "engagement.arcs.exit_rad");
  EXPECT_EQ(field([](cutting::Engagement& e) { e.feed_from_tool *= 2.0; }), "engagement.feed_from_tool");
  SweepOptions sweep;
  sweep.range = {0.0, 0.1};
  sweep.spindle_speed_rad_per_s = {500.0, 600.0};
  EXPECT_THROW(static_cast<void>(compute_sweep(good, sweep)), InvalidInput);
  LobesProblem nothing = good;
  nothing.spatial->engagement = cutting::Engagement{};
  EXPECT_LT(evaluate_point(nothing, {}, {1000.0, 1e-3}).spectral_radius, 1.0);
}

}  // namespace given_engagement_test
}  // namespace robomill::stability
