#include "robomill/robot/joint_load.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "robomill/base/random.hpp"
#include "robomill/robot/dynamics.hpp"
#include "testing/robot/arms.hpp"
#include "testing/support.hpp"

namespace robomill::robot {
namespace joint_load_test {

using robomill::test::field_of;
using robomill::test::seeds;

const Eigen::Vector3d tip(0.05, -0.02, 0.3);

Link random_link(Random& random) {
  Link link{.mass_kg = random.uniform(5.0, 200.0), .center_m = 0.3 * testing::random_vector(random)};
  const Eigen::Matrix3d turn = testing::random_pose(random, 0.0).linear();
  const Eigen::Vector3d principal(random.uniform(1.0, 2.0), random.uniform(1.0, 2.0), random.uniform(1.0, 2.0));
  const Eigen::Matrix3d inertia = turn * principal.asDiagonal() * turn.transpose();
  link.inertia_kg_m2 = 0.5 * (inertia + inertia.transpose());
  return link;
}

Arm random_heavy_arm(Random& random, int k) {
  Arm arm = k % 2 == 0 ? testing::kr210() : testing::random_chain(random, 1 + k % 7);
  for (Joint& joint : arm.joints) {
    joint.rotor_inertia = random.uniform(0.0, 5.0);
    joint.link = random_link(random);
  }
  return arm;
}

Wrench random_wrench(Random& random) {
  Wrench out;
  out.force_n = 1e3 * testing::random_vector(random);
  out.moment_n_m = 1e2 * testing::random_vector(random);
  return out;
}

Eigen::VectorXd random_rates(Random& random, Eigen::Index size) {
  Eigen::VectorXd out(size);
  for (double& value : out) value = random.normal();
  return out;
}

Eigen::VectorXd part(const std::vector<JointLoad>& loads, double JointLoad::*member) {
  Eigen::VectorXd out(static_cast<Eigen::Index>(loads.size()));
  for (std::size_t i = 0; i < loads.size(); ++i) out(static_cast<Eigen::Index>(i)) = loads[i].*member;
  return out;
}

Eigen::VectorXd torques(const std::vector<JointLoad>& loads) {
  Eigen::VectorXd out(static_cast<Eigen::Index>(loads.size()));
  for (std::size_t i = 0; i < loads.size(); ++i) out(static_cast<Eigen::Index>(i)) = loads[i].torque().value();
  return out;
}

/// Central difference of fourth order along a direction.
template <class F>
auto derivative(F&& f, const Eigen::VectorXd& at, const Eigen::VectorXd& along) {
  constexpr double h = 1e-3;
  using Value = std::decay_t<decltype(f(at))>;
  const Value near = f(Eigen::VectorXd(at + h * along)) - f(Eigen::VectorXd(at - h * along));
  const Value far = f(Eigen::VectorXd(at + 2.0 * h * along)) - f(Eigen::VectorXd(at - 2.0 * h * along));
  return Value((8.0 * near - far) / (12.0 * h));
}

template <class F>
Eigen::VectorXd gradient(F&& f, const Eigen::VectorXd& at) {
  Eigen::VectorXd out(at.size());
  for (Eigen::Index i = 0; i < at.size(); ++i) out(i) = derivative(f, at, Eigen::VectorXd::Unit(at.size(), i));
  return out;
}

/// V = −Σ m g · c, of the links one by one.
double potential(const Arm& arm, const Eigen::VectorXd& position, const Eigen::Vector3d& gravity) {
  double out = 0.0;
  Arm below;
  for (const Joint& joint : arm.joints) {
    below.joints.push_back(joint);
    out -= joint.link.mass_kg * gravity.dot(forward(below, position.head(below.size())) * joint.link.center_m);
  }
  return out;
}

void expect_close(const Eigen::VectorXd& found, const Eigen::VectorXd& expected, double relative) {
  ASSERT_EQ(found.size(), expected.size());
  EXPECT_LT((found - expected).cwiseAbs().maxCoeff(), relative * (1.0 + expected.cwiseAbs().maxCoeff()))
      << found.transpose() << " for " << expected.transpose();
}

// Virtual work: what the drives do over a small motion is what weight and wrench take up.
TEST(JointLoads, StaticsIsTheGradientOfThePotentialEnergy) {
  for (int k = 0; k < seeds(300); ++k) {
    Random random(81, static_cast<std::uint64_t>(k));
    const Arm arm = random_heavy_arm(random, k);
    const Eigen::VectorXd position = testing::random_position(random, arm.size());
    JointLoadOptions options;
    if (k % 3 > 0) options.gravity_m_per_s2 = 9.81 * testing::random_vector(random).normalized();
    const std::vector<JointLoad> loads = joint_loads(arm, position, tip, {}, options);
    const Eigen::VectorXd expected =
        gradient([&](const Eigen::VectorXd& q) { return potential(arm, q, options.gravity_m_per_s2); }, position);
    expect_close(torques(loads), expected, 1e-8);
    expect_close(part(loads, &JointLoad::gravity), torques(loads), 1e-15);
  }
}

// −Jᵀ F from differences of forward kinematics alone: of the point, and of the flange's rotation.
TEST(JointLoads, DrivesOpposeTheWrench) {
  for (int k = 0; k < seeds(300); ++k) {
    Random random(82, static_cast<std::uint64_t>(k));
    const Arm arm = random_heavy_arm(random, k);
    const Eigen::VectorXd position = testing::random_position(random, arm.size());
    const Wrench wrench = random_wrench(random);
    const Eigen::Matrix3d turn = forward(arm, position).linear();
    Eigen::VectorXd expected(arm.size());
    for (Eigen::Index i = 0; i < arm.size(); ++i) {
      const Eigen::VectorXd along = Eigen::VectorXd::Unit(arm.size(), i);
      const Eigen::Vector3d moved =
          derivative([&](const Eigen::VectorXd& q) { return Eigen::Vector3d(forward(arm, q) * tip); }, position, along);
      const Eigen::Matrix3d turned =
          derivative([&](const Eigen::VectorXd& q) { return Eigen::Matrix3d(forward(arm, q).linear()); }, position,
                     along) *
          turn.transpose();
      const Eigen::Vector3d rate(turned(2, 1), turned(0, 2), turned(1, 0));
      expected(i) = -(wrench.force_n.dot(moved) + wrench.moment_n_m.dot(rate));
    }
    const std::vector<JointLoad> loads = joint_loads(arm, position, tip, wrench);
    expect_close(part(loads, &JointLoad::wrench), expected, 1e-8);
    // It adds to the weight and changes nothing else.
    expect_close(torques(loads) - torques(joint_loads(arm, position, tip)), part(loads, &JointLoad::wrench), 1e-12);
  }
}

// Lagrange: d/dt ∂T/∂q̇ − ∂T/∂q with T = ½ q̇ᵀ M q̇, from mass_matrix alone.
TEST(JointLoads, MotionIsThatOfLagrange) {
  for (int k = 0; k < seeds(300); ++k) {
    Random random(83, static_cast<std::uint64_t>(k));
    const Arm arm = random_heavy_arm(random, k);
    const Eigen::VectorXd position = testing::random_position(random, arm.size());
    JointLoadOptions options;
    options.velocity = random_rates(random, arm.size());
    options.acceleration = random_rates(random, arm.size());
    const Eigen::VectorXd& speed = options.velocity;
    const std::vector<JointLoad> loads = joint_loads(arm, position, tip, {}, options);
    const Eigen::MatrixXd mass = mass_matrix(arm, position);
    expect_close(part(loads, &JointLoad::inertia), mass * options.acceleration, 1e-13);
    const Eigen::MatrixXd changing =
        derivative([&](const Eigen::VectorXd& q) { return Eigen::MatrixXd(mass_matrix(arm, q)); }, position, speed);
    const Eigen::VectorXd energy =
        gradient([&](const Eigen::VectorXd& q) { return 0.5 * speed.dot(mass_matrix(arm, q) * speed); }, position);
    expect_close(part(loads, &JointLoad::coriolis), changing * speed - energy, 1e-8);
    const Eigen::VectorXd sum = part(loads, &JointLoad::gravity) + part(loads, &JointLoad::inertia) +
                                part(loads, &JointLoad::coriolis) + part(loads, &JointLoad::wrench);
    expect_close(torques(loads), sum, 1e-15);
  }
}

/// About −y of B, so that a positive angle lifts: x along the arm where it lies level, masses at the links' ends.
Arm pendulum(const std::vector<double>& mass_kg, double length_m) {
  Eigen::Isometry3d base = Eigen::Isometry3d::Identity();
  base.linear() << 1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0;
  Arm arm = arm_from_dh(std::vector<DhRow>(mass_kg.size(), {.a_m = length_m}), base);
  for (std::size_t i = 0; i < mass_kg.size(); ++i) {
    arm.joints[i].link = {.mass_kg = mass_kg[i], .center_m = {length_m, 0.0, 0.0}};
  }
  return arm;
}

// A mass that hangs on a level arm: the drive pushes up, and with the cut pressing up too it needs to push less.
TEST(JointLoads, HoldsAPendulum) {
  Arm arm = pendulum({10.0}, 2.0);
  arm.joints[0].rotor_inertia = 3.0;
  const double angle = 0.4;
  JointLoadOptions options;
  options.acceleration = Eigen::VectorXd::Constant(1, 1.5);
  options.velocity = Eigen::VectorXd::Constant(1, 7.0);
  const std::vector<JointLoad> loads = joint_loads(arm, Eigen::VectorXd::Constant(1, angle), Eigen::Vector3d::Zero(),
                                                   {.force_n = {0.0, 0.0, 30.0}}, options);
  EXPECT_NEAR(loads[0].gravity, 10.0 * 9.80665 * 2.0 * std::cos(angle), 1e-12);
  EXPECT_NEAR(loads[0].inertia, (10.0 * 4.0 + 3.0) * 1.5, 1e-12);
  EXPECT_NEAR(loads[0].coriolis, 0.0, 1e-12);
  EXPECT_NEAR(loads[0].wrench, -30.0 * 2.0 * std::cos(angle), 1e-12);
  EXPECT_EQ(loads[0].status, JointLoad::Status::known);
}

TEST(JointLoads, HoldsADoublePendulumThatTurns) {
  const double m2 = 4.0, l = 0.8, g = 9.80665;
  const Arm arm = pendulum({6.0, m2}, l);
  const Eigen::Vector2d position(0.3, -1.1), speed(1.2, -2.5);
  JointLoadOptions options;
  options.velocity = speed;
  const std::vector<JointLoad> loads = joint_loads(arm, position, Eigen::Vector3d::Zero(), {}, options);
  const double first = l * std::cos(0.3), second = l * std::cos(0.3 - 1.1);
  EXPECT_NEAR(loads[0].gravity, g * (6.0 * first + m2 * (first + second)), 1e-12);
  EXPECT_NEAR(loads[1].gravity, g * m2 * second, 1e-12);
  const double turning = m2 * l * l * std::sin(-1.1);
  EXPECT_NEAR(loads[0].coriolis, -turning * (2.0 * speed(0) * speed(1) + speed(1) * speed(1)), 1e-12);
  EXPECT_NEAR(loads[1].coriolis, turning * speed(0) * speed(0), 1e-12);
}

TEST(JointLoads, SlidesThatRiseHoldTheWeight) {
  Arm arm;
  arm.joints.push_back({.prismatic = true, .link = {.mass_kg = 12.0}});
  const auto held = joint_loads(arm, Eigen::VectorXd::Zero(1), tip, {.force_n = {5.0, 0.0, -20.0}});
  EXPECT_NEAR(held[0].gravity, 12.0 * 9.80665, 1e-12);
  EXPECT_NEAR(held[0].wrench, 20.0, 1e-12);
}

// Base, gravity and wrench turned together: the drives do not notice. An axis turned round: its torque changes sign.
TEST(JointLoads, DoNotDependOnTheFrame) {
  for (int k = 0; k < seeds(200); ++k) {
    Random random(84, static_cast<std::uint64_t>(k));
    const Arm arm = random_heavy_arm(random, k);
    const Eigen::VectorXd position = testing::random_position(random, arm.size());
    JointLoadOptions options;
    options.velocity = random_rates(random, arm.size());
    options.acceleration = random_rates(random, arm.size());
    const Wrench wrench = random_wrench(random);
    const Eigen::VectorXd expected = torques(joint_loads(arm, position, tip, wrench, options));

    const Eigen::Isometry3d turn = testing::random_pose(random, 1.0);
    Arm turned = arm;
    turned.joints.front().before = turn * turned.joints.front().before;
    JointLoadOptions in_turned = options;
    in_turned.gravity_m_per_s2 = turn.linear() * options.gravity_m_per_s2;
    const Wrench with_it{.force_n = turn.linear() * wrench.force_n, .moment_n_m = turn.linear() * wrench.moment_n_m};
    expect_close(torques(joint_loads(turned, position, tip, with_it, in_turned)), expected, 1e-11);

    const auto j = static_cast<Eigen::Index>(random.index(static_cast<std::uint64_t>(arm.size())));
    Arm other_way = arm;
    other_way.joints[static_cast<std::size_t>(j)].axis *= -1.0;
    Eigen::VectorXd mirrored = position, against = expected;
    JointLoadOptions backwards = options;
    for (Eigen::VectorXd* vector : {&mirrored, &against, &backwards.velocity, &backwards.acceleration}) {
      (*vector)(j) *= -1.0;
    }
    expect_close(torques(joint_loads(other_way, mirrored, tip, wrench, backwards)), against, 1e-11);
  }
}

TEST(JointLoads, AreUnknownBelowALinkWithoutMass) {
  Random random(85);
  const Arm bare = testing::kr210();
  const Eigen::VectorXd position = testing::kr210_posture();
  const Wrench wrench = random_wrench(random);
  const std::vector<JointLoad> none = joint_loads(bare, position, tip, wrench);
  for (const JointLoad& load : none) {
    EXPECT_EQ(load.status, JointLoad::Status::mass_unknown);
    EXPECT_FALSE(load.torque());
  }
  Arm arm = random_heavy_arm(random, 0);
  expect_close(part(none, &JointLoad::wrench), part(joint_loads(arm, position, tip, wrench), &JointLoad::wrench),
               1e-15);
  const Eigen::VectorXd whole = torques(joint_loads(arm, position, tip, wrench));
  arm.joints[2].link = {};
  const std::vector<JointLoad> some = joint_loads(arm, position, tip, wrench);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(some[i].torque().has_value(), i > 2) << i;
    if (i > 2) {
      EXPECT_NEAR(*some[i].torque(), whole(static_cast<Eigen::Index>(i)), 1e-9);
    } else {
      EXPECT_EQ(some[i].gravity, 0.0);
    }
  }
  const std::vector<JointLoadRange> ranges = joint_load_ranges(arm, position, tip, std::vector<Wrench>{wrench});
  EXPECT_EQ(ranges[2].status, JointLoad::Status::mass_unknown);
  EXPECT_EQ(ranges[2].max, 0.0);
}

// A payload weighs −J_cᵀ (m g) and adds its own mass matrix.
TEST(JointLoads, APayloadIsAnotherBodyOnTheLastJoint) {
  for (int k = 0; k < seeds(100); ++k) {
    Random random(86, static_cast<std::uint64_t>(k));
    const Arm arm = random_heavy_arm(random, k);
    const Link payload = random_link(random);
    const Eigen::VectorXd position = testing::random_position(random, arm.size());
    const Arm both = with_payload(arm, payload);
    Arm alone = arm;
    for (Joint& joint : alone.joints) {
      joint.link = {};
      joint.rotor_inertia = 0.0;
    }
    alone.joints.back().link = payload;
    const Eigen::MatrixXd mass = mass_matrix(arm, position) + mass_matrix(alone, position);
    EXPECT_LT((mass_matrix(both, position) - mass).cwiseAbs().maxCoeff(), 1e-12 * mass.cwiseAbs().maxCoeff());
    const Wrench weight{.force_n = {0.0, 0.0, -9.80665 * payload.mass_kg}};
    Arm to_link = arm;
    to_link.flange.setIdentity();
    const Eigen::VectorXd expected = torques(joint_loads(arm, position, tip)) +
                                     part(joint_loads(to_link, position, payload.center_m, weight), &JointLoad::wrench);
    expect_close(torques(joint_loads(both, position, tip)), expected, 1e-11);
  }
  EXPECT_EQ(field_of([] { (void)with_payload(testing::kr210(), {}); }), "payload.mass_kg");
}

TEST(JointLoads, RangeOverTheWrenchesOfARevolution) {
  Random random(87);
  const Arm arm = random_heavy_arm(random, 0);
  const Eigen::VectorXd position = testing::kr210_posture();
  std::vector<Wrench> wrenches(36);
  for (Wrench& wrench : wrenches) wrench = random_wrench(random);
  Eigen::VectorXd low = Eigen::VectorXd::Constant(6, 1e300), high = -low;
  for (const Wrench& wrench : wrenches) {
    const Eigen::VectorXd torque = torques(joint_loads(arm, position, tip, wrench));
    low = low.cwiseMin(torque).eval();
    high = high.cwiseMax(torque).eval();
  }
  const std::vector<JointLoadRange> ranges = joint_load_ranges(arm, position, tip, wrenches);
  for (std::size_t i = 0; i < 6; ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    EXPECT_EQ(ranges[i].status, JointLoad::Status::known);
    EXPECT_NEAR(ranges[i].min, low(row), 1e-9);
    EXPECT_NEAR(ranges[i].max, high(row), 1e-9);
  }
  Joint joint;
  EXPECT_FALSE(torque_share(joint, ranges[0]));
  joint.max_torque = 200.0;
  EXPECT_EQ(torque_share(joint, {.status = JointLoad::Status::known, .min = -300.0, .max = 100.0}), 1.5);
  EXPECT_FALSE(torque_share(joint, {.min = -300.0, .max = 100.0}));
}

TEST(JointLoads, RejectWhatIsWrong) {
  Random random(88);
  Arm arm = random_heavy_arm(random, 0);
  const Eigen::VectorXd position = testing::kr210_posture();
  const auto loads = [&](const Wrench& wrench, const JointLoadOptions& options) {
    return field_of([&] { (void)joint_loads(arm, position, tip, wrench, options); });
  };
  JointLoadOptions options;
  options.gravity_m_per_s2.x() = NAN;
  EXPECT_EQ(loads({}, options), "gravity_m_per_s2");
  options = {};
  options.velocity = Eigen::VectorXd::Zero(5);
  EXPECT_EQ(loads({}, options), "velocity");
  options = {};
  options.acceleration = Eigen::VectorXd::Constant(6, INFINITY);
  EXPECT_EQ(loads({}, options), "acceleration");
  EXPECT_EQ(loads({.force_n = {NAN, 0.0, 0.0}}, {}), "wrench.force_n");
  EXPECT_EQ(loads({.moment_n_m = {NAN, 0.0, 0.0}}, {}), "wrench.moment_n_m");
  EXPECT_EQ(field_of([&] { (void)joint_loads(arm, position.head(4), tip); }), "position");
  EXPECT_EQ(field_of([&] { (void)joint_load_ranges(arm, position, tip, {}); }), "wrenches");
  arm.joints[1].max_torque = -1.0;
  EXPECT_EQ(loads({}, {}), "joints[2].max_torque");
}

// ---- reversal under load

using Found = std::tuple<std::size_t, Eigen::Index, LoadReversal::Kind>;
std::vector<Found> found(const std::vector<LoadedBlock>& blocks, const ReversalOptions& options = {}) {
  std::vector<Found> out;
  for (const LoadReversal& reversal : load_reversals(blocks, options)) {
    out.emplace_back(reversal.block, reversal.joint, reversal.kind);
  }
  return out;
}

LoadedBlock block(const std::vector<std::pair<double, double>>& joints, bool cuts = true) {
  LoadedBlock out{.joints = {}, .cuts = cuts};
  for (const auto& [min, max] : joints) {
    out.joints.push_back({.status = JointLoad::Status::known, .min = min, .max = max});
  }
  return out;
}

constexpr auto within_block = LoadReversal::Kind::within;
constexpr auto between_blocks = LoadReversal::Kind::between;

TEST(LoadReversals, AreWithinABlockOrBetweenTwo) {
  EXPECT_TRUE(found({}).empty());
  EXPECT_EQ(found({block({{1.0, 2.0}, {-3.0, 1.0}}), block({{-2.0, -1.0}, {1.0, 2.0}}),
                   block({{-2.0, 0.0}, {0.0, 0.0}}), block({{0.5, 2.0}, {-1.0, -0.5}})}),
            (std::vector<Found>{
                {0, 1, within_block}, {1, 0, between_blocks}, {3, 0, between_blocks}, {3, 1, between_blocks}}));
}

TEST(LoadReversals, ARapidMoveOrAnUnknownLoadStartsAnew) {
  EXPECT_TRUE(found({block({{1.0, 2.0}}), block({{-5.0, 5.0}}, false), block({{-2.0, -1.0}})}).empty());
  LoadedBlock unknown;
  unknown.joints.resize(1);
  EXPECT_TRUE(found({block({{1.0, 2.0}}), unknown, block({{-2.0, -1.0}})}).empty());
}

TEST(LoadReversals, RoundingIsNone) {
  // A vertical axis: gravity turns it by rounding alone, or the largest is a cut's.
  const std::vector<LoadedBlock> blocks = {block({{-1e-13, 40.0}}), block({{-1e-13, 1e-13}}), block({{1e-9, 20.0}})};
  EXPECT_TRUE(found(blocks).empty());
  EXPECT_EQ(found(blocks, {.least_share = 0.0}).size(), 2U);
  EXPECT_EQ(found({block({{-1.0, 40.0}})}).size(), 1U);
  EXPECT_TRUE(found({block({{-1.0, 40.0}})}, {.least_share = 0.1}).empty());
}

// What must not matter: the torques' unit, the sense of an axis, the order of joints; backwards there are as many.
TEST(LoadReversals, AreThoseOfTheMirroredProgram) {
  for (int k = 0; k < seeds(500); ++k) {
    Random random(89, static_cast<std::uint64_t>(k));
    const std::size_t n = 1 + random.index(6);
    std::vector<LoadedBlock> blocks(1 + random.index(20));
    for (LoadedBlock& each : blocks) {
      each.cuts = random.uniform() < 0.9;
      for (std::size_t j = 0; j < n; ++j) {
        const double middle = random.normal(), half = random.uniform(0.0, 0.5);
        each.joints.push_back({.status = JointLoad::Status::known, .min = middle - half, .max = middle + half});
      }
    }
    const std::vector<Found> expected = found(blocks);
    std::vector<LoadedBlock> mirrored = blocks, swapped = blocks, reversed = blocks;
    for (LoadedBlock& each : mirrored) {
      for (JointLoadRange& load : each.joints) {
        std::swap(load.min, load.max);
        load.min *= -1e3;
        load.max *= -1e3;
      }
    }
    EXPECT_EQ(found(mirrored), expected);
    for (LoadedBlock& each : swapped) std::ranges::reverse(each.joints);
    std::vector<Found> back = found(swapped);
    for (auto& [number, joint, kind] : back) joint = static_cast<Eigen::Index>(n) - 1 - joint;
    std::ranges::sort(back);
    EXPECT_EQ(back, expected);
    std::ranges::reverse(reversed);
    EXPECT_EQ(found(reversed).size(), expected.size());
    // Every reversal is one: a sign of its own on either side.
    for (const auto& [number, joint, kind] : expected) {
      const JointLoadRange& load = blocks[number].joints[static_cast<std::size_t>(joint)];
      EXPECT_TRUE(blocks[number].cuts);
      EXPECT_EQ(load.min < 0.0 && load.max > 0.0, kind == within_block);
    }
  }
}

TEST(LoadReversals, RejectWhatIsWrong) {
  EXPECT_EQ(field_of([] { (void)found({block({{1.0, 2.0}}), block({})}); }), "blocks[2].joints");
  EXPECT_EQ(field_of([] { (void)found({block({{1.0, 2.0}, {2.0, 1.0}})}); }), "blocks[1].joints[2]");
  EXPECT_EQ(field_of([] { (void)found({block({{NAN, 2.0}})}); }), "blocks[1].joints[1]");
  EXPECT_EQ(field_of([] { (void)found({block({})}, {.least_share = 1.0}); }), "least_share");
}

}  // namespace joint_load_test
}  // namespace robomill::robot
