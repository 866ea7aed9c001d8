#include "robomill/cutting/static_deflection.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "robomill/base/error.hpp"
#include "robomill/base/random.hpp"
#include "robomill/cutting/engagement.hpp"

namespace robomill::cutting {
namespace static_deflection_test {

Cutter ball() {
  Cutter cutter;
  cutter.kind = CutterKind::ball_end;
  cutter.mill = {.teeth = 2, .diameter_m = 6e-3, .helix_rad = std::numbers::pi / 6.0};
  return cutter;
}

MillingCoefficients aluminium() {
  return {.tangential_n_per_m2 = {900e6},
          .radial_n_per_m2 = {350e6},
          .axial_n_per_m2 = {150e6},
          .tangential_edge_n_per_m = {12e3},
          .radial_edge_n_per_m = {15e3},
          .axial_edge_n_per_m = {2e3}};
}

constexpr CutMotion motion = {.feed_per_tooth_m = 0.05e-3, .spindle_speed_rad_per_s = 1000.0};

TEST(StaticDeflection, LeavesARigidCutAlone) {
  const Cut cut = {.axial_depth_m = 1e-3, .radial_depth_m = 0.5e-3};
  const StaticDeflection deflected = static_deflection(ball(), cut, aluminium(), motion, Eigen::Matrix3d::Zero());
  EXPECT_EQ(deflected.status, StaticDeflection::Status::found);
  EXPECT_EQ(deflected.cut.axial_depth_m, cut.axial_depth_m);
  EXPECT_EQ(deflected.deflection_m.norm(), 0.0);
}

// The residual: the depth left is the commanded one less what its own force deflects; the deflection is C F of a force
// computed anew.
TEST(StaticDeflection, DepthAndForceAgree) {
  Random random(11);
  for (int i = 0; i < 20; ++i) {
    const Cut cut = {.axial_depth_m = random.uniform(0.2e-3, 1.2e-3),
                     .radial_depth_m = random.uniform(0.2e-3, 1e-3),
                     .direction = i % 2 == 0 ? MillingDirection::up : MillingDirection::down,
                     .lead_rad = random.uniform(0.0, 0.4)};
    Eigen::Matrix3d compliance = Eigen::Matrix3d::Zero();
    for (int axis = 0; axis < 3; ++axis) compliance(axis, axis) = random.uniform(0.2e-6, 4e-6);
    compliance(0, 2) = compliance(2, 0) = 0.3e-6;
    const StaticDeflection deflected = static_deflection(ball(), cut, aluminium(), motion, compliance);
    ASSERT_EQ(deflected.status, StaticDeflection::Status::found) << i;
    const CuttingForce force = cutting_force(ball(), engage(ball(), deflected.cut), aluminium(), motion);
    const Eigen::Vector3d deflection = compliance * force.mean_n;
    EXPECT_NEAR(deflected.cut.axial_depth_m, cut.axial_depth_m - deflection.z(), 2e-9 * cut.axial_depth_m) << i;
    EXPECT_LE((deflected.deflection_m - deflection).norm(), 1e-12) << i;
    EXPECT_LT(deflected.cut.axial_depth_m, cut.axial_depth_m) << "a ball end is pushed out of the cut";
  }
}

TEST(StaticDeflection, ReportsAStructureThatIsTooSoft) {
  const Cut cut = {.axial_depth_m = 0.2e-3, .radial_depth_m = 0.5e-3};
  Eigen::Matrix3d compliance = Eigen::Matrix3d::Identity() * 1e-3;
  EXPECT_EQ(static_deflection(ball(), cut, aluminium(), motion, compliance).status,
            StaticDeflection::Status::lifts_off);
  // An axial force that pulls, on a spring softer than what it gains by going deeper.
  MillingCoefficients pulling = aluminium();
  pulling.axial_n_per_m2 = {-3000e6};
  pulling.axial_edge_n_per_m = {-60e3};
  Cutter flat = ball();
  flat.kind = CutterKind::flat_end;
  const Cut slot = {.axial_depth_m = 1e-3, .direction = MillingDirection::slot};
  EXPECT_EQ(static_deflection(flat, slot, pulling, motion, compliance).status, StaticDeflection::Status::diverged);
}

// Pulled in near the end of the edges: a state, and no error about a depth that nobody asked for.
TEST(StaticDeflection, DoesNotLookBeyondTheEdges) {
  MillingCoefficients pulling = aluminium();
  pulling.axial_n_per_m2 = {-200e6};
  Cutter flat = ball();
  flat.kind = CutterKind::flat_end;
  flat.cutting_height_m = 5e-3;
  const Cut slot = {.axial_depth_m = 4.9e-3, .direction = MillingDirection::slot};
  const StaticDeflection soft = static_deflection(flat, slot, pulling, motion, Eigen::Matrix3d::Identity() * 1e-4);
  EXPECT_EQ(soft.status, StaticDeflection::Status::diverged);
  EXPECT_EQ(soft.cut.axial_depth_m, slot.axial_depth_m);
  const StaticDeflection stiff = static_deflection(flat, {.axial_depth_m = 2e-3, .direction = MillingDirection::slot},
                                                   pulling, motion, Eigen::Matrix3d::Identity() * 1e-6);
  EXPECT_EQ(stiff.status, StaticDeflection::Status::found);
  EXPECT_GT(stiff.cut.axial_depth_m, 2e-3);
}

TEST(StaticDeflection, RejectsWhatACutMustNotBe) {
  EXPECT_THROW(static_cast<void>(
                   static_deflection(ball(), {.radial_depth_m = 1e-3}, aluminium(), motion, Eigen::Matrix3d::Zero())),
               InvalidInput);
}

}  // namespace static_deflection_test
}  // namespace robomill::cutting
