#include "robomill/decision/limit_breakdown.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace robomill::decision {
namespace limit_breakdown_test {

// A mode's share is that of the speeds whose limit it sets: two modes far apart in stiffness, each in its own
// direction.
TEST(LimitShare, CountsTheSpeedsOfEachMode) {
  modal::ModalModel tool, workpiece;
  tool.modes.resize(3);
  workpiece.modes.resize(2);
  std::vector<stability::Limit> limits;
  EXPECT_EQ(limit_share(limits, tool, workpiece).tool.size(), 0);  // no limit, no share
  const auto add = [&limits](modal::ModeId mode, int speeds) {
    for (int i = 0; i < speeds; ++i) {
      limits.push_back({.status = stability::Limit::Status::found, .mode = mode});
    }
  };
  add({2}, 3);
  add({3}, 1);
  add({2, modal::ModeOwner::workpiece}, 4);
  limits.push_back({});  // stable in range
  add({}, 5);            // of measured FRFs: no mode is known
  const LimitShare share = limit_share(limits, tool, workpiece);
  EXPECT_EQ(share.tool, Eigen::Vector3d(0.0, 0.375, 0.125));
  EXPECT_EQ(share.workpiece, Eigen::Vector2d(0.0, 0.5));
}

}  // namespace limit_breakdown_test
}  // namespace robomill::decision
