#include "robomill/simulation/posture.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/random.hpp"
#include "robomill/simulation/drilling.hpp"
#include "testing/cutting/cutters.hpp"
#include "testing/simulation/posture_cases.hpp"
#include "testing/support.hpp"

namespace robomill::simulation {
namespace posture_test {

using detail::Physics;
using std::numbers::pi;
using testing::Process;
using testing::revolution;
using testing::rigid_force;

/// Of the forces over the third revolution from those of a cutter that cannot vibrate, of the largest force.
struct Difference {
  double largest = 0.0, mean = 0.0;
};
Difference from_rigid(const PostureCut& cut, int steps, int parts = 128) {
  Process run(cut, steps, Physics::full);
  Difference d;
  double largest = 0.0;
  for (int i = 0; i < 3 * steps; ++i) {
    run.engine.step();
    if (i < 2 * steps) continue;
    Eigen::Vector3d expected = Eigen::Vector3d::Zero();
    for (int p = 0; p < parts; ++p) expected += rigid_force(cut, revolution * (i + (p + 0.5) / parts) / steps) / parts;
    d.largest = std::max(d.largest, (run.force() - expected).norm());
    d.mean += (run.force() - expected).norm() / steps;
    largest = std::max(largest, expected.norm());
  }
  return {d.largest / largest, d.mean / largest};
}

TEST(Posture, ARigidCutterFeelsTheStaticForceInEveryPosture) {
  for (const auto& [lead, tilt] : {std::pair{0.0, 0.0}, {0.3, 0.0}, {-0.2, 0.4}, {0.1, -0.5}}) {
    EXPECT_LT(from_rigid(testing::ball_cut(lead, tilt), 720).largest, 1e-3) << lead << " " << tilt;
  }
}

// Random cutters of every kind, any lead and tilt, chips of a finishing and of a roughing cut: cutting_force, whose
// means over a step are exact.
TEST(Posture, ARigidCutterFeelsTheCuttingForceOfItsEngagement) {
  constexpr int steps = 720;
  int compared = 0;
  for (int seed = 0; seed < test::seeds(100); ++seed) {
    Random random(31, static_cast<std::uint64_t>(seed));
    PostureCut cut = testing::ball_cut(0.0, 0.0, 1);
    cut.cutter = cutting::testing::random_cutter(random, static_cast<cutting::CutterKind>(random.index(4)));
    const cutting::Cut pass = cutting::testing::random_cut(random, cut.cutter);
    try {
      cut.engagement = cutting::engage(cut.cutter, pass, {.slices = 30});
    } catch (const InvalidInput&) {
      continue;  // on the shank
    }
    cut.motion.feed_per_tooth_m = (seed % 3 == 0 ? 1e-5 : 0.02) * cut.cutter.mill.diameter_m;
    cut.coefficients.axial_n_per_m2 = {4e8};
    if (seed % 2 == 1) {  // the chip alone, and shared unevenly
      cut.coefficients.tangential_edge_n_per_m.clear();
      cut.coefficients.radial_edge_n_per_m.clear();
      cut.coefficients.axial_edge_n_per_m.clear();
      cut.cutter.mill.runout_m = random.uniform(0.0, 0.5) * cut.motion.feed_per_tooth_m;
      cut.cutter.mill.runout_angle_rad = random.uniform(0.0, revolution);
    }
    const cutting::CuttingForce expected =
        cutting::cutting_force(cut.cutter, cut.engagement, cut.coefficients, cut.motion, {.steps = steps});
    ++compared;
    // Its steps are centred at the rotation: two of half the size.
    Process run(cut, 2 * steps, Physics::full);
    Eigen::Vector3d half = Eigen::Vector3d::Zero();
    double largest = 0.0;
    for (int i = 0; i < 4 * steps; ++i) {
      run.engine.step();
      if (i > 2 * steps && i % 2 == 0) {
        const Eigen::Vector3d force = 0.5 * (half + run.force());
        largest = std::max(largest, (force - expected.force_n.col(i / 2 - steps)).norm());
      }
      half = run.force();
    }
    EXPECT_LT(largest, 1e-3 * expected.peak_force_n) << seed;
  }
  EXPECT_GT(compared, test::seeds(100) / 2);
}

// Teeth that run out, and a pitch that shares the feed unevenly: the force in closed form again. What is of second
// order in feed over diameter is not in that form.
TEST(Posture, RunoutAndUnequalPitchShareTheChip) {
  PostureCut cut = testing::ball_cut(0.15, -0.2);
  cut.motion.feed_per_tooth_m = 2e-7;
  cut.cutter.mill.teeth = 3;
  cut.cutter.mill.pitch_rad = {100.0 * pi / 180.0, 117.0 * pi / 180.0, 143.0 * pi / 180.0};
  EXPECT_LT(from_rigid(cut, 720).largest, 1e-3);
  cut.cutter.mill.runout_m = 4e-8;
  cut.cutter.mill.runout_angle_rad = 0.7;
  // Where a tooth begins to miss, its edge force ends at the end of the step.
  EXPECT_LT(from_rigid(cut, 720).mean, 2e-3);
  cut.coefficients.tangential_edge_n_per_m.clear();
  cut.coefficients.radial_edge_n_per_m.clear();
  cut.coefficients.axial_edge_n_per_m.clear();
  EXPECT_LT(from_rigid(cut, 720).largest, 1e-3);
}

/// A cylinder as a cutter of any shape, its rings those of milling_model's slices.
PostureCut as_posture(const MillingCut& cut, int slices, double turn) {
  PostureCut same;
  same.cutter.mill = cut.milling.tool;
  cutting::Engagement& e = same.engagement;
  e.feed_from_tool = Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  e.first_arc = {0};
  const double tangent = std::tan(cut.milling.tool.helix_rad);
  double entry = cut.milling.immersion.entry_rad + turn;
  entry -= revolution * std::floor(entry / revolution);
  for (int i = 0; i < slices; ++i) {
    e.slices.push_back({.radius_m = 0.5 * cut.milling.tool.diameter_m,
                        .height_m = (i + 0.5) * cut.axial_depth_m / slices,
                        .position_rad = 0.5 * pi,
                        .width_m = cut.axial_depth_m / slices,
                        .edge_length_per_width = std::hypot(1.0, tangent)});
    e.arcs.push_back({entry, entry + cut.milling.immersion.exit_rad - cut.milling.immersion.entry_rad});
    e.first_arc.push_back(e.arcs.size());
  }
  const cutting::ForceCoefficients& k = cut.milling.coefficients;
  same.coefficients = {.tangential_n_per_m2 = {k.tangential_n_per_m2},
                       .radial_n_per_m2 = {k.radial_n_per_m2},
                       .tangential_edge_n_per_m = {k.tangential_edge_n_per_m},
                       .radial_edge_n_per_m = {k.radial_edge_n_per_m}};
  same.motion = {.feed_per_tooth_m = cut.milling.feed_per_tooth_m,
                 .spindle_speed_rad_per_s = cut.spindle_speed_rad_per_s};
  same.structure = cut.structure;
  return same;
}

MillingCut plain_cut() {
  MillingCut cut = testing::rigid_cut();
  cut.milling.tool.teeth = 3;
  cut.milling.tool.helix_rad = 0.5;
  cut.milling.immersion = {.entry_rad = 0.6, .exit_rad = 2.2};
  cut.structure = modal::joined(testing::one_mode(0, 300.0, 0.03, 0.3), testing::one_mode(1, 420.0, 0.02, 0.2));
  cut.structure.compliance(0, 0) = 3e-8;
  cut.structure.compliance(0, 1) = 1e-8;
  return cut;
}

/// Largest difference of displacements and of forces, each of its largest.
double difference(const Simulation& a, const Simulation& b) {
  const double moved = (a.displacement_m - b.displacement_m).cwiseAbs().maxCoeff();
  const double pushed = (a.force_n - b.force_n).cwiseAbs().maxCoeff();
  return std::max(moved / a.displacement_m.cwiseAbs().maxCoeff(), pushed / a.force_n.cwiseAbs().maxCoeff());
}

TEST(Posture, ACylinderIsTheMillingCut) {
  MillingCut cut = plain_cut();
  cut.milling.tool.runout_m = 1e-5;
  cut.milling.tool.pitch_rad = {2.0, 2.1, revolution - 4.1};
  const SimulationOptions options = {.seconds = 0.2, .steps_per_revolution = 600, .slices = 6};
  const Simulation a = simulate(cut, options), b = simulate(as_posture(cut, 6, 0.0), options);
  EXPECT_LT(difference(a, b), 1e-12);
  EXPECT_NEAR(a.small.spectral_radius, b.small.spectral_radius, 0.02 * a.small.spectral_radius);  // 12 slices for 6
  EXPECT_EQ(b.slices, 6);
  EXPECT_TRUE(b.walls.empty());
  cut.milling.tool.helix_rad = 0.0;
  const SmallVibration one = small_vibration(cut), other = small_vibration(as_posture(cut, 1, 0.0));
  EXPECT_NEAR(one.spectral_radius, other.spectral_radius, 1e-9);
  EXPECT_EQ(one.period_s, other.period_s);
}

// Three even teeth look the same a third of a turn on: forces in F know nothing of how the tool frame is turned about
// the axis, which puts entry and exit on both sides of φ = 0.
TEST(Posture, ATurnOfTheToolFrameChangesNothing) {
  const MillingCut cut = plain_cut();
  const SimulationOptions options = {.seconds = 0.2, .steps_per_revolution = 600, .slices = 6};
  const Simulation straight = simulate(as_posture(cut, 6, 0.0), options);
  EXPECT_GT(straight.displacement_m.cwiseAbs().maxCoeff(), 1e-6);
  for (const double turns : {1.0, 2.0}) {
    const Simulation turned = simulate(as_posture(cut, 6, turns * revolution / 3.0), options);
    EXPECT_LT(difference(straight, turned), 1e-12);
  }
}

/// Lips on a cone fed along its axis: lead -90° turns the tool's -z into the feed.
PostureCut plunging(const DrillingCut& drill) {
  PostureCut cut;
  cut.cutter.kind = cutting::CutterKind::general;
  cut.cutter.mill.teeth = drill.lips;
  cut.cutter.mill.diameter_m = drill.diameter_m;
  cut.cutter.bottom_angle_rad = 0.5 * (pi - drill.point_angle_rad);
  const double kappa = cut.cutter.bottom_angle_rad;
  cut.engagement.slices = {{.radius_m = 0.4 * drill.diameter_m,
                            .height_m = 0.4 * drill.diameter_m * std::tan(kappa),
                            .position_rad = kappa,
                            .width_m = drill.radial_width_m / std::cos(kappa)}};
  cut.engagement.arcs = {{0.0, revolution}};
  cut.engagement.first_arc = {0, 1};
  cut.engagement.feed_from_tool = cutting::feed_from_tool(-0.5 * pi, 0.0);
  const cutting::ForceCoefficients& k = drill.coefficients;
  cut.coefficients = {.tangential_n_per_m2 = {k.tangential_n_per_m2},
                      .radial_n_per_m2 = {k.radial_n_per_m2},
                      .tangential_edge_n_per_m = {k.tangential_edge_n_per_m},
                      .radial_edge_n_per_m = {k.radial_edge_n_per_m}};
  cut.motion = {.feed_per_tooth_m = drill.feed_per_revolution_m / drill.lips,
                .spindle_speed_rad_per_s = drill.spindle_speed_rad_per_s};
  cut.structure = modal::turned(drill.structure, cut.engagement.feed_from_tool);
  return cut;
}

DrillingCut drill() {
  DrillingCut cut;
  cut.diameter_m = 0.01;
  cut.radial_width_m = 5e-4;
  cut.feed_per_revolution_m = 1e-4;
  cut.coefficients = {
      .tangential_n_per_m2 = 9e8, .radial_n_per_m2 = 5e8, .tangential_edge_n_per_m = 8e3, .radial_edge_n_per_m = 6e3};
  cut.structure = modal::joined(testing::one_mode(0, 400.0, 0.03, 0.3), testing::one_mode(1, 430.0, 0.03, 0.3));
  cut.structure = modal::joined(cut.structure, testing::one_mode(2, 900.0, 0.03, 0.5));
  cut.spindle_speed_rad_per_s = 3000.0 * testing::rpm;
  return cut;
}

TEST(Posture, APlungingConeIsTheDrill) {
  DrillingCut one = drill();
  one.lips = 1;  // pushes sideways
  const SimulationOptions options = {.seconds = 0.1};
  const PostureCut cone = plunging(one);
  const Simulation a = simulate(one, options), b = simulate(cone, options);
  ASSERT_EQ(a.steps_per_revolution, b.steps_per_revolution);
  Simulation turned = a;
  turned.displacement_m = a.displacement_m * cone.engagement.feed_from_tool.transpose();
  turned.force_n = a.force_n * cone.engagement.feed_from_tool.transpose();
  EXPECT_LT(difference(turned, b), 1e-12);
  EXPECT_NEAR(a.small.spectral_radius, b.small.spectral_radius, 1e-9 * a.small.spectral_radius);
}

// Angles that all but close: the surface at exit must not run into that at entry.
TEST(Posture, AnglesMayNearlyCloseTheCircle) {
  for (const double gap : {1e-4, 0.02, 0.08, 0.3, 3.0}) {
    PostureCut cut = plunging(drill());
    cut.structure = testing::no_modes();
    cut.engagement.arcs = {{4.0, 4.0 + revolution - gap}};
    EXPECT_LT(from_rigid(cut, 600, 1000).largest, 1e-3) << gap;
  }
}

TEST(Posture, RejectsBadInput) {
  const auto rejected = [](auto change) {
    PostureCut cut = testing::ball_cut(0.2, 0.1, 6);
    change(cut);
    return test::field_of([&] { static_cast<void>(simulate(cut, {.seconds = 0.02})); });
  };
  using C = PostureCut;
  EXPECT_EQ(rejected([](C&) {}), "accepted");
  EXPECT_EQ(rejected([](C& c) { c.cutter.mill.teeth = 0; }), "teeth");
  EXPECT_EQ(rejected([](C& c) { c.engagement.first_arc.pop_back(); }), "engagement.first_arc");
  EXPECT_EQ(rejected([](C& c) { c.engagement.first_arc[1] = 99; }), "engagement.first_arc");
  EXPECT_EQ(rejected([](C& c) { c.engagement.slices[0].width_m = -1.0; }), "engagement.slices");
  EXPECT_EQ(rejected([](C& c) { c.engagement.arcs[0].exit_rad = c.engagement.arcs[0].entry_rad; }), "engagement.arcs");
  EXPECT_EQ(rejected([](C& c) { c.engagement.arcs[0].exit_rad += 7.0; }), "engagement.arcs");
  EXPECT_EQ(rejected([](C& c) { c.engagement.feed_from_tool *= 2.0; }), "engagement.feed_from_tool");
  EXPECT_EQ(rejected([](C& c) { c.engagement.feed_from_tool.row(0) *= -1.0; }), "engagement.feed_from_tool");
  EXPECT_EQ(rejected([](C& c) { c.motion.feed_per_tooth_m = 0.0; }), "motion.feed_per_tooth_m");
  EXPECT_EQ(rejected([](C& c) { c.motion.spindle_speed_rad_per_s = 0.0; }), "motion.spindle_speed_rad_per_s");
  EXPECT_EQ(rejected([](C& c) { c.coefficients.tangential_n_per_m2.clear(); }), "tangential_n_per_m2");
  EXPECT_EQ(rejected([](C& c) { c.structure.compliance(2, 2) = std::nan(""); }), "structure");
}

}  // namespace posture_test
}  // namespace robomill::simulation
