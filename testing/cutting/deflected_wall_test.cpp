// The judge of walls against closed forms and the force kernel.
#include "testing/cutting/deflected_wall.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "robomill/cutting/engagement.hpp"
#include "testing/cutting/cutters.hpp"

namespace robomill::cutting::testing {
namespace deflected_wall_test {

using std::numbers::pi;

constexpr double rpm = 2.0 * pi / 60.0;

/// A cutter of 12 mm beside a wall of 4 mm; one move along +x from before the material to behind it.
struct Case {
  program::Program program;
  WallCut cut;
};

Case wall_case(double side, int teeth, double helix_rad, double radial_m, double feed_per_tooth_m) {
  Case out;
  out.cut.cutter = flat_end(12.0 * mm, teeth, helix_rad);
  out.cut.coefficients = {.tangential_n_per_m2 = {800e6},
                          .radial_n_per_m2 = {300e6},
                          .axial_n_per_m2 = {100e6},
                          .tangential_edge_n_per_m = {10e3},
                          .radial_edge_n_per_m = {15e3}};
  out.cut.spindle_speed_rad_per_s = 6000.0 * rpm;
  out.cut.side = side;
  out.cut.stock_y_m = -side * radial_m;
  out.cut.to_x_m = 16.0 * mm;
  out.cut.top_m = 4.0 * mm;
  out.cut.slices = 8;
  const double tip_y_m = -side * 6.0 * mm;
  out.program.start = {.tip_m = {-8.0 * mm, tip_y_m, 0.0}};
  program::Block move;
  move.end = {.tip_m = {14.0 * mm, tip_y_m, 0.0}};
  move.duration_s = 22.0 * mm / (feed_per_tooth_m * teeth * 100.0);
  out.program.blocks = {move};
  return out;
}

TEST(DeflectedWall, AStiffToolLeavesNoError) {
  for (const double side : {1.0, -1.0}) {
    const Case c = wall_case(side, 4, 0.5, 1.0 * mm, 0.1 * mm);
    const Wall wall = cut_wall(c.program, c.cut, {8.0 * mm, 10.0 * mm});
    const Wall::Summary error = wall.between(4.0 * mm, 10.0 * mm);
    EXPECT_LT(std::abs(error.worst_m), 2e-8) << side;
  }
}

// The force of the rays' chips against the force kernel's closed form: whole revolutions.
TEST(DeflectedWall, TheMeanForceIsThatOfTheForceKernel) {
  for (const double side : {1.0, -1.0}) {
    const Case c = wall_case(side, 4, 0.5, 1.0 * mm, 0.1 * mm);
    const Wall wall = cut_wall(c.program, c.cut, {6.0 * mm, 10.0 * mm});  // ten revolutions
    const Cut cut = {.axial_depth_m = 4.0 * mm,
                     .radial_depth_m = 1.0 * mm,
                     .direction = side > 0.0 ? MillingDirection::up : MillingDirection::down};
    const CuttingForce force =
        cutting_force(c.cut.cutter, engage(c.cut.cutter, cut), c.cut.coefficients,
                      {.feed_per_tooth_m = 0.1 * mm, .spindle_speed_rad_per_s = c.cut.spindle_speed_rad_per_s});
    // The kernel's teeth run on circles: edges do not touch the ridge that lies before the wall's foot (f/D of 34°).
    EXPECT_LT((wall.mean_force_n - force.mean_n).norm(), 0.02 * force.mean_n.norm())
        << side << " " << wall.mean_force_n.transpose() << " / " << force.mean_n.transpose();
  }
}

// Straight teeth, one of which stands at 45° (up) or 135° (down) as another finishes the wall at 0° or 180°. A springy
// tip is then C F from its place, F that of a chip f sin 45° over the whole height.
TEST(DeflectedWall, AStaticComplianceLeavesTheClosedForm) {
  for (const double side : {1.0, -1.0}) {
    const double radial_m = 6.0 * mm * (1.0 - std::cos(65.0 * degree));
    Case c = wall_case(side, 8, 0.0, radial_m, 0.05 * mm);
    c.cut.structure = {
        {.frequency_hz = 40e3, .damping_ratio = 0.9, .stiffness_n_per_m = 2e7},
        {.frequency_hz = 40e3, .damping_ratio = 0.9, .stiffness_n_per_m = 3e7, .direction = Eigen::Vector3d::UnitX()}};
    c.cut.coefficients.radial_edge_n_per_m.clear();  // it begins or ends just as a tooth stands at the wall
    c.cut.steps_per_revolution = 3600;
    c.cut.slices = 2;  // straight teeth: all heights are alike
    c.cut.ray_m = 2e-6;
    const Wall wall = cut_wall(c.program, c.cut, {6.0 * mm, 10.0 * mm});
    const double angle = side > 0.0 ? 45.0 * degree : 135.0 * degree;
    const double chip_m = 0.05 * mm * std::sin(angle);
    const double tangential_n = 4.0 * mm * (800e6 * chip_m + 10e3);
    const double radial_n = 4.0 * mm * 300e6 * chip_m;
    const double force_y_n = tangential_n * std::sin(angle) - radial_n * std::cos(angle);
    const double expected_m = -side * force_y_n / 2e7;
    const Wall::Summary error = wall.between(5.0 * mm, 9.0 * mm);
    EXPECT_NEAR(error.mean_m, expected_m, 0.03 * std::abs(expected_m)) << side;
    EXPECT_LT(std::abs(error.worst_m - error.mean_m), 0.1 * std::abs(error.mean_m)) << side;
  }
}

// A force that pushes one way takes the tool to the end of its play: half the backlash comes on top.
TEST(DeflectedWall, BacklashAddsHalfOfItself) {
  Case c = wall_case(-1.0, 4, 45.0 * degree, 1.0 * mm, 0.1 * mm);
  c.cut.top_m = 12.0 * mm * pi / 4.0;  // a tooth follows where the one before it ends: the force is nearly constant
  c.cut.slices = 24;
  c.cut.structure = {{.frequency_hz = 40.0, .damping_ratio = 0.3, .stiffness_n_per_m = 1e7}};
  const Wall::Summary tight = cut_wall(c.program, c.cut, {6.0 * mm, 10.0 * mm}).between(7.0 * mm, 10.0 * mm);
  c.cut.structure.front().backlash_m = 10e-6;
  const Wall::Summary loose = cut_wall(c.program, c.cut, {6.0 * mm, 10.0 * mm}).between(7.0 * mm, 10.0 * mm);
  EXPECT_GT(std::abs(tight.mean_m), 5e-6);
  EXPECT_NEAR(loose.mean_m - tight.mean_m, std::copysign(5e-6, tight.mean_m), 0.6e-6);
}

}  // namespace deflected_wall_test
}  // namespace robomill::cutting::testing
