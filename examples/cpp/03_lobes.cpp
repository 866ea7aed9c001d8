// Stability lobes of a slot. Four teeth and one flexible direction, along the feed: in a full slot the teeth's forces
// add up to a constant stiffness, so that the lobes are known in closed form.
#include <robomill/base/units.hpp>
#include <robomill/modal/modes.hpp>
#include <robomill/stability/lobes.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <numbers>

using namespace robomill;

int main() {
  constexpr double pi = std::numbers::pi, mass_kg = 0.6, frequency_hz = 650.0, damping_ratio = 0.025;
  stability::LobesProblem problem;
  problem.milling.tool = {.teeth = 4, .diameter_m = 16 * units::mm};
  problem.milling.immersion = cutting::immersion(cutting::MillingDirection::slot, 0.0, 16 * units::mm);
  problem.milling.coefficients = {.tangential_n_per_m2 = 700 * units::n_per_mm2,
                                  .radial_n_per_m2 = 250 * units::n_per_mm2};
  problem.dynamics = modal::modes_from_mass({{frequency_hz, damping_ratio, mass_kg}}, {});

  stability::LobesOptions options;
  options.spindle_speed_rad_per_s = {4000 * units::rpm, 12000 * units::rpm};
  options.axial_depth_m = {0.0, 10 * units::mm};
  options.grid = {161, 50};
  const stability::LobesResult lobes = stability::compute_lobes(problem, options);
  for (std::size_t i = 0; i < lobes.limit.size(); i += 20) {
    const stability::Limit& limit = lobes.limit[i];
    const double speed_rpm = limit.spindle_speed_rad_per_s / units::rpm;
    if (limit.status == stability::Limit::Status::found)
      std::printf("%6.0f rpm: chatter from %.3f mm on, at %.1f Hz\n", speed_rpm, limit.axial_depth_m / units::mm,
                  limit.chatter_frequency_hz);
    else
      std::printf("%6.0f rpm: stable down to %.0f mm\n", speed_rpm, options.axial_depth_m[1] / units::mm);
  }

  // Each tooth leaves Kr sin^2 + Kt sin cos; over four teeth that is Kr, and a = -1 / (2 Kr Re G). It is least at
  // w0 sqrt(1 + 2 z), 2 k z (1 + z) / Kr, and each lobe has it at one speed.
  const double omega_rad_per_s = 2.0 * pi * frequency_hz,
               stiffness_n_per_m = mass_kg * omega_rad_per_s * omega_rad_per_s;
  const double least_m =
      2.0 * stiffness_n_per_m * damping_ratio * (1.0 + damping_ratio) / problem.milling.coefficients.radial_n_per_m2;
  double found_m = options.axial_depth_m[1];
  for (const stability::Limit& limit : lobes.limit)
    if (limit.status == stability::Limit::Status::found) found_m = std::min(found_m, limit.axial_depth_m);
  std::printf("stable at every speed: %.4f mm, in closed form %.4f mm\n", found_m / units::mm, least_m / units::mm);
  return std::abs(found_m / least_m - 1.0) < 1e-3 ? 0 : 1;
}
