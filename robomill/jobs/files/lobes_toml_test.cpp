#include "robomill/jobs/files/lobes_toml.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>
#include <vector>

#include "robomill/base/units.hpp"
#include "robomill/cutting/coefficients.hpp"
#include "robomill/cutting/files/materials_toml.hpp"
#include "robomill/cutting/files/slots_csv.hpp"
#include "robomill/cutting/material.hpp"
#include "testing/support.hpp"
#include "testing/text.hpp"

namespace robomill::jobs {
namespace lobes_toml_test {

const std::string good = R"([tool]
teeth = 2
diameter_mm = 12
helix_deg = 30
[cut]
direction = "down"
radial_depth_mm = 1.2
feed_per_tooth_mm = 0.1
feed_direction_deg = 90
[coefficients]
tangential_n_per_mm2 = 600
radial_n_per_mm2 = 200
[dynamics]
x = [{ frequency_hz = 922, damping_ratio = 0.011, modal_mass_kg = 0.03993 }]
y = [{ frequency_hz = 922, damping_ratio = 0.011, modal_mass_kg = 0.03993 }]
[lobes]
spindle_speed_rpm = [5000, 25000]
axial_depth_mm = [0, 5]
grid = [30, 20]
method = "semi-discretization"
)";

std::string with(const std::string& old_text, const std::string& new_text) {
  return test_support::replaced(good, old_text, new_text);
}

TEST(LobesToml, ReadsEverythingInSi) {
  const test::Folder folder;
  const LobesFile file = read_lobes(folder.file("lobes.toml", good));
  EXPECT_NO_THROW(file.validate());
  const cutting::Milling& milling = file.problem.milling;
  EXPECT_DOUBLE_EQ(milling.tool.diameter_m, 0.012);
  EXPECT_DOUBLE_EQ(milling.tool.helix_rad, 30 * units::deg);
  EXPECT_NEAR(milling.immersion.entry_rad, std::acos(2 * 1.2 / 12 - 1), 1e-14);
  EXPECT_NEAR(milling.immersion.exit_rad, std::numbers::pi, 1e-14);
  EXPECT_DOUBLE_EQ(milling.coefficients.tangential_n_per_m2, 6e8);
  EXPECT_DOUBLE_EQ(file.problem.feed_direction_rad, std::numbers::pi / 2);
  EXPECT_DOUBLE_EQ(file.radial_depth_m, 1.2e-3);
  EXPECT_DOUBLE_EQ(file.options.axial_depth_m[1], 5e-3);
  EXPECT_DOUBLE_EQ(file.options.spindle_speed_rad_per_s[0], 5000 * units::rpm);
  EXPECT_EQ(file.options.grid[0], 30);
}

// The file that robomill coefficients writes, and a material, in place of numbers: a cylinder has κ = 90 degrees.
TEST(LobesToml, TakesCoefficientsFromAFileOrAMaterial) {
  const test::Folder folder;
  const std::string numbers = "tangential_n_per_mm2 = 600\nradial_n_per_mm2 = 200\n";
  const auto read = [&](const std::string& table) {
    return read_lobes(folder.file("lobes.toml", with(numbers, table))).problem.milling.coefficients;
  };
  cutting::SlotsFile slots;
  for (const double feed_m : {0.05e-3, 0.1e-3, 0.2e-3}) {
    const double a = 4.0 * 2e-3;  // teeth and depth
    slots.slots.push_back({.feed_per_tooth_m = feed_m,
                           .axial_depth_m = 2e-3,
                           .mean_force_n = {-a / 4 * 250e6 * feed_m - a / std::numbers::pi * 30e3,
                                            a / 4 * 700e6 * feed_m + a / std::numbers::pi * 20e3, 0.0}});
    slots.lines.push_back(slots.lines.size() + 2);
  }
  folder.file("k.toml", cutting::slot_fit_toml(cutting::identify_from_slots(slots.slots, {.teeth = 4}), slots));
  const cutting::ForceCoefficients found = read("file = \"k.toml\"\n");
  EXPECT_NEAR(found.tangential_n_per_m2, 700e6, 1.0);
  EXPECT_NEAR(found.radial_n_per_m2, 250e6, 1.0);
  EXPECT_NEAR(found.tangential_edge_n_per_m, 20e3, 1e-3);
  EXPECT_NEAR(found.radial_edge_n_per_m, 30e3, 1e-3);
  // What a fit writes is read, also where the tooth is pulled in.
  for (cutting::SlotForce& slot : slots.slots) slot.mean_force_n[0] += 8e-3 / 4 * 450e6 * slot.feed_per_tooth_m;
  folder.file("pulls.toml", cutting::slot_fit_toml(cutting::identify_from_slots(slots.slots, {.teeth = 4}), slots));
  EXPECT_NEAR(read("file = \"pulls.toml\"\n").radial_n_per_m2, -200e6, 1.0);
  folder.file("length.toml",
              "[coefficients]\ntangential_n_per_mm2 = [100, 600]\ntangential_edge_n_per_mm = 20\n"
              "edge_per = \"edge-length\"\n");
  EXPECT_NEAR(read("file = \"length.toml\"\n").tangential_n_per_m2, (600 + 50 * std::numbers::pi) * 1e6, 1.0);
  EXPECT_NEAR(read("file = \"length.toml\"\n").tangential_edge_n_per_m, 20e3 / std::cos(30 * units::deg), 1e-6);
  const std::string ti = "material = \"Ti6Al4V\"\nrake_deg = 5\nchip_thickness_mm = 0.03\n";
  EXPECT_DOUBLE_EQ(read(ti).tangential_n_per_m2, cutting::milling_coefficients(*cutting::material("Ti6Al4V").orthogonal,
                                                                               5 * units::deg, 30 * units::deg, 0.03e-3)
                                                     .tangential_n_per_m2.front());
  folder.file("low.toml", "[coefficients]\ntangential_n_per_mm2 = 0.6\n");
  const std::string message = test::rejection([&] { static_cast<void>(read("file = \"low.toml\"\n")); });
  EXPECT_NE(message.find("lobes.toml:11: coefficients.file"), std::string::npos) << message;
  EXPECT_NE(message.find("tangential_n_per_m2 = 600000"), std::string::npos) << message;
}

TEST(LobesToml, ARadialNumberThatPullsIsWarnedOf) {
  const test::Folder folder;
  const LobesFile file =
      read_lobes(folder.file("lobes.toml", with("radial_n_per_mm2 = 200", "radial_n_per_mm2 = -200")));
  EXPECT_DOUBLE_EQ(file.problem.milling.coefficients.radial_n_per_m2, -200e6);
  ASSERT_FALSE(file.notes.empty());
  EXPECT_NE(file.notes.front().find("coefficients.radial_n_per_mm2 = -200 N/mm^2; is unusual"), std::string::npos)
      << file.notes.front();
}

std::string joined(const std::vector<std::string>& notes) {
  std::string all;
  for (const std::string& note : notes) all += note + "\n";
  return all;
}

const std::string coefficients = "[coefficients]\ntangential_n_per_mm2 = 600\nradial_n_per_mm2 = 200\n";

/// `good` with the coefficients of a material; a name in place of the table has to stand before the first table.
std::string with_material(const std::string& name) {
  return "coefficients = \"" + name + "\"\n" + with(coefficients, "");
}

// [AviationAluminum2021] 7075-T6, its first set; by its name the same cut as by its numbers.
TEST(LobesToml, TheNameOfAMaterialStandsForItsNumbers) {
  const test::Folder folder;
  const LobesFile named = read_lobes(folder.file("lobes.toml", with_material("7075-T6")));
  const LobesFile typed = read_lobes(
      folder.file("typed.toml", with(coefficients,
                                     "[coefficients]\ntangential_n_per_mm2 = 1319.41\nradial_n_per_mm2 = 788.83\n"
                                     "tangential_edge_n_per_mm = 19.65\nradial_edge_n_per_mm = 26.77\n")));
  EXPECT_NO_THROW(named.validate());
  const cutting::ForceCoefficients &k = named.problem.milling.coefficients, &same = typed.problem.milling.coefficients;
  EXPECT_EQ(k.tangential_n_per_m2, same.tangential_n_per_m2);
  EXPECT_EQ(k.radial_n_per_m2, same.radial_n_per_m2);
  EXPECT_EQ(k.tangential_edge_n_per_m, same.tangential_edge_n_per_m);
  EXPECT_EQ(k.radial_edge_n_per_m, same.radial_edge_n_per_m);
  const auto radius = [](const LobesFile& file) {
    const stability::OperatingPoint point{.spindle_speed_rad_per_s = 8000 * units::rpm, .axial_depth_m = 1e-3};
    return stability::evaluate_point(file.problem, file.options, point).spectral_radius;
  };
  EXPECT_EQ(radius(named), radius(typed));
  const std::string notes = joined(named.notes);
  EXPECT_NE(notes.find("those of 7075-t6, set 3 of 5: cemented carbide, dry, 7075 [AviationAluminum2021]"),
            std::string::npos)
      << notes;
  EXPECT_NE(notes.find("The 4 sets of 7075-t6 reach from 600.5 to 1319 N/mm^2"), std::string::npos) << notes;
  EXPECT_TRUE(typed.notes.empty());
}

// Of four sets the sample's deviation, 308.5 of 909.6 N/mm^2 in the mean; of two half their distance.
TEST(LobesToml, AMaterialBringsItsSpread) {
  const test::Folder folder;
  const auto read = [&](const std::string& text) { return read_lobes(folder.file("lobes.toml", text)); };
  const LobesFile named = read(with_material("7075-t6"));
  EXPECT_NEAR(named.uncertainty.coefficient_std_ratio, 308.5 / 909.6, 1e-4);
  EXPECT_EQ(named.uncertainty.tangential_std_n_per_m2, 0.0);
  EXPECT_EQ(named.uncertainty.samples, 0) << "no more samples than were asked for";
  EXPECT_EQ(joined(named.notes).find("standard deviation"), std::string::npos) << "no band";
  EXPECT_NE(named.band_note.find("whose standard deviation is that of the sets of its material, 33.9 %"),
            std::string::npos)
      << named.band_note;
  EXPECT_NEAR(read(with_material("6061-t6")).uncertainty.coefficient_std_ratio, (1041.4 - 243.77) / (1041.4 + 243.77),
              1e-12);
  for (const char* own : {"tangential_std_n_per_mm2 = 30", "radial_std_n_per_mm2 = 0", "coefficient_std_ratio = 0"}) {
    const LobesFile file = read(with_material("7075-t6") + "[uncertainty]\n" + own + "\n");
    EXPECT_EQ(file.uncertainty.coefficient_std_ratio, 0.0) << own;
    EXPECT_EQ(file.band_note, "");
  }
  EXPECT_DOUBLE_EQ(
      read(with_material("7075-t6") + "[uncertainty]\ncoefficient_std_ratio = 0.1\n").uncertainty.coefficient_std_ratio,
      0.1);
}

TEST(LobesToml, SaysWhereACutIsUnlikeWhatIsRecommended) {
  const test::Folder folder;
  const auto notes = [&](const std::string& text) { return joined(read_lobes(folder.file("lobes.toml", text)).notes); };
  EXPECT_EQ(notes(with_material("7075-t6")).find("recommended"), std::string::npos);
  const std::string coarse =
      notes(test_support::replaced(with_material("7075-t6"), "feed_per_tooth_mm = 0.1", "feed_per_tooth_mm = 1"));
  EXPECT_NE(coarse.find("A feed per tooth of 1 mm is more than twice of what is recommended for 7075-t6 at 12 mm"),
            std::string::npos)
      << coarse;
}

// [Du2024] had 0.02 mm a tooth and no range of speeds; the fibreboard of [Goli2018] 754 m/min and chips of 41 to 91 um.
TEST(LobesToml, SaysWhereACutLeavesTheTestsOfItsMaterial) {
  const test::Folder folder;
  const auto notes = [&](const std::string& text) { return joined(read_lobes(folder.file("lobes.toml", text)).notes); };
  const std::string aluminium = notes(with_material("6061-T6"));
  EXPECT_NE(aluminium.find("A feed per tooth of 0.1 mm lies outside the tests of [Du2024], 0.02 mm"), std::string::npos)
      << aluminium;
  const std::string inside =
      notes(test_support::replaced(with_material("6061-T6"), "feed_per_tooth_mm = 0.1", "feed_per_tooth_mm = 0.02"));
  EXPECT_EQ(inside.find("outside"), std::string::npos) << inside;
  const std::string board =
      notes(with(coefficients, "[coefficients]\nmaterial = \"mdf\"\nset = 1\nradial_ratio = 0.4\n"));
  EXPECT_NE(board.find("A cutting speed of 188 to 942 m/min lies outside the tests of [Goli2018], 754 m/min"),
            std::string::npos)
      << board;
  EXPECT_NE(board.find("A mean chip thickness of 0.0311 mm lies outside the tests of [Goli2018], 0.041 to 0.091 mm"),
            std::string::npos)
      << board;
}

TEST(LobesToml, RejectsAMaterialInTheFilesWords) {
  const test::Folder folder;
  const auto expect = [&](const std::string& text, const std::string& words) {
    const std::string said = test::rejection([&] { static_cast<void>(read_lobes(folder.file("lobes.toml", text))); });
    EXPECT_NE(said.find(words), std::string::npos) << said;
  };
  expect(with_material("7075-t7"), "lobes.toml:1: coefficients = \"7075-t7\"; must be one of 6061-t6");
  expect(with_material("7075-t7"), "Did you mean 7075-t6?");
  expect(with_material("1045"), "lobes.toml:1: coefficients = \"1045\"; has no radial coefficient");
  expect(with_material("304"), "of which no force coefficients are known");
  expect("coefficients = 600\n" + with(coefficients, ""), "lobes.toml:1: coefficients = 600");
}

// The modes given by modal mass have the receptance 1 / (m (ω_n² - ω² + 2iζω_nω)).
TEST(LobesToml, InlineModesHaveTheirModalMass) {
  const test::Folder folder;
  const modal::ModalModel model = read_lobes(folder.file("lobes.toml", good)).problem.dynamics;
  const Eigen::Vector3d frequency_hz(100.0, 922.0, 3000.0);
  const modal::FrfSet frfs = modal::synthesize(model, frequency_hz);
  const double natural = 2 * std::numbers::pi * 922;
  for (const char* name : {"xx", "yy"}) {
    for (Eigen::Index i = 0; i < 3; ++i) {
      const double omega = 2 * std::numbers::pi * frequency_hz(i);
      const std::complex<double> expected =
          1.0 / (0.03993 * std::complex<double>(natural * natural - omega * omega, 2 * 0.011 * natural * omega));
      const std::complex<double> found = frfs.find(modal::parse_frf_name(name))->receptance(i);
      EXPECT_LT(std::abs(found - expected), 1e-12 * std::abs(expected));
    }
  }
}

// k = m ω²: a mode is told by its mass or by its stiffness, in whichever table it stands.
TEST(LobesToml, AModeHasAMassOrAStiffness) {
  const test::Folder folder;
  const double stiffness_n_per_um = 0.03993 * std::pow(2.0 * std::numbers::pi * 922.0, 2) * 1e-6;
  const std::string stiffness = fmt::format("modal_stiffness_n_per_um = {:.17g}", stiffness_n_per_um);
  const std::string mass = "modal_mass_kg = 0.03993";
  const auto with = [&](const std::string& told) {
    std::string text = good;
    for (std::size_t at = text.find(mass); at != std::string::npos; at = text.find(mass, at + told.size())) {
      text.replace(at, mass.size(), told);
    }
    return folder.file("lobes.toml", text);
  };
  const LobesFile by_mass = read_lobes(with(mass)), by_stiffness = read_lobes(with(stiffness));
  ASSERT_EQ(by_stiffness.problem.dynamics.modes.size(), 2U);
  for (std::size_t k = 0; k < 2; ++k) {
    const modal::Mode &a = by_mass.problem.dynamics.modes[k], &b = by_stiffness.problem.dynamics.modes[k];
    EXPECT_LT((a.right - b.right).norm(), 1e-14 * a.right.norm());
    EXPECT_LT((a.left - b.left).norm(), 1e-14 * a.left.norm());
  }
  const auto said = [&](const std::string& told) {
    return test::rejection([&] { static_cast<void>(read_lobes(with(told))); });
  };
  EXPECT_NE(said(mass + ", " + stiffness).find("modal_stiffness_n_per_um"), std::string::npos);
  EXPECT_NE(said(mass + ", " + stiffness).find("must not stand beside modal_mass_kg"), std::string::npos);
  EXPECT_NE(said("weight = 1").find("modal_stiffness_n_per_um"), std::string::npos) << said("weight = 1");
  EXPECT_NE(said("modal_stiffness_n_per_um = 0").find("must be > 0"), std::string::npos);
  EXPECT_NE(said("modal_stiffness_n_per_um = -3").find("must be > 0"), std::string::npos);
}

// A direction of the plane that nobody measured is rigid, or like the other, only where the file says so.
TEST(LobesToml, ADirectionThatIsMissingHasToBeSaid) {
  const test::Folder folder;
  const std::string mode = "[{ frequency_hz = 922, damping_ratio = 0.011, modal_mass_kg = 0.03993 }]\n";
  const std::string cut = good.substr(0, good.find("x = "));
  const std::string chart = good.substr(good.find("[lobes]"));
  const auto loaded = [&](const std::string& dynamics) {
    LobesFile file = read_lobes(folder.file("lobes.toml", cut + dynamics + chart));
    load_dynamics(file);
    return file;
  };
  const auto said = [&](const std::string& dynamics) {
    return test::rejection([&] { static_cast<void>(loaded(dynamics)); });
  };
  folder.file("x.toml",
              "[[modes]]\nfrequency_hz = 922\ndamping_ratio = 0.011\nleft = { x = [1, 0] }\n"
              "right = { x = [0, -1e-4] }\n");
  folder.file("x.csv", "frequency_hz,xx_re_m_per_n,xx_im_m_per_n\n100,1e-6,-1e-8\n200,2e-6,-3e-8\n");
  for (const std::string& source :
       {"x = " + mode, std::string("modes = \"x.toml\"\n"), std::string("frf = \"x.csv\"\n")}) {
    const std::string open = said(source);
    EXPECT_NE(open.find("lobes.toml: dynamics: nothing is known of y"), std::string::npos) << open;
    const LobesFile rigid = loaded(source + "rigid_directions = [\"y\"]\n");
    EXPECT_EQ(rigid.assumed.back().taken, "rigid");
    EXPECT_EQ(rigid.assumed.back().key, "dynamics.rigid_directions");
    const LobesFile equal = loaded(source + "equal_directions = true\n");
    EXPECT_EQ(equal.problem.dynamics.modes.size() + equal.problem.measured.frfs.size(), 2U);
    EXPECT_EQ(equal.assumed.back().key, "dynamics.equal_directions");
    EXPECT_EQ(equal.assumed.back().file, "lobes.toml");
    const std::string wrong = said(source + "rigid_directions = [\"x\"]\n");
    EXPECT_NE(wrong.find("dynamics.rigid_directions: names x, which was measured"), std::string::npos) << wrong;
  }
  EXPECT_TRUE(loaded("x = " + mode + "y = []\n").assumed.empty()) << "an empty list says it";
  EXPECT_TRUE(loaded("x = " + mode + "y = " + mode).assumed.empty());
  EXPECT_NE(said("x = " + mode + "y = " + mode + "equal_directions = true\n").find("dynamics.equal_directions"),
            std::string::npos);
  EXPECT_NE(said("x = " + mode + "rigid_directions = [\"z\"]\n").find("dynamics.rigid_directions"), std::string::npos);
}

TEST(LobesToml, AnglesStandInForTheDirection) {
  const test::Folder folder;
  const LobesFile file = read_lobes(
      folder.file("lobes.toml", with("direction = \"down\"\nradial_depth_mm = 1.2", "entry_deg = 0\nexit_deg = 90")));
  EXPECT_NEAR(file.radial_depth_m, 6e-3, 1e-15);
  EXPECT_FALSE(file.direction);
  const LobesFile slot = read_lobes(
      folder.file("lobes.toml", with("direction = \"down\"\nradial_depth_mm = 1.2", "direction = \"slot\"")));
  EXPECT_NEAR(slot.radial_depth_m, 12e-3, 1e-15);
  EXPECT_EQ(slot.direction, cutting::MillingDirection::slot);
}

TEST(LobesToml, ReadsWhatElseActsInTheCut) {
  const test::Folder folder;
  const std::string text = with("helix_deg = 30", "helix_deg = [30, 35]\nrunout_um = 5\nrunout_angle_deg = 90") + R"(
[process_damping]
indentation_n_per_mm3 = 40000
wear_land_mm = 0.08
friction = 0.25
[speed_variation]
amplitude_ratio = 0.1
frequency_ratio = 0.25
[workpiece_dynamics]
y = [{ frequency_hz = 300, damping_ratio = 0.02, modal_mass_kg = 2 }]
[uncertainty]
tangential_std_n_per_mm2 = 30
frequency_std_ratio = 0.01
grid = [20, 10]
[surface_error]
)";
  const LobesFile file = read_lobes(folder.file("lobes.toml", text));
  EXPECT_NO_THROW(file.validate());
  const cutting::Milling& milling = file.problem.milling;
  EXPECT_EQ(milling.tool.tooth_helix_rad, (std::vector<double>{30 * units::deg, 35 * units::deg}));
  EXPECT_DOUBLE_EQ(milling.tool.runout_m, 5e-6);
  EXPECT_DOUBLE_EQ(milling.tool.runout_angle_rad, std::numbers::pi / 2);
  EXPECT_DOUBLE_EQ(milling.process_damping.indentation_n_per_m3, 4e13);
  EXPECT_DOUBLE_EQ(milling.process_damping.wear_land_m, 8e-5);
  EXPECT_DOUBLE_EQ(milling.process_damping.friction, 0.25);
  EXPECT_DOUBLE_EQ(milling.speed_variation.amplitude_ratio, 0.1);
  EXPECT_DOUBLE_EQ(milling.speed_variation.frequency_ratio, 0.25);
  EXPECT_EQ(file.problem.workpiece_dynamics.modes.size(), 1U);
  EXPECT_EQ(file.uncertainty.samples, 200);
  EXPECT_DOUBLE_EQ(file.uncertainty.tangential_std_n_per_m2, 3e7);
  EXPECT_EQ(file.uncertainty.grid, (std::array<int, 2>{20, 10}));
  EXPECT_EQ(file.surface_grid, (std::array<int, 2>{60, 60}));
  const auto rejected = [&](const std::string& row, const std::string& words) {
    const std::string said =
        test::rejection([&] { static_cast<void>(read_lobes(folder.file("bad.toml", good + row))); });
    EXPECT_NE(said.find(words), std::string::npos) << said;
  };
  rejected("[process_damping]\nwear_land_mm = 5\n", "bad.toml:22: process_damping.wear_land_mm = 5 mm; is longer");
  rejected("[speed_variation]\namplitude_ratio = 10\n",
           "speed_variation.amplitude_ratio = 10; must be >= 0 and <= 0.9");
  rejected("[speed_variation]\namplitude_ratio = 0.1\n", "frequency_ratio");
  rejected("[uncertainty]\nsamples = 3\n", "uncertainty.samples = 3; must be >= 20 and <= 1e+06");
  rejected("[uncertainty]\ndamping_std_ratio = 10\n", "It is a share of the value, not a percentage");
  rejected("[surface_error]\ngrid = [1, 2]\n", "surface_error.grid[1] = 1; must be >= 2");
  rejected("[workpiece_dynamics]\nmass_kg = 2\n", "workpiece_dynamics.mass_kg");
}

TEST(LobesToml, RejectsInTheFilesWords) {
  const test::Folder folder;
  const auto say = [&](const std::string& text) {
    return test::rejection([&] { read_lobes(folder.file("lobes.toml", text)).validate(); });
  };
  const auto expect = [&](const std::string& old_text, const std::string& new_text, const std::string& words) {
    const std::string said = say(with(old_text, new_text));
    EXPECT_NE(said.find(words), std::string::npos) << said;
  };
  expect("teeth = 2", "teeth = 0", "lobes.toml:2: tool.teeth = 0");
  expect("radial_depth_mm = 1.2", "radial_depth_mm = 13", "lobes.toml:7: cut.radial_depth_mm = 13 mm");
  expect("tangential_n_per_mm2 = 600", "tangential_n_per_mm2 = 0.6",
         "lobes.toml:11: coefficients.tangential_n_per_mm2 = 0.6 N/mm^2");
  expect("tangential_n_per_mm2 = 600", "tangential_n_per_mm2 = 6e8",
         "coefficients.tangential_n_per_mm2 = 6e+08 N/mm^2");
  expect("axial_depth_mm = [0, 5]", "axial_depth_mm = [0, 1000]", "lobes.axial_depth_mm = 1000 mm");
  expect("spindle_speed_rpm = [5000, 25000]", "spindle_speed_rpm = [5000, 5000]", "lobes.spindle_speed_rpm = 5000 rpm");
  expect("damping_ratio = 0.011", "damping_ratio = -0.011", "damping_ratio = -0.011");
  expect("method = \"semi-discretization\"", "method = \"guess\"", "must be one of \"collocation\"");
  expect("helix_deg = 30", "pitch_deg = [170, 180]", "lobes.toml:4: tool.pitch_deg: must sum to one revolution");
  expect("helix_deg = 30", "pitch_deg = [120, 120, 120]", "must have one entry for each tooth (2)");
  expect("helix_deg = 30", "pitch_deg = [-10, 370]", "lobes.toml:4: tool.pitch_deg[1] = -10 deg; must be > 0");
  expect("helix_deg = 30", "helix_deg = 100", "lobes.toml:4: tool.helix_deg = 100 deg");
  expect("diameter_mm = 12", "diameter_mm = 0", "lobes.toml:3: tool.diameter_mm = 0 mm; must be > 0");
  expect("grid = [30, 20]", "grid = [30, 1]", "lobes.toml:19: lobes.grid[2] = 1; must be >= 2");
  expect("grid = [30, 20]", "intervals = 2", "lobes.intervals = 2; must be >= 4");
  expect("grid = [30, 20]", "tolerance = 0", "lobes.tolerance = 0");
  expect("direction = \"down\"\nradial_depth_mm = 1.2", "entry_deg = 10\nexit_deg = 190", "cut.exit_deg = 190 deg");
  expect("direction = \"down\"\nradial_depth_mm = 1.2", "entry_deg = 10", "cut.exit_deg: is missing");
  expect("radial_depth_mm = 1.2\n", "", "cut.radial_depth_mm");
  expect("teeth = 2", "teth = 2", "tool.teeth");
  expect("[dynamics]", "[dynamics]\nmodes = \"m.json\"", "only one of modes, frf");
  expect("[dynamics]", "[dynamics]\nkeep_modes = [3]", "lobes.toml:14: dynamics.keep_modes");
}

/// A ball end, of which a line is replaced.
std::string ball_without(const std::string& line, const std::string& by) {
  const std::string text =
      "[tool]\nkind = \"ball-end\"\nteeth = 2\ndiameter_mm = 6\nhelix_deg = 30\n[cut]\ndirection = \"up\"\n"
      "stepover_mm = 0.8\nlead_deg = -10\nfeed_per_tooth_mm = 0.05\n[coefficients]\ntangential_n_per_mm2 = 1500\n"
      "radial_n_per_mm2 = [100, 900]\naxial_n_per_mm2 = 300\n[dynamics]\naxes = \"tool\"\nx = [{ frequency_hz = 850, "
      "damping_ratio = 0.02, modal_mass_kg = 0.06 }]\ny = []\n[lobes]\nspindle_speed_rpm = [8000, 24000]\n"
      "axial_depth_mm = [0, 1]\n";
  return line.empty() ? text : test_support::replaced(text, line, by);
}

TEST(LobesToml, ReadsAnyCutterInAnyPosture) {
  const test::Folder folder;
  const LobesFile file = read_lobes(folder.file("lobes.toml", ball_without("", "")));
  ASSERT_TRUE(file.problem.spatial);
  const stability::SpatialMilling& milling = *file.problem.spatial;
  EXPECT_EQ(milling.cutter.kind, cutting::CutterKind::ball_end);
  EXPECT_NEAR(milling.cut.lead_rad, -10.0 * units::deg, 1e-12);
  EXPECT_NEAR(milling.cut.radial_depth_m, 0.8e-3, 1e-15);
  EXPECT_EQ(milling.coefficients.radial_n_per_m2.size(), 2U);
  EXPECT_TRUE(milling.modes_turn_with_tool);
  EXPECT_THROW(require_plane(file), InvalidInput);
}

TEST(LobesToml, RejectsWhatASweepCannotDo) {
  const test::Folder folder;
  const std::string sweep = "sweep = \"radial_depth\"\nradial_depth_mm = [0.1, 0.8]\n";
  const std::string text = test_support::replaced(ball_without("axial_depth_mm = [0, 1]\n", sweep), "lead_deg = -10",
                                                  "axial_depth_mm = 0.2");
  const LobesFile file = read_lobes(folder.file("lobes.toml", text));
  EXPECT_NEAR(file.problem.spatial->cut.radial_depth_m, 0.8e-3, 1e-15);
  EXPECT_NEAR(file.sweep_range[0], 0.1e-3, 1e-15);
  const std::pair<std::array<std::string, 2>, std::string> cases[] = {
      {{"direction = \"up\"", "direction = \"slot\""},
       "lobes.sweep = \"radial_depth\"; must not be the step-over of a slot"},
      {{"[lobes]", "[lobes]\nmethod = \"zeroth-order\""}, "lobes.method = \"zeroth-order\"; does not go with a sweep"},
      {{"[lobes]", "[uncertainty]\nsamples = 20\n[lobes]"}, "uncertainty"},
      {{"direction = \"up\"", "kind = \"drilling\"\nfeed_per_revolution_mm = 0.1"}, "is no part of drilling"}};
  for (const auto& [change, expected] : cases) {
    const auto path = folder.file("lobes.toml", test_support::replaced(text, change[0], change[1]));
    const std::string said = test::rejection([&] { static_cast<void>(read_lobes(path)); });
    EXPECT_NE(said.find(expected), std::string::npos) << said;
  }
}

TEST(LobesToml, NamesWhatACutInThreeDirectionsLacks) {
  const test::Folder folder;
  const std::pair<std::array<std::string, 2>, std::string> cases[] = {
      {{"stepover_mm = 0.8", ""}, "lobes.toml:6: cut.radial_depth_mm: is missing"},
      {{"direction = \"up\"", "direction = \"up\"\nentry_deg = 10"},
       "cut.entry_deg = 10 deg; is for an upright flat end"},
      {{"axial_depth_mm = [0, 1]", "sweep = \"lead\"\nlead_deg = [-10, 10]"}, "cut.axial_depth_mm: is missing"},
      {{"axial_depth_mm = [0, 1]", "sweep = \"speed\""}, "lobes.sweep"},
      {{"axial_depth_mm = [0, 1]", "axial_depth_mm = [0, 20]"}, "axial_depth"},
      {{"axial_n_per_mm2 = 300", "axial_n_per_mm2 = 0.3"}, "coefficients.axial_n_per_mm2 = 0.3 N/mm^2"},
      {{"feed_per_tooth_mm = 0.05", "feed_per_tooth_mm = 0.05\n[process_damping]\nfriction = 0.3"}, "process_damping"},
      {{"axes = \"tool\"", "axes = \"base\""}, "dynamics.axes"},
      {{"[lobes]",
        "[workpiece_dynamics]\nx = [{ frequency_hz = 300, damping_ratio = 0.02, modal_mass_kg = 9 }]\n[lobes]"},
       "a part does not lean with the tool"},
      {{"helix_deg = 30", "helix_deg = 30\ncorner_radius_mm = 1"}, "tool.corner_radius_mm"}};
  for (const auto& [change, expected] : cases) {
    const auto path = folder.file("lobes.toml", ball_without(change[0], change[1]));
    const std::string said = test::rejection([&] { static_cast<void>(read_lobes(path)); });
    EXPECT_NE(said.find(expected), std::string::npos) << said;
  }
}

// What other programs and catalogues call it is answered with the key that is meant.
TEST(LobesToml, RejectsWhatItsOwnKeysContradict) {
  const test::Folder folder;
  const auto say = [&](const std::string& old_text, const std::string& new_text) {
    const auto path = folder.file("lobes.toml", with(old_text, new_text));
    return test::rejection([&] { static_cast<void>(read_lobes(path)); });
  };
  const std::string cut = "direction = \"down\"\nradial_depth_mm = 1.2";
  const std::array<std::string, 3> cases[] = {
      {cut, "direction = \"slot\"\nradial_depth_mm = 1.2",
       "contradicts cut.direction = \"slot\", whose width is the diameter"},
      {cut, "entry_deg = 0\nexit_deg = 90\nradial_depth_mm = 1.2", "contradicts the radial depth"},
      {"teeth = 2", "teeth = 2\ncutting_height_mm = 3", "goes deeper than the edges reach, 3 mm"}};
  for (const auto& [old_text, new_text, expected] : cases) {
    const std::string said = say(old_text, new_text);
    EXPECT_NE(said.find(expected), std::string::npos) << said;
  }
  EXPECT_NO_THROW(
      static_cast<void>(read_lobes(folder.file("lobes.toml", with("teeth = 2", "teeth = 2\ncutting_height_mm = 30")))));
}

// A flat end cuts with its side, κ = 90 degrees; what [cut] and [coefficients] have for forces takes no part in a
// chart.
TEST(LobesToml, TakesTheTablesOfForces) {
  const test::Folder folder;
  const auto read = [&](const std::string& old_text, const std::string& new_text) {
    return read_lobes(folder.file("lobes.toml", with(old_text, new_text)));
  };
  const LobesFile polynomial = read("tangential_n_per_mm2 = 600", "tangential_n_per_mm2 = [100, 600]");
  EXPECT_NEAR(polynomial.problem.milling.coefficients.tangential_n_per_m2, (600 + 50 * std::numbers::pi) * 1e6, 1.0);
  const LobesFile file = read("radial_n_per_mm2 = 200",
                              "radial_n_per_mm2 = 200\naxial_edge_n_per_mm = 3\ntangential_edge_n_per_mm = 20\n"
                              "edge_per = \"edge-length\"");
  EXPECT_FALSE(file.problem.spatial);
  EXPECT_NEAR(file.problem.milling.coefficients.tangential_edge_n_per_m, 20e3 / std::cos(30 * units::deg), 1e-6);
  const LobesFile cut = read("feed_direction_deg = 90",
                             "feed_direction_deg = 90\naxial_depth_mm = 2\nspindle_speed_rpm = 9000\n"
                             "force_on = \"workpiece\"\nsurface_radius_along_feed_mm = -50");
  EXPECT_DOUBLE_EQ(cut.problem.milling.immersion.exit_rad,
                   read_lobes(folder.file("l.toml", good)).problem.milling.immersion.exit_rad);
  const auto say = [&](const std::string& old_text, const std::string& new_text) {
    return test::rejection([&] { static_cast<void>(read(old_text, new_text)); });
  };
  EXPECT_NE(
      say("[coefficients]", "axial_depth_mm = -2\n[coefficients]").find("lobes.toml:10: cut.axial_depth_mm = -2 mm"),
      std::string::npos);
  EXPECT_NE(say("[lobes]", "[lobes]\nlead_deg = [0, 5]").find("lobes.lead_deg: goes with sweep = \"lead\""),
            std::string::npos)
      << say("[lobes]", "[lobes]\nlead_deg = [0, 5]");
  EXPECT_NE(say("[dynamics]", "[dynamics]\naxes = \"flange\"").find("must be \"feed\" or \"tool\""), std::string::npos);
  EXPECT_NE(say("[dynamics]", "[dynamics]\naxis = \"feed\"").find("Did you mean dynamics.axes?"), std::string::npos);
}

// A table of another reader takes no part, and the file says so where it looks as if it did.
TEST(LobesToml, SaysThatASpindleNeedsAJob) {
  const test::Folder folder;
  const LobesFile read = read_lobes(folder.file("lobes.toml", good + "[spindle]\nmax_speed_rpm = 9000\n"));
  ASSERT_FALSE(read.notes.empty());
  EXPECT_NE(read.notes.front().find("[spindle] takes no part in a chart without [job]"), std::string::npos);
}

TEST(LobesToml, AnswersSynonymsWithTheRightKey) {
  const test::Folder folder;
  const auto say = [&](const std::string& old_text, const std::string& new_text) {
    const auto path = folder.file("lobes.toml", with(old_text, new_text));
    return test::rejection([&] { static_cast<void>(read_lobes(path)); });
  };
  const std::array<std::string, 3> cases[] = {
      {"teeth = 2", "flutes = 2", "lobes.toml:2: tool.flutes: is not known here. Here it is teeth"},
      {"teeth = 2", "teeth = 2\nflutes = 2", "lobes.toml:3: tool.flutes: is not known here. Here it is teeth"},
      {"radial_depth_mm = 1.2", "ae_mm = 1.2", "cut.ae_mm: is not known here. Here it is radial_depth_mm"},
      {"feed_per_tooth_mm", "fz", "cut.fz: is not known here. Here it is feed_per_tooth_mm"},
      {"axial_depth_mm = [0, 5]", "ap = [0, 5]", "lobes.ap: is not known here. Here it is axial_depth_mm"},
      {"[coefficients]", "ap_mm = 2\n[coefficients]", "cut.ap_mm: is not known here. Here it is axial_depth_mm"},
      {"[coefficients]", "vc = 200\n[coefficients]",
       "cut.vc: is not known here. Here it is spindle_speed_rpm = 1000 vc / (pi diameter_mm)"},
      {"\"down\"", "\"Climb\"", "must be one of \"up\", \"down\", \"slot\". Climb milling is \"down\" here"},
      {"\"down\"", "\"conventional\"", "Conventional milling is \"up\" here"},
      {"direction = \"down\"", "climb = true", "cut.climb: is not known here. Here it is direction = \"down\""}};
  for (const auto& [old_text, new_text, expected] : cases) {
    const std::string said = say(old_text, new_text);
    EXPECT_NE(said.find(expected), std::string::npos) << said;
  }
}

}  // namespace lobes_toml_test
}  // namespace robomill::jobs
