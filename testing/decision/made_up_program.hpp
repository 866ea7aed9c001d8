#pragma once
// A program made up, with its times by brute force.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/base/units.hpp"
#include "robomill/decision/program_decision.hpp"

namespace robomill::decision::made_up {

constexpr double n_rpm = units::rpm;
constexpr double none = std::numeric_limits<double>::infinity();

/// A program made up: lobes over speed that move with class and γ, feeds limited by chip, power and surface error.
class MadeUp : public ProgramModel {
 public:
  /// @param ways  of each stretch: other lobes and other chips
  explicit MadeUp(int seed, int ways = 1) : random_(static_cast<std::uint64_t>(seed)) {
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
    add_classes();
    power_w_ = random_.uniform(500.0, 1500.0);
    for (int way = 1; way < ways; ++way) add_way();
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
    if (!out.holds) return out;
    out.most_feed_per_tooth_m = 2e-5 + 6e-5 * margin;
    out.least_feed_per_tooth_m = 4e-5 * (1.0 - margin);
    out.least_by = {ProgramLimit::forced_vibration, 2e-5, 1e-5};
    return out;
  }

  /// What a machine makes of the cuts: some gain little by their feed.
  void measure() {
    for (ProgramCut& cut : cuts) {
      cut.feed_part = std::max(0.0, random_.uniform(-0.5, 1.0));
      cut.lost_s = (1.0 - cut.feed_part) * cut.length_m / cut.feed_m_per_s;
    }
  }

  std::vector<ProgramCut> cuts = {};
  std::vector<ProgramStretch> stretches = {};
  ProgramOptions options = {};

 private:
  void add_classes() {
    for (std::size_t k = 0; k < classes; ++k) {
      phase_.push_back(random_.uniform(0.0, 6.0));
      level_.push_back(random_.uniform(0.1, 0.9));
      turn_.push_back(random_.uniform(-3.0, 3.0));
    }
  }
  void add_way() {
    const std::size_t first_class = phase_.size();
    add_classes();
    for (ProgramStretch& stretch : stretches) {
      stretch.others.push_back(cuts.size());
      for (std::size_t c = stretch.begin; c < stretch.end; ++c) {
        ProgramCut cut = cuts[c];
        cut.tooth_feed_share = random_.uniform(0.9, 1.1);
        cut.looks = {first_class + cut.looks.front()};
        cuts.push_back(cut);
        chip_.push_back(chip_[c] * random_.uniform(0.8, 1.2));
      }
    }
  }

  static constexpr std::size_t classes = 4;  // of a way
  Random random_;
  std::vector<double> chip_ = {}, phase_ = {}, level_ = {}, turn_ = {};
  double power_w_ = 0.0;
};

/// Cuts [begin, end) made in one way.
struct Made {
  std::size_t begin = 0, end = 0;
};

/// Every way of a stretch, the program's first.
inline std::vector<Made> ways_of(const ProgramStretch& stretch) {
  std::vector<Made> out = {{.begin = stretch.begin, .end = stretch.end}};
  for (const std::size_t first : stretch.others) {
    out.push_back({.begin = first, .end = first + stretch.end - stretch.begin});
  }
  return out;
}

/// A speed, and that about which its window stands.
struct GridSpeed {
  double speed = 0.0, center = 0.0;
};

inline GridSpeed alone(double speed) {
  return {.speed = speed, .center = speed};
}

/// Time of a cut, its window looked at anew; infinite: it does not hold.
inline double time_of(const MadeUp& program, std::size_t cut, GridSpeed at, std::size_t gamma) {
  FeedRange range = program.feeds(cut, at.speed);
  for (int k = -2; k <= 2; ++k) {
    const CutLook look = program.look(program.cuts[cut].looks.front(), at.center * std::pow(1.01, k), gamma);
    if (!look.holds) return none;
    const double teeth_per_s = at.speed * program.options.teeth / (2.0 * std::numbers::pi);
    const double per_tooth = teeth_per_s / program.cuts[cut].tooth_feed_share;
    range.most_m_per_s = std::min(range.most_m_per_s, look.most_feed_per_tooth_m * per_tooth);
    range.least_m_per_s = std::max(range.least_m_per_s, look.least_feed_per_tooth_m * per_tooth);
  }
  const double feed = program.options.free_feed ? range.most_m_per_s : program.cuts[cut].feed_m_per_s;
  if (feed < range.least_m_per_s || feed > range.most_m_per_s) return none;
  return program.cuts[cut].time_s(feed);
}

/// The same of cuts on end, γ as programmed.
inline double time_of(const MadeUp& program, Made made, GridSpeed at) {
  double time = 0.0;
  for (std::size_t c = made.begin; c < made.end; ++c) time += time_of(program, c, at, 0);
  return time;
}

/// The least time of cuts on end over every sequence of γ that steps by at most one a cut.
inline double time_along_gamma(const MadeUp& program, Made made, GridSpeed at) {
  const std::size_t gammas = program.options.gamma_rad.size();
  const std::size_t count = made.end - made.begin;
  std::vector<std::vector<double>> times(count);
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t g = 0; g < gammas; ++g) times[i].push_back(time_of(program, made.begin + i, at, g));
  }
  std::vector<std::size_t> way(count + 1, 0);
  double best = none;
  for (;;) {
    double time = 0.0;
    for (std::size_t i = 0; i < count && std::isfinite(time); ++i) {
      const auto [low, high] = std::minmax(way[i], way[i + 1]);
      time += high - low > 1 ? none : std::max(times[i][low], times[i][high]);
    }
    best = std::min(best, time);
    std::size_t digit = 0;
    while (digit <= count && ++way[digit] == gammas) way[digit++] = 0;
    if (digit > count) return best;
  }
}

}  // namespace robomill::decision::made_up
