#include "robomill/cutting/files/coefficients_toml.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "robomill/cutting/files/materials_toml.hpp"
#include "robomill/cutting/material.hpp"
#include "robomill/io/toml/file.hpp"
#include "testing/support.hpp"

namespace robomill::cutting {
namespace coefficients_toml_test {

constexpr double degree = std::numbers::pi / 180.0;

CoefficientTable whole_table_of(const test::Folder& folder, const std::string& text, const CutAtHand& cut = {}) {
  io::TomlFile file(folder.file("forces.toml", text));
  return read_coefficient_table(file, cut);
}

MillingCoefficients table_of(const test::Folder& folder, const std::string& text, const CutAtHand& cut = {}) {
  return whole_table_of(folder, text, cut).coefficients;
}

TEST(CoefficientsToml, NumbersAndPolynomials) {
  const test::Folder folder;
  const MillingCoefficients k =
      table_of(folder,
               "[coefficients]\ntangential_n_per_mm2 = [325.4, 435.8, -65.25, 1772]\nradial_n_per_mm2 = 287\n"
               "axial_edge_n_per_mm = -11.52\n");
  EXPECT_EQ(k.tangential_n_per_m2, (std::vector<double>{325.4e6, 435.8e6, -65.25e6, 1772e6}));
  EXPECT_EQ(k.radial_n_per_m2, std::vector<double>{287e6});
  EXPECT_DOUBLE_EQ(k.axial_edge_n_per_m.front(), -11.52e3);
  EXPECT_TRUE(k.axial_n_per_m2.empty());
}

TEST(CoefficientsToml, WhatIsWrittenIsReadAgain) {
  const test::Folder folder;
  MillingCoefficients k;
  k.tangential_n_per_m2 = {325.4e6, 435.8e6, -65.25e6, 1772e6};
  k.radial_edge_n_per_m = {15.43e3};
  folder.file("k.toml", coefficients_toml(k) + "[identification]\nrows = 5\n");
  const MillingCoefficients read = table_of(folder, "[coefficients]\nfile = \"k.toml\"\n");
  ASSERT_EQ(read.tangential_n_per_m2.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_DOUBLE_EQ(read.tangential_n_per_m2[i], k.tangential_n_per_m2[i]);
  EXPECT_DOUBLE_EQ(read.radial_edge_n_per_m.front(), 15.43e3);
  EXPECT_TRUE(read.axial_edge_n_per_m.empty());
  EXPECT_EQ(read.edge_measure, EdgeMeasure::by_kind);
  for (const EdgeMeasure measure : {EdgeMeasure::width, EdgeMeasure::edge_length}) {
    k.edge_measure = measure;
    EXPECT_EQ(table_of(folder, coefficients_toml(k)).edge_measure, measure);
  }
}

TEST(CoefficientsToml, AMaterialTakesTheToolsHelix) {
  const test::Folder folder;
  const std::string named = "[coefficients]\nmaterial = \"Ti6Al4V\"\nrake_deg = 5\nchip_thickness_mm = 0.03\n";
  const auto expect_helix = [&](const MillingCoefficients& found, double helix_deg) {
    const MillingCoefficients k =
        milling_coefficients(*material("Ti6Al4V").orthogonal, 5.0 * degree, helix_deg * degree, 0.03e-3);
    EXPECT_DOUBLE_EQ(found.tangential_n_per_m2.front(), k.tangential_n_per_m2.front());
    EXPECT_DOUBLE_EQ(found.axial_n_per_m2.front(), k.axial_n_per_m2.front());
    EXPECT_EQ(found.radial_edge_n_per_m, k.radial_edge_n_per_m);
  };
  expect_helix(table_of(folder, "[tool]\nhelix_deg = 30\n" + named), 30.0);
  expect_helix(table_of(folder, "[tool]\nteeth = 2\n" + named), 0.0);
  expect_helix(table_of(folder, "[tool]\nhelix_deg = [30, 35]\n" + named + "helix_deg = 32\n"), 32.0);
  folder.file("k.toml", named + "helix_deg = 40\n");
  expect_helix(table_of(folder, "[tool]\nhelix_deg = 30\n[coefficients]\nfile = \"k.toml\"\n"), 40.0);
}

// Orthogonal tests show little of a cutter's edge: what was measured replaces it, one direction at a time.
TEST(CoefficientsToml, AMaterialTakesEdgeCoefficientsOfItsOwn) {
  const test::Folder folder;
  const std::string named =
      "[coefficients]\nmaterial = \"Ti6Al4V\"\nrake_deg = 5\nchip_thickness_mm = 0.03\nhelix_deg = 30\n";
  const MillingCoefficients plain = table_of(folder, named);
  const MillingCoefficients own =
      table_of(folder, named + "tangential_edge_n_per_mm = 19\naxial_edge_n_per_mm = 2\nedge_per = \"width\"\n");
  EXPECT_EQ(own.tangential_n_per_m2, plain.tangential_n_per_m2);
  EXPECT_EQ(own.axial_n_per_m2, plain.axial_n_per_m2);
  EXPECT_EQ(own.tangential_edge_n_per_m, std::vector<double>{19e3});
  EXPECT_EQ(own.radial_edge_n_per_m, plain.radial_edge_n_per_m);
  EXPECT_EQ(own.axial_edge_n_per_m, std::vector<double>{2e3});
  EXPECT_EQ(own.edge_measure, EdgeMeasure::width);
  EXPECT_NE(plain.edge_measure, EdgeMeasure::width);
}

TEST(CoefficientsToml, ANameAloneTakesAPublishedSet) {
  const test::Folder folder;
  const CoefficientTable table = whole_table_of(folder, "coefficients = \"AL 7075\"\n");
  EXPECT_EQ(table.coefficients.tangential_n_per_m2, std::vector<double>{1319.41e6})
      << "of its five sets the one with the largest force";
  EXPECT_EQ(table.coefficients.radial_n_per_m2, std::vector<double>{788.83e6});
  EXPECT_EQ(table.coefficients.tangential_edge_n_per_m, std::vector<double>{19.65e3});
  EXPECT_EQ(table.coefficients.radial_edge_n_per_m, std::vector<double>{26.77e3});
  ASSERT_TRUE(table.published);
  EXPECT_EQ(table.published->source, "AviationAluminum2021");
  EXPECT_GT(table.std_ratio, 0.0);
  EXPECT_FALSE(table.notes.empty());
  const CoefficientTable other = whole_table_of(folder, "[coefficients]\nmaterial = \"7075-t6\"\nset = 4\n");
  EXPECT_EQ(other.published->cutter, "HSS, dry, 7075");
  ASSERT_EQ(other.coefficients.radial_n_per_m2.size(), 1U);
  EXPECT_DOUBLE_EQ(other.coefficients.radial_n_per_m2.front(), 262.597e6);
  const CoefficientTable own = whole_table_of(
      folder, "[coefficients]\nmaterial = \"7075-t6\"\ntangential_edge_n_per_mm = 12\nedge_per = \"width\"\n");
  EXPECT_EQ(own.coefficients.tangential_n_per_m2, table.coefficients.tangential_n_per_m2);
  EXPECT_EQ(own.coefficients.tangential_edge_n_per_m, std::vector<double>{12e3});
  EXPECT_EQ(own.coefficients.radial_edge_n_per_m, table.coefficients.radial_edge_n_per_m);
  EXPECT_EQ(own.coefficients.edge_measure, EdgeMeasure::width);
  EXPECT_TRUE(whole_table_of(folder, "[coefficients]\ntangential_n_per_mm2 = 700\n").notes.empty());
}

// The note says by what the set was taken.
TEST(CoefficientsToml, TheLargestForceChoosesAmongSetsThatServeAlike) {
  for (const Material& known : materials()) {
    if (known.coefficients.size() < 2) continue;
    const std::size_t alike = sets_alike(known, CutterKind::flat_end);
    EXPECT_GE(alike, 1U) << known.name;
    EXPECT_LE(alike, known.coefficients.size()) << known.name;
    if (!known.coefficients[*best_set(known, CutterKind::flat_end)].has_radial()) continue;
    const test::Folder folder;
    const CoefficientTable table = whole_table_of(folder, "coefficients = \"" + known.name + "\"\n");
    const bool by_force = table.notes.front().find("with the largest force") != std::string::npos;
    EXPECT_EQ(by_force, alike > 1) << table.notes.front();
  }
}

TEST(CoefficientsToml, AMaterialIsScaled) {
  const test::Folder folder;
  const CoefficientTable as_it_is = whole_table_of(folder, "[coefficients]\nmaterial = \"7075-t6\"\n");
  const CoefficientTable harder = whole_table_of(folder, "[coefficients]\nmaterial = \"7075-t6\"\nscale = 1.25\n");
  EXPECT_DOUBLE_EQ(harder.coefficients.tangential_n_per_m2.front(),
                   1.25 * as_it_is.coefficients.tangential_n_per_m2.front());
  EXPECT_DOUBLE_EQ(harder.coefficients.radial_edge_n_per_m.front(),
                   1.25 * as_it_is.coefficients.radial_edge_n_per_m.front());
  EXPECT_EQ(harder.std_ratio, as_it_is.std_ratio);
  EXPECT_EQ(harder.notes.size(), as_it_is.notes.size() + 1);
  const auto say = [&](const std::string& table) {
    return test::rejection([&] { static_cast<void>(whole_table_of(folder, table)); });
  };
  EXPECT_NE(say("[coefficients]\nmaterial = \"7075-t6\"\nscale = 0\n").find("must be > 0 and <= 10"),
            std::string::npos);
  EXPECT_NE(say("[coefficients]\ntangential_n_per_mm2 = 700\nscale = 2\n").find("must stand beside a material"),
            std::string::npos);
}

TEST(CoefficientsToml, APowerLawIsTakenAtTheMeanChip) {
  const test::Folder folder;
  const std::string named = "[coefficients]\nmaterial = \"1045\"\nradial_ratio = 0.4\n";
  const auto expect_at = [&](const MillingCoefficients& k, double chip_m) {
    const double secant = 1500e6 * std::pow(chip_m / 1e-3, -0.22);
    EXPECT_NEAR(k.tangential_n_per_m2.front(), 0.78 * secant, 1.0);
    EXPECT_NEAR(k.tangential_edge_n_per_m.front(), 0.22 * secant * chip_m, 1e-6);
    EXPECT_NEAR(k.radial_n_per_m2.front(), 0.4 * 0.78 * secant, 1.0);
    EXPECT_NEAR(k.radial_edge_n_per_m.front(), 0.4 * 0.22 * secant * chip_m, 1e-6);
  };
  expect_at(table_of(folder, named, {.mean_chip_thickness_m = 0.04e-3}), 0.04e-3);
  expect_at(table_of(folder, named + "chip_thickness_mm = 0.03\n", {.mean_chip_thickness_m = 0.04e-3}), 0.03e-3);
}

// [Goli2018] had 754 m/min and chips from 41 to 91 um, [Palubicki2021] 1.5 mm a tooth.
TEST(CoefficientsToml, SaysWhatLeavesTheTests) {
  const test::Folder folder;
  const CoefficientTable board =
      whole_table_of(folder, "[coefficients]\nmaterial = \"mdf\"\nset = 1\nradial_ratio = 0.3\n");
  EXPECT_DOUBLE_EQ(board.std_ratio, 2.68 / 31.44) << "its tests' own before that of the sets";
  EXPECT_NE(board.notes[1].find("from 25.81 to 35.58 N/mm^2"), std::string::npos) << board.notes[1];
  const double speed_m_per_s = 754.0 / 60.0;
  EXPECT_TRUE(board.outside({}).empty()) << "nothing is known of the cut";
  EXPECT_TRUE(board
                  .outside({.mean_chip_thickness_m = 0.05e-3,
                            .feed_per_tooth_m = 5e-3,
                            .cutting_speed_m_per_s = {speed_m_per_s, speed_m_per_s}})
                  .empty());
  EXPECT_EQ(board.outside({.mean_chip_thickness_m = 0.03e-3, .cutting_speed_m_per_s = {speed_m_per_s, 20.0}}).size(),
            2U);
  const CoefficientTable chips =
      whole_table_of(folder, "[coefficients]\nmaterial = \"particleboard\"\nset = 1\nradial_ratio = 0.3\n");
  ASSERT_EQ(chips.outside({.feed_per_tooth_m = 0.5e-3}).size(), 1U);
  EXPECT_EQ(chips.outside({.feed_per_tooth_m = 0.5e-3}).front(),
            "A feed per tooth of 0.5 mm lies outside the tests of [Palubicki2021], 1.5 mm: the coefficients are taken "
            "to hold there too.");
}

// [Fullerton] 304.8 to 609.6 m/min and 0.1016 mm at 12.7 mm, [Niagara2016] from 243.84 m/min and the same feed.
TEST(CoefficientsToml, SaysWhatIsUnlikeWhatIsRecommended) {
  const test::Folder folder;
  const CoefficientTable table = whole_table_of(folder, "coefficients = \"6061\"\n");
  const auto notes = [&](FromTo speed_m_per_min, double feed_mm, double diameter_mm) {
    return table.unlike_recommended({.feed_per_tooth_m = feed_mm * 1e-3,
                                     .cutting_speed_m_per_s = {speed_m_per_min[0] / 60.0, speed_m_per_min[1] / 60.0},
                                     .diameter_m = diameter_mm * 1e-3});
  };
  EXPECT_TRUE(table.unlike_recommended({}).empty()) << "nothing is known of the cut";
  EXPECT_TRUE(notes({300.0, 300.0}, 0.1, 12.7).empty());
  EXPECT_TRUE(notes({100.0, 250.0}, 0.06, 12.7).empty()) << "a chart that reaches into a range";
  EXPECT_EQ(notes({200.0, 240.0}, 0.1, 12.7),
            std::vector<std::string>{"A cutting speed of 200 to 240 m/min is none that is recommended for 6061-t6: 305 "
                                     "to 610 [Fullerton], 244 to 610 [Niagara2016] m/min."});
  EXPECT_EQ(notes({300.0, 300.0}, 0.05, 12.7),
            std::vector<std::string>{"A feed per tooth of 0.05 mm is less than half of what is recommended for 6061-t6 "
                                     "at 12.7 mm: 0.102 [Fullerton], 0.102 [Niagara2016] mm."});
  EXPECT_EQ(notes({620.0, 700.0}, 0.3, 12.7).size(), 2U);
  // Between 6.35 mm with 0.0508 mm and 12.7 mm with 0.1016 mm a straight line; beyond 25.4 mm as at 25.4 mm.
  EXPECT_TRUE(notes({300.0, 300.0}, 0.0382, 9.525).empty());
  EXPECT_EQ(notes({300.0, 300.0}, 0.038, 9.525).size(), 1U);
  EXPECT_TRUE(notes({300.0, 300.0}, 0.4, 40.0).empty());
  EXPECT_TRUE(
      whole_table_of(folder, "[coefficients]\ntangential_n_per_mm2 = 700\n")
          .unlike_recommended({.feed_per_tooth_m = 1.0, .cutting_speed_m_per_s = {1e3, 1e3}, .diameter_m = 1e-2})
          .empty());
}

TEST(CoefficientsToml, RejectsAMaterialThatDoesNotServe) {
  const test::Folder folder;
  const auto expect = [&](const std::string& text, const std::string& words) {
    const std::string said = test::rejection([&] { static_cast<void>(table_of(folder, text)); });
    EXPECT_NE(said.find(words), std::string::npos) << said;
  };
  const std::string table = "[coefficients]\nmaterial = ";
  expect("coefficients = \"7075-t66\"\n",
         "forces.toml:1: coefficients = \"7075-t66\"; must be one of 6061-t6, 7075-t6");
  expect("coefficients = \"7075-t66\"\n", "Did you mean 7075-t6?");
  expect("coefficients = \"304\"\n", "is a material of which no force coefficients are known here");
  expect("coefficients = \"1045\"\n", "states the tangential one alone");
  expect("coefficients = \"1045\"\n", "material = \"1045\" and radial_ratio");
  expect("coefficients = 7075\n", "coefficients = 7075; must be text");
  expect(table + "\"1045\"\nradial_ratio = 0.4\n", "coefficients.chip_thickness_mm: is missing");
  expect(table + "\"1045\"\nradial_ratio = 0.4\nchip_thickness_mm = 0\n", "coefficients.chip_thickness_mm = 0");
  expect(table + "\"1045\"\nradial_ratio = -0.1\n", "coefficients.radial_ratio = -0.1; must be >= 0 and <= 2");
  expect(table + "\"1045\"\nset = 2\n", "coefficients.set = 2; must lie between 1 and 1");
  expect(table + "\"7075-t6\"\nradial_ratio = 0.3\n", "coefficients.radial_ratio = 0.3; has no part");
  expect(table + "\"7075-t6\"\nchip_thickness_mm = 0.03\n", "chip_thickness_mm = 0.03 mm; has no part");
  expect(table + "\"7075-t6\"\nrake_deg = 5\nchip_thickness_mm = 0.03\n", "of 7075-t6 none are known");
  expect(table + "\"Ti6Al4V\"\nrake_deg = 5\nchip_thickness_mm = 0.03\nset = 1\n", "coefficients.set = 1; has no part");
  expect(table + "\"7075-t6\"\nhelix_deg = 30\n", "coefficients.helix_deg = 30 deg; goes with rake_deg");
  expect("[coefficients]\ntangential_n_per_mm2 = 700\nradial_ratio = 0.3\n",
         "radial_ratio = 0.3; goes with a material");
  expect("[coefficients]\ntangential_n_per_mm2 = \"700\"\n", "must be a finite number, or a list of them");
}

TEST(CoefficientsToml, RejectsInTheFilesWords) {
  const test::Folder folder;
  const auto expect = [&](const std::string& text, const std::string& words) {
    const std::string said = test::rejection([&] { static_cast<void>(table_of(folder, "[coefficients]\n" + text)); });
    EXPECT_NE(said.find(words), std::string::npos) << said;
  };
  expect("radial_n_per_mm2 = 3\n", "coefficients.tangential_n_per_mm2: is missing");
  expect("material = \"cheese\"\nrake_deg = 5\nchip_thickness_mm = 0.03\nhelix_deg = 0\n",
         "forces.toml:2: coefficients.material = \"cheese\"; must be one of 6061-t6");
  expect("material = \"Ti6Al4V\"\nchip_thickness_mm = 0.03\n", "coefficients.rake_deg");
  expect("material = \"Ti6Al4V\"\nrake_deg = 5\n", "coefficients.chip_thickness_mm");
  expect("material = \"Ti6Al4V\"\nrake_deg = 5\nchip_thickness_mm = 0.03\n", "coefficients.helix_deg");
  expect("material = \"Ti6Al4V\"\nrake_deg = 5\nchip_thickness_mm = 0\nhelix_deg = 30\n",
         "forces.toml:4: coefficients.chip_thickness_mm = 0 mm; must be > 0");
  expect("material = \"Ti6Al4V\"\nrake_deg = 95\nchip_thickness_mm = 0.1\nhelix_deg = 30\n",
         "forces.toml:3: coefficients.rake_deg = 95 deg");
  expect("material = \"Ti6Al4V\"\ntangential_n_per_mm2 = 5\n", "must not stand beside tangential_n_per_mm2");
  expect("material = \"Ti6Al4V\"\nfile = \"k.toml\"\n", "must not stand beside a file");
  expect("file = \"k.toml\"\ntangential_n_per_mm2 = 5\n", "must not stand beside coefficients");
  folder.file("loop.toml", "[coefficients]\nfile = \"loop.toml\"\n");
  expect("file = \"loop.toml\"\n", "loop.toml:2");
  folder.file("odd.toml", "[coefficients]\ntangential_n_per_mm2 = 700\ntangental_edge_n_per_mm = 3\n");
  expect("file = \"odd.toml\"\n", "odd.toml:3");
  expect("file = \"none.toml\"\n", "none.toml");
}

}  // namespace coefficients_toml_test
}  // namespace robomill::cutting
