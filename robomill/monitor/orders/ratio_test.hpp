#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "robomill/monitor/monitor.hpp"
#include "robomill/monitor/orders/comb_search.hpp"
#include "robomill/monitor/orders/growth_test.hpp"
#include "robomill/monitor/orders/residual_lines.hpp"
#include "robomill/monitor/orders/spectra.hpp"
#include "robomill/monitor/orders/speed_posterior.hpp"

namespace robomill::monitor {

/// Tests a cut for chatter by its orders. Forced vibration stands at the multiples of rotation and lasts as long as the
/// tool cuts; chatter stands beside them. With S the synchronous energy and L that of the strongest family of lines
/// {±f_c + k f} (ResidualLines), in the last 0.3 s and 0.15 s, any of these for three hops is chatter:
///
/// ratio:  L > 0.2 S in both windows, at a known speed, where L exceeds the swing of S in 0.3 s: entry, exit and a
/// change of speed move energy out of the orders. Eight hops, while the tool enters. growth: a line that is no multiple
/// of the teeth has grown by 10 dB (GrowthTest), the speed stands still to 0.4 %, and
///         the line exceeds half the swing.
/// alone:  one line holds 0.6 of all energy where no speed was known since the tool entered, and is no low multiple of
///         rotation or of tooth passing. Four hops.
///
/// No line counts that rings down as a knock does (the last 25 ms below 0.4 of the strongest of the last six), that is
/// a low multiple of 50 or 60 Hz, that is smaller than a hundredth of the cut, or that has not grown by 6 dB within a
/// second or so: tones of the machine or of the room were there before. Chatter is over after six hops without.
///
/// The speed is known from where the posterior is narrow and the comb holds a third of the energy, until S falls below
/// a tenth of what it was, which is the tool leaving, or to 0.4 within 0.3 s while the whole stays, which is another
/// speed.
class RatioTest {
 public:
  struct Setup {
    double sample_rate_hz = 0.0, hop_s = 0.025;
    std::size_t channels = 1;
    int teeth = 0;                   ///< 0: unknown
    double speed_std_ratio = 0.015;  ///< of the hint
  };
  struct Verdict {
    bool chatter = false;
    bool pending = false;           ///< something stands out, not yet for long enough
    double frequency_hz = 0.0;      ///< of the strongest line that stands out; 0: none
    double frequency_std_hz = 0.0;  ///< its standard deviation
    std::size_t channel = 0;        ///< in which it is strongest
    SynchronousChatter synchronous = SynchronousChatter::none;
    double ratio = 0.0;               ///< L/S of the last 0.15 s
    double swing = 0.0;               ///< of S in 0.3 s, to the last S
    bool one_line = false;            ///< one line dominates that no low order can be, at the speed that is given
    double energy = 0.0;              ///< of everything in the last 0.15 s
    double rotation_hz = 0.0;         ///< most likely; 0: no hint, where the comb found may be a multiple of it
    double rotation_std_ratio = 0.0;  ///< standard deviation, of it
    bool known = false;               ///< the tool cuts at a known speed, or a multiple of it
  };
  explicit RatioTest(const Setup& setup);
  /// [Hz]; 0: unknown.
  void set_hint(double rotation_hz) noexcept;
  /// A measurement of the speed [Hz], good for the next hop.
  void measured(double rotation_hz, double std_ratio) noexcept;
  /// A hop.
  /// @param samples       of all channels, channel after channel, without offset, `frames` each
  /// @param bad_channels  bit c: left out
  Verdict step(std::span<const float> samples, std::size_t frames, std::uint64_t bad_channels) noexcept;
  /// As after construction; the hint stays.
  void reset() noexcept;

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
    bool ratio = false, growth = false, alone = false;
    double frequency_hz = 0.0;
    [[nodiscard]] bool any() const noexcept { return ratio || growth || alone; }
  };

  void measure(std::uint64_t bad_channels) noexcept;
  [[nodiscard]] Peak strongest(const Spectrum& like, double low_hz, double high_hz) const noexcept;
  void follow_cut() noexcept;
  [[nodiscard]] Finding find(std::uint64_t bad_channels) noexcept;
  [[nodiscard]] bool ratio_stands_out() const noexcept;
  [[nodiscard]] bool one_line_dominates() const noexcept;
  [[nodiscard]] bool stands_alone() const noexcept;
  [[nodiscard]] bool may_be_the_cut(double frequency_hz) const noexcept;
  void learn_tones() noexcept;
  [[nodiscard]] bool was_there(double frequency_hz) const noexcept;
  [[nodiscard]] bool rings_down(double frequency_hz, std::uint64_t bad_channels) const noexcept;
  [[nodiscard]] double swing() const noexcept;
  [[nodiscard]] std::size_t hops(double seconds) const noexcept;
  void describe(std::uint64_t bad_channels, Verdict& verdict) const noexcept;

  Setup setup_;
  Spectra spectra_;
  SpeedPosterior speed_;
  CombSearch search_;                                    // where no speed is given
  bool given_ = false;                                   // a speed is
  double measured_hz_ = 0.0, measured_std_ratio_ = 0.0;  // 0: not, in this hop
  GrowthTest growth_;
  std::vector<ResidualLines> lines_;       // of each window
  std::vector<float> power_, long_power_;  // of all channels, of the window measured last and of the long one
  std::array<ResidualFamily, windows> found_ = {};
  std::array<Peak, windows> peak_ = {};
  std::vector<double> cells_, tones_;  // energy beside the orders by frequency; the same, slow, without chatter
  double air_energy_ = 0.0;            // the least of late
  std::size_t tone_hops_ = 0;          // that these were learnt from
  std::vector<double> synchronous_, whole_, rotation_;  // of the short window, the last 0.3 s; rings
  std::size_t hop_ = 0;                                 // in these
  std::size_t ratio_hops_ = 0, growth_hops_ = 0, alone_hops_ = 0, calm_hops_ = 0;  // running
  std::size_t entry_hops_ = 0, lost_hops_ = 0;  // until the tool has entered; until a lost speed is no news
  double cut_ = 0.0;                            // S while the tool cuts at a known speed, slow; 0: it does not
  double loudest_ = 0.0;                        // of these, slowly forgotten
  bool chatter_ = false;
  double frequency_hz_ = 0.0, short_frequency_hz_ = 0.0;
};

}  // namespace robomill::monitor
