#pragma once
#include <cstdint>
#include <vector>

#include "robomill/monitor/comb_cusum/comb_cusum.hpp"
#include "robomill/monitor/detector.hpp"
#include "robomill/monitor/orders/ratio_test.hpp"
#include "robomill/monitor/spindle/tachometer.hpp"

namespace robomill::monitor {

/// The default detector: RatioTest, which needs no history, beside CombCusum, which finds slow growth and the chatter
/// of a tool that hardly has a comb. An alarm of CombCusum counts where the orders bear it out: where the speed is not
/// known, or lines beside the orders hold 3 % of the synchronous energy, or one line of high order dominates; and where
/// that energy does not swing as it does when the tool leaves the cut. Method: README.md.
class CombinedDetector final : public Detector {
 public:
  explicit CombinedDetector(const MonitorOptions& options);
  void decide(const Hop& hop, Decision& decision) noexcept override;
  void set_spindle_speed(double rad_per_s) noexcept override;
  void reset() noexcept override;

 private:
  void high_pass(const Hop& hop) noexcept;
  [[nodiscard]] bool is_the_cut(const RatioTest::Verdict& orders, double frequency_hz) const noexcept;
  [[nodiscard]] bool borne_out(const RatioTest::Verdict& orders, double frequency_hz) const noexcept;
  void judge(const RatioTest::Verdict& orders, Decision& decision) noexcept;

  MonitorOptions options_;
  Tachometer pulses_;
  CombCusum growth_;
  RatioTest orders_;
  std::vector<float> samples_;  // of the hop, channel after channel
  std::vector<double> mean_;    // of each channel, slow
  double sought_hz_ = 0.0;      // about which CombCusum seeks the speed
  double hint_hz_ = 0.0;        // as given; 0: none
  bool first_ = true;
  bool accepted_ = false;   // the alarm of CombCusum
  double loudest_ = 0.0;    // energy, slowly forgotten
  double unknown_s_ = 0.0;  // for which neither a speed is given nor a comb found
};

}  // namespace robomill::monitor
