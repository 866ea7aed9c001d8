#include "robomill/cutting/default_stock.hpp"

#include <algorithm>
#include <optional>
#include <string>

#include "robomill/base/error.hpp"

namespace robomill::cutting {
namespace {

using Eigen::Vector3d;
using program::Block;

struct Pass {
  double z_m = 0.0;
  std::size_t block = 0;
};

/// Finds the highest pass of a program.
class Passes {
 public:
  explicit Passes(const program::Program& program) : program_(program) {}

  [[nodiscard]] std::optional<Pass> highest() {
    std::size_t i = 0;
    while (i < program_.blocks.size()) {
      if (program_.blocks[i].kind == Block::Kind::feed) {
        i = run(i);
      } else {
        ++i;
      }
    }
    return highest_;
  }

 private:
  [[nodiscard]] double rise(std::size_t i) const {
    return (program_.blocks[i].end.tip_m - program_.begin_of(i).tip_m).dot(program_.begin_of(i).axis);
  }
  [[nodiscard]] bool across(std::size_t i) const {
    const double way = (program_.blocks[i].end.tip_m - program_.begin_of(i).tip_m).norm();
    return std::abs(rise(i)) < 0.7 * way;  // by more than 45 degrees from the axis
  }
  [[nodiscard]] bool is_feed(std::size_t i) const { return program_.blocks[i].kind == Block::Kind::feed; }

  /// Feed moves without a rapid among them. @return the first block after them
  std::size_t run(std::size_t first) {
    std::size_t end = first;
    while (end < program_.blocks.size() && program_.blocks[end].kind != Block::Kind::rapid) ++end;
    std::size_t level = first;
    while (level < end && (!is_feed(level) || rise(level) < 0.0)) ++level;
    // A way down that nothing follows is a pass itself, down a slope.
    bool leads_in = false;
    for (std::size_t i = level; i < end; ++i) leads_in = leads_in || (is_feed(i) && across(i));
    for (std::size_t i = leads_in ? level : first; i < end; ++i) {
      if (!is_feed(i)) continue;
      if (across(i)) take(program_.begin_of(i).tip_m.z(), i);
      if (across(i) || rise(i) < 0.0) take(program_.blocks[i].end.tip_m.z(), i);
    }
    return end;
  }
  void take(double z_m, std::size_t block) {
    if (!highest_ || z_m > highest_->z_m) highest_ = {.z_m = z_m, .block = block};
  }

  const program::Program& program_;
  std::optional<Pass> highest_;
};

bool moves_above_zero(const program::Program& program) {
  return program.start.tip_m.z() > 0.0 ||
         std::ranges::any_of(program.blocks, [](const Block& block) { return block.end.tip_m.z() > 0.0; });
}

/// The box of the tips of all feed moves.
Stock around_feed_moves(const program::Program& program) {
  Stock stock;
  stock.min_m.setConstant(1e300);
  stock.max_m.setConstant(-1e300);
  for (std::size_t i = 0; i < program.blocks.size(); ++i) {
    if (program.blocks[i].kind != Block::Kind::feed) continue;
    for (const Vector3d& tip : {program.begin_of(i).tip_m, program.blocks[i].end.tip_m}) {
      stock.min_m = stock.min_m.cwiseMin(tip);
      stock.max_m = stock.max_m.cwiseMax(tip);
    }
  }
  return stock;
}

}  // namespace

DefaultStock default_stock(const program::Program& program, const Cutter& cutter, double dexel_m,
                           double axial_depth_m) {
  require_positive("dexel_m", dexel_m, "m");
  require_non_negative("axial_depth_m", axial_depth_m, "m");
  const double radius = Profile(cutter).max_radius_m();
  DefaultStock out;
  Stock& stock = out.stock;
  stock = around_feed_moves(program);
  if (stock.min_m.x() > stock.max_m.x()) throw InvalidInput("program", "has no feed move", "It would cut nothing");
  stock.min_m -= Vector3d(radius, radius, dexel_m);
  stock.max_m += Vector3d(radius, radius, 0.0);
  const std::optional<Pass> highest = Passes(program).highest();
  if (highest) {
    out.highest_pass_m = highest->z_m;
    out.highest_pass_block = highest->block;
  }
  if (highest && axial_depth_m > 0.0) {
    out.top = DefaultStock::Top::axial_depth;
    stock.max_m.z() = highest->z_m + axial_depth_m;
    return out;
  }
  if (highest && highest->z_m < 0.0 && moves_above_zero(program)) {
    stock.max_m.z() = 0.0;
    return out;
  }
  const std::string where =
      highest ? "its highest pass is in line " + std::to_string(program.blocks[highest->block].line) : "it has no pass";
  throw InvalidInput("stock", "must be given: the program does not state how high the material stands; " + where,
                     "Give [stock], or cut.axial_depth_mm, the depth of the highest pass");
}

}  // namespace robomill::cutting
