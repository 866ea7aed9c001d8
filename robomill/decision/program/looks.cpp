#include "robomill/decision/program/looks.hpp"

#include <algorithm>
#include <cmath>

#include "robomill/base/parallel.hpp"

namespace robomill::decision {
namespace {

/// Looked at before anyone asks whether one of them has failed: the same at any number of threads.
constexpr std::size_t at_a_time = 8;

bool at_least(ProgramLimit limit) {
  return limit == ProgramLimit::stability || limit == ProgramLimit::least_chip;
}

/// Which of two looks that hold limits a cut more. Limits of several kinds are compared by their shares.
bool limits_more(const CutLook& one, const CutLook& other) {
  if (one.most_feed_per_tooth_m != other.most_feed_per_tooth_m) {
    return one.most_feed_per_tooth_m < other.most_feed_per_tooth_m;
  }
  if (one.by.limit == ProgramLimit::none) return false;
  return other.by.limit == ProgramLimit::none || shortfall(one.by) > shortfall(other.by);
}

}  // namespace

double shortfall(const LimitUse& use) {
  if (use.limit == ProgramLimit::none) return 0.0;
  const double scale = std::max(std::abs(use.allowed), 1e-12);
  // These bound from both sides, and are named where they are broken alone.
  const bool both_sides = use.limit == ProgramLimit::cutting_speed || use.limit == ProgramLimit::spindle_range;
  const double above = use.value - use.allowed;
  const double beyond = both_sides ? std::abs(above) : at_least(use.limit) ? -above : above;
  return std::isfinite(beyond) ? beyond / scale : HUGE_VAL;
}

std::optional<CutLook> Looks::known(const LookAt& at, std::size_t candidate) const {
  std::optional<CutLook> out;
  bool whole = true;
  double least_m = 0.0;
  LimitUse least_by;
  for (const std::size_t speed : speeds_[candidate].window) {
    const auto found = memo_.find(key(at, speed));
    if (found == memo_.end()) {
      whole = false;
      continue;
    }
    const CutLook& look = found->second;
    if (!look.holds) return look;
    if (look.least_feed_per_tooth_m > least_m) {
      least_m = look.least_feed_per_tooth_m;
      least_by = look.least_by;
    }
    if (!out || limits_more(look, *out)) out = look;
  }
  if (out) {
    out->least_feed_per_tooth_m = least_m;
    out->least_by = least_by;
  }
  return whole ? out : std::nullopt;
}

void Looks::run(const std::vector<Task>& tasks) {
  std::vector<CutLook> found(tasks.size());
  parallel_for(tasks.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      progress_.check();
      found[i] = model_.look(tasks[i].at.look_class, speeds_.speed(tasks[i].speed), tasks[i].at.gamma);
    }
  });
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    memo_.emplace(key(tasks[i].at, tasks[i].speed), found[i]);
    if (!found[i].holds) ++failures_[tasks[i].at.look_class];
  }
}

void Looks::ask(const std::vector<LookAt>& at, std::size_t candidate) {
  std::vector<Task> tasks;
  for (const LookAt& one : at) {
    for (const std::size_t speed : speeds_[candidate].window) {
      if (!memo_.contains(key(one, speed))) tasks.push_back({.at = one, .speed = speed});
    }
  }
  run(tasks);
}

std::optional<LookAt> Looks::ask_until_failure(std::vector<LookAt> at, std::size_t candidate) {
  const auto fails = [&](const LookAt& one) {
    const std::optional<CutLook> look = known(one, candidate);
    return look && !look->holds;
  };
  const auto failed = std::ranges::find_if(at, fails);
  if (failed != at.end()) return *failed;
  const auto failures = [&](const LookAt& one) {
    const auto found = failures_.find(one.look_class);
    return found == failures_.end() ? 0 : found->second;
  };
  std::ranges::stable_sort(at, std::ranges::greater{}, failures);
  std::vector<Task> tasks;
  for (std::size_t i = 0; i < at.size(); ++i) {
    for (const std::size_t speed : speeds_[candidate].window) {
      if (!memo_.contains(key(at[i], speed))) tasks.push_back({.at = at[i], .speed = speed});
    }
    if (tasks.size() < at_a_time && i + 1 < at.size()) continue;
    run(tasks);
    for (const Task& task : tasks) {
      if (fails(task.at)) return task.at;
    }
    tasks.clear();
  }
  return std::nullopt;
}

}  // namespace robomill::decision
