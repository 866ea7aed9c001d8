#include "testing/modal/posture_verdict.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "testing/support.hpp"

namespace robomill::modal::testing {
namespace posture_verdict_test {

/// An arm that is stiffer by a factor: its limits are deeper by as much.
PosturePredictor stiffer(const SimulatedArm& arm, double factor) {
  return [&arm, factor](const Eigen::VectorXd& joints) {
    ModalModel out = arm.modes(joints, std::numeric_limits<double>::infinity());
    for (Mode& mode : out.modes) mode.right /= factor;
    return out;
  };
}

int chattering(const PostureVerdicts& verdicts) {
  int out = 0;
  for (const JudgedCut& cut : verdicts.cuts()) out += cut.chatters ? 1 : 0;
  return out;
}

// Two methods, one in time with loss of contact, one by multipliers, from the same modes.
TEST(PostureVerdict, OfTheTrueModesIsThatOfTheSimulation) {
  VerdictScore score;
  int chatter = 0;
  for (int seed = 0; seed < test::seeds(20); ++seed) {
    const SimulatedArm arm(static_cast<std::uint64_t>(seed));
    const PostureVerdicts verdicts(arm, {.cuts = 8, .postures = 2});
    chatter += chattering(verdicts);
    score += verdicts.judge(stiffer(arm, 1.0));
  }
  const VerdictCounts all = score.all();
  EXPECT_GE(all.all(), 32);
  EXPECT_GE(all.right, 0.96 * all.all());
  EXPECT_GT(chatter, 0.25 * all.all());
  EXPECT_LT(chatter, 0.75 * all.all());
  EXPECT_EQ(score.family[0].all(), all.all() / 2);
  EXPECT_EQ(score.family[1].all(), all.all() / 4);
}

// All cuts end at twice the limit: an arm of five times the stiffness has chatter in none, one of a hundredth in all
// but the shallowest.
TEST(PostureVerdict, CountsOnWhichSideItIsWrong) {
  const SimulatedArm arm(3);
  const PostureVerdicts verdicts(arm, {.cuts = 12, .postures = 1, .seed = 5});
  const int all = static_cast<int>(verdicts.cuts().size()), chatter = chattering(verdicts);
  const VerdictCounts too_stiff = verdicts.judge(stiffer(arm, 5.0)).all();
  EXPECT_EQ(too_stiff.wrongly_stable, chatter);
  EXPECT_EQ(too_stiff.wrongly_unstable, 0);
  EXPECT_EQ(too_stiff.right, all - chatter);
  const VerdictCounts too_soft = verdicts.judge(stiffer(arm, 0.01)).all();
  EXPECT_GE(too_soft.wrongly_unstable, all - chatter - 2);
  EXPECT_LE(too_soft.wrongly_stable, 1);
  EXPECT_EQ(too_soft.all(), all);
}

}  // namespace posture_verdict_test
}  // namespace robomill::modal::testing
