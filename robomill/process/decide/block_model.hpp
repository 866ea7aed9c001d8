#pragma once
#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "robomill/decision/program_decision.hpp"
#include "robomill/process/decide.hpp"
#include "robomill/process/decide/apply.hpp"
#include "robomill/process/decide/collisions.hpp"
#include "robomill/process/decide/lean_ways.hpp"
#include "robomill/process/decide/way_model.hpp"

namespace robomill::process {

/// A program as the search asks of it: as programmed and, where lead or tilt are free, with every lean that it can
/// have. Cuts and classes of one way stand behind those of the other.
class BlockModel final : public decision::ProgramModel {
 public:
  /// @param problem  outlives the model
  /// @throws InvalidInput as lean_ways; Interrupted
  BlockModel(const DecideProblem& problem, Progress& progress);

  [[nodiscard]] decision::FeedRange feeds(std::size_t cut, double spindle_speed_rad_per_s) const override;
  [[nodiscard]] decision::CutLook look(std::size_t look_class, double spindle_speed_rad_per_s,
                                       std::size_t gamma) const override;

  [[nodiscard]] const WayModel& as_programmed() const { return *ways_.front(); }
  /// As programmed.
  [[nodiscard]] const ProgramUnits& units() const { return ways_.front()->units(); }
  [[nodiscard]] const std::vector<decision::ProgramCut>& cuts() const { return cuts_; }
  [[nodiscard]] const std::vector<decision::ProgramStretch>& stretches() const { return stretches_; }
  [[nodiscard]] const decision::ProgramOptions& search() const { return search_; }
  [[nodiscard]] const std::array<double, 2>& chip_m() const { return setting_.chip_m; }
  /// Of the cell and the cutter; null: the cell has no [geometry].
  [[nodiscard]] const robot::CollisionChecker* checker() const { return checker_.get(); }
  /// Sentences on what was left out.
  [[nodiscard]] const std::vector<std::string>& notes() const { return notes_; }
  [[nodiscard]] long long evaluations() const;

  /// How the tool leans in each stretch of a choice.
  [[nodiscard]] std::vector<Lean> leans(const decision::ProgramDecision& choice) const;
  /// The program at a choice.
  [[nodiscard]] program::Program chosen_program(const decision::ProgramDecision& choice) const;
  /// γ at its start and at each block's end; empty where it is not free.
  [[nodiscard]] std::vector<double> chosen_gamma(const program::Program& program,
                                                 const decision::ProgramDecision& choice) const;
  /// The block that stands for a cut in messages: the first of its line that cuts.
  [[nodiscard]] std::size_t block_of(std::size_t cut) const;
  /// Whether a block is one of a line that cuts.
  [[nodiscard]] bool in_line(std::size_t block) const { return line_of_[block] != no_line; }
  /// … of which line.
  [[nodiscard]] std::size_t line_of(std::size_t block) const { return line_of_[block]; }
  /// The way of a block that cuts.
  [[nodiscard]] const WayModel& way_at(const decision::ProgramDecision& choice, std::size_t block) const;

  /// Keeps what the lines take as programmed.
  void learn_programmed(const RobotRun& run);
  /// What a line gains by its feed: what it takes as programmed and in a choice that was run. false: not known.
  bool learn_times(const RobotRun& run, const decision::ProgramDecision& choice);
  /// What a choice takes, by what is known of the lines.
  [[nodiscard]] double time_s(const decision::ProgramDecision& choice) const;
  /// Holds what broke a limit further from it, by its worst block; false: that is not possible.
  bool tighten(const decision::ProgramDecision& choice, const std::vector<Violation>& violations);
  /// Whether γ or the lean may differ from the program's.
  [[nodiscard]] bool posture_free() const { return setting_.posture_free; }
  /// The posture of a choice in which the robot cannot stand at a block, or not without a collision, is left out at the
  /// block's line. false: no line is there.
  bool forbid(const decision::ProgramDecision& choice, std::size_t block);

 private:
  static constexpr std::size_t no_line = static_cast<std::size_t>(-1);
  /// A class of a way, and the γ at which it must not stand.
  struct Look {
    std::size_t way = 0, look_class = 0;
    std::set<std::size_t> forbidden = {};
  };

  void add_way(std::unique_ptr<WayModel> way);
  void add_leans(Progress& progress);
  void set_search();
  [[nodiscard]] std::size_t lines() const { return units().lines.size(); }
  [[nodiscard]] std::size_t stretch_of(std::size_t line) const;
  [[nodiscard]] std::size_t way_of(const decision::ProgramDecision& choice, std::size_t line) const;
  /// The cut of a line in a choice.
  [[nodiscard]] std::size_t chosen_cut(const decision::ProgramDecision& choice, std::size_t line) const;
  /// What the robot takes for each line; 0: not known.
  [[nodiscard]] std::vector<double> line_times(const RobotRun& run) const;
  [[nodiscard]] bool forbid_at(const decision::ProgramDecision& choice, std::size_t line);

  const DecideProblem& problem_;
  WaySetting setting_;
  std::unique_ptr<robot::CollisionChecker> checker_ = {};
  std::vector<Eigen::Matrix3d> frames_ = {};          ///< of the stretches, where leans are free
  std::vector<LeanWay> leans_ = {};                   ///< of way k: leans_[k - 1]
  std::vector<std::unique_ptr<WayModel>> ways_ = {};  ///< the first as programmed
  std::vector<decision::ProgramCut> cuts_ = {};       ///< of way w and line k: w · lines + k
  std::vector<decision::ProgramStretch> stretches_ = {};
  std::vector<std::vector<std::size_t>> other_ways_ = {};  ///< of each stretch: the way of each of its `others`
  std::vector<Look> looks_ = {};
  std::vector<std::size_t> line_of_ = {};  ///< of each block; no_line: none cuts in it
  std::vector<double> programmed_s_ = {};  ///< what the robot takes for each line as programmed; 0: not known
  decision::ProgramOptions search_ = {};
  std::vector<std::string> notes_ = {};
};

}  // namespace robomill::process
