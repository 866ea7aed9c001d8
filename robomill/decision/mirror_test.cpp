#include "robomill/decision/mirror.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "robomill/base/random.hpp"
#include "testing/support.hpp"

namespace robomill::decision {
namespace mirror_test {

using Eigen::Vector3d;

constexpr double um = 1e-6;

std::vector<WallPlace> wall(const Vector3d& normal, double error_m, int places = 5) {
  return std::vector<WallPlace>(static_cast<std::size_t>(places),
                                {.normal = normal.normalized(), .error_m = error_m, .width_m = 1e-3});
}

MirrorBlock block(const std::vector<WallPlace>& places, double length_m = 2e-3) {
  return {.feed = true, .length_m = length_m, .condition = condition_of(places)};
}

// Put back into the sum: no offset nearby makes it smaller.
TEST(Mirror, TheOffsetMinimisesTheSum) {
  for (int seed = 0; seed < 200; ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    std::vector<WallPlace> places;
    for (int k = 0; k < 8; ++k) {
      const double x = random.normal();
      const double y = random.normal();
      const Vector3d drawn = Vector3d(x, y, random.normal()).normalized();
      places.push_back({.normal = k < 3 ? Vector3d(Vector3d::Unit(k)) : drawn,  // they span all directions
                        .error_m = 20.0 * um * random.normal(),
                        .width_m = k < 3 ? 1.0 : random.uniform(0.1, 0.3)});
    }
    const MirrorCondition condition = condition_of(places);
    const Vector3d offset = condition.offset_m();
    const double least = condition.rms_m(offset);
    double sum = 0.0;
    for (const WallPlace& place : places) sum += place.width_m * std::pow(place.error_m - place.normal.dot(offset), 2);
    EXPECT_NEAR(least, std::sqrt(sum / condition.width_m), 1e-9 * 20.0 * um);
    for (int k = 0; k < 3; ++k) {
      for (const double by : {-um, um}) {
        EXPECT_LE(least, condition.rms_m(offset + by * Vector3d::Unit(k)) + 1e-12) << seed;
      }
    }
  }
}

TEST(Mirror, OneWallIsOffsetAlongItsNormal) {
  const Vector3d normal = Vector3d(1.0, 2.0, -0.5).normalized();
  const Vector3d offset = condition_of(wall(normal, 30.0 * um)).offset_m();
  EXPECT_LT((offset - 30.0 * um * normal).norm(), 1e-12);
}

TEST(Mirror, ACornerGetsWhatBothWallsAskFor) {
  const std::vector<MirrorBlock> path = {block(wall(Vector3d::UnitY(), 30.0 * um)),
                                         block(wall(Vector3d::UnitX(), -10.0 * um))};
  const MirrorOffsets offsets = mirror_offsets(path, {});
  EXPECT_LT((offsets.point_m[0] - Vector3d(0.0, 30.0 * um, 0.0)).norm(), 1e-12);
  EXPECT_LT((offsets.point_m[1] - Vector3d(-10.0 * um, 30.0 * um, 0.0)).norm(), 1e-12);
  EXPECT_LT((offsets.point_m[2] - Vector3d(-10.0 * um, 0.0, 0.0)).norm(), 1e-12);
}

// Where a pass bends a little, differing errors must not throw the point along the pass.
TEST(Mirror, ASmoothPassGetsTheMeanOfItsNeighbours) {
  const double turn = 0.05;
  const std::vector<MirrorBlock> path = {block(wall(Vector3d::UnitY(), 30.0 * um)),
                                         block(wall({std::sin(turn), std::cos(turn), 0.0}, 34.0 * um))};
  const Vector3d middle = mirror_offsets(path, {}).point_m[1];
  const Vector3d normal(std::sin(0.5 * turn), std::cos(0.5 * turn), 0.0);
  EXPECT_NEAR(middle.dot(normal), 32.0 * um, 0.05 * um);
  EXPECT_LT((middle - middle.dot(normal) * normal).norm(), 1e-9 * um);
}

TEST(Mirror, WallsThatFaceEachOther) {
  std::vector<WallPlace> shifted = wall(Vector3d::UnitY(), 20.0 * um);
  for (const WallPlace& place : wall(-Vector3d::UnitY(), -20.0 * um)) shifted.push_back(place);
  EXPECT_FALSE(opposite_walls(shifted));  // the slot stands beside its place: one offset suits both
  EXPECT_LT((condition_of(shifted).offset_m() - Vector3d(0.0, 20.0 * um, 0.0)).norm(), 1e-12);
  std::vector<WallPlace> narrow = wall(Vector3d::UnitY(), 20.0 * um);
  for (const WallPlace& place : wall(-Vector3d::UnitY(), 20.0 * um)) narrow.push_back(place);
  EXPECT_TRUE(opposite_walls(narrow));
  EXPECT_FALSE(opposite_walls(wall(Vector3d::UnitY(), 20.0 * um)));
  EXPECT_FALSE(opposite_walls({}));
}

TEST(Mirror, LongOffsetsAreCutOff) {
  const std::vector<MirrorBlock> path = {block(wall(Vector3d::UnitY(), 300.0 * um))};
  const MirrorOffsets offsets = mirror_offsets(path, {.max_offset_m = 100.0 * um});
  for (const Vector3d& point : offsets.point_m) EXPECT_NEAR(point.norm(), 100.0 * um, 1e-12);
  EXPECT_TRUE(offsets.bounded[0] && offsets.bounded[1]);
}

TEST(Mirror, AnOffsetDiesAwayUpToTheNextRapidMove) {
  const MirrorBlock rough = {.feed = true, .length_m = 2e-3};
  const MirrorBlock rapid = {.feed = false, .length_m = 2e-3};
  const std::vector<MirrorBlock> path = {rapid, rough, block(wall(Vector3d::UnitY(), 40.0 * um)), rough, rough, rough,
                                         rapid, rough};
  const MirrorOffsets offsets = mirror_offsets(path, {.blend_m = 5e-3});
  const double expected[] = {0.0, 24.0, 40.0, 40.0, 24.0, 8.0, 0.0, 0.0, 0.0};
  for (std::size_t i = 0; i < offsets.point_m.size(); ++i) {
    EXPECT_NEAR(offsets.point_m[i].y(), expected[i] * um, 1e-12) << i;
  }
  const std::vector<bool> blended = {false, true, false, true, true, true, false, false};
  EXPECT_EQ(offsets.blended, blended);
  for (const Vector3d& point : mirror_offsets({}, {}).point_m) EXPECT_TRUE(point.isZero());
}

TEST(Mirror, BadOptionsAreRejected) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double bad : {0.0, -1.0, nan}) {
    EXPECT_EQ(test::field_of([&] { static_cast<void>(mirror_offsets({}, {.max_offset_m = bad})); }), "max_offset_m");
  }
  EXPECT_EQ(test::field_of([&] { static_cast<void>(mirror_offsets({}, {.blend_m = nan})); }), "blend_m");
}

}  // namespace mirror_test
}  // namespace robomill::decision
