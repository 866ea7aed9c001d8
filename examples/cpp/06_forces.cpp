// What a ball end feels over a revolution: where it touches the material, and the force on it.
#include <robomill/base/units.hpp>
#include <robomill/cutting/engagement.hpp>
#include <robomill/cutting/force.hpp>

#include <Eigen/Core>
#include <cmath>
#include <cstdio>

using namespace robomill;

int main() {
  const cutting::Cutter ball{.kind = cutting::CutterKind::ball_end,
                             .mill = {.teeth = 2, .diameter_m = 10 * units::mm, .helix_rad = 30 * units::deg}};
  // A slot 1 mm deep; the axis leans forward by 15 deg, so that the tip, which has no cutting speed, is out of the cut.
  const cutting::Cut slot{
      .axial_depth_m = 1 * units::mm, .direction = cutting::MillingDirection::slot, .lead_rad = 15 * units::deg};
  const cutting::Engagement engagement = cutting::engage(ball, slot);

  // Aluminium: cutting coefficients, and what the edge adds per length.
  cutting::MillingCoefficients coefficients{.tangential_n_per_m2 = {800 * units::n_per_mm2},
                                            .radial_n_per_m2 = {300 * units::n_per_mm2},
                                            .axial_n_per_m2 = {100 * units::n_per_mm2},
                                            .tangential_edge_n_per_m = {12 * units::n_per_mm},
                                            .radial_edge_n_per_m = {15 * units::n_per_mm}};
  const cutting::CutMotion motion{.feed_per_tooth_m = 0.1 * units::mm, .spindle_speed_rad_per_s = 9000 * units::rpm};
  const cutting::CuttingForce force = cutting::cutting_force(ball, engagement, coefficients, motion);
  std::printf("force on the tool (x along the feed, z towards the spindle) until the next tooth:\n");
  for (Eigen::Index i = 0; i < force.rotation_rad.size() / ball.mill.teeth; i += 30)
    std::printf("  at %3.0f deg: %6.1f %6.1f %6.1f N\n", force.rotation_rad(i) / units::deg, force.force_n(0, i),
                force.force_n(1, i), force.force_n(2, i));
  std::printf("peak %.1f N, mean torque %.3f N m, power %.0f W, %.1f cm3/min\n", force.peak_force_n,
              force.mean_torque_n_m, force.power_w, force.removal_rate_m3_per_s * units::minute * 1e6);

  // Two closed forms. The groove's section is a segment of a circle, wherever the axis leans …
  const double r_m = ball.mill.diameter_m / 2.0, h_m = slot.axial_depth_m;
  const double segment_m2 =
      r_m * r_m * std::acos(1.0 - h_m / r_m) - (r_m - h_m) * std::sqrt(2.0 * r_m * h_m - h_m * h_m);
  std::printf("section of the groove: %.4f mm2 (segment of a circle %.4f mm2)\n", force.chip_area_m2 * 1e6,
              segment_m2 * 1e6);
  // … and without edge forces each cubic metre costs Kt joules.
  coefficients.tangential_edge_n_per_m = coefficients.radial_edge_n_per_m = {};
  const cutting::CuttingForce sharp = cutting::cutting_force(ball, engagement, coefficients, motion);
  const double joules_per_m3 = sharp.power_w / sharp.removal_rate_m3_per_s;
  std::printf("without edge forces %.2f J/mm3 (Kt is %.2f)\n", joules_per_m3 * units::mm3,
              coefficients.tangential_n_per_m2[0] * units::mm3);
  return std::abs(force.chip_area_m2 / segment_m2 - 1.0) < 1e-3 &&
                 std::abs(joules_per_m3 / coefficients.tangential_n_per_m2[0] - 1.0) < 1e-3
             ? 0
             : 1;
}
