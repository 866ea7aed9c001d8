#include "robomill/cutting/program_engagement.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <numbers>
#include <vector>

#include "robomill/base/parallel.hpp"
#include "robomill/base/random.hpp"
#include "robomill/cutting/engagement.hpp"
#include "testing/support.hpp"

namespace robomill::cutting {
namespace program_engagement_test {

using Eigen::Vector3d;
using program::Block;
using program::Pose;
using program::Program;
using std::numbers::pi;

Cutter end_mill(CutterKind kind, double radius_m) {
  Cutter cutter;
  cutter.kind = kind;
  cutter.mill = {.teeth = 2, .diameter_m = 2.0 * radius_m, .helix_rad = 0.5};
  return cutter;
}

Stock box(const Vector3d& low, const Vector3d& high) {
  Stock stock;
  stock.min_m = low;
  stock.max_m = high;
  return stock;
}

/// A ball pass along x at depth h with its neighbour at -l, cut up to x = 0 and looked at there.
struct Pass {
  double radius_m, depth_m, stepover_m, lead_rad, tilt_rad;
};

Vector3d axis_of(const Pass& pass) {
  return feed_from_tool(pass.lead_rad, pass.tilt_rad) * Vector3d::UnitZ();
}

Pose pose_of(const Pass& pass, double x, double y) {
  return {.tip_m = Vector3d(x, y, pass.radius_m) - pass.radius_m * axis_of(pass), .axis = axis_of(pass)};
}

PoseEngagement look_at(const Pass& pass, double dexel, const WalkOptions& options) {
  const double reach = std::sqrt(pass.depth_m * (2.0 * pass.radius_m - pass.depth_m));
  Workpiece part(
      box({-0.7 * reach, -reach - pass.stepover_m - 0.3e-3, -0.3e-3}, {reach + 1e-3, reach + 0.3e-3, pass.depth_m}),
      dexel);
  const Cutter cutter = end_mill(CutterKind::ball_end, pass.radius_m);
  const Profile profile(cutter);
  const double far = 3.0 * pass.radius_m;
  part.remove(profile, pose_of(pass, -far, -pass.stepover_m), pose_of(pass, far, -pass.stepover_m));
  part.remove(profile, pose_of(pass, -far, 0.0), pose_of(pass, -0.3e-3, 0.0));
  return EngagementFinder(cutter, part.dexel_m(), options)
      .at(part, pose_of(pass, 0.0, 0.0), {.tip_m_per_s = {0.02, 0.0, 0.0}}, 0.0);
}

/// Whether the point of ring and angle cuts, by the conditions about the ball's centre, whose directions are those of
/// W.
bool cuts(const Pass& pass, const Vector3d& normal) {
  const double r = pass.radius_m;
  const Vector3d p = r * normal;
  return p.z() <= pass.depth_m - r && std::pow(p.y() + pass.stepover_m, 2) + p.z() * p.z() >= r * r && normal.x() > 0.0;
}

/// Area where arcs and conditions differ, over rings much thinner than those of the finder.
double mismatch_m2(const Pass& pass, const PoseEngagement& cut) {
  const Engagement& e = cut.engagement;
  double area = 0.0;
  constexpr int rings = 400;
  constexpr int angles = 2000;
  for (int ring = 0; ring < rings; ++ring) {
    // The lowest 2 R of the envelope are the ball, whatever leans; above its equator nothing of these passes cuts.
    const double position = 0.5 * pi * (ring + 0.5) / rings;
    std::span<const Arc> arcs;
    for (std::size_t i = 0; i < e.slices.size(); ++i) {
      if (std::abs(position - e.slices[i].position_rad) * pass.radius_m < 0.5 * e.slices[i].width_m) arcs = e.of(i);
    }
    const double sine = std::sin(position);
    for (int k = 0; k < angles; ++k) {
      const double phi = 2.0 * pi * (k + 0.5) / angles;
      const Vector3d normal_t(sine * std::sin(phi), sine * std::cos(phi), -std::cos(position));
      const bool in = std::ranges::any_of(arcs, [&](const Arc& arc) {
        return (phi > arc.entry_rad && phi < arc.exit_rad) || phi + 2.0 * pi < arc.exit_rad;
      });
      if (in == cuts(pass, cut.work_from_feed * (e.feed_from_tool * normal_t))) continue;
      area += pass.radius_m * sine * pass.radius_m * (0.5 * pi / rings) * (2.0 * pi / angles);
    }
  }
  return area;
}

constexpr std::array<Pass, 5> passes = {{{3e-3, 1e-3, 0.5e-3, 0.0, 0.0},
                                         {3e-3, 1.2e-3, 1e-3, 0.0, 0.0},
                                         {4e-3, 1.2e-3, 1e-3, 0.0, 0.0},
                                         {3e-3, 1e-3, 0.5e-3, 0.3, 0.0},
                                         {3e-3, 1e-3, 0.5e-3, -0.25, 0.35}}};

// Areas of patch and chip from an independent numerical integration; the dexel is a twentieth of the depth.
TEST(EngagementFinder, BallPassHasTheIntegratedAreas) {
  constexpr std::array<double, 3> patch_mm2 = {2.7333, 4.6101, 5.6260};
  constexpr std::array<double, 3> chip_mm2 = {0.49826, 1.18605, 1.18956};
  for (std::size_t i = 0; i < 3; ++i) {
    const PoseEngagement cut = look_at(passes[i], 0.05e-3, {.ring_width_m = 0.01e-3, .angle_step_rad = 0.01});
    EXPECT_NEAR(patch_area_m2(cut.engagement), patch_mm2[i] * 1e-6, 4e-3 * patch_mm2[i] * 1e-6);
    EXPECT_NEAR(chip_area_m2(cut.engagement), chip_mm2[i] * 1e-6, 4e-3 * chip_mm2[i] * 1e-6);
    EXPECT_NEAR(cut.axial_depth_m,
                passes[i].depth_m - 0.25 * std::pow(passes[i].stepover_m, 2) / 2.0 / passes[i].radius_m, 0.05e-3);
    EXPECT_NEAR(cut.feed_speed_m_per_s, 0.02, 1e-15);
  }
}

// Against the conditions themselves, tilted too: what differs is a seam narrower than the dexel along the patch's edge.
TEST(EngagementFinder, BallPassAgreesWithItsConditionsWithinTheDexel) {
  constexpr double seam = 0.2;
  for (const Pass& pass : passes) {
    for (const double dexel : {0.25e-3, 0.1e-3}) {
      const PoseEngagement cut = look_at(pass, dexel, {});
      const double perimeter =
          2.0 * (pass.stepover_m + std::sqrt(pass.depth_m * (2.0 * pass.radius_m - pass.depth_m)) + pass.depth_m);
      EXPECT_LT(mismatch_m2(pass, cut), seam * dexel * perimeter) << pass.lead_rad << " " << dexel;
      const Vector3d x = cut.work_from_feed.col(0);
      EXPECT_LT((x - Vector3d::UnitX()).norm(), 1e-12);
      // T maps through F to the axis in W.
      EXPECT_LT((cut.work_from_feed * cut.engagement.feed_from_tool.col(2) - axis_of(pass)).norm(), 1e-12);
      EXPECT_LT(std::abs(cut.engagement.feed_from_tool(1, 2)), 1e-12) << "T leads but does not tilt in F";
    }
  }
}

// Entry and exit of a flat end mill, up and down, to a fiftieth of the dexel.
TEST(EngagementFinder, FlatEndMillEntersAndLeavesAtTheImmersion) {
  const Cutter cutter = end_mill(CutterKind::flat_end, 5e-3);
  const Profile profile(cutter);
  for (const double radial : {2e-3, 5e-3, 7.5e-3}) {
    for (const MillingDirection direction : {MillingDirection::up, MillingDirection::down}) {
      const Immersion expected = immersion(direction, radial, 10e-3);
      // φ from +y clockwise, feed along +x: up-milling has its material at +y.
      const double side = direction == MillingDirection::up ? 1.0 : -1.0;
      const double wall = side * (5e-3 - radial);
      Workpiece part(
          side > 0.0 ? box({-0.01, wall, 0.0}, {0.02, 0.012, 0.004}) : box({-0.01, -0.012, 0.0}, {0.02, wall, 0.004}),
          0.2e-3);
      const Pose from = {.tip_m = {-0.02, 0.0, 0.001}};
      const Pose now = {.tip_m = {0.002, 0.0, 0.001}};
      part.remove(profile, from, {.tip_m = {0.001, 0.0, 0.001}});
      const EngagementFinder finder(cutter, part.dexel_m(), {});
      const PoseEngagement cut = finder.at(part, now, {.tip_m_per_s = {1.0, 0.0, 0.0}}, 0.0);
      std::size_t sides = 0;
      for (std::size_t i = 0; i < cut.engagement.slices.size(); ++i) {
        const EdgeSlice& slice = cut.engagement.slices[i];
        if (slice.position_rad < 1.0) continue;  // the bottom slides
        ++sides;
        ASSERT_EQ(cut.engagement.of(i).size(), 1U);
        EXPECT_NEAR(cut.engagement.of(i)[0].entry_rad, expected.entry_rad, 0.02 * 0.2 / 5.0 + 1e-9) << radial;
        EXPECT_NEAR(cut.engagement.of(i)[0].exit_rad, expected.exit_rad, 0.02 * 0.2 / 5.0 + 1e-9) << radial;
      }
      EXPECT_GT(sides, 10U);
      EXPECT_NEAR(cut.axial_depth_m, 3e-3, 0.2e-3);
      const double across = direction == MillingDirection::up ? radial : radial;
      EXPECT_NEAR(cut.radial_depth_m, across, 0.02e-3) << radial;
    }
  }
}

/// An upright ball of 3 mm in a slab whose top is z = 0, along any direction, its rays standing anywhere.
struct Straight {
  Cut cut;
  double most_bias, most_scatter;  ///< of the chip's area, relative
};

PoseEngagement look_at(const Straight& pass, double dexel, Random& random) {
  const double depth = pass.cut.axial_depth_m;
  Stock stock = box({-8e-3, -8e-3, -depth - 1e-3}, {8e-3, 8e-3, 0.0});
  for (double& low : stock.min_m) low -= random.uniform(0.0, 1e-3);
  Workpiece part(stock, dexel);
  const double heading = random.uniform(0.0, 2.0 * pi);
  const Vector3d x(std::cos(heading), std::sin(heading), 0.0);
  const Vector3d y(-x.y(), x.x(), 0.0);
  const Vector3d tip(0.0, 0.0, -depth);
  const Cutter cutter = end_mill(CutterKind::ball_end, 3e-3);
  const Profile profile(cutter);
  if (pass.cut.direction != MillingDirection::slot) {
    const double side = pass.cut.direction == MillingDirection::down ? 1.0 : -1.0;
    const Vector3d beside = tip + side * pass.cut.radial_depth_m * y;
    part.remove(profile, {.tip_m = beside - 0.03 * x}, {.tip_m = beside + 0.03 * x});
  }
  part.remove(profile, {.tip_m = tip - 0.03 * x}, {.tip_m = tip - 1.5e-3 * x});
  return EngagementFinder(cutter, part.dexel_m(), {}).at(part, {.tip_m = tip}, {.tip_m_per_s = 0.02 * x}, 0.0);
}

// Two ways: rays of the default spacing, and the analytic engagement. Rings end where the cut ends, so that a depth
// between two of them is no deeper.
TEST(EngagementFinder, DefaultDexelsAreNoDeeperThanTheAnalyticCut) {
  const Straight cases[] = {
      {{.axial_depth_m = 0.5e-3, .direction = MillingDirection::slot}, 0.008, 0.003},
      {{.axial_depth_m = 1e-3, .direction = MillingDirection::slot}, 0.004, 0.001},
      {{.axial_depth_m = 2e-3, .direction = MillingDirection::slot}, 0.002, 0.001},
      {{.axial_depth_m = 1e-3, .radial_depth_m = 0.5e-3, .direction = MillingDirection::down}, 0.01, 0.015},
      {{.axial_depth_m = 1e-3, .radial_depth_m = 0.5e-3, .direction = MillingDirection::up}, 0.01, 0.015},
      {{.axial_depth_m = 1.2e-3, .radial_depth_m = 1e-3, .direction = MillingDirection::up}, 0.005, 0.01},
      {{.axial_depth_m = 2e-3, .radial_depth_m = 1e-3, .direction = MillingDirection::down}, 0.005, 0.005}};
  constexpr int places = 20;
  for (const Straight& pass : cases) {
    Random random(7);
    const double expected = chip_area_m2(engage(end_mill(CutterKind::ball_end, 3e-3), pass.cut));
    Eigen::ArrayXd error(places);
    for (int i = 0; i < places; ++i) {
      const PoseEngagement cut = look_at(pass, 0.25e-3, random);
      error[i] = chip_area_m2(cut.engagement) / expected - 1.0;
      EXPECT_NEAR(cut.axial_depth_m, pass.cut.axial_depth_m, 0.01e-3);
    }
    const double bias = error.mean();
    EXPECT_LT(std::abs(bias), pass.most_bias) << pass.cut.axial_depth_m;
    EXPECT_LT(std::sqrt((error - bias).square().mean()), pass.most_scatter) << pass.cut.axial_depth_m;
  }
}

// Less deep than half a ring.
TEST(EngagementFinder, SeesACutThinnerThanItsRings) {
  const Cutter cutter = end_mill(CutterKind::flat_end, 5e-3);
  Workpiece part(box({0.0, -0.01, 0.0}, {0.02, 0.01, 0.004}), 0.25e-3);
  const Pose now = {.tip_m = {0.006, 0.0, 0.0039}};
  part.remove(Profile(cutter), {.tip_m = {-0.02, 0.0, 0.0039}}, {.tip_m = {0.003, 0.0, 0.0039}});
  const PoseEngagement cut =
      EngagementFinder(cutter, part.dexel_m(), {}).at(part, now, {.tip_m_per_s = {1.0, 0.0, 0.0}}, 0.0);
  EXPECT_NEAR(cut.axial_depth_m, 0.1e-3, 0.005e-3);
  EXPECT_NEAR(chip_area_m2(cut.engagement), 1e-6, 0.05e-6);
}

// A drill's bottom cuts all around.
TEST(EngagementFinder, PlungeCutsAllAround) {
  const Cutter cutter = end_mill(CutterKind::flat_end, 3e-3);
  Workpiece part(box({-0.01, -0.01, 0.0}, {0.01, 0.01, 0.01}), 0.2e-3);
  const EngagementFinder finder(cutter, part.dexel_m(), {});
  const PoseEngagement cut = finder.at(part, {.tip_m = {0.0, 0.0, 0.0095}}, {.tip_m_per_s = {0.0, 0.0, -0.01}}, 0.0);
  EXPECT_NEAR(chip_area_m2(cut.engagement), pi * 9e-6, 1e-3 * pi * 9e-6);
  EXPECT_NEAR(patch_area_m2(cut.engagement), pi * 9e-6, 1e-3 * pi * 9e-6);
  EXPECT_NEAR(cut.engagement.feed_from_tool(0, 2), -1.0, 1e-12);
}

TEST(EngagementFinder, FindsNothingInAir) {
  const Cutter cutter = end_mill(CutterKind::ball_end, 3e-3);
  const Workpiece part(box({0.0, 0.0, 0.0}, {0.01, 0.01, 0.01}), 0.2e-3);
  const EngagementFinder finder(cutter, part.dexel_m(), {});
  const PoseEngagement cut = finder.at(part, {.tip_m = {0.0, 0.0, 0.02}}, {.tip_m_per_s = {1.0, 0.0, 0.0}}, 0.0);
  EXPECT_TRUE(cut.engagement.empty());
  EXPECT_EQ(cut.axial_depth_m, 0.0);
  EXPECT_EQ(cut.radial_depth_m, 0.0);
}

/// A zigzag over a block of material whose axis leans this way and that.
Program zigzag() {
  Program program;
  program.start = {.tip_m = {-0.006, 0.0, 0.02}};
  const auto move = [&](Block::Kind kind, double x, double y, double z, const Vector3d& axis) {
    program.blocks.push_back({.kind = kind,
                              .line = program.blocks.size() + 2,
                              .end = {.tip_m = {x, y, z}, .axis = axis.normalized()},
                              .duration_s = kind == Block::Kind::feed ? 0.5 : 0.0,
                              .spindle_speed_rad_per_s = 1000.0});
  };
  move(Block::Kind::rapid, -0.006, 0.0, 0.0085, Vector3d::UnitZ());
  for (int pass = 0; pass < 4; ++pass) {
    const double y = 0.002 * pass;
    const double x = pass % 2 == 0 ? 0.026 : -0.006;
    move(Block::Kind::feed, 0.01, y, 0.008, Vector3d(0.2, 0.1 * pass, 1.0));
    move(Block::Kind::feed, x, y, 0.0085, Vector3d(-0.1, 0.2, 1.0));
    move(Block::Kind::feed, x, y + 0.002, 0.0085, Vector3d(-0.1, 0.2, 1.0));
  }
  move(Block::Kind::rapid, 0.01, 0.012, 0.005, Vector3d::UnitZ());
  return program;
}

struct Walked {
  std::vector<BlockEngagement> parts;
  std::vector<std::size_t> batches;
  Vector3d removed;
};

Walked walked(const Program& program, const Cutter& cutter, double dexel, const WalkOptions& options) {
  Workpiece part(box({0.0, -0.002, 0.0}, {0.02, 0.02, 0.01}), dexel);
  const Vector3d before = part.volumes_m3();
  Walked out;
  walk(program, cutter, part, options, [&](std::span<const BlockEngagement> batch) {
    out.batches.push_back(batch.size());
    out.parts.insert(out.parts.end(), batch.begin(), batch.end());
  });
  out.removed = before - part.volumes_m3();
  return out;
}

// The tool stands still where it has cut already.
TEST(Walk, DwellsCutNothing) {
  const Program program = zigzag();
  Program dwelling = program;
  dwelling.blocks.clear();
  for (const Block& block : program.blocks) {
    dwelling.blocks.push_back(block);
    dwelling.blocks.push_back(block);
    dwelling.blocks.back().kind = Block::Kind::dwell;
    dwelling.blocks.back().duration_s = 1.5;
  }
  const Walked plain = walked(program, end_mill(CutterKind::ball_end, 3e-3), 0.3e-3, {});
  const Walked with = walked(dwelling, end_mill(CutterKind::ball_end, 3e-3), 0.3e-3, {});
  EXPECT_EQ(plain.removed, with.removed);
  for (const BlockEngagement& part : with.parts) {
    if (dwelling.blocks[part.block].kind != Block::Kind::dwell) continue;
    EXPECT_TRUE(part.cut.engagement.empty());
    EXPECT_EQ(part.removed_volume_m3, 0.0) << part.block;
    EXPECT_FALSE(part.rapid_in_material || part.shank) << part.block;
  }
  EXPECT_EQ(with.parts.size(), plain.parts.size() + program.blocks.size());
}

// Chip area times speed and time, and volume, are two accounts of the same material.
TEST(Walk, ChipAreasAccountForTheVolume) {
  const Walked out =
      walked(zigzag(), end_mill(CutterKind::ball_end, 3e-3), 0.2e-3, {.max_step_m = 0.3e-3, .max_turn_rad = 0.01});
  double by_chips = 0.0;
  double by_volume = 0.0;
  double all = 0.0;
  for (const BlockEngagement& part : out.parts) {
    all += part.removed_volume_m3;
    if (part.duration_s == 0.0) continue;
    by_chips += chip_area_m2(part.cut.engagement) * part.cut.feed_speed_m_per_s * part.duration_s;
    by_volume += part.removed_volume_m3;
  }
  EXPECT_NEAR(by_chips, by_volume, 0.01 * by_volume);
  EXPECT_NEAR(all, out.removed.mean(), 3e-3 * all);
  EXPECT_GT(by_volume, 1e-7);
}

TEST(Walk, HandsOutPartsInOrder) {
  const Program program = zigzag();
  const Walked out = walked(program, end_mill(CutterKind::ball_end, 3e-3), 0.4e-3, {.max_step_m = 1e-3, .batch = 16});
  ASSERT_GT(out.batches.size(), 3U);
  for (std::size_t i = 0; i + 1 < out.batches.size(); ++i) EXPECT_EQ(out.batches[i], 16U);
  std::size_t block = 0;
  double share = 0.0;
  std::vector<double> duration(program.blocks.size(), 0.0);
  for (const BlockEngagement& part : out.parts) {
    if (part.block != block) {
      EXPECT_EQ(part.block, block + 1);
      EXPECT_EQ(share, 1.0);
      block = part.block;
      share = 0.0;
    }
    EXPECT_GT(part.share_to, share);
    share = part.share_to;
    duration[block] += part.duration_s;
    EXPECT_LT((part.pose.tip_m - between(program.begin_of(block), program.blocks[block].end, share).tip_m).norm(),
              1e-15);
  }
  EXPECT_EQ(block + 1, program.blocks.size());
  for (std::size_t i = 0; i < program.blocks.size(); ++i) {
    EXPECT_NEAR(duration[i], program.blocks[i].duration_s, 1e-12);
  }
}

TEST(Walk, FlagsRapidsAndTheShankInMaterial) {
  const Program program = zigzag();
  const Walked out = walked(program, end_mill(CutterKind::ball_end, 3e-3), 0.2e-3, {});
  EXPECT_FALSE(out.parts.front().rapid_in_material);
  EXPECT_TRUE(out.parts.back().rapid_in_material);
  EXPECT_TRUE(out.parts.back().cut.engagement.empty());
  EXPECT_TRUE(std::ranges::none_of(out.parts, [](const BlockEngagement& part) { return part.shank; }));
  Cutter stubby = end_mill(CutterKind::flat_end, 3e-3);
  stubby.cutting_height_m = 1e-3;
  const Walked deep = walked(program, stubby, 0.2e-3, {});
  EXPECT_TRUE(std::ranges::any_of(
      deep.parts, [](const BlockEngagement& part) { return part.shank && part.shank_depth_m > 0.2e-3; }));
}

TEST(Walk, SameBitsAtAnyThreadCount) {
  const auto run = [](int threads) {
    set_thread_count(threads);
    const Walked out = walked(zigzag(), end_mill(CutterKind::ball_end, 3e-3), 0.3e-3, {});
    set_thread_count(0);
    std::vector<double> bits;
    for (const BlockEngagement& part : out.parts) {
      bits.push_back(part.removed_volume_m3);
      for (const Arc& arc : part.cut.engagement.arcs) bits.insert(bits.end(), {arc.entry_rad, arc.exit_rad});
    }
    return bits;
  };
  const std::vector<double> one = run(1);
  EXPECT_GT(one.size(), 1000U);
  EXPECT_EQ(one, run(2));
  EXPECT_EQ(one, run(8));
}

TEST(Walk, StopsWhenAsked) {
  const std::atomic<bool> stop{true};
  Progress progress({}, &stop);
  Workpiece part(box({0.0, 0.0, 0.0}, {0.02, 0.02, 0.01}), 0.5e-3);
  EXPECT_THROW(walk(
                   zigzag(), end_mill(CutterKind::ball_end, 3e-3), part, {}, [](auto) {}, progress),
               Interrupted);
}

// Counted before the first of them: a program as long as that would run for days.
TEST(Walk, RejectsWhatWouldNotEnd) {
  Program program = zigzag();
  Workpiece part(box({0.0, -0.002, 0.0}, {0.02, 0.02, 0.01}), 1e-3);
  program.blocks.back().kind = Block::Kind::feed;
  program.blocks.back().duration_s = 1.0;
  program.blocks.back().end.tip_m.x() = 1e9;
  EXPECT_EQ(test::field_of([&] {
              walk(program, end_mill(CutterKind::ball_end, 3e-3), part, {}, [](auto) { FAIL() << "has begun"; });
            }),
            "program, parts of its blocks");
}

TEST(Walk, RejectsFeedMovesWithoutDuration) {
  Program program = zigzag();
  program.blocks[3].duration_s = 0.0;
  Workpiece part(box({0.0, 0.0, 0.0}, {0.02, 0.02, 0.01}), 0.5e-3);
  EXPECT_EQ(test::field_of([&] { walk(program, end_mill(CutterKind::ball_end, 3e-3), part, {}, [](auto) {}); }),
            "duration_s");
}

TEST(WalkOptions, RejectsNamingTheMember) {
  EXPECT_EQ(test::field_of([] { WalkOptions{.ring_width_m = -1.0}.validate(); }), "ring_width_m");
  EXPECT_EQ(test::field_of([] { WalkOptions{.max_turn_rad = 0.0}.validate(); }), "max_turn_rad");
  EXPECT_EQ(test::field_of([] { WalkOptions{.batch = 0}.validate(); }), "batch");
}

}  // namespace program_engagement_test
}  // namespace robomill::cutting
