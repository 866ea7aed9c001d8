#include "robomill/cutting/engagement.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "testing/cutting/cutters.hpp"

namespace robomill::cutting {
namespace engagement_test {

using std::numbers::pi;
using testing::degree;

// Source: docs/frames.md. Lead tips the axis forward along the feed, tilt then turns it about the feed.
TEST(FeedFromTool, LeadTipsTheAxisForwardAndTiltToTheRight) {
  const Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d led = feed_from_tool(10.0 * degree, 0.0) * axis;
  EXPECT_NEAR(led.x(), std::sin(10.0 * degree), 1e-15);
  EXPECT_NEAR(led.y(), 0.0, 1e-15);
  const Eigen::Vector3d tilted = feed_from_tool(0.0, 10.0 * degree) * axis;
  EXPECT_NEAR(tilted.x(), 0.0, 1e-15);
  EXPECT_NEAR(tilted.y(), -std::sin(10.0 * degree), 1e-15);
  Eigen::Matrix3d by_hand;
  const double l = 0.3;
  const double t = -0.2;
  by_hand << std::cos(l), 0.0, std::sin(l),                                //
      std::sin(t) * std::sin(l), std::cos(t), -std::sin(t) * std::cos(l),  //
      -std::cos(t) * std::sin(l), std::sin(t), std::cos(t) * std::cos(l);
  EXPECT_NEAR((feed_from_tool(l, t) - by_hand).norm(), 0.0, 1e-15);
}

/// Two rings, one of them with two arcs.
Engagement two_rings() {
  Engagement engagement;
  engagement.slices = {{.radius_m = 2e-3, .position_rad = 1.1, .width_m = 1e-4},
                       {.radius_m = 3e-3, .height_m = 1e-3, .position_rad = 0.4, .width_m = 2e-4}};
  engagement.arcs = {
      {.entry_rad = 0.2, .exit_rad = 0.9}, {.entry_rad = 2.0, .exit_rad = 2.5}, {.entry_rad = 6.0, .exit_rad = 7.5}};
  engagement.first_arc = {0, 2, 3};
  engagement.feed_from_tool = feed_from_tool(0.3, -0.4);
  return engagement;
}

TEST(Engagement, AreasAreSumsOverArcs) {
  const Engagement engagement = two_rings();
  EXPECT_EQ(engagement.of(0).size(), 2U);
  EXPECT_EQ(engagement.of(1).size(), 1U);
  EXPECT_FALSE(engagement.empty());
  EXPECT_NEAR(patch_area_m2(engagement), 2e-3 * 1e-4 * 1.2 + 3e-3 * 2e-4 * 1.5, 1e-18);
  double chip = 0.0;  // midpoint rule over the angle
  for (std::size_t i = 0; i < 2; ++i) {
    const EdgeSlice& s = engagement.slices[i];
    for (const Arc& arc : engagement.of(i)) {
      constexpr int count = 20000;
      const double step = (arc.exit_rad - arc.entry_rad) / count;
      for (int k = 0; k < count; ++k) {
        const double phi = arc.entry_rad + (k + 0.5) * step;
        const Eigen::Vector3d n(std::sin(s.position_rad) * std::sin(phi), std::sin(s.position_rad) * std::cos(phi),
                                -std::cos(s.position_rad));
        chip += (engagement.feed_from_tool * n).x() * s.radius_m * s.width_m * step;
      }
    }
  }
  EXPECT_NEAR(chip_area_m2(engagement), chip, 1e-8 * std::abs(chip));
}

TEST(Engagement, WithoutArcsHasNoArea) {
  Engagement engagement;
  engagement.first_arc = {0};
  EXPECT_TRUE(engagement.empty());
  EXPECT_EQ(patch_area_m2(engagement), 0.0);
  EXPECT_EQ(chip_area_m2(engagement), 0.0);
}

}  // namespace engagement_test
}  // namespace robomill::cutting
