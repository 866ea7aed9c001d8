#include "robomill/process/decide.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/modal/tip.hpp"
#include "robomill/process/blocks/stability.hpp"
#include "robomill/simulation/posture.hpp"
#include "testing/process/programs.hpp"
#include "testing/support.hpp"

namespace robomill::process {
namespace decide_test {

constexpr double teeth = 2.0;

using Decide = testing::ThreePasses;

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
  for (std::size_t i = 0; i < result.forces->program->program.blocks.size(); ++i) {
    EXPECT_EQ(result.forces->program->program.blocks[i].end.tip_m, judged.forces.program->program.blocks[i].end.tip_m);
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
        const stability::BlockStability found =
            judged_cut({.setup = judged.forces.cut,
                        .cut = cut,
                        .base_from_work = judged.forces.cell->robot.workpiece.linear(),
                        .spindle_speed_rad_per_s = factor * speed * units::rpm},
                       all)
                .stability;
        const double limit = found.limited() ? found.limit.axial_depth_m : found.searched_depth_m[1];
        if (found.at.spectral_radius >= 1.0 || 1.0 - engaged_depth_m(cut) / limit < 0.2) time = 1e300;
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

// Independent of every stability chart: the cut in time, tooth by tooth.
TEST_F(Decide, BlocksAreStableInTime) {
  const DynamicsAt dynamics = constant_dynamics(modes());
  const Judged judged = judge(dynamics);
  const DecideResult result = decide(problem(judged, dynamics));
  ASSERT_EQ(result.status, DecideResult::Status::found) << result.reason;
  const Eigen::Matrix3d base_from_work = judged.forces.cell->robot.workpiece.linear();
  int looked = 0;
  for (std::size_t i = 0; i < result.blocks->rows.size() && looked < test::seeds(50); ++i) {
    const BlockRow& row = result.blocks->rows[i];
    if (!row.cuts) continue;
    ++looked;
    const cutting::PoseEngagement& engaged = result.forces->program->cuts[i];
    simulation::PostureCut cut;
    cut.cutter = judged.forces.cut.cutter;
    cut.engagement = engaged.engagement;
    cut.coefficients = judged.forces.cut.coefficients;
    cut.motion = {.feed_per_tooth_m = result.forces->program->blocks[i].force.feed_per_tooth_m,
                  .spindle_speed_rad_per_s = row.spindle_speed_rad_per_s};
    cut.structure =
        modal::tip_modes(modal::turned(modes(), (base_from_work * engaged.work_from_feed).transpose()), {}, 0.0);
    const simulation::Simulation run =
        simulation::simulate(cut, {.seconds = 0.5, .sample_rate_hz = 2048.0, .tolerance = 1e-2});
    EXPECT_EQ(run.verdict, simulation::Verdict::stable) << "block " << i + 1;
    EXPECT_NEAR(run.small.spectral_radius, row.stability.at.spectral_radius, 0.01) << "block " << i + 1;
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
  const double power = 0.8 * free.decided->sustained_power_w;
  check(
      [&](DecideProblem& p) {
        p.machine.spindle = {{.spindle_speed_rad_per_s = 6000.0 * units::rpm, .torque_n_m = 100.0, .power_w = power},
                             {.spindle_speed_rad_per_s = 18000.0 * units::rpm, .torque_n_m = 100.0, .power_w = power}};
      },
      &Outcome::sustained_power_w, power);
}

// The run that is written keeps what the search kept by the engagement of the program as it was.
TEST_F(Decide, ChipsAndCuttingSpeedsHoldInTheRunThatIsWritten) {
  const DynamicsAt dynamics = constant_dynamics(modes(20.0));
  const Judged judged = judge(dynamics);
  DecideProblem asked = problem(judged, dynamics);
  asked.options.chip_thickness_m = {0.02e-3, 0.03e-3};
  asked.options.cutting_speed_m_per_s = {1.0, 2.0};
  const DecideResult result = decide(asked);
  ASSERT_EQ(result.status, DecideResult::Status::found) << result.reason;
  int looked = 0;
  for (std::size_t i = 0; i < result.blocks->rows.size(); ++i) {
    if (!result.blocks->rows[i].cuts) continue;
    ++looked;
    const cutting::Engagement& engagement = result.forces->program->cuts[i].engagement;
    const double chip_m =
        result.forces->program->blocks[i].force.feed_per_tooth_m * cutting::greatest_chip_share(engagement);
    EXPECT_GE(chip_m, 0.994 * 0.02e-3) << i;
    EXPECT_LE(chip_m, 1.006 * 0.03e-3) << i;
    double radius_m = 0.0;
    for (std::size_t s = 0; s < engagement.slices.size(); ++s) {
      if (!engagement.of(s).empty()) radius_m = std::max(radius_m, engagement.slices[s].radius_m);
    }
    const double speed = radius_m * result.blocks->rows[i].spindle_speed_rad_per_s;
    EXPECT_GE(speed, 0.994) << i;
    EXPECT_LE(speed, 2.006 * 1.0) << i;
  }
  EXPECT_GT(looked, 10);
  asked.options.cutting_speed_m_per_s = {20.0, 30.0};
  const DecideResult none = decide(asked);
  EXPECT_EQ(none.status, DecideResult::Status::infeasible);
  EXPECT_NE(none.reason.find("cutting speed"), std::string::npos) << none.reason;
  EXPECT_NE(none.reason.find("at least"), std::string::npos) << none.reason;
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
  EXPECT_FALSE(result.forces.has_value());
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

// At 12,000 rpm two teeth pass 400 times a second, where a mode is: stable by far, and the tip vibrates by more than
// the feed. Off it the program holds.
TEST_F(Decide, ForcedVibrationIsALimit) {
  const std::vector<modal::MassMode> plane = {{400.0, 0.005, 3.0}};
  const DynamicsAt dynamics = constant_dynamics(modal::modes_from_mass(plane, plane, {{780.0, 0.03, 8.0}}));
  const Judged judged = judge(dynamics);
  int beyond = 0;
  for (const BlockRow& row : judged.blocks.rows) {
    if (!row.cuts || row.unstable() || !(row.steady.vibration_share > 1.0)) continue;
    ++beyond;
    EXPECT_EQ(row.steady.vibration.harmonic, 1);
    EXPECT_NEAR(row.steady.vibration.frequency_hz, 400.0, 1e-9);
    EXPECT_NEAR(row.steady.vibration.mode_frequency_hz, 400.0, 1e-6);
  }
  ASSERT_GT(beyond, 0);
  const std::vector<std::string> warnings = block_warnings(judged.forces, judged.blocks);
  const auto says = [](const std::string& text) {
    return text.find("is 1 × tooth passing (400.0 Hz), in which") != std::string::npos;
  };
  EXPECT_TRUE(std::ranges::any_of(warnings, says)) << fmt::format("{}", fmt::join(warnings, "\n"));
  EXPECT_NE(blocks_csv(judged.forces, judged.blocks).find(",vibration_um,"), std::string::npos);

  DecideProblem asked = problem(judged, dynamics);
  const DecideResult found = decide(asked);
  ASSERT_EQ(found.status, DecideResult::Status::found) << found.reason;
  const auto vibrates = [](const Violation& v) { return v.limit == decision::ProgramLimit::forced_vibration; };
  EXPECT_TRUE(std::ranges::any_of(found.as_programmed.violations, vibrates));
  EXPECT_TRUE(found.decided->violations.empty());
  EXPECT_GT(found.as_programmed.peak_vibration_m, found.decided->peak_vibration_m);
  for (const BlockRow& row : found.blocks->rows) {
    if (!row.cuts) continue;
    EXPECT_LE(row.steady.vibration_share, 1.005);
  }
  asked.machine.min_spindle_speed_rad_per_s = 11'900.0 * units::rpm;
  asked.machine.max_spindle_speed_rad_per_s = 12'100.0 * units::rpm;
  const DecideResult none = decide(asked);
  EXPECT_EQ(none.status, DecideResult::Status::infeasible);
  EXPECT_NE(none.reason.find("forced vibration"), std::string::npos) << none.reason;
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
  for (std::size_t i = 0; i < moved.forces->program->program.blocks.size(); ++i) {
    farthest = std::max(farthest, (moved.forces->program->program.blocks[i].end.tip_m -
                                   judged.forces.program->program.blocks[i].end.tip_m)
                                      .norm());
  }
  EXPECT_GT(farthest, 0.0);
  EXPECT_LE(farthest, asked.options.offsets.max_offset_m);
  asked.options.offsets.controller_compensates = true;
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
  for (std::size_t i = 1; i < result.forces->program->program.blocks.size(); ++i) {
    const program::Block& block = result.forces->program->program.blocks[i];
    if (block.spindle_speed_rad_per_s == result.forces->program->program.blocks[i - 1].spindle_speed_rad_per_s)
      continue;
    EXPECT_EQ(block.kind, program::Block::Kind::rapid);
  }
  asked.options.speed_changes = SpeedChanges::none;
  const DecideResult one = decide(asked);
  ASSERT_EQ(one.status, DecideResult::Status::found) << one.reason;
  EXPECT_EQ(one.decided->lowest_spindle_speed_rad_per_s, one.decided->highest_spindle_speed_rad_per_s);
  EXPECT_GE(one.decided->cutting_time_s, 0.99 * result.decided->cutting_time_s);
}

}  // namespace decide_test
}  // namespace robomill::process
