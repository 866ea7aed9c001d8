#include "robomill/jobs/decide.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/io/file.hpp"
#include "robomill/jobs/blocks/stability.hpp"
#include "robomill/jobs/plan.hpp"
#include "robomill/modal/files/modes_files.hpp"
#include "robomill/modal/tip.hpp"
#include "robomill/robot/pose.hpp"
#include "robomill/simulation/posture.hpp"
#include "testing/support.hpp"

namespace robomill::jobs {
namespace decide_test {

const std::string source = ROBOMILL_SOURCE_DIR;
constexpr double teeth = 2.0;

/// Three passes of a 6 mm ball end beside each other, the first a slot, with rapid moves between.
class Decide : public testing::Test {
 protected:
  void SetUp() override {
    std::string cell = io::read_file(source + "/examples/force-along-program/cell.toml");
    const std::size_t begin = cell.find("joint_stiffness_n_m_per_rad");
    cell.replace(begin, cell.find('\n', begin) - begin, "joint_stiffness_n_m_per_rad = [2e8, 2e8, 2e8, 2e8, 2e8, 2e8]");
    folder_.file("cell.toml", cell);
    folder_.file("forces.toml", R"([tool]
kind = "ball-end"
diameter_mm = 6
teeth = 2
helix_deg = 30
[coefficients]
tangential_n_per_mm2 = 900
radial_n_per_mm2 = 350
axial_n_per_mm2 = 150
[stock]
kind = "box"
min_mm = [-20, -8, -8]
max_mm = [20, 8, 0]
dexel_mm = 0.25
)");
    folder_.file("part.ngc", program());
  }
  static std::string program(const std::string& speed = "S12000") {
    std::string text = "(three passes)\nG21 G90 G94\n" + speed + " M3\n";
    for (int pass = 0; pass < 3; ++pass) {
      text += fmt::format("G0 X-12 Y{0} Z5\nG0 Z-{1}\n", pass, 0.6 + 0.2 * pass);
      for (int i = 1; i <= 6; ++i) text += fmt::format("G1 X{} F{} (pass {})\n", -12 + 4 * i, 600, pass + 1);
      text += "G0 Z5\n";
    }
    return text + "M2\n";
  }
  PlanResult judged() {
    return run_job(folder_.file("judge.toml",
                                "[job]\nforces = \"forces.toml\"\ncell = \"cell.toml\"\nprogram = \"part.ngc\"\n"
                                "modes = \"" +
                                    source + "/data/robot-modes.toml\"\n[decide]\nfree = []\n"),
                   1);
  }
  /// Modes that chatter in the deeper passes at 12,000 rpm.
  static modal::ModalModel modes(double mass = 1.0) {
    return modal::modes_from_mass({{410, 0.03, 0.6 * mass}}, {{530, 0.03, 0.5 * mass}}, {{780, 0.03, 0.8 * mass}});
  }
  struct Judged {
    ForcesResult forces;
    ProgramBlocks blocks;
  };
  Judged judge(const DynamicsAt& dynamics) {
    ForcesResult forces = *judged().forces;
    ProgramBlocks blocks = judge_blocks(forces, dynamics, {.scan_points = 0});
    return {.forces = std::move(forces), .blocks = std::move(blocks)};
  }
  static DecideProblem problem(const Judged& judged, const DynamicsAt& dynamics) {
    DecideProblem out = {.forces = judged.forces, .blocks = judged.blocks, .dynamics = dynamics};
    out.blocks_options.scan_points = 0;
    out.machine.min_spindle_speed_rad_per_s = 6000.0 * units::rpm;
    out.machine.max_spindle_speed_rad_per_s = 18000.0 * units::rpm;
    return out;
  }
  test::Folder folder_;
};

TEST_F(Decide, KeepsEveryLimitThatTheProgramBrokeAndIsFaster) {
  const DynamicsAt dynamics = constant_dynamics(modes());
  const Judged judged = judge(dynamics);
  const DecideResult result = decide(problem(judged, dynamics));
  ASSERT_EQ(result.status, DecideResult::Status::found) << result.reason;
  EXPECT_EQ(result.decided->unstable_blocks, 0U);
  EXPECT_TRUE(result.decided->violations.empty());
  EXPECT_GE(result.decided->least_stability_margin, 0.2 * 0.995);
  EXPECT_LT(result.decided->cutting_time_s, result.as_programmed.cutting_time_s);
  EXPECT_GT(result.evaluations, 0);
  EXPECT_GE(result.exact_runs, 1);
  // The path is the program's.
  for (std::size_t i = 0; i < result.program->blocks.size(); ++i) {
    EXPECT_EQ(result.program->blocks[i].end.tip_m, judged.forces.program->program.blocks[i].end.tip_m);
  }
}

// The grid that the search prunes, looked at one by one: the same blocks, each with its own look.
TEST_F(Decide, IsWithinTwoPercentOfLookingAtEverySpeed) {
  const DynamicsAt dynamics = constant_dynamics(modes());
  const Judged judged = judge(dynamics);
  DecideProblem asked = problem(judged, dynamics);
  asked.options.speed_changes = SpeedChanges::none;
  asked.machine.min_spindle_speed_rad_per_s = 9000.0 * units::rpm;
  asked.machine.max_spindle_speed_rad_per_s = 15000.0 * units::rpm;
  const DecideResult result = decide(asked);
  ASSERT_EQ(result.status, DecideResult::Status::found) << result.reason;
  double greatest_chip = 0.0;
  for (std::size_t i = 0; i < judged.blocks.rows.size(); ++i) {
    if (!judged.blocks.rows[i].cuts) continue;
    greatest_chip =
        std::max(greatest_chip, judged.forces.program->blocks[i].force.feed_per_tooth_m *
                                    cutting::greatest_chip_share(judged.forces.program->cuts[i].engagement));
  }
  const modal::ModalModel all = modes();
  double best = 1e300;
  for (double speed = 9000.0; speed <= 15000.0; speed *= 1.01) {
    double time = 0.0;
    for (std::size_t i = 0; i < judged.blocks.rows.size() && time < best; ++i) {
      if (!judged.blocks.rows[i].cuts) continue;
      const cutting::PoseEngagement& cut = judged.forces.program->cuts[i];
      for (const double factor : {0.98, 0.99, 1.0, 1.01, 1.02}) {
        const CutStability found = cut_stability({.file = judged.forces.file,
                                                  .cut = cut,
                                                  .base_from_work = judged.forces.cell->cell.workpiece.linear(),
                                                  .spindle_speed_rad_per_s = factor * speed * units::rpm},
                                                 all);
        const double limit = std::isfinite(found.limit_depth_m) ? found.limit_depth_m : found.searched_depth_m;
        if (found.spectral_radius >= 1.0 || 1.0 - engaged_depth_m(cut) / limit < 0.2) time = 1e300;
      }
      const double feed = greatest_chip / cutting::greatest_chip_share(cut.engagement) * teeth * speed / 60.0;
      time += (judged.forces.program->program.blocks[i].end.tip_m - judged.forces.program->program.begin_of(i).tip_m)
                  .norm() /
              feed;
    }
    best = std::min(best, time);
  }
  ASSERT_LT(best, 1e300);
  EXPECT_LE(result.decided->cutting_time_s, 1.02 * best);
}

TEST_F(Decide, TheProgramThatIsWrittenIsTheOneThatWasJudged) {
  folder_.file("modes.json", modal::modes_json(modes()));
  const std::string modes_toml = "modes = \"modes.json\"\n";
  const std::filesystem::path job =
      folder_.file("job.toml", "[job]\nforces = \"forces.toml\"\ncell = \"cell.toml\"\nprogram = \"part.ngc\"\n" +
                                   modes_toml + "[spindle]\nmin_speed_rpm = 6000\nmax_speed_rpm = 18000\n");
  const PlanResult plan = run_job(job, 1);
  ASSERT_TRUE(plan.decision.has_value());
  ASSERT_EQ(plan.decision->status, DecideResult::Status::found) << plan.decision->reason;
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
  ASSERT_EQ(again.blocks->rows.size(), plan.blocks->rows.size());
  for (std::size_t i = 0; i < again.blocks->rows.size(); ++i) {
    const BlockRow& a = again.blocks->rows[i];
    const BlockRow& b = plan.blocks->rows[i];
    EXPECT_EQ(a.cuts, b.cuts);
    if (!a.cuts) continue;
    EXPECT_NEAR(a.cut.spectral_radius, b.cut.spectral_radius, 1e-4);
    EXPECT_NEAR(a.spindle_speed_rad_per_s, b.spindle_speed_rad_per_s, 1e-4 * b.spindle_speed_rad_per_s);
    EXPECT_LE(again.forces->program->blocks[i].force.peak_force_n,
              1.001 * plan.forces->program->blocks[i].force.peak_force_n);
  }
}

// Independent of every stability chart: the cut in time, tooth by tooth.
TEST_F(Decide, BlocksAreStableInTime) {
  const DynamicsAt dynamics = constant_dynamics(modes());
  const Judged judged = judge(dynamics);
  const DecideResult result = decide(problem(judged, dynamics));
  ASSERT_EQ(result.status, DecideResult::Status::found) << result.reason;
  const Eigen::Matrix3d base_from_work = judged.forces.cell->cell.workpiece.linear();
  int looked = 0;
  for (std::size_t i = 0; i < result.blocks->rows.size() && looked < test::seeds(50); ++i) {
    const BlockRow& row = result.blocks->rows[i];
    if (!row.cuts) continue;
    ++looked;
    const cutting::PoseEngagement& engaged = result.forces->program->cuts[i];
    simulation::PostureCut cut;
    cut.cutter = judged.forces.file.cutter;
    cut.engagement = engaged.engagement;
    cut.coefficients = judged.forces.file.coefficients;
    cut.motion = {.feed_per_tooth_m = result.forces->program->blocks[i].force.feed_per_tooth_m,
                  .spindle_speed_rad_per_s = row.spindle_speed_rad_per_s};
    cut.structure =
        modal::tip_modes(modal::turned(modes(), (base_from_work * engaged.work_from_feed).transpose()), {}, 0.0);
    const simulation::Simulation run =
        simulation::simulate(cut, {.seconds = 0.5, .sample_rate_hz = 2048.0, .tolerance = 1e-2});
    EXPECT_EQ(run.verdict, simulation::Verdict::stable) << "block " << i + 1;
    EXPECT_NEAR(run.small.spectral_radius, row.cut.spectral_radius, 0.01) << "block " << i + 1;
  }
  EXPECT_GE(looked, 5);
}

TEST_F(Decide, ForceDeflectionTorqueAndPowerAreKept) {
  const DynamicsAt dynamics = constant_dynamics(modes(20.0));
  const Judged judged = judge(dynamics);
  const DecideResult free = decide(problem(judged, dynamics));
  ASSERT_EQ(free.status, DecideResult::Status::found) << free.reason;
  const auto check = [&](auto change, double Outcome::*value, double allowed) {
    DecideProblem asked = problem(judged, dynamics);
    change(asked);
    const DecideResult result = decide(asked);
    ASSERT_EQ(result.status, DecideResult::Status::found) << result.reason;
    EXPECT_LE((*result.decided).*value, 1.005 * allowed);
    EXPECT_GE((*result.decided).*value, 0.85 * allowed);  // it is used
    EXPECT_GE(result.decided->cutting_time_s, free.decided->cutting_time_s);
  };
  const double force = 0.8 * free.decided->peak_force_n;
  check([&](DecideProblem& p) { p.options.max_force_n = force; }, &Outcome::peak_force_n, force);
  const double deflection = 0.8 * free.decided->peak_deflection_m;
  check([&](DecideProblem& p) { p.options.max_deflection_m = deflection; }, &Outcome::peak_deflection_m, deflection);
  const double power = 0.8 * free.decided->peak_power_w;
  check(
      [&](DecideProblem& p) {
        p.machine.spindle = {{.spindle_speed_rad_per_s = 6000.0 * units::rpm, .torque_n_m = 100.0, .power_w = power},
                             {.spindle_speed_rad_per_s = 18000.0 * units::rpm, .torque_n_m = 100.0, .power_w = power}};
      },
      &Outcome::peak_power_w, power);
}

TEST_F(Decide, AGapInTheSpindlesCurveIsLeftOut) {
  const DynamicsAt dynamics = constant_dynamics(modes(20.0));
  const Judged judged = judge(dynamics);
  DecideProblem asked = problem(judged, dynamics);
  const auto point = [](double rpm, double torque) {
    return decision::SpindleCapacity{
        .spindle_speed_rad_per_s = rpm * units::rpm, .torque_n_m = torque, .power_w = 1e4 * torque};
  };
  asked.machine.spindle = {point(6000, 10), point(13000, 10), point(13100, 0), point(17900, 0)};
  const DecideResult result = decide(asked);
  ASSERT_EQ(result.status, DecideResult::Status::found) << result.reason;
  EXPECT_LE(result.decided->highest_spindle_speed_rad_per_s, 13100.0 * units::rpm);
}

TEST_F(Decide, SaysWhichLimitNoSpeedKeepsAndWhere) {
  const DynamicsAt soft = constant_dynamics(modes(0.02));
  const Judged judged = judge(soft);
  const DecideResult result = decide(problem(judged, soft));
  EXPECT_EQ(result.status, DecideResult::Status::infeasible);
  EXPECT_FALSE(result.program.has_value());
  EXPECT_NE(result.reason.find("6000 to 18000 rpm"), std::string::npos) << result.reason;
  EXPECT_NE(result.reason.find("stability margin"), std::string::npos) << result.reason;
  EXPECT_NE(result.reason.find("(line "), std::string::npos) << result.reason;
  const DynamicsAt stiff = constant_dynamics(modes(20.0));
  const Judged fine = judge(stiff);
  DecideProblem contradictory = problem(fine, stiff);
  contradictory.options.max_force_n = 0.5;
  const DecideResult none = decide(contradictory);
  EXPECT_EQ(none.status, DecideResult::Status::infeasible);
  EXPECT_NE(none.reason.find("peak force"), std::string::npos) << none.reason;
}

// A structure that is stiffer where the last joint stands elsewhere: as programmed it chatters at its speed.
TEST_F(Decide, TurnsGammaWhereThatAloneHelps) {
  const double programmed = judged().forces->program->blocks[10].joints(5);
  const DynamicsAt turning = [programmed](const Eigen::VectorXd& joints) {
    const double away = std::sin(joints(5) - programmed);
    return PostureDynamics{.modes = modes(0.05 + 20.0 * away * away)};
  };
  const Judged judged = judge(turning);
  EXPECT_GT(judged.blocks.unstable, 0U);
  DecideProblem asked = problem(judged, turning);
  asked.options.free = {Free::feed};
  EXPECT_EQ(decide(asked).status, DecideResult::Status::infeasible);
  asked.options.free = {Free::feed, Free::gamma};
  asked.options.gamma_step_rad = 15.0 * units::deg;
  const DecideResult turned = decide(asked);
  ASSERT_EQ(turned.status, DecideResult::Status::found) << turned.reason;
  EXPECT_TRUE(std::ranges::any_of(turned.gamma_offset_rad, [](double g) { return g != 0.0; }));
  EXPECT_GE(turned.decided->least_stability_margin, 0.2 * 0.995);
  ASSERT_TRUE(turned.gamma_map.has_value());
  EXPECT_EQ(turned.gamma_map->margin.cols(), std::ssize(turned.gamma_map->block));
  EXPECT_EQ(turned.gamma_map->margin.rows(), std::ssize(turned.gamma_map->gamma_rad));
  // By forward kinematics: the tip is where the program has it, turned by what was decided.
  const robot::Cell& cell = judged.forces.cell->cell;
  for (std::size_t i = 0; i < turned.program->blocks.size(); ++i) {
    const robot::ToolPose pose =
        robot::tool_pose(cell, robot::forward(cell.arm, turned.forces->program->blocks[i].joints));
    EXPECT_LT((pose.tip_m - turned.program->blocks[i].end.tip_m).norm(), 1e-9) << i;
  }
}

// What stands about the tool counts as soon as a posture differs from the program's.
TEST_F(Decide, TurnedPosturesAreCheckedForCollisions) {
  const DynamicsAt dynamics = constant_dynamics(modes(20.0));
  const std::string cell = io::read_file(folder_.at("cell.toml"));
  const auto with_box = [&](const std::string& box) {
    folder_.file("cell.toml", cell +
                                  "\n[geometry]\nstickout_mm = 30\nclearance_mm = 1\nholder = [{ length_mm = 20, "
                                  "diameter_mm = 30 }]\nfixtures = [{ " +
                                  box + " }]\n");
    const Judged judged = judge(dynamics);
    DecideProblem asked = problem(judged, dynamics);
    asked.options.free = {Free::feed, Free::gamma};
    asked.options.gamma_step_rad = 45.0 * units::deg;
    return decide(asked);
  };
  const DecideResult clear = with_box("box_from_mm = [500, 500, 0], box_to_mm = [520, 520, 20]");
  ASSERT_EQ(clear.status, DecideResult::Status::found) << clear.reason;
  EXPECT_TRUE(clear.collisions_checked);
  const DecideResult blocked = with_box("box_from_mm = [-30, -30, 35], box_to_mm = [30, 30, 45]");
  EXPECT_EQ(blocked.status, DecideResult::Status::infeasible);
  EXPECT_NE(blocked.reason.find("holder"), std::string::npos) << blocked.reason;
}

TEST_F(Decide, FinishingPassesAreMovedWhereThatIsAskedFor) {
  const DynamicsAt dynamics = constant_dynamics(modes(5.0));
  const Judged judged = judge(dynamics);
  DecideProblem asked = problem(judged, dynamics);
  const DecideResult plain = decide(asked);
  asked.options.compensate = true;
  const DecideResult moved = decide(asked);
  ASSERT_EQ(moved.status, DecideResult::Status::found) << moved.reason;
  ASSERT_TRUE(moved.compensation.has_value());
  EXPECT_LT(moved.compensation->rms_after_m, 0.5 * moved.compensation->rms_before_m);
  EXPECT_TRUE(moved.decided->violations.empty());
  double farthest = 0.0;
  for (std::size_t i = 0; i < moved.program->blocks.size(); ++i) {
    farthest = std::max(
        farthest, (moved.program->blocks[i].end.tip_m - judged.forces.program->program.blocks[i].end.tip_m).norm());
  }
  EXPECT_GT(farthest, 0.0);
  EXPECT_LE(farthest, asked.options.max_offset_m);
  asked.options.controller_compensates = true;
  const DecideResult left = decide(asked);
  EXPECT_FALSE(left.compensation.has_value());
  EXPECT_NEAR(left.decided->cutting_time_s, plain.decided->cutting_time_s, 1e-9);
}

TEST_F(Decide, SpeedsChangeInRapidMovesAlone) {
  const DynamicsAt dynamics = constant_dynamics(modes());
  const Judged judged = judge(dynamics);
  DecideProblem asked = problem(judged, dynamics);
  asked.options.spindle_ramp_rad_per_s2 = 1e6;
  const DecideResult result = decide(asked);
  ASSERT_EQ(result.status, DecideResult::Status::found) << result.reason;
  for (std::size_t i = 1; i < result.program->blocks.size(); ++i) {
    const program::Block& block = result.program->blocks[i];
    if (block.spindle_speed_rad_per_s == result.program->blocks[i - 1].spindle_speed_rad_per_s) continue;
    EXPECT_EQ(block.kind, program::Block::Kind::rapid);
  }
  asked.options.speed_changes = SpeedChanges::none;
  const DecideResult one = decide(asked);
  ASSERT_EQ(one.status, DecideResult::Status::found) << one.reason;
  EXPECT_EQ(one.decided->lowest_spindle_speed_rad_per_s, one.decided->highest_spindle_speed_rad_per_s);
  EXPECT_GE(one.decided->cutting_time_s, 0.99 * result.decided->cutting_time_s);
}

TEST_F(Decide, RejectsBadTables) {
  const auto rejects = [&](const std::string& table, const std::string& what) {
    const std::filesystem::path job = folder_.file(
        "bad.toml",
        "[job]\nforces = \"forces.toml\"\ncell = \"cell.toml\"\nprogram = \"part.ngc\"\n[decide]\n" + table);
    const std::string text = test::rejection([&] { static_cast<void>(run_job(job, 1)); });
    EXPECT_NE(text.find(what), std::string::npos) << text;
    EXPECT_NE(text.find("bad.toml"), std::string::npos) << text;
  };
  rejects("free = [\"depth\"]\n", "decide.free");
  rejects("free = [\"lead\"]\n", "gouges");
  rejects("free = [\"axial_depth\"]\n", "CAM");
  rejects("goal = \"money\"\n", "goal");
  rejects("max_force_n = -1\n", "max_force_n");
  rejects("chip_thickness_mm = [0.1]\n", "[least, most]");
  rejects("chip_thickness_mm = [0.1, 0.05]\n", "chip_thickness_mm");
  rejects("spindle_ramp_rpm_per_s = 0\n", "spindle_ramp_rpm_per_s");
  rejects("gamma_range_deg = [10, 20]\n", "gamma_range_deg");
  rejects("speed_change = \"air\"\n", "speed_changes");
}

}  // namespace decide_test
}  // namespace robomill::jobs
