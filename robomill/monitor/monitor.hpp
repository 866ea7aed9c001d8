#pragma once
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/base/names.hpp"
#include "robomill/base/units.hpp"

// Method: robomill/monitor/README.md, "Method"

namespace robomill::monitor {

/// Which detector decides.
enum class Kind {
  comb_cusum,     ///< what repeats with the spindle is taken off; the rest is tested against it and against its past
  energy_entropy  ///< the published detector: the entropy of the bands' energies against a calibrated threshold
};
inline constexpr Name<Kind> kind_names[] = {{"comb-cusum", Kind::comb_cusum}, {"energy-entropy", Kind::energy_entropy}};
/// Of the bands' energies E_b, p_b = E_b / Σ E.
enum class Entropy {
  normalised,  ///< -Σ p_b ln p_b: blind to the amplitude
  energy       ///< -Σ E_b ln p_b: grows with the amplitude's square
};
inline constexpr Name<Entropy> entropy_names[] = {{"normalised", Entropy::normalised}, {"energy", Entropy::energy}};
/// What a decision says of the cut.
enum class State {
  stable,      ///< no alarm, and none on its way up or down
  transition,  ///< comb_cusum: something stands out, not yet for long enough; energy_entropy: an alarm on its way down
  chatter,     ///< an alarm: score > threshold (energy_entropy with alarm_below: <)
  blind        ///< nothing can be said of the cut; Decision::reason says why
};
/// Why nothing can be said of the cut. The first that applies is given; chatter once found is not blind.
enum class BlindReason {
  none,
  /// No channel of vibration can be used: each is stuck, dead or mostly not finite, or was so within
  /// MonitorOptions::look_back_s(). A session also gives it where no samples come.
  no_signal,
  clipped,        ///< for 4 hops and more, every channel that can be used was at its converter's limit
  speed_unknown,  ///< no spindle speed was given, and none can be found, or one below 240 rpm: the detector's
  gap,            ///< as no_signal, where most frames are NaN in every channel: samples that were lost on their way
  standstill,     ///< the spindle turns slower than MonitorOptions::min_speed_rad_per_s
  overloaded,     ///< a session's: its decisions are more than a second behind the samples, or hops were left out
  /// comb_cusum, of a stream that began or was reset: neither a calm nor enough time has been seen to tell a stable cut
  /// from one that began in chatter. Lasts 0.6 s at least; then until a calm is known, and 3 s at most. A machine that
  /// was learnt is calm that is known. An alarm may come meanwhile.
  learning
};
/// Those that are one.
inline constexpr BlindReason blind_reasons[] = {
    BlindReason::no_signal,  BlindReason::clipped,    BlindReason::speed_unknown, BlindReason::gap,
    BlindReason::standstill, BlindReason::overloaded, BlindReason::learning};
/// Chatter synchronous with the spindle. It is detected by the power of a multiple of rotation against what was learnt
/// of it.
enum class SynchronousChatter {
  none,            ///< no chatter, or not synchronous
  locked,          ///< to the rotation: at a multiple of it that is none of tooth passing
  period_doubling  ///< half way between two multiples of tooth passing (even numbers of teeth)
};

/// The tests of Kind::comb_cusum. Method: README.md.
enum class Test : std::uint8_t {
  none,       ///< none has anything to go by
  dominant,   ///< one line that is no forced vibration comes to hold nearly all energy, and still grows
  ratio,      ///< what stands beside the multiples of rotation, against these
  family,     ///< several lines at one fraction of an order have grown: mild chatter
  growth,     ///< a line that is no multiple of tooth passing has grown, wherever it moves
  runaway,    ///< a line grows exponentially
  slow_ratio  ///< much of a slow spindle's vibration does not repeat from turn to turn, has come and lasts: arms
};
inline constexpr Name<Test> test_names[] = {
    {"none", Test::none},     {"dominant", Test::dominant}, {"ratio", Test::ratio},          {"family", Test::family},
    {"growth", Test::growth}, {"runaway", Test::runaway},   {"slow-ratio", Test::slow_ratio}};
/// What a test compares with a threshold. Ratios are of energies. Names, words and scales: explanation.hpp.
enum class Quantity : std::uint8_t {
  line_share,       ///< of the strongest unforced line, of all energy
  line_kept,        ///< of the last 12 hops, those in which it stood where it is now: 8 %, 3 % or 8 Hz above 100 Hz
  line_rise,        ///< of its energy in 1.7 s
  line_rise_since,  ///< the same, since 0.3 s after it began to dominate
  above_quiet,      ///< all energy to the least of late
  speed_belief,     ///< of the tracked speed, 0 to 1
  anchored,  ///< the multiples of rotation against what a right speed leaves them: a fifth of all, or half of before
  cutting,   ///< the tool cuts: above_quiet/4 or the share of the multiples of rotation/0.35, the greater
  staying,   ///< all energy to the most of the last 0.4 s, slow_ratio: of a second; less is the tool leaving
  entered,   ///< s since the tool entered
  asynchronous_ratio,  ///< of the strongest family beside the orders, to the orders
  family_above_quiet,  ///< of that family, to the least of all energy of late
  mains_distance,      ///< Hz, of the line to the nearest low multiple of 50 or 60 Hz: hum
  order_change,    ///< of the order beside the line in 0.3 s, in widths of a line: an order that moves is no chatter
  family_lines,    ///< of that family, 10 dB above the noise
  family_growth,   ///< of that family, to its own past 2 s
  line_growth,     ///< of a line beside the multiples of tooth passing, to its own past second
  line_to_teeth,   ///< of that line, to the multiples of tooth passing
  line_to_swing,   ///< of that line, to what these changed by in 0.3 s
  line_sustained,  ///< of the line's last turn, to the strongest 25 ms of its window: less rings down after a knock
  line_kept_up,    ///< the same of the last turn and of the one before, the less of both
  line_spread,     ///< of that energy over the window, 1: even; knocks are not
  line_new,        ///< of the line, to what the machine shows there without chatter
  other_speed,     ///< evidence for a speed at which the line is an order, beyond that for the tracked one
  rest_ratio,      ///< slow_ratio: of what does not repeat from turn to turn, to what does
  rest_holding,    ///< of that, second half of its window to the first: what rings falls
  rest_rise,       ///< of that, to its least of 2 s
  rest_lasting,    ///< of the last 0.4 s, the part in which all that slow_ratio asks was so
  repeating,       ///< of what repeats, to its most of a second: it goes where the tool leaves
  repeating_above_quiet,  ///< of what repeats, to the least of all energy of late: it comes with the cut
  loud_for,               ///< s for which all energy has stood above the quietest
  runaway_rise,           ///< 1 while a line grows exponentially by 20/s or more
  agreement,              ///< votes of several sensors, to those an alarm takes
};
/// One of what a test asks for.
struct Condition {
  Quantity quantity = Quantity::line_share;
  bool at_most = false;  ///< the value must be at most the threshold; else at least
  float value = 0.0F, threshold = 0.0F;
  [[nodiscard]] bool holds() const noexcept { return at_most ? value <= threshold : value >= threshold; }
};
/// Why a decision is what it is: of the test that holds the alarm, or came closest to one, all conditions. An alarm
/// begins where they hold; it is held by less (README.md, "Tests").
struct Explanation {
  Test test = Test::none;
  int sensor = 0;  ///< that it is about, of several: from 1, in the order of MonitorOptions::sensors; 0: one
  int hops = 0, enough_hops = 0;  ///< of the last 8 (growth: in a row) in which it held, of those an alarm takes
  float speed_belief =
      0.0F;  ///< in the tracked speed, 0 to 1; below 0.12 only `dominant`, `slow_ratio` and `runaway` are armed
  int conditions = 0;
  std::array<Condition, 15> condition = {};
  void ask(Quantity quantity, double value, double threshold, bool at_most = false) noexcept {
    if (conditions < static_cast<int>(condition.size())) {
      constexpr double most = std::numeric_limits<float>::max();  // a ratio to nothing is infinite
      const double held =
          std::abs(value) > most ? std::copysign(std::numeric_limits<double>::infinity(), value) : value;
      condition[static_cast<std::size_t>(conditions++)] = {quantity, at_most, static_cast<float>(held),
                                                           static_cast<float>(threshold)};
    }
  }
  [[nodiscard]] int held() const noexcept {
    int count = 0;
    for (int i = 0; i < conditions; ++i) count += condition[static_cast<std::size_t>(i)].holds() ? 1 : 0;
    return count;
  }
};

/// What is wrong with the input; a bit mask, since several may be.
enum Fault : std::uint32_t {
  not_finite = 1,          ///< NaN, infinite or |sample| >= 1e15; the last good one stands in for them
  stuck = 2,               ///< a channel that moved repeats one value for >= 20 ms
  clipped = 4,             ///< |sample| >= 0.9999 full_scale, or two runs and more of 4 equal samples at the extremes
  dead_channel = 8,        ///< a channel that never moved, or with a variance < 1e-8 of its sensor's loudest one
  wrong_sample_rate = 16,  ///< the comb fits at another one, Decision::suggested_sample_rate_hz
  speed_unknown = 32       ///< no comb was found: in air, or the tests run without
};

struct Machine;

/// The least MonitorOptions::min_speed_rad_per_s.
inline constexpr double slowest_min_speed_rad_per_s = 1.0 * units::rpm;

struct ROBOMILL_API MonitorOptions {
  Kind kind = Kind::comb_cusum;
  double sample_rate_hz = 0.0;  ///< in [100, 1e6]; required
  int channels = 1;             ///< in [1, 64]; interleaved, in the order of the files
  int tachometer_channel = -1;  ///< of these, from 0: pulses, which are no vibration; -1: none
  /// comb-cusum: of each channel its sensor, from 0 on, 8 at most; the tachometer's is not used. The powers of a
  /// sensor's channels are added; sensors are judged apart and an alarm takes their agreement (README.md). Empty: one
  /// sensor.
  std::vector<int> sensors = {};
  int agreeing_sensors = 0;       ///< votes at one line that an alarm takes, >= 0; 0: (n + 1)/2 of n that see the cut
  int pulses_per_revolution = 1;  ///< of the tachometer or encoder; in [1, 10000]
  double spindle_speed_rad_per_s = 0.0;  ///< a hint, off by several percent in real metadata; 0: unknown
  double speed_std_ratio = 0.015;        ///< of the hint, in (0, 0.2]: width of a Cauchy distribution about it
  /// Below it the spindle stands still: BlindReason::standstill. In [1, 100000] rpm; a hint is none or above it.
  double min_speed_rad_per_s = 30.0 * units::rpm;
  int teeth = 0;                      ///< in [0, 64]; 0: unknown
  double window_s = 0.05;             ///< energy-entropy: of the transform; at least 32 samples and one hop
  double hop_s = 0.025;               ///< between decisions; at least 4 samples, of energy-entropy 16
  int bands = 16;                     ///< equal, from 0 to half the sample rate; in [2, 64]
  Entropy entropy = Entropy::energy;  ///< energy-entropy
  /// energy-entropy: finite, required there; chatter where Decision::energy_entropy > threshold (alarm_below: <). It
  /// holds for one form, unit and sensor, and calibrate() sets it.
  double threshold = std::numeric_limits<double>::quiet_NaN();
  bool alarm_below = false;  ///< energy-entropy: which side of the threshold is chatter, from calibration
  /// comb-cusum, > 0: in how many of 8 hops a family must stand: 5 at 0.1, one more for every factor of 37
  /// fewer, 3 to 8.
  double false_alarms_per_hour = 0.1;
  double full_scale = 0.0;  ///< at which the converter clips, >= 0: |sample| >= 0.9999 of it; 0: unknown
  /// comb-cusum: what this machine shows without chatter (machine.hpp), of the same sample rate and channels; null: not
  /// known.
  std::shared_ptr<const Machine> machine = {};
  /// @throws InvalidInput naming the field
  void validate() const;
  [[nodiscard]] int sensor_count() const noexcept;
  /// Samples a hop and a window: the times, rounded.
  [[nodiscard]] std::size_t hop_samples() const noexcept;
  [[nodiscard]] std::size_t window_samples() const noexcept;
  /// Of the stream, how far back a decision looks: the default detector's longest window, or two of the published one's
  /// where these are longer.
  [[nodiscard]] double look_back_s() const noexcept;
};

/// One a hop, by value.
struct Decision {
  std::uint64_t hop = 0;  ///< from 1; 0: none was made yet
  double time_s = 0.0;    ///< of the last sample it used: when it could be made
  State state = State::stable;
  BlindReason reason = BlindReason::none;  ///< of State::blind
  bool changed = false;                    ///< state differs from the last decision's
  double score = 0.0;                      ///< of the test
  double threshold = 0.0;  ///< alarm where score > threshold (MonitorOptions::alarm_below: <); comb-cusum: 1
  /// Σ over the channels of the bands' energy entropy, as MonitorOptions::entropy has it; comb-cusum: of the last 0.15
  /// s. Of several sensors, this, level and band_level are those of the first one that can be used.
  double energy_entropy = 0.0;
  double level = 0.0;                 ///< rms of the channels of vibration over the hop, mean taken off [input's unit]
  double chatter_frequency_hz = 0.0;  ///< 0: none
  double chatter_frequency_std_hz = 0.0;     ///< its standard deviation
  int channel = 0;                           ///< in which chatter is strongest, from 0
  double spindle_speed_rad_per_s = 0.0;      ///< as tracked; 0: unknown
  double spindle_speed_std_rad_per_s = 0.0;  ///< its standard deviation
  double suggested_sample_rate_hz = 0.0;     ///< with Fault::wrong_sample_rate
  std::uint32_t faults = 0;                  ///< of Fault
  SynchronousChatter synchronous = SynchronousChatter::none;
  Explanation why = {};                   ///< comb_cusum
  int bands = 0;                          ///< used of band_level
  std::array<float, 64> band_level = {};  ///< rms of each band, all channels [input's unit]
};

class Detector;

/// Detects chatter in a stream of samples. Method and accuracy: robomill/monitor/README.md.
///
/// Nothing throws, and nothing is allocated, after construction. Not to be used by two threads at once.
class ROBOMILL_API ChatterMonitor {
 public:
  /// @throws InvalidInput naming an option that is out of range
  explicit ChatterMonitor(const MonitorOptions& options);
  ~ChatterMonitor();
  ChatterMonitor(ChatterMonitor&&) noexcept;
  ChatterMonitor& operator=(ChatterMonitor&&) noexcept;
  ChatterMonitor(const ChatterMonitor&) = delete;
  ChatterMonitor& operator=(const ChatterMonitor&) = delete;

  /// Samples of all channels interleaved, any number of them; what is left of a frame waits for the next call.
  /// @return the last decision made; its hop counts them
  Decision push(std::span<const float> samples) noexcept;
  /// Frames still wanted for the next decision; who pushes no more than these sees every one.
  [[nodiscard]] std::size_t frames_to_next_decision() const noexcept;
  /// A new hint [rad/s]. Below MonitorOptions::min_speed_rad_per_s, 0 too, the spindle stands still until the next one,
  /// and the hint before stays; negative or not finite: unknown.
  void set_spindle_speed(double rad_per_s) noexcept;
  /// As after construction; the last hint stays, and so does a spindle that stands still.
  void reset() noexcept;

 private:
  friend const Detector& detector_of(const ChatterMonitor& monitor);
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// "comb-cusum", "normalised", "stable", "locked", …: as the files write them.
[[nodiscard]] ROBOMILL_API std::string_view to_string(Kind kind);
[[nodiscard]] ROBOMILL_API std::string_view to_string(Entropy entropy);
[[nodiscard]] ROBOMILL_API std::string_view to_string(State state);
[[nodiscard]] ROBOMILL_API std::string_view to_string(BlindReason reason);
[[nodiscard]] ROBOMILL_API std::string_view to_string(SynchronousChatter kind);
[[nodiscard]] ROBOMILL_API std::string_view to_string(Test test);
[[nodiscard]] ROBOMILL_API std::string_view to_string(Quantity quantity);
/// "not-finite", …; of one bit.
[[nodiscard]] ROBOMILL_API std::string_view to_string(Fault fault);

}  // namespace robomill::monitor
