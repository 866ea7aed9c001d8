#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "robomill/base/units.hpp"
#include "robomill/cell/check/placement.hpp"
#include "robomill/cell/check/tool_places.hpp"

namespace robomill::cell {
namespace {

/// A shift by this much counts as one, a turn by that much too.
constexpr double unit_shift_m = 0.1, unit_turn_rad = 10.0 * units::deg;
/// How far a change may go, in these units.
constexpr double steps_of_change[] = {0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 12.0, 15.0, 18.0};
constexpr double least_margin = 0.02;  ///< of a pose that is proposed: not at the edge of what can be reached
constexpr std::size_t most_looks = 60, most_verified = 12;
constexpr int halvings = 4;

/// Which way the workpiece goes: along B's x, y and z, and about z.
using Change = Eigen::Vector4d;

/// Shifts along edges, faces and corners of a cube, turns, and turns with a shift over the table; of length 1.
std::vector<Change> directions_of_change() {
  std::vector<Change> out;
  const auto add = [&out](double x, double y, double z, double turn) {
    out.push_back(Change(x, y, z, turn).normalized());
  };
  for (const int z : {0, 1, -1}) {
    for (const int y : {0, 1, -1}) {
      for (const int x : {0, -1, 1}) {
        if (x != 0 || y != 0 || z != 0) add(x, y, z, 0.0);
      }
    }
  }
  for (const double turn : {1.0, -1.0}) {
    add(0.0, 0.0, 0.0, turn);
    for (const int y : {0, 1, -1}) {
      for (const int x : {-1, 0, 1}) {
        if (x != 0 || y != 0) add(x, y, 0.0, turn);
      }
    }
  }
  return out;
}

/// Of a number the nearest multiple of a step.
double rounded(double value, double step) {
  return step * std::round(value / step);
}

class ProposalSearch {
 public:
  ProposalSearch(const Cell& cell, const Placement& failed, const Targets& targets)
      : cell_(cell), failed_(failed), targets_(targets) {
    Eigen::Vector3d low = Eigen::Vector3d::Constant(HUGE_VAL), high = -low;
    for (const program::Pose& pose : targets.head.pose) {
      low = low.cwiseMin(pose.tip_m);
      high = high.cwiseMax(pose.tip_m);
    }
    middle_m_ = failed.workpiece * Eigen::Vector3d(0.5 * (low + high));
    looks_ = poses_to_look_at(failed, targets.head.pose.size());
  }

  /// The workpiece's pose after a change, in whole steps of 5 mm and 1°.
  [[nodiscard]] Proposal changed(const Change& direction, double size) const {
    Proposal out;
    for (int i = 0; i < 3; ++i) out.shift_m(i) = rounded(size * unit_shift_m * direction(i), 5.0 * units::mm);
    out.turn_rad = rounded(size * unit_turn_rad * direction(3), units::deg);
    out.placement.workpiece = Eigen::Translation3d(middle_m_ + out.shift_m) *
                              Eigen::AngleAxisd(out.turn_rad, Eigen::Vector3d::UnitZ()) *
                              Eigen::Translation3d(-middle_m_) * failed_.workpiece;
    return out;
  }

  /// Whether the places looked at can be taken, and not just so.
  [[nodiscard]] bool looks_well(const Proposal& proposal) const {
    const ToolPlaces places(cell_, proposal.placement.workpiece);
    ToolPlaces::Stand stand{.position = position_of(cell_.home), .gamma_rad = cell_.redundant_gamma_rad};
    for (const std::size_t i : looks_) {
      const std::optional<ToolPlaces::Stand> next = places.find_quickly(targets_.head.pose[i], stand);
      if (!next) return false;
      stand = *next;
      if (stand.margin >= least_margin) continue;
      const std::optional<ToolPlaces::Stand> better = places.find(targets_.head.pose[i]).stand;
      if (!better || better->margin < least_margin) return false;
      stand = *better;
    }
    return true;
  }

  /// Whether a turn with a shift does what the shift alone does not.
  [[nodiscard]] bool needs_its_turn(const Change& direction, double size) const {
    const Change shift(direction.x(), direction.y(), direction.z(), 0.0);
    return direction(3) == 0.0 || shift.isZero() || !looks_well(changed(shift, size));
  }

  /// The smallest change in a direction that looks well, between one that does not and one that does.
  [[nodiscard]] double least_size(const Change& direction, double bad, double good) const {
    for (int i = 0; i < halvings; ++i) {
      const double between = 0.5 * (bad + good);
      (looks_well(changed(direction, between)) ? good : bad) = between;
    }
    return good;
  }

 private:
  const Cell& cell_;
  const Placement& failed_;
  const Targets& targets_;
  Eigen::Vector3d middle_m_;
  std::vector<std::size_t> looks_;
};

}  // namespace

std::vector<std::size_t> poses_to_look_at(const Placement& failed, std::size_t poses) {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < std::min<std::size_t>(failed.misses.size(), most_looks / 3); ++i) {
    out.push_back(failed.misses[i].block);
  }
  const std::size_t step = std::max<std::size_t>(1, (poses + most_looks - 1) / most_looks);
  for (std::size_t i = 0; i < poses; i += step) out.push_back(i);
  return out;
}

std::vector<Proposal> propose(const Cell& cell, const Placement& failed, const Targets& targets, std::size_t most,
                              Progress& progress) {
  std::vector<Proposal> out;
  if (most == 0) return out;
  struct Candidate {
    Change direction;
    double size;
  };
  const std::vector<Change> directions = directions_of_change();
  const ProposalSearch search(cell, failed, targets);
  std::vector<Change> taken;
  const auto is_new = [&](const Change& direction) {
    return std::ranges::all_of(taken, [&](const Change& other) { return direction.dot(other) < 0.75; });
  };
  std::size_t verified = 0;
  double before = 0.0;
  progress.start("workpiece poses", std::size(steps_of_change) * directions.size());
  for (const double size : steps_of_change) {
    std::vector<Candidate> candidates;
    for (const Change& direction : directions) {
      progress.advance();
      if (!is_new(direction) || !search.looks_well(search.changed(direction, size))) continue;
      const double least = search.least_size(direction, before, size);
      if (search.needs_its_turn(direction, least)) candidates.push_back({direction, least});
    }
    std::ranges::stable_sort(candidates, {}, &Candidate::size);
    for (const Candidate& candidate : candidates) {
      if (!is_new(candidate.direction) || verified == most_verified) continue;
      ++verified;
      Proposal proposal = search.changed(candidate.direction, candidate.size);
      proposal.placement = judge(cell, proposal.placement.workpiece, targets, progress);
      if (!proposal.placement.works()) continue;
      taken.push_back(candidate.direction);
      out.push_back(std::move(proposal));
      if (out.size() == most) return out;
    }
    if (verified == most_verified) break;
    before = size;
  }
  return out;
}

}  // namespace robomill::cell
