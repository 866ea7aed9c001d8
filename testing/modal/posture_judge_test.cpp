#include "testing/modal/posture_judge.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "robomill/base/random.hpp"

namespace robomill::modal::testing {
namespace posture_judge_test {

double share(int part, int all) {
  return static_cast<double>(part) / static_cast<double>(all);
}

TEST(PostureJudge, FindsNoFaultInTheTruth) {
  const SimulatedArm arm(1);
  const PostureJudge judge(arm, {.bands = false});
  const PostureScore score = judge.judge([&](const Eigen::VectorXd& joints) { return arm.modes(joints); });
  EXPECT_EQ(score.missed, 0);
  EXPECT_GE(score.frequency_error.size(), 8U * 8U);
  EXPECT_GE(score.residue_error.size(), 8U * 3U);
  EXPECT_GE(score.limit_error.size(), 20U);
  EXPECT_EQ(quantile(score.frequency_error, 1.0), 0.0);
  EXPECT_EQ(quantile(score.residue_error, 1.0), 0.0);
  EXPECT_EQ(quantile(score.limit_error, 1.0), 0.0);
  EXPECT_EQ(score.too_deep, 0);
  EXPECT_EQ(score.banded, 0);
}

TEST(PostureJudge, MeasuresErrorsThatAreKnown) {
  const SimulatedArm arm(4);
  const PostureJudge judge(arm, {.bands = false});
  const PostureScore score = judge.judge([&](const Eigen::VectorXd& joints) {
    ModalModel model = arm.modes(joints);
    for (Mode& mode : model.modes) {
      mode.frequency_hz *= 1.01;
      mode.right *= 0.8;  // a limit depth is that of a structure stiffer by a quarter
    }
    for (Residual& residual : model.residuals) residual.stiffness *= 0.8;
    return model;
  });
  EXPECT_NEAR(quantile(score.frequency_error, 0.0), 0.01, 1e-9);
  EXPECT_NEAR(quantile(score.frequency_error, 1.0), 0.01, 1e-9);
  EXPECT_NEAR(quantile(score.residue_error, 0.5), 0.2, 1e-9);
  EXPECT_GT(share(score.too_deep, static_cast<int>(score.limit_error.size())), 0.6);
}

// Errors of one deviation each, told as such: 95 % and 90 % of the truth lie in the bands, as far as so few draws can
// tell.
TEST(PostureJudge, FindsTheTruthInBandsThatAreToldRightly) {
  PostureScore all;
  for (const std::uint64_t seed : {0U, 3U}) {
    const SimulatedArm arm(seed);
    const PostureJudge judge(arm, {.limits = false});
    Random random(seed, 99);
    const PostureScore score = judge.judge([&](const Eigen::VectorXd& joints) {
      ModalModel model = arm.modes(joints);
      for (Mode& mode : model.modes) {
        mode.frequency_std_hz = 0.01 * mode.frequency_hz;
        mode.damping_ratio_std = 0.05 * mode.damping_ratio;
        mode.residue_std_ratio = 0.05;
        mode.frequency_hz *= 1.0 + 0.01 * random.normal();
        mode.damping_ratio *= 1.0 + 0.05 * random.normal();
        mode.right *= 1.0 + 0.05 * random.normal();
      }
      std::sort(model.modes.begin(), model.modes.end(),
                [](const Mode& a, const Mode& b) { return a.frequency_hz < b.frequency_hz; });
      return model;
    });
    all.frequencies_in_band += score.frequencies_in_band;
    all.banded += score.banded;
    all.limits_in_band += score.limits_in_band;
    all.banded_limits += score.banded_limits;
  }
  EXPECT_NEAR(share(all.frequencies_in_band, all.banded), 0.95, 0.05);
  EXPECT_GT(share(all.limits_in_band, all.banded_limits), 0.75);
}

}  // namespace posture_judge_test
}  // namespace robomill::modal::testing
