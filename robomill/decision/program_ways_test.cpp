#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <set>
#include <string>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/decision/program/looks.hpp"
#include "robomill/decision/program_decision.hpp"
#include "testing/decision/made_up_program.hpp"
#include "testing/support.hpp"

namespace robomill::decision::program_ways_test {
namespace {

using namespace made_up;

/// Speeds are given in steps so wide that every one is a speed of the coarse grid: the grid is known beforehand.
constexpr double wide_step = 120.0 * n_rpm;

class OnKnownGrid final : public MadeUp {
 public:
  OnKnownGrid(int seed, int ways) : MadeUp(seed, ways) {
    options.speed_step_rad_per_s = wide_step;
    options.feed_slack = 0.0;
    options.other_gain = 0.05 * (seed % 3);
    stretches[0].programmed_spindle_speed_rad_per_s = 9050.0 * n_rpm;
    stretches[1].programmed_spindle_speed_rad_per_s = 8930.0 * n_rpm;
  }
};

std::vector<GridSpeed> grid_of(const MadeUp& program) {
  const double low = program.options.min_spindle_speed_rad_per_s;
  const double high = program.options.max_spindle_speed_rad_per_s;
  std::vector<GridSpeed> out;
  for (double center = low; center <= high; center *= 1.01) {
    const double speed = std::round(center / wide_step) * wide_step;
    if (out.empty() || speed > out.back().speed + 0.5 * wide_step) out.push_back({.speed = speed, .center = center});
  }
  if (out.back().speed < high - 0.5 * wide_step) out.push_back(alone(high));
  for (const ProgramStretch& stretch : program.stretches) {
    out.push_back(alone(stretch.programmed_spindle_speed_rad_per_s));
  }
  return out;
}

/// The least weighted times of a stretch over its ways, one a speed.
std::vector<double> least_times(const MadeUp& program, const ProgramStretch& stretch,
                                const std::vector<GridSpeed>& grid, double other_gain) {
  std::vector<double> out;
  for (const GridSpeed& at : grid) {
    double best = none;
    double weight = 1.0;
    for (const Made& made : ways_of(stretch)) {
      const bool turns = program.options.gamma_rad.size() > 1;
      best = std::min(best, weight * (turns ? time_along_gamma(program, made, at) : time_of(program, made, at)));
      weight = 1.0 + other_gain;
    }
    out.push_back(best);
  }
  return out;
}

/// The least of weighted times and ramp over all ways × all pairs of speeds.
double exhaustive(const MadeUp& program, double other_gain) {
  const ProgramOptions& options = program.options;
  double best = none;
  if (!options.free_speed) {
    best = 0.0;
    for (const ProgramStretch& stretch : program.stretches) {
      best += least_times(program, stretch, {alone(stretch.programmed_spindle_speed_rad_per_s)}, other_gain).front();
    }
    best += std::abs(program.stretches[0].programmed_spindle_speed_rad_per_s -
                     program.stretches[1].programmed_spindle_speed_rad_per_s) /
            options.ramp_rad_per_s2;
    return best;
  }
  const std::vector<GridSpeed> grid = grid_of(program);
  const std::vector<double> first = least_times(program, program.stretches[0], grid, other_gain);
  const std::vector<double> second = least_times(program, program.stretches[1], grid, other_gain);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    for (std::size_t j = 0; j < grid.size(); ++j) {
      if (options.one_speed && i != j) continue;
      best = std::min(best, first[i] + second[j] + std::abs(grid[i].speed - grid[j].speed) / options.ramp_rad_per_s2);
    }
  }
  return best;
}

double weighted_time(const MadeUp& program, const ProgramDecision& decision) {
  double time = decision.ramp_time_s;
  for (const DecidedStretch& stretch : decision.stretches) {
    time += stretch.cutting_time_s * (stretch.way == 0 ? 1.0 : 1.0 + program.options.other_gain);
  }
  return time;
}

/// Looks that a search would make that looks at all of the grid.
long long all_looks(const MadeUp& program) {
  std::set<std::size_t> classes;
  for (const ProgramCut& cut : program.cuts) classes.insert(cut.looks.front());
  std::set<long long> speeds;
  for (const GridSpeed& at : grid_of(program)) {
    for (int k = -2; k <= 2; ++k) speeds.insert(std::llround(1e6 * std::log(at.center * std::pow(1.01, k))));
  }
  return std::ssize(classes) * std::ssize(speeds) * std::ssize(program.options.gamma_rad);
}

/// What all seeds of a property have in common.
struct Tally {
  int found = 0, others = 0;
  long long looks = 0, all = 0;              ///< of all programs
  long long found_looks = 0, found_all = 0;  ///< of those that have an answer
};

/// Cuts of ways that were taken, and of no others, have a feed, and keep their limits.
void expect_keeps_limits(const MadeUp& program, const ProgramDecision& decision) {
  std::vector<bool> taken(program.cuts.size(), false);
  for (std::size_t k = 0; k < program.stretches.size(); ++k) {
    const Made made = ways_of(program.stretches[k])[decision.stretches[k].way];
    EXPECT_GE(decision.stretches[k].limiting_cut, made.begin);
    EXPECT_LT(decision.stretches[k].limiting_cut, made.end);
    for (std::size_t c = made.begin; c < made.end; ++c) {
      taken[c] = true;
      const FeedRange range = program.feeds(c, decision.stretches[k].spindle_speed_rad_per_s);
      EXPECT_GE(decision.feed_m_per_s[c], range.least_m_per_s * (1.0 - 1e-9));
      EXPECT_LE(decision.feed_m_per_s[c], range.most_m_per_s * (1.0 + 1e-9));
    }
  }
  for (std::size_t c = 0; c < program.cuts.size(); ++c) {
    EXPECT_EQ(decision.feed_m_per_s[c] > 0.0, taken[c]) << "cut " << c;
    EXPECT_TRUE(taken[c] || (decision.gamma_begin_rad[c] == 0.0 && decision.gamma_end_rad[c] == 0.0));
  }
}

/// The search against all ways × all speeds (× all sequences of γ).
void expect_best(const MadeUp& program, Tally& tally) {
  const ProgramDecision decision = decide_program(program.cuts, program.stretches, program, program.options);
  tally.looks += decision.looks;
  tally.all += all_looks(program);
  const double best = exhaustive(program, program.options.other_gain);
  ASSERT_EQ(decision.status == ProgramDecision::Status::found, std::isfinite(best));
  if (!std::isfinite(best)) {
    EXPECT_FALSE(decision.rejected.empty());
    return;
  }
  ++tally.found;
  tally.found_looks += decision.looks;
  tally.found_all += all_looks(program);
  EXPECT_NEAR(weighted_time(program, decision), best, 1e-8 * best);
  EXPECT_LE(decision.cutting_time_s + decision.ramp_time_s,
            (1.0 + program.options.other_gain) * exhaustive(program, 0.0) * (1.0 + 1e-8));
  for (const DecidedStretch& stretch : decision.stretches) tally.others += stretch.way > 0 ? 1 : 0;
  expect_keeps_limits(program, decision);
}

TEST(ProgramWays, AreTheBestOfAllWaysAndSpeeds) {
  Tally tally;
  for (int seed = 1; seed <= test::seeds(300); ++seed) {
    SCOPED_TRACE(seed);
    expect_best(OnKnownGrid(seed, 3), tally);
  }
  EXPECT_GT(tally.found, 10);
  EXPECT_GT(tally.others, 5);
  EXPECT_LT(2 * tally.looks, tally.all);
  RecordProperty("found", tally.found);
  RecordProperty("others", tally.others);
  const auto share = [](long long part, long long whole) {
    return std::to_string(static_cast<double>(part) / static_cast<double>(whole));
  };
  RecordProperty("share_of_looks", share(tally.looks, tally.all));
  RecordProperty("share_of_looks_found", share(tally.found_looks, tally.found_all));
}

TEST(ProgramWays, AreTheBestAtOneSpeedForAll) {
  Tally tally;
  for (int seed = 1; seed <= test::seeds(200); ++seed) {
    SCOPED_TRACE(seed);
    OnKnownGrid program(seed, 3);
    program.options.one_speed = true;
    expect_best(program, tally);
  }
  EXPECT_GT(tally.found, 3);
  EXPECT_GT(tally.others, 0);
  EXPECT_LT(2 * tally.looks, tally.all);
}

TEST(ProgramWays, AreTheBestAtTheProgrammedSpeed) {
  Tally tally;
  for (int seed = 1; seed <= 100; ++seed) {
    SCOPED_TRACE(seed);
    OnKnownGrid program(seed, 4);
    program.options.free_speed = false;
    expect_best(program, tally);
  }
  EXPECT_GT(tally.found, 5);
  EXPECT_GT(tally.others, 0);
}

TEST(ProgramWays, AreTheBestAtTheProgrammedFeed) {
  Tally tally;
  for (int seed = 1; seed <= test::seeds(200); ++seed) {
    SCOPED_TRACE(seed);
    OnKnownGrid program(seed, 3);
    program.options.free_feed = false;
    // Time is saved by another way where its lines have higher feeds.
    for (std::size_t c = 0; c < program.cuts.size(); ++c) {
      program.cuts[c].feed_m_per_s = 0.005 + 0.0001 * static_cast<double>(c);
    }
    expect_best(program, tally);
  }
  EXPECT_GT(tally.found, 3);
  EXPECT_GT(tally.others, 0);
}

TEST(ProgramWays, AreTheBestOfAllSequencesOfGamma) {
  Tally tally;
  for (int seed = 1; seed <= test::seeds(100); ++seed) {
    SCOPED_TRACE(seed);
    OnKnownGrid program(seed, 2);
    program.options.min_spindle_speed_rad_per_s = 9000.0 * n_rpm;
    program.options.max_spindle_speed_rad_per_s = 9720.0 * n_rpm;
    program.stretches[1].programmed_spindle_speed_rad_per_s = 9130.0 * n_rpm;
    program.options.gamma_rad = {-0.5, 0.0, 0.5};
    program.options.gamma_rate_rad_per_s = 1e9;  // a step in any cut
    const ProgramDecision decision = decide_program(program.cuts, program.stretches, program, program.options);
    const double best = exhaustive(program, program.options.other_gain);
    ASSERT_EQ(decision.status == ProgramDecision::Status::found, std::isfinite(best));
    tally.looks += decision.looks;
    tally.all += all_looks(program);
    if (!std::isfinite(best)) continue;
    ++tally.found;
    // Of ways of γ as fast as each other to a millionth that which turns least is taken.
    EXPECT_NEAR(weighted_time(program, decision), best, 2e-6 * best);
    for (const DecidedStretch& stretch : decision.stretches) tally.others += stretch.way > 0 ? 1 : 0;
  }
  EXPECT_GT(tally.found, 3);
  EXPECT_GT(tally.others, 0);
  EXPECT_LT(tally.looks, tally.all);
}

// γ turns no faster than it may, also where a stretch takes less time than a step.
TEST(ProgramWays, KeepTheRateOfGamma) {
  int turned = 0;
  int too_short = 0;
  for (int seed = 1; seed <= 4000; ++seed) {
    SCOPED_TRACE(seed);
    MadeUp program(seed, 2);
    Random random(static_cast<std::uint64_t>(seed) + 1000);
    program.options.gamma_rad = {-0.5, 0.0, 0.2, 0.5};
    program.options.gamma_rate_rad_per_s = std::exp(random.uniform(-3.0, 3.0));
    const double spread = random.uniform(0.0, 4.0);
    for (ProgramCut& cut : program.cuts) cut.length_m *= std::exp(random.uniform(-spread, 0.0));
    program.options.free_speed = false;
    const ProgramDecision decision = decide_program(program.cuts, program.stretches, program, program.options);
    if (decision.status == ProgramDecision::Status::infeasible) continue;
    for (std::size_t k = 0; k < program.stretches.size(); ++k) {
      const Made made = ways_of(program.stretches[k])[decision.stretches[k].way];
      double sum_rad = 0.0;
      for (std::size_t c = made.begin; c < made.end; ++c) {
        const double turn_rad = std::abs(decision.gamma_end_rad[c] - decision.gamma_begin_rad[c]);
        const double time_s = program.cuts[c].length_m / decision.feed_m_per_s[c];
        EXPECT_LE(turn_rad, time_s * program.options.gamma_rate_rad_per_s * (1.0 + 1e-9)) << "cut " << c;
        if (c > made.begin) {
          EXPECT_EQ(decision.gamma_begin_rad[c], decision.gamma_end_rad[c - 1]) << "cut " << c;
        }
        sum_rad += turn_rad;
      }
      if (decision.stretches[k].cutting_time_s * program.options.gamma_rate_rad_per_s < 0.5) {
        EXPECT_EQ(sum_rad, 0.0);
        ++too_short;
      }
      if (sum_rad > 0.0) ++turned;
    }
  }
  EXPECT_GT(turned, 0);
  EXPECT_GT(too_short, 0);
}

TEST(ProgramWays, SayWhatStopsOneSpeedForAll) {
  int stopped = 0;
  for (int seed = 1; seed <= test::seeds(100); ++seed) {
    SCOPED_TRACE(seed);
    MadeUp program(seed, 2);
    program.options.one_speed = true;
    const ProgramDecision decision = decide_program(program.cuts, program.stretches, program, program.options);
    for (const RejectedSpeed& rejected : decision.rejected) {
      if (rejected.stopped_by.limit == ProgramLimit::none) continue;
      ++stopped;
      const std::vector<Made> ways = ways_of(program.stretches[rejected.stretch]);
      EXPECT_TRUE(std::ranges::any_of(
          ways, [&](const Made& made) { return rejected.cut >= made.begin && rejected.cut < made.end; }));
      EXPECT_EQ(time_of(program, rejected.cut, alone(rejected.spindle_speed_rad_per_s), 0), none);
    }
  }
  EXPECT_GT(stopped, 0);
}

/// A cut that may be made in two ways, each with a feed and a margin.
class TwoWays final : public ProgramModel {
 public:
  TwoWays(double other_feed_m_per_s, double margin, double other_margin)
      : feed_m_per_s_{0.01, other_feed_m_per_s}, margin_{margin, other_margin} {
    options.teeth = 2;
    options.free_speed = false;
  }
  [[nodiscard]] FeedRange feeds(std::size_t cut, double /*speed*/) const override {
    return {.least_m_per_s = 0.001,
            .most_m_per_s = feed_m_per_s_[cut],
            .most_by = {ProgramLimit::tip_speed, feed_m_per_s_[cut], feed_m_per_s_[cut]}};
  }
  [[nodiscard]] CutLook look(std::size_t look_class, double /*speed*/, std::size_t /*gamma*/) const override {
    const std::scoped_lock lock(mutex_);
    looked.insert(look_class);
    const double margin = margin_[look_class];
    return {.holds = margin >= 0.2, .by = {ProgramLimit::stability, margin, 0.2}};
  }
  [[nodiscard]] ProgramDecision decide(double other_gain) {
    options.other_gain = other_gain;
    const ProgramCut own = {.length_m = 0.1, .feed_m_per_s = 0.01, .looks = {0}};
    ProgramCut other = own;
    other.looks = {1};
    return decide_program({own, other},
                          {{.begin = 0, .end = 1, .programmed_spindle_speed_rad_per_s = 900.0, .others = {1}}}, *this,
                          options);
  }

  ProgramOptions options = {};
  mutable std::set<std::size_t> looked = {};

 private:
  std::array<double, 2> feed_m_per_s_, margin_;
  mutable std::mutex mutex_;
};

TEST(ProgramWays, AreChangedOnlyForTheirGain) {
  EXPECT_EQ(TwoWays(0.0101, 0.5, 0.5).decide(0.02).stretches[0].way, 0U);
  EXPECT_EQ(TwoWays(0.0101, 0.5, 0.5).decide(0.0).stretches[0].way, 1U);
  EXPECT_EQ(TwoWays(0.0103, 0.5, 0.5).decide(0.02).stretches[0].way, 1U);
  EXPECT_EQ(TwoWays(0.01, 0.5, 0.5).decide(0.0).stretches[0].way, 0U);    // as fast as each other
  EXPECT_EQ(TwoWays(0.005, 0.1, 0.5).decide(0.02).stretches[0].way, 1U);  // the programmed way does not hold
}

TEST(ProgramWays, AreNotLookedAtWhereTheyCannotBeFaster) {
  TwoWays slower(0.009, 0.5, 0.5);
  EXPECT_EQ(slower.decide(0.02).looks, 5);  // a window
  EXPECT_EQ(slower.looked, std::set<std::size_t>{0});
  TwoWays faster(0.02, 0.5, 0.5);
  static_cast<void>(faster.decide(0.02));
  EXPECT_EQ(faster.looked, std::set<std::size_t>{1});
}

TEST(ProgramWays, AreRejectedByTheNearest) {
  const ProgramDecision other = TwoWays(0.01, 0.05, 0.19).decide(0.02);
  ASSERT_EQ(other.rejected.size(), 1U);
  EXPECT_EQ(other.rejected[0].cut, 1U);
  EXPECT_EQ(other.rejected[0].stopped_by.value, 0.19);
  EXPECT_EQ(TwoWays(0.01, 0.19, 0.05).decide(0.02).rejected.at(0).cut, 0U);
  EXPECT_EQ(TwoWays(0.02, 0.1, 0.1).decide(0.02).rejected.at(0).cut, 0U);
}

TEST(ProgramWays, RejectBadOnes) {
  const MadeUp program(1, 2);
  const auto field = [&](std::size_t stretch, std::size_t first) {
    std::vector<ProgramStretch> stretches = program.stretches;
    stretches[stretch].others = {first};
    return test::field_of(
        [&] { static_cast<void>(decide_program(program.cuts, stretches, program, program.options)); });
  };
  EXPECT_EQ(field(0, program.stretches[0].others[0]), "accepted");
  EXPECT_EQ(field(1, 0), "stretches[2].others");
  EXPECT_EQ(field(0, program.stretches[1].end - 1), "stretches[1].others");
  EXPECT_EQ(field(1, program.stretches[0].others[0]), "stretches[2].others");  // cuts of another stretch's way
  EXPECT_EQ(field(0, program.cuts.size() - 1), "stretches[1].others");
  EXPECT_EQ(field(0, std::numeric_limits<std::size_t>::max()), "stretches[1].others");
  ProgramOptions options = program.options;
  options.other_gain = -0.1;
  EXPECT_EQ(test::field_of([&] { options.validate(); }), "other_gain");
  std::vector<ProgramStretch> none_others = program.stretches;
  for (ProgramStretch& stretch : none_others) stretch.others.clear();
  EXPECT_THROW(static_cast<void>(decide_program(program.cuts, none_others, program, program.options)), InvalidInput);
}

/// Looks that depend on the speed alone, given from the lowest of a window on.
class GivenLooks final : public ProgramModel {
 public:
  explicit GivenLooks(std::vector<CutLook> looks) : looks_(std::move(looks)) {}
  [[nodiscard]] FeedRange feeds(std::size_t /*cut*/, double /*speed*/) const override { return {}; }
  [[nodiscard]] CutLook look(std::size_t /*look_class*/, double speed, std::size_t /*gamma*/) const override {
    const auto step = static_cast<std::size_t>(std::lround(std::log(speed / 1000.0) / std::log(1.01)) + 2);
    return looks_[std::min(step, looks_.size() - 1)];
  }

 private:
  std::vector<CutLook> looks_;
};

CutLook known_of(const std::vector<CutLook>& over_window) {
  const GivenLooks model(over_window);
  ProgramOptions options;
  options.free_speed = false;
  const CandidateSpeeds speeds({{.begin = 0, .end = 1, .programmed_spindle_speed_rad_per_s = 1000.0}}, options);
  Looks looks(model, speeds, 1, 1, Progress::none());
  looks.ask({{}}, 0);
  return looks.known({}, 0).value_or(CutLook{});
}

// What limits a cut over a window: by the least feed, then by shares of limits, which compare metres with margins.
TEST(ProgramWays, KnowWhatIsNearestToItsLimit) {
  const auto margin = [](double value) { return CutLook{.holds = true, .by = {ProgramLimit::stability, value, 0.2}}; };
  const auto surface = [](double value_m, double most_feed_m) {
    return CutLook{
        .holds = true, .by = {ProgramLimit::surface_error, value_m, 5e-5}, .most_feed_per_tooth_m = most_feed_m};
  };
  // Metres are small numbers: a fifth of a surface error is further from its limit than a margin that just holds.
  const CutLook shares = known_of({margin(0.9), surface(1e-5, none), margin(0.21)});
  EXPECT_EQ(shares.by.limit, ProgramLimit::stability);
  EXPECT_EQ(shares.by.value, 0.21);
  EXPECT_EQ(known_of({margin(0.9), surface(4.9e-5, none)}).by.limit, ProgramLimit::surface_error);
  // The least feed is named with what limits it.
  const CutLook feeds = known_of({margin(0.21), surface(2e-5, 4e-5), surface(3e-5, 3e-5)});
  EXPECT_EQ(feeds.by.value, 3e-5);
  EXPECT_EQ(feeds.most_feed_per_tooth_m, 3e-5);
  CutLook fails = margin(0.1);
  fails.holds = false;
  EXPECT_FALSE(known_of({surface(2e-5, 1e-5), fails}).holds);
}

}  // namespace
}  // namespace robomill::decision::program_ways_test
