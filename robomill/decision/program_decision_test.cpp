#include "robomill/decision/program_decision.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "robomill/base/error.hpp"
#include "robomill/base/parallel.hpp"
#include "robomill/base/random.hpp"
#include "robomill/base/units.hpp"
#include "testing/support.hpp"

namespace robomill::decision::program_decision_test {
namespace {

constexpr double n_rpm = units::rpm;
constexpr double none = std::numeric_limits<double>::infinity();

/// A program made up: lobes over speed that move with class and γ, feeds limited by chip, power and surface error.
class MadeUp final : public ProgramModel {
 public:
  explicit MadeUp(int seed) : random_(static_cast<std::uint64_t>(seed)) {
    const int count = 6 + static_cast<int>(random_.uniform(0.0, 6.0));
    const int break_at = 2 + static_cast<int>(random_.uniform(0.0, 3.0));
    for (int c = 0; c < count; ++c) {
      ProgramCut cut = {.length_m = random_.uniform(0.002, 0.05), .feed_m_per_s = random_.uniform(0.005, 0.02)};
      cut.tooth_feed_share = random_.uniform(0.9, 1.1);
      cut.looks = {static_cast<std::size_t>(random_.uniform(0.0, 3.999))};
      cuts.push_back(cut);
      chip_.push_back(random_.uniform(2e-5, 8e-5));
    }
    stretches = {
        {.begin = 0, .end = static_cast<std::size_t>(break_at), .programmed_spindle_speed_rad_per_s = 9000.0 * n_rpm},
        {.begin = static_cast<std::size_t>(break_at),
         .end = cuts.size(),
         .programmed_spindle_speed_rad_per_s = 9000.0 * n_rpm}};
    for (int k = 0; k < 4; ++k) {
      phase_.push_back(random_.uniform(0.0, 6.0));
      level_.push_back(random_.uniform(0.1, 0.9));
      turn_.push_back(random_.uniform(-3.0, 3.0));
    }
    power_w_ = random_.uniform(500.0, 1500.0);
    options.teeth = 2;
    options.min_spindle_speed_rad_per_s = 6000.0 * n_rpm;
    options.max_spindle_speed_rad_per_s = 12000.0 * n_rpm;
    options.ramp_rad_per_s2 = 2000.0 * n_rpm;
  }

  [[nodiscard]] FeedRange feeds(std::size_t cut, double speed) const override {
    const double per_m = speed * options.teeth / (2.0 * std::numbers::pi) / cuts[cut].tooth_feed_share;
    FeedRange range = {.least_m_per_s = 1e-5 * per_m,
                       .most_m_per_s = chip_[cut] * per_m,
                       .least_by = {ProgramLimit::least_chip, 0.0, 1e-5},
                       .most_by = {ProgramLimit::greatest_chip, 1.0, chip_[cut]}};
    const double by_power = power_w_ / 2.0e4 * (1.0 + 0.2 * std::sin(static_cast<double>(cut)));
    if (by_power < range.most_m_per_s) {
      range.most_m_per_s = by_power;
      range.most_by = {ProgramLimit::power, 2.0 * power_w_, power_w_};
    }
    return range;
  }

  [[nodiscard]] CutLook look(std::size_t look_class, double speed, std::size_t gamma) const override {
    const double margin = level_[look_class] + 0.8 * std::sin(40.0 * std::log(speed) + phase_[look_class] +
                                                              turn_[look_class] * options.gamma_rad[gamma]);
    CutLook out = {.holds = margin >= 0.2, .by = {ProgramLimit::stability, margin, 0.2}};
    if (out.holds) out.most_feed_per_tooth_m = 2e-5 + 6e-5 * margin;
    return out;
  }

  std::vector<ProgramCut> cuts = {};
  std::vector<ProgramStretch> stretches = {};
  ProgramOptions options = {};

 private:
  Random random_;
  std::vector<double> chip_ = {}, phase_ = {}, level_ = {}, turn_ = {};
  double power_w_ = 0.0;
};

/// Time of a cut, its window looked at anew; infinite: it does not hold.
double time_of(const MadeUp& program, std::size_t cut, double speed, std::size_t gamma) {
  FeedRange range = program.feeds(cut, speed);
  for (int k = -2; k <= 2; ++k) {
    const CutLook look = program.look(program.cuts[cut].looks.front(), speed * std::pow(1.01, k), gamma);
    if (!look.holds) return none;
    const double teeth_per_s = speed * program.options.teeth / (2.0 * std::numbers::pi);
    range.most_m_per_s =
        std::min(range.most_m_per_s, look.most_feed_per_tooth_m * teeth_per_s / program.cuts[cut].tooth_feed_share);
  }
  return range.most_m_per_s < range.least_m_per_s ? none : program.cuts[cut].length_m / range.most_m_per_s;
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
    double time = 0.0;
    for (std::size_t c = stretch.begin; c < stretch.end; ++c) time += time_of(program, c, speed, 0);
    return time;
  };
  std::vector<double> first;
  std::vector<double> second;
  for (const double n : speeds) {
    first.push_back(stretch_time(program.stretches[0], n));
    second.push_back(stretch_time(program.stretches[1], n));
  }
  double best = none;
  for (std::size_t i = 0; i < speeds.size(); ++i) {
    for (std::size_t j = 0; j < speeds.size(); ++j) {
      const double ramp = std::abs(speeds[i] - speeds[j]) / program.options.ramp_rad_per_s2;
      best = std::min(best, first[i] + second[j] + ramp);
    }
  }
  return best;
}

/// The least time of a stretch at one speed over every sequence of γ that steps by at most one a cut.
double exhaustive_gamma(const MadeUp& program, const ProgramStretch& stretch, double speed) {
  const std::size_t gammas = program.options.gamma_rad.size();
  const std::size_t count = stretch.end - stretch.begin;
  std::vector<std::size_t> way(count + 1, 0);
  double best = none;
  for (;;) {
    double time = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      const auto [low, high] = std::minmax(way[i], way[i + 1]);
      if (high - low > 1) time = none;
      if (!std::isfinite(time)) break;
      time += std::max(time_of(program, stretch.begin + i, speed, way[i]),
                       time_of(program, stretch.begin + i, speed, way[i + 1]));
    }
    best = std::min(best, time);
    std::size_t digit = 0;
    while (digit <= count && ++way[digit] == gammas) way[digit++] = 0;
    if (digit > count) return best;
  }
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
        const double least_s = time_of(program, c, speed, 0);
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
      best += exhaustive_gamma(program, stretch, stretch.programmed_spindle_speed_rad_per_s);
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
    MadeUp program(seed);
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
        time += time_of(program, c, rejected.spindle_speed_rad_per_s, 0);
      }
      EXPECT_EQ(std::isfinite(time), rejected.stopped_by.limit == ProgramLimit::none);
      if (std::isfinite(time)) continue;
      EXPECT_EQ(time_of(program, rejected.cut, rejected.spindle_speed_rad_per_s, 0), none);
    }
  }
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
