#include "robomill/cutting/chip.hpp"

#include <algorithm>
#include <cmath>

#include "robomill/base/units.hpp"

namespace robomill::cutting::detail {
namespace {

/// Angle from tooth j forward to tooth k at a height, in (0, 2π].
double gap(const FlatEndMill& mill, int j, int k, double height) {
  if (j == k) return units::revolution;
  const double ahead =
      mill.standing_angle(k) - mill.standing_angle(j) - (mill.lag_rad_per_m(k) - mill.lag_rad_per_m(j)) * height;
  const double turned = ahead - units::revolution * std::floor(ahead / units::revolution);
  return turned > 0.0 ? turned : units::revolution;
}

}  // namespace

void ChipShare::set(const FlatEndMill& mill, int tooth, double height_m, double position_sine, double feed_m) {
  shared_ = mill.runout_m > 0.0;
  lines_.clear();
  const double own = mill.radius_deviation_m(tooth, height_m);
  for (int k = 0; k < mill.teeth; ++k) {
    const double delay = gap(mill, tooth, k, height_m);
    const Line line = {.slope = feed_m * delay / units::revolution,
                       .offset = (own - mill.radius_deviation_m(k, height_m)) * position_sine,
                       .delay_rad = delay};
    if (shared_ || lines_.empty()) {
      lines_.push_back(line);
    } else if (line.delay_rad < lines_.front().delay_rad) {
      lines_.front() = line;
    }
  }
  if (shared_) find_levels();
}

/// From large n·x_F down: the line of least slope is lowest, then those of greater slope take over.
void ChipShare::find_levels() {
  levels_.clear();
  const auto steeper = [](const Line& a, const Line& b) {
    return a.slope < b.slope || (a.slope == b.slope && a.offset < b.offset);
  };
  std::ranges::sort(lines_, steeper);
  std::size_t lowest = 0;
  double highest = -1e300;  // zero of a line: below it the chip would be negative
  for (const Line& line : lines_) {
    if (line.slope > 0.0) highest = std::max(highest, -line.offset / line.slope);
  }
  levels_.push_back(highest);
  while (true) {
    double next_level = -1e300;
    std::size_t next = lowest;
    for (std::size_t i = lowest + 1; i < lines_.size(); ++i) {
      const double rise = lines_[i].slope - lines_[lowest].slope;
      if (!(rise > 0.0)) continue;
      const double level = (lines_[lowest].offset - lines_[i].offset) / rise;
      if (level < next_level) continue;
      next_level = level;
      next = i;
    }
    if (next == lowest || next_level <= highest) return;
    levels_.push_back(next_level);
    lowest = next;
  }
}

const std::vector<ChipPiece>& ChipShare::pieces(const Arc& arc, const Forwards& forwards, double& missed_rad) {
  pieces_.clear();
  if (!shared_) {
    pieces_.push_back({.from_rad = arc.entry_rad,
                       .to_rad = arc.exit_rad,
                       .slope_m = lines_.front().slope,
                       .delay_rad = lines_.front().delay_rad});
    return pieces_;
  }
  cuts_.clear();
  cuts_.push_back(arc.entry_rad);
  for (const double level : levels_) {
    const double cosine = (level - forwards.mean) / forwards.amplitude;
    if (!(std::abs(cosine) < 1.0)) continue;
    const double half = std::acos(cosine);
    for (const double angle : {forwards.middle_rad - half, forwards.middle_rad + half}) {
      double turned = angle - units::revolution * std::floor((angle - arc.entry_rad) / units::revolution);
      if (turned > arc.entry_rad && turned < arc.exit_rad) cuts_.push_back(turned);
    }
  }
  cuts_.push_back(arc.exit_rad);
  std::ranges::sort(cuts_);
  for (std::size_t i = 1; i < cuts_.size(); ++i) {
    if (!(cuts_[i] > cuts_[i - 1])) continue;
    const double middle = 0.5 * (cuts_[i - 1] + cuts_[i]);
    const double along = forwards.mean + forwards.amplitude * std::cos(middle - forwards.middle_rad);
    const Line* lowest = &lines_.front();
    for (const Line& line : lines_) {
      if (line.slope * along + line.offset < lowest->slope * along + lowest->offset) lowest = &line;
    }
    if (lowest->slope * along + lowest->offset > 0.0) {
      pieces_.push_back({.from_rad = cuts_[i - 1],
                         .to_rad = cuts_[i],
                         .slope_m = lowest->slope,
                         .offset_m = lowest->offset,
                         .delay_rad = lowest->delay_rad});
    } else {
      missed_rad += cuts_[i] - cuts_[i - 1];
    }
  }
  return pieces_;
}

}  // namespace robomill::cutting::detail
