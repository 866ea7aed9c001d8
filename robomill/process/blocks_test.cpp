#include "robomill/process/blocks.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>

#include "robomill/base/parallel.hpp"
#include "robomill/base/units.hpp"
#include "robomill/cutting/static_deflection.hpp"
#include "robomill/process/blocks/classes.hpp"
#include "robomill/process/blocks/dynamics.hpp"
#include "robomill/robot/pose.hpp"
#include "robomill/robot/stiffness.hpp"
#include "robomill/stability/lobes.hpp"
#include "robomill/stability/surface_error.hpp"
#include "testing/process/programs.hpp"
#include "testing/support.hpp"

namespace robomill::process {
namespace blocks_test {

class Blocks : public ::testing::Test {
 protected:
  /// A slot along x, 1 mm deep, then back 1 mm beside it, in moves of 2 mm.
  static std::string slot() {
    std::string text = "G21 G90 G94\nS12000 M3\nG0 X-18 Y0 Z5\nG0 Z-1\n";
    for (int i = 1; i <= 18; ++i) text += fmt::format("G1 X{} F900\n", -18 + 2 * i);
    text += "G1 Y1\n";
    for (int i = 1; i <= 18; ++i) text += fmt::format("G1 X{}\n", 18 - 2 * i);
    return text + "G0 Z5\nM2\n";
  }
  /// A slot along x whose depth changes slowly, in moves of 0.5 mm.
  static std::string wave() {
    std::string text = "G21 G90 G94\nS12000 M3\nG0 X-18 Y0 Z5\nG0 Z-0.7\n";
    for (int i = 1; i <= 72; ++i) {
      text += fmt::format("G1 X{:.3f} Z{:.4f} F900\n", -18.0 + 0.5 * i, -0.7 - 0.15 * std::sin(0.05 * i));
    }
    return text + "G0 Z5\nM2\n";
  }
  /// @param stiffness  factor on the joints'
  static ForcesResult forces_of(double stiffness = 1.0, const test_support::CutFile& cut = {},
                                const std::string& program = slot(),
                                const ProgramRun& run = {.keep_cuts = true, .deflect = true}) {
    const cell::Cell cell = testing::cell_of(test_support::arm_cell(ROBOMILL_SOURCE_DIR, 2e6 * stiffness));
    return testing::forces_along(testing::cut_of(cut), cell, program, run);
  }
  static DynamicsAt dynamics(double mass = 1.0) {
    return constant_dynamics(
        modal::modes_from_mass({{410, 0.03, 6.0 * mass}}, {{530, 0.03, 5.0 * mass}}, {{780, 0.03, 8.0 * mass}}));
  }
};

// A chip f (n·x_F) makes the mean force f N/(2π) ∫∫ f nᵀ dφ db x_F: the force kernel's own mean, without edge forces.
TEST_F(Blocks, MeanStiffnessTimesTheFeedIsTheMeanForce) {
  const ForcesResult forces = forces_of(1e3);
  std::size_t compared = 0;
  for (const cutting::PoseEngagement& cut : forces.program->cuts) {
    if (cut.engagement.empty()) continue;
    ++compared;
    const double speed = 12000.0 * units::rpm;
    const double teeth = forces.cut.cutter.mill.teeth;
    const double feed_m = cut.feed_speed_m_per_s * 2.0 * std::numbers::pi / (speed * teeth);
    const cutting::CuttingForce force =
        cutting::cutting_force(forces.cut.cutter, cut.engagement, forces.cut.coefficients,
                               {.feed_per_tooth_m = feed_m, .spindle_speed_rad_per_s = speed});
    const Eigen::Vector3d expected = cut.work_from_feed * force.mean_n;
    const Eigen::Vector3d found = mean_stiffness(cut, forces.cut.coefficients) * cut.work_from_feed.col(0) *
                                  (feed_m * teeth / (2.0 * std::numbers::pi));
    EXPECT_LT((found - expected).norm(), 1e-9 * expected.norm());
  }
  EXPECT_GT(compared, 30U);
}

// Two ways: the dexels' engagement in the posture, and the analytic slot with the modes in the feed's frame.
TEST_F(Blocks, ASlotIsThatOfTheAnalyticCut) {
  const ForcesResult forces = forces_of(1e4);
  const ProgramBlocks blocks = judge_blocks(forces, dynamics(), {.scan_points = 3});
  stability::LobesProblem problem;
  problem.spatial.emplace();
  problem.spatial->cutter = forces.cut.cutter;
  problem.spatial->cut = {.axial_depth_m = 1e-3, .direction = cutting::MillingDirection::slot};
  problem.spatial->coefficients = forces.cut.coefficients;
  // The feed runs along x of W, which is x of B: F is B.
  problem.dynamics = dynamics()(Eigen::VectorXd::Zero(6)).modes;
  stability::LobesOptions options;
  options.axial_depth_m = {0.0, 8e-3};
  const double speed = 12000.0 * units::rpm;
  options.spindle_speed_rad_per_s = {speed, 2.0 * speed};
  const stability::PointResult point = stability::evaluate_point(problem, options, {speed, 1e-3});
  const BlockRow& row = blocks.rows[9];  // amid the slot
  ASSERT_TRUE(row.cuts);
  EXPECT_NEAR(row.axial_depth_m, 1e-3, 0.03e-3);
  EXPECT_NEAR(row.stability.at.spectral_radius, point.spectral_radius, 0.02 * point.spectral_radius);
  // Constant dynamics: where the robot stands does not matter.
  ASSERT_EQ(blocks.scans.size(), 4U);
  for (const LimitScan& scan : blocks.scans) {
    for (const double limit_m : scan.limit_m) {
      if (!std::isfinite(limit_m)) continue;
      EXPECT_NEAR(limit_m, scan.limit_m[1], 1e-9) << scan.parameter;
    }
  }
}

// The same two ways to the surface that the slot's edges leave.
TEST_F(Blocks, TheSurfaceErrorOfASlotIsThatOfTheAnalyticCut) {
  const ForcesResult forces = forces_of(1e4);
  const ProgramBlocks blocks = judge_blocks(forces, dynamics(), {.scan_points = 0});
  const double speed = 12000.0 * units::rpm;
  const cutting::PoseEngagement& cut = forces.program->cuts[9];  // amid the slot
  stability::LobesProblem problem;
  problem.spatial.emplace();
  problem.spatial->cutter = forces.cut.cutter;
  problem.spatial->cut = {.axial_depth_m = 1e-3, .direction = cutting::MillingDirection::slot};
  problem.spatial->coefficients = forces.cut.coefficients;
  problem.spatial->feed_per_tooth_m = cut.feed_speed_m_per_s * 2.0 * std::numbers::pi / (2.0 * speed);
  problem.dynamics = dynamics()(Eigen::VectorXd::Zero(6)).modes;  // F is B
  const stability::SurfacePoint surface = stability::surface_point(problem, {speed, 1e-3});
  ASSERT_TRUE(surface.stable);
  // Of two teeth one stands at either flank at once: the errors are alike, their signs are not.
  EXPECT_NEAR(std::abs(blocks.rows[9].steady.surface_error_m), std::abs(surface.surface_location_error_m),
              0.05 * surface.peak_deflection_m);
  int known = 0;
  for (const BlockRow& row : blocks.rows) {
    if (!row.cuts) continue;
    EXPECT_FALSE(row.unstable() && std::isfinite(row.steady.surface_error_m));
    if (std::isfinite(row.steady.surface_error_m)) ++known;
  }
  EXPECT_GE(known, 30);
  const ProgramBlocks heavy_cut = judge_blocks(forces, dynamics(1e-3), {.scan_points = 0});
  ASSERT_TRUE(heavy_cut.rows[9].unstable());
  EXPECT_TRUE(std::isnan(heavy_cut.rows[9].steady.surface_error_m));
}

// What is shared differs little from what each block would have got, and threads do not matter.
TEST_F(Blocks, SharedEvaluationsAreCloseToOwnOnes) {
  const ForcesResult forces = forces_of(1.0, {}, wave());
  const ProgramBlocks own =
      judge_blocks(forces, dynamics(0.1), {.alike = {.joint_rad = 0.0, .cut_share = 0.0}, .scan_points = 0});
  const ProgramBlocks shared = judge_blocks(forces, dynamics(0.1), {.scan_points = 0});
  EXPECT_EQ(own.evaluations, own.cutting);
  EXPECT_LT(shared.evaluations, own.cutting);
  double largest = 0.0, largest_of_limit = 0.0;
  for (std::size_t i = 0; i < own.rows.size(); ++i) {
    if (!own.rows[i].cuts) continue;
    const double radius = own.rows[i].stability.at.spectral_radius;
    largest = std::max(largest, std::abs(shared.rows[i].stability.at.spectral_radius - radius) / std::max(1.0, radius));
    const double limit_m = own.rows[i].stability.at.limit_depth_m;
    if (!std::isfinite(limit_m)) continue;
    largest_of_limit = std::max(largest_of_limit, std::abs(shared.rows[i].stability.at.limit_depth_m / limit_m - 1.0));
  }
  EXPECT_GT(largest_of_limit, 1e-6);
  EXPECT_LT(largest_of_limit, 0.05);
  EXPECT_LT(largest, 0.02);
  RecordProperty("largest_difference", fmt::format("{:.3g}, limit {:.3g}", largest, largest_of_limit));
  const int threads = thread_count();
  set_thread_count(1);
  ProgramBlocks alone = judge_blocks(forces, dynamics(0.1), {.scan_points = 0});
  set_thread_count(threads);
  alone.seconds = shared.seconds;
  EXPECT_EQ(blocks_json(forces, alone), blocks_json(forces, shared));
}

// The fixed point along a program against that of one cut: a straight slot under its own force.
TEST_F(Blocks, TheEngagementFeelsTheDeflection) {
  const ForcesResult forces = forces_of(0.5, {.axial_n_per_mm2 = 600.0});  // pushes the tool up
  ASSERT_TRUE(forces.program->deflected);
  const BlockResult& row = forces.program->blocks[9];
  EXPECT_EQ(row.settled, BlockResult::Settled::found);
  const robot::Stiffness stiffness =
      robot::stiffness(forces.cell->robot.arm, row.joints, robot::tip_point(forces.cell->robot), {});
  const double feed_m = 0.9 / 60.0 / (200.0 * 2.0);
  const cutting::StaticDeflection one = cutting::static_deflection(
      forces.cut.cutter, {.axial_depth_m = 1e-3, .direction = cutting::MillingDirection::slot}, forces.cut.coefficients,
      {.feed_per_tooth_m = feed_m, .spindle_speed_rad_per_s = 12000.0 * units::rpm},
      stiffness.compliance.topLeftCorner<3, 3>());
  ASSERT_EQ(one.status, cutting::StaticDeflection::Status::found);
  ASSERT_LT(one.cut.axial_depth_m, 0.97e-3);
  EXPECT_NEAR(row.force.axial_depth_m, one.cut.axial_depth_m, 0.02e-3);
}

TEST_F(Blocks, SaysWhereTheProgramLeavesTheMeasuredRegion) {
  const ForcesResult forces = forces_of();
  const DynamicsAt known = dynamics(0.1);
  const double border = forces.program->blocks[10].joints(0);
  const ProgramBlocks blocks = judge_blocks(forces,
                                            [&](const Eigen::VectorXd& joints) {
                                              PostureDynamics out = known(joints);
                                              out.measured_nearby = joints(0) > border;
                                              out.joint_distance_rad = 0.2;
                                              for (modal::Mode& mode : out.modes.modes)
                                                mode.frequency_std_hz = 0.01 * mode.frequency_hz;
                                              return out;
                                            },
                                            {.alike = {.joint_rad = 1e-3}, .scan_points = 0});
  const auto said = std::ranges::count_if(block_warnings(forces, blocks), [](const std::string& text) {
    return text.find("(line ") != std::string::npos && text.find("11.5° of a joint") != std::string::npos &&
           text.find("median within the measured region") != std::string::npos;
  });
  EXPECT_GE(said, 1);
  EXPECT_LE(said, 3);
  EXPECT_EQ(static_cast<std::size_t>(said), blocks.beyond.size());
  for (const BeyondMeasured& stretch : blocks.beyond) {
    EXPECT_NEAR(stretch.farthest_rad, 0.2, 1e-12);
    for (std::size_t i = stretch.first; i <= stretch.last; ++i) {
      EXPECT_FALSE(blocks.rows[i].cuts && blocks.rows[i].measured_nearby.value()) << i;
    }
  }
}

// Chatter before none, then the gain that is left: what the tables list first.
TEST(WorstBlock, IsTheOneNearestToChatter) {
  const auto row = [](double radius, double gain, double margin) {
    BlockRow out{.cuts = true, .stability_margin = margin};
    out.stability.at.spectral_radius = radius;
    out.stability.at.gain_margin = gain;
    return out;
  };
  const double none = std::numeric_limits<double>::infinity();
  const BlockRow rows[] = {row(1.2, 0.5, -1.0),  row(1.01, 0.9, -9.0), row(0.99, 0.8, 0.3), row(0.99, 1.1, 0.1),
                           row(0.998, 1.8, -14), row(0.99, none, 0.2), row(0.99, none, 0.9)};
  for (std::size_t i = 0; i < std::size(rows); ++i) {
    for (std::size_t j = 0; j < std::size(rows); ++j) EXPECT_EQ(worse(rows[i], rows[j]), i < j) << i << ' ' << j;
  }
}

TEST_F(Blocks, SayThatTheWorkpieceTakesNoPart) {
  ForcesResult forces = forces_of();
  const auto says = [&](const BlocksOptions& options) {
    const ProgramBlocks blocks = judge_blocks(forces, dynamics(), options);
    const nlohmann::json json = nlohmann::json::parse(blocks_json(forces, blocks));
    return json["summary"]["notes"].dump().find("The workpiece is taken as rigid") != std::string::npos;
  };
  EXPECT_FALSE(says({.scan_points = 0}));
  EXPECT_TRUE(says({.scan_points = 0, .workpiece_vibrates = true}));
  forces.cut.workpiece_dynamics = modal::modes_from_mass({{300, 0.02, 2.0}}, {});
  EXPECT_TRUE(says({.scan_points = 0}));
}

TEST_F(Blocks, SaysInWhichBlockTheDynamicsAreNotKnown) {
  const ForcesResult forces = forces_of();
  const DynamicsAt known = dynamics();
  const double border = forces.program->blocks[10].joints(0);
  const auto fails = [&](const Eigen::VectorXd& joints) {
    if (!(joints(0) > border)) throw InvalidInput("joints", "is where no mode is known");
    return known(joints);
  };
  const std::string said = test::rejection(
      [&] { static_cast<void>(judge_blocks(forces, fails, {.alike = {.joint_rad = 1e-3}, .scan_points = 0})); });
  EXPECT_TRUE(said.starts_with("block ")) << said;
  EXPECT_NE(said.find("): joints: is where no mode is known"), std::string::npos) << said;
}

// Hits along z are asked for where a cut pushes along it.
TEST_F(Blocks, AnUprightFlatEndHardlyPushesAlongItsAxis) {
  const std::string plunge = "G21 G90 G94\nS12000 M3\nG0 X0 Y0 Z5\nG1 Z-1 F100\nG0 Z5\nM2\n";
  const auto pushed = [&](const std::string& kind, const std::string& program) {
    return pushed_axes(forces_of(1.0, {.kind = kind}, program, {}));
  };
  EXPECT_EQ(pushed("flat-end", slot()), (std::array{true, true, false}));
  EXPECT_EQ(pushed("ball-end", slot()), (std::array{true, true, true}));
  EXPECT_EQ(pushed("flat-end", plunge), (std::array{true, true, true}));
}

}  // namespace blocks_test
}  // namespace robomill::process
