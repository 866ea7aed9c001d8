// Vibration of any cutter: growth, energy, and the deflection of a compliance.
#include <gtest/gtest.h>
#include <Eigen/LU>

#include <cmath>
#include <numbers>
#include <vector>

#include "robomill/base/linear_algebra.hpp"

#include "testing/simulation/posture_cases.hpp"

namespace robomill::simulation {
namespace posture_vibration_test {

using detail::Physics;
using std::numbers::pi;
using testing::edge_force;
using testing::EdgeForce;
using testing::for_edges;
using testing::normal;
using testing::polynomial;
using testing::Process;
using testing::revolution;

// A ball that cuts all round as it is fed along its axis: along that axis nothing varies, and
// c = N Σ db (Kr cos κ + Ka sin κ) cos κ; one mode then has the characteristic equation of a turned shaft, and below
// c = 2 k ζ (1 + ζ) no speed chatters [Tlusty1963].
TEST(Posture, APlungingBallHasTheTurnedShaftsEquation) {
  const double mass = 0.8, zeta = 0.04, frequency = 600.0, omega = revolution * frequency;
  PostureCut cut = testing::ball_cut(-0.5 * pi, 0.0, 1);
  cut.engagement = testing::looked_at(cut.cutter, cut.engagement.feed_from_tool, 24,
                                      [](const Eigen::Vector3d& p, const Eigen::Vector3d&) { return p.x() > 2e-3; });
  cut.coefficients.axial_n_per_m2 = {4e8};
  cut.structure = testing::one_mode(0, frequency, zeta, mass);
  double c = 0.0;
  for (const cutting::EdgeSlice& slice : cut.engagement.slices) {
    const double kappa = slice.position_rad;
    c += 2.0 * slice.width_m * std::cos(kappa) *
         (polynomial(cut.coefficients.radial_n_per_m2, kappa) * std::cos(kappa) + 4e8 * std::sin(kappa));
  }
  const double limit = 2.0 * mass * omega * omega * zeta * (1.0 + zeta);
  for (const double share : {0.3, 0.97, 1.5}) {
    PostureCut scaled = cut;
    for (cutting::EdgeSlice& slice : scaled.engagement.slices) slice.width_m *= share * limit / c;
    for (const double speed_rpm : {3100.0, 4400.0, 8700.0, 16000.0}) {
      scaled.motion.spindle_speed_rad_per_s = speed_rpm * testing::rpm;
      const double expected = testing::axial_radius(mass, zeta, omega, share * limit, 30.0 / speed_rpm);
      const SmallVibration small = small_vibration(scaled);
      ASSERT_EQ(small.status, SmallVibration::Status::found);
      EXPECT_NEAR(small.spectral_radius, expected, 1e-4 * expected) << share << " " << speed_rpm;
      if (share < 1.0) {
        EXPECT_LT(small.spectral_radius, 1.0);
      }
    }
  }
}

/// Largest multiplier of a tooth period for one mode in each direction, by the trapezoidal rule on the delay equation
/// M q'' + C q' + K q = A(t) (q(t) - q(t - τ)), A in F from the engagement itself.
double trapezoidal_radius(const PostureCut& cut, const Eigen::Vector3d& mass, const Eigen::Vector3d& zeta,
                          const Eigen::Vector3d& omega, int intervals) {
  const double tau = revolution / cut.motion.spindle_speed_rad_per_s / cut.cutter.mill.teeth;
  const double h = tau / intervals;
  const Eigen::Matrix3d to_feed = cut.engagement.feed_from_tool;
  const auto stiffness = [&](double rotation) {
    Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
    for_edges(cut, rotation, [&](const cutting::EdgeSlice& slice, int, double angle) {
      a += edge_force(cut, slice, angle).per_chip_n_per_m * normal(slice.position_rad, angle).transpose();
    });
    return Eigen::Matrix3d(to_feed * a * to_feed.transpose());
  };
  std::vector<Eigen::Matrix3d> a;
  for (int i = 0; i <= intervals; ++i) {
    // Over a step's width, as edges come and go.
    constexpr int parts = 16;
    Eigen::Matrix3d mean = Eigen::Matrix3d::Zero();
    for (int p = 0; p < parts; ++p)
      mean += stiffness((i + (p + 0.5) / parts - 0.5) * h * cut.motion.spindle_speed_rad_per_s) / parts;
    a.push_back(mean);
  }
  const Eigen::Matrix3d m = mass.asDiagonal();
  const Eigen::Matrix3d damping = (2.0 * mass.array() * zeta.array() * omega.array()).matrix().asDiagonal();
  const Eigen::Matrix3d spring = (mass.array() * omega.array().square()).matrix().asDiagonal();
  const Eigen::Index n = 3 * (intervals + 1) + 3;  // q at -τ ... 0, velocity
  // Each column of the state is one start; all go through a period at once.
  Eigen::MatrixXd history = Eigen::MatrixXd::Zero(3 * (2 * intervals + 1), n);
  history.topLeftCorner(n - 3, n - 3).setIdentity();
  Eigen::MatrixXd velocity = Eigen::MatrixXd::Zero(3, n);
  velocity.rightCols(3).setIdentity();
  for (int i = 0; i < intervals; ++i) {
    const Eigen::MatrixXd q = history.middleRows(3 * (intervals + i), 3);
    const Eigen::MatrixXd before = history.middleRows(3 * i, 3), before_next = history.middleRows(3 * (i + 1), 3);
    const auto k = static_cast<std::size_t>(i);
    // q⁺ = q + h (v + v⁺) / 2, M (v⁺ - v) = h / 2 (sum of the forces at both ends).
    const Eigen::Matrix3d now = a[k] - spring, next = a[k + 1] - spring;
    const Eigen::Matrix3d left = m + 0.5 * h * damping - 0.25 * h * h * next;
    const Eigen::MatrixXd right = (m - 0.5 * h * damping + 0.25 * h * h * next) * velocity +
                                  0.5 * h * (now + next) * q - 0.5 * h * (a[k] * before + a[k + 1] * before_next);
    const Eigen::MatrixXd faster = left.inverse() * right;
    history.middleRows(3 * (intervals + i + 1), 3) = q + 0.5 * h * (velocity + faster);
    velocity = faster;
  }
  Eigen::MatrixXd map(n, n);
  map << history.bottomRows(n - 3), velocity;
  return linear_algebra::eigenvalues(map).cwiseAbs().maxCoeff();
}

// A tilted ball, modes along x, y and z: two ways to the same multiplier that share no code.
TEST(Posture, SmallVibrationIsThatOfTheDelayEquation) {
  const Eigen::Vector3d mass(0.4, 0.6, 0.5), zeta(0.02, 0.03, 0.025), hz(700.0, 820.0, 640.0);
  int unstable = 0;
  for (const double factor : {1.0, 4.0, 12.0}) {
    PostureCut cut = testing::ball_cut(0.25, -0.35, 16);
    for (cutting::EdgeSlice& slice : cut.engagement.slices) slice.width_m *= factor;
    cut.structure =
        modal::joined(testing::one_mode(0, hz(0), zeta(0), mass(0)), testing::one_mode(1, hz(1), zeta(1), mass(1)));
    cut.structure = modal::joined(cut.structure, testing::one_mode(2, hz(2), zeta(2), mass(2)));
    const double coarse = trapezoidal_radius(cut, mass, zeta, revolution * hz, 50);
    const double fine = trapezoidal_radius(cut, mass, zeta, revolution * hz, 100);
    const SmallVibration small = small_vibration(cut);
    ASSERT_EQ(small.status, SmallVibration::Status::found);
    EXPECT_NEAR(small.spectral_radius, fine + (fine - coarse) / 3.0, 2e-3) << factor;
    unstable += small.spectral_radius > 1.0 ? 1 : 0;
  }
  EXPECT_GT(unstable, 0);
  EXPECT_LT(unstable, 3);
}

// A robot that is a stiffness alone: at every moment q = S F(q), the chip being what q and the tooth before left. With
// straight teeth and steps that meet their pitch that is a fixed point a step, found here by going round.
TEST(Posture, AComplianceAloneFollowsTheFixedPointOfForceAndDeflection) {
  PostureCut cut = testing::ball_cut(0.2, 0.3, 12);
  cut.cutter.mill.helix_rad = 0.0;
  const int steps = 240, delay = 120;
  cut.structure.compliance << 8e-8, 2e-8, -1e-8, 1e-8, 6e-8, 3e-8, -2e-8, 1e-8, 9e-8;
  Process run(cut, steps, Physics::linear);
  const Eigen::Matrix3d to_feed = cut.engagement.feed_from_tool;
  std::vector<Eigen::Vector3d> q(static_cast<std::size_t>(delay), Eigen::Vector3d::Zero());
  double first = 0.0, largest = 0.0;
  for (int i = 1; i <= 4 * delay; ++i) {
    run.engine.step();
    Eigen::Vector3d force = Eigen::Vector3d::Zero(), now = Eigen::Vector3d::Zero();
    const Eigen::Vector3d before = q[q.size() - delay];
    const double rotation = revolution * i / steps - 1e-9;  // the engine gives the state just before
    for (int pass = 0; pass < 60; ++pass) {
      force.setZero();
      for_edges(cut, rotation, [&](const cutting::EdgeSlice& slice, int, double angle) {
        const Eigen::Vector3d n = to_feed * normal(slice.position_rad, angle);
        const EdgeForce edge = edge_force(cut, slice, angle);
        const double chip = cut.motion.feed_per_tooth_m * n.x() + n.dot(now - before);
        force += to_feed * (edge.per_chip_n_per_m * chip + edge.edge_n);
      });
      now = cut.structure.compliance * force;
    }
    q.push_back(now);
    largest = std::max(largest, now.norm());
    if (i <= delay)
      first = std::max(first, (now - cut.structure.compliance * testing::rigid_force(cut, rotation)).norm());
    EXPECT_NEAR((run.displacement() - now).norm(), 0.0, 1e-4 * largest) << i;
  }
  // The deflection fed back: it was no small part of the first tooth's.
  EXPECT_GT(first, 0.02 * largest);
}

// What the force puts in during a revolution of steady motion is what damping takes out.
TEST(Posture, ForceFeedsWhatDampingTakes) {
  PostureCut cut = testing::ball_cut(0.1, 0.3, 16);
  cut.motion.feed_per_tooth_m = 2e-5;
  const Eigen::Vector3d mass(2.0, 1.5, 2.5), zeta(0.04, 0.03, 0.05), hz(500.0, 760.0, 430.0);
  cut.structure = testing::no_modes();
  for (const Eigen::Index axis : {0, 1, 2}) {
    cut.structure = modal::joined(cut.structure, testing::one_mode(axis, hz(axis), zeta(axis), mass(axis)));
  }
  const int steps = 1200;
  Process run(cut, steps, Physics::full);
  const Eigen::Vector3d c = 4.0 * pi * zeta.array() * hz.array() * mass.array();
  double in = 0.0, out = 0.0;
  for (int i = 0; i < 200 * steps; ++i) {
    const Eigen::Vector3d before = run.displacement();
    run.engine.step();
    if (i < 199 * steps) continue;
    const Eigen::Vector3d moved = run.displacement() - before;
    in += run.force().dot(moved);
    out += c.dot(moved.cwiseAbs2()) / run.engine.step_s();
  }
  EXPECT_GT(out, 0.0);
  EXPECT_NEAR(in, out, 1e-4 * out);
}

TEST(Posture, ConvergesAtSecondOrder) {
  PostureCut cut = testing::ball_cut(0.25, -0.35, 12);
  cut.structure = testing::arm_modes();
  const auto displacements = [&](int factor) {
    Process run(cut, 240 * factor, Physics::linear);
    Eigen::MatrixXd q(3, 240 * 4);
    for (int i = 1; i <= 4 * 240 * factor; ++i) {
      run.engine.step();
      if (i % factor == 0) q.col(i / factor - 1) = run.displacement();
    }
    return q;
  };
  const Eigen::MatrixXd exact = displacements(16);
  const double coarse = (displacements(1) - exact).norm(), fine = (displacements(4) - exact).norm();
  EXPECT_GT(std::sqrt(coarse / fine), 3.5);
  EXPECT_LT(fine, 1e-4 * exact.norm());
}

TEST(Posture, AnArmsCutGivesAVerdictAndAllThreeForces) {
  PostureCut cut = testing::ball_cut(0.2, 0.1, 12);
  cut.motion.feed_per_tooth_m = 2e-5;
  cut.structure = testing::arm_modes();
  for (const double factor : {0.3, 4.0}) {
    PostureCut wider = cut;
    for (cutting::EdgeSlice& slice : wider.engagement.slices) slice.width_m *= factor;
    const Simulation s = simulate(wider, {.seconds = 1.0});
    ASSERT_EQ(s.small.status, SmallVibration::Status::found);
    EXPECT_EQ(s.verdict, factor < 1.0 ? Verdict::stable : Verdict::chatter);
    EXPECT_EQ(s.small.spectral_radius < 1.0, factor < 1.0);
    EXPECT_TRUE(s.resolved);
    EXPECT_TRUE(s.displacement_m.allFinite());
    for (const Eigen::Index axis : {0, 1, 2}) {
      EXPECT_GT(s.force_n.col(axis).cwiseAbs().maxCoeff(), 1.0);
      EXPECT_GT(s.displacement_m.col(axis).cwiseAbs().maxCoeff(), 1e-7);
    }
  }
  cut.engagement = {};
  const Simulation air = simulate(cut, {.seconds = 0.05});
  EXPECT_EQ(air.force_n.cwiseAbs().maxCoeff(), 0.0);
  EXPECT_EQ(air.verdict, Verdict::stable);
}

}  // namespace posture_vibration_test
}  // namespace robomill::simulation
