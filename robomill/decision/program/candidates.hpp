#pragma once
#include <cstddef>
#include <map>
#include <vector>

#include "robomill/decision/program_decision.hpp"

namespace robomill::decision {

/// A spindle speed that may be taken.
struct CandidateSpeed {
  double spindle_speed_rad_per_s = 0.0;
  std::vector<std::size_t> window = {};  ///< of CandidateSpeeds::speeds: where cuts must hold too, itself among them
  int step = -1;                         ///< on the fine grid; -1: it stands beside it
};

/// Speeds that are looked at, and those of them that may be taken. Neighbours share their windows.
class CandidateSpeeds {
 public:
  CandidateSpeeds(const std::vector<ProgramStretch>& stretches, const ProgramOptions& options);
  /// Fine steps about a candidate of the grid, as far as they are not there yet.
  void refine(std::size_t candidate);

  [[nodiscard]] double speed(std::size_t index) const { return speeds_[index]; }
  [[nodiscard]] const CandidateSpeed& operator[](std::size_t candidate) const { return candidates_[candidate]; }
  [[nodiscard]] std::size_t size() const { return candidates_.size(); }

 private:
  /// A window has 2 half + 1 speeds, each by `ratio` above the one before.
  struct Window {
    double ratio = 1.01;
    int half = 0;
  };
  void add_step(int step);
  void add_alone(double speed);
  [[nodiscard]] std::size_t grid_speed(int step);
  /// To a whole multiple of the step that speeds are given in.
  [[nodiscard]] double rounded(double speed) const;

  const ProgramOptions& options_;
  Window window_;
  std::vector<double> speeds_ = {};
  std::vector<CandidateSpeed> candidates_ = {};
  std::map<int, std::size_t> grid_ = {};  ///< speeds of the fine grid that are there
};

}  // namespace robomill::decision
