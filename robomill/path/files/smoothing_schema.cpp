#include "robomill/path/files/smoothing_schema.hpp"

#include <utility>

namespace robomill::path {

const io::Schema<SmoothingFile>& smoothing_table() {
  using io::key;
  using Options = SmoothingOptions;
  const auto option = [](io::Row<Options> row) { return io::of(&SmoothingFile::options, std::move(row)); };
  static const io::Schema<SmoothingFile> table(
      "smoothing", "how a program becomes a trajectory",
      {option(key("tip_tolerance_mm", &Options::tip_tolerance_m,
                  "distance of the tip to the programmed path; required, as are the next seven")
                  .above(0.0, "0.02 mm suits finishing")),
       option(key("axis_tolerance_deg", &Options::axis_tolerance_rad,
                  "angle of the axis to the programmed curve (program.rotary)")
                  .above(0.0)),
       option(key("max_velocity_mm_per_s", &Options::max_velocity_m_per_s, "of the tip along its path").above(0.0)),
       option(key("max_acceleration_mm_per_s2", &Options::max_acceleration_m_per_s2, "of the tip").above(0.0)),
       option(key("max_jerk_mm_per_s3", &Options::max_jerk_m_per_s3, "of the tip").above(0.0)),
       option(
           key("max_angular_velocity_deg_per_s", &Options::max_angular_velocity_rad_per_s, "of the axis along its path")
               .above(0.0)),
       option(key("max_angular_acceleration_deg_per_s2", &Options::max_angular_acceleration_rad_per_s2, "of the axis")
                  .above(0.0)),
       option(key("max_angular_jerk_deg_per_s3", &Options::max_angular_jerk_rad_per_s3, "of the axis").above(0.0)),
       option(key("sample_period_ms", &Options::sample_period_s, "period of the samples").above(0.0)),
       option(key("max_duration_h", &Options::max_duration_s,
                  "a program that would last longer is rejected before it is sampled")
                  .above(0.0)),
       option(key("method", &Options::method, method_names, "robomill/path/README.md describes them")),
       option(key("filters", &Options::filters,
                  "moving averages in series: 1 a trapezoid of speed, 2 the S curve, 3 smoother; verified and optimal "
                  "(of --method, where it is given) need at least 2")
                  .at_least(1.0)
                  .at_most(3.0)),
       key("free_gamma", &SmoothingFile::free_gamma, "the flange may turn about the tool's axis along the path"),
       key("drive_bandwidth_hz", &SmoothingFile::drive_bandwidth_hz,
           "position servos of the joints, for the tracking error; one for all or one a joint")
           .or_one()
           .above(0.0),
       key("drive_damping_ratio", &SmoothingFile::drive_damping_ratio, "of these servos").above(0.0, "0.7 is usual"),
       key("flexible_joint_hz", &SmoothingFile::flexible_joint_hz,
           "flexible joints behind them; one for all or one a joint; without it stiff")
           .or_one()
           .above(0.0),
       key("flexible_joint_damping_ratio", &SmoothingFile::flexible_joint_damping_ratio, "of these joints")
           .at_least(0.0, "0.05 is usual")});
  return table;
}

}  // namespace robomill::path
