#include "robomill/cutting/unusual_cut.hpp"

#include <gtest/gtest.h>

#include "robomill/base/units.hpp"

namespace robomill::cutting {
namespace unusual_cut_test {

constexpr double m_per_min = 1.0 / units::minute;

TEST(UnusualCut, FeedOfAToothIsComparedWithTheDiameter) {
  // 12 mm written in inches, a feed ten times too fast, and a feed of the path for one of a tooth.
  for (const auto& [diameter_mm, feed_mm] : {FromTo{0.472, 0.05}, FromTo{6.0, 0.6}, FromTo{12.0, 5.0}}) {
    const auto found = unusual_cut(diameter_mm * units::mm, feed_mm * units::mm, {0.0, 0.0});
    ASSERT_EQ(found.size(), 1u) << diameter_mm;
    EXPECT_NE(found[0].find("up to 8 % of the diameter"), std::string::npos) << found[0];
  }
}

TEST(UnusualCut, SpeedsAreUnusualWhereAllAre) {
  EXPECT_EQ(unusual_cut(0.012, 0.0, {5.65 * m_per_min, 5.65 * m_per_min}).size(), 1u);  // 150 rev/s as rpm
  EXPECT_EQ(unusual_cut(0.012, 0.0, {9000.0 * m_per_min, 20000.0 * m_per_min}).size(), 1u);
  EXPECT_TRUE(unusual_cut(0.012, 0.0, {1.0 * m_per_min, 300.0 * m_per_min}).empty());  // a chart from a slow speed on
}

// A micro mill, a high-feed cutter of 16 mm, a face mill in steel, a tap-speed slot in titanium, a router in foam.
TEST(UnusualCut, OrdinaryCutsPass) {
  struct Cut {
    double diameter_mm, feed_mm, speed_m_per_min;
  };
  for (const Cut& cut : {Cut{0.3, 0.006, 25.0}, Cut{16.0, 1.0, 200.0}, Cut{80.0, 0.25, 180.0}, Cut{10.0, 0.05, 30.0},
                         Cut{20.0, 0.4, 1500.0}}) {
    const double speed = cut.speed_m_per_min * m_per_min;
    EXPECT_TRUE(unusual_cut(cut.diameter_mm * units::mm, cut.feed_mm * units::mm, {speed, speed}).empty())
        << cut.diameter_mm;
  }
}

TEST(UnusualCut, WhatIsNotKnownIsNotCompared) {
  EXPECT_TRUE(unusual_cut(0.0, 0.005, {0.0, 0.0}).empty());
}

}  // namespace unusual_cut_test
}  // namespace robomill::cutting
