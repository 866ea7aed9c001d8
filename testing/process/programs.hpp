#pragma once
// Programs in an arm's cell, in memory: what tests of whole programs start from. Its user defines ROBOMILL_SOURCE_DIR.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "robomill/base/units.hpp"
#include "robomill/cell/files/cell_toml.hpp"
#include "robomill/modal/modes.hpp"
#include "robomill/process/decide.hpp"
#include "robomill/program/files/program_files.hpp"
#include "testing/jobs/program_files.hpp"

namespace robomill::process::testing {

inline cell::Cell cell_of(const std::string& toml) {
  return cell::read_cell(io::TomlSource("cell.toml", toml));
}

/// What forces_file() says.
inline Cut cut_of(const test_support::CutFile& in = {}) {
  using cutting::CutterKind;
  constexpr double n_per_mm2 = units::n_per_mm2, n_per_mm = 1.0 / units::mm;
  const auto point = [](const std::array<double, 3>& mm) {
    return Eigen::Vector3d(units::mm * Eigen::Vector3d(mm[0], mm[1], mm[2]));
  };
  Cut out = {.path = "forces.toml"};
  out.cutter.kind = in.kind == "ball-end" ? CutterKind::ball_end : CutterKind::flat_end;
  out.cutter.mill = {
      .teeth = in.teeth, .diameter_m = in.diameter_mm * units::mm, .helix_rad = in.helix_deg * units::deg};
  out.coefficients = {.tangential_n_per_m2 = {in.tangential_n_per_mm2 * n_per_mm2},
                      .radial_n_per_m2 = {in.radial_n_per_mm2 * n_per_mm2},
                      .axial_n_per_m2 = {in.axial_n_per_mm2 * n_per_mm2},
                      .tangential_edge_n_per_m = {in.tangential_edge_n_per_mm * n_per_mm},
                      .radial_edge_n_per_m = {in.radial_edge_n_per_mm * n_per_mm}};
  out.stock = cutting::Stock{.min_m = point(in.min_mm), .max_m = point(in.max_mm)};
  out.dexel_m = in.dexel_mm * units::mm;
  return out;
}

/// The forces along a program in G-code.
inline ForcesResult forces_along(const Cut& cut, const cell::Cell& cell, const std::string& program,
                                 const ProgramRun& run = {.keep_cuts = true, .deflect = true}) {
  return process::forces_along(cut, program::read_program_text(program, "part.ngc", cell::program_reading(cell)),
                               "part.ngc", cell, run);
}

/// Three passes of a 6 mm ball end beside each other, the first a slot, with rapid moves between.
inline std::string three_passes() {
  std::string text = "(three passes)\nG21 G90 G94\nS12000 M3\n";
  for (int pass = 0; pass < 3; ++pass) {
    text += fmt::format("G0 X-12 Y{0} Z5\nG0 Z-{1}\n", pass, 0.6 + 0.2 * pass);
    for (int i = 1; i <= 6; ++i) text += fmt::format("G1 X{} F{} (pass {})\n", -12 + 4 * i, 600, pass + 1);
    text += "G0 Z5\n";
  }
  return text + "M2\n";
}
/// Modes that chatter in the deeper passes at 12,000 rpm.
inline modal::ModalModel three_passes_modes(double mass = 1.0) {
  return modal::modes_from_mass({{410, 0.03, 0.6 * mass}}, {{530, 0.03, 0.5 * mass}}, {{780, 0.03, 0.8 * mass}});
}

/// They in their cell, judged.
class ThreePasses : public ::testing::Test {
 protected:
  void SetUp() override { cell_ = test_support::arm_cell(ROBOMILL_SOURCE_DIR, 2e8); }
  static modal::ModalModel modes(double mass = 1.0) { return three_passes_modes(mass); }
  [[nodiscard]] ForcesResult forces() const { return forces_along(cut_, cell_of(cell_), three_passes()); }
  struct Judged {
    ForcesResult forces;
    ProgramBlocks blocks;
  };
  [[nodiscard]] Judged judge(const DynamicsAt& dynamics) const {
    ForcesResult run = forces();
    ProgramBlocks blocks = judge_blocks(run, dynamics, {.scan_points = 0});
    return {.forces = std::move(run), .blocks = std::move(blocks)};
  }
  static DecideProblem problem(const Judged& judged, const DynamicsAt& dynamics) {
    DecideProblem out = {.forces = judged.forces, .blocks = judged.blocks, .dynamics = dynamics};
    out.blocks_options.scan_points = 0;
    out.machine.min_spindle_speed_rad_per_s = 6000.0 * units::rpm;
    out.machine.max_spindle_speed_rad_per_s = 18000.0 * units::rpm;
    return out;
  }
  std::string cell_ = {};  ///< cell.toml
  Cut cut_ = cut_of({.dexel_mm = 0.25});
};

}  // namespace robomill::process::testing
