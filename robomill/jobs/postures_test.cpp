#include "robomill/jobs/postures.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "robomill/base/units.hpp"
#include "robomill/jobs/files/postures_json.hpp"
#include "robomill/jobs/lobes.hpp"
#include "testing/support.hpp"

namespace robomill::jobs {
namespace postures_test {

using robomill::test::Folder;
using robomill::test::rejection;

// An arm without masses, so that measured modes are taken as they are; postures 1, 2, 4, 6 and 8 to 10 of
// [RobotMillingChatter] table 4-6, which differ along x, y, z and γ.
const std::string arm = R"([robot]
base_origin_mm = [0, 0, 225.6]
dh = [{ a_mm = 350, alpha_deg = -90, d_mm = 449.4 }, { a_mm = 1150, theta_offset_deg = -90 },
      { a_mm = 41, alpha_deg = -90, theta_offset_deg = 180 }, { alpha_deg = 90, d_mm = -1200 }, { alpha_deg = -90 },
      { alpha_deg = 180, d_mm = -420, theta_offset_deg = 180 }]
joint_min_position_deg = [-185, -120, -150, -350, -125, -350]
joint_max_position_deg = [185, 120, 168, 350, 125, 350]
[tool]
length_mm = 354.48999730278962
)";
const std::array<std::string, 7> joints_deg = {"[-11.1363094, -11.5231738, 21.6488357, 0, 79.8743381, 101.136309]",
                                               "[-8.51398793, 8.34566629, 2.31740768, 0, 79.336926, 98.5139879]",
                                               "[2.54444375e-14, -12.8248533, 22.6817896, 0, 80.1430637, 90]",
                                               "[2.54444375e-14, -14.0938382, 14.040981, 0, 90.0528573, 90]",
                                               "[1.27222187e-14, -2.44928824, 13.6570813, 0, 78.792207, 150]",
                                               "[1.27222187e-14, -2.44928824, 13.6570813, 180, -78.792207, 30]",
                                               "[0, -2.44928824, 13.6570813, 180, -78.792207, 90]"};

std::string modes_at(double frequency_hz) {
  std::string out;
  for (const auto& [axis, factor] : {std::pair{"x", 1.0}, std::pair{"y", 1.05}, std::pair{"z", 2.0}}) {
    std::string vector = "{ x = [0, 0], y = [0, 0], z = [0, 0] }";
    vector.replace(vector.find(std::string(axis) + " = [0") + 5, 1, "0.02");
    out += "[[modes]]\nfrequency_hz = " + std::to_string(frequency_hz * factor) +
           "\ndamping_ratio = 0.03\nleft = " + vector + "\nright = " + vector + "\n";
  }
  return out;
}

const std::string cut = R"([tool]
teeth = 3
diameter_mm = 16
[cut]
direction = "up"
radial_depth_mm = 8
[coefficients]
tangential_n_per_mm2 = 800
radial_n_per_mm2 = 250
[lobes]
spindle_speed_rpm = [3000, 9000]
axial_depth_mm = [0, 8]
grid = [7, 60]
)";

/// cell.toml with a posture a frequency.
std::filesystem::path write_cell(const Folder& folder, const std::vector<double>& frequency_hz) {
  std::string text = arm;
  for (std::size_t p = 0; p < frequency_hz.size(); ++p) {
    const std::string name = "modes_" + std::to_string(p + 1) + ".toml";
    folder.file(name, modes_at(frequency_hz[p]));
    text += "[[postures]]\njoints_deg = " + joints_deg.at(p) + "\nmodes = \"" + name + "\"\n";
  }
  return folder.file("cell.toml", text);
}

TEST(RunPostures, GivesTheLimitsOfLobesInEachPosture) {
  const Folder folder;
  const PosturesResult result =
      run_postures({.cell = write_cell(folder, {520.0, 500.0, 480.0}), .cut = folder.file("cut.toml", cut)});
  ASSERT_EQ(result.postures.size(), 3U);
  for (std::size_t p = 0; p < 3; ++p) {
    const LobesJobResult one = run_lobes(
        {.lobes = folder.file("lobes.toml", cut + "[dynamics]\ncell = \"cell.toml\"\njoints_deg = " + joints_deg.at(p) +
                                                "\n[uncertainty]\nsamples = 20\ngrid = [2, 4]\n")});
    ASSERT_EQ(one.lobes.limit.size(), result.postures[p].limits.size());
    for (std::size_t s = 0; s < one.lobes.limit.size(); ++s) {
      EXPECT_EQ(one.lobes.limit[s].status, result.postures[p].limits[s].status);
      EXPECT_NEAR(one.lobes.limit[s].axial_depth_m, result.postures[p].limits[s].axial_depth_m, 1e-8);
    }
  }
}

TEST(RunPostures, NamesDirectionsInWhichPosturesDiffer) {
  const Folder folder;
  const PosturesResult result = run_postures(
      {.cell = write_cell(folder, {520, 520, 520, 520, 520, 520, 520}), .cut = folder.file("cut.toml", cut)});
  ASSERT_EQ(result.directions.size(), 4U);
  const std::array<std::pair<std::string, std::vector<std::size_t>>, 4> expected = {
      {{"x", {1, 2}}, {"y", {1, 3}}, {"z", {3, 4}}, {"gamma", {5, 6, 7}}}};
  for (std::size_t d = 0; d < 4; ++d) {
    EXPECT_EQ(result.directions[d].name, expected.at(d).first);
    EXPECT_EQ(result.directions[d].postures, expected.at(d).second);
    EXPECT_GT(result.directions[d].speeds, 0U);
    EXPECT_NEAR(result.directions[d].spread, 0.0, 1e-4);  // the same modes in base axes everywhere
  }
  EXPECT_NEAR(result.postures[0].pose.tip_m.x(), 1.270, 1e-6);
  EXPECT_NEAR(result.postures[0].pose.tip_m.z(), 0.776, 1e-6);
  EXPECT_NEAR(result.postures[0].pose.axis.z(), 1.0, 1e-9);
}

// Of one mode the limit is proportional to its stiffness: with all receptances scaled, (greatest - least) / mean.
TEST(RunPostures, StatesHowFarLimitsLieApart) {
  const Folder folder;
  const std::filesystem::path cell = write_cell(folder, {520.0, 520.0});
  std::string twice = modes_at(520.0);
  for (std::size_t at = 0; (at = twice.find("left = ", at)) != std::string::npos; ++at) {
    twice.replace(twice.find("0.02", at), 4, "0.04");
  }
  folder.file("modes_2.toml", twice);
  const PosturesResult result = run_postures({.cell = cell, .cut = folder.file("cut.toml", cut)});
  ASSERT_EQ(result.directions.size(), 1U);
  EXPECT_NEAR(result.directions[0].spread, (1.0 - 0.5) / 0.75, 1e-3);
  const std::string csv = postures_csv(result);
  EXPECT_EQ(csv.substr(0, csv.find('\n')), "spindle_speed_rpm,posture_1_mm,posture_2_mm");
}

TEST(RunPostures, SaysThatTheCutsOwnStructureDoesNotCount) {
  const Folder folder;
  const std::filesystem::path cell = write_cell(folder, {520.0});
  folder.file("other.toml", modes_at(100.0));
  const PosturesResult result =
      run_postures({.cell = cell, .cut = folder.file("cut.toml", cut + "[dynamics]\nmodes = \"other.toml\"\n")});
  ASSERT_FALSE(result.cut.notes.empty());
  EXPECT_NE(result.cut.notes.front().find("is replaced"), std::string::npos);
  EXPECT_TRUE(result.directions.empty());
}

// The first and the last posture lean by 20 degrees, the one between stands upright.
TEST(RunPostures, SaysOfWhichPosturesANoteIs) {
  const Folder folder;
  folder.file("modes.toml", modes_at(520.0));
  folder.file("upright.toml", modes_at(520.0));
  folder.file("again.toml", modes_at(520.0));
  const std::string posture = "[[postures]]\njoints_deg = [0, -12.8248533, 22.6817896, 0, ";
  const auto cell = folder.file("cell.toml", arm + posture + "60.1430637, 90]\nmodes = \"modes.toml\"\n" + posture +
                                                 "80.1430637, 90]\nmodes = \"upright.toml\"\n" + posture +
                                                 "60.1430637, 45]\nmodes = \"again.toml\"\n");
  const PosturesResult result = run_postures({.cell = cell, .cut = folder.file("cut.toml", cut)});
  const std::string text =
      "The cut's z is the base's z, from which the tool's axis stands off by 20 deg in this posture.";
  for (const char* number : {"1", "3"}) {
    EXPECT_EQ(std::ranges::count(result.cut.notes, "Posture " + std::string(number) + ": " + text), 1) << number;
  }
  EXPECT_EQ(std::ranges::count(result.cut.notes, text), 0);
}

TEST(RunPostures, RejectsWhatHasNoPosturesAndOtherCharts) {
  const Folder folder;
  const std::filesystem::path good = folder.file("cut.toml", cut);
  const std::string none = rejection([&] { (void)run_postures({.cell = folder.file("cell.toml", arm), .cut = good}); });
  EXPECT_NE(none.find("cell.toml: has no [[postures]]"), std::string::npos) << none;
  std::string swept = cut;
  swept.replace(swept.find("axial_depth_mm = [0, 8]"), 23, "sweep = \"radial-depth\"\nradial_depth_mm = [1, 8]");
  swept.replace(swept.find("radial_depth_mm = 8"), 19, "radial_depth_mm = 8\naxial_depth_mm = 1");
  const std::string sweep = rejection(
      [&] { (void)run_postures({.cell = write_cell(folder, {520.0}), .cut = folder.file("swept.toml", swept)}); });
  EXPECT_NE(sweep.find("lobes.sweep"), std::string::npos) << sweep;
}

}  // namespace postures_test
}  // namespace robomill::jobs
