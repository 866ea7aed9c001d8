#pragma once
#include <compare>
#include <cstddef>
#include <optional>
#include <unordered_map>
#include <vector>

#include "robomill/decision/program/candidates.hpp"
#include "robomill/decision/program_decision.hpp"

namespace robomill::decision {

/// By how much a limit is missed, as a share of it; <= 0: it is kept.
[[nodiscard]] double shortfall(const LimitUse& use);

/// A class of cuts with γ.
struct LookAt {
  std::size_t look_class = 0, gamma = 0;
  friend auto operator<=>(const LookAt&, const LookAt&) = default;
};

/// What a model says, asked once.
class Looks {
 public:
  Looks(const ProgramModel& model, const CandidateSpeeds& speeds, std::size_t classes, std::size_t gammas,
        Progress& progress)
      : model_(model), speeds_(speeds), classes_(classes), gammas_(gammas), progress_(progress) {}

  /// Over the window of a candidate: the first that does not hold, else that which allows the least feed, of those
  /// alike that which is nearest to its limit, with the highest of what they ask at least; none where some of it has
  /// not been looked at and what was holds.
  [[nodiscard]] std::optional<CutLook> known(const LookAt& at, std::size_t candidate) const;
  /// Looks at all of them over the candidate's window.
  void ask(const std::vector<LookAt>& at, std::size_t candidate);
  /// The same until one does not hold: that one. Those that often do not are looked at first.
  std::optional<LookAt> ask_until_failure(std::vector<LookAt> at, std::size_t candidate);
  [[nodiscard]] long long count() const { return static_cast<long long>(memo_.size()); }

 private:
  struct Task {
    LookAt at;
    std::size_t speed = 0;
  };
  [[nodiscard]] std::size_t key(const LookAt& at, std::size_t speed) const {
    return (speed * gammas_ + at.gamma) * classes_ + at.look_class;
  }
  void run(const std::vector<Task>& tasks);

  const ProgramModel& model_;
  const CandidateSpeeds& speeds_;
  std::size_t classes_, gammas_;
  Progress& progress_;
  std::unordered_map<std::size_t, CutLook> memo_ = {};
  std::unordered_map<std::size_t, int> failures_ = {};  ///< of a class
};

}  // namespace robomill::decision
