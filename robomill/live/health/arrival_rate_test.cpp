#include "robomill/live/health/arrival_rate.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <optional>
#include <vector>

#include "robomill/base/random.hpp"

namespace robomill::live {
namespace arrival_rate_test {

/// Sends frames to be measured, on a clock of its own.
class Sender {
 public:
  explicit Sender(ArrivalRate& rate) : rate_(&rate) {}

  /// What is measured while frames arrive at `true_hz` for so long, `step_s` at a time, each up to `late_s` late; then
  /// nothing for pause_s.
  std::vector<double> measured(double true_hz, double seconds, double step_s, double late_s = 0.0) {
    std::vector<double> out;
    for (const double end_s = clock_s_ + seconds; clock_s_ < end_s; clock_s_ += step_s) {
      const auto at = std::chrono::duration<double>(clock_s_ + random_.uniform(0.0, late_s));
      const std::optional<double> off =
          rate_->add(static_cast<std::uint64_t>(true_hz * step_s),
                     ArrivalRate::Clock::time_point(std::chrono::duration_cast<ArrivalRate::Clock::duration>(at)));
      if (off) out.push_back(*off);
    }
    clock_s_ += pause_s;
    return out;
  }

  double pause_s = 100.0;

 private:
  ArrivalRate* rate_;
  Random random_{1};
  double clock_s_ = 0.0;
};

TEST(ArrivalRate, MeasuresWhatIsOff) {
  for (const double step_s : {0.025, 0.1, 0.8}) {
    for (const double factor : {0.5, 0.85, 1.15, 2.0}) {
      ArrivalRate rate(10'000.0, 1.0);
      const std::vector<double> off = Sender(rate).measured(10'000.0 * factor, 40.0, step_s, 0.1);
      ASSERT_EQ(off.size(), 3U) << step_s << ' ' << factor;
      for (const double hz : off) EXPECT_NEAR(hz, 10'000.0 * factor, 10'000.0 * 0.02 * factor);
    }
    ArrivalRate rate(10'000.0, 1.0);
    Sender sender(rate);
    EXPECT_TRUE(sender.measured(9500.0, 60.0, step_s, 0.1).empty());
    EXPECT_TRUE(sender.measured(10'500.0, 60.0, step_s, 0.1).empty());
  }
}

// What had waited in a pipe comes at once: at the beginning, and after a pause.
TEST(ArrivalRate, LeavesABacklogOut) {
  ArrivalRate rate(10'000.0, 1.0);
  Sender sender(rate);
  for (int i = 0; i < 2; ++i) {
    sender.pause_s = 0.0;
    EXPECT_TRUE(sender.measured(1e6, 1.0, 0.1).empty());
    sender.pause_s = 100.0;
    EXPECT_TRUE(sender.measured(10'000.0, 60.0, 0.1).empty());
  }
  // 9 s of frames and 100 s without are no rate.
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(sender.measured(10'000.0, 9.0, 0.1).empty());
}

TEST(ArrivalRate, NamesBothRates) {
  EXPECT_NE(ArrivalRate(10'240.0, 1.0).message(5121.3).find("arrive at 5121 Hz, not at signal.sample_rate_hz = 10240"),
            std::string::npos);
}

}  // namespace arrival_rate_test
}  // namespace robomill::live
