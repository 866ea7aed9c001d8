#pragma once
#include <cstddef>
#include <memory>
#include <vector>

#include "robomill/monitor/machine.hpp"
#include "robomill/monitor/orders/cut_tests.hpp"
#include "robomill/monitor/orders/noise_floor.hpp"

namespace robomill::monitor {

/// Finds tones: lines 12 dB above the noise that stand in a cell in 5 % of the hops and more.
class CalmTones {
 public:
  explicit CalmTones(std::size_t cells) : seen_(cells) {}
  void add(const CutTests::Shown& shown);
  /// The loudest, 20 at most.
  [[nodiscard]] std::vector<LearntTone> found(int hops) const;

 private:
  struct Seen {
    int hops = 0;
    double frequency_sum_hz = 0.0, power_sum = 0.0;
  };
  std::vector<Seen> seen_;
  std::unique_ptr<NoiseFloor> floor_;
};

}  // namespace robomill::monitor
