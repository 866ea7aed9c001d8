#include "robomill/process/files/forces_toml.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/random.hpp"
#include "testing/support.hpp"
#include "testing/text.hpp"

namespace robomill::process {
namespace forces_toml_test {

using robomill::test::Folder;
using robomill::test::rejection;
using robomill::test::seeds;

const std::string good = R"(force_on = "workpiece"
[tool]
kind = "bull-nose"
diameter_mm = 10
corner_radius_mm = 2
cutting_height_mm = 15
teeth = 3
helix_deg = 30
pitch_deg = [110, 120, 130]
runout_um = 5
runout_angle_deg = 20
[cut]
axial_depth_mm = 1.5
stepover_mm = 4
feed_per_tooth_mm = 0.05
direction = "down"
spindle_speed_rpm = 12000
lead_deg = 10
tilt_deg = -5
feed_direction_deg = 30
[coefficients]
tangential_n_per_mm2 = [100, 900]
radial_n_per_mm2 = 350
axial_edge_n_per_mm = -3
[forces]
steps = 180
slices = 40
[workpiece_dynamics]
z = [{ frequency_hz = 200, damping_ratio = 0.02, modal_mass_kg = 3 }]
[stock]
kind = "turned"
center_mm = [1, 2]
outline_radius_mm = [40, 40, 20]
outline_z_mm = [0, 10, 30]
dexel_mm = 0.5
)";

std::string with(const std::string& old_text, const std::string& new_text) {
  return test_support::replaced(good, old_text, new_text);
}

TEST(ForcesToml, ReadsEveryKeyInSi) {
  const Folder folder;
  const ForcesFile file = read_forces(folder.file("forces.toml", good));
  EXPECT_EQ(file.cutter.kind, cutting::CutterKind::bull_nose);
  EXPECT_DOUBLE_EQ(file.cutter.corner_radius_m, 2e-3);
  EXPECT_DOUBLE_EQ(file.cutter.cutting_height_m, 15e-3);
  EXPECT_EQ(file.cutter.mill.pitch_rad.size(), 3U);
  EXPECT_DOUBLE_EQ(file.cutter.mill.runout_m, 5e-6);
  EXPECT_DOUBLE_EQ(file.cut.axial_depth_m, 1.5e-3);
  EXPECT_DOUBLE_EQ(file.cut.radial_depth_m, 4e-3);
  EXPECT_EQ(file.cut.direction, cutting::MillingDirection::down);
  EXPECT_DOUBLE_EQ(file.cut.lead_rad, std::numbers::pi / 18.0);
  EXPECT_DOUBLE_EQ(file.motion.spindle_speed_rad_per_s, 400.0 * std::numbers::pi);
  EXPECT_EQ(file.coefficients.tangential_n_per_m2, (std::vector<double>{100e6, 900e6}));
  EXPECT_EQ(file.coefficients.axial_edge_n_per_m, std::vector<double>{-3e3});
  EXPECT_TRUE(file.on_workpiece);
  EXPECT_EQ(file.force.steps, 180);
  EXPECT_EQ(file.slices, 40);
  EXPECT_EQ(file.workpiece_dynamics.modes.size(), 1U);
  ASSERT_TRUE(file.stock.has_value());
  EXPECT_EQ(file.stock->outline_m.size(), 3U);
  EXPECT_DOUBLE_EQ(file.stock->outline_m[2].x(), 20e-3);
  EXPECT_DOUBLE_EQ(file.dexel_m, 0.5e-3);
}

TEST(ForcesToml, AProgramNeedsNoCut) {
  const Folder folder;
  const auto path = folder.file("forces.toml",
                                "[tool]\nkind = \"ball-end\"\ndiameter_mm = 6\nteeth = 2\n[coefficients]\n"
                                "tangential_n_per_mm2 = 900\n");
  const ForcesFile file = read_forces(path, ForcesJob::program);
  EXPECT_EQ(file.motion.spindle_speed_rad_per_s, 0.0);
  EXPECT_FALSE(file.stock.has_value());
  EXPECT_NE(rejection([&] { static_cast<void>(read_forces(path)); }).find("cut.axial_depth_mm: is missing"),
            std::string::npos);
}

// [BudakAltintasArmarego1996]; its tests had a flat end.
TEST(ForcesToml, TheNameOfAMaterialStandsForItsNumbers) {
  const Folder folder;
  const std::string table =
      "[coefficients]\ntangential_n_per_mm2 = [100, 900]\nradial_n_per_mm2 = 350\naxial_edge_n_per_mm = -3\n";
  const auto named = [&](const std::string& name) {
    return read_forces(folder.file("forces.toml", "coefficients = \"" + name + "\"\n" + with(table, "")));
  };
  const ForcesFile file = named("Ti6Al4V");
  const ForcesFile typed =
      read_forces(folder.file("typed.toml", with(table,
                                                 "[coefficients]\ntangential_n_per_mm2 = 1825\nradial_n_per_mm2 = 770\n"
                                                 "axial_n_per_mm2 = -735\ntangential_edge_n_per_mm = 29.7\n"
                                                 "radial_edge_n_per_mm = 55.7\naxial_edge_n_per_mm = -1.8\n")));
  EXPECT_EQ(file.coefficients.tangential_n_per_m2, typed.coefficients.tangential_n_per_m2);
  EXPECT_EQ(file.coefficients.radial_n_per_m2, typed.coefficients.radial_n_per_m2);
  EXPECT_EQ(file.coefficients.axial_n_per_m2, typed.coefficients.axial_n_per_m2);
  EXPECT_EQ(file.coefficients.tangential_edge_n_per_m, typed.coefficients.tangential_edge_n_per_m);
  EXPECT_EQ(file.coefficients.radial_edge_n_per_m, typed.coefficients.radial_edge_n_per_m);
  EXPECT_EQ(file.coefficients.axial_edge_n_per_m, typed.coefficients.axial_edge_n_per_m);
  EXPECT_TRUE(typed.notes.empty());
  ASSERT_EQ(file.notes.size(), 3U);
  EXPECT_NE(file.notes[0].find("ti-6al-4v, set 1 of 1: end mill, 4 teeth [BudakAltintasArmarego1996]"),
            std::string::npos)
      << file.notes[0];
  EXPECT_NE(file.notes[1].find("another kind of cutter"), std::string::npos) << file.notes[1];
  EXPECT_NE(file.notes[2].find("recommended for ti-6al-4v"), std::string::npos) << file.notes[2];
  const std::string said = rejection([&] { static_cast<void>(named("6061-T66")); });
  EXPECT_NE(said.find("forces.toml:1: coefficients = \"6061-T66\""), std::string::npos) << said;
  EXPECT_NE(said.find("Did you mean 6061-t6?"), std::string::npos) << said;
}

TEST(ForcesToml, ASlotIsAsWideAsItsCutter) {
  const Folder folder;
  const auto slot = [&](const std::string& kind, const std::string& radial_depth_mm) {
    static_cast<void>(read_forces(folder.file(
        "forces.toml", "[tool]\nkind = \"" + kind + "\"\ndiameter_mm = 10\nteeth = 2\n[cut]\naxial_depth_mm = 1\n" +
                           "direction = \"slot\"\nfeed_per_tooth_mm = 0.05\nspindle_speed_rpm = 3000\n" +
                           "radial_depth_mm = " + radial_depth_mm + "\n[coefficients]\ntangential_n_per_mm2 = 700\n")));
  };
  const std::string said = rejection([&] { slot("flat-end", "4"); });
  EXPECT_NE(said.find("cut.radial_depth_mm = 4 mm; contradicts cut.direction = \"slot\""), std::string::npos) << said;
  EXPECT_NO_THROW(slot("flat-end", "10"));
  EXPECT_NO_THROW(slot("ball-end", "6"));
}

// A power of the chip is taken at the mean chip of the cut where the file tells it: of an upright flat end.
TEST(ForcesToml, APowerOfTheChipIsTakenAtTheCutsMeanChip) {
  const Folder folder;
  const std::string flat = "[tool]\nkind = \"flat-end\"\ndiameter_mm = 10\nteeth = 2\n";
  const std::string tool = flat + "[coefficients]\nmaterial = \"1045\"\nradial_ratio = 0.4\n";
  const std::string cut =
      "[cut]\naxial_depth_mm = 1\ndirection = \"slot\"\nfeed_per_tooth_mm = 0.05\nspindle_speed_rpm = 3000\n";
  const auto tangential = [&](const std::string& text, ForcesJob job) {
    return read_forces(folder.file("forces.toml", text), job).coefficients.tangential_n_per_m2.front();
  };
  const double chip_m = 2.0 * 0.05e-3 / std::numbers::pi;
  EXPECT_NEAR(tangential(tool + cut, ForcesJob::revolution), 0.78 * 1500e6 * std::pow(chip_m / 1e-3, -0.22), 1.0);
  EXPECT_NE(rejection([&] {
              static_cast<void>(tangential(tool, ForcesJob::program));
            }).find("coefficients.chip_thickness_mm: is missing"),
            std::string::npos);
  EXPECT_NEAR(tangential(tool + "chip_thickness_mm = 0.02\n", ForcesJob::program),
              0.78 * 1500e6 * std::pow(0.02, -0.22), 1.0);
  const ForcesFile aluminium = read_forces(folder.file("forces.toml", "coefficients = \"6061-t6\"\n" + flat + cut));
  ASSERT_EQ(aluminium.notes.size(), 4U);
  EXPECT_NE(aluminium.notes[2].find("A feed per tooth of 0.05 mm lies outside the tests of [Du2024], 0.02 mm"),
            std::string::npos)
      << aluminium.notes[2];
  EXPECT_EQ(aluminium.notes[3],
            "A cutting speed of 94.2 m/min is none that is recommended for 6061-t6: 305 to 610 [Fullerton], 244 to 610 "
            "[Niagara2016] m/min.");
}

TEST(ForcesToml, SaysWhatIsWrongAndWhere) {
  const Folder folder;
  const auto message_of = [&](const std::string& text) {
    return rejection([&] { static_cast<void>(read_forces(folder.file("forces.toml", text))); });
  };
  const auto expect = [&](const std::string& from, const std::string& to, const std::string& part) {
    const std::string message = message_of(with(from, to));
    EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  expect("axial_depth_mm = 1.5", "axial_depth_mm = 40", "forces.toml:13: cut.axial_depth_mm = 40 mm");
  expect("stepover_mm = 4", "stepover_mm = 0", "cut.stepover_mm = 0 mm");
  expect("stepover_mm = 4", "stepover_mm = 10.5", "cut.stepover_mm = 10.5 mm");
  expect("kind = \"bull-nose\"", "kind = \"bull\"", "tool.kind = \"bull\"");
  expect("tangential_n_per_mm2 = [100, 900]", "tangential_n_per_mm2 = [-900, 300]", "position angle of");
  expect("corner_radius_mm = 2", "corner_radius_mm = 5", "tool.corner_radius_mm = 5 mm");
  expect("lead_deg = 10", "lead_dg = 10", "cut.lead_dg");
  expect("\"workpiece\"", "\"part\"", "force_on");
  expect("steps = 180", "steps = 2", "forces.steps = 2");
  expect("outline_z_mm = [0, 10, 30]", "outline_z_mm = [0, 10]", "stock.outline_z_mm");
  expect("dexel_mm = 0.5", "dexel_mm = 0", "stock.dexel_mm = 0");
  expect("tangential_n_per_mm2 = [100, 900]\n", "", "coefficients.tangential_n_per_mm2: is missing");
  expect("kind = \"turned\"", "kind = \"neighbours\"", "tool.kind = \"bull-nose\"; must be \"ball-end\"");
  expect("lead_deg = 10", "surface_radius_along_feed_mm = 0", "surface_radius_along_feed_mm = 0");
  expect("[workpiece_dynamics]\nz = [{ frequency_hz = 200, damping_ratio = 0.02, modal_mass_kg = 3 }]",
         "[robot]\njoints_deg = [0, 0, 0]", "robot.cell: is missing");
  const std::string part = "[workpiece_dynamics]";
  expect(part, "[dynamics]\ncell = \"cell.toml\"\n" + part, "dynamics.joints_deg: is missing");
  expect(part, "[dynamics]\njoints_deg = [0, 0, 0]\n" + part, "dynamics.cell: is missing");
  expect(part, "[dynamics]\ncell = \"cell.toml\"\njoints_deg = 0\nmodes = \"m.json\"\n" + part,
         "dynamics.cell = \"cell.toml\"; must not stand beside modes");
  expect(part, "[dynamics]\naxes = \"base\"\n" + part, "must be \"feed\" or \"tool\"");
  expect(part, part + "\nfrf = \"f.csv\"", "workpiece_dynamics: must give only one of modes, frf");
  expect("center_mm = [1, 2]", "min_mm = [1, 2, 3]", "stock.min_mm: is no part of this kind of stock");
}

TEST(ForcesToml, DamagedFilesAreReadOrRejected) {
  const Folder folder;
  Random random(5);
  for (int k = 0; k < seeds(500); ++k) {
    std::string text = good;
    for (int i = 0; i < 3; ++i) {
      text[static_cast<std::size_t>(random.uniform(0.0, static_cast<double>(text.size()) - 0.01))] =
          static_cast<char>(random.uniform(1.0, 127.0));
    }
    try {
      static_cast<void>(read_forces(folder.file("forces.toml", text)));
    } catch (const InvalidInput&) {
    }
  }
}

}  // namespace forces_toml_test
}  // namespace robomill::process
