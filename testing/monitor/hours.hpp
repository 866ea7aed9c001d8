#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "robomill/base/random.hpp"
#include "testing/monitor/recording.hpp"

namespace robomill::monitor::testing {

/// Hours of stable cutting: a bank of simulated stable cuts without noise (milling and drilling, entries, exits,
/// changes of depth and of speed), joined in random order by idle times, each time with fresh noise, hum, gain and
/// knocks. Truth: no chatter. x and y interleaved at corpus_rate_hz.
class StableHours {
 public:
  /// @param bank   cuts in it
  /// @param teeth  of all of them; 0: as they are drawn
  StableHours(std::uint64_t seed, double hours, int bank = 16, int teeth = 0);

  /// The next cut with the idle time before it; empty when the hours are over. Valid until the next call.
  [[nodiscard]] std::span<const float> next();
  /// Of the cut that next() gave last: the speed as given, off by up to 3 %, and its teeth.
  [[nodiscard]] double hint_rad_per_s() const { return hint_; }
  [[nodiscard]] int teeth() const { return bank_[current_].plan.teeth(); }
  [[nodiscard]] double seconds() const { return static_cast<double>(frames_) / corpus_rate_hz; }  ///< given so far

 private:
  struct Entry {
    CutPlan plan;
    CleanCut clean;
    double level = 0.0;
  };
  void add_disturbances(const Entry& entry, std::size_t frames);

  Random random_;
  std::uint64_t frames_ = 0, wanted_ = 0;
  std::vector<Entry> bank_;
  std::vector<float> noise_;  ///< of rms 1, white and coloured
  std::vector<float> samples_;
  std::size_t current_ = 0;
  double hint_ = 0.0;
};

}  // namespace robomill::monitor::testing
