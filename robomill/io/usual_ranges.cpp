#include "robomill/io/usual_ranges.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/io/key_unit.hpp"
#include "robomill/io/text.hpp"

namespace robomill::io {
namespace {

constexpr double deg_per_rad = 180.0 / std::numbers::pi;
constexpr Compared largest = Compared::largest, angles = Compared::angles, any = Compared::any;

// From cutters of 0.1 mm to face mills of 200 mm, from arms of 3 kg payload to such of 1,000 kg, from a robot's first
// mode to that of a short end mill. Wide on purpose: what is rare is no mistake.
constexpr std::array rows = std::to_array<UsualRange>({
    // cutter
    {"teeth", 1, 60},
    {"flutes", 1, 60},
    {"diameter_mm", 0.05, 250},
    {"inner_diameter_mm", 0.05, 250},
    {"upper_diameter_mm", 1, 400},
    {"shank_diameter_mm", 0.5, 250},
    {"helix_deg", 2, 65, angles},
    {"pitch_deg", 3, 360, largest},
    {"runout_um", 0.05, 300},
    {"runout_angle_deg", 0, 360, any},
    {"corner_radius_mm", 0.005, 60},
    {"corner_center_radius_mm", 0.005, 200},
    {"corner_center_height_mm", 0.005, 200},
    {"bottom_angle_deg", 0, 90, any},
    {"side_angle_deg", 0, 90, any},
    {"cutting_height_mm", 0.05, 300},
    {"max_axial_depth_mm", 0.05, 300},
    {"point_angle_deg", 60, 180},
    {"rake_deg", 0, 45, any},
    {"wear_land_mm", 0.005, 1},
    {"indentation_n_per_mm3", 100, 1e7},
    // cut
    {"feed_per_tooth_mm", 1e-4, 2},
    {"feed_per_revolution_mm", 0.001, 5},
    {"axial_depth_mm", 0.0055, 200},
    {"radial_depth_mm", 0.001, 250},
    {"stepover_mm", 0.001, 250},
    {"entry_deg", 0, 360, any},
    {"exit_deg", 0, 360, any},
    {"lead_deg", 0, 90, any},
    {"tilt_deg", 0, 90, any},
    {"feed_direction_deg", 0, 360, any},
    {"surface_radius_along_feed_mm", 0.1, 1e5},
    {"surface_radius_across_feed_mm", 0.1, 1e5},
    {"spindle_speed_rpm", 50, 200'000},
    {"spindle_speed_std_rpm", 0, 0, any},
    {"min_speed_rpm", 10, 200'000},
    {"max_speed_rpm", 500, 200'000},
    {"speed_rpm", 10, 200'000},
    {"torque_n_m", 0.01, 2000},
    {"power_kw", 0.05, 200},
    {"spindle_ramp_rpm_per_s", 50, 200'000},
    {"spin_up_s", 0.1, 120},
    {"chip_thickness_mm", 1e-5, 3},
    {"cutting_speed_m_per_min", 1, 10'000},
    {"feed_mm_per_min", 1, 100'000},
    {"max_feed_mm_per_min", 10, 100'000},
    {"max_force_n", 0.1, 20'000},
    {"max_deflection_um", 0.1, 3000},
    {"max_surface_error_um", 0.1, 3000},
    {"max_offset_um", 1, 5000},
    {"gamma_range_deg", 5, 360, angles},
    {"gamma_step_deg", 1, 90},
    {"cone_deg", 1, 45},
    {"cone_step_deg", 1, 45},
    {"power_time_s", 0.001, 60},
    // measured: forces, vibration, displacements under a load; the largest of a column
    {"force_n", 0.1, 50'000, largest},
    {"fx_n", 0.01, 20'000, largest},
    {"fy_n", 0.01, 20'000, largest},
    {"fz_n", 0.01, 20'000, largest},
    {"mx_n_m", 0.001, 5000, largest},
    {"my_n_m", 0.001, 5000, largest},
    {"mz_n_m", 0.001, 5000, largest},
    {"dx_mm", 1e-4, 50, largest},
    {"dy_mm", 1e-4, 50, largest},
    {"dz_mm", 1e-4, 50, largest},
    {"deviation_mm", 1e-5, 5, largest},
    {"ax_m_per_s2", 0.001, 1e6, largest},
    {"ay_m_per_s2", 0.001, 1e6, largest},
    {"az_m_per_s2", 0.001, 1e6, largest},
    {"ax_g", 1e-4, 1e5, largest},
    {"ay_g", 1e-4, 1e5, largest},
    {"az_g", 1e-4, 1e5, largest},
    // force coefficients; of polynomials in the position angle no coefficient has a usual range of its own
    {"tangential_n_per_mm2", 5, 12'000, largest},
    {"radial_n_per_mm2", 1, 12'000, largest,
     "A tooth is mostly pushed out of what it cuts: is the sign that of another convention? A high rake angle, fibres "
     "or "
     "a fit to few feeds may pull it in"},
    {"axial_n_per_mm2", 1, 12'000, largest},
    {"tangential_edge_n_per_mm", 0.1, 300, largest},
    {"radial_edge_n_per_mm", 0.1, 300, largest},
    {"axial_edge_n_per_mm", 0.05, 300, largest},
    {"tangential_std_n_per_mm2", 0.01, 4000},
    {"radial_std_n_per_mm2", 0.01, 4000},
    {"tangential_range_n_per_mm2", 1, 20'000},
    {"specific_force_n_per_mm2", 5, 12'000},
    {"shear_stress_n_per_mm2", 10, 2000},
    {"friction_angle_deg", 5, 60},
    {"chip_ratio_per_deg", 0, 0, any},
    {"chip_ratio_power_per_deg", 0, 0, any},
    // structure
    {"frequency_hz", 1, 30'000},
    {"frequency_std_hz", 0, 0, any},
    {"modes[].std.frequency_hz", 0, 0, any},
    {"modes[].std.damping_ratio", 0, 0, any},
    {"damping_ratio", 2e-4, 0.35},
    {"modal_mass_kg", 1e-5, 5000},
    {"modal_stiffness_n_per_um", 0.1, 1000},
    {"youngs_modulus_gpa", 60, 750},
    {"tool[].youngs_modulus_gpa", 150, 750},
    {"density_kg_per_m3", 1000, 20'000},
    {"poissons_ratio", 0.1, 0.45},
    {"loss_factor", 1e-5, 0.3},
    {"length_mm", 0.2, 1000},
    {"tool[].length_mm", 0.2, 500},
    {"insertion_length_mm", 2, 300},
    {"points_mm", 1, 500, largest},
    {"translational_stiffness_n_per_m", 1e5, 1e12, largest},
    {"rotational_stiffness_n_m_per_rad", 10, 1e12, largest},
    {"cross_stiffness_n_per_rad", 10, 1e10, largest},
    {"translational_damping_n_s_per_m", 0.001, 1e6, largest},
    {"rotational_damping_n_m_s_per_rad", 1e-5, 1e6, largest},
    {"range_hz", 20, 50'000, largest},
    {"step_hz", 0.001, 100},
    {"band_hz", 20, 50'000, largest},
    {"exponential_decay_per_s", 0, 0, any},
    {"peaks_hz", 1, 50'000},
    // hammer hits
    {"sample_rate_hz", 100, 1e7},
    {"force_mv_per_n", 0.05, 1020},
    {"response_mv_per_g", 0.5, 1e7},
    {"response_mv_per_m_per_s2", 0.05, 1020},
    {"response_mv_per_m_per_s", 10, 1e7},
    {"response_mv_per_m", 1, 1e9},
    {"accelerometer_mass_kg", 1e-4, 0.2},
    {"accelerometer.mass_kg", 1e-4, 0.2},
    {"accelerometer.offset_mm", 0.1, 50},
    {"force_overload_n", 10, 100'000},
    {"response_overload_m_per_s2", 10, 1e6},
    {"response_overload_m_per_s", 0.01, 1000},
    {"response_overload_m", 1e-5, 1},
    {"min_frequency_hz", 0.1, 10'000},
    {"max_frequency_hz", 10, 50'000},
    {"frequency_resolution_hz", 0.01, 100},
    {"hit_spacing_s", 0.05, 60},
    {"force_window_s", 1e-4, 1},
    {"exponential_time_constant_s", 0.001, 30},
    // arm and cell
    {"a_mm", 0.5, 5000},
    {"d_mm", 0.5, 5000},
    {"alpha_deg", 1e-3, 360, angles},
    {"theta_offset_deg", 1e-3, 360, angles},
    {"base_half_width_mm", 10, 5000},
    {"platform_half_width_mm", 10, 5000},
    {"platform_offset_mm", 1, 5000},
    {"base_offset_mm", 1, 5000},
    {"platform_to_flange_mm", 1, 5000},
    {"base_origin_mm", 5, 20'000, largest},
    {"base_rotation_deg", 1e-3, 360, angles},
    {"origin_mm", 5, 20'000, largest},
    {"rotation_deg", 1e-3, 360, angles},
    {"mount_origin_mm", 5, 2000, largest},
    {"mount_rotation_deg", 1e-3, 360, angles},
    {"joints_deg", 0.5, 720, angles},
    {"start_joints_deg", 0.5, 720, angles},
    {"gamma_deg", 0.5, 360, any},
    {"joint_min_position", 0, 0,
     any},  // of these and of the velocity without a unit robot/files/joint_limits.cpp doubts
    {"joint_max_position", 0, 0, any},
    {"joint_min_position_deg", 1, 720, angles},
    {"joint_max_position_deg", 1, 720, angles},
    {"joint_min_position_rad", 0.02, 15},
    {"joint_max_position_rad", 0.02, 15},
    {"joint_min_position_mm", 1, 30'000},
    {"joint_max_position_mm", 1, 30'000},
    {"joint_max_velocity", 0, 0, any},
    {"joint_max_velocity_deg_per_s", 15, 2300},
    {"joint_max_velocity_rad_per_s", 0.2, 40},
    {"joint_max_velocity_mm_per_s", 10, 10'000},
    {"joint_max_acceleration", 0.05, 150},
    {"joint_max_acceleration_deg_per_s2", 20, 12'000},
    {"joint_max_acceleration_rad_per_s2", 0.3, 200},
    {"joint_max_acceleration_mm_per_s2", 10, 100'000},
    {"joint_max_jerk", 0.5, 20'000},
    {"joint_max_jerk_deg_per_s3", 100, 2e6},
    {"joint_max_jerk_rad_per_s3", 2, 35'000},
    {"joint_max_jerk_mm_per_s3", 100, 1e7},
    {"joint_stiffness_n_m_per_rad", 500, 1e8},
    {"joint_damping_n_m_s_per_rad", 0.01, 1e6},
    {"joint_rotor_inertia_kg_m2", 0.001, 2000},
    {"joint_max_torque_n_m", 1, 100'000},
    {"center_mm", 0.5, 3000, largest},
    {"inertia_kg_m2", 1e-6, 5000, largest},
    {"mass_kg", 0.001, 3000},
    {"tool.mass_kg", 0.2, 1500},
    {"tool.length_mm", 5, 1500},
    {"tip_tolerance_mm", 5e-4, 5},
    {"axis_tolerance_deg", 1e-3, 10},
    {"max_velocity_mm_per_s", 1, 5000},
    {"max_acceleration_mm_per_s2", 10, 50'000},
    {"max_jerk_mm_per_s3", 100, 1e7},
    {"max_angular_velocity_deg_per_s", 2, 1500},
    {"max_angular_acceleration_deg_per_s2", 10, 20'000},
    {"max_angular_jerk_deg_per_s3", 100, 2e6},
    {"sample_period_ms", 0.05, 100},
    {"max_duration_h", 0, 0, any},
    {"drive_bandwidth_hz", 0.2, 1000},
    {"flexible_joint_hz", 1, 2000},
    {"stickout_mm", 1, 1000},
    {"clearance_mm", 0.01, 200},
    {"gouge_tolerance_mm", 0.001, 10},
    {"box_from_mm", 1, 20'000, largest},
    {"box_to_mm", 1, 20'000, largest},
    {"from_mm", 1, 20'000, largest},
    {"to_mm", 1, 20'000, largest},
    // stock
    {"min_mm", 0.2, 20'000, largest},
    {"max_mm", 0.2, 20'000, largest},
    {"radius_mm", 0.1, 10'000},
    {"bottom_mm", 0, 0, any},
    {"top_mm", 0, 0, any},
    {"outline_radius_mm", 0.1, 10'000, largest},
    {"outline_z_mm", 0, 0, any},
    {"dexel_mm", 0.001, 10},
    // monitor
    {"window_ms", 1, 5000},
    {"hop_ms", 0.5, 5000},
    {"timeout_s", 0.01, 3600},
    {"connect_timeout_s", 0, 0, any},
    {"false_alarms_per_hour", 1e-6, 100},
    {"settle_s", 0.1, 60},
    {"calm_s", 0.05, 600},
    {"retract_mm", 0.05, 500},
    {"pulses_per_revolution", 1, 10'000},
    {"onset_s", 0, 0, any},
});

/// A unit that somebody may have written a value in: the value in the key's unit is `factor` times what stands there.
struct Slip {
  std::string_view unit;  ///< of the key
  double factor;
  std::string_view written;
};

constexpr std::array slips = std::to_array<Slip>({
    {"mm", 1000, "m"},
    {"mm", 25.4, "inches"},
    {"mm", 1e-3, "um"},
    {"mm", 10, "cm"},
    {"um", 1000, "mm"},
    {"um", 1e6, "m"},
    {"deg", deg_per_rad, "rad"},
    {"rad", 1 / deg_per_rad, "degrees"},
    {"deg/s", deg_per_rad, "rad/s"},
    {"rad/s", 1 / deg_per_rad, "deg/s"},
    {"deg/s^2", deg_per_rad, "rad/s^2"},
    {"rad/s^2", 1 / deg_per_rad, "deg/s^2"},
    {"deg/s^3", deg_per_rad, "rad/s^3"},
    {"rad/s^3", 1 / deg_per_rad, "deg/s^3"},
    {"mm/s", 1000, "m/s"},
    {"mm/s", 1.0 / 60, "mm/min"},
    {"mm/s^2", 1000, "m/s^2"},
    {"mm/s^3", 1000, "m/s^3"},
    {"mm/min", 1000, "m/min"},
    {"mm/min", 60, "mm/s"},
    {"m/min", 1e-3, "mm/min"},
    {"m/min", 60, "m/s"},
    {"rpm", 60, "Hz (revolutions per second)"},
    {"rpm", 30 / std::numbers::pi, "rad/s"},
    {"rpm", 1000, "thousands of rpm"},
    {"rpm", 1.0 / 60, "revolutions per hour"},
    {"Hz", 1000, "kHz"},
    {"Hz", 1.0 / 60, "rpm"},
    {"Hz", 1e-3, "mHz"},
    {"N/mm^2", 1e-6, "N/m^2"},
    {"N/mm^2", 1000, "kN/mm^2 (GPa)"},
    {"N/mm^2", 1e6, "N/um^2"},
    {"N/mm", 1e-3, "N/m"},
    {"N/mm", 1000, "kN/mm"},
    {"N/um", 1e-6, "N/m"},
    {"N/um", 1e-3, "N/mm"},
    {"N/m", 1000, "N/mm"},
    {"N/m", 1e6, "N/um"},
    {"N m/rad", 1000, "kN m/rad"},
    {"N m/rad", 1e6, "MN m/rad"},
    {"N m/rad", deg_per_rad, "N m/deg"},
    {"N m/rad", 1e-3, "N mm/rad"},
    {"N", 1000, "kN"},
    {"N", units::standard_gravity, "kgf"},
    {"N", 1e-3, "mN"},
    {"N m", 1e-3, "N mm"},
    {"N m", 1000, "kN m"},
    {"kW", 1e-3, "W"},
    {"kg", 1e-3, "g"},
    {"kg", 1000, "t"},
    {"kg m^2", 1e-6, "kg mm^2"},
    {"kg m^2", 1e-9, "g mm^2"},
    {"kg/m^3", 1000, "g/cm^3"},
    {"kg/m^3", 1e12, "t/mm^3"},
    {"GPa", 1e-3, "MPa (N/mm^2)"},
    {"GPa", 1e-9, "Pa"},
    {"mV/N", 1000, "V/N"},
    {"mV/g", 1000, "V/g"},
    {"mV/(m/s^2)", 1000, "V/(m/s^2)"},
    {"s", 1e-3, "ms"},
    {"ms", 1000, "s"},
    {"", 1e-2, "percent"},
});

/// Position, velocity and the like of joints, whose unit is rad or m, so that the key has none.
bool is_of_joints(std::string_view name) {
  return name.starts_with("joint_") && unit_of_key(name).empty();
}

bool within(const UsualRange& row, double value) {
  // A decimal value at the end of its range is within it.
  return std::abs(value) >= row.lowest * (1.0 - 1e-9) && std::abs(value) <= row.highest * (1.0 + 1e-9);
}

std::string hint_of(const UsualRange& row, std::string_view key, double value) {
  const std::string_view name = key.substr(key.rfind('.') + 1);
  if (is_of_joints(name)) return within(row, value / deg_per_rad) ? "Is it in degrees or mm?" : "";
  const std::string unit = unit_of_key(name);
  if (name == "feed_per_tooth_mm" && value > row.highest && value >= 20.0)
    return "Is it a feed in mm/min, or in um a tooth?";
  if (name.ends_with("youngs_modulus_gpa") && within(row, 10.0 * value))
    return "Steel has 210 GPa, carbide 450 to 700: is a digit missing?";
  for (const Slip& slip : slips) {
    if (slip.unit == unit && within(row, value * slip.factor)) return fmt::format("Is it in {}?", slip.written);
  }
  return {};
}

/// Whether a number is a multiple of 15° in radians, from 45° on, as somebody would write it, and no round number of
/// degrees. Frames that were measured are off by less.
bool is_round_in_radians(double value) {
  constexpr double step = std::numbers::pi / 12.0;
  const double steps = std::round(std::abs(value) / step);
  const bool round_in_degrees = std::abs(2.0 * value - std::round(2.0 * value)) < 1e-9;
  return steps >= 3.0 && steps <= 24.0 && !round_in_degrees && std::abs(std::abs(value) - steps * step) < 6e-3;
}

/// Angles none of which is above a full turn in radians, at least one of which is a round number of them; or several of
/// odd numbers. Angles of a setup in degrees are mostly round and above that.
bool look_like_radians(std::span<const double> values) {
  std::size_t round_ones = 0, odd = 0;
  for (const double value : values) {
    if (std::abs(value) > 2.0 * std::numbers::pi + 6e-3) return false;
    if (is_round_in_radians(value)) ++round_ones;
    if (std::abs(10.0 * value - std::round(10.0 * value)) > 1e-9) ++odd;
  }
  return round_ones > 0 || (values.size() >= 6 && odd >= 3);
}

}  // namespace

std::span<const UsualRange> usual_ranges() {
  return rows;
}

const UsualRange* usual_range(std::string_view key) {
  std::string path;
  bool index = false;
  for (const char letter : key) {
    if (letter == ']') index = false;
    if (!index) path += letter;
    if (letter == '[') index = true;
  }
  const auto row_of = [](std::string_view name) {
    const auto* row = std::ranges::find(rows, name, &UsualRange::key);
    return row == rows.end() ? nullptr : row;
  };
  if (const UsualRange* row = row_of(path)) return row;
  return row_of(std::string_view(path).substr(path.rfind('.') + 1));
}

std::optional<Unusual> unusual_value(std::string_view key, std::span<const double> values) {
  const UsualRange* row = usual_range(key);
  if (row == nullptr || row->compared == any || values.empty()) return std::nullopt;
  const auto unusual = [&](double value, std::string hint) {
    const std::string unit = unit_of_key(key);
    return Unusual{.value = value,
                   .rule = fmt::format("is unusual: {:.15g} to {:.15g}{}{} is usual", row->lowest, row->highest,
                                       unit.empty() ? "" : " ", unit),
                   .hint = std::move(hint)};
  };
  if (!row->if_negative.empty() && values.size() == 1 && values[0] < 0.0) {
    return unusual(values[0], std::string(row->if_negative));
  }
  const double most = *std::ranges::max_element(values, {}, [](double value) { return std::abs(value); });
  if (row->compared == angles && most != 0.0 && look_like_radians(values)) {
    return Unusual{.value = most, .rule = "looks like radians", .hint = "The key is in degrees"};
  }
  if (row->compared != Compared::each) {
    if (most == 0.0 || within(*row, most)) return std::nullopt;
    return unusual(most, hint_of(*row, key, most));
  }
  for (const double value : values) {
    if (value != 0.0 && !within(*row, value)) return unusual(value, hint_of(*row, key, value));
  }
  return std::nullopt;
}

std::optional<std::string> unusual_warning(std::string_view where, std::string_view key,
                                           std::span<const double> values) {
  std::optional<Unusual> found = unusual_value(key, values);
  if (!found) return std::nullopt;
  const InvalidInput said(InvalidInput::Parts{.where = std::string(where),
                                              .field = std::string(key),
                                              .number = found->value,
                                              .unit = unit_of_key(key),
                                              .rule = std::move(found->rule),
                                              .hint = std::move(found->hint)});
  return fmt::format("{}{}", warning_label, said.what());
}

std::vector<std::string> take_warnings(std::vector<std::string>& notes) {
  std::vector<std::string> out;
  std::erase_if(notes, [&](const std::string& note) {
    if (!note.starts_with(warning_label)) return false;
    out.push_back(note.substr(warning_label.size()));
    return true;
  });
  return out;
}

}  // namespace robomill::io
