#include "robomill/cutting/milling.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "robomill/base/error.hpp"
#include "robomill/base/random.hpp"
#include "robomill/cutting/force.hpp"
#include "testing/support.hpp"

namespace robomill::cutting {
namespace milling_test {

using std::numbers::pi;
using test::field_of;
using test::seeds;

Milling robot_cut() {
  Milling m;
  m.tool.teeth = 3;
  m.tool.diameter_m = 0.012;
  m.immersion = immersion(MillingDirection::up, 1.8e-3, 0.012);
  m.coefficients = {.tangential_n_per_m2 = 712e6, .radial_n_per_m2 = 287e6};
  return m;
}

Milling random_cut(Random& random) {
  Milling m;
  m.tool.teeth = 1 + static_cast<int>(random.index(6));
  m.tool.diameter_m = random.uniform(0.002, 0.05);
  m.tool.helix_rad = random.uniform(-0.9, 0.9);
  m.immersion.entry_rad = random.uniform(0.0, 0.9 * pi);
  m.immersion.exit_rad = random.uniform(m.immersion.entry_rad + 0.05, pi);
  m.coefficients = {.tangential_n_per_m2 = random.uniform(1e8, 3e9), .radial_n_per_m2 = random.uniform(-1e8, 1e9)};
  return m;
}

TEST(Immersion, UpAndDownMillingTouchTheWallOfTheSlot) {
  const Immersion up = immersion(MillingDirection::up, 0.6e-3, 12e-3);
  EXPECT_DOUBLE_EQ(up.entry_rad, 0.0);
  EXPECT_DOUBLE_EQ(up.exit_rad, std::acos(0.9));
  const Immersion down = immersion(MillingDirection::down, 0.6e-3, 12e-3);
  EXPECT_DOUBLE_EQ(down.entry_rad, std::acos(-0.9));
  EXPECT_DOUBLE_EQ(down.exit_rad, pi);
  for (const MillingDirection direction : {MillingDirection::up, MillingDirection::down}) {
    const Immersion full = immersion(direction, 12e-3, 12e-3);
    EXPECT_NEAR(full.entry_rad, 0.0, 1e-7);
    EXPECT_NEAR(full.exit_rad, pi, 1e-7);
  }
}

TEST(Immersion, GivesBackItsRadialDepth) {
  for (const double b : {0.1e-3, 1.8e-3, 6e-3, 11.9e-3}) {
    EXPECT_NEAR(radial_depth(immersion(MillingDirection::up, b, 12e-3), 12e-3), b, 1e-15);
    EXPECT_NEAR(radial_depth(immersion(MillingDirection::down, b, 12e-3), 12e-3), b, 1e-15);
  }
  EXPECT_NEAR(radial_depth(immersion(MillingDirection::slot, 0.0, 12e-3), 12e-3), 12e-3, 1e-15);
}

// A step outwards along the tooth's radius (sin φ, cos φ) makes the chip thicker and the force on the tool is -Kt along
// the cutting speed (cos φ, -sin φ) and -Kr along the radius; a step along the edge's path changes nothing.
TEST(DirectionalCoefficients, TakeTheForceFromTheChipThickness) {
  const ForceCoefficients k{.tangential_n_per_m2 = 6e8, .radial_n_per_m2 = 2e8};
  for (double angle = 0.0; angle < 2.0 * pi; angle += 0.1) {
    const Eigen::Vector2d radius(std::sin(angle), std::cos(angle));
    const Eigen::Vector2d path(std::cos(angle), -std::sin(angle));
    const Eigen::Matrix2d kappa = directional_coefficients(k, angle);
    EXPECT_NEAR((kappa * radius + 6e8 * path + 2e8 * radius).norm(), 0.0, 1e-6);
    EXPECT_NEAR((kappa * path).norm(), 0.0, 1e-6);
  }
}

// Source: [Altintas1995], the zero-order directional factors over one tooth period: F = a Kt/2 N/2π α Δ with
// α_xx = [cos 2φ - 2 r φ + r sin 2φ]/2, α_xy = [-sin 2φ - 2 φ + r cos 2φ]/2, α_yx = [-sin 2φ + 2 φ + r cos 2φ]/2,
// α_yy = [-cos 2φ - 2 r φ - r sin 2φ]/2 between entry and exit, r = Kr/Kt.
TEST(MeanCuttingStiffness, OfAToothPeriodIsThePublishedZeroOrderFactor) {
  const Milling m = robot_cut();
  const double r = 287.0 / 712.0;
  const auto alpha = [r](double phi) {
    Eigen::Matrix2d a;
    const double s = std::sin(2.0 * phi), c = std::cos(2.0 * phi);
    a << c - 2.0 * r * phi + r * s, -s - 2.0 * phi + r * c, -s + 2.0 * phi + r * c, -c - 2.0 * r * phi - r * s;
    return Eigen::Matrix2d(0.5 * a);
  };
  const Eigen::Matrix2d expected =
      3.0 / (4.0 * pi) * 712e6 * 1e-3 * (alpha(m.immersion.exit_rad) - alpha(m.immersion.entry_rad));
  Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
  for (int j = 0; j < 3; ++j) sum += mean_cutting_stiffness(m, j, 0.0, 2.0 * pi / 3.0, 1e-3);
  EXPECT_LT((sum - expected).norm(), 1e-12 * expected.norm());
}

// The closed forms against thin slices, each of which is one edge point.
TEST(CuttingStiffness, IsTheLimitOfThinAxialSlices) {
  for (int seed = 0; seed < seeds(100); ++seed) {
    Random random(1, static_cast<std::uint64_t>(seed));
    const Milling m = random_cut(random);
    const double depth = random.uniform(0.0001, 0.03);
    const double rotation = random.uniform(0.0, 2.0 * pi);
    const int tooth = static_cast<int>(random.index(static_cast<std::uint64_t>(m.tool.teeth)));
    const int slices = 200000;
    const double start = rotation + 2.0 * pi * tooth / m.tool.teeth;
    Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
    for (int i = 0; i < slices; ++i) {
      double angle = start - 2.0 * std::tan(m.tool.helix_rad) / m.tool.diameter_m * depth * (i + 0.5) / slices;
      angle -= 2.0 * pi * std::floor(angle / (2.0 * pi));
      if (angle < m.immersion.entry_rad || angle > m.immersion.exit_rad) continue;
      sum += directional_coefficients(m.coefficients, angle) * (depth / slices);
    }
    const double scale = depth * (m.coefficients.tangential_n_per_m2 + 1e9);
    EXPECT_LT((cutting_stiffness(m, tooth, rotation, depth) - sum).norm(), 1e-4 * scale) << seed;
  }
}

TEST(MeanCuttingStiffness, IsTheMeanOfTheStiffness) {
  for (int seed = 0; seed < seeds(200); ++seed) {
    Random random(2, static_cast<std::uint64_t>(seed));
    Milling m = random_cut(random);
    if (seed % 4 == 0) m.tool.helix_rad = 0.0;
    if (seed % 4 == 1) m.tool.helix_rad = 1e-9;
    const double depth = random.uniform(0.0001, 0.03);
    const double from = random.uniform(-7.0, 7.0);
    const double to = from + random.uniform(0.01, 7.0);
    const int count = 20000;
    Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
    for (int i = 0; i < count; ++i)
      sum += cutting_stiffness(m, 0, from + (to - from) * (i + 0.5) / count, depth) / count;
    const double scale = depth * (m.coefficients.tangential_n_per_m2 + 1e9);
    EXPECT_LT((mean_cutting_stiffness(m, 0, from, to, depth) - sum).norm(), 3e-4 * scale) << seed;
  }
}

TEST(MeanCuttingStiffness, LosesNothingWhereTheHelixIsSmall) {
  Milling m = robot_cut();
  const Eigen::Matrix2d straight = mean_cutting_stiffness(m, 0, 0.1, 0.15, 1e-3);
  for (const double helix : {1e-16, 1e-13, 1e-10}) {
    m.tool.helix_rad = helix;
    const Eigen::Matrix2d k = mean_cutting_stiffness(m, 0, 0.1, 0.15, 1e-3);
    EXPECT_LT((k - straight).norm(), 1e-10 * straight.norm()) << helix;
  }
}

// Where the helix lags by one tooth pitch over the depth, as much edge enters as leaves.
TEST(CuttingStiffness, OfAFullPitchOfLagDoesNotDependOnRotation) {
  Milling m = robot_cut();
  m.tool.helix_rad = 0.6;
  const double depth = 2.0 * pi / 3.0 / m.tool.lag_rad_per_m(0);
  const auto all = [&](double rotation) {
    Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
    for (int j = 0; j < 3; ++j) sum += cutting_stiffness(m, j, rotation, depth);
    return sum;
  };
  const Eigen::Matrix2d first = all(0.0);
  for (double rotation = 0.1; rotation < 7.0; rotation += 0.1) {
    EXPECT_LT((all(rotation) - first).norm(), 1e-12 * first.norm());
  }
}

TEST(FlatEndMill, ToothStandsWhereThePitchesBeforeItEnd) {
  Milling m = robot_cut();
  m.tool.pitch_rad = {1.9, 2.2, 2.0 * pi - 4.1};
  EXPECT_FALSE(m.tool.has_equal_pitch());
  Milling one = robot_cut();
  for (const double rotation : {0.2, 3.0, 5.9}) {
    const Eigen::Matrix2d expected = cutting_stiffness(one, 0, rotation + 4.1, 1e-3);
    EXPECT_LT((cutting_stiffness(m, 2, rotation, 1e-3) - expected).norm(), 1e-6);
  }
  m.tool.pitch_rad = {2.0 * pi / 3.0, 2.0 * pi / 3.0, 2.0 * pi / 3.0};
  EXPECT_TRUE(m.tool.has_equal_pitch());
}

// The mean of radius times tangential force.
TEST(MeanTorque, IsThatOfTheForceOverARevolution) {
  const Milling m = robot_cut();
  const double depth = 1.2e-3, feed = 0.01e-3;
  double torque = 0.0;
  const int count = 100000;
  for (int i = 0; i < count; ++i) {
    const double angle = 2.0 * pi * (i + 0.5) / count;
    if (angle > m.immersion.exit_rad) continue;
    torque += 3.0 * 712e6 * depth * feed * std::sin(angle) * 0.006 / count;
  }
  EXPECT_NEAR(mean_torque_n_m(m, depth, feed), torque, 1e-4 * torque);
  // The energy of a revolution is Kt times the volume that it removes.
  const double volume = depth * 1.8e-3 * feed * 3.0;
  EXPECT_NEAR(2.0 * pi * mean_torque_n_m(m, depth, feed), 712e6 * volume, 1e-12 * 712e6 * volume);
}

// Two methods: the closed form, and the sum over a revolution of the force model. Edge forces, helix, runout so large
// that teeth miss the cut, and unequal pitch.
TEST(MeanTorque, IsThatOfTheForceModel) {
  Random random(7);
  for (int seed = 0; seed < seeds(300); ++seed) {
    Milling m = robot_cut();
    m.tool.teeth = 1 + static_cast<int>(random.uniform(0.0, 4.999));
    m.tool.helix_rad = random.uniform(0.0, 0.8);
    m.coefficients.tangential_edge_n_per_m = random.uniform(0.0, 3e4);
    m.coefficients.radial_edge_n_per_m = random.uniform(0.0, 3e4);
    const double feed = random.uniform(0.01e-3, 0.1e-3);
    if (seed % 2 == 0) m.tool.runout_m = random.uniform(0.0, 60e-6);
    m.tool.runout_angle_rad = random.uniform(0.0, 6.0);
    m.feed_per_tooth_m = feed;
    if (seed % 3 == 0) {
      double sum = 0.0;
      for (int j = 0; j < m.tool.teeth; ++j) m.tool.pitch_rad.push_back(random.uniform(0.8, 1.2));
      for (const double pitch : m.tool.pitch_rad) sum += pitch;
      for (double& pitch : m.tool.pitch_rad) pitch *= 2.0 * pi / sum;
    }
    const MillingDirection directions[] = {MillingDirection::up, MillingDirection::down, MillingDirection::slot};
    const Cut cut = {.axial_depth_m = random.uniform(0.1e-3, 10e-3),
                     .radial_depth_m = random.uniform(0.05, 1.0) * m.tool.diameter_m,
                     .direction = directions[seed % 3]};
    m.immersion = immersion(cut.direction, cut.radial_depth_m, m.tool.diameter_m);
    const Cutter cutter = {.kind = CutterKind::flat_end, .mill = m.tool};
    const MillingCoefficients k = {.tangential_n_per_m2 = {m.coefficients.tangential_n_per_m2},
                                   .radial_n_per_m2 = {m.coefficients.radial_n_per_m2},
                                   .tangential_edge_n_per_m = {m.coefficients.tangential_edge_n_per_m},
                                   .radial_edge_n_per_m = {m.coefficients.radial_edge_n_per_m}};
    const CutMotion motion = {.feed_per_tooth_m = feed, .spindle_speed_rad_per_s = 800.0};
    const CuttingForce force = cutting_force(cutter, engage(cutter, cut, {.slices = 200}), k, motion);
    EXPECT_NEAR(mean_torque_n_m(m, cut.axial_depth_m, feed), force.mean_torque_n_m, 1e-3 * force.mean_torque_n_m)
        << seed;
  }
}

TEST(Milling, RejectsWhatCannotBe) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto rejected = [](auto change) {
    Milling m = robot_cut();
    change(m);
    return field_of([&] { m.validate(); });
  };
  EXPECT_EQ(rejected([](Milling&) {}), "accepted");
  EXPECT_EQ(rejected([](Milling& m) { m.tool.teeth = 0; }), "teeth");
  EXPECT_EQ(rejected([](Milling& m) { m.tool.diameter_m = 12.0; }), "diameter_m");
  EXPECT_EQ(rejected([&](Milling& m) { m.tool.diameter_m = nan; }), "diameter_m");
  EXPECT_EQ(rejected([](Milling& m) { m.tool.helix_rad = 30.0; }), "helix_rad");
  EXPECT_EQ(rejected([](Milling& m) { m.tool.pitch_rad = {2.0, 2.0}; }), "pitch_rad");
  EXPECT_EQ(rejected([](Milling& m) { m.tool.pitch_rad = {2.0, 2.0, 2.0}; }), "pitch_rad");
  EXPECT_EQ(rejected([](Milling& m) { m.tool.pitch_rad = {5.0, 2.0, 2.0 * pi - 7.0}; }), "pitch_rad[3]");
  EXPECT_EQ(rejected([](Milling& m) { m.immersion = {.entry_rad = -0.1, .exit_rad = 1.0}; }), "entry_rad");
  EXPECT_EQ(rejected([](Milling& m) { m.immersion = {.entry_rad = 1.0, .exit_rad = 1.0}; }), "exit_rad");
  EXPECT_EQ(rejected([](Milling& m) { m.immersion = {.entry_rad = 1.0, .exit_rad = 3.2}; }), "exit_rad");
  EXPECT_EQ(rejected([](Milling& m) { m.coefficients.tangential_n_per_m2 = 712.0; }), "tangential_n_per_m2");
  EXPECT_EQ(rejected([](Milling& m) { m.coefficients.tangential_n_per_m2 = 712e12; }), "tangential_n_per_m2");
  EXPECT_EQ(rejected([&](Milling& m) { m.coefficients.radial_n_per_m2 = nan; }), "radial_n_per_m2");
  EXPECT_EQ(rejected([](Milling& m) { m.coefficients.radial_n_per_m2 = 287.0; }), "radial_n_per_m2");
  EXPECT_EQ(rejected([](Milling& m) { m.coefficients.radial_n_per_m2 = 0.0; }), "accepted");
  const auto deep = [] { return immersion(MillingDirection::up, 0.013, 0.012); };
  EXPECT_EQ(field_of(deep), "radial_depth_m");
  EXPECT_EQ(field_of([] { return immersion(MillingDirection::down, 0.0, 0.012); }), "radial_depth_m");
  EXPECT_EQ(field_of([&] { return mean_torque_n_m(robot_cut(), nan, 1e-5); }), "axial_depth_m");
}

}  // namespace milling_test
}  // namespace robomill::cutting
