#include "robomill/cutting/files/coefficients_toml.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <string>
#include <vector>

#include "robomill/cutting/material.hpp"
#include "robomill/io/toml_file.hpp"
#include "testing/support.hpp"

namespace robomill::cutting {
namespace coefficients_toml_test {

constexpr double degree = std::numbers::pi / 180.0;

MillingCoefficients table_of(const test::Folder& folder, const std::string& text) {
  io::TomlFile file(folder.file("forces.toml", text));
  return read_coefficient_table(file);
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
    const MillingCoefficients k = milling_coefficients(material("Ti6Al4V"), 5.0 * degree, helix_deg * degree, 0.03e-3);
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

TEST(CoefficientsToml, RejectsInTheFilesWords) {
  const test::Folder folder;
  const auto expect = [&](const std::string& text, const std::string& words) {
    const std::string said = test::rejection([&] { static_cast<void>(table_of(folder, "[coefficients]\n" + text)); });
    EXPECT_NE(said.find(words), std::string::npos) << said;
  };
  expect("radial_n_per_mm2 = 3\n", "coefficients.tangential_n_per_mm2: is missing");
  expect("material = \"cheese\"\nrake_deg = 5\nchip_thickness_mm = 0.03\nhelix_deg = 0\n",
         "forces.toml:2: coefficients.material = \"cheese\"; must be one of Ti6Al4V");
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
