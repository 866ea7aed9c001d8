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
  double offset_rad = 0.0;    ///< of tooth 0 at the first sample
  double noise_n = 0.0;       ///< standard deviation of each sample
  double air_s = 0.0;         ///< before and after the cut
  double air_after_s = -1.0;  ///< after it; below 0: as before
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
    if (t < how.air_s || t > how.seconds - (how.air_after_s < 0.0 ? how.air_s : how.air_after_s)) f.setZero();
    for (double& component : f) component += how.noise_n * random.normal();
    out.force_n.col(i) = f + how.zero_n + how.drift_n_per_s * t;
  }
  return out;
}

MeasuredForce compared(const CuttingForce& force, const Recording& how, std::uint64_t seed = 1) {
  return compare_forces(record_of(force, how, seed), predicted(force), {.spindle_speed_rad_per_s = 600.0});
}

/// The first note with a text in it; empty: none.
std::string said(const MeasuredForce& m, const std::string& part) {
  const auto at =
      std::ranges::find_if(m.notes, [&](const std::string& note) { return note.find(part) != std::string::npos; });
  return at == m.notes.end() ? "" : *at;
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

// The level is that of the strongest revolutions, however little of the record they fill.
TEST(MeasuredForce, FindsACutThatFillsLittleOfTheRecord) {
  const CuttingForce force = cut();
  for (const double cutting_s : {0.1, 0.2, 0.4}) {
    const double air_s = 0.5 * (4.0 - cutting_s);
    const MeasuredForce m = compared(force, {.seconds = 4.0, .noise_n = 1.0, .air_s = air_s});
    EXPECT_GE(m.from_s, air_s);
    EXPECT_LE(m.to_s, 4.0 - air_s);
    EXPECT_GT(m.air_revolutions, 300);
    EXPECT_LT(m.error_ratio.maxCoeff(), 0.02);
    EXPECT_EQ(said(m, "vary"), "");
  }
}

// A jolt is neither the level nor part of the stretch.
TEST(MeasuredForce, LeavesAJoltOut) {
  const CuttingForce force = cut();
  ForceRecord record = record_of(force, {.seconds = 1.0, .noise_n = 1.0, .air_s = 0.1});
  record.force_n.middleCols(7000, 150) *= 20.0;
  const MeasuredForce m = compare_forces(record, predicted(force), {.spindle_speed_rad_per_s = 600.0});
  EXPECT_GE(m.revolutions, 50);
  EXPECT_LE(m.to_s, 0.7);
  EXPECT_LT(m.error_ratio.maxCoeff(), 0.02);
  EXPECT_NE(said(m, "more than twice"), "");
}

// Two cuts of different depth: the strong one counts, and the notes name the weak one.
TEST(MeasuredForce, SaysThatThereIsAWeakerCut) {
  const CuttingForce force = cut();
  ForceRecord record = record_of(force, {.seconds = 2.0, .noise_n = 1.0, .air_s = 0.2});
  record.force_n.leftCols(14000) *= 0.3;
  const MeasuredForce m = compare_forces(record, predicted(force), {.spindle_speed_rad_per_s = 600.0});
  EXPECT_GE(m.from_s, 1.4);
  EXPECT_NE(said(m, "neither the cut nor air"), "");
}

// A stretch that is given and holds air is averaged with it, which is a warning.
TEST(MeasuredForce, WarnsOfAirInTheGivenStretch) {
  const CuttingForce force = cut();
  const ForceRecord record = record_of(force, {.seconds = 1.0, .noise_n = 1.0, .air_s = 0.3});
  const auto of = [&](double from_s, double to_s) {
    return compare_forces(record, predicted(force), {.spindle_speed_rad_per_s = 600.0, .from_s = from_s, .to_s = to_s});
  };
  EXPECT_TRUE(said(of(0.1, 0.6), "averaged with the cut").starts_with("Warning: "));
  EXPECT_EQ(said(of(0.35, 0.65), "averaged with the cut"), "");
}

// 4, 8 and 20 samples a revolution have fewer harmonics than are sought.
TEST(MeasuredForce, OfFewSamplesARevolution) {
  CuttingForce force = cut();
  force.rotation_rad = Eigen::VectorXd::LinSpaced(360, 0.0, 2.0 * pi * 359.0 / 360.0);
  for (Eigen::Index i = 0; i < 360; ++i) {
    force.force_n.col(i) =
        100.0 * Eigen::Vector3d(1.0 + std::cos(force.rotation_rad(i)), std::sin(force.rotation_rad(i)), 0.5);
  }
  for (const double samples : {4.1, 8.0, 20.0}) {
    PredictedRevolution one = predicted(force);
    one.teeth = 1;
    const Recording how = {.speed_rad_per_s = 601.0, .rate_hz = samples * 600.0 / (2.0 * pi), .noise_n = 1.0};
    const MeasuredForce m = compare_forces(record_of(force, how), one, {.spindle_speed_rad_per_s = 600.0});
    EXPECT_NEAR(m.spindle_speed_rad_per_s, 601.0, 0.1) << samples;
  }
}

// The tooth passing of 20 teeth 4 % faster is that of 21 teeth 1 % slower, near enough: no such range is searched.
TEST(MeasuredForce, FindsTheSpeedOfManyTeeth) {
  const int teeth = 20;
  CuttingForce force = cut();
  force.rotation_rad = Eigen::VectorXd::LinSpaced(1440, 0.0, 2.0 * pi * 1439.0 / 1440.0);
  force.force_n.resize(3, 1440);
  for (Eigen::Index i = 0; i < 1440; ++i) {
    const double phi = teeth * force.rotation_rad(i);
    force.force_n.col(i) = 100.0 * Eigen::Vector3d(1.0 + std::cos(phi), std::sin(phi), 1.0 + 0.5 * std::cos(phi));
  }
  PredictedRevolution many = predicted(force);
  many.teeth = teeth;
  for (const double change : {-0.019, -0.004, 0.0, 0.012, 0.019}) {
    const double speed = 600.0 * (1.0 + change);
    const Recording how = {.speed_rad_per_s = speed, .rate_hz = 40000.0, .noise_n = 20.0};
    const MeasuredForce m =
        compare_forces(record_of(force, how), many, {.spindle_speed_rad_per_s = 600.0, .speed_tolerance = 0.02});
    EXPECT_NEAR(m.spindle_speed_rad_per_s, speed, 0.1);
  }
  const auto wide = [&] {
    (void)compare_forces(record_of(force, {.rate_hz = 40000.0}), many,
                         {.spindle_speed_rad_per_s = 600.0, .speed_tolerance = 0.021});
  };
  EXPECT_EQ(field_of(wide), "speed_tolerance");
  EXPECT_NE(rejection(wide).find("must be at most 0.02 with 20 teeth"), std::string::npos);
}

// The prediction's first step need not be at rotation 0; its steps must be even.
TEST(MeasuredForce, OfAPredictionThatBeginsElsewhere) {
  const CuttingForce force = cut();
  PredictedRevolution later = predicted(force);
  later.rotation_rad.array() += 0.5;
  const Recording how = {.offset_rad = 1.234, .noise_n = 1.0};
  const ForceRecord record = record_of(force, how);
  const MeasuredForce m = compare_forces(record, later, {.spindle_speed_rad_per_s = 600.0});
  EXPECT_LT(m.error_ratio_of_all, 0.01);
  const double turns = (600.0 * m.from_s + 1.234) / pi;
  EXPECT_NEAR(turns, std::round(turns), 1e-3);
  later.rotation_rad(7) += 1e-3;
  EXPECT_NE(rejection([&] { (void)compare_forces(record, later, {.spindle_speed_rad_per_s = 600.0}); }).find("even"),
            std::string::npos);
  later.rotation_rad = 2.0 * force.rotation_rad;
  EXPECT_NE(rejection([&] { (void)compare_forces(record, later, {.spindle_speed_rad_per_s = 600.0}); }).find("even"),
            std::string::npos);
}

// Between air before and after the cut the zero drifts on a straight line; of air on one side it does not.
TEST(MeasuredForce, ZeroOfADriftingAmplifier) {
  const CuttingForce force = cut();
  const Eigen::Vector3d drift(40.0, -20.0, 10.0);
  const MeasuredForce both =
      compared(force, {.seconds = 2.0, .noise_n = 1.0, .air_s = 0.1, .air_after_s = 0.9, .drift_n_per_s = drift});
  EXPECT_LT((both.zero_n - drift * 0.5 * (both.from_s + both.to_s)).norm(), 1.0);
  EXPECT_LT((both.mean_n - force.mean_n).norm(), 1.0);
  EXPECT_EQ(said(both, "drift"), "");
  const MeasuredForce before =
      compared(force, {.seconds = 2.0, .noise_n = 1.0, .air_s = 0.5, .air_after_s = 0.0, .drift_n_per_s = drift});
  EXPECT_LT((before.zero_n - drift * 0.25).norm(), 1.0);
  EXPECT_NE(said(before, "before the cut alone"), "");
  const MeasuredForce after =
      compared(force, {.seconds = 2.0, .noise_n = 1.0, .air_s = 0.0, .air_after_s = 0.5, .drift_n_per_s = drift});
  EXPECT_NE(said(after, "after the cut alone"), "");
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

// Steps that no whole number of teeth divides: what all teeth have alike is not between them, to rounding.
TEST(MeasuredForce, TellsTeethApartAtAnyNumberOfSteps) {
  CuttingForce force = cut();
  for (Eigen::Index i = 0; i < 360; ++i) {
    const double phi = force.rotation_rad(i);
    force.force_n.col(i) = 100.0 * Eigen::Vector3d(std::cos(7.0 * phi), std::sin(14.0 * phi), std::cos(21.0 * phi)) +
                           Eigen::Vector3d(10.0 * std::cos(phi), 0.0, 0.0);
  }
  PredictedRevolution seven = predicted(force, false);
  seven.teeth = 7;
  const MeasuredForce m =
      compare_forces(record_of(force, {.rate_hz = 40000.0}), seven, {.spindle_speed_rad_per_s = 600.0});
  EXPECT_NEAR(m.between_teeth_n.x(), 10.0 / std::numbers::sqrt2, 0.02);
  EXPECT_LT(m.between_teeth_n.tail<2>().maxCoeff(), 0.05);
}

// Five revolutions count, no fewer, however the alignment cuts them.
TEST(MeasuredForce, NeedsFiveRevolutionsAfterAll) {
  const CuttingForce force = cut();
  for (int k = 0; k < 40; ++k) {
    const Recording how = {.seconds = 0.052 + 0.001 * k, .offset_rad = 0.3 * k, .noise_n = 1.0};
    try {
      EXPECT_GE(compared(force, how).revolutions, 5);
    } catch (const InvalidInput& error) {
      EXPECT_NE(std::string(error.what()).find("at least 5 are needed"), std::string::npos) << error.what();
      EXPECT_LT(how.seconds, 0.080);
    }
  }
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
  // Three or four revolutions in the cut, in noise: the rest is not averaged with them.
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const auto short_cut = [&](double air_s) {
      return says(record_of(force, {.seconds = 2.0, .noise_n = 5.0, .air_s = air_s}, seed));
    };
    EXPECT_NE(short_cut(0.98).find("has 3 whole revolutions in the cut"), std::string::npos) << short_cut(0.98);
    EXPECT_NE(short_cut(0.985).find("the cut is shorter than five revolutions"), std::string::npos) << short_cut(0.985);
  }
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
  EXPECT_EQ(field(predicted(force), {.spindle_speed_rad_per_s = 600.0, .from_s = 1e300, .to_s = 1e301}), "record");
  EXPECT_EQ(field(predicted(force), {.spindle_speed_rad_per_s = 600.0, .from_s = 0.48}), "record");
}

// The beginning may be given alone.
TEST(MeasuredForce, FromATimeOn) {
  const CuttingForce force = cut();
  const MeasuredForce m =
      compare_forces(record_of(force, {}), predicted(force), {.spindle_speed_rad_per_s = 600.0, .from_s = 0.3});
  EXPECT_GE(m.from_s, 0.3);
  EXPECT_LE(m.revolutions, 19);
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
