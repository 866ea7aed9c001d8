#pragma once

namespace robomill::page {

/// What the page draws and says of each block of blocks.json, a list each.
inline constexpr const char* path_columns[] = {"block",
                                               "line",
                                               "x_mm",
                                               "y_mm",
                                               "z_mm",
                                               "axial_depth_mm",
                                               "radial_depth_mm",
                                               "spindle_speed_rpm",
                                               "feed_mm_per_min",
                                               "spectral_radius",
                                               "limit_depth_mm",
                                               "limit_5_percent_mm",
                                               "limit_95_percent_mm",
                                               "stability_margin",
                                               "gain_margin",
                                               "chatter_frequency_hz",
                                               "mode",
                                               "regime",
                                               "lower_bound",
                                               "peak_f_n",
                                               "torque_n_m",
                                               "power_w",
                                               "deflection_um",
                                               "joint_torque_share",
                                               "cut_joint_torque_n_m",
                                               "surface_error_um",
                                               "vibration_um",
                                               "condition_number",
                                               "measured_nearby",
                                               "note"};

}  // namespace robomill::page
