#include "robomill/cutting/default_stock.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "testing/cutting/cutters.hpp"
#include "testing/support.hpp"

namespace robomill::cutting {
namespace default_stock_test {

using Eigen::Vector3d;
using program::Block;
using program::Program;
using testing::ball_end;
using testing::mm;

struct Move {
  Block::Kind kind;
  double x_mm, y_mm, z_mm;
};
constexpr Block::Kind rapid = Block::Kind::rapid;
constexpr Block::Kind feed = Block::Kind::feed;

Program program_of(const std::vector<Move>& moves, double start_z_mm) {
  Program program;
  program.start.tip_m = Vector3d(0.0, 0.0, start_z_mm * mm);
  for (const Move& move : moves) {
    program.blocks.push_back({.kind = move.kind,
                              .line = program.blocks.size() + 2,
                              .end = {.tip_m = Vector3d(move.x_mm, move.y_mm, move.z_mm) * mm},
                              .duration_s = 1.0});
  }
  return program;
}

DefaultStock stock_of(const Program& program, double axial_depth_mm = 0.0) {
  return default_stock(program, ball_end(3.0 * mm, 2, 0.5), 0.25 * mm, axial_depth_mm * mm);
}

const std::vector<Move> pocket = {{rapid, 10, 10, 5}, {feed, 10, 10, -2}, {feed, 30, 10, -2},
                                  {feed, 30, 20, -2}, {feed, 30, 20, 5},  {rapid, 0, 0, 50}};

// The plane from which the tool plunges at feed is none of the material's.
TEST(DefaultStock, APocketBelowZeroHasItsTopThere) {
  const DefaultStock found = stock_of(program_of(pocket, 50.0));
  EXPECT_EQ(found.top, DefaultStock::Top::program_zero);
  EXPECT_LT((found.stock.min_m - Vector3d(7.0, 7.0, -2.25) * mm).norm(), 1e-15);
  EXPECT_LT((found.stock.max_m - Vector3d(33.0, 23.0, 0.0) * mm).norm(), 1e-15);
}

TEST(DefaultStock, AGivenDepthStandsAboveTheHighestPass) {
  const DefaultStock found = stock_of(program_of(pocket, 50.0), 1.5);
  EXPECT_EQ(found.top, DefaultStock::Top::axial_depth);
  EXPECT_DOUBLE_EQ(found.highest_pass_m, -2.0 * mm);
  EXPECT_EQ(found.highest_pass_block, 2U);
  EXPECT_NEAR(found.stock.max_m.z(), -0.5 * mm, 1e-15);
}

// Ramps and helices begin in air; what they lead to counts. A way down that nothing follows is a pass down a slope.
TEST(DefaultStock, AWayDownToAPassIsNone) {
  const std::vector<Move> ramp = {{rapid, 0, 0, 5},  {feed, 10, 0, 1},  {feed, 0, 0, -1},
                                  {feed, 10, 0, -2}, {feed, 10, 9, -2}, {rapid, 10, 9, 5}};
  EXPECT_DOUBLE_EQ(stock_of(program_of(ramp, 50.0)).highest_pass_m, -2.0 * mm);
  const std::vector<Move> slope = {{rapid, 0, 0, 5}, {feed, 0, 0, -1}, {feed, 20, 0, -4}, {rapid, 20, 0, 5},
                                   {rapid, 0, 1, 5}, {feed, 0, 1, -1}, {feed, 20, 1, -4}, {rapid, 20, 1, 5}};
  EXPECT_DOUBLE_EQ(stock_of(program_of(slope, 50.0), 1.0).highest_pass_m, -1.0 * mm);
  const std::vector<Move> holes = {{rapid, 0, 0, 2}, {feed, 0, 0, -20}, {feed, 0, 0, 2}, {rapid, 0, 0, 50}};
  EXPECT_EQ(stock_of(program_of(holes, 50.0)).stock.max_m.z(), 0.0);
}

// Where the zero is below the passes, or nothing moves above it, the height is not in the program.
TEST(DefaultStock, RejectsAProgramThatDoesNotGiveTheHeight) {
  const auto rejected = [](std::vector<Move> moves, double raise_mm, double start_z_mm) {
    for (Move& move : moves) move.z_mm += raise_mm;
    const Program program = program_of(moves, start_z_mm);
    EXPECT_EQ(stock_of(program, 2.0).top, DefaultStock::Top::axial_depth);
    return robomill::test::rejection([&] { static_cast<void>(stock_of(program)); });
  };
  for (const std::string& message : {rejected(pocket, 20.0, 50.0), rejected(pocket, -400.0, -300.0)}) {
    EXPECT_NE(message.find("stock: must be given"), std::string::npos) << message;
    EXPECT_NE(message.find("line 4"), std::string::npos) << message;
  }
}

TEST(DefaultStock, NeedsAFeedMove) {
  const Program rapids = program_of({{rapid, 1, 2, 3}}, 0.0);
  EXPECT_EQ(robomill::test::field_of([&] { static_cast<void>(stock_of(rapids)); }), "program");
}

}  // namespace default_stock_test
}  // namespace robomill::cutting
