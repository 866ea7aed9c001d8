#pragma once
#include <cstdint>
#include <vector>

#include "robomill/monitor/detector.hpp"
#include "robomill/monitor/orders/cut_tests.hpp"
#include "robomill/monitor/tachometer.hpp"

namespace robomill::monitor {

/// The default detector, Kind::comb_cusum: the tests of the orders on samples without offset, at the speed that a hint,
/// pulses and the signal give. Threshold 1. Method: README.md.
class OrderDetector final : public Detector {
 public:
  explicit OrderDetector(const MonitorOptions& options);
  void decide(const Hop& hop, Decision& decision) noexcept override;
  void set_spindle_speed(double rad_per_s) noexcept override;
  void reset() noexcept override;
  [[nodiscard]] const CutTests& orders() const noexcept { return orders_; }

 private:
  void count_pulses(const Hop& hop) noexcept;
  void high_pass(const Hop& hop) noexcept;
  void report_speed(const CutTests::Verdict& orders, Decision& decision) noexcept;
  void report_learning(std::uint64_t bad_channels, const CutTests::Verdict& orders, Decision& decision) noexcept;
  void report_bands(std::uint64_t bad_channels, Decision& decision) noexcept;
  void doubt_the_sample_rate(const CutTests::Verdict& orders, Decision& decision) noexcept;

  MonitorOptions options_;
  Tachometer pulses_;
  CutTests orders_;
  std::vector<float> samples_;  // of the hop, channel after channel
  std::vector<double> mean_;    // of each channel, slow
  std::vector<double> bands_;   // mean squares, of a channel
  double hint_hz_ = 0.0;        // 0: none
  bool first_ = true;
  bool rests_ = false;              // by pulses
  double seen_s_ = 0.0;             // of samples in which a channel could be used
  double unknown_s_ = 0.0;          // for which neither a speed is given nor a comb found
  double doubt_s_ = 0.0;            // for which a comb has been there that the hint does not explain
  double suggested_rate_hz_ = 0.0;  // 0: none
};

}  // namespace robomill::monitor
