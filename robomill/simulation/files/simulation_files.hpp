#pragma once
#include <filesystem>
#include <string>

#include "robomill/simulation/simulation.hpp"

namespace robomill::simulation {

/// The columns time_s, x_m, y_m, ax_m_per_s2, ay_m_per_s2, fx_n, fy_n, fz_n (and z_m, az_m_per_s2 where z moves) by the
/// ending: .csv; .mat, a variable a column; .wav, ax and ay in m/s² as 32-bit floats, channels 1 and 2.
/// @throws InvalidInput if the ending is another one, the place cannot be written, or a WAV's rate is no whole number
void write_simulation(const std::filesystem::path& path, const Simulation& result);

/// What the simulation found, without the columns.
[[nodiscard]] std::string simulation_json(const Simulation& result, double spindle_speed_rad_per_s,
                                          double axial_depth_m);

}  // namespace robomill::simulation
