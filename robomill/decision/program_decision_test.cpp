#include "robomill/decision/program_decision.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "robomill/base/error.hpp"
#include "robomill/base/parallel.hpp"
#include "testing/decision/made_up_program.hpp"
#include "testing/support.hpp"

namespace robomill::decision::program_decision_test {
namespace {

using namespace made_up;

/// A range of speeds that is narrower than a step of the search may fall between two of its speeds: it counts as none.
void leave_out_narrow(std::vector<double>& times) {
  constexpr std::ptrdiff_t speeds_a_step = 5;  // of the fine grid, with both ends
  for (auto begin = times.begin(); begin != times.end();) {
    const bool holds = std::isfinite(*begin);
    const auto end = std::find_if(begin, times.end(), [&](double time) { return std::isfinite(time) != holds; });
    if (holds && end - begin < speeds_a_step) std::fill(begin, end, none);
    begin = end;
  }
}

/// The least time with γ as it is, over all pairs of speeds of a fine grid.
double exhaustive(const MadeUp& program) {
  constexpr double ratio = 1.0025;
  std::vector<double> speeds;
  for (double n = program.options.min_spindle_speed_rad_per_s; n <= program.options.max_spindle_speed_rad_per_s;
       n *= ratio) {
    speeds.push_back(n);
  }
  const auto stretch_time = [&](const ProgramStretch& stretch, double speed) {
    return time_of(program, ways_of(stretch).front(), alone(speed));
  };
  std::vector<double> first;
  std::vector<double> second;
  for (const double n : speeds) {
    first.push_back(stretch_time(program.stretches[0], n));
    second.push_back(stretch_time(program.stretches[1], n));
  }
  leave_out_narrow(first);
  leave_out_narrow(second);
  double best = none;
  for (std::size_t i = 0; i < speeds.size(); ++i) {
    for (std::size_t j = 0; j < speeds.size(); ++j) {
      const double ramp = std::abs(speeds[i] - speeds[j]) / program.options.ramp_rad_per_s2;
      best = std::min(best, first[i] + second[j] + ramp);
    }
  }
  return best;
}

// Two independent ways: the search with bounds, and every pair of speeds on a grid four times as fine.
TEST(ProgramDecision, TakesAtMostTwoPercentLongerThanExhaustiveSearch) {
  int found = 0;
  for (int seed = 1; seed <= test::seeds(200); ++seed) {
    const MadeUp program(seed);
    const ProgramDecision decision = decide_program(program.cuts, program.stretches, program, program.options);
    const double best = exhaustive(program);
    if (decision.status == ProgramDecision::Status::infeasible) continue;
    ++found;
    EXPECT_LE(decision.cutting_time_s + decision.ramp_time_s, 1.02 * best) << "seed " << seed;
  }
  EXPECT_GT(found, 5);
  RecordProperty("found", found);
}

// The same where a machine was measured, on which some cuts gain little or nothing by their feed.
TEST(ProgramDecision, SearchesTheTimeOfTheMachineWhereItIsKnown) {
  int found = 0, faster = 0;
  for (int seed = 1; seed <= test::seeds(200); ++seed) {
    MadeUp program(seed);
    program.options.feed_slack = 0.0;
    const ProgramDecision by_feeds = decide_program(program.cuts, program.stretches, program, program.options);
    program.measure();
    const ProgramDecision decision = decide_program(program.cuts, program.stretches, program, program.options);
    EXPECT_EQ(decision.status, by_feeds.status);
    if (decision.status == ProgramDecision::Status::infeasible) continue;
    ++found;
    const double time_s = decision.cutting_time_s + decision.ramp_time_s;
    EXPECT_LE(time_s, 1.02 * exhaustive(program)) << "seed " << seed;
    double by_feeds_s = by_feeds.ramp_time_s;
    double at_feeds_s = 0.0;
    for (std::size_t c = 0; c < program.cuts.size(); ++c) {
      by_feeds_s += program.cuts[c].time_s(by_feeds.feed_m_per_s[c]);
      at_feeds_s += program.cuts[c].time_s(decision.feed_m_per_s[c]);
    }
    EXPECT_NEAR(decision.cutting_time_s, at_feeds_s, 1e-9 * at_feeds_s);
    if (time_s < 0.999 * by_feeds_s) ++faster;
  }
  EXPECT_GT(found, 5);
  EXPECT_GT(faster, 0);
}

TEST(ProgramDecision, KeepsEveryLimitOverTheWindow) {
  for (int seed = 1; seed <= test::seeds(200); ++seed) {
    const MadeUp program(seed);
    const ProgramDecision decision = decide_program(program.cuts, program.stretches, program, program.options);
    if (decision.status == ProgramDecision::Status::infeasible) {
      EXPECT_FALSE(decision.rejected.empty());
      continue;
    }
    for (std::size_t k = 0; k < program.stretches.size(); ++k) {
      const double speed = decision.stretches[k].spindle_speed_rad_per_s;
      for (std::size_t c = program.stretches[k].begin; c < program.stretches[k].end; ++c) {
        const double least_s = time_of(program, c, alone(speed), 0);
        EXPECT_GE(program.cuts[c].length_m / decision.feed_m_per_s[c], least_s * (1.0 - 1e-9))
            << "seed " << seed << " cut " << c;
        EXPECT_GE(decision.feed_m_per_s[c], program.feeds(c, speed).least_m_per_s * (1.0 - 1e-9));
      }
    }
  }
}

// γ a cut: the corridor's way against every sequence of γ, at the programmed speed.
TEST(ProgramDecision, FindsTheBestWayOfGamma) {
  int turned = 0;
  for (int seed = 1; seed <= 60; ++seed) {
    MadeUp program(seed);
    program.options.gamma_rad = {-0.5, 0.0, 0.5};
    program.options.gamma_rate_rad_per_s = 1e9;  // a step in any cut
    program.options.free_speed = false;
    program.options.feed_slack = 0.0;
    const ProgramDecision decision = decide_program(program.cuts, program.stretches, program, program.options);
    double best = 0.0;
    for (const ProgramStretch& stretch : program.stretches) {
      best += time_along_gamma(program, ways_of(stretch).front(), alone(stretch.programmed_spindle_speed_rad_per_s));
    }
    EXPECT_EQ(decision.status == ProgramDecision::Status::found, std::isfinite(best)) << "seed " << seed;
    if (!std::isfinite(best)) continue;
    EXPECT_NEAR(decision.cutting_time_s, best, 1e-9 * best) << "seed " << seed;
    if (std::ranges::any_of(decision.gamma_begin_rad, [](double gamma) { return gamma != 0.0; })) ++turned;
  }
  EXPECT_GT(turned, 0);
}

TEST(ProgramDecision, LooksAtAFractionOfTheGrid) {
  const MadeUp program(3);
  const ProgramDecision decision = decide_program(program.cuts, program.stretches, program, program.options);
  EXPECT_LT(decision.looks, 4 * 280);  // classes × speeds of the fine grid
  EXPECT_GT(decision.looks, 0);
}

TEST(ProgramDecision, IsTheSameAtAnyNumberOfThreads) {
  for (int seed = 1; seed <= 5; ++seed) {
    MadeUp program(seed, 3);
    program.options.gamma_rad = {-0.5, 0.0, 0.5};
    set_thread_count(1);
    const ProgramDecision one = decide_program(program.cuts, program.stretches, program, program.options);
    set_thread_count(4);
    const ProgramDecision four = decide_program(program.cuts, program.stretches, program, program.options);
    set_thread_count(0);
    EXPECT_EQ(one.feed_m_per_s, four.feed_m_per_s);
    EXPECT_EQ(one.gamma_begin_rad, four.gamma_begin_rad);
    EXPECT_EQ(one.looks, four.looks);
    EXPECT_EQ(one.cutting_time_s, four.cutting_time_s);
  }
}

TEST(ProgramDecision, OneSpeedIsTheSameInEveryStretch) {
  for (int seed = 1; seed <= test::seeds(50); ++seed) {
    MadeUp program(seed);
    program.options.one_speed = true;
    const ProgramDecision decision = decide_program(program.cuts, program.stretches, program, program.options);
    if (decision.status == ProgramDecision::Status::infeasible) continue;
    EXPECT_EQ(decision.stretches[0].spindle_speed_rad_per_s, decision.stretches[1].spindle_speed_rad_per_s);
    MadeUp free(seed);
    const ProgramDecision better = decide_program(free.cuts, free.stretches, free, free.options);
    EXPECT_LE(better.cutting_time_s + better.ramp_time_s, 1.011 * decision.cutting_time_s);
  }
}

TEST(ProgramDecision, FewerChangesOfFeedCostNoMoreThanTheirSlack) {
  for (int seed = 1; seed <= test::seeds(50); ++seed) {
    MadeUp program(seed);
    program.options.feed_slack = 0.0;
    const ProgramDecision fast = decide_program(program.cuts, program.stretches, program, program.options);
    program.options.feed_slack = 0.05;
    const ProgramDecision even = decide_program(program.cuts, program.stretches, program, program.options);
    if (fast.status == ProgramDecision::Status::infeasible) continue;
    const auto changes = [](const std::vector<double>& feeds) {
      std::size_t count = 0;
      for (std::size_t i = 1; i < feeds.size(); ++i) count += feeds[i] != feeds[i - 1] ? 1 : 0;
      return count;
    };
    EXPECT_LE(changes(even.feed_m_per_s), changes(fast.feed_m_per_s));
    EXPECT_LE(even.cutting_time_s, 1.0501 * fast.cutting_time_s);
  }
}

TEST(ProgramDecision, SaysWhatStopsFasterSpeeds) {
  for (int seed = 1; seed <= test::seeds(50); ++seed) {
    const MadeUp program(seed);
    const ProgramDecision decision = decide_program(program.cuts, program.stretches, program, program.options);
    if (decision.status == ProgramDecision::Status::infeasible) continue;
    for (const RejectedSpeed& rejected : decision.rejected) {
      const ProgramStretch& stretch = program.stretches[rejected.stretch];
      double time = 0.0;
      for (std::size_t c = stretch.begin; c < stretch.end; ++c) {
        time += time_of(program, c, alone(rejected.spindle_speed_rad_per_s), 0);
      }
      EXPECT_EQ(std::isfinite(time), rejected.stopped_by.limit == ProgramLimit::none);
      if (std::isfinite(time)) continue;
      EXPECT_EQ(time_of(program, rejected.cut, alone(rejected.spindle_speed_rad_per_s), 0), none);
    }
  }
}

// What a look asks at least holds at every speed of the window, also after feeds are evened out, and is named where it
// contradicts another limit.
TEST(ProgramDecision, FeedsKeepWhatLooksAskAtLeast) {
  int named = 0;
  for (int seed = 1; seed <= test::seeds(200); ++seed) {
    MadeUp program(seed);
    program.options.feed_slack = 0.05;
    const ProgramDecision decision = decide_program(program.cuts, program.stretches, program, program.options);
    for (const RejectedSpeed& one : decision.rejected) {
      if (one.stopped_by.limit == ProgramLimit::forced_vibration) ++named;
    }
    if (decision.status == ProgramDecision::Status::infeasible) continue;
    for (std::size_t k = 0; k < program.stretches.size(); ++k) {
      const double speed = decision.stretches[k].spindle_speed_rad_per_s;
      for (std::size_t c = program.stretches[k].begin; c < program.stretches[k].end; ++c) {
        const CutLook look = program.look(program.cuts[c].looks.front(), speed, 0);
        const double per_tooth =
            speed * program.options.teeth / (2.0 * std::numbers::pi) / program.cuts[c].tooth_feed_share;
        EXPECT_GE(decision.feed_m_per_s[c], look.least_feed_per_tooth_m * per_tooth * (1.0 - 1e-9)) << seed;
      }
    }
  }
  EXPECT_GT(named, 0);
}

TEST(ProgramDecision, RejectsBadOptions) {
  const MadeUp program(1);
  const auto rejects = [&](auto change, const char* field) {
    ProgramOptions options = program.options;
    change(options);
    try {
      static_cast<void>(decide_program(program.cuts, program.stretches, program, options));
      ADD_FAILURE() << field;
    } catch (const InvalidInput& error) {
      EXPECT_EQ(error.parts().field, field);
    }
  };
  rejects([](ProgramOptions& o) { o.teeth = 0; }, "teeth");
  rejects([](ProgramOptions& o) { o.min_spindle_speed_rad_per_s = 0.0; }, "min_spindle_speed_rad_per_s");
  rejects([](ProgramOptions& o) { o.max_spindle_speed_rad_per_s = 1.0; }, "max_spindle_speed_rad_per_s");
  rejects([](ProgramOptions& o) { o.speed_window = 0.5; }, "speed_window");
  rejects([](ProgramOptions& o) { o.gamma_rad = {0.1}; }, "gamma_rad");
  rejects([](ProgramOptions& o) { o.gamma_rad = {0.1, 0.0}; }, "gamma_rad");
  rejects([](ProgramOptions& o) { o.feed_slack = -1.0; }, "feed_slack");
  std::vector<ProgramStretch> gap = program.stretches;
  gap[1].begin += 1;
  EXPECT_THROW(static_cast<void>(decide_program(program.cuts, gap, program, program.options)), InvalidInput);
}

}  // namespace
}  // namespace robomill::decision::program_decision_test
