// The surface that cuts in three directions leave: against the plane, the simulation and closed forms.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/random.hpp"
#include "robomill/stability/forced_vibration.hpp"
#include "robomill/stability/surface_error.hpp"
#include "testing/simulation/posture_cases.hpp"
#include "testing/stability/problems.hpp"
#include "testing/stability/spatial_cases.hpp"
#include "testing/support.hpp"

namespace robomill::stability {
namespace surface_error_spatial_test {

using cutting::CutterKind;
using cutting::MillingDirection;
using std::numbers::pi;
using testing::rpm;

/// The same cut for both: a flat end upright, modes in x and y.
struct Twin {
  LobesProblem plane, space;
  OperatingPoint point;
};

Twin twin(Random& random, bool helix) {
  Twin t;
  cutting::Milling& milling = t.plane.milling;
  milling.tool.teeth = 1 + static_cast<int>(random.index(4));
  milling.tool.diameter_m = random.uniform(0.006, 0.016);
  if (helix) milling.tool.helix_rad = random.uniform(0.1, 0.6);
  const MillingDirection direction = static_cast<MillingDirection>(random.index(3));
  const double radial_m = milling.tool.diameter_m * random.uniform(0.05, 0.9);
  milling.immersion = cutting::immersion(direction, radial_m, milling.tool.diameter_m);
  milling.coefficients = {.tangential_n_per_m2 = random.uniform(5e8, 1e9),
                          .radial_n_per_m2 = random.uniform(1e8, 4e8),
                          .tangential_edge_n_per_m = random.uniform(0.0, 2e4),
                          .radial_edge_n_per_m = random.uniform(0.0, 2e4)};
  milling.feed_per_tooth_m = random.uniform(2e-5, 1e-4);
  if (milling.tool.teeth > 1 && random.index(3) == 0) {
    milling.tool.pitch_rad.assign(static_cast<std::size_t>(milling.tool.teeth), 2.0 * pi / milling.tool.teeth);
    milling.tool.pitch_rad.front() += 0.1;
    milling.tool.pitch_rad.back() -= 0.1;
  }
  if (!helix && random.index(3) == 0) {
    milling.tool.runout_m = random.uniform(2e-6, 4e-5);
    milling.tool.runout_angle_rad = random.uniform(0.0, 2.0 * pi);
  }
  t.plane.dynamics = testing::plane_model({testing::mass_mode(0, random.uniform(300.0, 1200.0), 0.03, 0.3),
                                           testing::mass_mode(1, random.uniform(300.0, 1200.0), 0.04, 0.2)});
  t.plane.feed_direction_rad = random.uniform(0.0, 2.0 * pi);
  t.point = {random.uniform(3000.0, 12000.0) * rpm, std::pow(10.0, random.uniform(-4.3, -3.3))};
  t.space = t.plane;
  SpatialMilling& spatial = t.space.spatial.emplace();
  spatial.cutter.mill = milling.tool;
  spatial.cut = {.axial_depth_m = t.point.axial_depth_m, .radial_depth_m = radial_m, .direction = direction};
  const cutting::ForceCoefficients& k = milling.coefficients;
  spatial.coefficients = {.tangential_n_per_m2 = {k.tangential_n_per_m2},
                          .radial_n_per_m2 = {k.radial_n_per_m2},
                          .axial_n_per_m2 = {1e8},
                          .tangential_edge_n_per_m = {k.tangential_edge_n_per_m},
                          .radial_edge_n_per_m = {k.radial_edge_n_per_m}};
  spatial.feed_per_tooth_m = milling.feed_per_tooth_m;
  return t;
}

/// Of a slot whose teeth stand at both walls at once the errors are equal and opposite: either counts.
double signless(const Twin& t, double error_m) {
  return t.space.spatial->cut.direction == MillingDirection::slot ? std::abs(error_m) : error_m;
}

// Two ways to one orbit: a dense solve for the state of the plane's collocation, harmonics between entries and exits
// here.
TEST(SurfaceErrorSpatial, OfAnUprightFlatEndIsThatOfThePlane) {
  int stable = 0, unequal = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    Random random(481, seed);
    const Twin t = twin(random, false);
    const SurfacePoint plane = surface_point(t.plane, t.point, 1e-9);
    const SurfacePoint space = surface_point(t.space, t.point, 1e-9);
    ASSERT_EQ(plane.stable, space.stable) << seed;
    if (!plane.stable) continue;
    ++stable;
    unequal += t.plane.milling.tool.runout_m > 0.0 || !t.plane.milling.tool.pitch_rad.empty() ? 1 : 0;
    const bool runout = t.plane.milling.tool.runout_m > 0.0;  // where the plane converges slowly
    const double scale = std::max(plane.peak_deflection_m, std::abs(plane.surface_location_error_m));
    EXPECT_NEAR(signless(t, space.surface_location_error_m), signless(t, plane.surface_location_error_m),
                (runout ? 1e-5 : 1e-6) * scale)
        << seed;
    EXPECT_NEAR(std::abs(space.place.normal_rad), 0.5 * pi, 1e-12) << seed;
    EXPECT_NEAR(space.peak_deflection_m, plane.peak_deflection_m, 0.05 * plane.peak_deflection_m) << seed;
    EXPECT_EQ(space.peak_to_peak_z_m, 0.0) << seed;
  }
  EXPECT_GE(stable, 20);
  EXPECT_GE(unequal, 5);
}

// The plane looks at the tip's height alone; over the edge's height the error is that or greater.
TEST(SurfaceErrorSpatial, OfAHelixStartsAtTheTipWithThatOfThePlane) {
  int stable = 0;
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    Random random(482, seed);
    const Twin t = twin(random, true);
    if (!surface_point(t.plane, t.point).stable) continue;
    ++stable;
    const SurfacePoint plane = surface_point(t.plane, t.point, 1e-9);
    const SurfacePoint space = surface_point(t.space, t.point, 1e-9);
    double tip = 0.0;
    for (const SurfacePlace& place : surface_profile(t.space, t.point, 1e-9)) {
      if (place.height_m < 1e-5 * t.point.axial_depth_m && std::abs(place.error_m) > std::abs(tip)) tip = place.error_m;
    }
    EXPECT_NEAR(signless(t, tip), signless(t, plane.surface_location_error_m), 2e-5 * plane.peak_deflection_m) << seed;
    EXPECT_GE(std::abs(space.surface_location_error_m), std::abs(tip) * (1.0 - 1e-12)) << seed;
  }
  EXPECT_GE(stable, 15);
}

/// A ball or bull nose that leans, in the plane's own words.
struct Leaning {
  LobesProblem problem;
  OperatingPoint point;
};

cutting::Cutter leaning_cutter(Random& random) {
  cutting::Cutter cutter;
  cutting::FlatEndMill& mill = cutter.mill;
  cutter.kind = random.index(2) == 0 ? CutterKind::ball_end : CutterKind::bull_nose;
  mill.teeth = 1 + static_cast<int>(random.index(4));
  mill.diameter_m = random.uniform(0.006, 0.016);
  mill.helix_rad = random.uniform(0.0, 0.6);
  if (cutter.kind == CutterKind::bull_nose) cutter.corner_radius_m = random.uniform(0.2, 0.4) * mill.diameter_m;
  if (mill.teeth > 1 && random.index(3) == 0) {
    mill.pitch_rad.assign(static_cast<std::size_t>(mill.teeth), 2.0 * pi / mill.teeth);
    mill.pitch_rad.front() += 0.15;
    mill.pitch_rad.back() -= 0.15;
  }
  return cutter;
}

std::optional<Leaning> leaning(std::uint64_t seed) {
  Random random(483, seed);
  Leaning drawn;
  SpatialMilling& milling = drawn.problem.spatial.emplace();
  milling.cutter = leaning_cutter(random);
  const bool ball = milling.cutter.kind == CutterKind::ball_end;
  const double rounded_m = ball ? 0.5 * milling.cutter.mill.diameter_m : milling.cutter.corner_radius_m;
  milling.cut.axial_depth_m = rounded_m * random.uniform(0.05, 0.3);
  milling.cut.radial_depth_m = milling.cutter.mill.diameter_m * random.uniform(0.05, 0.3);
  milling.cut.direction = static_cast<MillingDirection>(random.index(3));
  milling.cut.lead_rad = random.uniform(0.1, 0.4) * (ball && random.index(2) == 0 ? -1.0 : 1.0);
  milling.cut.tilt_rad = random.uniform(-0.4, 0.4);
  milling.coefficients = {.tangential_n_per_m2 = {random.uniform(6e8, 1e9)},
                          .radial_n_per_m2 = {random.uniform(1e8, 4e8)},
                          .axial_n_per_m2 = {random.uniform(5e7, 2e8)},
                          .tangential_edge_n_per_m = {random.uniform(0.0, 400.0)},
                          .radial_edge_n_per_m = {random.uniform(0.0, 400.0)},
                          .axial_edge_n_per_m = {random.uniform(-100.0, 100.0)}};
  milling.feed_per_tooth_m = 1e-6;  // the simulation knows terms of the order of feed / diameter
  if (random.index(3) == 0) {
    milling.cutter.mill.runout_m = random.uniform(0.1e-6, 0.5e-6);
    milling.cutter.mill.runout_angle_rad = random.uniform(0.0, 2.0 * pi);
  }
  std::vector<testing::RealMode> modes;
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d along = Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized();
    modes.push_back({random.uniform(300.0, 1200.0), random.uniform(0.03, 0.06), random.uniform(0.1, 0.4), along});
  }
  drawn.problem.dynamics = testing::spatial_model(modes);
  drawn.point = {random.uniform(4000.0, 14000.0) * rpm, milling.cut.axial_depth_m};
  try {
    static_cast<void>(cutting::engage(milling.cutter, milling.cut));
  } catch (const InvalidInput&) {
    return std::nullopt;  // it reaches the shank
  }
  return drawn;
}

/// One revolution of the settled motion in F, step by step.
std::vector<Eigen::Vector3d> simulated(const Leaning& drawn, int steps) {
  const SpatialMilling& milling = *drawn.problem.spatial;
  simulation::PostureCut cut;
  cut.cutter = milling.cutter;
  cut.engagement = cutting::engage(milling.cutter, milling.cut, {.rings_per_stretch = 14});
  cut.coefficients = milling.coefficients;
  cut.motion = {.feed_per_tooth_m = milling.feed_per_tooth_m,
                .spindle_speed_rad_per_s = drawn.point.spindle_speed_rad_per_s};
  cut.structure = tip_modes(drawn.problem);
  simulation::testing::Process run(cut, steps, simulation::detail::Physics::linear);
  std::vector<Eigen::Vector3d> last(static_cast<std::size_t>(steps)), now = last;
  for (int turn = 0; turn < 400; ++turn) {
    double moved = 0.0, largest = 0.0;
    for (int i = 1; i <= steps; ++i) {
      run.engine.step();
      now[static_cast<std::size_t>(i % steps)] = run.displacement();
    }
    for (std::size_t i = 0; i < now.size(); ++i) {
      moved = std::max(moved, (now[i] - last[i]).norm());
      largest = std::max(largest, now[i].norm());
    }
    last = now;
    if (moved < 1e-4 * largest) break;
  }
  return last;
}

/// Where a ball or a bull nose has the normal at ψ, by the torus that it is a part of.
struct Generating {
  Eigen::Vector3d normal, place;  ///< in F
  double angle = 0.0, height = 0.0, sine = 0.0;
};

Generating generating(const SpatialMilling& milling, double psi) {
  const double corner = milling.cutter.kind == CutterKind::ball_end ? 0.5 * milling.cutter.mill.diameter_m
                                                                    : milling.cutter.corner_radius_m;
  const double center = 0.5 * milling.cutter.mill.diameter_m - corner;
  const Eigen::Matrix3d turn = cutting::feed_from_tool(milling.cut.lead_rad, milling.cut.tilt_rad);
  Generating g;
  g.normal = {0.0, std::sin(psi), -std::cos(psi)};
  const Eigen::Vector3d n = turn.transpose() * g.normal;
  const Eigen::Vector3d out = Eigen::Vector3d(n.x(), n.y(), 0.0).normalized();
  const Eigen::Vector3d place = center * out + corner * n + corner * Eigen::Vector3d::UnitZ();
  g.place = turn * place;
  g.angle = std::atan2(n.x(), n.y());
  g.height = place.z();
  g.sine = std::hypot(n.x(), n.y());
  return g;
}

/// The error of greatest magnitude over what one pass leaves beside equal passes, found by looking: at each y the
/// lowest of this pass and both neighbours.
double looked_up(const Leaning& drawn, const std::vector<Eigen::Vector3d>& q) {
  const SpatialMilling& milling = *drawn.problem.spatial;
  const cutting::FlatEndMill& mill = milling.cutter.mill;
  const int looks = 8000;
  std::vector<Generating> all;
  double lowest = 1.0;
  for (int i = 0; i <= looks; ++i) {
    const Generating g = generating(milling, -1.0 + 2.0 * i / looks);
    lowest = std::min(lowest, g.place.z());
    all.push_back(g);
  }
  const auto height_at = [&](double y) {
    const auto after = std::ranges::upper_bound(all, y, {}, [](const Generating& g) { return g.place.y(); });
    if (after == all.begin() || after == all.end()) return 1.0;
    const Generating& low = *std::prev(after);
    const double share = (y - low.place.y()) / (after->place.y() - low.place.y());
    return low.place.z() + share * (after->place.z() - low.place.z());
  };
  const auto displaced = [&](double rotation) {
    const double steps = static_cast<double>(q.size());
    double at = rotation / (2.0 * pi) * steps;
    at -= steps * std::floor(at / steps);
    const std::size_t i = static_cast<std::size_t>(at) % q.size();
    const double share = at - std::floor(at);
    return Eigen::Vector3d((1.0 - share) * q[i] + share * q[(i + 1) % q.size()]);
  };
  double worst = 0.0;
  for (const Generating& g : all) {
    if (g.place.z() - lowest > milling.cut.axial_depth_m) continue;
    const double step = milling.cut.radial_depth_m;
    if (milling.cut.direction != MillingDirection::slot &&
        std::min(height_at(g.place.y() - step), height_at(g.place.y() + step)) < g.place.z()) {
      continue;
    }
    double stiff = -1.0, reach = -1.0;
    for (int j = 0; j < mill.teeth; ++j) {
      const double longer = mill.radius_deviation_m(j, g.height) * g.sine;
      const double rotation = g.angle - mill.standing_angle(j) + mill.lag_rad_per_m(j) * g.height;
      stiff = std::max(stiff, longer);
      reach = std::max(reach, longer + g.normal.dot(displaced(rotation)));
    }
    if (std::abs(stiff - reach) > std::abs(worst)) worst = stiff - reach;
  }
  return worst;
}

/// Half the greatest distance between two places.
double half_extent(const std::vector<Eigen::Vector3d>& q) {
  double widest = 0.0;
  for (std::size_t i = 0; i < q.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) widest = std::max(widest, (q[i] - q[j]).squaredNorm());
  }
  return 0.5 * std::sqrt(widest);
}

// Integrated in time, and the profile that remains found by looking: no code in common but the engagement.
TEST(SurfaceErrorSpatial, OfLeaningBallsAndBullNosesIsWhatTheSimulationLeaves) {
  int compared = 0, unequal = 0;
  const int cuts = test::seeds(300);
  for (std::uint64_t seed = 0; compared < cuts; ++seed) {
    ASSERT_LT(seed, 1000U);
    const std::optional<Leaning> drawn = leaning(seed);
    if (!drawn) continue;
    if (evaluate_point(drawn->problem, {.tolerance = 1e-2}, drawn->point).spectral_radius > 0.8) continue;
    const SurfacePoint found = surface_of_stable_cut(drawn->problem, drawn->point, 1e-4);
    const std::vector<Eigen::Vector3d> q = simulated(*drawn, 720);
    double largest = 0.0;
    for (const Eigen::Vector3d& at : q) largest = std::max(largest, at.norm());
    EXPECT_NEAR(found.peak_deflection_m, largest, 0.02 * largest) << seed;  // found at 16 looks a period
    const double extent = half_extent(q);
    EXPECT_NEAR(found.vibration.amplitude_m, extent, 0.03 * extent) << seed;
    EXPECT_EQ(found.vibration.amplitude_m, ForcedResponse(drawn->problem).at(drawn->point).amplitude_m) << seed;
    const cutting::FlatEndMill& mill = drawn->problem.spatial->cutter.mill;
    // Which tooth misses changes along the profile, where neither places a ring.
    const double share = mill.runout_m > 0.0 ? 0.03 : 0.01;
    EXPECT_NEAR(found.surface_location_error_m, looked_up(*drawn, q), share * largest) << seed;
    unequal += mill.teeth > 1 && (mill.runout_m > 0.0 || !mill.pitch_rad.empty()) ? 1 : 0;
    ++compared;
  }
  EXPECT_GE(unequal, compared / 5);
}

LobesProblem fed(CutterKind kind, const testing::CutInShopUnits& cut) {
  LobesProblem problem = testing::spatial_problem(kind, 10, 2, cut, {800, 300, 200}, testing::xyz(0.4, 0.5, 0.4));
  if (kind == CutterKind::bull_nose) problem.spatial->cutter.corner_radius_m = 2e-3;
  problem.spatial->feed_per_tooth_m = 0.05e-3;
  problem.spatial->coefficients.radial_edge_n_per_m = {5e3};
  return problem;
}

// On a ball the cusps on both sides lie half a step-over away, whatever lead and tilt.
TEST(SurfaceErrorSpatial, OfABallLooksFromCuspToCusp) {
  for (const MillingDirection direction : {MillingDirection::up, MillingDirection::down}) {
    for (const double lead : {-20.0, 0.0, 15.0}) {
      const LobesProblem problem = fed(CutterKind::ball_end, {0.4, 1.2, direction, lead, 10.0});
      const std::vector<SurfacePlace> profile = surface_profile(problem, {9000 * rpm, 0.4e-3});
      const auto [low, high] = std::ranges::minmax_element(profile, {}, &SurfacePlace::normal_rad);
      EXPECT_NEAR(low->normal_rad, -std::asin(0.6 / 5.0), 1e-6);
      EXPECT_NEAR(high->normal_rad, std::asin(0.6 / 5.0), 1e-6);
      const SurfacePoint point = surface_point(problem, {9000 * rpm, 0.4e-3});
      EXPECT_TRUE(point.remains);
      double worst = 0.0;
      for (const SurfacePlace& place : profile) {
        worst = std::max(worst, std::abs(place.error_m));
        EXPECT_NEAR(std::hypot(place.radius_m, place.height_m - 5e-3), 5e-3, 1e-12);
      }
      EXPECT_EQ(std::abs(point.surface_location_error_m), worst);
    }
  }
}

// A shallow cut leaves what lies below the stock on its open side, a slot both flanks.
TEST(SurfaceErrorSpatial, OfAShallowCutEndsAtTheStock) {
  const double flank = std::acos(1.0 - 0.1 / 5.0);
  const auto range = [&](MillingDirection direction) {
    const std::vector<SurfacePlace> profile =
        surface_profile(fed(CutterKind::ball_end, {0.1, 3.0, direction, 10.0, 0.0}), {9000 * rpm, 0.1e-3});
    const auto [low, high] = std::ranges::minmax_element(profile, {}, &SurfacePlace::normal_rad);
    return std::pair(low->normal_rad, high->normal_rad);
  };
  EXPECT_NEAR(range(MillingDirection::slot).first, -flank, 1e-6);
  EXPECT_NEAR(range(MillingDirection::slot).second, flank, 1e-6);
  EXPECT_NEAR(range(MillingDirection::up).first, -flank, 1e-6);
}

// A wall that the next pass would take is the part's own where nothing else is left; a leaning edge leaves the floor.
TEST(SurfaceErrorSpatial, OfUprightWallsAndLeaningFloors) {
  const OperatingPoint point{9000 * rpm, 1e-3};
  for (const CutterKind kind : {CutterKind::flat_end, CutterKind::bull_nose}) {
    const SurfacePoint wall = surface_point(fed(kind, {1.0, 2.0, MillingDirection::down, 0.0, 0.0}), point);
    EXPECT_FALSE(wall.remains);
    EXPECT_LT(wall.place.normal_rad, 0.0);  // down-milling leaves the side towards -y
    const LobesProblem leaning = fed(kind, {1.0, 2.0, MillingDirection::down, 3.0, 0.0});
    EXPECT_TRUE(surface_point(leaning, point).remains);
    for (const SurfacePlace& place : surface_profile(leaning, point)) EXPECT_LT(std::abs(place.normal_rad), 0.3);
  }
}

// A tool that is pushed away from the floor leaves material standing on it, one that is drawn in takes too much.
TEST(SurfaceErrorSpatial, IsPositiveWhereMaterialIsLeft) {
  LobesProblem problem = fed(CutterKind::ball_end, {0.3, 0.5, MillingDirection::down, 20.0, 0.0});
  problem.dynamics = testing::spatial_model({{2000.0, 0.5, 1.0, Eigen::Vector3d::UnitZ()}});
  problem.spatial->coefficients.radial_n_per_m2 = {0.0};
  problem.spatial->coefficients.radial_edge_n_per_m = {0.0};
  const OperatingPoint point{1000 * rpm, 0.3e-3};
  problem.spatial->coefficients.axial_n_per_m2 = {1e9};
  problem.spatial->coefficients.tangential_n_per_m2 = {1e6};
  EXPECT_GT(surface_point(problem, point).surface_location_error_m, 0.0);
  problem.spatial->coefficients.axial_n_per_m2 = {-1e9};
  EXPECT_LT(surface_point(problem, point).surface_location_error_m, 0.0);
}

// Rings of the same slot handed in as found: everything that the pass leaves counts, as in a slot.
TEST(SurfaceErrorSpatial, OfAGivenEngagementIsThatOfItsRings) {
  for (const CutterKind kind : {CutterKind::flat_end, CutterKind::ball_end, CutterKind::bull_nose}) {
    for (const double lead : {0.0, 12.0}) {
      LobesProblem problem = fed(kind, {0.8, 10.0, MillingDirection::slot, lead, 0.0});
      problem.spatial->cutter.mill.teeth = 3;  // of two one stands at either flank at once
      const double speed = 9300 * rpm;
      const SurfacePoint known = surface_point(problem, {speed, 0.8e-3});
      ASSERT_TRUE(known.stable);
      problem.spatial->engagement = cutting::engage(problem.spatial->cutter, problem.spatial->cut, {.slices = 200});
      const SurfacePoint given = surface_point(problem, {speed, engaged_height_m(*problem.spatial->engagement)});
      ASSERT_TRUE(given.stable);
      EXPECT_FALSE(given.remains);
      EXPECT_NEAR(std::abs(given.surface_location_error_m), std::abs(known.surface_location_error_m),
                  0.02 * known.peak_deflection_m);
    }
  }
}

// Modes that lean with the tool are the same structure in other axes.
TEST(SurfaceErrorSpatial, IsTheSameInTheToolsAxes) {
  LobesProblem problem = fed(CutterKind::bull_nose, {0.5, 2.0, MillingDirection::up, 12.0, -8.0});
  problem.spatial->cutter.mill.pitch_rad = {3.0, 2.0 * pi - 3.0};
  const OperatingPoint point{9000 * rpm, 0.5e-3};
  const SurfacePoint feed = surface_point(problem, point);
  const Eigen::Matrix3d turn =
      cutting::feed_from_tool(problem.spatial->cut.lead_rad, problem.spatial->cut.tilt_rad).transpose();
  for (modal::Mode& mode : problem.dynamics.modes) {
    mode.left = (turn * mode.left).eval();
    mode.right = (turn * mode.right).eval();
  }
  problem.spatial->modes_turn_with_tool = true;
  const SurfacePoint tool = surface_point(problem, point);
  ASSERT_TRUE(feed.stable && tool.stable);
  EXPECT_NEAR(tool.surface_location_error_m, feed.surface_location_error_m, 1e-9 * feed.peak_deflection_m);
  EXPECT_NEAR(tool.peak_to_peak_z_m, feed.peak_to_peak_z_m, 1e-9 * feed.peak_deflection_m);
}

TEST(SurfaceErrorSpatial, SaysWhatItCannotSee) {
  LobesProblem problem = fed(CutterKind::ball_end, {0.4, 1.2, MillingDirection::up, 10.0, 0.0});
  LobesProblem light = problem;
  light.dynamics = testing::xyz(0.01, 0.01, 0.01);
  EXPECT_FALSE(surface_point(light, {9000 * rpm, 2e-3}).stable);
  EXPECT_TRUE(std::isnan(surface_point(light, {9000 * rpm, 2e-3}).surface_location_error_m));
  problem.spatial->feed_per_tooth_m = 0.0;
  EXPECT_EQ(test::field_of([&] { static_cast<void>(surface_point(problem, {900.0, 1e-4})); }), "feed_per_tooth_m");
  LobesProblem drill = problem;
  drill.spatial.reset();
  drill.drilling = cutting::Drill{.diameter_m = 0.01, .coefficients = {.tangential_n_per_m2 = 8e8}};
  EXPECT_EQ(test::field_of([&] { static_cast<void>(surface_point(drill, {900.0, 1e-4})); }), "drilling");
  EXPECT_EQ(test::field_of([&] {
              static_cast<void>(surface_profile(testing::benchmark(0.1), {900.0, 1e-4}));
            }),
            "feed_per_tooth_m");
}

}  // namespace surface_error_spatial_test
}  // namespace robomill::stability
