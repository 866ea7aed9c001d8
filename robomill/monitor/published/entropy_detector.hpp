#pragma once
#include <vector>

#include "robomill/monitor/detector.hpp"
#include "robomill/monitor/entropy.hpp"

namespace robomill::monitor {

/// The published detector: the energy entropy, summed over the channels, against its threshold; chatter from one hop
/// beyond it; stable again after two on the other side, the first of them a transition (the source has no way back).
class EntropyDetector final : public Detector {
 public:
  explicit EntropyDetector(const MonitorOptions& options);
  void decide(const Hop& hop, Decision& decision) noexcept override;
  void set_spindle_speed(double rad_per_s) noexcept override { spindle_speed_rad_per_s_ = rad_per_s; }
  void reset() noexcept override;

 private:
  MonitorOptions options_;
  std::vector<EnergyEntropy> channels_;
  double spindle_speed_rad_per_s_ = 0.0;
  std::size_t warm_up_ = 0, seen_ = 0;
  State state_ = State::stable;
};

}  // namespace robomill::monitor
