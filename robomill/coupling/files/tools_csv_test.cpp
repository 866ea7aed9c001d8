#include "robomill/coupling/files/tools_csv.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "robomill/base/random.hpp"
#include "testing/support.hpp"

namespace robomill::coupling {
namespace tools_csv_test {

std::vector<ListedTool> read_tools(const std::filesystem::path& path, const Segment& like) {
  std::vector<std::string> notes;
  return coupling::read_tools(path, like, notes);
}

Segment carbide() {
  return {.length_m = 0.03,
          .diameter_m = 0.01,
          .inner_diameter_m = 0.001,
          .youngs_modulus_pa = 580e9,
          .density_kg_per_m3 = 14450.0,
          .mass_kg = 0.2,
          .poissons_ratio = 0.22,
          .loss_factor = 0.002,
          .flutes = 4,
          .flute_diameter_ratio = 0.75,
          .beam = Beam::euler_bernoulli};
}

TEST(ToolsCsv, ReadsARowASegment) {
  const test::Folder folder;
  const auto tools = read_tools(folder.file("tools.csv",
                                            "# the rack by the window\n"
                                            "tool,length_mm,diameter_mm,flutes,youngs_modulus_gpa,beam,teeth\n"
                                            "\"mill, 10\",20,10,3,600,,\n"
                                            "\"mill, 10\",60.5,10,,,timoshenko\n"
                                            "\n"
                                            "drill,80,6,,210,,2\n"),
                                carbide());
  ASSERT_EQ(tools.size(), 2U);
  EXPECT_EQ(tools[0].name, "mill, 10");
  EXPECT_EQ(tools[0].teeth, 3);
  ASSERT_EQ(tools[0].segments.size(), 2U);
  const Segment& tip = tools[0].segments[0];
  EXPECT_DOUBLE_EQ(tip.length_m, 0.02);
  EXPECT_DOUBLE_EQ(tip.diameter_m, 0.01);
  EXPECT_EQ(tip.flutes, 3);
  EXPECT_DOUBLE_EQ(tip.youngs_modulus_pa, 600e9);
  EXPECT_EQ(tip.beam, Beam::euler_bernoulli);
  // The material is the assembly's where the row says none; bore, mass and flutes are the segment's own.
  EXPECT_DOUBLE_EQ(tip.density_kg_per_m3, 14450.0);
  EXPECT_DOUBLE_EQ(tip.poissons_ratio, 0.22);
  EXPECT_DOUBLE_EQ(tip.loss_factor, 0.002);
  EXPECT_DOUBLE_EQ(tip.flute_diameter_ratio, 0.75);
  EXPECT_EQ(tip.inner_diameter_m, 0.0);
  EXPECT_EQ(tip.mass_kg, 0.0);
  const Segment& shank = tools[0].segments[1];
  EXPECT_DOUBLE_EQ(shank.length_m, 0.0605);
  EXPECT_EQ(shank.flutes, 0);
  EXPECT_DOUBLE_EQ(shank.youngs_modulus_pa, 580e9);
  EXPECT_EQ(shank.beam, Beam::timoshenko);
  EXPECT_EQ(tools[1].name, "drill");
  EXPECT_EQ(tools[1].teeth, 2);
}

TEST(ToolsCsv, TakesSemicolonsTabsAndCommasForThePoint) {
  const test::Folder folder;
  const auto german =
      read_tools(folder.file("tools.csv", "\xEF\xBB\xBFtool;length_mm;diameter_mm\r\nFräser;20,5;10\r\n"), carbide());
  ASSERT_EQ(german.size(), 1U);
  EXPECT_EQ(german[0].name, "Fräser");
  EXPECT_DOUBLE_EQ(german[0].segments[0].length_m, 0.0205);
  const auto tabs =
      read_tools(folder.file("tools.csv", "tool\tinner_diameter_mm\tlength_mm\tdiameter_mm\na\t\t20\t10\n"), carbide());
  EXPECT_DOUBLE_EQ(tabs[0].segments[0].length_m, 0.02);
}

TEST(ToolsCsv, TwoQuotesWithinQuotesAreOne) {
  const test::Folder folder;
  const auto tools = read_tools(
      folder.file("tools.csv", "tool,length_mm,diameter_mm\n\"1/2\"\" mill, \"\"long\"\"\",20,10\n1/2\"\",30,10\n"),
      carbide());
  ASSERT_EQ(tools.size(), 2U);
  EXPECT_EQ(tools[0].name, "1/2\" mill, \"long\"");
  EXPECT_EQ(tools[1].name, "1/2\"\"") << "without quotes about it, a field is as it stands";
}

TEST(ToolsCsv, RejectsInTheFilesWords) {
  const test::Folder folder;
  const auto expect = [&](const std::string& text, const std::string& words) {
    const std::string said =
        test::rejection([&] { static_cast<void>(read_tools(folder.file("tools.csv", text), carbide())); });
    EXPECT_NE(said.find(words), std::string::npos) << said;
  };
  const std::string head = "tool,length_mm,diameter_mm,inner_diameter_mm,beam,teeth,density_kg_per_m3\n";
  expect(head + "a,20,10\na,-3,10\n", "tools.csv:3: length_mm = -3 mm; must be > 0");
  expect(head + "a,,10\n", "tools.csv:2: length_mm: is missing; must be > 0");
  expect(head + "a,twenty,10\n", "tools.csv:2: length_mm = \"twenty\"; must be a finite number");
  expect(head + "a,inf,10\n", "tools.csv:2: length_mm");
  expect(head + "a,20,10,11\n", "tools.csv:2: inner_diameter_mm = 11 mm");
  expect(head + "a,20,10,,bernoulli\n", "tools.csv:2: beam = \"bernoulli\"; must be one of");
  expect(head + "a,20,10,,,1.5\n", "tools.csv:2: teeth = 1.5; must be a whole number");
  expect(head + "a,20,10,,,0\n", "tools.csv:2: teeth = 0; must be at least 1");
  expect(head + "a,20,10,,,2\na,20,10,,,3\n", "tools.csv:3: teeth = 3; differs");
  expect(head + "a,20,10,,,,-1\n", "tools.csv:2: density_kg_per_m3 = -1 kg/m^3");
  expect(head + "a,20,10\nb,20,10\na,20,10\n", "tools.csv:4: tool = \"a\"; comes a second time");
  expect(head + ",20,10\n", "tools.csv:2: tool: is empty");
  expect(head + "a,20,10,1,timoshenko,2,7800,9\n", "tools.csv:2: has 8 fields where there are 7 columns");
  expect(head, "holds no row");
  expect("tool,length_mm,length_mm\na,2,3\n", "tools.csv:1: names the column length_mm twice");
  expect("tool,,length_mm\na,2,3\n", "tools.csv:1: has a column without a name");
  expect("tool,length_mm\na,2\n", "tools.csv: has no column diameter_mm");
  expect("tool,length_mm,diameter_mm,lenght_mm\na,2,3,4\n", "Did you mean length_mm?");
}

// Cut off or changed at any place, a file is rejected or read, and never anything worse.
TEST(ToolsCsv, SurvivesMutations) {
  const test::Folder folder;
  const std::string good = "tool,length_mm,diameter_mm,beam\n\"a\",20,10,timoshenko\n\"b\",30,12,euler-bernoulli\n";
  Random random(3);
  for (int i = 0; i < test::seeds(1000); ++i) {
    std::string text = good;
    text[random.index(text.size())] = static_cast<char>(random.index(256));
    if (i % 2 == 0) text.resize(1 + random.index(good.size() - 1));
    try {
      for (const ListedTool& tool : read_tools(folder.file("tools.csv", text), carbide())) {
        for (const Segment& segment : tool.segments) segment.validate();
      }
    } catch (const InvalidInput&) {
      continue;
    }
  }
}

}  // namespace tools_csv_test
}  // namespace robomill::coupling
