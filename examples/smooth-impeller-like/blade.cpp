#include "examples/smooth-impeller-like/blade.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

namespace robomill::examples {
namespace {

constexpr double feed_mm_per_min = 1800.0;
constexpr double clearance_mm = 15.0;
constexpr double deg = std::numbers::pi / 180.0;

Eigen::Vector3d around(double radius_mm, double angle_rad, double z_mm) {
  return {radius_mm * std::cos(angle_rad), radius_mm * std::sin(angle_rad), z_mm};
}

/// The blade is ruled: straight lines from the hub to the shroud, from the inlet (s = 0) to the outlet (s = 1).
Eigen::Vector3d hub_mm(double s) {
  return around(14.0 + 26.0 * std::pow(s, 1.6), 1.0 * std::pow(s, 1.1), 28.0 * std::pow(1.0 - s, 1.4));
}
Eigen::Vector3d shroud_mm(double s) {
  return around(23.0 + 20.0 * std::pow(s, 1.4), 1.0 * std::pow(s, 1.1) + 0.25 * (1.0 - s),
                34.0 * std::pow(1.0 - s, 1.3) + 8.0 * s);
}

struct Pose {
  Eigen::Vector3d tip_mm, axis;
};

/// The tool lies along the rulings.
Pose pose(double s, double height) {
  const Eigen::Vector3d hub = hub_mm(s);
  const Eigen::Vector3d across = shroud_mm(s) - hub;
  return {.tip_mm = hub + height * across, .axis = across.normalized()};
}

/// A block with the angles of an xyzac-trt table: (i, j, k) = (sin C sin A, cos C sin A, cos A), A <= 0, C without
/// jumps.
class Writer {
 public:
  void move(const char* code, const Pose& pose, const std::string& more = {}) {
    const double a = -std::acos(pose.axis.z());
    double c = std::atan2(-pose.axis.x(), -pose.axis.y());
    c += 2.0 * std::numbers::pi * std::round((c_rad_ - c) / (2.0 * std::numbers::pi));
    c_rad_ = c;
    text_ += fmt::format("{} X{:.3f} Y{:.3f} Z{:.3f} A{:.3f} C{:.3f}{}\n", code, pose.tip_mm.x(), pose.tip_mm.y(),
                         pose.tip_mm.z(), a / deg, c / deg, more);
  }
  void line(const char* text) { (text_ += text) += '\n'; }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  double c_rad_ = 0.0;
  std::string text_;
};

Pose away(Pose pose) {
  pose.tip_mm += clearance_mm * pose.axis;
  return pose;
}

}  // namespace

std::string blade_program(int passes, int moves_a_pass) {
  Writer out;
  out.line("(one blade of an invented impeller, finished along its rulings; xyzac-trt, tip positions)");
  out.line("G21 G90 G94 M428");
  out.line("M8");
  out.line("S12000 M3");
  const std::string feed = fmt::format(" F{:.0f}", feed_mm_per_min);
  for (int pass = 0; pass < passes; ++pass) {
    const double height = 0.95 - 0.9 * pass / (passes - 1);
    for (int i = 0; i <= moves_a_pass; ++i) {
      const double share = static_cast<double>(i) / moves_a_pass;
      const Pose at = pose(pass % 2 == 0 ? share : 1.0 - share, height);
      const bool first = pass == 0 && i == 0;
      if (first) out.move("G0", away(at));
      out.move("G1", at, first ? feed : std::string());
      if (pass == passes - 1 && i == moves_a_pass) out.move("G0", away(at));
    }
  }
  out.line("M30");
  return out.text();
}

}  // namespace robomill::examples
