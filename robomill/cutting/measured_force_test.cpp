#include "robomill/cutting/measured_force.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "robomill/base/random.hpp"
#include "robomill/base/units.hpp"
#include "robomill/cutting/force.hpp"
#include "testing/cutting/cutters.hpp"
#include "testing/support.hpp"

namespace robomill::cutting {
namespace measured_force_test {

using robomill::test::field_of;
using robomill::test::rejection;
using robomill::test::seeds;
using std::numbers::pi;
using testing::mm;

/// A flat end of two teeth half in the material, whose helix makes its force smooth.
CuttingForce cut(double runout_m = 0.0, int steps = 360) {
  Cutter cutter = testing::flat_end(10.0 * mm, 2, 0.7);
  cutter.mill.runout_m = runout_m;
  const Engagement engagement = engage(cutter, {.axial_depth_m = 5.0 * mm, .radial_depth_m = 5.0 * mm});
  return cutting_force(cutter, engagement,
                       {.tangential_n_per_m2 = {800e6}, .radial_n_per_m2 = {300e6}, .axial_n_per_m2 = {150e6}},
                       {.feed_per_tooth_m = 0.1 * mm, .spindle_speed_rad_per_s = 600.0}, {.steps = steps});
}

PredictedRevolution predicted(const CuttingForce& force, bool alike = true) {
  return {.rotation_rad = force.rotation_rad, .force_n = force.force_n, .teeth = 2, .teeth_alike = alike};
}

/// What a dynamometer records of a force.
struct Recording {
  double speed_rad_per_s = 600.0, rate_hz = 10000.0, seconds = 0.5;
  double offset_rad = 0.0;  ///< of tooth 0 at the first sample
  double noise_n = 0.0;     ///< standard deviation of each sample
  double air_s = 0.0;       ///< before and after the cut
  Eigen::Vector3d zero_n = Eigen::Vector3d::Zero(), drift_n_per_s = Eigen::Vector3d::Zero();
};

ForceRecord record_of(const CuttingForce& force, const Recording& how, std::uint64_t seed = 1) {
  Random random(seed);
  const Eigen::Index steps = force.force_n.cols();
  const auto count = static_cast<Eigen::Index>(how.seconds * how.rate_hz);
  ForceRecord out{.sample_rate_hz = how.rate_hz, .force_n = Eigen::Matrix3Xd(3, count)};
  for (Eigen::Index i = 0; i < count; ++i) {
    const double t = static_cast<double>(i) / how.rate_hz;
    const double turns = (how.speed_rad_per_s * t + how.offset_rad) / (2.0 * pi);
    const double place = (turns - std::floor(turns)) * static_cast<double>(steps);
    const auto at = static_cast<Eigen::Index>(place);
    const double share = place - static_cast<double>(at);
    Eigen::Vector3d f = (1.0 - share) * force.force_n.col(at % steps) + share * force.force_n.col((at + 1) % steps);
    if (t < how.air_s || t > how.seconds - how.air_s) f.setZero();
    for (double& component : f) component += how.noise_n * random.normal();
    out.force_n.col(i) = f + how.zero_n + how.drift_n_per_s * t;
  }
  return out;
}

MeasuredForce compared(const CuttingForce& force, const Recording& how, std::uint64_t seed = 1) {
  return compare_forces(record_of(force, how, seed), predicted(force), {.spindle_speed_rad_per_s = 600.0});
}

// A record made of the prediction itself: nothing is left but what a cubic through 105 samples a revolution and the
// means over steps lose, some 0.3 %.
TEST(MeasuredForce, OfThePredictionItself) {
  const CuttingForce force = cut();
  const MeasuredForce m = compared(force, {.speed_rad_per_s = 603.1, .offset_rad = 1.234});
  EXPECT_NEAR(m.spindle_speed_rad_per_s, 603.1, 1e-3);
  EXPECT_EQ(m.revolutions_in_record, 47);
  EXPECT_GE(m.revolutions, 46);
  EXPECT_LT(m.error_ratio.maxCoeff(), 5e-3);
  EXPECT_LT(m.error_ratio_of_all, 4e-3);
  EXPECT_LT((m.mean_n - force.mean_n).norm(), 1e-3 * force.rms_n.norm());
  EXPECT_LT((m.predicted_mean_n - force.mean_n).norm(), 1e-9);
  EXPECT_LT((m.peak_n - force.peak_n).norm(), 1e-2 * force.peak_n.norm());
  EXPECT_LT(m.between_teeth_n.norm(), 1e-3 * force.rms_n.norm());
  EXPECT_LT(m.wander_rad, 1e-3);
  EXPECT_FALSE(m.better_axes);
  EXPECT_EQ(m.air_revolutions, 0);
  // At from_s tooth 0 stands at the first step.
  const double turns = (603.1 * m.from_s + 1.234) / pi;  // a period is a tooth
  EXPECT_NEAR(turns, std::round(turns), 1e-4);
  ASSERT_EQ(m.harmonics.size(), 16U);
  EXPECT_NEAR(m.harmonics[1].frequency_hz, 2.0 * 603.1 / (2.0 * pi), 1e-3);
  EXPECT_LT((m.harmonics[1].measured_n - m.harmonics[1].predicted_n).norm(), 2e-3 * m.harmonics[1].predicted_n.norm());
}

// Scatter is that of the noise; the mean revolution has it over √n, and the speed is wrong by what it says.
TEST(MeasuredForce, DeviationsAreThoseOfTheNoise) {
  const CuttingForce force = cut();
  const int runs = seeds(200);
  double pulls = 0.0;
  for (int k = 0; k < runs; ++k) {
    const MeasuredForce m = compared(force, {.speed_rad_per_s = 597.0, .offset_rad = 0.1 * k, .noise_n = 10.0},
                                     1000 + static_cast<std::uint64_t>(k));
    // A cubic through four samples takes some of the noise away, at most half of its variance.
    EXPECT_GT(m.scatter_n.minCoeff(), 7.0);
    EXPECT_LT(m.scatter_n.maxCoeff(), 10.5);
    EXPECT_LT(m.error_n.maxCoeff(), 3.0 * 10.0 / std::sqrt(m.revolutions));
    EXPECT_GT(m.error_n.minCoeff(), 0.3 * 10.0 / std::sqrt(m.revolutions));
    pulls += std::pow((m.spindle_speed_rad_per_s - 597.0) / m.spindle_speed_deviation_rad_per_s, 2);
  }
  const double pull = std::sqrt(pulls / runs);
  EXPECT_GT(pull, 0.5);
  EXPECT_LT(pull, 1.6);
}

TEST(MeasuredForce, FindsTheCutAndTakesTheAirOff) {
  const CuttingForce force = cut();
  const Eigen::Vector3d zero_n(40.0, -25.0, 7.0);
  const MeasuredForce m = compared(force, {.seconds = 1.0, .noise_n = 1.0, .air_s = 0.2, .zero_n = zero_n});
  EXPECT_GE(m.from_s, 0.2);
  EXPECT_LE(m.to_s, 0.8);
  EXPECT_GE(m.revolutions, 50);
  EXPECT_GE(m.air_revolutions, 30);
  EXPECT_LT((m.zero_n - zero_n).norm(), 0.2);
  EXPECT_LT((m.mean_n - force.mean_n).norm(), 0.5);
  EXPECT_LT(m.error_ratio.maxCoeff(), 0.02);
}

// A stretch that is given counts, and a drift is taken out about its middle.
TEST(MeasuredForce, OfAStretchThatDrifts) {
  const CuttingForce force = cut();
  const Eigen::Vector3d drift(100.0, -50.0, 0.0);
  const ForceRecord record = record_of(force, {.seconds = 1.0, .drift_n_per_s = drift});
  const MeasuredForce m =
      compare_forces(record, predicted(force), {.spindle_speed_rad_per_s = 600.0, .from_s = 0.3, .to_s = 0.7});
  EXPECT_GE(m.from_s, 0.3);
  EXPECT_LE(m.to_s, 0.71);
  const double seconds = m.to_s - m.from_s;
  EXPECT_LT((m.drift_n - drift * seconds).norm(), 0.02 * (drift * seconds).norm());
  const Eigen::Vector3d middle = drift * 0.5 * (m.from_s + m.to_s);
  EXPECT_LT((m.mean_n - force.mean_n - middle).norm(), 0.5);
  EXPECT_LT(m.shape_error_ratio.maxCoeff(), 8e-3);
  EXPECT_GT(m.error_ratio.maxCoeff(), 0.05);
}

// Runout of the recording that the prediction lacks is what differs from tooth to tooth.
TEST(MeasuredForce, TellsTeethApart) {
  const CuttingForce straight = cut(), runout = cut(20e-6);
  const MeasuredForce without =
      compare_forces(record_of(runout, {.offset_rad = 4.0}), predicted(straight), {.spindle_speed_rad_per_s = 600.0});
  EXPECT_GT(without.between_teeth_n.norm(), 0.1 * straight.rms_n.norm());
  EXPECT_LT(without.between_teeth_n.norm(), 1.01 * without.shape_error_n.norm());
  // With it the offset is that of the tooth: both halves of the revolution fit.
  const MeasuredForce with = compare_forces(record_of(runout, {.offset_rad = 4.0}), predicted(runout, false),
                                            {.spindle_speed_rad_per_s = 600.0});
  EXPECT_LT(with.error_ratio_of_all, 3e-3);
  const double turns = (600.0 * with.from_s + 4.0) / (2.0 * pi);
  EXPECT_NEAR(turns, std::round(turns), 1e-3);
}

TEST(MeasuredForce, FindsTheAxes) {
  const CuttingForce force = cut();
  const ForceRecord straight = record_of(force, {.noise_n = 2.0});
  // The dynamometer's x, y, z are -y, x, -z of the feed frame.
  ForceRecord turned = straight;
  turned.force_n.row(0) = -straight.force_n.row(1);
  turned.force_n.row(1) = straight.force_n.row(0);
  turned.force_n.row(2) = -straight.force_n.row(2);
  const MeasuredForce m = compare_forces(turned, predicted(force), {.spindle_speed_rad_per_s = 600.0});
  EXPECT_GT(m.error_ratio_of_all, 0.3);
  ASSERT_TRUE(m.better_axes);
  EXPECT_EQ(*m.better_axes, (SignedAxes{2, -1, -3}));
  EXPECT_LT(m.better_axes_error_ratio, 0.05);
}

TEST(MeasuredForce, WithoutOneComponent) {
  const CuttingForce force = cut();
  ForceRecord record = record_of(force, {});
  record.force_n.row(2).setConstant(std::numeric_limits<double>::quiet_NaN());
  const MeasuredForce m = compare_forces(record, predicted(force), {.spindle_speed_rad_per_s = 600.0});
  EXPECT_TRUE(std::isnan(m.mean_n.z()) && std::isnan(m.error_ratio.z()) && m.force_n.row(2).array().isNaN().all());
  EXPECT_LT(m.error_ratio.head<2>().maxCoeff(), 5e-3);
  EXPECT_FALSE(m.better_axes);
}

TEST(MeasuredForce, RejectsWhatIsNoCut) {
  const CuttingForce force = cut();
  const auto says = [&](const ForceRecord& record) {
    return rejection([&] { (void)compare_forces(record, predicted(force), {.spindle_speed_rad_per_s = 600.0}); });
  };
  CuttingForce none = force;
  none.force_n.setZero();
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    EXPECT_NE(says(record_of(none, {.noise_n = 5.0}, seed)).find("repeats nothing with the rotation"),
              std::string::npos);
  }
  CuttingForce kilo = force;
  kilo.force_n *= 1e-3;
  EXPECT_NE(says(record_of(kilo, {})).find("less than 2 % of the predicted"), std::string::npos);
  EXPECT_NE(says(record_of(force, {.seconds = 0.03})).find("has 2 whole revolutions"), std::string::npos);
  EXPECT_NE(says(record_of(force, {.seconds = 0.5, .air_s = 0.23})).find("in the cut"), std::string::npos);
  EXPECT_NE(says(record_of(force, {.rate_hz = 500.0})).find("at least 4 samples a tooth"), std::string::npos);
  ForceRecord broken = record_of(force, {});
  broken.force_n(1, 7) = std::numeric_limits<double>::infinity();
  EXPECT_NE(says(broken).find("in y that is not finite"), std::string::npos);
  const ForceRecord good = record_of(force, {});
  const auto field = [&](const PredictedRevolution& other, const MeasuredForceOptions& options) {
    return field_of([&] { (void)compare_forces(good, other, options); });
  };
  EXPECT_EQ(field(predicted(none), {.spindle_speed_rad_per_s = 600.0}), "predicted");
  EXPECT_EQ(field(predicted(force), {}), "spindle_speed_rad_per_s");
  EXPECT_EQ(field(predicted(force), {.spindle_speed_rad_per_s = 600.0, .speed_tolerance = 0.2}), "speed_tolerance");
  EXPECT_EQ(field(predicted(force), {.spindle_speed_rad_per_s = 600.0, .from_s = 0.2, .to_s = 0.1}), "to_s");
  EXPECT_EQ(field(predicted(force), {.spindle_speed_rad_per_s = 600.0, .from_s = 0.2, .to_s = 0.22}), "record");
}

// A speed at the border of what was searched is noted, one beyond it too.
TEST(MeasuredForce, NotesASpeedThatIsNotTheGivenOne) {
  const CuttingForce force = cut();
  const MeasuredForce m = compare_forces(record_of(force, {.speed_rad_per_s = 606.5}), predicted(force),
                                         {.spindle_speed_rad_per_s = 600.0});
  ASSERT_FALSE(m.notes.empty());
  EXPECT_NE(m.notes.front().find("at the border"), std::string::npos);
}

}  // namespace measured_force_test
}  // namespace robomill::cutting
