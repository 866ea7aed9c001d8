#pragma once
#include <cstddef>
#include <limits>
#include <vector>

#include "robomill/decision/program/looks.hpp"
#include "robomill/decision/program_decision.hpp"

namespace robomill::decision {

inline constexpr double no_time = std::numeric_limits<double>::infinity();

/// Time of a stretch at a speed, or what stops it.
struct StretchTime {
  double time_s = no_time;       ///< of ProgramCut::time_s; infinite: a limit stops it
  LimitUse stopped_by = {};      ///< … this one
  double missed = 0.0;           ///< … by this share of it, > 0
  std::size_t cut = 0;           ///< … here
  double feed_time_s = no_time;  ///< as time_s, at the feeds
};

/// One stretch at one speed.
struct StretchAt {
  StretchTime time = {};
  std::vector<double> least = {};  ///< feed of each of its cuts [m/s], at least
  std::vector<double> most = {};   ///< … at most
  std::vector<LimitUse> most_by = {};
  std::vector<std::size_t> gamma = {};  ///< where each group of its cuts begins, and where the last ends
  std::vector<std::size_t> group = {};  ///< of each of its cuts
};

/// Finds the least time of a stretch at a candidate speed. Of a stretch it takes the cuts [begin, end) alone.
class StretchCost {
 public:
  StretchCost(const std::vector<ProgramCut>& cuts, const ProgramModel& model, const ProgramOptions& options,
              const CandidateSpeeds& speeds, Looks& looks)
      : cuts_(cuts), model_(model), options_(options), speeds_(speeds), looks_(looks) {}

  /// What needs no dynamics: a lower bound.
  [[nodiscard]] StretchTime bound(const ProgramStretch& stretch, std::size_t candidate) const;
  [[nodiscard]] StretchAt exact(const ProgramStretch& stretch, std::size_t candidate);

 private:
  [[nodiscard]] StretchAt by_feeds(const ProgramStretch& stretch, std::size_t candidate) const;
  void at_programmed_gamma(const ProgramStretch& stretch, std::size_t candidate, StretchAt& out);
  void along_gamma(const ProgramStretch& stretch, std::size_t candidate, StretchAt& out);
  /// What stops a stretch along which there is no way of γ.
  void stop_along_gamma(const ProgramStretch& stretch, std::size_t candidate, StretchAt& out) const;
  /// The feed of a cut for each feed per tooth of what cuts [m/s per m].
  [[nodiscard]] double feed_of_a_tooth(std::size_t cut, std::size_t candidate) const;
  /// Feeds of a cut: those that it has and a look allows.
  struct Feeds {
    double least_m_per_s = 0.0, most_m_per_s = 0.0;
    LimitUse by = {};  ///< what narrowed them last
    [[nodiscard]] bool empty() const { return most_m_per_s < least_m_per_s; }
  };
  [[nodiscard]] Feeds narrowed(const Feeds& feeds, std::size_t cut, const CutLook& look, std::size_t candidate) const;
  /// What keeps a cut from γ, as far as it is known.
  [[nodiscard]] StretchTime at_gamma(std::size_t cut, std::size_t gamma, const Feeds& feeds,
                                     std::size_t candidate) const;
  void limit_feed(const ProgramStretch& stretch, std::size_t cut, const CutLook& look, std::size_t candidate,
                  StretchAt& out) const;
  /// The times of a stretch that nothing stops.
  void sum_up(const ProgramStretch& stretch, StretchAt& out) const;

  const std::vector<ProgramCut>& cuts_;
  const ProgramModel& model_;
  const ProgramOptions& options_;
  const CandidateSpeeds& speeds_;
  Looks& looks_;
};

}  // namespace robomill::decision
