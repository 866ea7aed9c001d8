#include "robomill/modal/files/hit_files/hit_sets.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "robomill/modal/files/found_hits.hpp"
#include "testing/support.hpp"

namespace robomill::modal {
namespace hit_sets_test {

namespace fs = std::filesystem;

TEST(HitSets, FilesOfOneMeasurementDifferByWordsAlone) {
  EXPECT_EQ(set_key("impact_pt8.txt"), "pt8");
  EXPECT_EQ(set_key("Accel-pt8.txt"), "pt8");
  EXPECT_EQ(set_key("force1.csv"), "1");
  EXPECT_EQ(set_key("accelerometer1.csv"), "1");
  EXPECT_EQ(set_key("tap_x_3_Hammer.lvm"), "tap_x_3");
  EXPECT_EQ(set_key("f_12.csv"), set_key("a_12.csv"));
  EXPECT_NE(set_key("force_1.csv"), set_key("acc_2.csv"));
  EXPECT_NE(set_key("hit_1.csv"), set_key("hit_2.csv"));
  EXPECT_EQ(set_key("across.csv"), "across") << "no accelerometer";
  EXPECT_TRUE(is_named_force("Hammer 3.csv"));
  EXPECT_FALSE(is_named_force("acc_3.csv"));
  EXPECT_FALSE(is_named_force("hit_3.csv"));
  const auto sets = sets_by_name({"d/acc_1.csv", "d/acc_2.csv", "d/force_1.csv", "d/hit.csv", "e/force_2.csv"});
  ASSERT_EQ(sets.size(), 4U);
  EXPECT_EQ(sets[0], (std::vector<fs::path>{"d/acc_1.csv", "d/force_1.csv"}));
}

class HitSetsTest : public ::testing::Test {
 protected:
  /// A record of a force alone, or of what follows it.
  void put(const std::string& name, const std::string& header, bool force, const char* time = "{:.5f},",
           double scale = 1.0) {
    std::string text = header;
    for (int i = 0; i < 900; ++i) {
      const double pushed = i >= 60 && i < 66 ? 50.0 * std::sin(3.14159 * (i - 59.5) / 6.0) : 0.0;
      const double moved = i < 60 ? 0.0 : std::exp(-0.01 * (i - 60)) * std::sin(0.3 * (i - 60));
      text += fmt::format(fmt::runtime(time), i * 1e-3) + fmt::format("{:.6f}\n", scale * (force ? pushed : moved));
    }
    folder_.file(name, text);
  }
  FoundHits found() { return find_hits(folder_.path(), folder_.path(), "made_up.csv"); }
  test::Folder folder_;
};

TEST_F(HitSetsTest, FilesThatAreNoHitsAloneAreOneTogether) {
  put("acc_x_1.csv", "time_s,ax_m_per_s2\n", false);
  put("force_x_1.csv", "time_s,force_n\n", true);
  put("acc_x_2.csv", "time_s,ax_m_per_s2\n", false);
  const FoundHits hits = found();
  ASSERT_EQ(hits.hits.size(), 1U) << (hits.left_out.empty() ? "" : hits.left_out.front());
  const FoundHit& hit = hits.hits[0];
  EXPECT_EQ(hit.files, (std::vector<std::string>{"force_x_1.csv", "acc_x_1.csv"}));
  EXPECT_EQ(hit.name(), "force_x_1.csv + acc_x_1.csv");
  EXPECT_NEAR(hit.sample_rate_hz, 1000.0, 1e-6);
  EXPECT_EQ(hit.time, "time_s");
  EXPECT_EQ(hit.first(ColumnGuess::Role::force)->name, "force_n");
  EXPECT_EQ(hit.first(ColumnGuess::Role::response)->name, "ax_m_per_s2");
  EXPECT_EQ(hit.guess.force_direction, "x");
  ASSERT_EQ(hits.left_out.size(), 1U);
  EXPECT_NE(hits.left_out[0].find("acc_x_2.csv: no column looks like a hammer's force"), std::string::npos);
}

// Without names of columns the files' names say which is which: an acceleration may have the sharper peak.
TEST_F(HitSetsTest, TheFilesNameSaysWhatAColumnIs) {
  put("impact_8.txt", "", true, "{:.2e} ");
  std::string sharp;
  for (int i = 0; i < 900; ++i) sharp += fmt::format("{:.6g} {}\n", i * 1e-3, i == 63 ? 90.0 : 0.001 * std::sin(i));
  folder_.file("accel-8.txt", sharp);
  const FoundHits hits = found();
  ASSERT_EQ(hits.hits.size(), 1U) << (hits.left_out.empty() ? "" : hits.left_out.front());
  EXPECT_EQ(hits.hits[0].files, (std::vector<std::string>{"impact_8.txt", "accel-8.txt"}));
  EXPECT_EQ(hits.hits[0].time, "1");
  EXPECT_EQ(hits.hits[0].first(ColumnGuess::Role::force)->name, "2");
  EXPECT_EQ(hits.hits[0].first(ColumnGuess::Role::response)->name, "2");
  EXPECT_NEAR(hits.hits[0].sample_rate_hz, 1000.0, 1e-3);
}

TEST_F(HitSetsTest, SaysWhyFilesDoNotGoTogether) {
  put("force_1.csv", "time_s,force_n\n", true);
  put("acc_1.csv", "time_s,ax_m_per_s2\n", false);
  std::string slow = "time_s,ax_m_per_s2\n";
  for (int i = 0; i < 900; ++i) slow += fmt::format("{:.6f},{}\n", i * 2e-3, std::sin(0.1 * i));
  folder_.file("acc_1.csv", slow);
  const FoundHits hits = found();
  EXPECT_TRUE(hits.hits.empty());
  ASSERT_EQ(hits.left_out.size(), 1U);
  EXPECT_NE(hits.left_out[0].find("force_1.csv + acc_1.csv"), std::string::npos) << hits.left_out[0];
  EXPECT_NE(hits.left_out[0].find("was sampled at"), std::string::npos) << hits.left_out[0];
}

// Two files that are given have any names.
TEST_F(HitSetsTest, TwoFilesThatAreGivenMayHaveAnyNames) {
  put("one.csv", "t,resp (m/s^2)\n", false);
  put("two.csv", "t,kraft (N)\n", true);
  EXPECT_TRUE(found().hits.empty());
  const FoundHits given = find_hits({folder_.at("one.csv"), folder_.at("two.csv")}, folder_.path());
  ASSERT_EQ(given.hits.size(), 1U);
  EXPECT_EQ(given.hits[0].files, (std::vector<std::string>{"two.csv", "one.csv"}));
}

TEST_F(HitSetsTest, ThreeFilesAreAMeasurementToo) {
  put("force_1.csv", "t,value\n", true);
  put("acc_1.csv", "t,value x\n", false);
  put("resp_1.csv", "t,value y\n", false);
  const FoundHits hits = found();
  ASSERT_EQ(hits.hits.size(), 1U) << (hits.left_out.empty() ? "" : hits.left_out.front());
  EXPECT_EQ(hits.hits[0].files.front(), "force_1.csv");
  EXPECT_EQ(hits.hits[0].guess.with(ColumnGuess::Role::response).size(), 2U);
}

}  // namespace hit_sets_test
}  // namespace robomill::modal
