#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/decision/finish.hpp"
#include "robomill/decision/program_decision.hpp"
#include "robomill/decision/recommend.hpp"
#include "robomill/process/blocks.hpp"
#include "robomill/process/compensate.hpp"
#include "robomill/process/decide_options.hpp"
#include "robomill/process/forces.hpp"
#include "robomill/program/program.hpp"

// Method: robomill/process/README.md, "The decision (`decide.hpp`)"

namespace robomill::process {

/// What the robot makes of a program that was run and judged, along the trajectory that it would be smoothed to.
struct RobotRun {
  double time_s = std::numeric_limits<double>::quiet_NaN();  ///< of the whole program
  std::vector<double> block_time_s = {};                     ///< 0, or the block is missing: not known
  /// Of each block the greatest share of its torque that a drive gives, inertia too; empty: weight and cut alone count.
  std::vector<double> torque_shares = {};
};

/// A program with what is known of it, and what its conditions must keep.
struct DecideProblem {
  const ForcesResult& forces;   ///< as programmed, with a cell and cuts kept
  const ProgramBlocks& blocks;  ///< judged as programmed
  const DynamicsAt& dynamics;
  BlocksOptions blocks_options = {};
  decision::MachineLimits machine = {};  ///< but for the depth of the cutter
  decision::FinishLimits finish = {};
  DecideOptions options = {};
  double max_tip_speed_m_per_s = 0.0;  ///< of the path; 0: not known
  /// With γ as in DecideResult. Empty: time is that at the feeds.
  std::function<RobotRun(const ForcesResult& forces, const ProgramBlocks& blocks,
                         const std::vector<double>& gamma_offset_rad)>
      robot_run = {};
};

/// A limit that a block does not keep.
struct Violation : decision::LimitUse {
  std::size_t block = 0;
};

/// What a program comes to under some conditions.
struct Outcome {
  static constexpr double none = std::numeric_limits<double>::quiet_NaN();
  double cutting_time_s = 0.0;  ///< length / feed of what cuts: the tool at its feed throughout
  double robot_time_s = none;   ///< of the whole program along its smoothed trajectory; NaN: there is none
  double total_time_s =
      0.0;  ///< cutting time with air at feed, dwells and changes of the spindle's speed, without rapids
  double lowest_spindle_speed_rad_per_s = 0.0, highest_spindle_speed_rad_per_s = 0.0;
  std::size_t unstable_blocks = 0;       ///< deeper than their mean limit
  std::size_t uncertain_blocks = 0;      ///< stable by that, but deeper than its 5 % quantile: their margin is below 0
  double least_stability_margin = none;  ///< 1 − depth / 5 % quantile of the limit
  double peak_force_n = 0.0, peak_deflection_m = 0.0;
  double revolution_torque_n_m = 0.0;      ///< largest mean over a revolution
  double sustained_power_w = 0.0;          ///< largest mean over the time that counts for the spindle's curve
  double worst_surface_error_m = none;     ///< its magnitude
  double peak_vibration_m = none;          ///< largest amplitude of the tip about its mean
  double greatest_torque_share = 0.0;      ///< of a joint's drive; 0: not known, or no limit is given
  std::size_t reversals = 0;               ///< blocks in which the load of a joint turns round while it cuts
  std::vector<Violation> violations = {};  ///< the worst of each limit
};

/// Lines that cut on end, at one spindle speed.
struct DecidedLines {
  std::size_t first_block = 0, last_block = 0;
  double spindle_speed_rad_per_s = 0.0;
  /// How the tool leans from where the program has it, about the centre of its ball: along the stretch's main feed and
  /// across it.
  double lead_rad = 0.0, tilt_rad = 0.0;
  double lowest_feed_m_per_s = 0.0, highest_feed_m_per_s = 0.0;
  double cutting_time_s = 0.0;
  decision::LimitUse limited_by = {};
  std::size_t limiting_block = 0;
};

/// A speed that was not taken.
struct RejectedAlternative {
  decision::RejectedSpeed speed = {};
  std::size_t block = 0;  ///< where it is stopped
};

/// Stability margin over the path and the turn of the flange about the tool's axis.
struct GammaMap {
  std::vector<std::size_t> block = {};  ///< length m
  std::vector<double> path_m = {};      ///< length m; way of the tip at the block's end
  std::vector<double> gamma_rad = {};   ///< length n; from where the program has it
  Eigen::MatrixXd margin;               ///< n x m; NaN: the robot cannot stand there
  std::vector<double> chosen_rad = {};  ///< length m
  double least_margin = 0.0;
};

/// What was decided, and what the program comes to so.
struct Decision {
  enum class Status {
    found,      ///< the decided program keeps every limit
    infeasible  ///< see `reason`; there is no program
  };
  Status status = Status::infeasible;
  std::string reason = {};
  Outcome as_programmed;
  std::optional<Outcome> decided = {};
  std::vector<DecidedLines> stretches = {};
  std::vector<RejectedAlternative> alternatives = {};
  std::optional<GammaMap> gamma_map = {};
  /// γ of the flange from where the program has it, at the program's start and at each block's end; empty: as it is.
  std::vector<double> gamma_offset_rad = {};
  std::optional<Compensation> compensation = {};      ///< of its path, where that was asked for and keeps every limit
  std::size_t speeds_changed = 0, feeds_changed = 0;  ///< changes of S and F along the program
  std::string collision = {};       ///< of the program as it is, where its way comes too near to something
  bool collisions_checked = false;  ///< from block end to block end, by the cell's [geometry]
  long long evaluations = 0;        ///< cuts looked at
  int exact_runs = 0;               ///< of the whole program, as it was chosen
  double seconds = 0.0;
  std::vector<std::string> notes = {};
  std::vector<Assumption> assumed = {};
};

/// A decision with its program as that was run through the material and judged; none where it is infeasible.
struct DecideResult : Decision {
  std::optional<ForcesResult> forces = {};
  std::optional<ProgramBlocks> blocks = {};
};

/// Chooses spindle speeds, feeds and γ of a program by decision::decide_program with one look a class of blocks, runs
/// the program so through the material and judges every block of it. Where a block then breaks a limit it is held
/// further from it and the choice made anew. Where the robot's run is known, a choice that keeps every limit is made
/// anew too, by what the robot makes of each line's feed, as long as that promises 1 % of the time; of all such choices
/// the one that takes the robot least time is taken, and the program as it is where it keeps every limit and takes
/// less. Four choices are run at most.
/// @throws InvalidInput if an option is out of range, forces lack cell, program or cuts, or what is free needs what is
/// not there; Interrupted
[[nodiscard]] ROBOMILL_API DecideResult decide(const DecideProblem& problem, Progress& progress = Progress::none());

/// "power 9.1 kW; at most 7.5 kW".
[[nodiscard]] ROBOMILL_API std::string limit_text(const decision::LimitUse& use);

}  // namespace robomill::process
