#include "robomill/jobs/lobes.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "robomill/base/units.hpp"
#include "robomill/io/file.hpp"
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

TEST(RunLobes, RejectsWhatHasNoLobes) {
  const test::Folder folder;
  const auto rejects = [](const std::filesystem::path& path) {
    return rejection([&] { static_cast<void>(run_lobes({.lobes = path})); });
  };
  EXPECT_NE(rejects(folder.at("missing.toml")).find("missing.toml"), std::string::npos);
  const auto drill = folder.file(
      "drill.toml", replaced(quick("[6, 12]"), "direction = \"up\"\nradial_depth_mm = 1.8\nfeed_per_tooth_mm = 0.01\n",
                             "kind = \"drilling\"\nfeed_per_revolution_mm = 0.1\n"));
  const std::string said = rejects(drill);
  EXPECT_NE(said.find("drill.toml: lobes are those of milling. robomill simulate takes drilling"), std::string::npos)
      << said;
}

}  // namespace lobes_test
}  // namespace robomill::jobs
