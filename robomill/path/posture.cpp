#include "robomill/path/posture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "robomill/base/parallel.hpp"
#include "robomill/path/postures/posture_walk.hpp"

namespace robomill::path {
namespace {

constexpr int most_start_branches = 256;
/// The field of candidates narrows twice: looked at in so many places, so many are kept.
constexpr std::size_t first_places = 24, second_places = 400, second_candidates = 48;
constexpr WalkOptions roughly{.halvings = 6, .max_step = 0.5, .careful = false};
constexpr WalkOptions exactly{};

struct Candidate {
  double gamma_rad = 0.0;
  robot::Position6 start = robot::Position6::Zero();
  Walk walk = {};
};

bool found(const Walk& walk) {
  return walk.reach.status == robot::Reach::Status::found;
}

/// Whether a went better than b: to the end with the larger margin, or farther.
bool better(const Candidate& a, const Candidate& b) {
  if (found(a.walk) != found(b.walk)) return found(a.walk);
  return found(a.walk) ? a.walk.margin.least > b.walk.margin.least : a.walk.t > b.walk.t;
}

/// All branches of the first pose with one gamma; where a start is wanted, the one that is nearest to it.
void add_branches(const robot::Kinematics& kinematics, const Head& head, const PostureOptions& options,
                  double gamma_rad, std::vector<Candidate>& out) {
  const program::Pose& first = head.pose.front();
  std::array<robot::Position6, most_start_branches> branches;
  int count = kinematics.all({.tip_m = first.tip_m, .axis = first.axis, .gamma_rad = gamma_rad}, branches.data(),
                             most_start_branches);
  if (options.start && count > 0) {
    const auto far = [&](const robot::Position6& branch) { return (branch - *options.start).squaredNorm(); };
    branches.front() = *std::min_element(branches.begin(), branches.begin() + count,
                                         [&](const auto& a, const auto& b) { return far(a) < far(b); });
    count = 1;
  }
  for (int k = 0; k < count; ++k) {
    out.push_back({.gamma_rad = gamma_rad, .start = branches[static_cast<std::size_t>(k)]});
  }
}

std::vector<Candidate> candidates(const robot::Kinematics& kinematics, const Head& head,
                                  const PostureOptions& options) {
  std::vector<Candidate> out;
  if (options.gamma_rad || !kinematics.turns_about_axis()) {
    add_branches(kinematics, head, options, options.gamma_rad.value_or(0.0), out);
    return out;
  }
  for (int k = 0; k < options.gammas; ++k) {
    // 0, then to both sides: of equals the first is taken.
    const int turn = k % 2 == 0 ? k / 2 : -(k + 1) / 2;
    add_branches(kinematics, head, options, 2.0 * std::numbers::pi * turn / options.gammas, out);
  }
  return out;
}

/// Walks all of them and puts the best first; a stable order, so that threads change nothing.
void walk_all(const robot::Kinematics& kinematics, const Head& head, const std::vector<double>& along,
              const WalkOptions& options, std::vector<Candidate>& all) {
  parallel_for(all.size(), 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      all[i].walk = walk(kinematics, head, along, {all[i].gamma_rad}, all[i].start, options);
    }
  });
  std::stable_sort(all.begin(), all.end(), better);
}

/// Whether any gamma takes a pose, and if none, why: that of the one that misses by least.
robot::Reach reach_of(const robot::Kinematics& kinematics, const program::Pose& pose, const robot::Position6& near,
                      const PostureOptions& options) {
  robot::Reach out;
  const bool one = options.gamma_rad || !kinematics.turns_about_axis();
  for (int k = 0; k < (one ? 1 : options.gammas); ++k) {
    const double gamma_rad = options.gamma_rad.value_or(2.0 * std::numbers::pi * k / options.gammas);
    robot::Position6 position;
    const robot::Reach reach = kinematics.follow(
        robot::ToolPose{.tip_m = pose.tip_m, .axis = pose.axis, .gamma_rad = gamma_rad}, near, position);
    const bool within = reach.status != robot::Reach::Status::out_of_reach;
    const bool best_within = out.status != robot::Reach::Status::out_of_reach;
    if (within && reach.status != robot::Reach::Status::outside_limits) return {.status = robot::Reach::Status::found};
    if (k == 0 || (within && !best_within) || (within == best_within && reach.beyond < out.beyond)) out = reach;
  }
  return out;
}

std::size_t block_at(const Head& head, double t) {
  const double block = t > 0.0 ? std::ceil(t) - 1.0 : 0.0;
  return std::min(static_cast<std::size_t>(block), head.line.size() - 1);
}

/// Why a walk ended. On the way to where the machine cannot reach it is stretched, and singular, first: then what is
/// missing at the block's end says more.
struct End {
  robot::Reach reach = {};
  std::size_t block = 0;
  bool for_all = false;  ///< no gamma takes the block's end
};
End end_of(const robot::Kinematics& kinematics, const Head& head, const Candidate& farthest,
           const PostureOptions& options) {
  End out{.reach = farthest.walk.reach, .block = block_at(head, farthest.walk.t)};
  const robot::Reach there = reach_of(kinematics, head.pose[out.block + 1], farthest.start, options);
  out.for_all = there.status != robot::Reach::Status::found;
  if (out.for_all) out.reach = there;
  return out;
}

/// Walks candidates exactly, in order of what rough walks promise, until none can be better any more: those see no more
/// than half of what is near. The best is left in front.
void walk_exactly(const robot::Kinematics& kinematics, const Head& head, const std::vector<double>& along,
                  std::vector<Candidate>& all) {
  constexpr std::size_t at_once = 8;
  std::vector<Candidate> walked;
  walked.reserve(all.size());
  for (std::size_t begin = 0; begin < all.size(); begin += at_once) {
    const auto best = std::min_element(walked.begin(), walked.end(), better);
    if (best != walked.end() && found(best->walk) && !better(all[begin], *best)) break;
    std::vector<Candidate> next;
    next.assign(all.begin() + static_cast<std::ptrdiff_t>(begin),
                all.begin() + static_cast<std::ptrdiff_t>(std::min(begin + at_once, all.size())));
    walk_all(kinematics, head, along, exactly, next);
    walked.insert(walked.end(), next.begin(), next.end());
  }
  std::stable_sort(walked.begin(), walked.end(), better);
  all = std::move(walked);
}

std::string number(double value, const char* unit) {
  char text[48];
  std::snprintf(text, sizeof text, "%.4g %s", value, unit);
  return text;
}

}  // namespace

void PostureOptions::validate() const {
  if (gamma_rad) require_finite("gamma_rad", *gamma_rad, "rad");
  if (start && !start->allFinite()) throw InvalidInput("start", "must be finite");
  if (gammas < 4) throw InvalidInput("gammas", gammas, "", "must be >= 4");
  require_positive("max_axis_step_rad", max_axis_step_rad, "rad");
  require_positive("max_tip_step_m", max_tip_step_m, "m");
  if (max_blocks < 1) throw InvalidInput("max_blocks", 0.0, "blocks", "must be >= 1");
}

InvalidInput cannot_take(const robot::Reach& reach, const robot::Kinematics& kinematics, std::size_t block,
                         std::size_t line) {
  const char* unit = kinematics.turns_about_axis() ? "rad" : "m";
  const std::string joint = "joint " + std::to_string(reach.joint + 1);
  const std::string place = "block " + std::to_string(block + 1) + " (line " + std::to_string(line) + ")";
  InvalidInput::Parts parts{.field = line > 0 ? place : "the program's start",
                            .hint = kinematics.turns_about_axis()
                                        ? "Move the workpiece, or turn the flange about the tool's axis"
                                        : "Move the workpiece"};
  switch (reach.status) {
    case robot::Reach::Status::out_of_reach:
      parts.rule = "is out of the machine's reach";
      if (reach.beyond > 0.0) parts.rule += " by " + number(reach.beyond, "m");
      break;
    case robot::Reach::Status::outside_limits:
      parts.rule = "takes " + joint + " " + number(reach.beyond, unit) + " beyond its limit";
      break;
    case robot::Reach::Status::singular:
      parts.rule = line > 0 ? "leads through a singularity" : "stands in a singularity";
      if (reach.joint >= 0) parts.rule += ", where " + joint + " cannot follow";
      break;
    case robot::Reach::Status::jump:
      parts.rule = "makes " + joint + " jump by " + number(reach.beyond, unit);
      break;
    case robot::Reach::Status::found:
      parts.rule = "can be taken";
      break;
  }
  return InvalidInput(std::move(parts));
}

PostureChoice choose_posture(program::Source& source, const robot::Kinematics& kinematics,
                             const PostureOptions& options) {
  options.validate();
  const Head head = read_head(source, options.max_blocks);
  if (head.line.empty()) throw InvalidInput("program", "must hold at least one block");
  PostureChoice out{.blocks = head.line.size(), .whole = head.whole};
  const std::vector<double> along = stations(head, options);
  std::vector<Candidate> all = candidates(kinematics, head, options);
  const auto reject = [&](const robot::Reach& reach, std::size_t block) {
    return cannot_take(reach, kinematics, block, head.line[block]);
  };
  if (all.empty()) {
    const robot::Position6 near = options.start.value_or(robot::Position6::Zero());
    throw cannot_take(reach_of(kinematics, head.pose.front(), near, options), kinematics, 0, 0);
  }
  walk_all(kinematics, head, thinned(along, first_places), roughly, all);
  if (all.size() > second_candidates) all.resize(second_candidates);
  walk_all(kinematics, head, thinned(along, second_places), roughly, all);
  const bool may_turn = !options.gamma_rad && kinematics.turns_about_axis();
  const bool want_turning = may_turn && options.free_gamma;
  if (!want_turning) {
    walk_exactly(kinematics, head, along, all);
    const Candidate& best = all.front();
    if (found(best.walk)) {
      out.posture = {.start = best.start, .gamma_rad = {best.gamma_rad}};
      out.margin = best.walk.margin;
      return out;
    }
  }
  const End end = end_of(kinematics, head, all.front(), options);
  if (!may_turn || (!found(all.front().walk) && end.for_all)) throw reject(end.reach, end.block);
  Posture turning = turning_posture(kinematics, head, along, options);
  if (turning.gamma_rad.empty()) throw reject(end.reach, end.block);
  out.margin = walk(kinematics, head, along, turning.gamma_rad, turning.start, exactly).margin;
  out.posture = std::move(turning);
  return out;
}

}  // namespace robomill::path
