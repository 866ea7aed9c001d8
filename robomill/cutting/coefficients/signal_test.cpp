#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/cutting/coefficients.hpp"
#include "robomill/cutting/engagement.hpp"
#include "testing/cutting/cutters.hpp"
#include "testing/support.hpp"

namespace robomill::cutting {
namespace coefficients_signal_test {

using robomill::test::field_of;
using robomill::test::seeds;
using std::numbers::pi;
using testing::ball_end;
using testing::flat_end;
using testing::mm;

/// [BallEndRobot] eq. 26: -15881 in Krc read as -1588.1, Kac and Kae in our sign (docs/errata.md).
MillingCoefficients planted() {
  return {.tangential_n_per_m2 = {325.4e6, 435.8e6, -65.25e6, 1772e6},
          .radial_n_per_m2 = {1169e6, -1588.1e6, 741.1e6, 1221e6},
          .axial_n_per_m2 = {-312.8e6, 871.6e6, -858.1e6, -100.1e6},
          .tangential_edge_n_per_m = {13.15e3},
          .radial_edge_n_per_m = {15.43e3},
          .axial_edge_n_per_m = {11.52e3}};
}

struct Case {
  Cutter cutter;
  Engagement engagement;
  CutMotion motion{.feed_per_tooth_m = 0.05 * mm, .spindle_speed_rad_per_s = 300.0};
  [[nodiscard]] CuttingForce force(const MillingCoefficients& k, int steps = 360) const {
    return cutting_force(cutter, engagement, k, motion, {.steps = steps});
  }
};

Case ball() {
  Case out;
  out.cutter = ball_end(3.0 * mm, 2, 0.5);
  out.engagement = engage(out.cutter, {.axial_depth_m = 2.5 * mm,
                                       .radial_depth_m = 2.0 * mm,
                                       .direction = MillingDirection::up,
                                       .lead_rad = 0.2,
                                       .tilt_rad = -0.3});
  return out;
}

Case flat() {
  Case out;
  out.cutter = flat_end(10.0 * mm, 3, 0.5);
  out.engagement = engage(out.cutter, {.axial_depth_m = 3.0 * mm, .radial_depth_m = 4.0 * mm});
  return out;
}

double largest_error(const std::vector<double>& found, const std::vector<double>& planted) {
  double error = 0.0;
  for (std::size_t i = 0; i < planted.size(); ++i) error = std::max(error, std::abs(found.at(i) - planted[i]));
  return error;
}

constexpr CoefficientDegrees cubic = {.tangential = 3, .radial = 3, .axial = 3};

TEST(SignalFit, FindsThePlantedPolynomialsOfABallEnd) {
  const Case cut = ball();
  const MillingCoefficients k = planted();
  const CuttingForce force = cut.force(k);
  const SignalFit fit = identify_from_signal(cut.cutter, cut.engagement, cut.motion, force.rotation_rad, force.force_n,
                                             {.degrees = cubic, .find_offset = false, .steps = 360});
  EXPECT_TRUE(fit.identifiable) << fit.notes.front();
  EXPECT_LT(largest_error(fit.coefficients.tangential_n_per_m2, k.tangential_n_per_m2), 1.0);
  EXPECT_LT(largest_error(fit.coefficients.radial_n_per_m2, k.radial_n_per_m2), 1.0);
  EXPECT_LT(largest_error(fit.coefficients.axial_n_per_m2, k.axial_n_per_m2), 1.0);
  EXPECT_LT(largest_error(fit.coefficients.tangential_edge_n_per_m, k.tangential_edge_n_per_m), 1e-4);
  EXPECT_LT(largest_error(fit.coefficients.radial_edge_n_per_m, k.radial_edge_n_per_m), 1e-4);
  EXPECT_LT(largest_error(fit.coefficients.axial_edge_n_per_m, k.axial_edge_n_per_m), 1e-4);
  EXPECT_GT(fit.r_squared.minCoeff(), 1.0 - 1e-12);
  EXPECT_LT(fit.residual_n.cwiseAbs().maxCoeff(), 1e-8);
}

// The offset is not on the model's grid, so that the interpolation between its steps is in the answer.
TEST(SignalFit, FindsWhereTheToothStood) {
  const Case cut = ball();
  const MillingCoefficients k = planted();
  const CuttingForce force = cut.force(k, 1440);
  Random random(4);
  for (int seed = 0; seed < std::max(2, seeds(10)); ++seed) {
    const double offset = random.uniform(0.0, pi);
    const Eigen::VectorXd rotation = force.rotation_rad.array() - offset;
    const SignalFit fit =
        identify_from_signal(cut.cutter, cut.engagement, cut.motion, rotation, force.force_n, {.degrees = cubic});
    EXPECT_NEAR(fit.offset_rad, offset, 1e-4);
    EXPECT_TRUE(fit.identifiable);
    EXPECT_LT(largest_error(fit.coefficients.tangential_n_per_m2, k.tangential_n_per_m2), 0.01 * 1772e6);
    EXPECT_GT(fit.r_squared.minCoeff(), 1.0 - 1e-5);
  }
}

TEST(SignalFit, DeviationsCoverTheNoise) {
  const Case cut = flat();
  const MillingCoefficients k = {.tangential_n_per_m2 = {700e6},
                                 .radial_n_per_m2 = {250e6},
                                 .axial_n_per_m2 = {-150e6},
                                 .tangential_edge_n_per_m = {12e3},
                                 .radial_edge_n_per_m = {15e3},
                                 .axial_edge_n_per_m = {2e3}};
  const CuttingForce force = cut.force(k);
  const int cases = seeds(500);
  int within = 0;
  for (int seed = 0; seed < cases; ++seed) {
    Random random(9, static_cast<std::uint64_t>(seed));
    Eigen::Matrix3Xd noisy = force.force_n;
    for (double& value : noisy.reshaped()) value += 5.0 * random.normal();
    const SignalFit fit = identify_from_signal(cut.cutter, cut.engagement, cut.motion, force.rotation_rad, noisy,
                                               {.find_offset = false, .steps = 360});
    EXPECT_NEAR(fit.noise_n, 5.0, 0.6);
    for (const auto values : {&MillingCoefficients::tangential_n_per_m2, &MillingCoefficients::radial_n_per_m2,
                              &MillingCoefficients::axial_n_per_m2, &MillingCoefficients::tangential_edge_n_per_m,
                              &MillingCoefficients::radial_edge_n_per_m, &MillingCoefficients::axial_edge_n_per_m}) {
      const double error = std::abs((fit.coefficients.*values).front() - (k.*values).front());
      within += error <= 2.0 * (fit.deviations.*values).front() ? 1 : 0;
    }
  }
  EXPECT_NEAR(within / (6.0 * cases), 0.954, 0.03);
}

// A cylinder has one κ: of a straight line in κ only the sum is determined.
TEST(SignalFit, ReportsWhatACylinderDoesNotDetermine) {
  const Case cut = flat();
  const CuttingForce force = cut.force({.tangential_n_per_m2 = {700e6}, .radial_n_per_m2 = {250e6}});
  const SignalFit fit = identify_from_signal(
      cut.cutter, cut.engagement, cut.motion, force.rotation_rad, force.force_n,
      {.degrees = {.tangential = 1, .tangential_edge = -1, .axial_edge = -1}, .find_offset = false, .steps = 360});
  EXPECT_FALSE(fit.identifiable);
  ASSERT_EQ(fit.notes.size(), 1U);
  EXPECT_EQ(fit.notes.front(), "The signal does not separate: tangential κ, tangential.");
  EXPECT_TRUE(std::isinf(fit.deviations.tangential_n_per_m2[0]) && std::isinf(fit.deviations.tangential_n_per_m2[1]));
  EXPECT_TRUE(std::isfinite(fit.deviations.radial_n_per_m2.front()));
  const std::vector<double>& line = fit.coefficients.tangential_n_per_m2;
  EXPECT_NEAR(line[0] * 0.5 * pi + line[1], 700e6, 1.0);
  EXPECT_NEAR(fit.coefficients.radial_n_per_m2.front(), 250e6, 1.0);
  EXPECT_TRUE(fit.coefficients.tangential_edge_n_per_m.empty());
  EXPECT_GT(fit.r_squared.head<2>().minCoeff(), 1.0 - 1e-12);
}

// Two ways to the same constants: the means of slots, and the course of one.
TEST(SignalFit, AgreesWithTheMeansOfSlots) {
  const MillingCoefficients k = {.tangential_n_per_m2 = {1825e6},
                                 .radial_n_per_m2 = {770e6},
                                 .axial_n_per_m2 = {735e6},
                                 .tangential_edge_n_per_m = {29.7e3},
                                 .radial_edge_n_per_m = {55.7e3},
                                 .axial_edge_n_per_m = {1.8e3}};
  Case cut;
  cut.cutter = flat_end(18.1 * mm, 4, pi / 6.0);
  cut.engagement = engage(cut.cutter, {.axial_depth_m = 5.08 * mm, .direction = MillingDirection::slot});
  std::vector<SlotForce> slots;
  for (const double feed_mm : {0.025, 0.05, 0.1}) {
    cut.motion.feed_per_tooth_m = feed_mm * mm;
    slots.push_back({feed_mm * mm, 5.08 * mm, 300.0, cut.force(k).mean_n});
  }
  const MillingCoefficients means = identify_from_slots(slots, {.teeth = 4}).coefficients();
  const CuttingForce force = cut.force(k);
  const MillingCoefficients course = identify_from_signal(cut.cutter, cut.engagement, cut.motion, force.rotation_rad,
                                                          force.force_n, {.find_offset = false, .steps = 360})
                                         .coefficients;
  for (const auto values : {&MillingCoefficients::tangential_n_per_m2, &MillingCoefficients::radial_n_per_m2,
                            &MillingCoefficients::axial_n_per_m2, &MillingCoefficients::tangential_edge_n_per_m,
                            &MillingCoefficients::radial_edge_n_per_m, &MillingCoefficients::axial_edge_n_per_m}) {
    const double expected = (k.*values).front();
    EXPECT_NEAR((means.*values).front(), expected, 1e-6 * expected);
    EXPECT_NEAR((course.*values).front(), expected, 1e-6 * expected);
  }
}

TEST(SignalFit, DetectsAForceOnTheWorkpiece) {
  const Case cut = flat();
  const CuttingForce force = cut.force({.tangential_n_per_m2 = {700e6}, .radial_n_per_m2 = {250e6}});
  const SignalFit fit = identify_from_signal(cut.cutter, cut.engagement, cut.motion, force.rotation_rad, -force.force_n,
                                             {.find_offset = false});
  ASSERT_EQ(fit.notes.size(), 1U);
  EXPECT_NE(fit.notes.front().find("workpiece"), std::string::npos);
}

TEST(SignalFit, RejectsWhatCannotBe) {
  const Case cut = flat();
  const CuttingForce force = cut.force({.tangential_n_per_m2 = {700e6}});
  const auto with = [&](const Eigen::VectorXd& rotation, const Eigen::Matrix3Xd& forces, const SignalOptions& options) {
    return field_of([&] {
      static_cast<void>(identify_from_signal(cut.cutter, cut.engagement, cut.motion, rotation, forces, options));
    });
  };
  const Eigen::VectorXd& rotation = force.rotation_rad;
  EXPECT_EQ(with(rotation.head(10), force.force_n, {}), "force_n");
  EXPECT_EQ(with(rotation.head(3), force.force_n.leftCols(3), {}), "rotation_rad");
  EXPECT_EQ(with(Eigen::VectorXd::Constant(360, NAN), force.force_n, {}), "rotation_rad");
  EXPECT_EQ(with(rotation, force.force_n * INFINITY, {}), "force_n");
  EXPECT_EQ(with(rotation, force.force_n, {.degrees = {.axial = 7}}), "degrees.axial");
  EXPECT_EQ(with(rotation, force.force_n, {.degrees = {-1, -1, -1, -1, -1, -1}}), "degrees");
  EXPECT_EQ(with(rotation, force.force_n, {.steps = 2}), "steps");
  EXPECT_EQ(with(rotation, force.force_n, {.rank_tolerance = 0.0}), "rank_tolerance");
  EXPECT_EQ(
      field_of([&] { static_cast<void>(identify_from_signal(cut.cutter, {}, cut.motion, rotation, force.force_n)); }),
      "engagement");
}

}  // namespace coefficients_signal_test
}  // namespace robomill::cutting
