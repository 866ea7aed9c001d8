#include "robomill/robot/identify.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "robomill/base/random.hpp"
#include "testing/robot/arms.hpp"
#include "testing/support.hpp"

namespace robomill::robot {
namespace identify_test {

using robomill::test::field_of;
using robomill::test::seeds;

const Eigen::Vector3d tip(0.1, -0.05, 0.3);

/// Loads in random postures and directions, with the displacements of the loaded equilibrium.
std::vector<Load> planted_loads(const Arm& arm, Random& random, int count, double force_n, double noise_m) {
  std::vector<Load> out;
  for (int k = 0; k < count; ++k) {
    Load load{.position = 0.4 * testing::random_position(random, arm.size())};
    load.wrench = {.force_n = force_n * testing::random_vector(random),
                   .moment_n_m = 0.1 * force_n * testing::random_vector(random)};
    const LoadedPosture loaded = loaded_posture(arm, load.position, tip, load.wrench);
    EXPECT_EQ(loaded.status, LoadedPosture::Status::converged);
    load.displacement_m = loaded.displacement_m + noise_m * testing::random_vector(random);
    out.push_back(load);
  }
  return out;
}

TEST(Identify, FindsPlantedStiffnessWithoutNoise) {
  Random random(41);
  Arm arm = testing::kr210();
  for (const double force_n : {100.0, 5000.0}) {
    const IdentifiedStiffness found = identify_joint_stiffness(arm, tip, planted_loads(arm, random, 15, force_n, 0.0));
    EXPECT_EQ(found.status, IdentifiedStiffness::Status::converged);
    for (std::size_t i = 0; i < 6; ++i) {
      EXPECT_TRUE(found.joints[i].identifiable) << found.joints[i].reason;
      EXPECT_NEAR(found.joints[i].stiffness, arm.joints[i].stiffness, 1e-9 * arm.joints[i].stiffness);
      EXPECT_LT(found.joints[i].deviation, 1e-9 * arm.joints[i].stiffness);
    }
    EXPECT_NEAR(found.r_squared, 1.0, 1e-12);
    EXPECT_LT(found.rms_m, 1e-12);
  }
  // Sliding joints among turning ones.
  Arm chain = testing::random_chain(random, 6);
  for (Joint& joint : chain.joints) joint.stiffness = (joint.prismatic ? 1e7 : 1e6) * random.uniform(1.0, 3.0);
  const IdentifiedStiffness found = identify_joint_stiffness(chain, tip, planted_loads(chain, random, 20, 500.0, 0.0));
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(found.joints[i].stiffness, chain.joints[i].stiffness, 1e-9 * chain.joints[i].stiffness);
  }
}

TEST(Identify, DeviationsHoldUnderNoise) {
  const Arm arm = testing::kr210();
  int within = 0, all = 0;
  for (int k = 0; k < seeds(2000); ++k) {
    Random random(42, static_cast<std::uint64_t>(k));
    constexpr double noise_m = 20e-6;
    const IdentifiedStiffness found =
        identify_joint_stiffness(arm, tip, planted_loads(arm, random, 30, 500.0, noise_m));
    ASSERT_EQ(found.status, IdentifiedStiffness::Status::converged);
    for (std::size_t i = 0; i < 6; ++i) {
      const IdentifiedJoint& joint = found.joints[i];
      ++all;
      if (std::abs(joint.compliance - 1.0 / arm.joints[i].stiffness) < 2.0 * joint.compliance_deviation) ++within;
    }
    EXPECT_NEAR(found.rms_m, noise_m, 0.4 * noise_m);
  }
  // A deviation that comes from 84 numbers itself: 95.1 % of Student's distribution.
  EXPECT_NEAR(within / static_cast<double>(all), 0.951, 0.02);
}

TEST(Identify, WeighsLoadsByTheirDeviation) {
  const Arm arm = testing::kr210();
  double weighted = 0.0, plain = 0.0;
  for (int k = 0; k < 20; ++k) {
    Random random(43, static_cast<std::uint64_t>(k));
    std::vector<Load> loads = planted_loads(arm, random, 20, 500.0, 0.0);
    for (std::size_t i = 0; i < loads.size(); ++i) {
      loads[i].deviation_m = i % 2 == 0 ? 1e-6 : 200e-6;
      loads[i].displacement_m += loads[i].deviation_m * testing::random_vector(random);
    }
    const IdentifiedStiffness with = identify_joint_stiffness(arm, tip, loads);
    for (Load& load : loads) load.deviation_m = 0.0;
    const IdentifiedStiffness without = identify_joint_stiffness(arm, tip, loads);
    for (std::size_t i = 0; i < 6; ++i) {
      weighted += std::pow(with.joints[i].compliance * arm.joints[i].stiffness - 1.0, 2);
      plain += std::pow(without.joints[i].compliance * arm.joints[i].stiffness - 1.0, 2);
    }
    EXPECT_NEAR((with.residual_m.col(0) - (loads[0].displacement_m -
                                           loaded_posture(arm, loads[0].position, tip, loads[0].wrench).displacement_m))
                    .norm(),
                0.0, 20e-6);
  }
  EXPECT_LT(weighted, 1e-2 * plain);
}

TEST(Identify, ReportsAJointThatNoLoadTurns) {
  // Forces along axis 1, which stands upright, and through the flange: neither moment nor motion about it.
  Random random(44);
  const Arm arm = testing::kr210();
  std::vector<Load> loads = planted_loads(arm, random, 15, 500.0, 0.0);
  for (Load& load : loads) {
    load.wrench = {.force_n = {0.0, 0.0, random.uniform(300.0, 900.0)}};
    load.displacement_m = loaded_posture(arm, load.position, tip, load.wrench).displacement_m;
  }
  const IdentifiedStiffness found = identify_joint_stiffness(arm, tip, loads);
  EXPECT_FALSE(found.joints[0].identifiable);
  EXPECT_EQ(found.joints[0].reason, "no load turns this joint");
  EXPECT_EQ(found.joints[0].stiffness, 0.0);
  for (std::size_t i = 1; i < 6; ++i) {
    EXPECT_TRUE(found.joints[i].identifiable) << i << found.joints[i].reason;
    EXPECT_NEAR(found.joints[i].stiffness, arm.joints[i].stiffness, 1e-9 * arm.joints[i].stiffness);
  }
}

TEST(Identify, ReportsAJointWhoseTurningDoesNotMoveThePoint) {
  Random random(45);
  const Arm arm = testing::kr210();
  std::vector<Load> loads = planted_loads(arm, random, 15, 500.0, 0.0);
  const Eigen::Vector3d on_axis_6(0.0, 0.0, 0.3);
  for (Load& load : loads)
    load.displacement_m = loaded_posture(arm, load.position, on_axis_6, load.wrench).displacement_m;
  const IdentifiedStiffness found = identify_joint_stiffness(arm, on_axis_6, loads);
  EXPECT_FALSE(found.joints[5].identifiable);
  EXPECT_EQ(found.joints[5].reason, "where loads turn this joint the point does not move");
  EXPECT_NEAR(found.joints[2].stiffness, arm.joints[2].stiffness, 1e-6 * arm.joints[2].stiffness);
}

TEST(Identify, ReportsJointsThatStandInOneLine) {
  Random random(46);
  const Arm arm = testing::kr210();
  std::vector<Load> loads = planted_loads(arm, random, 15, 500.0, 0.0);
  for (Load& load : loads) {
    load.position(4) = 0.0;
    load.displacement_m = loaded_posture(arm, load.position, tip, load.wrench).displacement_m;
  }
  // Under a load the wrist bends a little. The linear part cannot distinguish the joints; their deviations show it.
  const IdentifiedStiffness found = identify_joint_stiffness(arm, tip, loads);
  for (Load& load : loads) load.displacement_m += 1e-6 * testing::random_vector(random);
  const IdentifiedStiffness noisy = identify_joint_stiffness(arm, tip, loads);
  for (const std::size_t i : {std::size_t{3}, std::size_t{5}}) {
    EXPECT_FALSE(noisy.joints[i].identifiable);
    EXPECT_FALSE(noisy.joints[i].reason.empty());
  }
  EXPECT_TRUE(noisy.joints[1].identifiable);
  EXPECT_GT(found.condition_number, 1e3);
}

TEST(Identify, ReportsAJointThatComesOutSofterThanNothing) {
  Random random(47);
  Arm arm = testing::kr210();
  arm.joints[5].stiffness = 1e12;
  int taken_as_rigid = 0;
  for (int k = 0; k < 20; ++k) {
    const IdentifiedStiffness found = identify_joint_stiffness(arm, tip, planted_loads(arm, random, 20, 500.0, 20e-6));
    EXPECT_FALSE(found.joints[5].identifiable);
    EXPECT_TRUE(found.joints[1].identifiable);
    if (found.joints[5].reason.find("taken as rigid") != std::string::npos) {
      ++taken_as_rigid;
      EXPECT_LE(found.joints[5].compliance, 0.0);
    }
  }
  EXPECT_GT(taken_as_rigid, 4);
  EXPECT_LT(taken_as_rigid, 16);
}

TEST(Identify, RejectsLoadsThatSayNothing) {
  Random random(48);
  const Arm arm = testing::kr210();
  const std::vector<Load> good = planted_loads(arm, random, 5, 500.0, 0.0);
  const auto field = [&](auto&& spoil) {
    std::vector<Load> loads = good;
    spoil(loads);
    return field_of([&] { (void)identify_joint_stiffness(arm, tip, loads); });
  };
  EXPECT_EQ(field([](auto&) {}), "accepted");
  EXPECT_EQ(field([](auto& loads) { loads.resize(1); }), "loads");
  EXPECT_EQ(field([](auto& loads) { loads[2].position.conservativeResize(5); }), "loads[3].position");
  EXPECT_EQ(field([](auto& loads) { loads[2].position(0) = std::nan(""); }), "loads[3].position");
  EXPECT_EQ(field([](auto& loads) { loads[0].wrench.force_n(0) = std::nan(""); }), "loads[1].wrench.force_n");
  EXPECT_EQ(field([](auto& loads) { loads[0].wrench.moment_n_m(0) = std::nan(""); }), "loads[1].wrench.moment_n_m");
  EXPECT_EQ(field([](auto& loads) { loads[4].displacement_m(2) = std::nan(""); }), "loads[5].displacement_m");
  EXPECT_EQ(field([](auto& loads) { loads[4].deviation_m = 1e-6; }), "loads[5].deviation_m");
  EXPECT_EQ(field([](auto& loads) { loads[4].deviation_m = -1e-6; }), "loads[5].deviation_m");
  EXPECT_EQ(field_of([&] { (void)identify_joint_stiffness(arm, tip, good, {.max_relative_deviation = 0.0}); }),
            "max_relative_deviation");
  EXPECT_EQ(field_of([&] { (void)identify_joint_stiffness(arm, tip, good, {.tolerance = 0.0}); }), "tolerance");
  EXPECT_EQ(field_of([&] { (void)identify_joint_stiffness(arm, tip, good, {.max_iterations = 0}); }), "max_iterations");
  // Two loads give six numbers for six joints: an answer, but no deviation.
  std::vector<Load> two = good;
  two.resize(2);
  const IdentifiedStiffness bare = identify_joint_stiffness(arm, tip, two);
  for (const IdentifiedJoint& joint : bare.joints) EXPECT_FALSE(joint.identifiable);
}

}  // namespace identify_test
}  // namespace robomill::robot
