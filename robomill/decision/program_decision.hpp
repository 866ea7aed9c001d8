#pragma once
#include <cstddef>
#include <limits>
#include <optional>
#include <string_view>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/base/names.hpp"
#include "robomill/base/progress.hpp"

// Method: robomill/decision/README.md, "A whole program (`program_decision.hpp`)"

namespace robomill::decision {

/// What keeps a cut of a program from a speed, a feed or a posture. Values are in SI units.
enum class ProgramLimit {
  none,
  stability,         ///< stability margin at some speed of the window, at least
  force,             ///< peak force on the tool
  torque,            ///< mean over a revolution, of what the spindle has
  power,             ///< …
  deflection,        ///< of the tip, under the mean force of a revolution
  surface_error,     ///< surface location error, its magnitude
  greatest_chip,     ///< chip thickness
  least_chip,        ///< chip thickness, at least
  cutting_speed,     ///< of the outermost point that cuts
  spindle_range,     ///< speeds that the spindle has
  tip_speed,         ///< of the tip along its path
  joint_speed,       ///< of a joint
  joint_torque,      ///< of a joint, as a share of what its drive gives
  forced_vibration,  ///< amplitude of the tip about its mean, of which the feed per tooth is allowed
  reversal,          ///< of a joint's load while it cuts: its backlash opens
  posture            ///< the robot cannot stand there, or not without a collision
};
inline constexpr Name<ProgramLimit> program_limit_names[] = {{"none", ProgramLimit::none},
                                                             {"stability", ProgramLimit::stability},
                                                             {"force", ProgramLimit::force},
                                                             {"torque", ProgramLimit::torque},
                                                             {"power", ProgramLimit::power},
                                                             {"deflection", ProgramLimit::deflection},
                                                             {"surface_error", ProgramLimit::surface_error},
                                                             {"greatest_chip", ProgramLimit::greatest_chip},
                                                             {"least_chip", ProgramLimit::least_chip},
                                                             {"cutting_speed", ProgramLimit::cutting_speed},
                                                             {"spindle_range", ProgramLimit::spindle_range},
                                                             {"tip_speed", ProgramLimit::tip_speed},
                                                             {"joint_speed", ProgramLimit::joint_speed},
                                                             {"joint_torque", ProgramLimit::joint_torque},
                                                             {"forced_vibration", ProgramLimit::forced_vibration},
                                                             {"reversal", ProgramLimit::reversal},
                                                             {"posture", ProgramLimit::posture}};
[[nodiscard]] ROBOMILL_API std::string_view to_string(ProgramLimit limit);

/// A limit with what stands against it.
struct LimitUse {
  ProgramLimit limit = ProgramLimit::none;
  double value = 0.0, allowed = 0.0;
};

/// A line of a program that cuts: the unit of a feed.
struct ProgramCut {
  double length_m = 0.0;                ///< > 0; way of the tip at feed
  double feed_m_per_s = 0.0;            ///< > 0; as programmed
  double tooth_feed_share = 1.0;        ///< > 0; feed of what cuts over that of the tip
  std::vector<std::size_t> looks = {};  ///< classes of its engagements, of ProgramModel::look
  /// What the machine makes of it, where that was measured: lost_s + feed_part · length / feed.
  double lost_s = 0.0, feed_part = 1.0;  ///< >= 0; in [0, 1]
  /// Infinite at no feed.
  [[nodiscard]] double time_s(double at_feed_m_per_s) const {
    if (!(at_feed_m_per_s > 0.0)) return std::numeric_limits<double>::infinity();
    return lost_s + feed_part * length_m / at_feed_m_per_s;
  }
};

/// Cuts on end, without air between them: the unit of a spindle speed.
struct ProgramStretch {
  std::size_t begin = 0, end = 0;                   ///< cuts [begin, end)
  double programmed_spindle_speed_rad_per_s = 0.0;  ///< > 0
  /// First cuts of the same lines made otherwise, as many each: [others[k], others[k] + end - begin).
  std::vector<std::size_t> others = {};
};

/// Feeds that a cut may have at a speed, as far as they need no dynamics.
struct FeedRange {
  double least_m_per_s = 0.0, most_m_per_s = 0.0;  ///< none where least > most
  /// What limits them, with the value at the programmed feed; of loads where the range is empty at its least feed.
  LimitUse least_by = {}, most_by = {};
  /// What keeps a range that is empty from a feed: most_by, with the value at the least feed of it.
  [[nodiscard]] ROBOMILL_API LimitUse contradiction() const;
};

/// A class of cuts at a speed in a posture.
struct CutLook {
  bool holds = false;
  LimitUse by = {};  ///< what does not hold; else the stability margin
  /// >= 0; by the surface error, or by forced vibration that grows faster than the feed.
  double most_feed_per_tooth_m = std::numeric_limits<double>::infinity();
  /// Where that is finite: `by` at this feed per tooth, and the rise of its value with the feed.
  double by_feed_per_tooth_m = 0.0, by_rise_per_m = 0.0;
  /// By forced vibration that edges or runout make, which the feed must exceed.
  double least_feed_per_tooth_m = 0.0;
  LimitUse least_by = {};
  /// `by` at a feed per tooth.
  [[nodiscard]] ROBOMILL_API LimitUse at(double feed_per_tooth_m) const;
};

/// What a program asks of its machine. Its functions are called by several threads at once, and answer alike each time.
class ROBOMILL_API ProgramModel {
 public:
  ProgramModel() = default;
  ProgramModel(const ProgramModel&) = delete;
  ProgramModel& operator=(const ProgramModel&) = delete;
  ProgramModel(ProgramModel&&) = delete;
  ProgramModel& operator=(ProgramModel&&) = delete;
  virtual ~ProgramModel() = default;
  [[nodiscard]] virtual FeedRange feeds(std::size_t cut, double spindle_speed_rad_per_s) const = 0;
  /// @param gamma  of ProgramOptions::gamma_rad
  [[nodiscard]] virtual CutLook look(std::size_t look_class, double spindle_speed_rad_per_s,
                                     std::size_t gamma) const = 0;
};

struct ROBOMILL_API ProgramOptions {
  int teeth = 0;                             ///< >= 1; required
  bool free_speed = true, free_feed = true;  ///< else as programmed
  double min_spindle_speed_rad_per_s = 0.0;  ///< > 0; required where the speed is free
  double max_spindle_speed_rad_per_s = 0.0;  ///< >= min
  /// w in [0, 0.5): what is looked at holds from n (1 - w) to n (1 + w), in steps of w/2, of 0.25 to 1 %; speeds are
  /// looked for in the same steps.
  double speed_window = 0.02;
  bool one_speed = false;           ///< for all stretches
  double ramp_rad_per_s2 = 0.0;     ///< >= 0; a change between stretches takes |Δn| / ramp; 0: no time
  double feed_slack = 0.01;         ///< >= 0; share of the time that fewer changes of feed may cost
  double speed_step_rad_per_s = 0;  ///< >= 0; speeds are whole multiples of it
  double feed_step_m_per_s = 0.0;   ///< >= 0; … feeds, downwards
  /// Turns of the flange about the tool's axis from where it is programmed, increasing, with 0.
  std::vector<double> gamma_rad = {0.0};
  double gamma_rate_rad_per_s = 0.5;  ///< > 0; γ takes one step of gamma_rad in so much time of cutting
  /// >= 0; another way of a stretch is taken where the program's own takes more than (1 + other_gain) times as long.
  double other_gain = 0.02;
  int alternatives = 6;  ///< >= 0
  /// @throws InvalidInput naming the member
  void validate() const;
};

/// A stretch as decided.
struct DecidedStretch {
  double spindle_speed_rad_per_s = 0.0;
  double cutting_time_s = 0.0;  ///< of its cuts, ProgramCut::time_s
  std::size_t way = 0;          ///< 0: as the program makes it; k: ProgramStretch::others[k - 1]
  LimitUse limited_by = {};     ///< of the cut that gives away most time to its limit
  std::size_t limiting_cut = 0;
};

/// A speed that was not taken.
struct RejectedSpeed {
  double spindle_speed_rad_per_s = 0.0;
  std::size_t stretch = 0;  ///< one speed for all: that which is stopped
  /// At the feeds, of the stretch, one speed for all: of all; at least where a limit stops it.
  double cutting_time_s = 0.0;
  LimitUse stopped_by = {};  ///< none: it is slower; of several ways that were looked at the one that comes nearest
  std::size_t cut = 0;       ///< where, of that way
};

struct ProgramDecision {
  enum class Status {
    found,
    infeasible  ///< some stretch has no speed at which every cut keeps its limits: see `rejected`, nearest first
  };
  Status status = Status::infeasible;
  std::vector<DecidedStretch> stretches = {};  ///< one a stretch
  std::vector<double> feed_m_per_s = {};       ///< one a cut; 0 of ways that were not taken
  /// Of gamma_rad, one where each cut begins and ends: linear between. 0 of ways that were not taken.
  std::vector<double> gamma_begin_rad = {}, gamma_end_rad = {};
  double cutting_time_s = 0.0, ramp_time_s = 0.0;
  /// found: faster ones and what stopped them, and slower ones. infeasible: what stopped each speed of that stretch,
  /// one speed for all: of the stretch that misses most.
  std::vector<RejectedSpeed> rejected = {};
  long long looks = 0;  ///< calls of ProgramModel::look
};

/// The spindle speed of every stretch, the way in which it is made, the feed of every cut and γ along them with the
/// least time
///     Σ ProgramCut::time_s(feed) + Σ |Δn| / ramp
/// such that every cut keeps its limits. Speeds are a grid; on it the answer is exact: a shortest path through
/// stretches × ways × speeds (and, of each, through cuts × γ) is sought with bounds in place of what has not been
/// looked at, its unseen nodes are looked at, and so on until it has none. Feeds are then evened out: the fewest
/// changes that cost no more than feed_slack of the time.
/// @param cuts  those of the stretches first, one after another; behind them those of other ways, each of one at most
/// @throws InvalidInput if an option, a cut or a stretch is out of range; Interrupted
[[nodiscard]] ROBOMILL_API ProgramDecision decide_program(const std::vector<ProgramCut>& cuts,
                                                          const std::vector<ProgramStretch>& stretches,
                                                          const ProgramModel& model, const ProgramOptions& options,
                                                          Progress& progress = Progress::none());

}  // namespace robomill::decision
