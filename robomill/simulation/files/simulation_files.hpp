#pragma once
#include <filesystem>
#include <string>

#include "robomill/io/schema.hpp"
#include "robomill/simulation/simulation.hpp"

namespace robomill::simulation {

/// The columns time_s, x_m, y_m, ax_m_per_s2, ay_m_per_s2, fx_n, fy_n, fz_n (and z_m, az_m_per_s2 where z moves) by the
/// ending: .csv; .mat, a variable a column; .wav, ax and ay in m/s² as 32-bit floats, channels 1 and 2.
/// @throws InvalidInput if the ending is another one, the place cannot be written, or a WAV's rate is no whole number
void write_simulation(const std::filesystem::path& path, const Simulation& result);

inline constexpr Name<Verdict> verdict_names[] = {
    {"stable", Verdict::stable}, {"chatter", Verdict::chatter}, {"undecided", Verdict::undecided}};

/// What the simulation found, without the columns.
struct SimulationView {
  const Simulation* simulation = nullptr;
  double spindle_speed_rad_per_s = 0.0, axial_depth_m = 0.0;
};
[[nodiscard]] const io::Schema<SimulationView>& simulation_table();
[[nodiscard]] std::string simulation_json(const Simulation& result, double spindle_speed_rad_per_s,
                                          double axial_depth_m);

}  // namespace robomill::simulation
