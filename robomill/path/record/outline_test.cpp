#include "robomill/path/record/outline.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "robomill/base/random.hpp"

namespace robomill::path {
namespace outline_test {

TEST(Outline, FindsTheSharpestCorners) {
  program::Program program;
  const auto go = [&](double x, double y, double z = 0.0) {
    program::Block block;
    block.line = program.blocks.size() + 1;
    block.end.tip_m = Eigen::Vector3d(x, y, z);
    program.blocks.push_back(block);
  };
  go(0.1, 0.0);
  go(0.2, 0.03);  // a little
  go(0.2, 0.1);   // nearly a right angle
  program.blocks.push_back({.kind = program::Block::Kind::dwell, .line = 4, .end = program.blocks.back().end});
  go(0.2, 0.0);  // back
  go(0.2, 0.1);  // … and forth, to where there was one before
  go(0.3, 0.1);  // a right angle there
  program::ProgramSource source(program);
  const ProgramOutline found = outline(source, 1e-3, 4);
  EXPECT_EQ(found.blocks, 7U);
  ASSERT_EQ(found.corners.size(), 4U);
  EXPECT_EQ(found.corners[0].line, 1U);
  EXPECT_EQ(found.corners[1].line, 2U);
  EXPECT_EQ(found.corners[2].line, 3U) << "of two at one place the sharper";
  EXPECT_EQ(found.corners[3].line, 5U);
  EXPECT_NEAR(found.corners[2].turn_rad, std::numbers::pi, 1e-12);
  for (const ProgramCorner& corner : found.corners) {
    EXPECT_TRUE((corner.plane * corner.plane.transpose()).isIdentity(1e-12));
    EXPECT_GE(corner.vertices_m.row(1).minCoeff(), -0.1);
    const Eigen::VectorXd from = corner.vertices_m.colwise().norm();
    EXPECT_EQ(from.minCoeff(), 0.0) << "the corner itself is among its vertices";
  }
  EXPECT_EQ(found.path_m.cols(), 7);
  // Read to its end, and ready to be read again.
  program::Block first;
  ASSERT_TRUE(source.next(first));
  EXPECT_EQ(first.line, 1U);
}

// Twenty reversals do not hide the one right angle.
TEST(Outline, ShowsCornersOfEachKind) {
  program::Program program;
  for (int i = 0; i < 20; ++i) {
    program::Block block;
    block.line = static_cast<std::size_t>(i + 1);
    block.end.tip_m = Eigen::Vector3d(i % 2 == 0 ? 0.1 : 0.0, 1e-3 * i, 0.0);
    program.blocks.push_back(block);
  }
  program.blocks.push_back({.line = 21, .end = {.tip_m = Eigen::Vector3d(0.0, 0.1, 0.0)}});
  program.blocks.push_back({.line = 22, .end = {.tip_m = Eigen::Vector3d(0.002, 0.1, 0.0)}});
  program::ProgramSource source(program);
  const ProgramOutline found = outline(source, 2e-5);
  ASSERT_EQ(found.corners.size(), 6U);
  EXPECT_EQ(found.corners.back().line, 21U);
  EXPECT_NEAR(found.corners.back().turn_rad, std::numbers::pi / 2.0, 1e-9);
}

TEST(Outline, KeepsALongProgramShort) {
  program::Program program;
  Random random(2);
  for (int i = 0; i < 50000; ++i) {
    program::Block block;
    block.line = static_cast<std::size_t>(i + 1);
    block.end.tip_m = Eigen::Vector3d(1e-4 * i, 1e-4 * random.normal(), 0.0);
    program.blocks.push_back(block);
  }
  program::ProgramSource source(program);
  const ProgramOutline found = outline(source, 2e-5);
  EXPECT_EQ(found.blocks, 50000U);
  EXPECT_GE(found.path_m.cols(), 2000);
  EXPECT_LE(found.path_m.cols(), 4001);
  EXPECT_EQ(found.path_m.col(found.path_m.cols() - 1), program.blocks.back().end.tip_m);
  EXPECT_EQ(found.corners.size(), 6U);
}

TEST(Outline, OfNoMoveHasOnePoint) {
  const program::Program program;
  program::ProgramSource source(program);
  const ProgramOutline found = outline(source, 2e-5);
  EXPECT_EQ(found.path_m.cols(), 1);
  EXPECT_TRUE(found.corners.empty());
}

}  // namespace outline_test
}  // namespace robomill::path
