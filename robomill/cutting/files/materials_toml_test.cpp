#include "robomill/cutting/files/materials_toml.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "robomill/base/units.hpp"
#include "testing/support.hpp"

namespace robomill::cutting {
namespace materials_toml_test {

std::string document(const char* name) {
  std::ifstream file(std::string(ROBOMILL_SOURCE_DIR "/docs/") + name);
  return {std::istreambuf_iterator<char>(file), {}};
}

bool within(double value, double low, double high) {
  return low <= value && value <= high;
}

TEST(MaterialsToml, EveryEntryNamesItsSource) {
  const std::string sources = document("bibliography.md"), formats = document("formats.md");
  const auto expect_source = [&](const Material& known, const std::string& cutter, const std::string& source) {
    EXPECT_FALSE(cutter.empty()) << known.name;
    EXPECT_NE(sources.find("- [" + source + "] "), std::string::npos) << known.name << ": " << source;
  };
  for (const Material& known : materials()) {
    EXPECT_FALSE(known.description.empty()) << known.name;
    EXPECT_NE(formats.find("\n| `" + known.name + "` | "), std::string::npos) << known.name;
    EXPECT_FALSE(known.coefficients.empty() && known.conditions.empty()) << known.name;
    for (const PublishedCoefficients& set : known.coefficients) expect_source(known, set.cutter, set.source);
    for (const CuttingConditions& entry : known.conditions) expect_source(known, entry.cutter, entry.source);
    if (known.orthogonal) expect_source(known, "edge", known.orthogonal->source);
  }
  EXPECT_GE(std::ranges::count_if(materials(), [](const Material& known) { return !known.coefficients.empty(); }), 12);
}

TEST(MaterialsToml, CoefficientsAreOfAPlausibleSize) {
  const auto expect_range = [](const std::optional<FromTo>& range, double low, double high) {
    if (!range) return;
    EXPECT_TRUE(within((*range)[0], 0.0, (*range)[1]) && within((*range)[1], low, high)) << (*range)[1];
  };
  for (const Material& known : materials()) {
    SCOPED_TRACE(known.name);
    for (const PublishedCoefficients& set : known.coefficients) {
      // At a chip of 50 um; a name, a kind of force and a unit gone wrong leave these bounds.
      const MillingCoefficients k = set.at(5e-5);
      const double tangential_n_per_m2 = k.tangential_n_per_m2.front();
      EXPECT_TRUE(within(tangential_n_per_m2, 1e7, 5e9)) << tangential_n_per_m2;
      for (const double radial_n_per_m2 : k.radial_n_per_m2) {
        EXPECT_TRUE(within(radial_n_per_m2 / tangential_n_per_m2, 0.1, 1.0)) << radial_n_per_m2;
      }
      for (const double axial_n_per_m2 : k.axial_n_per_m2) EXPECT_LT(std::abs(axial_n_per_m2), tangential_n_per_m2);
      for (const auto& edge : {k.tangential_edge_n_per_m, k.radial_edge_n_per_m}) {
        for (const double edge_n_per_m : edge) EXPECT_TRUE(within(edge_n_per_m, 0.0, 1e5)) << edge_n_per_m;
      }
      if (set.tangential_range_n_per_m2) {
        const double stated = set.is_power() ? set.specific_force_n_per_m2 : tangential_n_per_m2;
        EXPECT_TRUE(within(stated, (*set.tangential_range_n_per_m2)[0], (*set.tangential_range_n_per_m2)[1])) << stated;
      }
      EXPECT_LT(set.tangential_std_n_per_m2, 0.5 * tangential_n_per_m2);
      expect_range(set.tested_speed_m_per_s, 0.1, 100.0);
      expect_range(set.tested_feed_per_tooth_m, 1e-6, 5e-3);
      expect_range(set.tested_chip_m, 1e-6, 1e-3);
    }
    EXPECT_LE(spread_of_sets(known).std_ratio, 1.0) << "as a standard deviation of all coefficients";
    for (const CuttingConditions& entry : known.conditions) {
      expect_range(entry.cutting_speed_m_per_s, 0.1, 100.0);
      EXPECT_TRUE(entry.cutting_speed_m_per_s || !entry.feed_per_tooth_m.empty());
      EXPECT_TRUE(std::ranges::is_sorted(entry.diameter_m));
      EXPECT_TRUE(std::ranges::is_sorted(entry.feed_per_tooth_m)) << "a wider cutter takes no less";
      for (const double feed_m : entry.feed_per_tooth_m) EXPECT_TRUE(within(feed_m, 1e-6, 1e-3)) << feed_m;
    }
  }
}

// What coefficients_toml.cpp tells who has to give a ratio.
TEST(MaterialsToml, RadialOverTangentialAsTheMessageSays) {
  std::vector<double> ratios;
  for (const Material& known : materials()) {
    for (const PublishedCoefficients& set : known.coefficients) {
      if (set.has_radial()) ratios.push_back(set.line.radial_n_per_m2.front() / set.line.tangential_n_per_m2.front());
    }
  }
  ASSERT_FALSE(ratios.empty());
  EXPECT_NEAR(*std::ranges::min_element(ratios), 0.16, 0.005);
  EXPECT_NEAR(*std::ranges::max_element(ratios), 0.60, 0.005);
}

// [Du2024] table 3 with its eq. 3: kt 925 N/mm^2, kn 0.26, friction 0.2, helix 35 and rake 15 degrees.
TEST(MaterialsToml, OtherFormsOfAModelAreTurnedIntoOurs) {
  const double helix = 35.0 * units::deg, rake = 15.0 * units::deg;
  const MillingCoefficients& k = material("6061-t6").coefficients.front().line;
  const double tangential = 925e6 * (1.0 + 0.2 * std::tan(helix) * (std::cos(rake) - 0.26 * std::sin(rake)));
  EXPECT_NEAR(k.tangential_n_per_m2.front(), tangential, 0.05e6);
  EXPECT_NEAR(k.radial_n_per_m2.front(), 925e6 * 0.26 / std::cos(helix), 0.05e6);
}

TEST(MaterialsToml, FoundByAnyOfItsNames) {
  EXPECT_EQ(material("7075-T6").name, "7075-t6");
  EXPECT_EQ(material("7075 t6").name, "7075-t6");
  EXPECT_EQ(material("al7075").name, "7075-t6");
  EXPECT_EQ(material("Ti6Al4V").name, "ti-6al-4v");
  EXPECT_EQ(material("C45").name, "1045");
  std::set<std::string> seen;
  for (const Material& known : materials()) {
    EXPECT_EQ(&material(known.name), &known) << known.name << " is hidden by another";
    for (const std::string& other : known.other_names) EXPECT_EQ(&material(other), &known) << other;
    EXPECT_TRUE(seen.insert(known.name).second);
  }
  const std::string near = test::rejection([] { static_cast<void>(material("6016-t6")); });
  EXPECT_NE(near.find("Did you mean"), std::string::npos) << near;
  const std::string shorter = test::rejection([] { static_cast<void>(material("Inconel")); });
  EXPECT_NE(shorter.find("Did you mean inconel-718?"), std::string::npos) << shorter;
  const std::string far = test::rejection([] { static_cast<void>(material("cheese")); });
  EXPECT_NE(far.find("must be one of 6061-t6, 7075-t6"), std::string::npos) << far;
}

TEST(MaterialsToml, RejectsInTheFilesWords) {
  const std::string good =
      "[materials.foam]\ndescription = \"foam\"\n[[materials.foam.coefficients]]\ncutter = \"any\"\n"
      "tangential_n_per_mm2 = 5\nsource = \"Someone\"\n";
  const auto read = [](const std::string& text) {
    std::vector<std::string> notes;
    return read_materials(io::TomlSource("m.toml", text), notes);
  };
  ASSERT_EQ(read(good).size(), 1U);
  EXPECT_DOUBLE_EQ(read(good).front().coefficients.front().line.tangential_n_per_m2.front(), 5e6);
  const auto expect = [&](const std::string& text, const std::string& words) {
    const std::string said = test::rejection([&] { static_cast<void>(read(text)); });
    EXPECT_NE(said.find(words), std::string::npos) << said;
  };
  expect("[materials.foam]\nother_names = [\"f\"]\n", "materials.foam.description: is missing");
  expect(good + "specific_force_n_per_mm2 = 8\n", "must have either tangential_n_per_mm2 or specific_force_n_per_mm2");
  expect(good + "cutting_speed_m_per_min = [300, 200]\n", "m.toml:7");
  expect(good + "feed_per_tooth_mm = [0.1]\n", "must be [from, to]");
  expect(good + "kind = \"round\"\n", "kind");
  expect(good + "radial_n_per_mm = 2\n", "radial_n_per_mm");
  expect(good + "[[materials.foam.conditions]]\ncutter = \"any\"\nsource = \"Someone\"\ndiameter_mm = [3, 6]\n",
         "must have a feed for each diameter_mm");
  expect(good +
             "[[materials.foam.coefficients]]\ncutter = \"any\"\nspecific_force_n_per_mm2 = 5\n"
             "thickness_power = 1\nsource = \"Someone\"\n",
         "thickness_power = 1; must be below 1");
}

}  // namespace materials_toml_test
}  // namespace robomill::cutting
