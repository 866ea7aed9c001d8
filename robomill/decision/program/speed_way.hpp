#pragma once
#include <cstddef>
#include <vector>

#include "robomill/decision/program/candidates.hpp"
#include "robomill/decision/program/stretch_row.hpp"

namespace robomill::decision {

/// The least time through stretches × speeds, each stretch made in its best way. What needs dynamics is looked at only
/// where the best by what is known goes through it.
class SpeedWay {
 public:
  SpeedWay(const std::vector<ProgramStretch>& stretches, const ProgramOptions& options, CandidateSpeeds& speeds,
           StretchCost& cost, Progress& progress);

  /// The candidate of each stretch; empty where some stretch has none. Where a speed of the grid nearly holds, finer
  /// steps about it are taken in.
  std::vector<std::size_t> find();

  [[nodiscard]] const StretchRow& row(std::size_t stretch) const { return rows_[stretch]; }

 private:
  std::vector<std::size_t> find_on_grid();
  /// Bounds of the candidates that are new.
  void extend();
  /// Looks at what has not been looked at, up to the first that does not hold; false: all of it had been.
  bool look_along(const std::vector<std::size_t>& way);
  void refine();
  [[nodiscard]] bool nearly_holds(std::size_t candidate) const;
  /// The least time by what is known; false: there is none.
  bool solve(std::vector<std::size_t>& way) const;
  void relax(std::size_t from, std::size_t to, std::vector<double>& total, std::vector<std::size_t>& before) const;

  [[nodiscard]] bool may_take(std::size_t stretch, std::size_t candidate) const;
  [[nodiscard]] double speed(std::size_t candidate) const { return speeds_[candidate].spindle_speed_rad_per_s; }
  [[nodiscard]] double ramp_s(std::size_t from, std::size_t to) const;
  [[nodiscard]] double cost_at(std::size_t stretch, std::size_t candidate) const;

  const std::vector<ProgramStretch>& stretches_;
  const ProgramOptions& options_;
  CandidateSpeeds& speeds_;
  StretchCost& cost_;
  Progress& progress_;
  bool one_speed_;
  std::vector<std::size_t> order_ = {};  ///< of the candidates, by speed
  std::vector<StretchRow> rows_ = {};
  std::vector<int> failures_ = {};         ///< of each stretch
  std::vector<std::size_t> look_at_ = {};  ///< stretches, those that often fail first
};

}  // namespace robomill::decision
