#include "robomill/path/files/path_clearance.hpp"

#include <fmt/format.h>

#include "robomill/base/units.hpp"

namespace robomill::path {
namespace {

std::string nearest_text(const PathClearance& path) {
  const robot::Clearance& at = path.clearance;
  using Status = robot::Clearance::Status;
  switch (at.status) {
    case Status::collision:
      return fmt::format("{} collides with {}", at.first, at.second);
    case Status::gouge:
      return fmt::format("{} gouges {} by {:.3g} mm", at.first, at.second, at.depth_m / units::mm);
    case Status::too_near:
      return fmt::format("{} and {} come within {:.3g} mm, at least {:.6g} mm is asked for", at.first, at.second,
                         at.distance_m / units::mm, path.required_m / units::mm);
    case Status::clear:
      break;
  }
  if (at.first.empty()) return fmt::format("nothing comes within {:.6g} mm", path.reach_m / units::mm);
  return fmt::format("{} and {} come within {:.3g} mm", at.first, at.second, at.distance_m / units::mm);
}

}  // namespace

std::string clearance_text(const PathClearance& clearance) {
  std::string out = clearance.clear() ? "clear: " : "";
  out += nearest_text(clearance);
  const bool placed = !clearance.clear() || !clearance.clearance.first.empty();
  if (placed && clearance.line > 0) out += fmt::format(", line {}", clearance.line);
  if (placed) out += fmt::format(", at {:.3f} s", clearance.time_s);
  return out + fmt::format("; {} positions of the trajectory looked at, no point moves more than {:.3g} mm between two",
                           clearance.looks, clearance.between_m / units::mm);
}

}  // namespace robomill::path
