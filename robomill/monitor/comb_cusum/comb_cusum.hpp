#pragma once
#include <complex>
#include <memory>
#include <vector>

#include "robomill/monitor/comb_cusum/cusum.hpp"
#include "robomill/monitor/comb_cusum/frequency.hpp"
#include "robomill/monitor/comb_cusum/narrowband_detector.hpp"
#include "robomill/monitor/detector.hpp"
#include "robomill/monitor/entropy.hpp"
#include "robomill/monitor/spindle/spindle.hpp"
#include "robomill/monitor/spindle/spindle_comb.hpp"
#include "robomill/signal/synchrosqueeze.hpp"

namespace robomill::monitor {

/// The default detector. Method: README.md.
class CombCusum final : public Detector {
 public:
  explicit CombCusum(const MonitorOptions& options);
  void decide(const Hop& hop, Decision& decision) noexcept override;
  void set_spindle_speed(double rad_per_s) noexcept override;
  void reset() noexcept override;

 private:
  static constexpr std::size_t columns_a_hop = 4;  // of the transform
  static constexpr std::size_t kept = 8;           // hops of log energies

  void take_in(const Hop& hop) noexcept;
  // Speed
  void take_up(const SpindleTracker::Change& change) noexcept;
  bool speed_holds() noexcept;
  void replay(std::size_t samples) noexcept;
  void lose() noexcept;
  void learn_anew() noexcept;
  [[nodiscard]] bool trusted() const noexcept;
  [[nodiscard]] bool comb_known() const noexcept { return spindle_.rotation_hz() > 0.0 && trusted(); }
  // Comb
  void comb() noexcept;
  void take_lags() noexcept;
  // Lines
  void leave_power() noexcept;
  [[nodiscard]] bool comb_follows(std::size_t channel) const noexcept;
  void squeeze() noexcept;
  void judge(Decision& decision) noexcept;
  [[nodiscard]] bool near_a_harmonic(double frequency_hz) const noexcept;
  [[nodiscard]] bool process_narrowband() noexcept;
  [[nodiscard]] bool may_be_the_cut(double frequency_hz) const noexcept;
  void in_cut(const Cusum::Verdict& verdict, bool at_once) noexcept;
  void begin_chatter(bool above_baseline) noexcept;
  void in_chatter() noexcept;
  void follow_line() noexcept;
  void report_frequency(Decision& decision) noexcept;
  void report_bands(Decision& decision) const noexcept;
  [[nodiscard]] double power() const noexcept;            // of all channels in the hop
  [[nodiscard]] double energy_of_power() const noexcept;  // that it has in the lines
  [[nodiscard]] double level(std::size_t line) const noexcept;
  [[nodiscard]] double line_hz(std::size_t line) const noexcept;

  MonitorOptions options_;
  std::size_t channels_, frames_, lines_;
  std::size_t tachometer_;  // channel; channels_: none
  SpindleTracker spindle_;
  SpindleComb comb_;
  std::vector<signal::SynchrosqueezeStream> streams_;
  std::vector<FrequencyRing> rings_;
  Cusum lines_test_;
  std::vector<float> past_;              // of a channel, to learn the comb from
  std::vector<float> input_, residual_;  // of the hop, channel after channel
  std::vector<double> mean_;             // of each channel, slow
  std::vector<double> lags_;             // of a channel's harmonics, powers
  std::vector<std::complex<double>> column_;
  std::vector<double> energy_, taken_, power_;
  std::vector<double> left_power_;  // of the residual in the hop, each channel
  std::vector<double> late_half_;   // in its second half
  std::unique_ptr<bool[]> falls_;   // it is on its way down
  std::size_t away_ = 0;            // channels in which the comb predicts what no longer comes
  std::vector<double> history_;     // of the lines' log energies, loudest channel; `kept` hops
  std::vector<double> band_power_;  // of the hop, each channel's bands
  std::uint64_t bad_ = 0;           // channels that are left out
  std::size_t still_bad_ = 0;       // hops until a channel that is well again counts
  double slow_power_ = 0.0;
  std::size_t jumps_ = 0;
  std::size_t entry_hops_ = 0;  // for which the tool still enters
  std::uint64_t hops_ = 0;

  State state_ = State::stable;
  std::size_t line_ = 0, channel_ = 0;  // of chatter
  bool above_baseline_ = true;
  double highest_ = 0.0;  // log energy of chatter's line, at most so far
  NarrowbandDetector narrowband_;
  double power_before_ = 0.0;  // of all channels, a hop ago
  std::size_t broad_ = 0, calm_ = 0, steady_ = 0;
  FrequencyEstimate found_;
};

}  // namespace robomill::monitor
