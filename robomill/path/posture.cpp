#include "robomill/path/posture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "robomill/base/parallel.hpp"
#include "robomill/base/units.hpp"
#include "robomill/path/postures/axis_tilt.hpp"
#include "robomill/path/postures/posture_walk.hpp"

namespace robomill::path {
namespace {

constexpr int most_start_branches = 256;
/// The field of candidates narrows twice: looked at in so many places, so many are kept.
constexpr std::size_t first_places = 24, second_places = 400, second_candidates = 48;
constexpr WalkOptions roughly{.halvings = 6, .max_step = 0.5, .careful = false};
constexpr WalkOptions exactly{};
/// A margin that is worth no other configuration than home's; for some 6° of a wrist from its singularity.
constexpr double ample_margin = 0.05;
/// Nearer than this to where two ways meet a position is singular for who reads of it.
constexpr double near_angle = 5.0 * units::deg, near_length_m = 0.05;
/// Home itself is then between two ways.
constexpr double between_angle = 0.1 * units::deg, between_length_m = 1e-3;

struct Candidate {
  double gamma_rad = 0.0;
  robot::Position6 start = robot::Position6::Zero();
  Walk walk = {};
  Resemblance like = {};  ///< to home; of whom none is given, all alike
};

/// Whether a went better than b: to the end with the larger margin, or farther.
bool better(const Candidate& a, const Candidate& b) {
  if (found(a.walk) != found(b.walk)) return found(a.walk);
  return found(a.walk) ? a.walk.margin.least > b.walk.margin.least : a.walk.t > b.walk.t;
}

/// What comes before all nearness: shoulder, elbow and wrist, in this order, and then whole turns.
int rank(const Candidate& candidate) {
  constexpr int turns_at_most = 100;
  const Resemblance& like = candidate.like;
  const int other = (like.shoulder ? 0 : 4) + (like.elbow ? 0 : 2) + (like.wrist ? 0 : 1);
  return other * turns_at_most + std::min(like.turns, turns_at_most - 1);
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
  // As the start has the flange: the grid of gammas misses it.
  if (options.start) add_branches(kinematics, head, options, kinematics.forward(*options.start).gamma_rad, out);
  for (int k = 0; k < options.gammas; ++k) {
    // 0, then to both sides: of equals the first is taken.
    const int turn = k % 2 == 0 ? k / 2 : -(k + 1) / 2;
    add_branches(kinematics, head, options, 2.0 * std::numbers::pi * turn / options.gammas, out);
  }
  return out;
}

/// Walks all of them and puts the best first; a stable order, so that threads change nothing.
void walk_all(const robot::Kinematics& kinematics, const Head& head, const std::vector<double>& along,
              const WalkOptions& options, const std::optional<robot::Position6>& home, Progress& progress,
              std::vector<Candidate>& all) {
  parallel_for(all.size(), 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Candidate& one = all[i];
      one.walk = walk(kinematics, head, along, {one.gamma_rad}, one.start, options);
      if (home) one.like = resemblance(kinematics, *home, one.start, one.walk.low, one.walk.high);
      progress.advance();
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

/// Where no way goes through a singularity: the one that gets farthest, tilted beside it.
TiltedWay tilted_beside(const Head& head, const Candidate& farthest, const PostureOptions& options) {
  if (options.beside == nullptr || !(options.max_axis_tilt_rad > 0.0) || found(farthest.walk)) return {};
  const TiltedWay way{.posture = {.start = farthest.start, .gamma_rad = {farthest.gamma_rad}}, .walk = farthest.walk};
  return tilted_way(head, std::span(&way, 1), options);
}

/// Of a field in order of margin, half of what is kept is the first of it, half what resembles home most.
void narrow(std::vector<Candidate>& all) {
  if (all.size() <= second_candidates) return;
  std::stable_sort(all.begin() + second_candidates / 2, all.end(), [](const Candidate& a, const Candidate& b) {
    return found(a.walk) != found(b.walk) ? found(a.walk) : rank(a) < rank(b);
  });
  all.resize(second_candidates);
}

/// Walks candidates of one rank exactly, and puts the best first.
class ExactWalks {
 public:
  ExactWalks(const robot::Kinematics& kinematics, const Head& head, const std::vector<double>& along,
             const PostureOptions& options, Progress& progress)
      : kinematics_(kinematics), head_(head), along_(along), options_(options), progress_(progress) {}

  /// In order of what rough walks promise, until none can be better any more: those see no more than half of what is
  /// near. Leaves out those not walked.
  void put_best_first(std::vector<Candidate>& all) const {
    std::vector<Candidate> walked;
    walked.reserve(all.size());
    for (std::size_t begin = 0; begin < all.size(); begin += at_once) {
      const auto best = std::min_element(walked.begin(), walked.end(), better);
      if (best != walked.end() && found(best->walk) && !better(all[begin], *best)) break;
      const std::vector<Candidate> next = some(all, begin);
      walked.insert(walked.end(), next.begin(), next.end());
    }
    std::stable_sort(walked.begin(), walked.end(), better);
    all = std::move(walked);
  }

  /// The one nearest to home that has so much margin.
  /// @param best  has it
  [[nodiscard]] Candidate nearest(std::vector<Candidate> all, Candidate best, double margin) const {
    const auto enough = [&](const Candidate& one) { return found(one.walk) && one.walk.margin.least >= margin; };
    all.erase(std::remove_if(all.begin(), all.end(), [&](const Candidate& one) { return !enough(one); }), all.end());
    std::stable_sort(all.begin(), all.end(),
                     [](const Candidate& a, const Candidate& b) { return a.like.distance < b.like.distance; });
    for (std::size_t begin = 0; begin < all.size(); begin += at_once) {
      const std::vector<Candidate> next = some(all, begin);
      // Exactly walked they may have come down in rank or margin.
      for (const Candidate& one : next) {
        if (enough(one) && rank(one) <= rank(best) && one.like.distance < best.like.distance) best = one;
      }
      if (best.like.distance <= all[std::min(begin + at_once, all.size()) - 1].like.distance) break;
    }
    return best;
  }

 private:
  static constexpr std::size_t at_once = 8;

  std::vector<Candidate> some(const std::vector<Candidate>& all, std::size_t begin) const {
    std::vector<Candidate> out;
    out.assign(all.begin() + static_cast<std::ptrdiff_t>(begin),
               all.begin() + static_cast<std::ptrdiff_t>(std::min(begin + at_once, all.size())));
    walk_all(kinematics_, head_, along_, exactly, options_.home, progress_, out);
    return out;
  }

  const robot::Kinematics& kinematics_;
  const Head& head_;
  const std::vector<double>& along_;
  const PostureOptions& options_;
  Progress& progress_;
};

/// Puts the one to take first, or where none goes through, the one that gets farthest.
void choose_exactly(const ExactWalks& walks, const PostureOptions& options, std::vector<Candidate>& all) {
  std::stable_sort(all.begin(), all.end(), [](const Candidate& a, const Candidate& b) {
    return found(a.walk) && found(b.walk) && rank(a) != rank(b) ? rank(a) < rank(b) : better(a, b);
  });
  std::vector<std::vector<Candidate>> kinds;  // by rank, as they are roughly
  std::vector<Candidate> bests;
  double largest = 0.0;
  for (auto begin = all.begin(); begin != all.end();) {
    const auto end = std::find_if(begin, all.end(), [&](const Candidate& one) {
      return rank(one) != rank(*begin) || found(one.walk) != found(begin->walk);
    });
    std::vector<Candidate> walked(begin, end);
    kinds.push_back(walked);
    walks.put_best_first(walked);
    bests.push_back(walked.front());
    begin = end;
    if (!found(bests.back().walk)) continue;
    largest = std::max(largest, bests.back().walk.margin.least);
    if (largest >= ample_margin) break;
  }
  const double enough = largest >= ample_margin ? ample_margin : 0.5 * largest;
  for (std::size_t k = 0; k < bests.size(); ++k) {
    const double margin = bests[k].walk.margin.least;
    if (!found(bests[k].walk) || margin < enough) continue;
    Candidate chosen = bests[k];
    if (options.home) {
      chosen = walks.nearest(kinds[k], chosen, std::max(enough, (1.0 - options.margin_for_home) * margin));
    }
    all = {std::move(chosen)};
    return;
  }
  std::stable_sort(bests.begin(), bests.end(), better);
  // Of those that get as far, what the one that resembles home meets says most.
  const auto& farthest = bests.front();
  const auto most_alike = std::min_element(bests.begin(), bests.end(), [&](const Candidate& a, const Candidate& b) {
    const double block = std::ceil(farthest.walk.t);
    const bool a_far = std::ceil(a.walk.t) == block, b_far = std::ceil(b.walk.t) == block;
    return a_far != b_far ? a_far : rank(a) < rank(b);
  });
  all = {*most_alike};
}

std::string number(double value, const char* unit) {
  char text[48];
  std::snprintf(text, sizeof text, "%.4g %s", value, unit);
  return text;
}

std::string degrees(double angle_rad) {
  char text[48];
  std::snprintf(text, sizeof text, "%.2g°", angle_rad / units::deg);
  return text;
}

/// Where no way passes a singularity, joints jump or cannot follow: the error says which it is and how near.
InvalidInput named_singularity(const InvalidInput& error, const robot::Reach& reach,
                               const robot::Configuration& configuration) {
  const bool met = reach.status == robot::Reach::Status::jump || reach.status == robot::Reach::Status::singular;
  const std::string near = met ? singularity_text(configuration) : std::string();
  if (near.empty()) return error;
  InvalidInput::Parts parts = error.parts();
  if (reach.status == robot::Reach::Status::jump) parts.rule = "leads past a singularity";
  parts.rule += ": " + near;
  if (configuration.wrist_rad < near_angle)
    parts.hint = "Tilt the workpiece, or mount the tool across the flange's axis";
  return InvalidInput(std::move(parts));
}

}  // namespace

void PostureOptions::validate() const {
  if (gamma_rad) require_finite("gamma_rad", *gamma_rad, "rad");
  if (start && !start->allFinite()) throw InvalidInput("start", "must be finite");
  if (home && !home->allFinite()) throw InvalidInput("home", "must be finite");
  if (!(margin_for_home >= 0.0 && margin_for_home <= 1.0)) {
    throw InvalidInput("margin_for_home", margin_for_home, "", "must lie in [0, 1]");
  }
  if (gammas < 4) throw InvalidInput("gammas", gammas, "", "must be >= 4");
  require_positive("max_axis_step_rad", max_axis_step_rad, "rad");
  require_positive("max_tip_step_m", max_tip_step_m, "m");
  if (max_blocks < 1) throw InvalidInput("max_blocks", 0.0, "blocks", "must be >= 1");
  if (!(max_axis_tilt_rad >= 0.0 && max_axis_tilt_rad <= most_tilt_rad)) {
    throw InvalidInput("max_axis_tilt_rad", max_axis_tilt_rad, "rad", "must lie in [0, 0.1]");
  }
}

InvalidInput cannot_take(const robot::Reach& reach, const robot::Kinematics& kinematics, std::size_t block,
                         std::size_t line) {
  const char* unit = kinematics.turns_about_axis() ? "rad" : "m";
  const std::string joint = "joint " + std::to_string(reach.joint + 1);
  const std::string place = "block " + std::to_string(block + 1) + " (line " + std::to_string(line) + ")";
  const bool turning_helps =
      kinematics.turns_about_axis() && (reach.joint + 1 == kinematics.joints() || !turns_last_joint_alone(kinematics));
  InvalidInput::Parts parts{
      .field = line > 0 ? place : "the program's start",
      .hint = turning_helps ? "Move the workpiece, or turn the flange about the tool's axis" : "Move the workpiece"};
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

Resemblance resemblance(const robot::Kinematics& kinematics, const robot::Position6& home,
                        const robot::Position6& start, const robot::Position6& low, const robot::Position6& high) {
  Resemblance out;
  if (!kinematics.turns_about_axis()) return out;
  const robot::Configuration at_home = kinematics.configuration(home), here = kinematics.configuration(start);
  out.known = at_home.known && here.known;
  if (out.known) {
    out.shoulder = at_home.shoulder_m < between_length_m || at_home.shoulder_back == here.shoulder_back;
    out.elbow = at_home.elbow_rad < between_angle || at_home.elbow_down == here.elbow_down;
    out.wrist = at_home.wrist_rad < between_angle || at_home.wrist_flipped == here.wrist_flipped;
  }
  const robot::JointLimits& limits = kinematics.limits();
  for (int i = 0; i < kinematics.joints(); ++i) {
    const double half = 0.5 * limits.max_position(i) - 0.5 * limits.min_position(i);
    const double away = std::abs(0.5 * (low(i) + high(i)) - home(i));
    // Half a turn to one side is no farther than half a turn to the other.
    out.turns += static_cast<int>(std::max(0.0, std::ceil((away - std::numbers::pi - 1e-9) / units::revolution)));
    out.distance += std::pow((start(i) - home(i)) / std::min(half, units::revolution), 2);
  }
  out.distance = std::sqrt(out.distance);
  return out;
}

std::string singularity_text(const robot::Configuration& configuration) {
  if (!configuration.known) return {};
  if (configuration.wrist_rad < near_angle) {
    return "axes 4 and 6 stand " + degrees(configuration.wrist_rad) +
           (configuration.parallel_axes ? " from parallel" : " from one line");
  }
  if (configuration.elbow_rad < near_angle) {
    return "the arm stands " + degrees(configuration.elbow_rad) + " from stretched or folded";
  }
  if (configuration.shoulder_m < near_length_m) {
    const std::string away = number(configuration.shoulder_m / units::mm, "mm");
    return configuration.parallel_axes ? "axes 5 and 6 meet " + away + " from the plane through axis 1 along axis 2"
                                       : "the wrist's centre stands " + away + " from axis 1";
  }
  return {};
}

bool turns_last_joint_alone(const robot::Kinematics& kinematics) {
  if (!kinematics.turns_about_axis()) return false;
  const robot::JointLimits& limits = kinematics.limits();
  // Any position away from singularities shows it.
  robot::Position6 position = robot::Position6::Zero(), turned;
  for (int i = 0; i < kinematics.joints(); ++i) {
    position(i) = std::clamp(0.3 + 0.1 * i, limits.min_position(i), limits.max_position(i));
  }
  robot::ToolPose pose = kinematics.forward(position);
  pose.gamma_rad += 1e-3;
  if (kinematics.follow(pose, position, turned).status != robot::Reach::Status::found) return false;
  return (turned - position).head(kinematics.joints() - 1).cwiseAbs().maxCoeff() < 1e-9;
}

PostureChoice choose_posture(program::Source& source, const robot::Kinematics& kinematics,
                             const PostureOptions& options, Progress& progress) {
  options.validate();
  const Head head = read_head(source, options.max_blocks);
  if (head.line.empty()) throw InvalidInput("program", "must hold at least one block");
  PostureChoice out{.blocks = head.line.size(), .in_line = turns_last_joint_alone(kinematics), .whole = head.whole};
  const std::vector<double> along = stations(head, options);
  std::vector<Candidate> all = candidates(kinematics, head, options);
  const auto reject = [&](const robot::Reach& reach, std::size_t block) {
    return named_singularity(cannot_take(reach, kinematics, block, head.line[block]), reach,
                             kinematics.configuration(all.front().walk.last));
  };
  const auto roughly_walked = [&] {
    return walk(kinematics, head, along, out.posture.gamma_rad, out.posture.start, roughly);
  };
  const auto describe = [&](const Walk& whole) {
    out.at_margin = kinematics.configuration(out.margin.position);
    if (!options.home) return;
    out.resemblance = resemblance(kinematics, *options.home, out.posture.start, whole.low, whole.high);
    out.resemblance->asked = options.home_asked;
  };
  if (all.empty()) {
    const robot::Position6 near = options.start.value_or(robot::Position6::Zero());
    throw cannot_take(reach_of(kinematics, head.pose.front(), near, options), kinematics, 0, 0);
  }
  // Each is walked once, some twice more.
  progress.start("choosing the posture", all.size() + 2 * std::min(all.size(), second_candidates));
  walk_all(kinematics, head, thinned(along, first_places), roughly, options.home, progress, all);
  narrow(all);
  walk_all(kinematics, head, thinned(along, second_places), roughly, options.home, progress, all);
  const bool may_turn = !options.gamma_rad && kinematics.turns_about_axis();
  const bool want_turning = may_turn && options.free_gamma;
  if (!want_turning) {
    choose_exactly(ExactWalks(kinematics, head, along, options, progress), options, all);
    const Candidate& best = all.front();
    if (found(best.walk)) {
      out.posture = {.start = best.start, .gamma_rad = {best.gamma_rad}};
      out.margin = best.walk.margin;
      describe(roughly_walked());
      return out;
    }
  }
  const End end = end_of(kinematics, head, all.front(), options);
  if (!found(all.front().walk) && end.for_all) throw reject(end.reach, end.block);
  if (may_turn) out.posture = turning_posture(kinematics, head, along, options);
  if (!out.posture.gamma_rad.empty()) {
    out.margin = walk(kinematics, head, along, out.posture.gamma_rad, out.posture.start, exactly).margin;
    describe(roughly_walked());
  } else if (TiltedWay tilted = tilted_beside(head, all.front(), options); !tilted.posture.gamma_rad.empty()) {
    out.margin = tilted.walk.margin;
    out.posture = std::move(tilted.posture);
    describe(tilted.walk);
  } else {
    throw reject(end.reach, end.block);
  }
  return out;
}

}  // namespace robomill::path
