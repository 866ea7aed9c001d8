// From lobes to the speed and depth to cut at, with a margin and within what the spindle gives.
#include <robomill/base/units.hpp>
#include <robomill/decision/choose.hpp>
#include <robomill/modal/modes.hpp>
#include <robomill/stability/lobes.hpp>

#include <cstdio>

using namespace robomill;

int main() {
  constexpr double diameter_m = 16 * units::mm, radial_depth_m = 8 * units::mm;
  stability::LobesProblem problem;
  problem.milling.tool = {.teeth = 3, .diameter_m = diameter_m, .helix_rad = 30 * units::deg};
  problem.milling.immersion = cutting::immersion(cutting::MillingDirection::down, radial_depth_m, diameter_m);
  problem.milling.coefficients = {.tangential_n_per_m2 = 700 * units::n_per_mm2,
                                  .radial_n_per_m2 = 250 * units::n_per_mm2};
  problem.milling.feed_per_tooth_m = 0.1 * units::mm;
  problem.dynamics = modal::modes_from_mass({{650.0, 0.025, 0.6}}, {{720.0, 0.03, 0.55}});

  stability::LobesOptions options;
  options.spindle_speed_rad_per_s = {4000 * units::rpm, 18000 * units::rpm};
  options.axial_depth_m = {0.0, 12 * units::mm};
  options.grid = {141, 40};
  const stability::LobesResult lobes = stability::compute_lobes(problem, options);

  decision::RecommendOptions limits;
  limits.radial_depth_m = radial_depth_m;
  limits.machine.depth_margin = 0.2;
  limits.machine.spindle = {{3000 * units::rpm, 2.4, 0.75 * units::kw},
                            {12000 * units::rpm, 2.4, 3.0 * units::kw},
                            {18000 * units::rpm, 1.6, 3.0 * units::kw}};
  const decision::Recommendation choice = decision::choose(problem, options, lobes.limit, limits);
  if (!choice.recommended) {
    std::printf("no safe depth: %s\n", choice.reason.c_str());
    return 1;
  }
  const auto print = [](const char* what, const decision::Operation& at) {
    std::printf("%s: %.0f rpm, %.2f mm deep, %.0f %% below the limit, %.0f cm3/min, %.2f N m, %.2f kW\n", what,
                at.spindle_speed_rad_per_s / units::rpm, at.axial_depth_m / units::mm, 100.0 * at.margin,
                at.removal_rate_m3_per_s * units::minute * 1e6, at.torque_n_m, at.power_w / units::kw);
  };
  print("recommended", *choice.recommended);
  for (const decision::Operation& other : choice.alternatives) print("alternative", other);

  // It is stable there, no deeper than the limit less the margin, and the spindle can drive it.
  const decision::Operation& best = *choice.recommended;
  const stability::PointResult there =
      stability::evaluate_point(problem, options, {best.spindle_speed_rad_per_s, best.axial_depth_m});
  const decision::SpindleCapacity capacity =
      decision::capacity_at(limits.machine.spindle, best.spindle_speed_rad_per_s);
  std::printf("vibration there shrinks to %.2f of itself from tooth to tooth; the spindle gives %.2f N m and %.2f kW\n",
              there.spectral_radius, capacity.torque_n_m, capacity.power_w / units::kw);
  return there.stable && best.margin >= limits.machine.depth_margin - 1e-9 &&
                 best.torque_n_m <= capacity.torque_n_m * (1.0 + 1e-9) &&
                 best.power_w <= capacity.power_w * (1.0 + 1e-9)
             ? 0
             : 1;
}
