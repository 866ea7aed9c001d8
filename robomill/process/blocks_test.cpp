#include "robomill/process/blocks.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <string>

#include "robomill/base/parallel.hpp"
#include "robomill/base/units.hpp"
#include "robomill/cutting/static_deflection.hpp"
#include "robomill/io/file.hpp"
#include "robomill/jobs/plan.hpp"
#include "robomill/jobs/summary.hpp"
#include "robomill/process/blocks/classes.hpp"
#include "robomill/process/blocks/dynamics.hpp"
#include "robomill/robot/pose.hpp"
#include "robomill/robot/stiffness.hpp"
#include "robomill/stability/lobes.hpp"
#include "robomill/stability/surface_error.hpp"
#include "testing/jobs/program_files.hpp"
#include "testing/support.hpp"

namespace robomill::process {
namespace blocks_test {

using jobs::PlanResult;
using jobs::run_job;
using jobs::write_plan;

const std::string source = ROBOMILL_SOURCE_DIR;

class Blocks : public ::testing::Test {
 protected:
  /// @param stiffness  factor on the joints'
  void write_cell(double stiffness = 1.0) {
    folder_.file("cell.toml", test_support::arm_cell(source, 2e6 * stiffness));
  }
  void write_forces(const test_support::CutFile& cut = {}) {
    folder_.file("forces.toml", test_support::forces_file(cut));
  }
  /// A slot along x, 1 mm deep, then back 1 mm beside it, in moves of 2 mm.
  void write_program() {
    std::string text = "G21 G90 G94\nS12000 M3\nG0 X-18 Y0 Z5\nG0 Z-1\n";
    for (int i = 1; i <= 18; ++i) text += fmt::format("G1 X{} F900\n", -18 + 2 * i);
    text += "G1 Y1\n";
    for (int i = 1; i <= 18; ++i) text += fmt::format("G1 X{}\n", 18 - 2 * i);
    folder_.file("part.ngc", text + "G0 Z5\nM2\n");
  }
  /// A slot along x whose depth changes slowly, in moves of 0.5 mm.
  void write_wave() {
    std::string text = "G21 G90 G94\nS12000 M3\nG0 X-18 Y0 Z5\nG0 Z-0.7\n";
    for (int i = 1; i <= 72; ++i) {
      text += fmt::format("G1 X{:.3f} Z{:.4f} F900\n", -18.0 + 0.5 * i, -0.7 - 0.15 * std::sin(0.05 * i));
    }
    folder_.file("part.ngc", text + "G0 Z5\nM2\n");
  }
  PlanResult run(const std::string& more) {
    return run_job(folder_.file("job.toml",
                                "[job]\nforces = \"forces.toml\"\ncell = \"cell.toml\"\nprogram = "
                                "\"part.ngc\"\n" +
                                    more + "[decide]\nfree = []\n"),
                   1);
  }
  PlanResult run_with_modes() { return run("modes = \"" + source + "/data/robot-modes.toml\"\n"); }
  /// Forces and cuts of the program.
  static ForcesResult forces_of(const PlanResult& plan) { return *plan.shown().forces; }
  static DynamicsAt dynamics(double mass = 1.0) {
    return constant_dynamics(
        modal::modes_from_mass({{410, 0.03, 6.0 * mass}}, {{530, 0.03, 5.0 * mass}}, {{780, 0.03, 8.0 * mass}}));
  }
  test::Folder folder_;
};

// A chip f (n·x_F) makes the mean force f N/(2π) ∫∫ f nᵀ dφ db x_F: the force kernel's own mean, without edge forces.
TEST_F(Blocks, MeanStiffnessTimesTheFeedIsTheMeanForce) {
  write_cell(1e3);
  write_forces();
  write_program();
  const ForcesResult forces = forces_of(run_with_modes());
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
  write_cell(1e4);
  write_forces();
  write_program();
  const ForcesResult forces = forces_of(run_with_modes());
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
  write_cell(1e4);
  write_forces();
  write_program();
  const ForcesResult forces = forces_of(run_with_modes());
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
  write_cell();
  write_forces();
  write_wave();
  const ForcesResult forces = forces_of(run_with_modes());
  const ProgramBlocks own =
      judge_blocks(forces, dynamics(0.1), {.joint_tolerance_rad = 0.0, .cut_tolerance = 0.0, .scan_points = 0});
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
  write_cell(0.5);
  write_forces({.axial_n_per_mm2 = 600.0});  // pushes the tool up
  write_program();
  const ForcesResult forces = forces_of(run_with_modes());
  ASSERT_TRUE(forces.program->deflected);
  const BlockResult& row = forces.program->blocks[9];
  EXPECT_EQ(row.settled, BlockResult::Settled::found);
  const robot::Stiffness stiffness =
      robot::stiffness(forces.cell->cell.arm, row.joints, robot::tip_point(forces.cell->cell), {});
  const double feed_m = 0.9 / 60.0 / (200.0 * 2.0);
  const cutting::StaticDeflection one = cutting::static_deflection(
      forces.cut.cutter, {.axial_depth_m = 1e-3, .direction = cutting::MillingDirection::slot}, forces.cut.coefficients,
      {.feed_per_tooth_m = feed_m, .spindle_speed_rad_per_s = 12000.0 * units::rpm},
      stiffness.compliance.topLeftCorner<3, 3>());
  ASSERT_EQ(one.status, cutting::StaticDeflection::Status::found);
  ASSERT_LT(one.cut.axial_depth_m, 0.97e-3);
  EXPECT_NEAR(row.force.axial_depth_m, one.cut.axial_depth_m, 0.02e-3);
}

TEST_F(Blocks, SaysWhereTheEngagementIsLost) {
  write_cell(2e-3);
  write_forces({.axial_n_per_mm2 = 2000.0});
  write_program();
  const PlanResult plan = run_with_modes();
  const auto said = std::ranges::count_if(plan.shown().forces->warnings, [](const std::string& text) {
    return (text.find("lose the engagement") != std::string::npos ||
            text.find("does not settle") != std::string::npos) &&
           text.find("the first in line") != std::string::npos;
  });
  EXPECT_GE(said, 1);
  ASSERT_TRUE(plan.shown().blocks);
  const std::string text = summary(plan);
  EXPECT_TRUE(text.find("lose the engagement") != std::string::npos ||
              text.find("does not settle") != std::string::npos)
      << text;
  const ProgramForces& program = *plan.shown().forces->program;
  const auto lost = std::ranges::count_if(
      program.blocks, [](const BlockResult& block) { return block.settled == BlockResult::Settled::lost; });
  const auto json = nlohmann::json::parse(blocks_json(*plan.shown().forces, *plan.shown().blocks));
  EXPECT_EQ(json["summary"]["engagement_lost"], lost);
  for (std::size_t i = 0; i < program.blocks.size(); ++i) {
    const std::string note = block_note(program.blocks[i], plan.shown().blocks->rows[i]);
    EXPECT_EQ(note == "engagement lost", program.blocks[i].settled == BlockResult::Settled::lost) << i;
  }
}

TEST_F(Blocks, APlanWithoutLobesWritesThem) {
  write_cell();
  write_forces();
  write_program();
  const PlanResult plan = run_with_modes();
  ASSERT_TRUE(plan.shown().blocks);
  EXPECT_FALSE(plan.has_lobes());
  const std::filesystem::path out = folder_.at("out");
  write_plan(out, plan);
  std::istringstream table(io::read_file(out / "blocks.csv"));
  std::string header;
  std::getline(table, header);
  EXPECT_TRUE(
      header.starts_with("block,line,x_mm,y_mm,z_mm,q1,q2,q3,q4,q5,q6,axial_depth_mm,radial_depth_mm,"
                         "spindle_speed_rpm,feed_mm_per_min,spectral_radius,limit_depth_mm,stability_margin,"
                         "chatter_frequency_hz,mode,regime,peak_f_n,torque_n_m,power_w,deflection_um,"
                         "surface_error_um,surface_left_um,gain_margin"));
  const auto json = nlohmann::json::parse(io::read_file(out / "blocks.json"));
  EXPECT_EQ(json["blocks"]["block"].size(), plan.shown().blocks->rows.size());
  EXPECT_EQ(json["limit_over"].size(), 4U);
  for (std::size_t i = 0; i < plan.shown().blocks->rows.size(); ++i) {
    const BlockRow& row = plan.shown().blocks->rows[i];
    EXPECT_EQ(json["blocks"]["stability_margin"][i].is_null(), !row.cuts);
    if (!row.cuts || !std::isfinite(row.stability.at.limit_depth_m)) continue;
    EXPECT_NEAR(row.stability_margin, 1.0 - row.axial_depth_m / row.stability.limit_5_percent_m, 1e-12);
    EXPECT_LE(row.stability.limit_5_percent_m, row.stability.limit_95_percent_m);
  }
  EXPECT_EQ(json["summary"]["cutting"], plan.shown().blocks->cutting);
}

// By forward kinematics the joints of a smoothed path hold the tip where each block ends, to the tolerance and a
// sample.
TEST_F(Blocks, PosturesAreThoseOfTheSmoothedPath) {
  write_cell();
  write_forces();
  write_program();
  std::string cell = io::read_file(folder_.at("cell.toml"));
  cell.insert(cell.find("[workpiece]"),
              "joint_max_velocity = [2.1, 2.0, 1.9, 3.1, 3.0, 3.8]\njoint_max_acceleration = [3, 3, 3, 8, 8, 10]\n"
              "joint_max_jerk = [60, 60, 60, 200, 200, 250]\n");
  cell +=
      "\n[smoothing]\ntip_tolerance_mm = 0.02\naxis_tolerance_deg = 0.1\nmax_velocity_mm_per_s = 50\n"
      "max_acceleration_mm_per_s2 = 500\nmax_jerk_mm_per_s3 = 10000\nmax_angular_velocity_deg_per_s = 60\n"
      "max_angular_acceleration_deg_per_s2 = 600\nmax_angular_jerk_deg_per_s3 = 12000\n";
  folder_.file("cell.toml", cell);
  const PlanResult plan = run_with_modes();
  ASSERT_TRUE(plan.shown().path && plan.shown().blocks);
  const ProgramForces& program = *plan.shown().forces->program;
  ASSERT_EQ(plan.shown().path->block_joints.size(), program.blocks.size());
  const robot::Cell& arm = plan.shown().forces->cell->cell;
  for (std::size_t i = 0; i < program.blocks.size(); ++i) {
    EXPECT_EQ(program.blocks[i].joints, plan.shown().path->block_joints[i]);
    const robot::ToolPose pose = robot::tool_pose(arm, robot::forward(arm.arm, program.blocks[i].joints));
    EXPECT_LT((pose.tip_m - program.program.blocks[i].end.tip_m).norm(), 0.1e-3) << i;
  }
}

TEST_F(Blocks, SaysWhereTheProgramLeavesTheMeasuredRegion) {
  write_cell();
  write_forces();
  write_program();
  const ForcesResult forces = forces_of(run_with_modes());
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
                                            {.joint_tolerance_rad = 1e-3, .scan_points = 0});
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
  write_cell();
  write_forces();
  write_program();
  ForcesResult forces = forces_of(run_with_modes());
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

TEST_F(Blocks, SayThatTheDynamicsOfTheForcesTakeNoPart) {
  write_cell();
  write_forces();
  write_program();
  const auto says = [](const PlanResult& plan) {
    return std::ranges::any_of(plan.notes, [](const std::string& text) { return text.starts_with("[dynamics]"); });
  };
  EXPECT_FALSE(says(run_with_modes()));
  const std::string forces = io::read_file(folder_.at("forces.toml"));
  const auto mode = [](const char* direction) {
    return fmt::format("[[dynamics.{}]]\nfrequency_hz = 300\ndamping_ratio = 0.02\nmodal_mass_kg = 2\n", direction);
  };
  folder_.file("forces.toml", forces + mode("x") + mode("y"));
  EXPECT_TRUE(says(run_with_modes()));
}

TEST_F(Blocks, SaysInWhichBlockTheDynamicsAreNotKnown) {
  write_cell();
  write_forces();
  write_program();
  const ForcesResult forces = forces_of(run_with_modes());
  const DynamicsAt known = dynamics();
  const double border = forces.program->blocks[10].joints(0);
  const auto fails = [&](const Eigen::VectorXd& joints) {
    if (!(joints(0) > border)) throw InvalidInput("joints", "is where no mode is known");
    return known(joints);
  };
  const std::string said = test::rejection(
      [&] { static_cast<void>(judge_blocks(forces, fails, {.joint_tolerance_rad = 1e-3, .scan_points = 0})); });
  EXPECT_TRUE(said.starts_with("block ")) << said;
  EXPECT_NE(said.find("): joints: is where no mode is known"), std::string::npos) << said;
}

TEST_F(Blocks, SaysWhatIsMissing) {
  write_cell();
  write_forces();
  write_program();
  const std::string still = test::rejection([&] { static_cast<void>(run("")); });
  EXPECT_NE(still.find("does not say what vibrates"), std::string::npos) << still;
  folder_.file("part.ngc", "G21 G90 G94\nG0 X-18 Y0 Z5\nG0 Z-1\nG1 X18 F900\nM2\n");
  const std::string slow = test::rejection([&] { static_cast<void>(run_with_modes()); });
  EXPECT_NE(slow.find("line 4 of the program cuts without one"), std::string::npos) << slow;
  const std::string lobes = test::rejection([&] { static_cast<void>(run("lobes = \"lobes.toml\"\n")); });
  EXPECT_NE(lobes.find("needs one of hits, frf, modes and assembly"), std::string::npos) << lobes;
}

// Hits along z are asked for where a cut pushes along it.
TEST_F(Blocks, AnUprightFlatEndHardlyPushesAlongItsAxis) {
  write_program();
  const std::string slot = io::read_file(folder_.at("part.ngc"));
  const std::string plunge = "G21 G90 G94\nS12000 M3\nG0 X0 Y0 Z5\nG1 Z-1 F100\nG0 Z5\nM2\n";
  const auto pushed = [&](const std::string& kind, const std::string& program) {
    return pushed_axes(test_support::forces_along(folder_,
                                                  {.cell = test_support::arm_cell(source, 2e6),
                                                   .forces = test_support::forces_file({.kind = kind}),
                                                   .program = program},
                                                  {}));
  };
  EXPECT_EQ(pushed("flat-end", slot), (std::array{true, true, false}));
  EXPECT_EQ(pushed("ball-end", slot), (std::array{true, true, true}));
  EXPECT_EQ(pushed("flat-end", plunge), (std::array{true, true, true}));
}

}  // namespace blocks_test
}  // namespace robomill::process
