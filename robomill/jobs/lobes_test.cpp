#include "robomill/jobs/lobes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>

#include "robomill/base/units.hpp"
#include "robomill/io/file.hpp"
#include "robomill/stability/surface_error.hpp"
#include "testing/support.hpp"
#include "testing/text.hpp"

namespace robomill::jobs {
namespace lobes_test {

using test::rejection;
using test_support::replaced;

/// The example's lobes.toml with a grid that is quick.
std::string quick(const std::string& grid) {
  const std::string text =
      io::read_file(std::filesystem::path(ROBOMILL_SOURCE_DIR) / "examples/first-lobes/lobes.toml");
  return replaced(replaced(text, "../../data/", ROBOMILL_SOURCE_DIR "/data/"), "[200, 200]", grid);
}

TEST(RunLobes, GivesWhatTheStageItselfGives) {
  const test::Folder folder;
  const auto path = folder.file("lobes.toml", quick("[6, 12]") +
                                                  "[uncertainty]\nsamples = 20\ntangential_std_n_per_mm2 = 30\n"
                                                  "grid = [2, 6]\n[surface_error]\ngrid = [2, 3]\n");
  const stability::OperatingPoint point = {6500 * units::rpm, 0.6 * units::mm};
  const LobesJobResult result = run_lobes({.lobes = path, .points = {point}, .seed = 7});
  EXPECT_FALSE(result.comparison);

  LobesFile file = read_milling(path);
  const stability::LobesResult lobes = stability::compute_lobes(file.problem, file.options);
  ASSERT_EQ(result.lobes.limit.size(), 6U);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(result.lobes.limit[i].axial_depth_m, lobes.limit[i].axial_depth_m);
  ASSERT_EQ(result.lobes.points.size(), 1U);
  EXPECT_EQ(result.lobes.points[0].spectral_radius,
            stability::evaluate_point(file.problem, file.options, point).spectral_radius);

  file.uncertainty.seed = 7;
  const stability::UncertainLimits uncertain =
      stability::uncertain_limits(file.problem, file.options, file.uncertainty);
  EXPECT_EQ(result.uncertain.samples, 20);
  EXPECT_EQ(result.uncertain.limit_50_percent_m, uncertain.limit_50_percent_m);
  EXPECT_EQ(result.surface.spindle_speed_rad_per_s.size(), 2);
  EXPECT_EQ(result.surface.axial_depth_m.size(), 3);
}

TEST(RunLobes, ComparesMethodsInPlaceOfTheChart) {
  const test::Folder folder;
  const auto path = folder.file("lobes.toml", quick("[3, 12]") + "[surface_error]\ngrid = [2, 3]\n");
  const LobesJobResult result = run_lobes({.lobes = path, .compare = true});
  ASSERT_TRUE(result.comparison);
  EXPECT_EQ(result.comparison->spindle_speed_rad_per_s.size(), 3U);
  EXPECT_EQ(result.comparison->rows.front().method, stability::Method::collocation);
  EXPECT_TRUE(result.lobes.limit.empty());
  EXPECT_EQ(result.surface.axial_depth_m.size(), 0);
}

TEST(RunLobes, RejectsAMissingFile) {
  const test::Folder folder;
  const std::string said = rejection([&] { static_cast<void>(run_lobes({.lobes = folder.at("missing.toml")})); });
  EXPECT_NE(said.find("missing.toml"), std::string::npos);
}

constexpr const char* ball = R"([tool]
kind = "ball-end"
teeth = 2
diameter_mm = 6
helix_deg = 30
[cut]
direction = "up"
stepover_mm = 0.8
axial_depth_mm = 0.25
lead_deg = -10
tilt_deg = 15
[coefficients]
tangential_n_per_mm2 = 1500
radial_n_per_mm2 = 900
axial_n_per_mm2 = 300
[dynamics]
x = [{ frequency_hz = 850, damping_ratio = 0.02, modal_mass_kg = 0.06 }]
y = [{ frequency_hz = 900, damping_ratio = 0.04, modal_mass_kg = 0.06 }]
z = [{ frequency_hz = 2200, damping_ratio = 0.03, modal_mass_kg = 0.06 }]
[lobes]
spindle_speed_rpm = [11000, 13000]
grid = [3, 20]
)";

// The limit at 12,000 rpm and the radius at 20,000 are those of an independent solver (stability/spatial_test.cpp).
TEST(RunLobes, JudgesABallInThreeDirections) {
  const test::Folder folder;
  const auto path = folder.file("ball.toml", std::string(ball) + "axial_depth_mm = [0, 0.6]\n");
  const LobesJobResult result = run_lobes({.lobes = path, .points = {{20000.0 * units::rpm, 0.6e-3}}});
  EXPECT_NEAR(result.lobes.limit[1].axial_depth_m, 0.1651169e-3, 2e-9);
  EXPECT_NEAR(result.lobes.points[0].spectral_radius, 1.287170672, 2e-6);
  EXPECT_LT(result.lobes.points[0].gain_margin, 1.0);
  ASSERT_EQ(result.cut.notes.size(), 1U);
  EXPECT_NE(result.cut.notes[0].find("tip is in the cut"), std::string::npos);
}

TEST(RunLobes, MapsTheSurfaceThatABallLeaves) {
  const test::Folder folder;
  const auto file = [&](const std::string& end) {
    const std::string text = replaced(std::string(ball), "[cut]\n", "[cut]\nfeed_per_tooth_mm = 0.05\n");
    return folder.file("ball.toml", text + end);
  };
  const LobesJobResult result =
      run_lobes({.lobes = file("axial_depth_mm = [0, 0.3]\n[surface_error]\ngrid = [3, 4]\n")});
  int stable = 0;
  for (Eigen::Index s = 0; s < 3; ++s) {
    for (Eigen::Index d = 0; d < 4; ++d) {
      const double error_m = result.surface.surface_location_error_m(d, s);
      if (std::isnan(error_m)) continue;
      ++stable;
      const stability::SurfacePoint there = stability::surface_point(
          result.cut.problem, {result.surface.spindle_speed_rad_per_s(s), result.surface.axial_depth_m(d)});
      EXPECT_NEAR(error_m, there.surface_location_error_m, 1e-6 * there.peak_deflection_m);
    }
  }
  EXPECT_GT(stable, 2);
  EXPECT_LT(stable, 12);
  const std::string said = rejection([&] {
    static_cast<void>(run_lobes({.lobes = file("sweep = \"lead\"\nlead_deg = [-30, 30]\n[surface_error]\n")}));
  });
  EXPECT_NE(said.find("surface_error: goes with a chart over the axial depth"), std::string::npos) << said;
}

TEST(RunLobes, SweepsTheLead) {
  const test::Folder folder;
  const auto path = folder.file("lead.toml", std::string(ball) + "sweep = \"lead\"\nlead_deg = [-30, 30]\n");
  const LobesJobResult result = run_lobes({.lobes = path, .points = {{12000.0 * units::rpm, -10.0 * units::mm}}});
  ASSERT_TRUE(result.sweep);
  EXPECT_EQ(result.sweep->stable.size(), 3U);
  EXPECT_NEAR(result.sweep->points[0].axial_depth_m, -10.0 * units::deg, 1e-12);
  EXPECT_LT(result.sweep->points[0].gain_margin, 1.0);
  EXPECT_TRUE(result.lobes.limit.empty());
  const std::string compared = rejection([&] { static_cast<void>(run_lobes({.lobes = path, .compare = true})); });
  EXPECT_NE(compared.find("lead.toml:"), std::string::npos) << compared;
  EXPECT_EQ(compared.find("lead.toml"), compared.rfind("lead.toml")) << compared;
  EXPECT_NE(compared.find(": lobes.sweep = \"lead\"; does not go with a comparison of methods"), std::string::npos)
      << compared;
}

TEST(RunLobes, JudgesDrilling) {
  const test::Folder folder;
  const auto drill = folder.file(
      "drill.toml", replaced(quick("[6, 12]"), "direction = \"up\"\nradial_depth_mm = 1.8\nfeed_per_tooth_mm = 0.01\n",
                             "kind = \"drilling\"\nfeed_per_revolution_mm = 0.1\n"));
  const LobesJobResult result = run_lobes({.lobes = drill});
  ASSERT_EQ(result.lobes.limit.size(), 6U);
  EXPECT_EQ(result.lobes.limit[0].status, stability::Limit::Status::found);
  EXPECT_EQ(result.cut.assumed.back().what, "Direction z, not measured");
}

}  // namespace lobes_test
}  // namespace robomill::jobs
