#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "robomill/monitor/monitor.hpp"
#include "robomill/monitor/orders/comb_search.hpp"
#include "robomill/monitor/orders/cut_follower.hpp"
#include "robomill/monitor/orders/growth_test.hpp"
#include "robomill/monitor/orders/residual_lines.hpp"
#include "robomill/monitor/orders/runaway.hpp"
#include "robomill/monitor/orders/spectra.hpp"
#include "robomill/monitor/orders/speed_posterior.hpp"
#include "robomill/monitor/orders/tones.hpp"

namespace robomill::monitor {

/// Tests a cut for chatter by its orders. Forced vibration stands at the multiples of rotation and lasts as long as the
/// tool cuts; chatter stands beside them. With S the synchronous energy and L that of the strongest family of lines
/// {±f_c + k f} (ResidualLines), in the last 0.3 s and 0.15 s, any of these is chatter:
///
/// ratio:    L > 0.2 S in both windows, at a known speed that stands still to 0.8 %. Three hops more with it than
///           without; six while the tool enters.
/// growth:   a line that is no multiple of the teeth has grown by 10 dB (GrowthTest), the speed stands still to 0.8 %,
///           and the line exceeds half the swing of S in 0.3 s: a change of depth or speed moves energy out of the
///           orders. Three hops.
/// family:   L has grown by three (FamilyGrowth), and the speed stands so still that the order beside the line has
///           moved by less than 0.5/T of the short window. So many hops as the rate of false alarms asks for.
/// alone:    one line holds 0.6 of all energy where no comb explains the signal, the teeth are known, and it is no low
///           multiple of rotation and none of tooth passing. Four hops.
/// runaway:  the strongest line grows exponentially (Runaway).
///
/// No line counts that rings down as a knock does (without the orders, the last 25 ms below half of the strongest of
/// the last six). For ratio, alone and runaway it must have grown by 6 dB within a second or so: tones of the machine
/// or of the room were there before (Tones). For ratio and alone it is no low multiple of 50 or 60 Hz, for ratio L is a
/// hundredth of the loudest cut. Chatter is over after six hops without.
class CutTests {
 public:
  struct Setup {
    double sample_rate_hz = 0.0, hop_s = 0.025;
    std::size_t channels = 1;
    int teeth = 0;                       ///< 0: unknown
    double speed_std_ratio = 0.015;      ///< of the hint
    double false_alarms_per_hour = 0.1;  ///< asked of the family's growth: ln(hops an hour/alarms an hour)/3.6 hops
  };
  struct Verdict {
    bool chatter = false;
    /// Hops that speak for chatter, of those an alarm takes; in chatter 1 + L/S, 1.2 to 100.
    double score = 0.0;
    double frequency_hz = 0.0;      ///< of the strongest line that stands out; 0: none
    double frequency_std_hz = 0.0;  ///< its standard deviation
    std::size_t channel = 0;        ///< in which it is strongest
    SynchronousChatter synchronous = SynchronousChatter::none;
    double ratio = 0.0;               ///< L/S of the last 0.15 s
    double rotation_hz = 0.0;         ///< most likely; 0: no hint, where the comb found may be a multiple of it
    double rotation_std_ratio = 0.0;  ///< standard deviation, of it
    bool known = false;               ///< the tool cuts at a known speed, or a multiple of it
    double comb_hz = 0.0;             ///< of the comb that is sought far from the hint while no speed is known; 0: none
  };
  explicit CutTests(const Setup& setup);
  /// [Hz]; 0: unknown.
  void set_hint(double rotation_hz) noexcept;
  /// A measurement of the speed [Hz], good for the next hop.
  void measured(double rotation_hz, double std_ratio) noexcept;
  /// A hop.
  /// @param samples       of all channels, channel after channel, without offset, `frames` each
  /// @param bad_channels  bit c: left out
  /// @param still         the spindle stands still: no chatter begins
  Verdict step(std::span<const float> samples, std::size_t frames, std::uint64_t bad_channels,
               bool still = false) noexcept;
  /// As after construction; the hint stays.
  void reset() noexcept;
  /// Of a channel, the last 0.15 s.
  [[nodiscard]] const Spectrum& spectrum(std::size_t channel) const noexcept {
    return spectra_.spectrum(windows - 1, channel);
  }

 private:
  static constexpr std::size_t windows = Spectra::windows_s.size();

  /// The strongest line of a window, of whatever order.
  struct Peak {
    double frequency_hz = 0.0;
    double share = 0.0;   ///< of the whole energy between the limits that it was looked for in
    double energy = 0.0;  ///< that whole
  };
  /// What stands out in a hop.
  struct Finding {
    bool ratio = false, growth = false, family = false, alone = false, runaway = false;
    double frequency_hz = 0.0;
    [[nodiscard]] bool any() const noexcept { return ratio || growth || family || alone || runaway; }
  };
  /// Hops in which it did.
  struct Counts {
    std::size_t ratio = 0, growth = 0, family = 0, alone = 0, calm = 0;
  };

  void measure(std::uint64_t bad_channels) noexcept;
  [[nodiscard]] std::span<const float> without_a_lone_line(std::size_t window) noexcept;
  [[nodiscard]] Peak strongest(const Spectrum& like, double low_hz, double high_hz) const noexcept;
  void fill_cells() noexcept;
  [[nodiscard]] Finding find(std::uint64_t bad_channels) noexcept;
  void find_in_cut(Finding& out) noexcept;
  [[nodiscard]] bool ratio_stands_out() const noexcept;
  [[nodiscard]] bool stands_alone() const noexcept;
  [[nodiscard]] bool may_be_the_cut(double frequency_hz, double highest_of_rotation, double highest_of_teeth,
                                    double off) const noexcept;
  [[nodiscard]] double speed_off() const noexcept;
  void learn_tones() noexcept;
  [[nodiscard]] bool rings_down(double frequency_hz, std::uint64_t bad_channels) const noexcept;
  [[nodiscard]] double count(const Finding& found) noexcept;
  void describe(std::uint64_t bad_channels, Verdict& verdict) const noexcept;

  Setup setup_;
  std::size_t family_hops_;  // that an alarm takes
  Spectra spectra_;
  SpeedPosterior speed_;
  CombSearch search_;                                    // where no speed is given, or the one given explains nothing
  bool given_ = false;                                   // a speed is
  double measured_hz_ = 0.0, measured_std_ratio_ = 0.0;  // 0: not, in this hop
  CutFollower cut_;
  GrowthTest growth_;
  FamilyGrowth family_;
  Runaway runaway_;
  Tones tones_;
  std::vector<ResidualLines> lines_;       // of each window
  std::vector<float> power_, long_power_;  // of all channels, of the window measured last and of the long one
  std::vector<float> rest_;                // of the window measured last, without a line that dominates
  std::array<ResidualFamily, windows> found_ = {};
  std::array<Peak, windows> peak_ = {};
  std::vector<double> cells_;  // energy beside the orders by frequency; all of it, where no speed is known
  double air_energy_ = 0.0;    // the least of late
  Counts counts_;
  bool chatter_ = false;
  double frequency_hz_ = 0.0, short_frequency_hz_ = 0.0;
};

}  // namespace robomill::monitor
