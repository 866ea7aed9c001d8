#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "robomill/monitor/monitor.hpp"
#include "robomill/monitor/orders/comb_search.hpp"
#include "robomill/monitor/orders/cut_state.hpp"
#include "robomill/monitor/orders/dominant_line.hpp"
#include "robomill/monitor/orders/growth_test.hpp"
#include "robomill/monitor/orders/machine_lines.hpp"
#include "robomill/monitor/orders/noise_floor.hpp"
#include "robomill/monitor/orders/residual_lines.hpp"
#include "robomill/monitor/orders/runaway.hpp"
#include "robomill/monitor/orders/slow_line.hpp"
#include "robomill/monitor/orders/spectra.hpp"
#include "robomill/monitor/orders/speed_tracker.hpp"
#include "robomill/monitor/orders/turn_split.hpp"

namespace robomill::monitor {

/// Tests a cut for chatter. Forced vibration stands at the multiples of rotation and lasts as long as the tool cuts;
/// chatter stands beside them. Method: README.md; thresholds: thresholds.hpp.
class CutTests {
 public:
  struct Setup {
    double sample_rate_hz = 0.0, hop_s = 0.025;  ///< >= 100 Hz
    std::size_t channels = 1;
    int teeth = 0;                                ///< 0: unknown
    double speed_std_ratio = 0.015;               ///< of the hint
    double false_alarms_per_hour = 0.1;           ///< one hop more of a family for every factor of 37 fewer
    std::shared_ptr<const Machine> machine = {};  ///< null: not known
  };
  struct Verdict {
    bool chatter = false;
    /// Hops that speak for chatter, of those an alarm takes; in chatter 1 + L/S, 1.18 to 100.
    double score = 0.0;
    double frequency_hz = 0.0;      ///< of the strongest line that stands out; 0: none
    double frequency_std_hz = 0.0;  ///< its standard deviation
    std::size_t channel = 0;        ///< in which it is strongest
    SynchronousChatter synchronous = SynchronousChatter::none;
    double rotation_hz = 0.0;         ///< most likely; 0: no hint, where the comb found may be a multiple of it
    double rotation_std_ratio = 0.0;  ///< standard deviation, of it
    bool known = false;               ///< the tool cuts at a known speed, or a multiple of it
    bool explained = false;           ///< … and its orders hold a good part of the energy
    /// Something calm has been seen, or was learnt: the cut was quieter than it is by a factor of four once, or nothing
    /// stood beside its orders for half a second. Without it steady chatter cannot be told from a stable cut.
    bool calm_known = false;
    double comb_hz = 0.0;  ///< of the comb that is sought far from the hint while no speed is known; 0: none
    Explanation why;
  };
  explicit CutTests(const Setup& setup);
  CutTests(const CutTests&) = delete;  // windows refer to spectra of it
  CutTests& operator=(const CutTests&) = delete;
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
  /// Of the longest window at a speed; 0: unknown.
  [[nodiscard]] static double history_s(double rotation_hz) noexcept;
  /// Of a channel, the last 0.15 s.
  [[nodiscard]] const Spectrum& spectrum(std::size_t channel) const noexcept { return fast_.spectrum(1, channel); }
  /// What of the last hop a machine is learnt from.
  struct Shown {
    double seconds = 0.0;              ///< that were seen
    double energy = 0.0;               ///< of all, in the last 0.3 s
    double rotation_hz = 0.0;          ///< of the cut that is followed; 0: none
    std::span<const float> fast;       ///< power of the last 0.15 s, line by line
    std::span<const float> slow;       ///< … of the last 0.3 s
    const Spectra* spectra = nullptr;  ///< their windows 1 and 0
    std::uint64_t bad_channels = 0;    ///< bit c: left out
  };
  [[nodiscard]] Shown shown() const noexcept;
  /// Energies in cells of Machine::cell_hz: of everything in the last 0.15 s; beside the orders of a cut that is
  /// followed, in the window of the growth.
  void show(std::span<double> all, std::span<double> beside) const noexcept;

 private:
  /// A window in which orders are followed: eight turns at least.
  struct Window {
    Spectra* spectra;
    std::size_t at;  // in these
    double seconds;
    ResidualLines lines;
    std::vector<float> power;  // of all channels, up to the highest line that counts
    [[nodiscard]] const Spectrum& like() const noexcept { return spectra->spectrum(at, 0); }
  };
  enum Of : std::size_t { s_0_15, s_0_3, s_0_5, s_1, s_2, windows };
  static constexpr std::size_t tests = std::size(test_names);
  static constexpr double block_s = 0.025;
  static constexpr std::size_t most_blocks = 80;  // of the longest window

  [[nodiscard]] std::size_t most_lines() const noexcept;  // of a spectrum
  void measure(std::uint64_t bad_channels) noexcept;
  void choose_windows() noexcept;
  void transform(std::size_t window, std::uint64_t bad_channels) noexcept;
  [[nodiscard]] std::span<const float> floor_of(const Window& window) noexcept;
  void follow_growth() noexcept;
  void follow_dominant() noexcept;
  void follow_runaway() noexcept;
  void follow_slow_line(std::uint64_t bad_channels) noexcept;
  void ask_of_other_speeds(Explanation& why, double line_hz, const Window& window) const noexcept;
  void ask_of_the_turns(Explanation& why) const noexcept;
  [[nodiscard]] Of window_of(Test test) const noexcept;  // in which its line is read, of a slow line apart
  [[nodiscard]] std::pair<const Spectra*, std::size_t> read_in() const noexcept;
  [[nodiscard]] bool may_be_the_cut(double frequency_hz) const noexcept;
  void explain_all() noexcept;
  [[nodiscard]] double belief() const noexcept;
  [[nodiscard]] bool follows() const noexcept;    // the tool cuts at a tracked speed
  [[nodiscard]] bool explained() const noexcept;  // … and the speed explains a good part of it
  void ask_of_the_cut(Explanation& why, double line_hz, std::size_t window) const noexcept;
  [[nodiscard]] double reading_hz(Test test) const noexcept;
  [[nodiscard]] bool lives() const noexcept;
  [[nodiscard]] bool stays(Test test) const noexcept;
  void ask_what_is_new() noexcept;
  struct Sustained {
    double last = 0.0, last_two = 0.0;  ///< of the last turn, and the least of the last two, to the strongest 25 ms
    double spread = 0.0;
  };
  [[nodiscard]] Sustained sustained(Test test, std::uint64_t bad_channels) const noexcept;
  void decide(std::uint64_t bad_channels, bool still) noexcept;
  void look_for_calm(std::uint64_t bad_channels) noexcept;
  void describe(std::uint64_t bad_channels, Verdict& verdict) const noexcept;

  Setup setup_;
  Spectra fast_, slow_, slowest_;
  std::vector<Window> windows_;
  Of far_ = s_0_3, near_ = s_0_15;  // in which families are followed; in which growth is
  NoiseFloor floor_;
  SpeedTracker speed_;
  CombSearch search_;   // where no speed is given, or the one given explains nothing
  bool given_ = false;  // a speed is
  bool armed_ = false;  // the tests that need orders
  struct SlowWindow {
    std::size_t at;  // in slowest_
    double seconds;
    std::vector<float> power;
  };
  std::vector<SlowWindow> slow_windows_;          // the shortest first
  std::size_t slow_at_ = 0, slow_orders_at_ = 0;  // the one whose lines are followed; whose orders are
  SpeedTracker slow_speed_;
  SlowLine slow_line_;
  TurnSplit turn_split_;
  bool slow_spindle_ = false;
  double energy_ = 0.0;  // of all, in the last 0.3 s
  CutState cut_;
  DominantLine dominant_;
  GrowthTest growth_;
  FamilyPast past_;
  MachineLines machine_;
  Runaway runaway_;
  ResidualFamily found_far_, found_near_;
  GrowthTest::Verdict grown_;
  double grown_hz_ = 0.0, rises_hz_ = 0.0;  // of the line that has grown; that runs away
  bool rises_ = false;
  std::uint64_t bad_channels_ = 0;  // of the last hop
  std::array<Explanation, tests> why_ = {};
  std::array<std::uint8_t, tests> held_ = {};  // bits: the last 8 hops in which each test held
  std::size_t growing_ = 0;                    // hops in a row of the growth
  int family_hops_;                            // of the last 8, that an alarm takes
  bool chatter_ = false;
  Test alarm_ = Test::none;
  std::size_t calm_ = 0;  // hops without, in chatter
  bool calm_known_ = false;
  std::size_t clean_ = 0;  // hops in a row in which the tool cut and nothing stood beside its orders
  double frequency_hz_ = 0.0;
  Test read_by_ = Test::none;
};

}  // namespace robomill::monitor
