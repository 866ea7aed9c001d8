#include "robomill/jobs/sweep/shown_points.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>

#include "robomill/io/file.hpp"
#include "robomill/jobs/verbs.hpp"
#include "testing/jobs/study_cut.hpp"
#include "testing/support.hpp"

namespace robomill::jobs {
namespace shown_points_test {

using nlohmann::json;

// One in each run, and no period of a grid: of any number of neighbours each place comes about equally often.
TEST(EvenChoice, HasNoPeriod) {
  EXPECT_EQ(even_choice(3, 5), (std::vector<std::uint64_t>{0, 1, 2}));
  EXPECT_TRUE(even_choice(0, 5).empty());
  constexpr std::uint64_t most = 1000;
  for (const std::uint64_t count : {1001ULL, 2000ULL, 64000ULL, 1'000'000'000ULL}) {
    const std::vector<std::uint64_t> chosen = even_choice(count, most);
    ASSERT_EQ(chosen.size(), most);
    EXPECT_LT(chosen.back(), count);
    for (std::uint64_t i = 0; i < most; ++i) {
      EXPECT_LE(std::max(chosen[i], i * count / most) - std::min(chosen[i], i * count / most), count / most + 1);
      if (i > 0) {
        EXPECT_LT(chosen[i - 1], chosen[i]) << "each once";
      }
    }
    for (const std::uint64_t period : {2ULL, 4ULL, 8ULL}) {
      std::vector<std::uint64_t> often(period, 0);
      for (const std::uint64_t i : chosen) ++often[i % period];
      EXPECT_GT(*std::ranges::min_element(often), most / period / 2) << count << " by " << period;
    }
  }
}

class StudyPages : public ::testing::Test {
 protected:
  /// The data of the page of a study over a radial depth, a direction that is text and, where asked, more.
  json page_of(const std::string& tables) {
    std::string cut = test_support::study_cut();
    cut.replace(cut.find("[0.05, 20]"), 10, "[0.05, 4]");  // where some points have no limit
    folder_.file("lobes.toml", cut);
    const std::filesystem::path study =
        folder_.file("study.toml", "[study]\njob = \"lobes\"\nbase = \"lobes.toml\"\n" + tables);
    const Verb& sweep = *std::ranges::find(verbs(), std::string("sweep"), &Verb::name);
    const Outcome outcome =
        sweep.run({.verb = sweep, .inputs = {study}, .output = folder_.at("out")}, Progress::none());
    return json::parse(page::report_json(outcome.page()));
  }
  test::Folder folder_;
};

TEST_F(StudyPages, HaveThePointsAndWhatTheySayTogether) {
  const json page = page_of(R"(
[probability]
value = "limit@8000"
at_least = 1
[[vary]]
key = "cut.radial_depth_mm"
values = [5, 0.2, 12]
[[vary]]
key = "cut.direction"
values = ["up", "down"]
[[vary]]
key = "dynamics.x[0].damping_ratio"
range = [0.01, 0.05]
count = 4
sampling = "sobol"
)");
  const json& points = page["study_points"];
  EXPECT_EQ(points["points"], 24);
  EXPECT_EQ(points["rejected"], 8) << "a radial depth above the diameter";
  ASSERT_EQ(points["keys"].size(), 3U);
  EXPECT_EQ(points["keys"][0]["name"], "cut.radial_depth_mm");
  EXPECT_EQ(points["keys"][0]["unit"], "mm");
  EXPECT_EQ(points["keys"][0]["numbers"][8], 0.2);
  EXPECT_EQ(points["keys"][1]["texts"][4], "down");
  EXPECT_TRUE(points["keys"][1]["numbers"].empty());
  const json& limit = points["values"][0];
  EXPECT_EQ(limit["unit"], "mm");
  EXPECT_TRUE(limit["numbers"][0].is_number());
  EXPECT_TRUE(limit["numbers"][8].is_null()) << "no depth up to 4 mm is unstable";
  const std::string table = io::read_file(folder_.at("out/results.csv"));
  int infinite = 0;
  for (std::size_t at = table.find(",inf,"); at != std::string::npos; at = table.find(",inf,", at + 1)) ++infinite;
  EXPECT_EQ(limit["infinite"], infinite);
  EXPECT_TRUE(limit["numbers"][23].is_null());
  EXPECT_TRUE(points["boundary_keys"].empty());
  const json written = json::parse(io::read_file(folder_.at("out/statistics.json")));
  EXPECT_EQ(page["statistics"]["probability"]["rows"].size(), written["probability"]["rows"].size());
  EXPECT_EQ(page["statistics"]["document"], "statistics/1");
  EXPECT_FALSE(page["created"].get<std::string>().empty());
}

TEST_F(StudyPages, HaveTheBoundary) {
  const json page = page_of(R"(
[boundary]
value = "abs_mu@8000,1"
halvings = 2
[[vary]]
key = "cut.radial_depth_mm"
range = [1, 9]
count = 3
[[vary]]
key = "coefficients.tangential_n_per_mm2"
range = [200, 2000]
count = 3
)");
  const json &points = page["study_points"], &found = page["statistics"]["boundary"];
  EXPECT_GT(found["points"], 2);
  EXPECT_EQ(points["boundary_points"], found["points"]);
  EXPECT_EQ(points["points"], found["evaluations"]);
  ASSERT_EQ(points["boundary_keys"].size(), 2U);
  EXPECT_EQ(points["boundary_keys"][1]["unit"], "N/mm^2");
  EXPECT_EQ(points["boundary_keys"][1]["numbers"].size(), found["points"].get<std::size_t>());
}

TEST_F(StudyPages, WithoutTablesHaveNoStatistics) {
  const json page = page_of(R"(collect = "limit@8000"
[[vary]]
key = "tool.teeth"
values = [2]
)");
  EXPECT_TRUE(page["statistics"].is_null());
  EXPECT_EQ(page["study_points"]["points"], 1);
}

}  // namespace shown_points_test
}  // namespace robomill::jobs
