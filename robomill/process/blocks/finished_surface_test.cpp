// What each block leaves of the finished surface.
#include "robomill/process/blocks/finished_surface.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "robomill/base/units.hpp"
#include "robomill/process/blocks.hpp"
#include "robomill/process/blocks/stability.hpp"
#include "robomill/process/compensate.hpp"
#include "robomill/stability/surface_error.hpp"
#include "testing/process/programs.hpp"
#include "testing/support.hpp"

namespace robomill::process {
namespace finished_surface_test {

/// Greatest magnitude of the errors of the places that the block's edges leave and that are so in W.
template <class Is>
double greatest_error_m(const ForcesResult& forces, std::size_t block, const modal::ModalModel& modes, Is is) {
  const cutting::PoseEngagement& cut = forces.program->cuts[block];
  const double speed = forces.program->blocks[block].force.spindle_speed_rad_per_s;
  const stability::LobesProblem problem = block_problem({.setup = forces.cut,
                                                         .cut = cut,
                                                         .base_from_work = forces.cell->robot.workpiece.linear(),
                                                         .spindle_speed_rad_per_s = speed},
                                                        modes);
  const Eigen::Vector3d tip_m = forces.program->program.blocks[block].end.tip_m;
  double out = 0.0;
  for (const stability::SurfacePlace& place :
       stability::surface_profile(problem, {speed, engaged_depth_m(cut)}, BlocksOptions{}.tolerance)) {
    const Eigen::Vector3d in_tool(place.radius_m * std::sin(place.angle_rad),
                                  place.radius_m * std::cos(place.angle_rad), place.height_m);
    const Eigen::Vector3d in_work = tip_m + cut.work_from_feed * cut.engagement.feed_from_tool * in_tool;
    if (is(in_work)) out = std::max(out, std::abs(place.error_m));
  }
  return out;
}

class FinishedSurface : public ::testing::Test {
 protected:
  /// Of an arm that hardly bends.
  static ForcesResult forces_of(const std::string& program, const test_support::CutFile& cut = {}) {
    return testing::forces_along(testing::cut_of(cut),
                                 testing::cell_of(test_support::arm_cell(ROBOMILL_SOURCE_DIR, 2e10)), program);
  }
  static DynamicsAt dynamics(double mass = 1.0) {
    return constant_dynamics(
        modal::modes_from_mass({{410, 0.03, 6.0 * mass}}, {{530, 0.03, 5.0 * mass}}, {{780, 0.03, 8.0 * mass}}));
  }
  /// A slot along x, 1 mm deep, in moves of 2 mm, then back beside it.
  /// @param beside_mm  in y; 0: the slot alone
  static std::string to_and_fro(double beside_mm) {
    std::string text = "G21 G90 G94\nS12000 M3\nG0 X-18 Y0 Z5\nG0 Z-1\n";
    for (int i = 1; i <= 18; ++i) text += fmt::format("G1 X{} F900\n", -18 + 2 * i);
    if (beside_mm != 0.0) text += fmt::format("G1 Y{}\n", beside_mm);
    for (int i = 1; beside_mm != 0.0 && i <= 18; ++i) text += fmt::format("G1 X{}\n", 18 - 2 * i);
    return text + "G0 Z5\nM2\n";
  }
};

// Of two passes of a ball end side by side each leaves what lies on its own side of the plane midway between them.
// Three ways: the rays, that plane (the rim of the slot apart, which rays may miss), and the runs of the compensation.
TEST_F(FinishedSurface, IsWhatLaterPassesLeave) {
  const modal::ModalModel modes = dynamics()(Eigen::VectorXd::Zero(6)).modes;
  int taken = 0;
  int compared = 0;
  for (const double beside_mm : {-0.5, 0.5}) {
    const ForcesResult forces = forces_of(to_and_fro(beside_mm));
    const ProgramBlocks blocks =
        judge_blocks(forces, dynamics(), {.alike = {.joint_rad = 0.0, .cut_share = 0.0}, .scan_points = 0});
    const std::vector<CompensatedBlock> left = compensate(forces, dynamics(), {.most_passes = 1}).blocks;
    for (std::size_t i = 0; i < blocks.rows.size(); ++i) {
      const BlockRow& row = blocks.rows[i];
      if (!row.cuts || !std::isfinite(row.surface_left_m)) continue;
      EXPECT_LE(std::abs(row.surface_left_m), std::abs(row.steady.surface_error_m)) << i;
      const Eigen::Vector3d tip_mm = forces.program->program.blocks[i].end.tip_m / units::mm;
      if (std::abs(tip_mm.x()) > 12.0) continue;
      ++compared;
      const double away = (tip_mm.y() == 0.0) == (beside_mm > 0.0) ? 1.0 : -1.0;  // where the other pass runs
      const auto apart_mm = [&](const Eigen::Vector3d& at_m) {
        return away * (at_m.y() / units::mm - 0.5 * beside_mm);
      };
      const auto surely = [&](const Eigen::Vector3d& at_m) {
        return apart_mm(at_m) < -0.1 && at_m.z() < -0.3 * units::mm;
      };
      const auto perhaps = [&](const Eigen::Vector3d& at_m) { return apart_mm(at_m) < 0.1; };
      const double found = std::abs(row.surface_left_m);
      EXPECT_GE(found, greatest_error_m(forces, i, modes, surely) * (1.0 - 1e-6)) << i;
      EXPECT_LE(found, greatest_error_m(forces, i, modes, perhaps) * (1.0 + 1e-6)) << i;
      ASSERT_EQ(left[i].before.state, SurfaceLeft::State::known) << i;
      EXPECT_NEAR(row.surface_left_m, left[i].before.error_m, 0.05 * found) << i;
      if (found < 0.9 * std::abs(row.steady.surface_error_m)) ++taken;
    }
  }
  EXPECT_GE(compared, 40);
  EXPECT_GE(taken, 10);
}

TEST_F(FinishedSurface, OfASinglePassIsAllThatItLeaves) {
  const ForcesResult forces = forces_of(to_and_fro(0.0));
  const ProgramBlocks blocks = judge_blocks(forces, dynamics(), {.scan_points = 0});
  int compared = 0;
  for (std::size_t i = 0; i < blocks.rows.size(); ++i) {
    const BlockRow& row = blocks.rows[i];
    if (!row.cuts) {
      EXPECT_TRUE(std::isnan(row.surface_left_m)) << i;
      continue;
    }
    if (std::abs(forces.program->program.blocks[i].end.tip_m.x()) > 12.0 * units::mm) continue;
    ++compared;
    EXPECT_NEAR(row.surface_left_m, row.steady.surface_error_m, 0.02 * std::abs(row.steady.surface_error_m)) << i;
  }
  EXPECT_GE(compared, 10);
  const ProgramBlocks chatters = judge_blocks(forces, dynamics(1e-3), {.scan_points = 0});
  ASSERT_TRUE(chatters.rows[9].unstable());
  EXPECT_TRUE(std::isnan(chatters.rows[9].surface_left_m));
}

TEST_F(FinishedSurface, IsNotKnownWithoutAStock) {
  ForcesResult forces = forces_of(to_and_fro(1.0));
  const auto column = [&](const ProgramBlocks& blocks) {
    const nlohmann::json json = nlohmann::json::parse(blocks_json(forces, blocks));
    return json["blocks"]["surface_left_um"];
  };
  const ProgramBlocks with = judge_blocks(forces, dynamics(), {.scan_points = 0});
  EXPECT_FALSE(column(with)[9].is_null());
  forces.program->stock.reset();
  const ProgramBlocks without = judge_blocks(forces, dynamics(), {.scan_points = 0});
  for (std::size_t i = 0; i < without.rows.size(); ++i) {
    EXPECT_TRUE(std::isnan(without.rows[i].surface_left_m)) << i;
    EXPECT_TRUE(column(without)[i].is_null()) << i;
    const double error_m = with.rows[i].steady.surface_error_m;
    if (std::isfinite(error_m)) {
      EXPECT_EQ(without.rows[i].steady.surface_error_m, error_m) << i;
    }
  }
  const auto said = [](const ProgramBlocks& blocks) {
    return std::ranges::any_of(block_notes(blocks), [](const std::string& text) {
      return text.find("finished surface is not known") != std::string::npos;
    });
  };
  EXPECT_TRUE(said(without));
  EXPECT_FALSE(said(with));
  std::istringstream table(blocks_csv(forces, without));
  std::string header;
  std::getline(table, header);
  const auto before =
      std::count(header.begin(), header.begin() + static_cast<std::ptrdiff_t>(header.find("surface_left_um")), ',');
  std::size_t rows = 0;
  for (std::string line; std::getline(table, line); ++rows) {
    std::size_t at = 0;
    for (std::ptrdiff_t k = 0; k < before; ++k) at = line.find(',', at) + 1;
    EXPECT_EQ(line[at], ',') << line;
  }
  EXPECT_EQ(rows, without.rows.size());
}

// A flat end's slot without axial force has one mean stiffness in every direction of the feed, and not one surface.
TEST_F(FinishedSurface, IsNotSharedBySlotsAcrossEachOther) {
  std::string text = "G21 G90 G94\nS12000 M3\nG0 X-24 Y0 Z5\nG0 Z-1\n";
  for (int i = 1; i <= 12; ++i) text += fmt::format("G1 X{} F900\n", -24 + 2 * i);
  for (int i = 1; i <= 6; ++i) text += fmt::format("G1 Y{}\n", 2 * i);
  const ForcesResult forces = forces_of(text + "G0 Z5\nM2\n", {.kind = "flat-end", .axial_n_per_mm2 = 0.0});
  const DynamicsAt uneven =
      constant_dynamics(modal::modes_from_mass({{410, 0.03, 60.0}}, {{530, 0.03, 5.0}}, {{780, 0.03, 8.0}}));
  const ProgramBlocks own =
      judge_blocks(forces, uneven, {.alike = {.joint_rad = 0.0, .cut_share = 0.0}, .scan_points = 0});
  const ProgramBlocks shared = judge_blocks(forces, uneven, {.scan_points = 0});
  EXPECT_LT(shared.evaluations, own.evaluations);
  int compared = 0;
  for (std::size_t i = 0; i < own.rows.size(); ++i) {
    if (!own.rows[i].cuts || !std::isfinite(own.rows[i].surface_left_m)) continue;
    ++compared;
    const double error_m = own.rows[i].steady.surface_error_m;
    EXPECT_NEAR(shared.rows[i].steady.surface_error_m, error_m, 0.05 * std::abs(error_m)) << i;
  }
  EXPECT_GE(compared, 10);
}

}  // namespace finished_surface_test
}  // namespace robomill::process
