#include "robomill/jobs/files/postures_json.hpp"

#include <fmt/format.h>

#include "robomill/base/units.hpp"
#include "robomill/io/csv.hpp"
#include "robomill/io/system/append.hpp"
#include "robomill/stability/files/lobes_schema.hpp"

namespace robomill::jobs {
namespace {

using io::key;
using stability::Limit;

const io::Schema<PostureLimits>& posture_limits_table() {
  static const io::Schema<PostureLimits> table(
      "posture_limits", "the limits in one posture",
      {key("number", &PostureLimits::number, "its place among the cell's [[postures]], from 1"),
       key(
           "joints_deg", [](const PostureLimits& row) { return row.posture.joints; }, "position of each joint"),
       key(
           "tip_mm", [](const PostureLimits& row) { return row.pose.tip_m; }, "of the tool, in the robot's base axes")
           .entries(3),
       key(
           "axis", [](const PostureLimits& row) { return row.pose.axis; }, "of the tool, from the tip to the spindle")
           .entries(3),
       key(
           "gamma_deg", [](const PostureLimits& row) { return row.pose.gamma_rad; },
           "turn of the flange about the tool's axis"),
       key(
           "limit_mm", [](const PostureLimits& row) { return stability::limit_depths_of(row.limits); },
           "one a speed; none: no depth of the chart is unstable")
           .nullable()},
      io::Use::written);
  return table;
}

const io::Schema<PostureDirection>& direction_table() {
  static const io::Schema<PostureDirection> table(
      "posture_direction", "postures that differ in one direction alone",
      {key("direction", &PostureDirection::name, "x, y or z of the tip, or gamma, a turn about the tool's axis"),
       key("postures", &PostureDirection::postures, "their numbers, by rising value"),
       key("spread", &PostureDirection::spread, "(greatest - least limit) / their mean, the mean over the speeds")
           .nullable(),
       key("speeds", &PostureDirection::speeds, "speeds at which each of them has a limit")},
      io::Use::written);
  return table;
}

}  // namespace

const io::Schema<PosturesResult>& postures_table() {
  static const io::Schema<PosturesResult> table(
      "postures", "the limits of a cut in each posture that a cell was measured in",
      {key("spindle_speed_rpm", &PosturesResult::spindle_speed_rad_per_s, "spindle speeds"),
       key("postures", &PosturesResult::postures, posture_limits_table(), "one a posture of the cell"),
       key("directions", &PosturesResult::directions, direction_table(), "how far limits lie apart by direction")},
      io::Use::written, 1);
  return table;
}

std::string postures_csv(const PosturesResult& result) {
  std::string out = "spindle_speed_rpm";
  for (const PostureLimits& row : result.postures) io::append(out, ",posture_{}_mm", row.number);
  out += "\n";
  for (std::size_t s = 0; s < result.spindle_speed_rad_per_s.size(); ++s) {
    out += io::csv_number(result.spindle_speed_rad_per_s[s], units::rpm);
    for (const PostureLimits& row : result.postures) {
      const Limit& limit = row.limits[s];
      out += ",";
      if (limit.status == Limit::Status::found) out += io::csv_number(limit.axial_depth_m, units::mm);
    }
    out += "\n";
  }
  return out;
}

}  // namespace robomill::jobs
