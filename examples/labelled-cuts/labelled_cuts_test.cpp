#include "examples/labelled-cuts/labelled_cuts.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "robomill/modal/frf.hpp"

namespace labelled_cuts_test {

using namespace robomill;
using namespace robomill::examples;
using cutting::MillingDirection;

TEST(LabelledCuts, AreOfAMachineWithTheStiffnessThatIsStated) {
  const modal::FrfSet set = modal::synthesize(true_modes.model(), Eigen::VectorXd::Constant(1, 1e-3));
  EXPECT_NEAR(1.0 / std::abs(set.find(modal::parse_frf_name("xx"))->receptance(0)), 8e6, 1.0);
  EXPECT_NEAR(1.0 / std::abs(set.find(modal::parse_frf_name("yy"))->receptance(0)), 6e6, 1.0);
  EXPECT_EQ(std::abs(set.find(modal::parse_frf_name("xy"))->receptance(0)), 0.0);
}

// Both call the same cuts chatter, but for what 4 % and the slope leave open.
TEST(LabelledCuts, HaveTwoOperatorsWhoMostlyAgree) {
  const std::vector<LabelledCut> cuts = label_cuts(1);
  ASSERT_EQ(cuts.size(), 120U);
  int agree = 0, chatter = 0;
  for (const LabelledCut& cut : cuts) {
    agree += cut.chatter[0] == cut.chatter[1] ? 1 : 0;
    chatter += cut.chatter[0] ? 1 : 0;
  }
  EXPECT_GT(agree, 96);
  EXPECT_LT(agree, 120);
  EXPECT_GT(chatter, 24);
  EXPECT_LT(chatter, 96);
}

// Modes that explain the labels as well as the true ones answer for cuts as labelled, and not for the other direction.
TEST(LabelledCuts, SayWhatWasLabelledAndATapTestWhatTheMachineDoes) {
  constexpr std::uint64_t seed = 1;
  const std::vector<LabelledCut> cuts = label_cuts(seed);
  const LabelFit fit = fit_to_labels(cuts, seed);
  EXPECT_GT(fit.log_likelihood, fit.log_likelihood_of_true - 3.0);
  EXPECT_GT(std::abs(fit.modes.frequency_hz[0] / true_modes.frequency_hz[0] - 1.0), 0.2);

  const CutKind labelled, up{.direction = MillingDirection::up};
  const Question as_labelled = ask(labelled, seed), other = ask(up, seed);
  EXPECT_GT(answered(as_labelled, labelled, fit.modes.model()), 0.8);
  EXPECT_GT(answered(as_labelled, labelled, fit.modes.model()), answered(as_labelled, threshold_of(cuts)));
  EXPECT_LT(answered(other, up, fit.modes.model()), 0.75);
  const modal::ModalModel tapped = tap_test(seed);
  for (const CutKind& kind : {labelled, up}) EXPECT_GT(answered(ask(kind, seed), kind, tapped), 0.97);
}

}  // namespace labelled_cuts_test
