#pragma once
// A program of three passes with its cell, judged: what tests of the decision start from. Its user defines
// ROBOMILL_SOURCE_DIR.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "robomill/base/units.hpp"
#include "robomill/jobs/plan.hpp"
#include "robomill/modal/modes.hpp"
#include "robomill/process/decide.hpp"
#include "testing/jobs/program_files.hpp"
#include "testing/support.hpp"

namespace robomill::jobs::testing {

/// Three passes of a 6 mm ball end beside each other, the first a slot, with rapid moves between.
class ThreePasses : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_.file("cell.toml", test_support::arm_cell(ROBOMILL_SOURCE_DIR, 2e8));
    folder_.file("forces.toml", test_support::forces_file({.dexel_mm = 0.25}));
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
    return run_job(
        folder_.file("judge.toml",
                     "[job]\nforces = \"forces.toml\"\ncell = \"cell.toml\"\nprogram = \"part.ngc\"\n"
                     "modes = \"" +
                         std::string(ROBOMILL_SOURCE_DIR) + "/data/robot-modes.toml\"\n[decide]\nfree = []\n"),
        1);
  }
  /// Modes that chatter in the deeper passes at 12,000 rpm.
  static modal::ModalModel modes(double mass = 1.0) {
    return modal::modes_from_mass({{410, 0.03, 0.6 * mass}}, {{530, 0.03, 0.5 * mass}}, {{780, 0.03, 0.8 * mass}});
  }
  struct Judged {
    process::ForcesResult forces;
    process::ProgramBlocks blocks;
  };
  Judged judge(const process::DynamicsAt& dynamics) {
    process::ForcesResult forces = *judged().programmed.forces;
    process::ProgramBlocks blocks = process::judge_blocks(forces, dynamics, {.scan_points = 0});
    return {.forces = std::move(forces), .blocks = std::move(blocks)};
  }
  static process::DecideProblem problem(const Judged& judged, const process::DynamicsAt& dynamics) {
    process::DecideProblem out = {.forces = judged.forces, .blocks = judged.blocks, .dynamics = dynamics};
    out.blocks_options.scan_points = 0;
    out.machine.min_spindle_speed_rad_per_s = 6000.0 * units::rpm;
    out.machine.max_spindle_speed_rad_per_s = 18000.0 * units::rpm;
    return out;
  }
  test::Folder folder_;
};

}  // namespace robomill::jobs::testing
