#include "robomill/cutting/force.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "robomill/cutting/engagement.hpp"
#include "testing/cutting/cutters.hpp"
#include "testing/support.hpp"

namespace robomill::cutting {
namespace force_test {

using robomill::test::field_of;
using robomill::test::rejection;
using robomill::test::seeds;
using std::numbers::pi;
using testing::ball_end;
using testing::degree;
using testing::flat_end;
using testing::mm;

constexpr CutterKind kinds[] = {CutterKind::flat_end, CutterKind::ball_end, CutterKind::bull_nose, CutterKind::general};

MillingCoefficients published() {
  return {.tangential_n_per_m2 = {1825e6},
          .radial_n_per_m2 = {770e6},
          .axial_n_per_m2 = {735e6},
          .tangential_edge_n_per_m = {29.7e3},
          .radial_edge_n_per_m = {55.7e3},
          .axial_edge_n_per_m = {1.8e3}};
}

Cut slot(double depth_m) {
  return {.axial_depth_m = depth_m, .direction = MillingDirection::slot};
}

// Source: closed forms of a slot, F_x = -(N a / 4) Krc c - (N a / π) Kre, F_y = (N a / 4) Ktc c + (N a / π) Kte, F_z =
// (N a / π) Kac c + (N a / 2) Kae, edge forces per axial depth.
TEST(CuttingForce, AveragesOfASlotAreExact) {
  const CutMotion motion = {.feed_per_tooth_m = 0.05 * mm, .spindle_speed_rad_per_s = 100.0};
  for (const double helix : {0.0, 30.0, 45.0}) {
    const Cutter cutter = flat_end(18.1 * mm, 4, helix * degree);
    const Engagement engagement = engage(cutter, slot(5.08 * mm), {.slices = 17});
    for (const int steps : {8, 90, 360}) {
      const CuttingForce force = cutting_force(cutter, engagement, published(), motion, {.steps = steps});
      EXPECT_NEAR(force.mean_n.x(), -555.8508, 5e-5);
      EXPECT_NEAR(force.mean_n.y(), 655.6513, 5e-5);
      EXPECT_NEAR(force.mean_n.z(), 255.9891, 5e-5);
      EXPECT_NEAR(force.mean_torque_n_m, 8.07226, 5e-6);
      EXPECT_NEAR(force.power_w, 100.0 * force.mean_torque_n_m, 1e-10);
      EXPECT_NEAR((force.force_n.rowwise().mean() - force.mean_n).norm(), 0.0, 1e-10);
    }
  }
}

/// The sum over elements as the equations say it, at `fine` points of each step, each tooth against the furthest that
/// any tooth before it has reached on its ring: nothing of the kernel's.
CuttingForce by_elements(const Cutter& cutter, const Engagement& engagement, const MillingCoefficients& c,
                         const CutMotion& motion, int steps, int fine) {
  const auto at = [](const std::vector<double>& p, double x) {
    double sum = 0.0;
    for (std::size_t i = 0; i < p.size(); ++i) sum += p[i] * std::pow(x, static_cast<double>(p.size() - 1 - i));
    return sum;
  };
  const FlatEndMill& mill = cutter.mill;
  CuttingForce result;
  result.force_n = Eigen::Matrix3Xd::Zero(3, steps);
  result.torque_n_m = Eigen::VectorXd::Zero(steps);
  const Eigen::Matrix3d& turn = engagement.feed_from_tool;
  const double feed = motion.feed_per_tooth_m * mill.teeth;
  for (int k = 0; k < steps; ++k) {
    for (int sub = 0; sub < fine; ++sub) {
      const double rotation = 2.0 * pi / steps * (k - 0.5 + (sub + 0.5) / fine);
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      double torque = 0.0;
      for (std::size_t i = 0; i < engagement.slices.size(); ++i) {
        const EdgeSlice& s = engagement.slices[i];
        const double kappa = s.position_rad;
        for (int j = 0; j < mill.teeth; ++j) {
          double phi = rotation + mill.standing_angle(j) - mill.lag_rad_per_m(j) * s.height_m;
          phi -= 2.0 * pi * std::floor(phi / (2.0 * pi));
          const bool in = std::ranges::any_of(engagement.of(i), [&](const Arc& a) {
            return (phi > a.entry_rad && phi < a.exit_rad) || phi + 2.0 * pi < a.exit_rad;
          });
          if (!in) continue;
          const Eigen::Vector3d n(std::sin(kappa) * std::sin(phi), std::sin(kappa) * std::cos(phi), -std::cos(kappa));
          const double along = turn.row(0).dot(n);
          double furthest = -1e300;  // where another tooth, at most a revolution before, stood along n
          for (int other = 0; other < mill.teeth; ++other) {
            double ahead = mill.standing_angle(other) - mill.standing_angle(j) -
                           (mill.lag_rad_per_m(other) - mill.lag_rad_per_m(j)) * s.height_m;
            while (ahead <= 1e-12) ahead += 2.0 * pi;
            const double reached =
                -feed * ahead / (2.0 * pi) * along + mill.radius_deviation_m(other, s.height_m) * std::sin(kappa);
            furthest = std::max(furthest, reached);
          }
          const double chip = mill.radius_deviation_m(j, s.height_m) * std::sin(kappa) - furthest;
          if (chip <= 0.0) continue;
          const double length = s.width_m * std::hypot(1.0, s.radius_m * std::sin(kappa) * mill.lag_rad_per_m(j));
          const double ft =
              at(c.tangential_n_per_m2, kappa) * chip * s.width_m + at(c.tangential_edge_n_per_m, kappa) * length;
          const double fr = at(c.radial_n_per_m2, kappa) * chip * s.width_m + at(c.radial_edge_n_per_m, kappa) * length;
          const double fa = at(c.axial_n_per_m2, kappa) * chip * s.width_m + at(c.axial_edge_n_per_m, kappa) * length;
          sum +=
              -ft * Eigen::Vector3d(std::cos(phi), -std::sin(phi), 0.0) - fr * n +
              fa * Eigen::Vector3d(std::cos(kappa) * std::sin(phi), std::cos(kappa) * std::cos(phi), std::sin(kappa));
          torque += s.radius_m * ft;
        }
      }
      result.force_n.col(k) += turn * sum / fine;
      result.torque_n_m[k] += torque / fine;
    }
  }
  return result;
}

// Two methods: harmonics that come and go, and elements summed at 200 points of each of 36 steps. Every kind, lead,
// tilt, runout, unequal pitch and helix, polynomials.
TEST(CuttingForce, IsTheSumOverElements) {
  int cases = 0;
  for (int seed = 0; seed < seeds(200); ++seed) {
    Random random(621, static_cast<std::uint64_t>(seed));
    Cutter cutter = testing::random_cutter(random, kinds[seed % 4]);
    const Cut cut = testing::random_cut(random, cutter);
    const CutMotion motion = {.feed_per_tooth_m = 0.05 * mm, .spindle_speed_rad_per_s = 100.0};
    if (seed % 2 == 1) {
      cutter.mill.runout_m = random.uniform(0.0, 0.06) * mm;
      cutter.mill.runout_angle_rad = random.uniform(0.0, 6.0);
    }
    if (seed % 5 == 4) {
      for (int j = 0; j < cutter.mill.teeth; ++j) {
        cutter.mill.tooth_helix_rad.push_back(random.uniform(20.0, 40.0) * degree);
      }
    }
    MillingCoefficients coefficients = published();
    coefficients.edge_measure = EdgeMeasure::edge_length;
    coefficients.tangential_n_per_m2 = {100e6, -200e6, 2000e6};
    coefficients.axial_n_per_m2 = {-100e6, 400e6};
    Engagement engagement;
    if (field_of([&] { engagement = engage(cutter, cut, {.slices = 9}); }) != "accepted") continue;
    const CuttingForce force = cutting_force(cutter, engagement, coefficients, motion, {.steps = 36});
    const CuttingForce sum = by_elements(cutter, engagement, coefficients, motion, 36, 200);
    const double scale = std::max(force.peak_force_n, 1e-3);
    EXPECT_LT((force.force_n - sum.force_n).cwiseAbs().maxCoeff(), 0.02 * scale) << seed;
    EXPECT_LT((force.force_n - sum.force_n).rowwise().mean().norm(), 2e-3 * scale) << seed;
    EXPECT_LT((force.torque_n_m - sum.torque_n_m).cwiseAbs().maxCoeff(), 0.02 * std::abs(force.peak_torque_n_m))
        << seed;
    ++cases;
  }
  EXPECT_GT(cases, seeds(200) / 2);
}

// Whatever the cutter, posture, pitch and runout: the work is Kt times the volume.
TEST(CuttingForce, PowerIsTangentialCoefficientTimesRemovalRate) {
  int cases = 0;
  for (int seed = 0; seed < seeds(500); ++seed) {
    Random random(622, static_cast<std::uint64_t>(seed));
    Cutter cutter = testing::random_cutter(random, kinds[seed % 4]);
    const Cut cut = testing::random_cut(random, cutter);
    const CutMotion motion = {.feed_per_tooth_m = random.uniform(0.01, 0.1) * mm,
                              .spindle_speed_rad_per_s = random.uniform(50.0, 2000.0)};
    if (seed % 2 == 1) {
      cutter.mill.runout_m = random.uniform(0.0, 0.1) * mm;
      cutter.mill.runout_angle_rad = random.uniform(-3.0, 3.0);
    }
    Engagement engagement;
    if (field_of([&] { engagement = engage(cutter, cut); }) != "accepted") continue;
    const MillingCoefficients coefficients = {.tangential_n_per_m2 = {800e6}, .radial_n_per_m2 = {300e6}};
    const CuttingForce force = cutting_force(cutter, engagement, coefficients, motion, {.steps = 90});
    EXPECT_NEAR(force.power_w, 800e6 * force.removal_rate_m3_per_s, 1e-9 * force.power_w) << seed;
    const double feed_speed = motion.feed_per_tooth_m * cutter.mill.teeth * motion.spindle_speed_rad_per_s / (2.0 * pi);
    EXPECT_NEAR(force.removal_rate_m3_per_s, chip_area_m2(engagement) * feed_speed,
                1e-12 * force.removal_rate_m3_per_s);
    ++cases;
  }
  EXPECT_GT(cases, seeds(500) / 2);
}

// Source: the chip's area across the feed, segment below h_min and l (h - h_min), of a ball in any posture.
TEST(CuttingForce, PowerOfABallFollowsFromDepthAndStepOver) {
  for (int seed = 0; seed < seeds(500); ++seed) {
    Random random(623, static_cast<std::uint64_t>(seed));
    const double radius = random.uniform(1.0, 8.0) * mm;
    const Cutter cutter = ball_end(radius, 1 + static_cast<int>(random.index(4)), random.uniform(0.0, 45.0) * degree);
    const double step = random.uniform(0.05, 0.6) * radius;
    const double half = std::asin(0.5 * step / radius);
    const double cusp = radius * (1.0 - std::cos(half));
    const Cut cut = {.axial_depth_m = cusp + random.uniform(0.02, 0.3) * radius,
                     .radial_depth_m = step,
                     .direction = seed % 2 == 0 ? MillingDirection::up : MillingDirection::down,
                     .lead_rad = random.uniform(-20.0, 20.0) * degree,
                     .tilt_rad = random.uniform(-20.0, 20.0) * degree};
    const CutMotion motion = {.feed_per_tooth_m = 0.02 * mm, .spindle_speed_rad_per_s = 1000.0};
    const CuttingForce force =
        cutting_force(cutter, engage(cutter, cut), {.tangential_n_per_m2 = {1e9}}, motion, {.steps = 60});
    const double area = radius * radius * (half - std::sin(half) * std::cos(half)) + step * (cut.axial_depth_m - cusp);
    const double rate = area * 0.02 * mm * cutter.mill.teeth * 1000.0 / (2.0 * pi);
    EXPECT_NEAR(force.power_w, 1e9 * rate, 1e-3 * force.power_w) << seed;
  }
}

// Source: mean_cutting_stiffness and mean_torque_n_m of milling.hpp, closed forms over height.
TEST(CuttingForce, OfAFlatEndAgreesWithTheClosedFormsOfMilling) {
  for (int seed = 0; seed < seeds(200); ++seed) {
    Random random(624, static_cast<std::uint64_t>(seed));
    Cutter cutter = testing::random_cutter(random, CutterKind::flat_end);
    cutter.mill.pitch_rad.clear();  // the feed of a pitch differs there
    const bool straight = seed % 2 == 0;
    if (straight) cutter.mill.helix_rad = 0.0;
    Cut cut = testing::random_cut(random, cutter);
    cut.lead_rad = cut.tilt_rad = 0.0;
    const double feed = 0.08 * mm;
    const Milling milling = {.tool = cutter.mill,
                             .immersion = immersion(cut.direction, cut.radial_depth_m, cutter.mill.diameter_m),
                             .coefficients = {.tangential_n_per_m2 = 7e8, .radial_n_per_m2 = 3e8}};
    const Engagement engagement = engage(cutter, cut, {.slices = straight ? 3 : 400});
    const CuttingForce force =
        cutting_force(cutter, engagement, {.tangential_n_per_m2 = {7e8}, .radial_n_per_m2 = {3e8}},
                      {.feed_per_tooth_m = feed, .spindle_speed_rad_per_s = 300.0}, {.steps = 72});
    const double step = 2.0 * pi / 72.0;
    for (int k = 0; k < 72; ++k) {
      Eigen::Vector2d expected = Eigen::Vector2d::Zero();
      for (int j = 0; j < cutter.mill.teeth; ++j) {
        expected +=
            mean_cutting_stiffness(milling, j, (k - 0.5) * step, (k + 0.5) * step, cut.axial_depth_m).col(0) * feed;
      }
      EXPECT_NEAR((force.force_n.col(k).head<2>() - expected).norm(), 0.0,
                  (straight ? 1e-11 : 1e-3) * force.peak_force_n)
          << seed << ' ' << k;
    }
    const double torque = mean_torque_n_m(milling, cut.axial_depth_m, feed);
    EXPECT_NEAR(force.mean_torque_n_m, torque, 1e-11 * torque);
  }
}

// Runout only shares the chip out.
TEST(CuttingForce, RunoutLeavesTheMeanPower) {
  for (int seed = 0; seed < seeds(200); ++seed) {
    Random random(625, static_cast<std::uint64_t>(seed));
    Cutter cutter = testing::random_cutter(random, kinds[seed % 4]);
    const Cut cut = testing::random_cut(random, cutter);
    const CutMotion motion = {.feed_per_tooth_m = 0.03 * mm, .spindle_speed_rad_per_s = 500.0};
    Engagement engagement;
    if (field_of([&] { engagement = engage(cutter, cut); }) != "accepted") continue;
    const MillingCoefficients coefficients = {.tangential_n_per_m2 = {900e6}};
    const CuttingForce even = cutting_force(cutter, engagement, coefficients, motion);
    cutter.mill.runout_m = random.uniform(0.001, 0.1) * mm;
    const CuttingForce uneven = cutting_force(cutter, engagement, coefficients, motion);
    EXPECT_NEAR(uneven.power_w, even.power_w, 1e-9 * even.power_w) << seed;
    EXPECT_EQ(even.missed_share, 0.0);
  }
}

// Two teeth, offset e towards the first: they differ by 2 e. At 2 e > f the second cuts nothing at all, the first 2 f.
TEST(CuttingForce, OneToothOfTwoCutsAllWhereRunoutExceedsHalfTheFeed) {
  Cutter cutter = flat_end(10.0 * mm, 2);
  const double feed = 0.05 * mm;
  const CutMotion motion = {.feed_per_tooth_m = feed, .spindle_speed_rad_per_s = 100.0};
  const Cut cut = {.axial_depth_m = mm, .radial_depth_m = 10.0 * mm};
  const Engagement engagement = engage(cutter, cut, {.slices = 3});
  const MillingCoefficients coefficients = {.tangential_n_per_m2 = {1e9}};
  cutter.mill.runout_m = 0.51 * feed;
  const CuttingForce force = cutting_force(cutter, engagement, coefficients, motion);
  EXPECT_NEAR(force.missed_share, 0.5, 1e-12);
  // tooth 0 at 90 degrees, then tooth 1 there
  EXPECT_NEAR(force.force_n(1, 90), 1e9 * mm * 2.0 * feed, 1e-3 * force.force_n(1, 90));
  EXPECT_EQ(force.force_n(1, 270), 0.0);
  cutter.mill.runout_m = 0.1 * feed;
  const CuttingForce shared = cutting_force(cutter, engagement, coefficients, motion);
  EXPECT_NEAR(shared.force_n(1, 90), 1e9 * mm * 1.2 * feed, 1e-3 * shared.force_n(1, 90));
  EXPECT_NEAR(shared.force_n(1, 270), 1e9 * mm * 0.8 * feed, 1e-3 * shared.force_n(1, 270));
  EXPECT_GT(shared.missed_share, 0.0);  // near entry and exit, where the chip is thinner than the difference
  EXPECT_LT(shared.missed_share, 0.2);
}

// A tooth after a wide pitch cuts more than one after a narrow one, as their angles.
TEST(CuttingForce, UnequalPitchSharesTheFeedByAngle) {
  Cutter cutter = flat_end(10.0 * mm, 2);
  cutter.mill.pitch_rad = {200.0 * degree, 160.0 * degree};
  const Engagement engagement = engage(cutter, {.axial_depth_m = mm, .radial_depth_m = 10.0 * mm}, {.slices = 3});
  const CuttingForce force = cutting_force(cutter, engagement, {.tangential_n_per_m2 = {1e9}},
                                           {.feed_per_tooth_m = 0.1 * mm, .spindle_speed_rad_per_s = 100.0});
  // Tooth 0 follows tooth 1 by pitch 1; at a rotation of 90 degrees tooth 1 stands at 290, out of the cut.
  EXPECT_NEAR(force.force_n(1, 90), 1e9 * mm * 0.2 * mm * 200.0 / 360.0, 1e-3 * force.force_n(1, 90));
  EXPECT_NEAR(force.force_n(1, 250), 1e9 * mm * 0.2 * mm * 160.0 / 360.0, 1e-3 * force.force_n(1, 250));
}

// Forces on the tool: against the feed in up-milling, pulled along in down-milling; a positive Ka lifts.
TEST(CuttingForce, PushesTheToolTheRightWay) {
  const Cutter cutter = flat_end(10.0 * mm, 4);
  const CutMotion motion = {.feed_per_tooth_m = 0.1 * mm, .spindle_speed_rad_per_s = 100.0};
  const MillingCoefficients coefficients = {
      .tangential_n_per_m2 = {1e9}, .radial_n_per_m2 = {3e8}, .axial_n_per_m2 = {2e8}};
  const auto mean = [&](MillingDirection direction) {
    const Cut cut = {.axial_depth_m = mm, .radial_depth_m = 1.0 * mm, .direction = direction};
    return cutting_force(cutter, engage(cutter, cut), coefficients, motion).mean_n;
  };
  const Eigen::Vector3d up = mean(MillingDirection::up);
  const Eigen::Vector3d down = mean(MillingDirection::down);
  EXPECT_LT(up.x(), 0.0);
  EXPECT_GT(down.x(), 0.0);
  EXPECT_GT(up.z(), 0.0);
  EXPECT_GT(down.z(), 0.0);
  EXPECT_NEAR(up.z(), down.z(), 1e-9);
  // A ball's radial force presses it out of the surface.
  const Cutter ball = ball_end(3.0 * mm);
  const CuttingForce lifted = cutting_force(ball, engage(ball, {.axial_depth_m = 0.3 * mm, .radial_depth_m = 0.5 * mm}),
                                            {.tangential_n_per_m2 = {1e9}, .radial_n_per_m2 = {5e8}}, motion);
  EXPECT_GT(lifted.mean_n.z(), 0.0);
  EXPECT_GT(lifted.mean_torque_n_m, 0.0);
}

TEST(CuttingForce, SummaryIsThatOfTheRevolution) {
  const Cutter cutter = ball_end(3.0 * mm, 2, 30.0 * degree);
  const Engagement engagement = engage(cutter, {.axial_depth_m = mm, .radial_depth_m = mm, .lead_rad = 0.3});
  const CutMotion motion = {.feed_per_tooth_m = 0.02 * mm, .spindle_speed_rad_per_s = 1000.0};
  ForceKernel kernel(cutter, published(), {.steps = 180});
  const CuttingForce force = cutting_force(cutter, engagement, published(), motion, {.steps = 180});
  static_cast<void>(kernel.summary(engage(cutter, slot(2.0 * mm)), motion));  // leaves nothing behind
  const ForceSummary summary = kernel.summary(engagement, motion);
  EXPECT_EQ(summary.mean_n, force.mean_n);
  EXPECT_EQ(summary.peak_force_n, force.peak_force_n);
  EXPECT_NEAR((force.force_n.rowwise().mean() - summary.mean_n).norm(), 0.0, 1e-12 * summary.peak_force_n);
  EXPECT_NEAR(force.force_n.colwise().norm().maxCoeff(), summary.peak_force_n, 1e-12 * summary.peak_force_n);
  EXPECT_NEAR(std::sqrt(force.force_n.row(0).squaredNorm() / 180.0), summary.rms_n.x(), 1e-12 * summary.rms_n.x());
  EXPECT_EQ(std::abs(summary.peak_n.y()), force.force_n.row(1).cwiseAbs().maxCoeff());
  EXPECT_EQ(summary.mean_torque_n_m, force.mean_torque_n_m);
  EXPECT_EQ(force.rotation_rad.size(), 180);
}

// Source: half a turn of a cutter of two equal teeth is the same cutter; without a cut there is no force.
TEST(CuttingForce, RepeatsWithTheToothAndEndsWithTheCut) {
  const Cutter cutter = flat_end(6.0 * mm, 2, 10.0 * degree);
  const Engagement engagement = engage(cutter, {.axial_depth_m = 0.5 * mm, .radial_depth_m = 0.5 * mm});
  const CuttingForce force =
      cutting_force(cutter, engagement, published(), {.feed_per_tooth_m = 0.02 * mm, .spindle_speed_rad_per_s = 1.0});
  for (int k = 0; k < 180; ++k) {
    EXPECT_NEAR((force.force_n.col(k) - force.force_n.col(k + 180)).norm(), 0.0, 1e-10 * force.peak_force_n);
  }
  EXPECT_GT((force.force_n.colwise().norm().array() == 0.0).count(), 40);
  Engagement none;
  none.first_arc = {0};
  const CuttingForce nothing =
      cutting_force(cutter, none, published(), {.feed_per_tooth_m = 0.02 * mm, .spindle_speed_rad_per_s = 1.0});
  EXPECT_EQ(nothing.peak_force_n, 0.0);
  EXPECT_EQ(nothing.removal_rate_m3_per_s, 0.0);
}

// Source: [BallEndRobot] eq. 26. Krc as printed is negative over nearly all of the ball; with a point in -15881 it is
// positive everywhere.
TEST(MillingCoefficients, SayWhereTheyAreNegative) {
  MillingCoefficients c = published();
  c.radial_n_per_m2 = {1169e6, -1588.1e6, 741.1e6, 1221e6};
  EXPECT_NO_THROW(c.validate(0.0, 0.5 * pi));
  c.radial_n_per_m2[1] = -15881e6;
  const std::string said = rejection([&] { c.validate(0.0, 0.8); });
  EXPECT_NE(said.find("radial_n_per_m2"), std::string::npos) << said;
  EXPECT_NE(said.find("45.84 degrees"), std::string::npos) << said;
  const Cutter cutter = ball_end(3.0 * mm);
  const Engagement engagement = engage(cutter, {.axial_depth_m = mm, .radial_depth_m = mm});
  EXPECT_EQ(field_of([&] { static_cast<void>(cutting_force(cutter, engagement, c, {})); }), "radial_n_per_m2");
  ForceKernel kernel(cutter, c);
  EXPECT_EQ(field_of([&] { static_cast<void>(kernel.summary(engagement, {})); }), "radial_n_per_m2");
}

// As fits to a cutter of a high rake angle have it; only a polynomial that changes its sign is a misprint.
TEST(MillingCoefficients, OneRadialNumberMayPullTheToothIn) {
  MillingCoefficients c = published();
  c.radial_n_per_m2 = {-200e6};
  EXPECT_NO_THROW(c.validate(0.0, 0.5 * pi));
  const Cutter cutter = ball_end(3.0 * mm);
  const Engagement engagement = engage(cutter, {.axial_depth_m = mm, .radial_depth_m = mm});
  const CutMotion motion = {.feed_per_tooth_m = 0.02 * mm, .spindle_speed_rad_per_s = 1000.0};
  EXPECT_GT(cutting_force(cutter, engagement, c, motion).peak_force_n, 0.0);
  c.tangential_n_per_m2 = {-200e6};
  EXPECT_EQ(field_of([&] { c.validate(0.0, 0.5 * pi); }), "tangential_n_per_m2");
}

TEST(MillingCoefficients, RejectsMixedUpUnits) {
  const auto field = [](auto change) {
    MillingCoefficients c = published();
    change(c);
    return field_of([&] { c.validate(0.0, 1.5); });
  };
  EXPECT_EQ(field([](MillingCoefficients&) {}), "accepted");
  EXPECT_EQ(field([](MillingCoefficients& c) { c.tangential_n_per_m2.clear(); }), "tangential_n_per_m2");
  EXPECT_EQ(field([](MillingCoefficients& c) { c.tangential_n_per_m2 = {1825.0}; }), "tangential_n_per_m2");
  EXPECT_EQ(field([](MillingCoefficients& c) { c.radial_n_per_m2 = {770e12}; }), "radial_n_per_m2");
  EXPECT_EQ(field([](MillingCoefficients& c) { c.axial_n_per_m2 = {-300e6}; }), "accepted");
  EXPECT_EQ(field([](MillingCoefficients& c) { c.axial_n_per_m2 = {5.0}; }), "axial_n_per_m2");
  EXPECT_EQ(field([](MillingCoefficients& c) { c.axial_edge_n_per_m = {-11.52e3}; }), "accepted");
  EXPECT_EQ(field([](MillingCoefficients& c) { c.radial_edge_n_per_m = {1e9}; }), "radial_edge_n_per_m");
  EXPECT_EQ(field([](MillingCoefficients& c) { c.radial_n_per_m2 = {std::nan(""), 1e9}; }), "radial_n_per_m2[1]");
}

TEST(CutMotion, RejectsWhatIsNoMotion) {
  EXPECT_EQ(field_of([] { CutMotion{.feed_per_tooth_m = -1.0}.validate(); }), "feed_per_tooth_m");
  EXPECT_EQ(field_of([] { CutMotion{.feed_per_tooth_m = 0.1}.validate(); }), "feed_per_tooth_m");
  EXPECT_EQ(field_of([] { CutMotion{.spindle_speed_rad_per_s = std::nan("")}.validate(); }), "spindle_speed_rad_per_s");
  EXPECT_EQ(field_of([] { ForceOptions{.steps = 1}.validate(); }), "steps");
}

// An engagement that was put together wrongly must not reach memory that is not the kernel's.
TEST(CuttingForce, RejectsArcsThatAreNone) {
  const Cutter cutter = flat_end(10e-3);
  const auto rejected_field = [&](auto spoil) {
    Engagement engagement = engage(cutter, {.axial_depth_m = 2e-3, .radial_depth_m = 5e-3});
    spoil(engagement);
    return field_of([&] {
      static_cast<void>(cutting_force(cutter, engagement, {.tangential_n_per_m2 = {9e8}},
                                      {.feed_per_tooth_m = 1e-4, .spindle_speed_rad_per_s = 100.0}));
    });
  };
  EXPECT_EQ(rejected_field([](Engagement& e) { e.arcs.front().exit_rad = e.arcs.front().entry_rad + 12.6; }), "arcs");
  EXPECT_EQ(rejected_field([](Engagement& e) { e.arcs.front().exit_rad = e.arcs.front().entry_rad - 0.1; }), "arcs");
  EXPECT_EQ(rejected_field([](Engagement& e) { e.arcs.front().entry_rad = std::nan(""); }), "arcs");
  EXPECT_EQ(rejected_field([](Engagement& e) { e.first_arc.pop_back(); }), "first_arc");
  EXPECT_EQ(rejected_field([](Engagement& e) { e.feed_from_tool(0, 0) = std::nan(""); }), "feed_from_tool");
}

}  // namespace force_test
}  // namespace robomill::cutting
