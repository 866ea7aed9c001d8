#include "examples/program-stability/hollow.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace robomill::examples {
namespace {

constexpr double move_mm = 1.5, step_over_mm = 0.6;
constexpr double deepest_mm = 0.8, least_mm = 0.3;  ///< below the stock's top, amid a pass and at its ends

/// The axis leans across the pass, from 10 degrees to 25 and back.
double lean_deg(double share) {
  return -10.0 - 15.0 * std::sin(std::numbers::pi * share);
}

double height_mm(double share) {
  return -least_mm - (deepest_mm - least_mm) * std::sin(std::numbers::pi * share);
}

double half_length_mm(int moves) {
  return 0.5 * move_mm * moves;
}

}  // namespace

std::string hollow_program(int passes, int moves_a_pass) {
  std::string out =
      "(a hollow finished to and fro with a ball end that leans; xyzac-trt, tip positions)\nG21 G90 G94 M428\n";
  out += "S9000 M3\n";
  const double half_mm = half_length_mm(moves_a_pass);
  for (int pass = 0; pass < passes; ++pass) {
    const double y_mm = step_over_mm * (pass - 0.5 * (passes - 1));
    const double way = pass % 2 == 0 ? 1.0 : -1.0;
    for (int i = 0; i <= moves_a_pass; ++i) {
      const double share = static_cast<double>(i) / moves_a_pass;
      const std::string place = fmt::format("X{:.3f} Y{:.3f}", way * (move_mm * i - half_mm), y_mm);
      if (i == 0) out += fmt::format("G0 {} Z4.000 A{:.3f} C0.000\n", place, lean_deg(share));
      out += fmt::format("G1 {} Z{:.3f} A{:.3f} C0.000 F{}\n", place, height_mm(share), lean_deg(share),
                         i == 0 ? 300 : 900);
    }
    // Away along the leant axis.
    const double back_rad = lean_deg(1.0) / 180.0 * std::numbers::pi;
    out += fmt::format("G0 Y{:.3f} Z4.000\n", y_mm + (4.0 - height_mm(1.0)) * std::tan(back_rad));
  }
  return out + "M2\n";
}

std::string hollow_forces(int passes, int moves_a_pass) {
  const double half_x_mm = half_length_mm(moves_a_pass) + 6.0;
  const double half_y_mm = 0.5 * step_over_mm * passes + 6.0;
  return fmt::format(R"(# A 10 mm ball end in an aluminium alloy; the stock is a box of rays.
[tool]
kind = "ball-end"
diameter_mm = 10
teeth = 2
helix_deg = 30

[coefficients]
tangential_n_per_mm2 = 700
radial_n_per_mm2 = 250
axial_n_per_mm2 = 100
tangential_edge_n_per_mm = 10
radial_edge_n_per_mm = 12
axial_edge_n_per_mm = 2

[stock]
kind = "box"
min_mm = [{0:.1f}, {1:.1f}, -8]
max_mm = [{2:.1f}, {3:.1f}, 0]
dexel_mm = 0.25
)",
                     -half_x_mm, -half_y_mm, half_x_mm, half_y_mm);
}

}  // namespace robomill::examples
