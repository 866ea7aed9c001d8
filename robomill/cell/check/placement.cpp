#include "robomill/cell/check/placement.hpp"

#include <optional>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/cell/check/tool_places.hpp"
#include "robomill/cell/posture_choice.hpp"
#include "robomill/path/postures/posture_walk.hpp"

namespace robomill::cell {
namespace {

constexpr std::size_t most_misses = 100;

/// Each pose for itself, the next one from where the last one stands.
void look_at_poses(const ToolPlaces& places, const path::Head& head, Placement& out, Progress& progress) {
  std::optional<ToolPlaces::Stand> before;
  for (std::size_t i = 0; i < head.pose.size(); ++i) {
    progress.check();
    out.complete = out.misses.size() < most_misses;
    if (!out.complete) return;
    ++out.poses;
    const program::Pose& pose = head.pose[i];
    if (before) {
      if (const auto next = places.follow(pose, *before)) {
        before = next;
        continue;
      }
    }
    ToolPlaces::Found found = places.find(pose);
    if (i == 0 && found.stand) {
      out.choice.posture = {.start = found.stand->position, .gamma_rad = {found.stand->gamma_rad}};
      const path::LimitShare limit = path::limit_share(places.machine(), found.stand->position);
      const double margin = found.stand->margin;
      out.choice.margin = {.least = margin, .joint = limit.share <= margin ? limit.joint : -1};
    }
    before = found.stand;
    if (found.stand) continue;
    found.miss.block = i;
    found.miss.line = i > 0 ? head.line[i - 1] : 0;
    out.misses.push_back(std::move(found.miss));
  }
}

}  // namespace

Placement judge(const Cell& cell, const Eigen::Isometry3d& workpiece, const Targets& targets, Progress& progress) {
  Placement out{.workpiece = workpiece};
  const ToolPlaces places(cell, workpiece);
  look_at_poses(places, targets.head, out, progress);
  if (!out.misses.empty() || targets.source == nullptr || targets.head.line.empty()) return out;
  try {
    out.choice = path::choose_posture(*targets.source, places.machine(), posture_options(cell, places.machine()));
  } catch (const InvalidInput& error) {
    if (!error.parts().where.empty()) throw;  // of the program's file, not of where it stands
    out.no_way = error.parts().field + " " + error.parts().rule;
  }
  return out;
}

}  // namespace robomill::cell
