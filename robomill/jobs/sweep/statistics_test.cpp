#include "robomill/jobs/sweep/statistics.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/parallel.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/json.hpp"
#include "robomill/io/table.hpp"
#include "robomill/jobs/sweep.hpp"
#include "testing/jobs/study_cut.hpp"
#include "testing/support.hpp"

namespace robomill::jobs {
namespace statistics_test {

using test::Folder;
using test::rejection;
using test_support::study_cut;

constexpr const char* head = R"(
[study]
job = "lobes"
base = "lobes.toml"
)";

/// Two keys on a grid.
std::string grid(int first, int second) {
  return "[[vary]]\nkey = \"cut.radial_depth_mm\"\nrange = [2, 9]\ncount = " + std::to_string(first) +
         "\n[[vary]]\nkey = \"coefficients.tangential_n_per_mm2\"\nrange = [300, 1500]\ncount = " +
         std::to_string(second) + "\n";
}

constexpr const char* boundary = "[boundary]\nvalue = \"abs_mu@8000,3\"\nhalvings = 3\n";

class Studies : public ::testing::Test {
 protected:
  Studies() { folder_.file("lobes.toml", study_cut()); }
  SweepResult run(const std::string& study, const std::string& into) {
    folder_.file("study.toml", head + study);
    return again(into);
  }
  SweepResult again(const std::string& into, bool status = false) {
    return run_sweep({.study = folder_.at("study.toml"), .folder = folder_.at(into), .status = status});
  }
  [[nodiscard]] std::string bytes(const std::string& name) const { return io::read_file(folder_.at(name)); }
  [[nodiscard]] io::Json statistics(const std::string& into) const {
    return io::parsed(bytes(into + "/statistics.json"));
  }
  [[nodiscard]] std::vector<std::vector<double>> rows(const std::string& name) const {
    std::vector<std::string> warnings;
    std::vector<std::vector<double>> out;
    for (const io::TextTable::Row& row : io::parse_text_table(bytes(name), name, warnings).rows) {
      std::vector<double>& cells = out.emplace_back();
      for (const auto& field : row.fields) {
        cells.push_back(io::parse_cell(field).value_or(std::numeric_limits<double>::quiet_NaN()));
      }
    }
    return out;
  }

  Folder folder_;
};

/// Where lines of a full grid, row by row, cross 1: between their points linearly.
std::vector<std::pair<double, double>> crossings(const std::vector<std::vector<double>>& points, std::size_t first,
                                                 std::size_t second) {
  std::vector<std::pair<double, double>> out;
  const auto add = [&](const std::vector<double>& from, const std::vector<double>& to) {
    const double a = from[2] - 1.0, b = to[2] - 1.0;
    if ((a < 0.0) == (b < 0.0)) return;
    const double share = a / (a - b);
    out.emplace_back(from[0] + share * (to[0] - from[0]), from[1] + share * (to[1] - from[1]));
  };
  for (std::size_t i = 0; i < first; ++i) {
    for (std::size_t k = 0; k < second; ++k) {
      if (i + 1 < first) add(points[i * second + k], points[(i + 1) * second + k]);
      if (k + 1 < second) add(points[i * second + k], points[i * second + k + 1]);
    }
  }
  return out;
}

TEST_F(Studies, TraceTheBoundaryThatTheFullGridHas) {
  const SweepResult result = run(grid(4, 4) + boundary + "interpolate = false\n", "traced");
  EXPECT_TRUE(result.complete());
  const SweepResult full = run("collect = \"abs_mu@8000,3\"\n" + grid(25, 25), "full");
  EXPECT_EQ(full.points, 625U);
  EXPECT_LT(result.points, full.points / 2);
  std::vector<std::vector<double>> traced = rows("traced/boundary.csv");
  std::vector<std::pair<double, double>> expected = crossings(rows("full/results.csv"), 25, 25);
  ASSERT_EQ(traced.size(), expected.size());
  ASSERT_GT(traced.size(), 20U);
  std::ranges::sort(traced);
  std::ranges::sort(expected);
  for (std::size_t i = 0; i < traced.size(); ++i) {
    EXPECT_NEAR(traced[i][0], expected[i].first, 1e-9);
    EXPECT_NEAR(traced[i][1], expected[i].second, 1e-6);
  }
  const io::Json found = statistics("traced")["boundary"];
  EXPECT_EQ(found["evaluations"], result.points);
  EXPECT_EQ(found["grid_points"], 625);
  EXPECT_EQ(found["points"], traced.size());
  EXPECT_NEAR(found["steps"]["cut.radial_depth_mm"].get<double>(), 7.0 / 24.0, 1e-12);
  EXPECT_EQ(found["complete"], true);
  EXPECT_EQ(result.findings.size(), 2U);
  EXPECT_EQ(rows("traced/results.csv").size(), result.points);
  // Interpolated it crosses the same edges.
  const SweepResult fewer = run(grid(4, 4) + boundary, "fewer");
  EXPECT_LT(fewer.points, result.points);
  std::vector<std::vector<double>> interpolated = rows("fewer/boundary.csv");
  ASSERT_EQ(interpolated.size(), traced.size());
  std::ranges::sort(interpolated);
  for (std::size_t i = 0; i < traced.size(); ++i) {
    EXPECT_NEAR(interpolated[i][0], traced[i][0], 0.1 * 7.0 / 24.0);
    EXPECT_NEAR(interpolated[i][1], traced[i][1], 0.1 * 1200.0 / 24.0);
  }
  const io::Json counted = statistics("fewer")["boundary"];
  EXPECT_EQ(counted["evaluations"], fewer.points);
  EXPECT_EQ(counted["evaluations"].get<std::uint64_t>() + counted["interpolated"].get<std::uint64_t>(), result.points);
  EXPECT_LE(counted["beyond_error"], counted["compared"]);
  ASSERT_EQ(fewer.findings.size(), 3U);
  EXPECT_NE(fewer.findings[2].find(" more points were interpolated. Of "), std::string::npos) << fewer.findings[2];
}

TEST_F(Studies, TraceABoundaryToTheSameBytesAfterAnInterruption) {
  const std::string text = "chunk_points = 7\n" + grid(4, 4) + boundary;
  set_thread_count(1);
  const SweepResult whole = run(text, "one");
  set_thread_count(0);
  run(text, "threads");
  for (int stop_at = 0; stop_at < 6; ++stop_at) {
    std::atomic<bool> stop = false;
    int seen = 0;
    Progress stops([&](const std::string&, double) { stop = ++seen > 12 * (stop_at + 1); }, &stop);
    try {
      static_cast<void>(run_sweep({.study = folder_.at("study.toml"), .folder = folder_.at("stopped")}, stops));
    } catch (const Interrupted&) {
      EXPECT_FALSE(std::filesystem::exists(folder_.at("stopped/boundary.csv")));
      const SweepResult status = again("stopped", true);
      EXPECT_FALSE(status.complete());
      EXPECT_LT(status.done_chunks, whole.chunks);
    }
  }
  const SweepResult rest = again("stopped");
  EXPECT_LT(rest.ran_chunks, whole.chunks);
  EXPECT_EQ(rest.chunks, whole.chunks);
  EXPECT_TRUE(again("stopped", true).complete());
  for (const char* other : {"threads", "stopped"}) {
    for (const char* file : {"boundary.csv", "boundary.h5", "statistics.json", "results.csv", "results.h5"}) {
      EXPECT_EQ(bytes(std::string("one/") + file), bytes(std::string(other) + "/" + file)) << other << ": " << file;
    }
  }
}

TEST_F(Studies, SayWhereABoundaryIsNotComplete) {
  const SweepResult result = run(grid(4, 4) + boundary + "most_points = 60\n", "few");
  EXPECT_LE(result.points, 60U);
  EXPECT_EQ(statistics("few")["boundary"]["complete"], false);
  EXPECT_NE(result.findings[2].find("most_points = 60 was reached"), std::string::npos) << result.findings[2];
  const SweepResult none = run(grid(4, 4) + boundary + "level = 1e6\n", "none");
  EXPECT_EQ(statistics("none")["boundary"]["points"], 0);
  EXPECT_NE(none.findings.back().find("is not seen"), std::string::npos);
}

/// Two keys, of which the second has no influence on the limit: the feed.
constexpr const char* sampled = R"(
[[vary]]
key = "coefficients.tangential_n_per_mm2"
range = [400, 900]
sampling = "sobol"
[[vary]]
key = "cut.feed_per_tooth_mm"
range = [0.05, 0.15]
sampling = "sobol"
)";

TEST_F(Studies, GiveIndicesOfWhatMatters) {
  const SweepResult result =
      run(std::string("seed = 3\ncollect = \"limit@8000\"\n[[vary]]\nkey = \"tool.teeth\"\nvalues = [2, 3]\n") +
              sampled + "[sensitivity]\nsamples = 16\n",
          "out");
  EXPECT_EQ(result.points, 2U * 16U * 4U);
  const io::Json found = statistics("out");
  ASSERT_EQ(found["sensitivity"].size(), 2U) << "a combination of the other keys each";
  for (const io::Json& row : found["sensitivity"]) {
    EXPECT_EQ(row["status"], "found");
    EXPECT_EQ(row["samples"], 16);
    EXPECT_EQ(row["left_out"], 0);
    EXPECT_EQ(row["keys"][0], "coefficients.tangential_n_per_mm2");
    EXPECT_LE(row["indices"][0]["first"]["low"].get<double>(), 1.0);
    EXPECT_GE(row["indices"][0]["first"]["high"].get<double>(), 1.0);
    EXPECT_EQ(row["indices"][1]["first"]["value"], 0.0);
    EXPECT_EQ(row["indices"][1]["total"]["value"], 0.0);
  }
  EXPECT_EQ(found["sensitivity"][1]["at"]["tool.teeth"], "3");
  EXPECT_FALSE(found.contains("probability"));
  EXPECT_NE(result.findings[0].find("limit@8000 at tool.teeth = 2: Sobol' indices from 16 samples"), std::string::npos)
      << result.findings[0];
}

// What they count is what a table of the points shows.
TEST_F(Studies, GiveProbabilitiesAndTheRobustOptimum) {
  constexpr const char* samples = R"(
[[vary]]
key = "cut.radial_depth_mm"
values = [2, 6, 12]
[[vary]]
key = "coefficients.tangential_n_per_mm2"
range = [400, 900]
count = 32
sampling = "sobol"
[probability]
value = ["limit@8000", "limit@9500"]
at_least = 16
)";
  const SweepResult result = run("collect = \"limit@8000\"\n" + std::string(samples), "out");
  EXPECT_EQ(result.points, 96U);
  const io::Json found = statistics("out")["probability"];
  ASSERT_EQ(found["rows"].size(), 6U);
  std::map<double, std::vector<std::vector<double>>> by_depth;
  for (const std::vector<double>& row : rows("out/results.csv")) by_depth[row[0]].push_back({row[2], row[3]});
  double best = 0.0;
  for (const io::Json& row : found["rows"]) {
    const double depth = std::stod(row["at"]["cut.radial_depth_mm"].get<std::string>());
    const std::size_t place = row["value"] == "limit@8000" ? 0 : 1;
    if (depth == 12.0) {
      EXPECT_EQ(row["left_out"], 32) << "no cut is wider than its tool";
      EXPECT_EQ(row["points"], 0);
      EXPECT_TRUE(row["probability"]["value"].is_null());
      continue;
    }
    std::vector<double> limits;
    for (const std::vector<double>& values : by_depth[depth]) limits.push_back(values[place]);
    std::ranges::sort(limits);
    const auto holding = std::ranges::count_if(limits, [](double limit) { return limit >= 16.0; });
    EXPECT_EQ(row["holding"], holding);
    EXPECT_EQ(row["infinite"], std::ranges::count(limits, std::numeric_limits<double>::infinity()));
    EXPECT_EQ(row["probability"]["value"], static_cast<double>(holding) / 32.0);
    EXPECT_NEAR(row["worst"].get<double>(), limits[1], 1e-12) << "1 of 32 is below, at most 5 %";
    best = std::max(best, limits[1]);
  }
  EXPECT_NEAR(found["optimum"]["worst"].get<double>(), best, 1e-12);
  EXPECT_EQ(found["equal"], 0);
}

TEST_F(Studies, RejectWhatHasNoBoundaryOrSamples) {
  const auto says = [&](const std::string& text) { return rejection([&] { run(text, "out"); }); };
  const std::string collect = "collect = \"limit@8000\"\n";
  const std::string counted =
      std::string(sampled).insert(std::string(sampled).find("sampling"), "count = 4\n") + "count = 4\n";
  EXPECT_NE(says(counted + boundary).find("must be a range on a grid"), std::string::npos);
  EXPECT_NE(says(grid(40, 40) + boundary + "most_points = 100\n").find("must be at least the 1600 of the coarse grid"),
            std::string::npos);
  EXPECT_NE(says(collect + grid(4, 4) + boundary + "[sensitivity]\nsamples = 8\n").find("must stand alone"),
            std::string::npos);
  EXPECT_NE(says(collect + grid(4, 4) + "[sensitivity]\nsamples = 8\n").find("needs keys with sampling"),
            std::string::npos);
  EXPECT_NE(says(collect + sampled + "[sensitivity]\nsamples = 12\n").find("must be a power of two"),
            std::string::npos);
  EXPECT_NE(says(collect + counted + "[sensitivity]\nsamples = 8\n").find("must be sensitivity.samples = 8"),
            std::string::npos);
  EXPECT_NE(says(collect + grid(4, 4) + "[probability]\nvalue = \"limit@8000\"\nat_most = 1\n")
                .find("needs keys that are sampled"),
            std::string::npos);
  EXPECT_NE(says(collect + counted + "[probability]\nvalue = \"limit@8000\"\n").find("must have at_least or at_most"),
            std::string::npos);
  folder_.file("study.toml", head + grid(4, 4) + boundary);
  EXPECT_NE(rejection([&] {
              static_cast<void>(
                  run_sweep({.study = folder_.at("study.toml"), .folder = folder_.at("out"), .shard = 1, .shards = 2}));
            }).find("shard: is not for a study with [boundary]"),
            std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder_.at("out")));
}

}  // namespace statistics_test
}  // namespace robomill::jobs
