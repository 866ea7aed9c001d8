// Whether the tool cuts at a known speed, of energies that are given and speeds that a posterior finds.
#include "robomill/monitor/orders/cut_follower.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "robomill/monitor/orders/spectra.hpp"
#include "robomill/monitor/orders/speed_posterior.hpp"

namespace cut_follower_test {

using robomill::monitor::CutFollower;
using robomill::monitor::hann_kernel;
using robomill::monitor::ResidualFamily;
using robomill::monitor::Spectrum;
using robomill::monitor::SpeedPosterior;

constexpr double hop_s = 0.025;
constexpr int ring = 12, entry = 16, unsettled = 40, loudest = 400;  // hops

/// What is believed of the speed about a hint of 80 Hz after hops of lines of amplitude 1 over a flat floor.
SpeedPosterior after(std::span<const double> lines_hz, double floor, int hops = 20) {
  Spectrum like{.seconds = 0.15, .step_hz = 2.5, .line = {}};
  like.line.resize(2049);
  std::vector<float> power(like.line.size(), static_cast<float>(floor));
  for (std::size_t i = 0; i < power.size(); ++i) {
    for (const double hz : lines_hz) {
      const double h = hann_kernel((static_cast<double>(i) * like.step_hz - hz) * like.seconds);
      power[i] += static_cast<float>(h * h);
    }
  }
  SpeedPosterior out({.hop_s = hop_s, .highest_hz = 5000.0, .teeth = 3});
  out.set_hint(80.0);
  for (int k = 0; k < hops; ++k) {
    out.predict(SpeedPosterior::Motion::free);
    out.observe(power, like);
    out.conclude();
  }
  return out;
}

SpeedPosterior comb(double rotation_hz, double floor) {
  std::vector<double> lines_hz;
  for (int k = 1; k <= 8; ++k) lines_hz.push_back(3 * k * rotation_hz);
  return after(lines_hz, floor);
}

const SpeedPosterior& found() {
  static const SpeedPosterior out = comb(80.0, 1e-4);
  return out;
}
const SpeedPosterior& lost() {
  static const SpeedPosterior out = after({}, 1.0);
  return out;
}

/// `hops` of S and of the whole, which is a tenth more where it is not given.
void run(CutFollower& cut, int hops, double synchronous, const SpeedPosterior& speed, double whole = 0.0,
         bool chatter = false) {
  const ResidualFamily now{.whole = whole > 0.0 ? whole : 1.1 * synchronous, .synchronous = synchronous};
  for (int k = 0; k < hops; ++k) cut.step(now, speed, chatter);
}

CutFollower cutting(double synchronous = 1.0) {
  CutFollower out(hop_s);
  run(out, 100, synchronous, found());
  return out;
}

TEST(CutFollower, KnowsTheCutWhereTheSpeedIsNarrowAndExplainsIt) {
  // A comb, the same under noise, and a line alone at a high multiple of the hint.
  const SpeedPosterior weak = comb(80.0, 0.035), strong = comb(80.0, 0.02);
  const SpeedPosterior lone = after(std::array{40 * 80.0}, 1e-4);
  ASSERT_GT(weak.known(), 0.4);
  ASSERT_LT(weak.share(), 0.35);
  ASSERT_GT(strong.share(), 0.35);
  ASSERT_LT(lone.known(), 0.4);
  ASSERT_GT(lone.share(), 0.35);
  for (const SpeedPosterior* speed : {&weak, &lone, &lost()}) {
    CutFollower cut(hop_s);
    run(cut, 100, 1.0, *speed);
    EXPECT_FALSE(cut.known() || cut.has_cut());
  }
  for (const SpeedPosterior* speed : {&strong, &found()}) {
    CutFollower cut(hop_s);
    run(cut, 1, 1.0, *speed);
    EXPECT_TRUE(cut.known() && cut.has_cut());
  }
}

TEST(CutFollower, TheSpeedStaysKnownUntilTheToolLeaves) {
  CutFollower cut = cutting();
  run(cut, 100, 0.11, lost());
  EXPECT_TRUE(cut.known());
  EXPECT_FALSE(cut.unsettled());
  run(cut, 1, 0.09, lost());
  EXPECT_FALSE(cut.known());
  EXPECT_FALSE(cut.unsettled());  // nothing is doubtful in air
  EXPECT_TRUE(cut.has_cut());
}

TEST(CutFollower, WhereTheOrdersVanishAndTheWholeStaysTheSpeedIsAnother) {
  CutFollower cut = cutting();
  run(cut, 1, 0.39, lost(), 1.1);
  EXPECT_FALSE(cut.known());
  for (int k = 0; k < unsettled; ++k, run(cut, 1, 0.39, lost(), 1.1)) EXPECT_TRUE(cut.unsettled()) << k;
  EXPECT_FALSE(cut.unsettled());

  for (const auto& [synchronous, whole] : {std::array{0.41, 1.1}, {0.39, 0.77}, {0.2, 0.54}}) {
    CutFollower still = cutting();
    run(still, 1, synchronous, lost(), whole);
    EXPECT_TRUE(still.known()) << synchronous << " of " << whole;
  }
  CutFollower slowly = cutting();
  for (int k = 0; k < 28; ++k) run(slowly, 1, std::exp(-k * std::log(2.4) / ring), lost(), 1.1);
  EXPECT_TRUE(slowly.known());
  CutFollower chatters = cutting();
  run(chatters, 1, 0.39, lost(), 1.1, true);
  EXPECT_TRUE(chatters.known());
}

TEST(CutFollower, TheToolEntersWhereTheEnergyGrowsByFour) {
  const auto hops_of_entry = [](double energy, bool chatter, const SpeedPosterior& speed) {
    CutFollower cut(hop_s);
    run(cut, 100, 1.0, lost());
    EXPECT_FALSE(cut.enters());
    int out = 0;
    for (int k = 0; k < 100; ++k) {
      run(cut, 1, energy, speed, 0.0, chatter);
      if (cut.enters()) ++out;
    }
    return out;
  };
  EXPECT_EQ(hops_of_entry(3.9, false, lost()), 0);
  EXPECT_EQ(hops_of_entry(4.1, true, lost()), 0);
  EXPECT_EQ(hops_of_entry(4.1, false, lost()), ring + entry - 1);
  EXPECT_EQ(hops_of_entry(4.1, false, found()), entry);  // what is known enters no more
  CutFollower deeper = cutting();
  run(deeper, 1, 100.0, found());
  EXPECT_FALSE(deeper.enters());
}

TEST(CutFollower, AnIdlingSpindleIsNoCut) {
  CutFollower cut = cutting();
  run(cut, 1, 0.01, lost());
  for (int k = 0; k < 10; ++k) {
    run(cut, 1, 0.029, found());
    EXPECT_FALSE(cut.known());
  }
  CutFollower light = cut;
  run(light, 1, 0.031, found());
  EXPECT_TRUE(light.known());
  // The loudest fades by e in 10 s.
  run(cut, loudest - 11, 0.01, lost());
  EXPECT_NEAR(cut.loudest(), std::exp(-1.0), 1e-3);
  run(cut, 1, 0.029, found());
  EXPECT_TRUE(cut.known());
}

// What it was shows in what anchors it: half of it.
TEST(CutFollower, FollowsTheEnergySlowlyAndNotInChatter) {
  const auto anchors = [](const CutFollower& cut, double synchronous) {
    return cut.anchored({.whole = synchronous, .synchronous = synchronous});
  };
  CutFollower cut = cutting();
  EXPECT_TRUE(anchors(cut, 0.51));
  EXPECT_FALSE(anchors(cut, 0.49));
  EXPECT_TRUE(cut.anchored({.whole = 5.9, .synchronous = 0.6}));
  EXPECT_FALSE(cut.anchored({.whole = 6.1, .synchronous = 0.6}));
  run(cut, 100, 3.0, found(), 0.0, true);
  run(cut, 100, 3.0, lost());
  EXPECT_TRUE(anchors(cut, 0.51));
  run(cut, 10, 3.0, found());
  const double followed = 3.0 - 2.0 * std::pow(0.9, 10);
  EXPECT_TRUE(anchors(cut, 0.51 * followed));
  EXPECT_FALSE(anchors(cut, 0.49 * followed));
  CutFollower chatters(hop_s);
  run(chatters, 100, 1.0, found(), 0.0, true);
  EXPECT_FALSE(chatters.known() || anchors(chatters, 1.0));
}

TEST(CutFollower, SwingAndSteadinessAreThoseOfTheLastRing) {
  CutFollower cut = cutting();
  EXPECT_EQ(cut.swing(), 0.0);
  EXPECT_TRUE(cut.steady());
  const SpeedPosterior near = comb(80.6, 1e-4), far = comb(80.7, 1e-4);
  ASSERT_NEAR(near.rotation_hz(), 80.6, 0.02);
  ASSERT_NEAR(far.rotation_hz(), 80.7, 0.02);
  run(cut, 1, 1.5, near);
  EXPECT_TRUE(cut.steady());
  run(cut, ring, 1.0, found());
  EXPECT_EQ(cut.swing(), 0.0);
  run(cut, 1, 0.8, far);
  for (int k = 0; k < ring; ++k, run(cut, 1, 1.0, found())) {
    EXPECT_DOUBLE_EQ(cut.swing(), 0.2) << k;
    EXPECT_FALSE(cut.steady()) << k;
  }
  EXPECT_EQ(cut.swing(), 0.0);
  EXPECT_TRUE(cut.steady());
}

TEST(CutFollower, IsUnsettledForASecondAfterChatter) {
  CutFollower cut = cutting();
  cut.chatter_ended();
  for (int k = 0; k < unsettled; ++k, run(cut, 1, 1.0, found())) EXPECT_TRUE(cut.unsettled()) << k;
  EXPECT_FALSE(cut.unsettled());
  EXPECT_TRUE(cut.known());
}

TEST(CutFollower, ForgetsTheSpeedOrAll) {
  CutFollower cut = cutting();
  cut.chatter_ended();
  cut.forget_speed();
  EXPECT_FALSE(cut.known());
  EXPECT_TRUE(cut.has_cut());
  EXPECT_EQ(cut.loudest(), 1.0);
  cut.reset();
  EXPECT_FALSE(cut.known() || cut.has_cut() || cut.unsettled() || cut.enters() || cut.steady());
  EXPECT_EQ(cut.swing(), 0.0);
  run(cut, ring - 1, 1.0, found());
  EXPECT_FALSE(cut.steady());  // three tenths of a second have not passed
  run(cut, 1, 1.0, found());
  EXPECT_TRUE(cut.steady());
}

}  // namespace cut_follower_test
