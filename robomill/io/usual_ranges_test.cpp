#include "robomill/io/usual_ranges.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "robomill/io/file.hpp"
#include "robomill/io/json.hpp"
#include "robomill/io/key_unit.hpp"
#include "robomill/io/table.hpp"
#include "robomill/io/text.hpp"
#include "robomill/io/toml/file.hpp"
#include "testing/support.hpp"

namespace robomill::io {
namespace usual_ranges_test {

const std::filesystem::path source = ROBOMILL_SOURCE_DIR;

struct Mistake {
  const char *name, *key;
  std::vector<double> values;
  const char* hint;  ///< that the warning must hold
};

struct Mistaken : ::testing::TestWithParam<Mistake> {};

TEST_P(Mistaken, IsNamedWithItsLikelyCause) {
  const Mistake& mistake = GetParam();
  const std::optional<Unusual> found = unusual_value(mistake.key, mistake.values);
  ASSERT_TRUE(found) << mistake.key;
  EXPECT_NE((found->rule + ". " + found->hint).find(mistake.hint), std::string::npos)
      << found->rule << ". " << found->hint;
}

INSTANTIATE_TEST_SUITE_P(
    Ordinary, Mistaken,
    ::testing::Values(
        Mistake{"DepthInM", "cut.axial_depth_mm", {0.0006}, "in m?"},
        Mistake{"ToolLengthInM", "tool.length_mm", {0.31}, "in m?"},
        Mistake{"SegmentInM", "tool[1].length_mm", {0.064}, "in m?"},
        Mistake{"DiameterInM", "tool.diameter_mm", {0.016}, "in m?"},
        Mistake{"OriginInM", "workpiece.origin_mm", {1.6, -0.3, 0.75}, "in m?"},
        Mistake{"ReachInM", "robot.dh[2].a_mm", {0.045}, "in m?"},
        Mistake{"FeedInMmPerMin", "cut.feed_per_tooth_mm", {1200}, "mm/min"},
        Mistake{"FeedInUm", "cut.feed_per_tooth_mm", {7}, "in um?"},
        Mistake{"SpeedInHz", "cut.spindle_speed_rpm", {40}, "Hz"},
        Mistake{"HelixInRad", "tool.helix_deg", {0.6109}, "in rad?"},
        Mistake{"MountInRad", "tool.mount_rotation_deg", {0, 0.7854, 0}, "radians"},
        Mistake{"JointsInRad", "robot.start_joints_deg", {0, -1.5708, 1.5708, 0, 1.2, 0}, "radians"},
        Mistake{"OddJointsInRad", "postures[0].joints_deg", {0.312, -0.871, 1.934, 0.208, 0.777, 0.05}, "radians"},
        Mistake{"VelocityInRad", "robot.joint_max_velocity_deg_per_s", {2.1, 2.1, 2.4}, "rad/s"},
        Mistake{"VelocityInDeg", "robot.joint_max_velocity_rad_per_s", {120, 115}, "deg/s"},
        Mistake{"PositionInDeg", "robot.joint_max_position_rad", {170}, "degrees"},
        Mistake{"RadialThatPulls", "coefficients.radial_n_per_mm2", {-200}, "of another convention?"},
        Mistake{"CoefficientsInPa", "coefficients.tangential_n_per_mm2", {7.1e8}, "N/m^2"},
        Mistake{"CoefficientsInGpa", "coefficients.tangential_n_per_mm2", {0.71}, "GPa"},
        Mistake{"EdgeInNPerM", "coefficients.tangential_edge_n_per_mm", {13'000}, "N/m?"},
        Mistake{"DampingInPercent", "modes[0].damping_ratio", {2.7}, "percent"},
        Mistake{"LossInPercent", "tool[0].loss_factor", {1.5}, "percent"},
        Mistake{"FrequencyInKhz", "dynamics.x[0].frequency_hz", {0.72}, "kHz"},
        Mistake{"RateInKhz", "acquisition.sample_rate_hz", {51.2}, "kHz"},
        Mistake{"SensitivityInV", "acquisition.force_mv_per_n", {0.0112}, "V/N"},
        Mistake{"ResponseInV", "acquisition.response_mv_per_g", {0.1}, "V/g"},
        Mistake{"AccelerometerInG", "acquisition.accelerometer_mass_kg", {4.8}, "in g?"},
        Mistake{"StiffnessInNPerMm", "joint.translational_stiffness_n_per_m", {62'000}, "N/mm"},
        Mistake{"RobotStiffnessInKn", "robot.joint_stiffness_n_m_per_rad", {120}, "kN m/rad"},
        Mistake{"ModalStiffnessInNPerM", "dynamics.x[0].modal_stiffness_n_per_um", {2.4e7}, "N/m?"},
        Mistake{"CarbideWithADigitMissing", "tool[0].youngs_modulus_gpa", {58}, "digit"},
        Mistake{"SteelInMpa", "holder.segments[0].youngs_modulus_gpa", {205'000}, "MPa"},
        Mistake{"DensityInGPerCm3", "tool[0].density_kg_per_m3", {14.4}, "g/cm^3"},
        Mistake{"PowerInW", "spindle.curve[0].power_kw", {7500}, "in W?"},
        Mistake{"LoadInG", "tool.mass_kg", {18'500}, "in g?"}, Mistake{"RunoutInMm", "tool.runout_um", {0.008}, "mm"},
        Mistake{"ToleranceInM", "smoothing.tip_tolerance_mm", {2e-5}, "in m?"},
        Mistake{"PeriodInS", "smoothing.sample_period_ms", {0.001}, "in s?"},
        Mistake{"InertiaInKgMm2", "robot.links[0].inertia_kg_m2", {7.2e6, 6.8e6, 2e6, 0, 0, 0}, "kg mm^2"}),
    [](const ::testing::TestParamInfo<Mistake>& mistake) { return std::string(mistake.param.name); });

struct Right {
  const char* key;
  std::vector<double> values;
};

TEST(UsualRanges, AdmitWhatShopsHave) {
  const std::vector<Right> cases = {
      {"tool.diameter_mm", {0.1}},
      {"tool.diameter_mm", {200}},
      {"cut.feed_per_tooth_mm", {0.0008}},
      {"cut.feed_per_tooth_mm", {1.5}},
      {"cut.spindle_speed_rpm", {60'000}},
      {"tool.helix_deg", {0}},
      {"tool.helix_deg", {-30}},
      {"workpiece.origin_mm", {1500, 0, -4}},
      {"workpiece.rotation_deg", {0, 0, 2}},
      {"workpiece.rotation_deg", {0.5, -1.5, 0}},
      {"robot.start_joints_deg", {0, 0, 0, 0, 5, 0}},
      {"robot.start_joints_deg", {0, -90, 90, 0, 90, 0}},
      {"postures[1].joints_deg", {-2.93, -55.24, 100.95, -6.2, 95.15, -71.37}},
      {"dynamics.x[0].damping_ratio", {0.003}},
      {"dynamics.x[0].frequency_hz", {7.5}},
      {"coefficients.tangential_n_per_mm2", {11.7}},
      {"coefficients.tangential_n_per_mm2", {3500}},
      {"coefficients.radial_n_per_mm2", {-120, 15, 340}},
      {"holder.artefact[0].youngs_modulus_gpa", {70}},
      {"lobes.no_such_key", {1e99}},
  };
  for (const Right& right : cases) EXPECT_FALSE(unusual_value(right.key, right.values)) << right.key;
}

TEST(UsualRanges, OfAPathStandsBeforeThatOfAName) {
  ASSERT_NE(usual_range("tool[3].length_mm"), nullptr);
  EXPECT_EQ(usual_range("tool[3].length_mm")->key, "tool[].length_mm");
  EXPECT_EQ(usual_range("tool.length_mm")->key, "tool.length_mm");
  EXPECT_EQ(usual_range("holder.segments[0].length_mm")->key, "length_mm");
}

TEST(UsualRanges, HaveOneRowAKeyAndARangeEach) {
  std::set<std::string_view> seen;
  for (const UsualRange& row : usual_ranges()) {
    EXPECT_TRUE(seen.insert(row.key).second) << row.key;
    const bool usable = row.compared == Compared::any || (row.lowest > 0.0 && row.lowest < row.highest);
    EXPECT_TRUE(usable) << row.key;
  }
}

/// Of a document that is read as a whole.
std::vector<std::string> unusual_of(const std::filesystem::path& path) {
  TomlFile file(path);
  for (const std::string& table : file.keys("")) file.skip(table);
  return file.unusual();
}

/// Every key with a unit in what docs/formats.md says of the documents that people write.
TEST(UsualRanges, HaveARowForEveryKeyWithAUnit) {
  const std::string text = read_file(source / "docs/formats.md");
  const std::regex quoted("`([a-z0-9_\\[\\]. ]+)`");
  std::size_t count = 0;
  for (const std::string section :
       {"## hits.toml", "## assembly.toml", "## lobes.toml", "## cell.toml", "## forces.toml", "## Materials",
        "## monitor.toml", "## recordings.toml", "## job.toml"}) {
    const std::size_t begin = text.find("\n" + section);
    ASSERT_NE(begin, std::string::npos) << section;
    const std::size_t end = std::min(text.find("\n## ", begin + 2), text.size());
    std::string row;
    bool of_keys = false;  // in a table of the document's own keys
    for (std::size_t at = begin + 1; at < end; at = row.size() + at + 1) {
      row = text.substr(at, text.find('\n', at) - at);
      const bool of_result = row.starts_with("<!-- schema: ") && row.find(".toml") == std::string::npos;
      if (of_result) at = text.find("<!-- end -->", at) - row.size() - 1;
      if (row.starts_with("| key")) of_keys = row.find("| meaning |") != std::string::npos;
      if (row.empty()) of_keys = false;
      if (!of_keys || !row.starts_with("| `")) continue;
      const std::string cell = row.substr(0, row.find(" | "));
      for (std::sregex_iterator found(cell.begin(), cell.end(), quoted), none; found != none; ++found) {
        const std::string key = (*found)[1];
        if (unit_of_key(key).empty() || key.starts_with('_') || key.find(' ') != std::string::npos) continue;
        ++count;
        EXPECT_NE(usual_range(key), nullptr) << section << ": " << key;
      }
    }
  }
  EXPECT_GT(count, 80u);
}

/// Examples and data are right, so that nothing in them is unusual; and every number with a unit there has a row.
TEST(UsualRanges, FindNothingInExamplesDataAndTemplates) {
  std::size_t files = 0;
  for (const char* folder : {"examples", "data", "robomill/jobs/templates"}) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(source / folder)) {
      if (entry.path().extension() != ".toml") continue;
      ++files;
      const std::vector<std::string> unusual = unusual_of(entry.path());
      EXPECT_TRUE(unusual.empty()) << unusual.front();
    }
  }
  EXPECT_GT(files, 30u);
}

TEST(UsualRanges, AreSaidWithFileLineKeyAndValue) {
  test::Folder folder;
  const auto path = folder.file("cut.toml",
                                "[tool]\nteeth = 2\n[cut]\nfeed_per_tooth_mm = 6\n[[cuts]]\naxial_depth_mm = 1\n"
                                "[[cuts]]\naxial_depth_mm = 0.002\n");
  const std::vector<std::string> found = unusual_of(path);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0], "Warning: " + path.string() +
                          ":4: cut.feed_per_tooth_mm = 6 mm; is unusual: 0.0001 to 2 mm is usual. Is it in um?");
  EXPECT_EQ(found[1], "Warning: " + path.string() +
                          ":8: cuts[2].axial_depth_mm = 0.002 mm; is unusual: 0.0055 to 200 mm is usual. Is it in m?");
  std::vector<std::string> notes = {"one", found[0], "two"};
  EXPECT_EQ(take_warnings(notes), std::vector<std::string>{found[0].substr(9)});
  EXPECT_EQ(notes, (std::vector<std::string>{"one", "two"}));
}

TEST(UsualRanges, AreThoseOfColumnsToo) {
  std::vector<std::string> warnings;
  static_cast<void>(
      parse_text_table("tool,diameter_mm,fx_n\na,12,0.2\nb,0.012,900\nc,0.010,-400\n", "t.csv", warnings));
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0], "Warning: t.csv:3: diameter_mm = 0.012 mm; is unusual: 0.05 to 250 mm is usual. Is it in m?");
  warnings.clear();
  static_cast<void>(parse_text_table("fx_n,fy_n\n1,0.001\n90000,0\n", "t.csv", warnings));
  ASSERT_EQ(warnings.size(), 2u);
  EXPECT_NE(warnings[0].find("t.csv:3: fx_n = 90000 N"), std::string::npos) << warnings[0];
  EXPECT_NE(warnings[1].find("t.csv:2: fy_n = 0.001 N"), std::string::npos) << warnings[1];
  warnings.clear();
  static_cast<void>(parse_table("time_s,force_n\n0,0\n1,0.04\n2,-0.01\n", "t.csv", warnings));
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("t.csv: force_n = 0.04 N; is unusual"), std::string::npos) << warnings[0];
  EXPECT_NE(warnings[0].find("Is it in kN?"), std::string::npos) << warnings[0];
}

TEST(UsualRanges, AreThoseOfJsonDocumentsToo) {
  const Json json = Json::parse(R"({"modes": [{"frequency_hz": 0.7, "std": {"frequency_hz": 1e-3}}],
                                     "frequency_hz": [0.1, 0.2, 8e5], "fit": {"damping_ratio": 5}})");
  std::vector<std::string> warnings;
  const JsonNode root(json, "m.json", warnings);
  const JsonNode mode = root.at("modes").at(std::size_t{0});
  EXPECT_EQ(mode.at("frequency_hz").number(), 0.7);
  EXPECT_EQ(mode.at("std").at("frequency_hz").number(), 1e-3);
  EXPECT_EQ(root.at("frequency_hz").numbers().size(), 3);
  ASSERT_EQ(warnings.size(), 2u) << "what is not read is not compared";
  EXPECT_EQ(warnings[0],
            "Warning: m.json: modes[1].frequency_hz = 0.7 Hz; is unusual: 1 to 30000 Hz is usual. Is it in kHz?");
  EXPECT_NE(warnings[1].find("m.json: frequency_hz = 800000 Hz"), std::string::npos) << warnings[1];
}

TEST(UsualRanges, TakeMassAndFrequencyOfAModeTogether) {
  test::Folder folder;
  const auto unusual = [&](const char* mass) {
    return unusual_of(folder.file("modes.toml", std::string("[dynamics]\nx = [{ frequency_hz = 700, "
                                                            "damping_ratio = 0.03, modal_mass_kg = ") +
                                                    mass + " }]\n"));
  };
  EXPECT_TRUE(unusual("0.4").empty());
  const std::vector<std::string> in_g = unusual("400");
  ASSERT_EQ(in_g.size(), 1u);
  EXPECT_NE(in_g[0].find("dynamics.x[1] is a mode of 7.74e+03 N/um"), std::string::npos) << in_g[0];
  EXPECT_NE(in_g[0].find("in g?"), std::string::npos) << in_g[0];
}

}  // namespace usual_ranges_test
}  // namespace robomill::io
