#include "robomill/simulation/drilling.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "testing/simulation/cuts.hpp"
#include "testing/support.hpp"

namespace robomill::simulation {
namespace drilling_test {

using std::numbers::pi;

DrillingCut drill() {
  DrillingCut cut;
  cut.diameter_m = 0.01;
  cut.radial_width_m = 0.003;
  cut.feed_per_revolution_m = 1e-4;
  cut.coefficients = {
      .tangential_n_per_m2 = 9e8, .radial_n_per_m2 = 5e8, .tangential_edge_n_per_m = 8e3, .radial_edge_n_per_m = 6e3};
  cut.structure = testing::no_modes();
  cut.spindle_speed_rad_per_s = 3000.0 * testing::rpm;
  return cut;
}

// Two lips push up alike and sideways against each other.
TEST(Drilling, ARigidDrillFeelsThrustAlone) {
  const DrillingCut cut = drill();
  const Simulation s = simulate(cut, {.seconds = 0.2});
  const double half = 0.5 * cut.point_angle_rad;
  const double width = cut.radial_width_m / std::sin(half), chip = 0.5e-4 * std::sin(half);
  const double thrust = 2.0 * width * (5e8 * chip + 6e3) * std::sin(half);
  EXPECT_EQ(s.verdict, Verdict::stable);
  const Eigen::Index middle = s.force_n.rows() / 2;
  EXPECT_NEAR(s.force_n(middle, 2), thrust, 1e-4 * thrust);
  EXPECT_NEAR(s.force_n.row(middle).head<2>().norm(), 0.0, 1e-9 * thrust);
  EXPECT_TRUE(s.walls.empty());
}

// One lip: the tangential force turns with it, and its torque is that of the cut.
TEST(Drilling, OneLipPushesSideways) {
  DrillingCut cut = drill();
  cut.lips = 1;
  const double half = 0.5 * cut.point_angle_rad;
  const double width = cut.radial_width_m / std::sin(half), chip = 1e-4 * std::sin(half);
  const Simulation s = simulate(cut, {.seconds = 0.2});
  const double tangential = width * (9e8 * chip + 8e3), inward = width * (5e8 * chip + 6e3) * std::cos(half);
  const Eigen::Index middle = s.force_n.rows() / 2;
  EXPECT_NEAR(s.force_n.row(middle).head<2>().norm(), std::hypot(tangential, inward), 1e-3 * tangential);
}

// An axial mode sees a delay equation with constant coefficients, c = n Kr b sin p: its roots by another method.
TEST(Drilling, AxialGrowthIsThatOfTheCharacteristicEquation) {
  const double mass = 0.8, zeta = 0.03, frequency = 600.0, omega = 2.0 * pi * frequency;
  for (const double speed_rpm : {2000.0, 6100.0, 11000.0, 17000.0}) {
    for (const double width_m : {0.5e-3, 2e-3, 4.5e-3}) {
      DrillingCut cut = drill();
      cut.structure = testing::one_mode(2, frequency, zeta, mass);
      cut.spindle_speed_rad_per_s = speed_rpm * testing::rpm;
      cut.radial_width_m = width_m;
      const double c = 2.0 * 5e8 * width_m * std::sin(0.5 * cut.point_angle_rad);
      const double expected = testing::axial_radius(mass, zeta, omega, c, 30.0 / speed_rpm);
      const SmallVibration small = small_vibration(cut);
      ASSERT_EQ(small.status, SmallVibration::Status::found);
      EXPECT_NEAR(small.spectral_radius, expected, 1e-3 * expected) << speed_rpm << " " << width_m;
    }
  }
}

// Source: [Tlusty1963], one mode: no speed chatters below c = 2 k ζ (1 + ζ).
TEST(Drilling, BelowTheTurningLimitNoSpeedChatters) {
  const double mass = 0.8, zeta = 0.05, frequency = 600.0, omega = 2.0 * pi * frequency;
  const double limit = 2.0 * mass * omega * omega * zeta * (1.0 + zeta);
  bool above_chatters = false;
  for (int i = 0; i < 30; ++i) {
    DrillingCut cut = drill();
    cut.structure = testing::one_mode(2, frequency, zeta, mass);
    cut.coefficients.radial_n_per_m2 = 8e8;
    cut.spindle_speed_rad_per_s = (3000.0 + 100.0 * i) * testing::rpm;
    const double per_width = 2.0 * 8e8 * std::sin(0.5 * cut.point_angle_rad);
    cut.radial_width_m = 0.97 * limit / per_width;
    ASSERT_LT(cut.radial_width_m, 0.005);
    EXPECT_LT(small_vibration(cut).spectral_radius, 1.0);
    cut.radial_width_m = std::min(1.05 * limit / per_width, 0.005);
    above_chatters = above_chatters || small_vibration(cut).spectral_radius > 1.0;
  }
  EXPECT_TRUE(above_chatters);
}

TEST(Drilling, LateralAndAxialModesTogetherGiveAVerdict) {
  DrillingCut cut = drill();
  cut.structure = modal::joined(testing::one_mode(0, 400.0, 0.03, 0.3), testing::one_mode(1, 430.0, 0.03, 0.3));
  cut.structure = modal::joined(cut.structure, testing::one_mode(2, 900.0, 0.03, 0.5));
  for (const double width_m : {1e-4, 4.5e-3}) {
    cut.radial_width_m = width_m;
    const Simulation s = simulate(cut, {.seconds = 1.0});
    ASSERT_EQ(s.small.status, SmallVibration::Status::found);
    EXPECT_EQ(s.verdict == Verdict::stable, s.small.spectral_radius < 1.0) << width_m;
    EXPECT_GT(s.displacement_m.col(2).cwiseAbs().maxCoeff(), 0.0);
    EXPECT_TRUE(s.displacement_m.allFinite());
  }
}

TEST(Drilling, RejectsBadInput) {
  const auto rejected = [](auto change) {
    DrillingCut cut = drill();
    change(cut);
    return test::field_of([&] { static_cast<void>(simulate(cut, {.seconds = 0.05})); });
  };
  EXPECT_EQ(rejected([](DrillingCut& c) { c.lips = 0; }), "lips");
  EXPECT_EQ(rejected([](DrillingCut& c) { c.diameter_m = 0.0; }), "diameter_m");
  EXPECT_EQ(rejected([](DrillingCut& c) { c.point_angle_rad = 4.0; }), "point_angle_rad");
  EXPECT_EQ(rejected([](DrillingCut& c) { c.radial_width_m = 0.006; }), "radial_width_m");
  EXPECT_EQ(rejected([](DrillingCut& c) { c.feed_per_revolution_m = 0.0; }), "feed_per_revolution_m");
  EXPECT_EQ(rejected([](DrillingCut& c) { c.coefficients.tangential_n_per_m2 = 0.0; }), "tangential_n_per_m2");
  EXPECT_EQ(rejected([](DrillingCut&) {}), "accepted");
}

}  // namespace drilling_test
}  // namespace robomill::simulation
