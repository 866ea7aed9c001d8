#include "robomill/path/files/smoothing_toml.hpp"

#include <fmt/format.h>

#include <cstddef>
#include <string>

#include "robomill/base/error.hpp"
#include "robomill/io/toml/file.hpp"
#include "robomill/path/files/smoothing_schema.hpp"
#include "robomill/robot/files/joint_limits.hpp"

namespace robomill::path {
namespace {

/// One number a joint, of one for all.
void spread(const io::TomlFile& file, const char* key, int joints, std::vector<double>& values) {
  if (values.size() == 1) values.assign(static_cast<std::size_t>(joints), values.front());
  if (!file.has(key) || static_cast<int>(values.size()) == joints) return;
  throw file.reject(
      key, fmt::format("must hold one number for all joints or one a joint, {}; it holds {}", joints, values.size()));
}

/// The limits come from the cell's reader; here their errors are reported in the file's words.
void check_limits(io::TomlFile& file, const robot::JointLimits& limits, int joints) {
  for (const robot::JointLimit& limit : robot::joint_limits) {
    std::vector<double> values;
    file.numbers(std::string("robot.joint_") + limit.name, limit.name, 1.0, values);
  }
  try {
    limits.validate(joints);
  } catch (const InvalidInput& error) {
    InvalidInput::Parts parts = file.located(error).parts();
    // Without a URDF a list that is missing is so for every joint.
    const std::string list = parts.field.substr(0, parts.field.find('['));
    if (!file.has(list) && !file.has("robot.urdf")) parts.field = list;
    if (parts.hint.empty())
      parts.hint = "Smoothing needs every joint's velocity, acceleration and jerk: rad or m, by joint";
    throw InvalidInput(std::move(parts));
  }
}

}  // namespace

bool has_smoothing(const io::TomlFile& cell) {
  return cell.has("smoothing");
}

SmoothingFile read_smoothing(io::TomlFile& file, const robot::JointLimits& limits, int joints,
                             std::optional<Method> method) {
  file.require("smoothing", "Write [smoothing] with tip_tolerance_mm, axis_tolerance_deg and the limits of the tool");
  check_limits(file, limits, joints);
  SmoothingFile out;
  smoothing_table().read(file, "smoothing", out);
  if (method) out.options.method = *method;
  spread(file, "smoothing.drive_bandwidth_hz", joints, out.drive_bandwidth_hz);
  spread(file, "smoothing.flexible_joint_hz", joints, out.flexible_joint_hz);
  static_cast<void>(file.done());  // whoever read the cell has what is unusual in it
  file.locate([&] { out.options.validate(); });
  return out;
}

}  // namespace robomill::path
