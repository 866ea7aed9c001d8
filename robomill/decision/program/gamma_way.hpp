#pragma once
#include <cstddef>
#include <functional>
#include <vector>

#include "robomill/decision/program_decision.hpp"

namespace robomill::decision {

/// γ along a stretch, by dynamic programming. Cuts are grouped so that γ may take one step of its grid in the time of a
/// group; it runs from where a group begins to where it ends, and the group's cuts must hold at both. Along a group
/// alone γ stays, for that is never slower: so it does along a stretch without the time for a step.
class GammaWay {
 public:
  /// A cut, of the stretch, with a γ at which it must hold.
  struct Place {
    std::size_t cut = 0, gamma = 0;
  };
  /// Time of a cut at γ; infinite where it does not hold.
  using TimeAt = std::function<double(std::size_t cut, std::size_t gamma)>;

  /// @param times_s  of the cuts, at least
  GammaWay(const std::vector<double>& times_s, const ProgramOptions& options);
  /// The way of the least time, of those that which turns least from where γ is programmed; false: there is none.
  bool solve(const TimeAt& time_at);

  [[nodiscard]] const std::vector<std::size_t>& gamma() const { return gamma_; }   ///< one more than groups
  [[nodiscard]] const std::vector<std::size_t>& groups() const { return group_; }  ///< of each cut
  [[nodiscard]] std::vector<Place> places() const;

 private:
  std::vector<std::size_t> group_ = {};
  std::vector<std::size_t> begin_ = {};  ///< first cut of each group, and the number of cuts
  std::vector<double> turn_s_ = {};      ///< what γ away from the programmed one costs, of each γ
  double step_s_ = 0.0;                  ///< what a step of γ costs
  std::vector<std::size_t> gamma_ = {};
};

}  // namespace robomill::decision
