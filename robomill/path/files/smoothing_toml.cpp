#include "robomill/path/files/smoothing_toml.hpp"

#include <fmt/format.h>

#include <cstddef>
#include <string>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/io/toml/file.hpp"
#include "robomill/robot/files/joint_limits.hpp"

namespace robomill::path {
namespace {

using Options = SmoothingOptions;
constexpr io::Field<Options> option_fields[] = {
    {"tip_tolerance_mm", "tip_tolerance_m", units::mm, &Options::tip_tolerance_m},
    {"axis_tolerance_deg", "axis_tolerance_rad", units::deg, &Options::axis_tolerance_rad},
    {"max_velocity_mm_per_s", "max_velocity_m_per_s", units::mm, &Options::max_velocity_m_per_s},
    {"max_acceleration_mm_per_s2", "max_acceleration_m_per_s2", units::mm, &Options::max_acceleration_m_per_s2},
    {"max_jerk_mm_per_s3", "max_jerk_m_per_s3", units::mm, &Options::max_jerk_m_per_s3},
    {"max_angular_velocity_deg_per_s", "max_angular_velocity_rad_per_s", units::deg,
     &Options::max_angular_velocity_rad_per_s},
    {"max_angular_acceleration_deg_per_s2", "max_angular_acceleration_rad_per_s2", units::deg,
     &Options::max_angular_acceleration_rad_per_s2},
    {"max_angular_jerk_deg_per_s3", "max_angular_jerk_rad_per_s3", units::deg, &Options::max_angular_jerk_rad_per_s3},
    {"sample_period_ms", "sample_period_s", units::ms, &Options::sample_period_s},
    {"max_duration_h", "max_duration_s", 60.0 * units::minute, &Options::max_duration_s},
};

/// A list with one number > 0 a joint, or one for all.
void read_per_joint(io::TomlFile& file, const char* key, const char* member, int joints, std::vector<double>& out) {
  if (!file.numbers(key, member, 1.0, out)) return;
  if (out.size() == 1) out.assign(static_cast<std::size_t>(joints), out.front());
  if (static_cast<int>(out.size()) != joints) {
    throw file.reject(
        key, fmt::format("must hold one number for all joints or one a joint, {}; it holds {}", joints, out.size()));
  }
  for (const double value : out) {
    if (!(value > 0.0)) throw file.reject(key, fmt::format("must be > 0; it holds {}", value));
  }
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
  file.fields("smoothing.", option_fields, out.options);
  file.choice("smoothing.method", method_names, out.options.method);
  if (method) out.options.method = *method;
  file.integer("smoothing.filters", "filters", out.options.filters);
  file.boolean("smoothing.free_gamma", out.free_gamma);
  read_per_joint(file, "smoothing.drive_bandwidth_hz", "drive_bandwidth_hz", joints, out.drive_bandwidth_hz);
  read_per_joint(file, "smoothing.flexible_joint_hz", "flexible_joint_hz", joints, out.flexible_joint_hz);
  file.number("smoothing.drive_damping_ratio", "drive_damping_ratio", 1.0, out.drive_damping_ratio);
  file.number("smoothing.flexible_joint_damping_ratio", "flexible_joint_damping_ratio", 1.0,
              out.flexible_joint_damping_ratio);
  static_cast<void>(file.done());  // whoever read the cell has what is unusual in it
  file.locate([&] {
    out.options.validate();
    require_positive("drive_damping_ratio", out.drive_damping_ratio, "", "0.7 is usual");
    require_non_negative("flexible_joint_damping_ratio", out.flexible_joint_damping_ratio, "", "0.05 is usual");
  });
  return out;
}

}  // namespace robomill::path
