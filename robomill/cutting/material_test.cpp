#include "robomill/cutting/material.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <optional>

#include "robomill/base/random.hpp"
#include "robomill/cutting/files/materials_toml.hpp"
#include "testing/support.hpp"

namespace robomill::cutting {
namespace material_test {

using std::numbers::pi;
using test::field_of;
using test::seeds;

constexpr double degree = pi / 180.0;

OrthogonalCut random_cut(Random& random) {
  OrthogonalCut cut;
  cut.shear_stress_n_per_m2 = random.uniform(1e8, 1e9);
  cut.friction_angle_rad = random.uniform(0.05, 0.6);
  cut.rake_rad = random.uniform(-0.2, 0.3);
  cut.shear_angle_rad = random.uniform(0.2, 0.7);
  return cut;
}

// Merchant's circle of forces: R = τ_s b h / (sin φ cos(φ + β - α)).
TEST(Oblique, WithoutInclinationIsTheOrthogonalBalance) {
  Random random(1);
  for (int seed = 0; seed < seeds(500); ++seed) {
    const OrthogonalCut cut = random_cut(random);
    const double lean = cut.friction_angle_rad - cut.rake_rad;
    const double resultant =
        cut.shear_stress_n_per_m2 / (std::sin(cut.shear_angle_rad) * std::cos(cut.shear_angle_rad + lean));
    const ObliqueCoefficients k = oblique_coefficients(cut, 0.0);
    EXPECT_NEAR(k.tangential_n_per_m2, resultant * std::cos(lean), 1e-12 * resultant);
    EXPECT_NEAR(k.radial_n_per_m2, resultant * std::sin(lean), 1e-12 * resultant);
    EXPECT_EQ(k.axial_n_per_m2, 0.0);
  }
}

// The force of the coefficients, put back as a vector on a helical edge: on the rake face it is a pressure with
// friction along the chip's flow, which Stabler's rule inclines by i; and the shear stress in the shear plane is τ_s.
// Directions: x radially outwards, y along the cutting motion, z towards the spindle.
TEST(Oblique, BalancesOnRakeFaceAndShearPlane) {
  Random random(2);
  for (int seed = 0; seed < seeds(1000); ++seed) {
    const OrthogonalCut cut = random_cut(random);
    const double i = random.uniform(-0.9, 0.9);
    const ObliqueCoefficients k = oblique_coefficients(cut, i);
    // Per b h = 1: the tool feels it against its motion, inwards and up.
    const Eigen::Vector3d on_tool(-k.radial_n_per_m2, -k.tangential_n_per_m2, k.axial_n_per_m2);
    // The edge lags upwards; what is square to it in the plane of motion and axis.
    const Eigen::Vector3d edge(0.0, -std::sin(i), std::cos(i)), ahead(0.0, std::cos(i), std::sin(i));
    const Eigen::Vector3d inwards = -Eigen::Vector3d::UnitX();
    const Eigen::Vector3d up_the_face = std::cos(cut.rake_rad) * inwards - std::sin(cut.rake_rad) * ahead;
    const Eigen::Vector3d into_chip = std::cos(cut.rake_rad) * ahead + std::sin(cut.rake_rad) * inwards;
    const Eigen::Vector3d flow = std::cos(i) * up_the_face + std::sin(i) * edge;
    const double pressure = -on_tool.dot(into_chip), friction = on_tool.dot(flow);
    EXPECT_GT(pressure, 0.0);
    EXPECT_NEAR(friction, pressure * std::tan(cut.friction_angle_rad), 1e-9 * pressure);
    EXPECT_LT((on_tool + pressure * into_chip - friction * flow).norm(), 1e-9 * pressure);
    // The chip moves with the flow as fast along the edge as the material comes along it: z lags, material goes up.
    EXPECT_GE(flow.dot(edge) * -Eigen::Vector3d::UnitY().dot(edge), 0.0);
    const Eigen::Vector3d plane =
        std::cos(cut.shear_angle_rad) * inwards - std::sin(cut.shear_angle_rad) * ahead;  // its normal
    const Eigen::Vector3d shear = on_tool - on_tool.dot(plane) * plane;
    const double area = 1.0 / (std::cos(i) * std::sin(cut.shear_angle_rad));
    EXPECT_NEAR(shear.norm() / area, cut.shear_stress_n_per_m2, 1e-9 * cut.shear_stress_n_per_m2);
  }
}

TEST(Oblique, TheOtherHelixTurnsTheAxialForceRound) {
  const OrthogonalCut cut{.shear_stress_n_per_m2 = 613e6,
                          .friction_angle_rad = 20.0 * degree,
                          .shear_angle_rad = 33.0 * degree,
                          .rake_rad = 5.0 * degree};
  const ObliqueCoefficients right = oblique_coefficients(cut, 30.0 * degree);
  const ObliqueCoefficients left = oblique_coefficients(cut, -30.0 * degree);
  EXPECT_LT(right.axial_n_per_m2, 0.0) << "a right-hand helix is pulled out of its holder";
  EXPECT_EQ(left.axial_n_per_m2, -right.axial_n_per_m2);
  EXPECT_EQ(left.tangential_n_per_m2, right.tangential_n_per_m2);
  EXPECT_EQ(left.radial_n_per_m2, right.radial_n_per_m2);
}

TEST(ShearAngle, FollowsFromTheChipRatio) {
  Random random(3);
  for (int seed = 0; seed < seeds(500); ++seed) {
    const double angle = random.uniform(0.1, 1.2), rake = random.uniform(-0.3, 0.4);
    // Chip ratio: the shear plane's length seen square to the motion and square to the rake face.
    EXPECT_NEAR(shear_angle_rad(std::sin(angle) / std::cos(angle - rake), rake), angle, 1e-12);
  }
  EXPECT_EQ(field_of([] { static_cast<void>(shear_angle_rad(0.0, 0.1)); }), "chip_ratio");
  EXPECT_EQ(field_of([] { static_cast<void>(shear_angle_rad(3.0, 0.5)); }), "chip_ratio");
}

// Source: [BudakAltintasArmarego1996] Ti6Al4V, its formulas by hand at rake 0 and h = 0.05 mm:
// r = 1.755 * 0.05^0.331 = 0.65106, φ = 33.067°, β = 19.1°.
TEST(Material, TitaniumByItsPublishedFormulas) {
  ASSERT_TRUE(material("Ti6Al4V").orthogonal);
  const OrthogonalTests& titanium = *material("Ti6Al4V").orthogonal;
  const OrthogonalCut cut = titanium.cut(0.0, 0.05e-3);
  EXPECT_NEAR(std::tan(cut.shear_angle_rad), 1.755 * std::pow(0.05, 0.331), 1e-12);
  EXPECT_NEAR(cut.friction_angle_rad, 19.1 * degree, 1e-15);
  const OrthogonalCut raked = titanium.cut(10.0 * degree, 0.05e-3);
  EXPECT_NEAR(raked.friction_angle_rad, (19.1 + 2.9) * degree, 1e-14);
  const double ratio = (1.755 - 0.28) * std::pow(0.05, 0.331 - 0.082);
  EXPECT_NEAR(std::tan(raked.shear_angle_rad),
              ratio * std::cos(10.0 * degree) / (1.0 - ratio * std::sin(10.0 * degree)), 1e-12);
  const MillingCoefficients k = milling_coefficients(titanium, 0.0, 0.0, 0.05e-3);
  EXPECT_NEAR(k.tangential_n_per_m2.front() * 1e-6,
              613.0 * std::cos(19.1 * degree) / std::sin(33.0674574 * degree) / std::cos(52.1674574 * degree), 1e-3);
  EXPECT_EQ(k.tangential_edge_n_per_m, std::vector<double>{24e3});
  EXPECT_EQ(k.radial_edge_n_per_m, std::vector<double>{43e3});
  EXPECT_TRUE(k.axial_edge_n_per_m.empty());
}

TEST(Material, RejectsWhatCannotBe) {
  const OrthogonalTests& titanium = *material("Ti6Al4V").orthogonal;
  const auto field = [&](double rake, double helix, double thickness) {
    return field_of([&] { static_cast<void>(milling_coefficients(titanium, rake, helix, thickness)); });
  };
  EXPECT_EQ(field(0.1, 0.5, 0.0), "chip_thickness_m");
  EXPECT_EQ(field(0.1, 0.5, NAN), "chip_thickness_m");
  EXPECT_EQ(field(0.1, 1.6, 5e-5), "helix_rad");
  EXPECT_EQ(field(1.6, 0.5, 5e-5), "rake_rad");
  EXPECT_EQ(field(70.0 * degree, 0.5, 5e-5), "rake_rad");  // the published chip ratio turns negative there
  OrthogonalCut cut{.shear_stress_n_per_m2 = 6e8, .friction_angle_rad = 0.4, .shear_angle_rad = 0.5, .rake_rad = 0.0};
  EXPECT_EQ(field_of([&] { cut.validate(); }), "accepted");
  cut.shear_angle_rad = 1.3;
  EXPECT_EQ(field_of([&] { cut.validate(); }), "shear_angle_rad");
  cut.shear_stress_n_per_m2 = 0.0;
  EXPECT_EQ(field_of([&] { cut.validate(); }), "shear_stress_n_per_m2");
}

PublishedCoefficients power_law(double force_n_per_m2, double power) {
  return {.source = "someone", .specific_force_n_per_m2 = force_n_per_m2, .thickness_power = power};
}

PublishedCoefficients straight(double tangential_n_per_m2, std::optional<double> radial_n_per_m2,
                               std::optional<CutterKind> kind = {}) {
  PublishedCoefficients set{.kind = kind, .source = "someone"};
  set.line.tangential_n_per_m2 = {tangential_n_per_m2};
  if (radial_n_per_m2) set.line.radial_n_per_m2 = {*radial_n_per_m2};
  return set;
}

// The straight line at h touches k h^(1-m): force and stiffness against a change of chip are those of the power.
TEST(Material, ALineTouchesAPowerOfTheChip) {
  Random random(4);
  for (int seed = 0; seed < seeds(500); ++seed) {
    const double force = random.uniform(2e7, 3e9), power = random.uniform(0.0, 0.9), h = random.uniform(5e-6, 3e-4);
    const PublishedCoefficients set = power_law(force, power);
    const MillingCoefficients k = set.at(h);
    const auto per_width = [&](double chip_m) { return force * std::pow(chip_m / 1e-3, -power) * chip_m; };
    const double slope = k.tangential_n_per_m2.front(), edge = k.tangential_edge_n_per_m.front();
    EXPECT_NEAR(slope * h + edge, per_width(h), 1e-12 * per_width(h));
    const double step = 1e-4 * h;
    EXPECT_NEAR(slope, (per_width(h + step) - per_width(h - step)) / (2.0 * step), 1e-6 * slope);
    EXPECT_TRUE(k.radial_n_per_m2.empty());
    // Concave: the power lies below its tangent everywhere else.
    EXPECT_LE(per_width(2.0 * h), (slope * 2.0 * h + edge) * (1.0 + 1e-12));
    EXPECT_LE(per_width(0.5 * h), (slope * 0.5 * h + edge) * (1.0 + 1e-12));
  }
  EXPECT_EQ(field_of([] { static_cast<void>(power_law(8e8, 0.25).at(0.0)); }), "chip_thickness_m");
  EXPECT_EQ(straight(7e8, 2e8).at(0.0).tangential_n_per_m2.front(), 7e8) << "a line needs no chip";
}

TEST(Material, TheSetForTheCutterIsTaken) {
  Material some;
  EXPECT_FALSE(best_set(some, CutterKind::flat_end));
  some.coefficients = {power_law(8e8, 0.25), straight(7e8, {}, CutterKind::flat_end)};
  EXPECT_EQ(best_set(some, CutterKind::flat_end), 0U) << "84.6 N/mm at 0.05 mm against 35";
  EXPECT_EQ(best_set(some, CutterKind::ball_end), 0U) << "one that names no kind before one for another kind";
  some.coefficients.push_back(straight(6e8, 2e8, CutterKind::ball_end));
  some.coefficients.push_back(straight(5e8, 2e8));
  some.coefficients.push_back(straight(4e8, 2e8));
  EXPECT_EQ(best_set(some, CutterKind::ball_end), 2U);
  EXPECT_EQ(best_set(some, CutterKind::flat_end), 3U) << "of two that serve alike the one with the larger force";
  some.coefficients.push_back(straight(9e8, 2e8));
  EXPECT_EQ(best_set(some, CutterKind::flat_end), 5U);
  some.coefficients[4].line.tangential_edge_n_per_m = {4e4};
  EXPECT_EQ(best_set(some, CutterKind::flat_end), 4U) << "edge forces count: 20 + 40 N/mm against 45";
  some.coefficients[4].line.tangential_edge_n_per_m = {};
  some.coefficients.push_back(straight(3e8, 2e8, CutterKind::flat_end));
  EXPECT_EQ(best_set(some, CutterKind::flat_end), 5U) << "that a set names the kind makes it no safer";
}

TEST(Material, SpreadIsThatOfTheLines) {
  Material some;
  EXPECT_EQ(spread_of_sets(some).sets, 0U);
  some.coefficients = {straight(6e8, 1e8), power_law(8e8, 0.25), straight(8e8, {})};
  EXPECT_EQ(spread_of_sets(some).sets, 2U);
  EXPECT_NEAR(spread_of_sets(some).std_ratio, 1e8 / 7e8, 1e-12) << "half the distance of two";
  some.coefficients.push_back(straight(1e9, 2e8));
  some.coefficients.push_back(straight(8e8, 3e8));
  const SetSpread spread = spread_of_sets(some);
  EXPECT_EQ(spread.sets, 4U);
  EXPECT_EQ(spread.tangential_n_per_m2, (FromTo{6e8, 1e9}));
  EXPECT_NEAR(spread.std_ratio, std::sqrt(8e16 / 3.0) / 8e8, 1e-12);
  some.coefficients = {straight(6e8, 1e8)};
  EXPECT_EQ(spread_of_sets(some).std_ratio, 0.0);
}

TEST(Material, MeanChipOverTheArc) {
  EXPECT_NEAR(mean_chip_thickness_m({.entry_rad = 0.0, .exit_rad = pi}, 1e-4), 2e-4 / pi, 1e-18);
  EXPECT_NEAR(mean_chip_thickness_m({.entry_rad = 0.25 * pi, .exit_rad = 0.5 * pi}, 1e-4),
              1e-4 * std::cos(0.25 * pi) / (0.25 * pi), 1e-18);
}

}  // namespace material_test
}  // namespace robomill::cutting
