#include "robomill/cutting/program/local.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "testing/support.hpp"

namespace robomill::cutting {
namespace program_engagement_local_test {

using Eigen::Vector3d;
using program::Block;
using program::Program;

/// Passes along x on a cylinder about x of the radius (0: a plane), `step` apart, there and back, in blocks of 1 mm.
Program passes(double radius, double step, bool zigzag) {
  Program program;
  const auto point = [&](int pass, double x) {
    const double s = pass * step;
    const double y = radius > 0.0 ? radius * std::sin(s / radius) : s;
    const double z = radius > 0.0 ? radius * std::cos(s / radius) - radius : 0.0;
    return Vector3d(x, y, z);
  };
  const auto axis = [&](int pass) {
    return radius > 0.0 ? Vector3d(0.0, std::sin(pass * step / radius), std::cos(pass * step / radius))
                        : Vector3d(0.0, 0.0, 1.0);
  };
  program.start = {.tip_m = point(0, 0.0), .axis = axis(0)};
  for (int pass = 0; pass < 8; ++pass) {
    const bool back = zigzag && pass % 2 == 1;
    for (int i = 0; i <= 20; ++i) {
      const double x = 1e-3 * (back ? 20 - i : i);
      if (pass == 0 && i == 0) continue;
      const bool rapid = i == 0 && !zigzag;
      program.blocks.push_back({.kind = rapid ? Block::Kind::rapid : Block::Kind::feed,
                                .line = 0,
                                .end = {.tip_m = point(pass, x), .axis = axis(pass)},
                                .duration_s = rapid ? 0.0 : 0.1});
    }
  }
  return program;
}

/// A block in the middle of a pass.
std::size_t middle_of(int pass) {
  return static_cast<std::size_t>(21 * pass + 9);
}

TEST(LocalCuts, PassesOnAPlane) {
  for (const bool zigzag : {false, true}) {
    const Program program = passes(0.0, 0.5e-3, zigzag);
    const LocalCuts cuts(program, 6e-3);
    EXPECT_EQ(cuts.at(middle_of(0)).neighbour, LocalCut::Neighbour::none);
    for (int pass = 1; pass < 8; ++pass) {
      const LocalCut cut = cuts.at(middle_of(pass));
      const bool back = zigzag && pass % 2 == 1;
      EXPECT_EQ(cut.neighbour, back ? LocalCut::Neighbour::left : LocalCut::Neighbour::right) << pass;
      EXPECT_NEAR(cut.stepover_m, 0.5e-3, 1e-12);
      EXPECT_NEAR(cut.curvature_per_m, 0.0, 1e-9);
      EXPECT_NEAR(cut.slope_rad, 0.0, 1e-12);
    }
  }
}

TEST(LocalCuts, PassesOnACylinder) {
  const Program program = passes(20e-3, 0.5e-3, false);
  const LocalCuts cuts(program, 6e-3);
  for (int pass = 1; pass < 7; ++pass) {
    const LocalCut cut = cuts.at(middle_of(pass));
    EXPECT_EQ(cut.neighbour, LocalCut::Neighbour::right);
    EXPECT_NEAR(cut.stepover_m, 40e-3 * std::sin(0.5 * 0.5 / 20.0), 1e-12);
    EXPECT_NEAR(cut.curvature_per_m, 50.0, 0.05);
    EXPECT_NEAR(cut.slope_rad, 0.0, 1e-9);
  }
  // Beside the last pass there is one neighbour alone: a plane that leans.
  const LocalCut last = cuts.at(middle_of(7));
  EXPECT_EQ(last.curvature_per_m, 0.0);
  EXPECT_NEAR(last.slope_rad, 0.5 * 0.5 / 20.0, 1e-9);
}

TEST(LocalCuts, PassesOutOfReachAreNone) {
  const Program program = passes(0.0, 5e-3, false);
  EXPECT_EQ(LocalCuts(program, 4e-3).at(middle_of(3)).neighbour, LocalCut::Neighbour::none);
  EXPECT_NEAR(LocalCuts(program, 6e-3).at(middle_of(3)).stepover_m, 5e-3, 1e-12);
  EXPECT_EQ(LocalCuts(program, 6e-3).at(middle_of(3) - 10).neighbour, LocalCut::Neighbour::none) << "a rapid move";
  EXPECT_EQ(test::field_of([&] { LocalCuts(program, 0.0); }), "reach_m");
}

}  // namespace program_engagement_local_test
}  // namespace robomill::cutting
