#include "robomill/cutting/program_forces.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/parallel.hpp"
#include "robomill/cutting/engagement.hpp"
#include "testing/support.hpp"

namespace robomill::cutting {
namespace program_forces_test {

using program::Block;
using program::Program;

constexpr double speed = 1000.0;  // rad/s
constexpr double feed_m_per_s = 0.03;

Cutter ball() {
  Cutter cutter;
  cutter.kind = CutterKind::ball_end;
  cutter.mill = {.teeth = 2, .diameter_m = 6e-3, .helix_rad = std::numbers::pi / 6.0};
  return cutter;
}

MillingCoefficients tangential_only() {
  return {.tangential_n_per_m2 = {900e6}};
}

Block move(const program::Pose& from, const Eigen::Vector3d& tip, std::size_t line) {
  Block block;
  block.line = line;
  block.end = {.tip_m = tip, .axis = from.axis};
  block.duration_s = (tip - from.tip_m).norm() / feed_m_per_s;
  return block;
}

/// Along y, then beside it at a step-over of 0.5 mm, 1 mm below the top of a slab.
Program two_passes(const Eigen::Vector3d& axis) {
  Program program;
  program.start = {.tip_m = {0.0, -8e-3, -1e-3}, .axis = axis.normalized()};
  const Eigen::Vector3d places[] = {{0.0, 8e-3, -1e-3},     {0.0, 8e-3, 8e-3},      {0.5e-3, -8e-3, 8e-3},
                                    {0.5e-3, -8e-3, -1e-3}, {0.5e-3, -1e-3, -1e-3}, {0.5e-3, 1e-3, -1e-3}};
  program::Pose at = program.start;
  std::size_t line = 1;
  for (const Eigen::Vector3d& tip : places) {
    program.blocks.push_back(move(at, tip, line++));
    at = program.blocks.back().end;
  }
  return program;
}

Stock slab() {
  Stock stock;
  stock.min_m = {-6e-3, -12e-3, -4e-3};
  stock.max_m = {6e-3, 12e-3, 0.0};
  return stock;
}

std::vector<BlockForce> run(const Program& program, double dexel_m, const MillingCoefficients& coefficients) {
  Workpiece workpiece(slab(), dexel_m);
  return program_forces(program, ball(), coefficients, workpiece, {.spindle_speed_rad_per_s = speed});
}

// Two ways: the workpiece of rays, and the analytic engagement in F turned into W. The feed runs along +y, so that
// x_F = y_W, y_F = -x_W, and the neighbouring pass at x_W = 0 lies at +y_F: down-milling.
TEST(ProgramForces, AgreeWithTheAnalyticCut) {
  MillingCoefficients coefficients = tangential_only();
  coefficients.radial_n_per_m2 = {350e6};
  coefficients.axial_n_per_m2 = {150e6};
  const Cut cut = {.axial_depth_m = 1e-3, .radial_depth_m = 0.5e-3, .direction = MillingDirection::down};
  const CuttingForce force =
      cutting_force(ball(), engage(ball(), cut), coefficients,
                    {.feed_per_tooth_m = feed_m_per_s * std::numbers::pi / speed, .spindle_speed_rad_per_s = speed});
  const Eigen::Vector3d expected(-force.mean_n.y(), force.mean_n.x(), force.mean_n.z());
  const std::vector<BlockForce> blocks = run(two_passes(Eigen::Vector3d::UnitZ()), 0.04e-3, coefficients);
  const BlockForce& block = blocks.back();
  EXPECT_NEAR(block.feed_per_tooth_m, feed_m_per_s * std::numbers::pi / speed, 1e-12);
  EXPECT_LE((block.mean_force_n - expected).norm(), 0.02 * expected.norm());
  EXPECT_NEAR(block.peak_force_n, force.peak_force_n, 0.03 * force.peak_force_n);
  EXPECT_NEAR(block.mean_torque_n_m, force.mean_torque_n_m, 0.02 * force.mean_torque_n_m);
  EXPECT_NEAR(block.power_w, block.mean_torque_n_m * speed, 1e-12 * block.power_w);
  EXPECT_NEAR(block.axial_depth_m, 1e-3, 0.06e-3);
}

// With Kt alone energy is Kt times volume, in any posture.
TEST(ProgramForces, EnergyIsThatOfTheVolume) {
  const Eigen::Vector3d axes[] = {{0.0, 0.0, 1.0}, {0.2, -0.1, 1.0}, {-0.3, 0.2, 1.0}};
  for (const Eigen::Vector3d& axis : axes) {
    const Program program = two_passes(axis);
    const std::vector<BlockForce> blocks = run(program, 0.1e-3, tangential_only());
    double energy = 0.0;
    double volume = 0.0;
    for (const BlockForce& block : {blocks[4], blocks[5]}) {  // the others begin inside the material, or in the air
      energy += block.power_w * block.cutting_time_s;
      volume += block.removed_volume_m3;
    }
    EXPECT_NEAR(energy, 900e6 * volume, 0.03 * energy) << axis.transpose();
  }
}

// A tip that stands aside of the program is one whose program stands there. What is observed is what the
// means are made of.
TEST(ProgramForces, AnOffsetTipIsThatOfAShiftedProgram) {
  const Eigen::Vector3d aside(0.07e-3, -0.03e-3, 0.11e-3);
  const Program program = two_passes({0.1, -0.2, 1.0});
  Program shifted = program;
  shifted.start.tip_m += aside;
  for (Block& block : shifted.blocks) block.end.tip_m += aside;
  ProgramForceOptions options = {.spindle_speed_rad_per_s = speed};
  Workpiece one(slab(), 0.2e-3);
  const std::vector<BlockForce> expected = program_forces(shifted, ball(), tangential_only(), one, options);
  options.walk.tip_offset_m.assign(program.blocks.size(), aside);
  std::vector<double> largest(program.blocks.size(), 0.0);
  options.observe = [&](const PartOfBlock& part) {
    largest[part.block] = std::max(largest[part.block], part.mean_force_n.norm());
    EXPECT_FALSE(part.cut.engagement.empty());
  };
  Workpiece other(slab(), 0.2e-3);
  const std::vector<BlockForce> found = program_forces(program, ball(), tangential_only(), other, options);
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_NEAR((found[i].mean_force_n - expected[i].mean_force_n).norm(), 0.0, 1e-6) << i;
    EXPECT_NEAR(found[i].removed_volume_m3, expected[i].removed_volume_m3, 1e-15 + 1e-3 * expected[i].removed_volume_m3)
        << i;
    EXPECT_NEAR(largest[i], found[i].heaviest_force_n.norm(), 1e-12) << i;
  }
  options.walk.tip_offset_m.pop_back();
  EXPECT_NE(test::rejection([&] {
              static_cast<void>(program_forces(program, ball(), tangential_only(), other, options));
            }).find("one offset a block"),
            std::string::npos);
}

/// A flat end mill along x through air, 40 mm of material and air again, in one block of 600 mm.
struct LongBlock {
  Cutter cutter;
  Program program;
  Stock stock;
  CuttingForce slot;  ///< of the steady cut
};

LongBlock slot_in_a_long_block() {
  LongBlock out;
  out.cutter.mill = {.teeth = 3, .diameter_m = 12e-3};
  out.program.start = {.tip_m = {-300e-3, 0.0, -3e-3}};
  out.program.blocks.push_back(move(out.program.start, {300e-3, 0.0, -3e-3}, 7));
  out.stock.min_m = {-20e-3, -30e-3, -10e-3};
  out.stock.max_m = {20e-3, 30e-3, 0.0};
  out.slot = cutting_force(
      out.cutter, engage(out.cutter, {.axial_depth_m = 3e-3, .direction = MillingDirection::slot}), tangential_only(),
      {.feed_per_tooth_m = feed_m_per_s * 2.0 * std::numbers::pi / speed / 3.0, .spindle_speed_rad_per_s = speed});
  return out;
}

// What the cut takes, not what is left of it over the way through air.
TEST(ProgramForces, AWayThroughAirMakesNoForceSmaller) {
  const LongBlock job = slot_in_a_long_block();
  Workpiece workpiece(job.stock, 0.5e-3);
  const BlockForce block = program_forces(job.program, job.cutter, tangential_only(), workpiece,
                                          {.spindle_speed_rad_per_s = speed, .force = {}})
                               .front();
  EXPECT_NEAR(block.peak_power_w, job.slot.power_w, 0.005 * job.slot.power_w);
  EXPECT_NEAR(block.sustained_power_w, job.slot.power_w, 0.005 * job.slot.power_w);
  EXPECT_NEAR(block.revolution_torque_n_m, job.slot.mean_torque_n_m, 0.005 * job.slot.mean_torque_n_m);
  EXPECT_NEAR(block.peak_torque_n_m, job.slot.peak_torque_n_m, 0.01 * job.slot.peak_torque_n_m);
  // The cutter comes in over its radius: there it cuts, but less.
  EXPECT_GT(block.power_w, 0.85 * job.slot.power_w);
  EXPECT_LT(block.power_w, job.slot.power_w);
  EXPECT_NEAR(block.power_w, block.mean_torque_n_m * speed, 1e-9 * block.power_w);
  EXPECT_NEAR(block.cutting_time_s, 46e-3 / feed_m_per_s, 3e-3 / feed_m_per_s);
  EXPECT_NEAR(block.heaviest_force_n.norm(), job.slot.mean_n.norm(), 0.01 * job.slot.mean_n.norm());
}

// Over a second, the 1.5 s of the cut are as heavy; over ten they are what remains of them.
TEST(ProgramForces, SustainedPowerIsOverTheTimeThatIsAskedFor) {
  const LongBlock job = slot_in_a_long_block();
  const auto sustained = [&](double time_s) {
    Workpiece workpiece(job.stock, 0.5e-3);
    const BlockForce block = program_forces(job.program, job.cutter, tangential_only(), workpiece,
                                            {.spindle_speed_rad_per_s = speed, .power_time_s = time_s})
                                 .front();
    return std::pair(block.sustained_power_w, block.power_w * block.cutting_time_s);
  };
  EXPECT_NEAR(sustained(1.0).first, job.slot.power_w, 0.005 * job.slot.power_w);
  const auto [power_w, energy_j] = sustained(10.0);
  EXPECT_NEAR(power_w, energy_j / 10.0, 1e-9 * power_w);
}

// The heaviest force is that of the direction that weighs.
TEST(ProgramForces, WeightsForcesAsItIsAsked) {
  MillingCoefficients coefficients = tangential_only();
  coefficients.axial_n_per_m2 = {150e6};
  Workpiece workpiece(slab(), 0.1e-3);
  ProgramForceOptions options = {.spindle_speed_rad_per_s = speed};
  std::vector<double> heaviest(6, 0.0);
  options.weight = [&](std::size_t block, const Eigen::Vector3d& force_n) {
    heaviest[block] = std::max(heaviest[block], std::abs(force_n.z()));
    return std::abs(force_n.z());
  };
  const Program program = two_passes(Eigen::Vector3d::UnitZ());
  const std::vector<BlockForce> blocks = program_forces(program, ball(), coefficients, workpiece, options);
  for (const BlockForce& block : blocks) {
    EXPECT_EQ(std::abs(block.heaviest_force_n.z()), heaviest[block.block]);
    EXPECT_GE(heaviest[block.block], std::abs(block.mean_force_n.z()) * (1.0 - 1e-12));
  }
}

TEST(ProgramForces, DoNotDependOnTheThreads) {
  const Program program = two_passes({0.1, 0.1, 1.0});
  set_thread_count(1);
  const std::vector<BlockForce> one = run(program, 0.1e-3, tangential_only());
  set_thread_count(4);
  const std::vector<BlockForce> four = run(program, 0.1e-3, tangential_only());
  set_thread_count(0);
  ASSERT_EQ(one.size(), four.size());
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].mean_force_n, four[i].mean_force_n);
    EXPECT_EQ(one[i].peak_force_n, four[i].peak_force_n);
    EXPECT_EQ(one[i].removed_volume_m3, four[i].removed_volume_m3);
  }
}

// Two ways: the workpiece of rays, and the neighbouring pass alone. On the plane, upright and leant; and on a cylinder
// whose passes follow it.
TEST(ProgramForces, NeighboursAloneGiveTheSameOnAPlane) {
  const Eigen::Vector3d axes[] = {{0.0, 0.0, 1.0}, {0.15, -0.1, 1.0}};
  for (const Eigen::Vector3d& axis : axes) {
    Program program = two_passes(axis);
    const std::vector<BlockForce> stock = run(program, 0.04e-3, tangential_only());
    const std::vector<BlockForce> alone =
        local_program_forces(program, ball(), tangential_only(), 1e-3, {.spindle_speed_rad_per_s = speed});
    const Eigen::Vector3d expected = stock.back().mean_force_n;
    // Leant, tips run deeper than the ball: 1 mm below the top there is more than 1 mm of ball in the material.
    const double most = axis.x() == 0.0 ? 0.02 : 0.15;
    EXPECT_LE((alone.back().mean_force_n - expected).norm(), most * expected.norm()) << axis.transpose();
    EXPECT_NEAR(alone.back().radial_depth_m, 0.5e-3, 1e-9);
  }
}

TEST(ProgramForces, TakesTheProgramsSpindleSpeedAndMissesNone) {
  Program program = two_passes(Eigen::Vector3d::UnitZ());
  Workpiece workpiece(slab(), 0.5e-3);
  EXPECT_EQ(
      test::field_of([&] { static_cast<void>(program_forces(program, ball(), tangential_only(), workpiece, {})); }),
      "spindle_speed_rad_per_s");
  for (Block& block : program.blocks) block.spindle_speed_rad_per_s = 500.0;
  const std::vector<BlockForce> blocks = program_forces(program, ball(), tangential_only(), workpiece, {});
  EXPECT_EQ(blocks.front().spindle_speed_rad_per_s, 500.0);
  EXPECT_NEAR(blocks.front().feed_per_tooth_m, feed_m_per_s * 2.0 * std::numbers::pi / 1000.0, 1e-12);
}

// A dwell has no forces, with the stock and without, and changes those of no other block.
TEST(ProgramForces, DwellsHaveNone) {
  const Program program = two_passes(Eigen::Vector3d::UnitZ());
  Program dwelling = program;
  Block dwell = dwelling.blocks[0];
  dwell.kind = Block::Kind::dwell;
  dwell.duration_s = 2.0;
  dwelling.blocks.insert(dwelling.blocks.begin() + 1, dwell);
  const ProgramForceOptions options = {.spindle_speed_rad_per_s = speed};
  const auto check = [](const std::vector<BlockForce>& plain, const std::vector<BlockForce>& with) {
    ASSERT_EQ(with.size(), plain.size() + 1);
    EXPECT_EQ(with[1].peak_force_n, 0.0);
    EXPECT_EQ(with[1].removed_volume_m3, 0.0);
    EXPECT_FALSE(with[1].rapid_in_material);
    for (std::size_t i = 0; i < plain.size(); ++i) {
      EXPECT_EQ(with[i == 0 ? 0 : i + 1].mean_force_n, plain[i].mean_force_n) << i;
    }
  };
  check(run(program, 0.1e-3, tangential_only()), run(dwelling, 0.1e-3, tangential_only()));
  check(local_program_forces(program, ball(), tangential_only(), 1e-3, options),
        local_program_forces(dwelling, ball(), tangential_only(), 1e-3, options));
}

}  // namespace program_forces_test
}  // namespace robomill::cutting
