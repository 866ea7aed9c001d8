#include "robomill/jobs/tools.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "robomill/base/parallel.hpp"
#include "testing/support.hpp"

namespace robomill::jobs {
namespace tools_test {

using decision::ToolResult;
using decision::tools_csv;
using decision::tools_json;

const std::string material = "youngs_modulus_gpa = 580\ndensity_kg_per_m3 = 14450\nloss_factor = 0.03\n";

coupling::AssemblyFile assembly(const test::Folder& folder) {
  return coupling::read_assembly(
      folder.file("assembly.toml",
                  "[frequency]\nrange_hz = [100, 5000]\nstep_hz = 5\n[[tool]]\nlength_mm = 60\ndiameter_mm = 12\n" +
                      material + "[holder]\n[[holder.segments]]\nlength_mm = 60\ndiameter_mm = 32\n" + material));
}

std::vector<coupling::ListedTool> tools(const test::Folder& folder, const coupling::AssemblyFile& file) {
  std::vector<std::string> notes;
  return coupling::read_tools(folder.file("tools.csv",
                                          "tool,length_mm,diameter_mm,flutes,teeth\nshort,60,12,,4\nlong,30,12,3,\n"
                                          "long,60,12\nthin,60,1,2\nplain,80,12\n"),
                              file.assembly.tool.front(), notes);
}

LobesFile cut(const test::Folder& folder, const std::string& more = "") {
  return read_lobes(
      folder.file("lobes.toml",
                  "[tool]\nteeth = 2\ndiameter_mm = 12\n" + more +
                      "[cut]\ndirection = \"down\"\nradial_depth_mm = 1.2\nfeed_per_tooth_mm = 0.05\n[coefficients]\n"
                      "tangential_n_per_mm2 = 712\nradial_n_per_mm2 = 287\n[lobes]\nspindle_speed_rpm = [6000, 20000]\n"
                      "axial_depth_mm = [0, 8]\ngrid = [25, 12]\ntolerance = 1e-4\n"));
}

TEST(Tools, EachRowIsWhatTheToolComesToAlone) {
  const test::Folder folder;
  const coupling::AssemblyFile file = assembly(folder);
  const auto listed = tools(folder, file);
  const std::vector<ToolResult> rows = try_tools(file, listed, cut(folder), 1, Progress::none());
  ASSERT_EQ(rows.size(), 4U);
  EXPECT_EQ(rows[0].teeth, 4);
  EXPECT_EQ(rows[1].teeth, 3);
  EXPECT_EQ(rows[3].teeth, 2);  // of the cut
  EXPECT_NEAR(rows[1].overhang_m, 0.09, 1e-15);
  // The first is the assembly's own tool.
  const modal::FrfSet own = coupling::tip_frfs(file.assembly, file.frequency_hz).frfs;
  EXPECT_EQ(rows[0].tip.frfs[0].receptance, own.frfs[0].receptance);
  EXPECT_LT(rows[0].fit_error, 0.02);
  EXPECT_GT(rows[0].peak_hz, rows[3].peak_hz);
  ASSERT_TRUE(rows[0].recommendation && rows[0].recommendation->recommended) << rows[0].failure;
  // What it recommends is stable by the lobes of that tool's modes.
  LobesFile mine = cut(folder);
  mine.problem.milling.tool.teeth = 4;
  mine.problem.dynamics = rows[0].modes;
  const decision::Operation& best = *rows[0].recommendation->recommended;
  const stability::PointResult point =
      stability::evaluate_point(mine.problem, mine.options, {best.spindle_speed_rad_per_s, best.axial_depth_m});
  EXPECT_LT(point.spectral_radius, 1.0);
  ASSERT_TRUE(rows[0].lowest_limit_m);
  EXPECT_LE(*rows[0].lowest_limit_m, best.limit_depth_m * (1.0 + 1e-9));
  // 1.2 mm are more than the thin cutter has; its coupling stands.
  const std::string why = "must be at most the cutter's diameter";
  EXPECT_NE(rows[2].no_cut.find(why), std::string::npos) << rows[2].no_cut;
  EXPECT_TRUE(rows[2].failure.empty());
  EXPECT_FALSE(rows[2].recommendation);
  EXPECT_FALSE(rows[2].lowest_limit_m);
  EXPECT_GT(rows[2].peak_hz, 0.0);
  const auto json = nlohmann::json::parse(tools_json(rows))["tools"][2];
  EXPECT_TRUE(json["failure"].is_null());
  EXPECT_NE(json["reason"].get<std::string>().find(why), std::string::npos);
  EXPECT_FALSE(json["modes"].empty());
  EXPECT_NE(tools_csv(rows).find(why), std::string::npos);
  write_tips(folder.at("tips"), rows);
  EXPECT_TRUE(std::filesystem::exists(folder.at("tips/3_thin.uff")));
}

TEST(Tools, AreTheSameAtAnyNumberOfThreads) {
  const test::Folder folder;
  const coupling::AssemblyFile file = assembly(folder);
  const auto listed = tools(folder, file);
  set_thread_count(1);
  const std::string one = tools_json(try_tools(file, listed, cut(folder), 1, Progress::none()));
  set_thread_count(4);
  const std::string four = tools_json(try_tools(file, listed, cut(folder), 1, Progress::none()));
  set_thread_count(0);
  EXPECT_EQ(one, four);
}

TEST(Tools, WithoutACutThereAreModesAlone) {
  const test::Folder folder;
  const coupling::AssemblyFile file = assembly(folder);
  const auto rows = try_tools(file, tools(folder, file), std::nullopt, 1, Progress::none());
  for (const ToolResult& row : rows) {
    EXPECT_TRUE(row.failure.empty()) << row.failure;
    EXPECT_FALSE(row.modes.modes.empty());
    EXPECT_FALSE(row.recommendation);
  }
  const auto json = nlohmann::json::parse(tools_json(rows));
  EXPECT_EQ(json["tools"][1]["tool"], "long");
  EXPECT_TRUE(json["tools"][3]["teeth"].is_null());
  EXPECT_TRUE(json["tools"][0]["recommended"].is_null());
  EXPECT_DOUBLE_EQ(json["tools"][1]["overhang_mm"].get<double>(), 90.0);
  std::string csv = tools_csv(rows);
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 5);
  EXPECT_NE(csv.find("\n\"long\",3,12,90,"), std::string::npos) << csv;
  csv = tools_csv({ToolResult{.name = "1/2\" mill"}});
  EXPECT_NE(csv.find("\n\"1/2\"\" mill\","), std::string::npos) << csv;
}

// What cuts neither carries an accelerometer nor hangs free.
TEST(Tools, CarryNoAccelerometer) {
  const test::Folder folder;
  const std::string text =
      "[frequency]\nrange_hz = [100, 5000]\nstep_hz = 20\n[[tool]]\nlength_mm = 60\n"
      "diameter_mm = 12\n" +
      material;
  const auto run = [&](const std::string& more) {
    return run_tools({.assembly = folder.file("assembly.toml", text + more),
                      .tools = folder.file("tools.csv", "tool,length_mm,diameter_mm\nshort,60,12\n")});
  };
  const ToolsResult loaded = run("[accelerometer]\nmass_kg = 0.02\n");
  const ToolsResult bare = run("");
  ASSERT_EQ(loaded.tools.size(), 1U);
  EXPECT_EQ(loaded.tools[0].tip.frfs[0].receptance, bare.tools[0].tip.frfs[0].receptance);
  ASSERT_FALSE(loaded.assembly.notes.empty());
  EXPECT_NE(loaded.assembly.notes.back().find("The accelerometer of 0.02 kg"), std::string::npos);
  const std::string words = test::rejection([&] { static_cast<void>(run("[holder]\nfree = true\n")); });
  EXPECT_NE(words.find("holder.free = true; must not be true where the tool is to cut"), std::string::npos) << words;
}

TEST(Tools, RejectAnAssemblyThatDoesNotCut) {
  const test::Folder folder;
  coupling::AssemblyFile file = assembly(folder);
  const auto listed = tools(folder, file);
  const auto say = [&] {
    return test::rejection([&] { static_cast<void>(try_tools(file, listed, std::nullopt, 1, Progress::none())); });
  };
  file.assembly.accelerometer.mass_kg = 0.003;
  EXPECT_NE(say().find("accelerometer.mass_kg = 0.003 kg; must be 0"), std::string::npos) << say();
  file.assembly.accelerometer = {};
  file.assembly.holder = {.free = true};
  EXPECT_NE(say().find("holder.free"), std::string::npos) << say();
}

TEST(Tools, RejectACutOfOneCutter) {
  const test::Folder folder;
  const coupling::AssemblyFile file = assembly(folder);
  const auto listed = tools(folder, file);
  const auto say = [&](const LobesFile& lobes) {
    return test::rejection([&] { static_cast<void>(try_tools(file, listed, lobes, 1, Progress::none())); });
  };
  EXPECT_NE(say(cut(folder, "pitch_deg = [170, 190]\n")).find("lobes.toml"), std::string::npos);
  LobesFile no_feed = cut(folder);
  no_feed.problem.milling.feed_per_tooth_m = 0.0;
  EXPECT_NE(say(no_feed).find("cut.feed_per_tooth_mm is missing"), std::string::npos);
  EXPECT_NE(test::rejection([&] {
              static_cast<void>(try_tools(file, {}, std::nullopt, 1, Progress::none()));
            }).find("no tool"),
            std::string::npos);
}

}  // namespace tools_test
}  // namespace robomill::jobs
