#include "robomill/process/decide/collisions.hpp"

#include "robomill/base/parallel.hpp"
#include "robomill/cell/clearance.hpp"

namespace robomill::process {

std::unique_ptr<robot::CollisionChecker> collision_checker(const cell::Cell& cell, const cutting::Cutter& cutter) {
  std::vector<Assumption> unused;
  return cell::clearance_checker(cell, &cutter, unused);
}

std::vector<NearMiss> near_misses(const robot::CollisionChecker* checker, const cell::Cell& cell,
                                  const Stands& stands) {
  if (checker == nullptr) return {};
  const double step_m = cell::look_step_m(*cell.geometry);
  std::vector<robot::Clearance> clearance(stands.joints.size());
  parallel_for(clearance.size(), 8, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const robot::Position6 from = i == 0 ? stands.start.value_or(stands.joints[0]) : stands.joints[i - 1];
      clearance[i] = checker->check_move(from, stands.joints[i], step_m).clearance;
    }
  });
  std::vector<NearMiss> out;
  for (std::size_t i = 0; i < clearance.size(); ++i) {
    if (clearance[i].status != robot::Clearance::Status::clear) out.push_back({.block = i, .clearance = clearance[i]});
  }
  return out;
}

}  // namespace robomill::process
