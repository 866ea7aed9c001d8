#include "robomill/jobs/sweep/study.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "robomill/io/text.hpp"
#include "robomill/jobs/sweep/samples.hpp"
#include "testing/support.hpp"

namespace robomill::jobs {
namespace study_test {

using test::rejection;

Variation ranged(const std::string& key, int count, Sampling sampling, double low = 0.0, double high = 1.0) {
  return {.keys = {key}, .range = {low, high}, .count = count, .sampling = sampling};
}

Study study_of(std::vector<Variation> vary) {
  return {.job = "lobes", .collect = {"limit@8000"}, .vary = std::move(vary)};
}

std::vector<double> column(const StudyPoints& points, std::size_t key) {
  std::vector<double> out;
  for (std::size_t i = 0; i < points.size(); ++i) out.push_back(*io::parse_number(points.values(i)[key]));
  return out;
}

/// Greatest difference between the share of points in [0, a) x [0, b) and its area, over a and b of a grid.
double star_discrepancy(const std::vector<double>& x, const std::vector<double>& y) {
  double worst = 0.0;
  constexpr int steps = 32;
  for (int i = 1; i <= steps; ++i) {
    for (int k = 1; k <= steps; ++k) {
      const double a = i / double{steps}, b = k / double{steps};
      std::size_t inside = 0;
      for (std::size_t n = 0; n < x.size(); ++n) inside += x[n] < a && y[n] < b ? 1 : 0;
      worst = std::max(worst, std::abs(static_cast<double>(inside) / static_cast<double>(x.size()) - a * b));
    }
  }
  return worst;
}

TEST(StudyPoints, OfGridsAndListsAreEachCombinationOnce) {
  const StudyPoints points(study_of({ranged("a", 3, Sampling::grid, -1.0, 1.0),
                                     {.keys = {"b"}, .values = {{"2"}, {"\"six\""}}},
                                     {.keys = {"c", "d"}, .values = {{"1", "10"}, {"2", "20"}}}}));
  ASSERT_EQ(points.size(), 12U);
  EXPECT_EQ(points.keys(), (std::vector<std::string>{"a", "b", "c", "d"}));
  EXPECT_EQ(points.values(0), (std::vector<std::string>{"-1", "2", "1", "10"}));
  EXPECT_EQ(points.values(1), (std::vector<std::string>{"-1", "2", "2", "20"}));
  EXPECT_EQ(points.values(2), (std::vector<std::string>{"-1", "\"six\"", "1", "10"}));
  EXPECT_EQ(points.values(11), (std::vector<std::string>{"1", "\"six\"", "2", "20"}));
  std::set<std::vector<std::string>> each;
  for (std::size_t i = 0; i < points.size(); ++i) each.insert(points.values(i));
  EXPECT_EQ(each.size(), points.size());
  EXPECT_EQ(points.settings(2)[1].key, "b");
  EXPECT_EQ(points.settings(2)[1].value, "\"six\"");
}

// [McKay1979]: of each key one sample stands in each of n equal parts.
TEST(StudyPoints, OfALatinHypercubeHaveEachPartOnce) {
  constexpr int n = 100;
  const StudyPoints points(study_of({ranged("a", n, Sampling::lhs, 5.0, 7.0), ranged("b", n, Sampling::lhs)}));
  ASSERT_EQ(points.size(), std::size_t{n}) << "sampled together";
  for (const std::size_t key : {0U, 1U}) {
    std::set<int> parts;
    for (const double value : column(points, key)) {
      const double share = key == 0 ? (value - 5.0) / 2.0 : value;
      ASSERT_GE(share, 0.0);
      ASSERT_LT(share, 1.0);
      parts.insert(static_cast<int>(share * n));
    }
    EXPECT_EQ(parts.size(), std::size_t{n});
  }
}

// A shift around the end keeps the discrepancy's order: that of 1,024 points of the sequence is far below the 0.04 of
// random ones.
TEST(StudyPoints, OfASobolSequenceFillTheSquareEvenly) {
  constexpr int n = 1024;
  const StudyPoints sobol(study_of({ranged("a", n, Sampling::sobol), ranged("b", n, Sampling::sobol)}));
  const StudyPoints lhs(study_of({ranged("a", n, Sampling::lhs), ranged("b", n, Sampling::lhs)}));
  ASSERT_EQ(sobol.size(), std::size_t{n});
  const double even = star_discrepancy(column(sobol, 0), column(sobol, 1));
  EXPECT_LT(even, 0.012);
  EXPECT_LT(even, star_discrepancy(column(lhs, 0), column(lhs, 1)));
}

TEST(StudyPoints, DependOnTheSeedAlone) {
  Study study = study_of({ranged("a", 10, Sampling::lhs), ranged("b", 10, Sampling::sobol)});
  const StudyPoints one(study), again(study);
  ASSERT_EQ(one.size(), 100U) << "two kinds of samples are combined";
  for (std::size_t i = 0; i < one.size(); ++i) EXPECT_EQ(one.values(i), again.values(i));
  study.seed = 2;
  const StudyPoints other(study);
  EXPECT_NE(one.values(0), other.values(0));
}

// Each point once, as a combination of what is not sampled and a sample.
TEST(StudyPoints, AreCombinationsEachWithAllSamples) {
  const StudyPoints points(study_of({ranged("a", 4, Sampling::sobol),
                                     {.keys = {"b", "c"}, .values = {{"1", "10"}, {"2", "20"}}},
                                     ranged("d", 3, Sampling::lhs),
                                     ranged("e", 2, Sampling::grid),
                                     ranged("f", 4, Sampling::sobol)}));
  ASSERT_EQ(points.combinations(), 4U);
  ASSERT_EQ(points.samples(), 12U);
  std::set<std::size_t> each;
  for (std::size_t c = 0; c < points.combinations(); ++c) {
    const std::vector<io::TomlSetting> settled = points.settled(c);
    ASSERT_EQ(settled.size(), 3U);
    EXPECT_EQ(settled[2].key, "e");
    for (std::size_t s = 0; s < points.samples(); ++s) {
      const std::size_t point = points.point(c, s);
      EXPECT_TRUE(each.insert(point).second);
      ASSERT_LT(point, points.size());
      const std::vector<std::string> values = points.values(point);
      EXPECT_EQ(values[1], settled[0].value);
      EXPECT_EQ(values[2], settled[1].value);
      EXPECT_EQ(values[4], settled[2].value);
    }
  }
  EXPECT_EQ(each.size(), points.size());
}

TEST(StudyPoints, OfIndicesAreItsSamplesInTheirOrder) {
  Study study = study_of({ranged("a", 8, Sampling::sobol, 0.0, 1.0),
                          {.keys = {"b"}, .values = {{"1"}, {"2"}}},
                          ranged("c", 8, Sampling::sobol, 0.0, 1.0)});
  study.sensitivity = SensitivityTask{.samples = 8};
  const StudyPoints points(study);
  const Shares samples = saltelli_samples(8, 2, 1);
  ASSERT_EQ(points.samples(), samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const std::vector<std::string> values = points.values(points.point(1, i));
    EXPECT_EQ(*io::parse_number(values[0]), samples[i][0]);
    EXPECT_EQ(values[1], "2");
    EXPECT_EQ(*io::parse_number(values[2]), samples[i][1]);
  }
}

TEST(Study, RejectsWhatItCannotVary) {
  const auto says = [](std::vector<Variation> vary) {
    return rejection([&] { study_of(std::move(vary)).validate(); });
  };
  EXPECT_EQ(says({}), "vary: must name a key at least. Write [[vary]] above each");
  EXPECT_EQ(says({ranged("a", 1, Sampling::grid)}),
            "vary[0]: must have a count of 1 to 10000000, or of 2 and more on a grid");
  EXPECT_EQ(says({ranged("a", 3, Sampling::grid, 2.0, 1.0)}), "vary[0]: must have values, or a range that rises");
  EXPECT_EQ(says({ranged("a", 3, Sampling::grid), ranged("a", 3, Sampling::grid)}), "vary[1].key: varies a twice");
  EXPECT_EQ(
      says({ranged("a", 3, Sampling::lhs), ranged("b", 4, Sampling::lhs)}),
      "vary[1].count = 4; must be 3, as of the other keys that are sampled in this way. They are sampled together");
  EXPECT_NE(says({ranged("a", 100'000, Sampling::grid), ranged("b", 100'000, Sampling::grid)}).find("at most 1e+09"),
            std::string::npos);
}

}  // namespace study_test
}  // namespace robomill::jobs
