// Plans of programs: what a job's files make of blocks, decision and path.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "robomill/base/units.hpp"
#include "robomill/io/file.hpp"
#include "robomill/jobs/outputs.hpp"
#include "robomill/jobs/plan.hpp"
#include "robomill/modal/files/modes_files.hpp"
#include "robomill/robot/pose.hpp"
#include "testing/process/programs.hpp"
#include "testing/support.hpp"

namespace robomill::jobs {
namespace plan_program_test {

const std::string source = ROBOMILL_SOURCE_DIR;

class PlannedBlocks : public ::testing::Test {
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
  PlanResult run(const std::string& more) {
    return run_job(folder_.file("job.toml",
                                "[job]\nforces = \"forces.toml\"\ncell = \"cell.toml\"\nprogram = "
                                "\"part.ngc\"\n" +
                                    more + "[decide]\nfree = []\n"),
                   1);
  }
  PlanResult run_with_modes() { return run("modes = \"" + source + "/data/robot-modes.toml\"\n"); }
  test::Folder folder_;
};

TEST_F(PlannedBlocks, SaysWhereTheEngagementIsLost) {
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
  const process::ProgramForces& program = *plan.shown().forces->program;
  const auto lost = std::ranges::count_if(program.blocks, [](const process::BlockResult& block) {
    return block.settled == process::BlockResult::Settled::lost;
  });
  const auto json = nlohmann::json::parse(process::blocks_json(*plan.shown().forces, *plan.shown().blocks));
  EXPECT_EQ(json["summary"]["engagement_lost"], lost);
  for (std::size_t i = 0; i < program.blocks.size(); ++i) {
    const std::string note = process::block_note(program.blocks[i], plan.shown().blocks->rows[i]);
    EXPECT_EQ(note == "engagement lost", program.blocks[i].settled == process::BlockResult::Settled::lost) << i;
  }
}

TEST_F(PlannedBlocks, APlanWithoutLobesWritesThem) {
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
    const process::BlockRow& row = plan.shown().blocks->rows[i];
    EXPECT_EQ(json["blocks"]["stability_margin"][i].is_null(), !row.cuts);
    if (!row.cuts || !std::isfinite(row.stability.at.limit_depth_m)) continue;
    EXPECT_NEAR(row.stability_margin, 1.0 - row.axial_depth_m / row.stability.limit_5_percent_m, 1e-12);
    EXPECT_LE(row.stability.limit_5_percent_m, row.stability.limit_95_percent_m);
  }
  EXPECT_EQ(json["summary"]["cutting"], plan.shown().blocks->cutting);
}

// By forward kinematics the joints of a smoothed path hold the tip where each block ends, to the tolerance and a
// sample.
TEST_F(PlannedBlocks, PosturesAreThoseOfTheSmoothedPath) {
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
  const process::ProgramForces& program = *plan.shown().forces->program;
  ASSERT_EQ(plan.shown().path->block_joints.size(), program.blocks.size());
  const robot::Cell& arm = plan.shown().forces->cell->robot;
  for (std::size_t i = 0; i < program.blocks.size(); ++i) {
    EXPECT_EQ(program.blocks[i].joints, plan.shown().path->block_joints[i]);
    const robot::ToolPose pose = robot::tool_pose(arm, robot::forward(arm.arm, program.blocks[i].joints));
    EXPECT_LT((pose.tip_m - program.program.blocks[i].end.tip_m).norm(), 0.1e-3) << i;
  }
}

TEST_F(PlannedBlocks, SayThatTheDynamicsOfTheForcesTakeNoPart) {
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

TEST_F(PlannedBlocks, SaysWhatIsMissing) {
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

class PlannedPasses : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_.file("cell.toml", test_support::arm_cell(source, 2e8));
    folder_.file("forces.toml", test_support::forces_file({.dexel_mm = 0.25}));
    folder_.file("part.ngc", process::testing::three_passes());
  }
  PlanResult judged() {
    return run_job(
        folder_.file("judge.toml",
                     "[job]\nforces = \"forces.toml\"\ncell = \"cell.toml\"\nprogram = \"part.ngc\"\nmodes = \"" +
                         source + "/data/robot-modes.toml\"\n[decide]\nfree = []\n"),
        1);
  }
  /// Masses of the links and torques of the drives.
  void add_links() {
    std::string cell = io::read_file(folder_.at("cell.toml"));
    std::string links = "joint_max_torque_n_m = [9000, 20000, 9000, 2000, 2000, 1000]\nlinks = [\n";
    for (const double mass_kg : {300.0, 250.0, 150.0, 60.0, 30.0, 20.0}) {
      links +=
          fmt::format("  {{ mass_kg = {}, center_mm = [0, 20, 0], inertia_kg_m2 = [1, 1, 1, 0, 0, 0] }},\n", mass_kg);
    }
    cell.insert(cell.find("joint_stiffness"), links + "]\n");
    folder_.file("cell.toml", cell);
  }
  test::Folder folder_;
};

TEST_F(PlannedPasses, TheProgramThatIsWrittenIsTheOneThatWasJudged) {
  folder_.file("modes.json", modal::modes_json(process::testing::three_passes_modes()));
  const std::string modes_toml = "modes = \"modes.json\"\n";
  const std::filesystem::path job =
      folder_.file("job.toml", "[job]\nforces = \"forces.toml\"\ncell = \"cell.toml\"\nprogram = \"part.ngc\"\n" +
                                   modes_toml + "[spindle]\nmin_speed_rpm = 6000\nmax_speed_rpm = 18000\n");
  const PlanResult plan = run_job(job, 1);
  ASSERT_TRUE(plan.decision.has_value());
  ASSERT_EQ(plan.decision->status, process::Decision::Status::found) << plan.decision->reason;
  write_plan(folder_.at("out"), plan);
  const std::string text = io::read_file(folder_.at("out") / "program.ngc");
  EXPECT_NE(text.find("(three passes)"), std::string::npos);
  EXPECT_NE(text.find("(pass 3)"), std::string::npos);
  EXPECT_NE(text.find("Nothing was checked for collisions"), std::string::npos);
  const PlanResult again = run_job(folder_.file("again.toml",
                                                "[job]\nforces = \"forces.toml\"\ncell = \"cell.toml\"\nprogram = "
                                                "\"out/program.ngc\"\n" +
                                                    modes_toml + "[decide]\nfree = []\n"),
                                   1);
  ASSERT_EQ(again.shown().blocks->rows.size(), plan.shown().blocks->rows.size());
  for (std::size_t i = 0; i < again.shown().blocks->rows.size(); ++i) {
    const process::BlockRow& a = again.shown().blocks->rows[i];
    const process::BlockRow& b = plan.shown().blocks->rows[i];
    EXPECT_EQ(a.cuts, b.cuts);
    if (!a.cuts) continue;
    EXPECT_NEAR(a.stability.at.spectral_radius, b.stability.at.spectral_radius, 1e-4);
    EXPECT_NEAR(a.spindle_speed_rad_per_s, b.spindle_speed_rad_per_s, 1e-4 * b.spindle_speed_rad_per_s);
    EXPECT_LE(again.shown().forces->program->blocks[i].force.peak_force_n,
              1.001 * plan.shown().forces->program->blocks[i].force.peak_force_n);
  }
}

// A program that calls is decided as the same one without calls, each pass for itself.
TEST_F(PlannedPasses, PassesOfASubprogramAreDecidedEachForItself) {
  folder_.file("modes.json", modal::modes_json(process::testing::three_passes_modes()));
  std::string calls = "o<pass> sub\n";
  for (int i = 1; i <= 6; ++i) calls += fmt::format("G1 X{} F600 (a pass)\n", -12 + 4 * i);
  calls += "G0 Z5\no<pass> endsub\nG21 G90 G94\nS12000 M3\n";
  for (int pass = 0; pass < 3; ++pass) {
    calls += fmt::format("G0 X-12 Y{} Z5\nG0 Z-{}\no<pass> call\n", pass, 0.6 + 0.2 * pass);
  }
  folder_.file("calls.ngc", calls + "M2\n");
  const auto decided = [&](const std::string& program) {
    const PlanResult plan = run_job(
        folder_.file("job.toml", "[job]\nforces = \"forces.toml\"\ncell = \"cell.toml\"\nprogram = \"" + program +
                                     "\"\nmodes = \"modes.json\"\n[spindle]\nmin_speed_rpm = 6000\nmax_speed_rpm = "
                                     "18000\n"),
        1);
    return plan.decided.value().text.value();
  };
  const program::Rewritten text = decided("calls.ngc");
  EXPECT_EQ(text.expanded_calls, 3U);
  EXPECT_NE(text.text.find("(3 calls of subprograms are expanded in place)"), std::string::npos) << text.text;
  const program::Program got = program::read_program_text(text.text, "calls.ngc");
  const program::Program plain = program::read_program_text(decided("part.ngc").text, "part.ngc");
  ASSERT_EQ(got.blocks.size(), plain.blocks.size());
  for (std::size_t i = 0; i < plain.blocks.size(); ++i) {
    const program::Block& a = got.blocks[i];
    const program::Block& b = plain.blocks[i];
    EXPECT_LT((a.end.tip_m - b.end.tip_m).norm(), 1e-9) << i;
    EXPECT_NEAR(a.spindle_speed_rad_per_s, b.spindle_speed_rad_per_s, 1e-5 * b.spindle_speed_rad_per_s) << i;
    EXPECT_NEAR(a.duration_s, b.duration_s, 1e-5 * b.duration_s) << i;
  }
}

// The head of the program says what was looked at, and no more.
TEST_F(PlannedPasses, TheHeadOfTheProgramSaysWhatWasChecked) {
  folder_.file("modes.json", modal::modes_json(process::testing::three_passes_modes()));
  const auto head = [&](const std::string& more) {
    std::string cell = io::read_file(folder_.at("cell.toml"));
    cell.insert(cell.find("[workpiece]"),
                "joint_max_velocity = [2.1, 2.0, 1.9, 3.1, 3.0, 3.8]\njoint_max_acceleration = [3, 3, 3, 8, 8, 10]\n"
                "joint_max_jerk = [60, 60, 60, 200, 200, 250]\n");
    folder_.file("checked.toml", cell + more +
                                     "\n[geometry]\nstickout_mm = 30\nclearance_mm = 1\n"
                                     "holder = [{ length_mm = 20, diameter_mm = 30 }]\n"
                                     "fixtures = [{ box_from_mm = [500, 500, 0], box_to_mm = [520, 520, 20] }]\n");
    const PlanResult plan =
        run_job(folder_.file("job.toml",
                             "[job]\nforces = \"forces.toml\"\ncell = \"checked.toml\"\nprogram = \"part.ngc\"\n"
                             "modes = \"modes.json\"\n[spindle]\nmin_speed_rpm = 6000\nmax_speed_rpm = 18000\n"),
                1);
    if (!plan.decided || !plan.decided->text) return std::string("no program");
    return plan.decided->text->text.substr(0, 2000);
  };
  const std::string ends = head("");
  EXPECT_NE(ends.find("from block end to block end with every joint running evenly, no trajectory"), std::string::npos)
      << ends;
  const std::string way = head(
      "\n[smoothing]\ntip_tolerance_mm = 0.02\naxis_tolerance_deg = 0.1\nmax_velocity_mm_per_s = 50\n"
      "max_acceleration_mm_per_s2 = 500\nmax_jerk_mm_per_s3 = 10000\nmax_angular_velocity_deg_per_s = 60\n"
      "max_angular_acceleration_deg_per_s2 = 600\nmax_angular_jerk_deg_per_s3 = 12000\n");
  EXPECT_NE(way.find("The whole trajectory was checked against the cell's geometry: clear"), std::string::npos) << way;
  EXPECT_EQ(way.find("block end"), std::string::npos) << way;
}

// What hangs on the flange is part of what the drives hold: a plan that does not know it says so.
TEST_F(PlannedPasses, LoadsWithoutTheSpindleAreAssumed) {
  const auto assumes_mass = [this] {
    const std::vector<Assumption> assumed = judged().assumed;
    const auto found = std::ranges::find(assumed, "tool.mass_kg", &Assumption::key);
    return found != assumed.end() && found->taken == "none" && found->file == "cell.toml";
  };
  EXPECT_FALSE(assumes_mass()) << "no drive has a limit";
  add_links();
  EXPECT_TRUE(assumes_mass());
  std::string cell = io::read_file(folder_.at("cell.toml"));
  cell.insert(cell.find("length_mm = "), "mass_kg = 40\n");
  folder_.file("cell.toml", cell);
  EXPECT_FALSE(assumes_mass());
}

TEST_F(PlannedPasses, RejectsBadTables) {
  const auto rejects = [&](const std::string& table, const std::string& what) {
    const std::filesystem::path job = folder_.file(
        "bad.toml",
        "[job]\nforces = \"forces.toml\"\ncell = \"cell.toml\"\nprogram = \"part.ngc\"\n[decide]\n" + table);
    const std::string text = test::rejection([&] { static_cast<void>(run_job(job, 1)); });
    EXPECT_NE(text.find(what), std::string::npos) << text;
    EXPECT_NE(text.find("bad.toml"), std::string::npos) << text;
  };
  rejects("free = [\"depth\"]\n", "decide.free");
  rejects("free = [\"axial_depth\"]\n", "CAM");
  rejects("free = [\"feed\", \"lead\"]\n", "spindle_speed");
  rejects("free = [\"spindle_speed\", \"lead\"]\ncone_deg = 50\n", "cone_deg");
  rejects("cone_step_deg = 0.5\n", "cone_step_deg");
  rejects("gamma_step_deg = 0.01\n", "gamma_step_deg");
  rejects("goal = \"money\"\n", "goal");
  rejects("max_force_n = -1\n", "max_force_n");
  rejects("chip_thickness_mm = [0.1]\n", "[least, most]");
  rejects("chip_thickness_mm = [0.1, 0.05]\n", "chip_thickness_mm");
  rejects("spindle_ramp_rpm_per_s = 0\n", "spindle_ramp_rpm_per_s");
  rejects("gamma_range_deg = [10, 20]\n", "gamma_range_deg");
  rejects("speed_change = \"air\"\n", "speed_changes");
}

TEST_F(PlannedPasses, AreTurnedOnlyWhereTheyWereJudged) {
  PlanResult plan = judged();
  EXPECT_EQ(judged_program(plan).blocks.cutting, plan.programmed.blocks->cutting);
  plan.judging.reset();
  EXPECT_EQ(test::field_of([&] { static_cast<void>(judged_program(plan)); }), "plan");
}

}  // namespace plan_program_test
}  // namespace robomill::jobs
