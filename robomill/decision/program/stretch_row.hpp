#pragma once
#include <cstddef>
#include <optional>
#include <vector>

#include "robomill/decision/program/stretch_cost.hpp"
#include "robomill/decision/program_decision.hpp"

namespace robomill::decision {

/// One stretch at each candidate speed, made in each of its ways: bounds until it has been looked at.
class StretchRow {
 public:
  StretchRow(const ProgramStretch& stretch, double other_gain) : stretch_(stretch), weight_(1.0 + other_gain) {}

  /// The next candidate's bounds.
  void add(const StretchCost& cost, std::size_t candidate);
  /// The next candidate, which may not be taken.
  void add_none() { nodes_.emplace_back(); }
  /// Looks at the best way of a candidate; false: it does not hold.
  bool look(StretchCost& cost, std::size_t candidate);

  [[nodiscard]] std::size_t size() const { return nodes_.size(); }
  /// Of the best way, weighted; a lower bound until the candidate is exact.
  [[nodiscard]] double time_s(std::size_t candidate) const;
  /// Whether the best way has been looked at, or there is none.
  [[nodiscard]] bool exact(std::size_t candidate) const;
  [[nodiscard]] std::size_t best_way(std::size_t candidate) const { return nodes_[candidate].best; }
  [[nodiscard]] const StretchAt& best(std::size_t candidate) const;
  /// The best way of those that have been looked at, where none holds that which comes nearest; none where nothing has
  /// been looked at and some way may hold.
  [[nodiscard]] std::optional<StretchTime> seen(std::size_t candidate) const;
  /// What the candidate takes at least, by what needs no dynamics.
  [[nodiscard]] StretchTime bound(std::size_t candidate) const;
  /// The stretch made so.
  [[nodiscard]] ProgramStretch made(std::size_t way) const;

 private:
  /// A way of the stretch at a candidate.
  struct Way {
    StretchAt at = {};
    StretchTime bound = {};  ///< by what needs no dynamics
    bool exact = false;
  };
  struct Node {
    std::vector<Way> ways = {};  ///< none: the candidate may not be taken
    std::size_t best = 0;
  };
  [[nodiscard]] double weighted_s(const Node& node, std::size_t way) const;
  /// By time, of those that do not hold by what they miss, of those alike the first; none where there is none.
  [[nodiscard]] std::optional<std::size_t> best_of(const Node& node, bool only_exact) const;

  ProgramStretch stretch_;
  double weight_;  ///< of the time of ways other than the program's
  std::vector<Node> nodes_ = {};
};

}  // namespace robomill::decision
