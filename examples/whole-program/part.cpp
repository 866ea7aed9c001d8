#include "examples/whole-program/part.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace robomill::examples {
namespace {

constexpr double pi = std::numbers::pi;

/// Of the face's passes along x.
constexpr int face_passes = 6, face_moves = 18;
constexpr double face_half_mm = 40.0, face_step_mm = 6.0, face_depth_mm = 0.8;

/// Of the hollow's passes along x.
constexpr int hollow_passes = 13, hollow_moves = 24;
constexpr double hollow_half_mm = 18.0, hollow_step_mm = 0.6;

double rad(double degrees) {
  return degrees / 180.0 * pi;
}

std::string aluminium() {
  return R"(
[coefficients]                      # an aluminium alloy
tangential_n_per_mm2 = 700
radial_n_per_mm2 = 250
axial_n_per_mm2 = 100
tangential_edge_n_per_mm = 10
radial_edge_n_per_mm = 12
axial_edge_n_per_mm = 2
)";
}

}  // namespace

std::string face_program() {
  std::string out = "(a face by a flat end that leads; xyzac-trt, tip positions)\nG21 G90 G94 M428\nS8000 M3\n";
  for (int pass = 0; pass < face_passes; ++pass) {
    const double y_mm = face_step_mm * (pass - 0.5 * (face_passes - 1));
    for (int i = 0; i <= face_moves; ++i) {
      const double share = static_cast<double>(i) / face_moves;
      const double lead_deg = 3.0 + 2.0 * std::sin(pi * share);
      // The tool leads along x: its axis leans back by turning C to a quarter turn and A by the lead.
      const std::string place = fmt::format("X{:.3f} Y{:.3f}", face_half_mm * (2.0 * share - 1.0), y_mm);
      if (i == 0) {
        out += fmt::format("G0 {} Z10.000 A{:.3f} C-90.000\nG0 Z-{:.3f}\n", place, lead_deg, face_depth_mm);
      } else {
        out += fmt::format("G1 {} A{:.3f} C-90.000 F1200\n", place, lead_deg);
      }
    }
    out += "G0 Z10.000\n";
  }
  return out + "M2\n";
}

std::string face_forces() {
  return R"([tool]
kind = "flat-end"
diameter_mm = 12
teeth = 3
helix_deg = 30
)" + aluminium() +
         R"(
[stock]
kind = "box"
min_mm = [-32, -18, -10]
max_mm = [32, 18, 0]
dexel_mm = 0.3
)";
}

std::string hollow_program() {
  std::string out =
      "(a hollow finished to and fro by a ball end that leans; xyzac-trt, tip positions)\nG21 G90 G94 M428\n"
      "S9000 M3\n";
  for (int pass = 0; pass < hollow_passes; ++pass) {
    const double y_mm = hollow_step_mm * (pass - 0.5 * (hollow_passes - 1));
    const double way = pass % 2 == 0 ? 1.0 : -1.0;
    for (int i = 0; i <= hollow_moves; ++i) {
      const double share = static_cast<double>(i) / hollow_moves;
      const double lean_deg = 10.0 + 10.0 * std::sin(pi * share);
      const double depth_mm = 0.15 + 0.45 * std::sin(pi * share);
      const std::string place = fmt::format("X{:.3f} Y{:.3f}", way * hollow_half_mm * (2.0 * share - 1.0), y_mm);
      if (i == 0) out += fmt::format("G0 {} Z4.000 A{:.3f} C0.000\n", place, -lean_deg);
      out += fmt::format("G1 {} Z{:.3f} A{:.3f} C0.000 F{}\n", place, -depth_mm, -lean_deg, i == 0 ? 300 : 900);
    }
    out += fmt::format("G0 Y{:.3f} Z4.000\n", y_mm - 4.15 * std::tan(rad(10.0)));
  }
  return out + "M2\n";
}

std::string hollow_forces() {
  return R"([tool]
kind = "ball-end"
diameter_mm = 8
teeth = 2
helix_deg = 30
)" + aluminium() +
         R"(
[stock]
kind = "box"
min_mm = [-24, -10, -6]
max_mm = [24, 10, 0]
dexel_mm = 0.2
)";
}

}  // namespace robomill::examples
