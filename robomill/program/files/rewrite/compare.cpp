#include "robomill/program/files/rewrite/compare.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "robomill/base/units.hpp"

namespace robomill::program {
namespace {

using Eigen::Vector3d;

constexpr double tip_tolerance_m = 2e-7;
constexpr double turned_tolerance = 1e-7;
constexpr double rate_tolerance = 1e-5;

/// Kind, spindle, coolant and stop.
std::string state_difference(const Block& wanted, const Block& got) {
  if (got.kind != wanted.kind) return "it is another kind of move";
  if (got.spindle != wanted.spindle || got.coolant != wanted.coolant || got.operator_stop != wanted.operator_stop) {
    return "spindle, coolant or stop are others";
  }
  return {};
}

std::string speed_difference(const Block& wanted, const Block& got) {
  const bool turns = wanted.spindle != Spindle::off;
  if (!turns || near_rate(got.spindle_speed_rad_per_s, wanted.spindle_speed_rad_per_s, rate_tolerance)) return {};
  return fmt::format("the spindle's speed is {:.9g} rpm instead of {:.9g}", got.spindle_speed_rad_per_s / units::rpm,
                     wanted.spindle_speed_rad_per_s / units::rpm);
}

std::string tip_difference(const Vector3d& wanted_m, const Vector3d& got_m) {
  const double off_m = (got_m - wanted_m).norm();
  if (off_m <= tip_tolerance_m) return {};
  return fmt::format("the tip comes to ({:.7g}, {:.7g}, {:.7g}) mm, off by {:.3g} mm", got_m.x() / units::mm,
                     got_m.y() / units::mm, got_m.z() / units::mm, off_m / units::mm);
}

std::string feed_difference(double wanted_way_m, double wanted_time_s, double way_m, double time_s) {
  if (wanted_way_m > 0.0 && way_m > 0.0) {
    const double feed = wanted_way_m / wanted_time_s;
    const double got_feed = way_m / time_s;
    const double allowed = rate_tolerance + std::abs(way_m - wanted_way_m) / wanted_way_m;
    if (std::abs(got_feed - feed) <= allowed * feed) return {};
    return fmt::format("its feed is {:.9g} mm/min instead of {:.9g}", got_feed / units::mm * units::minute,
                       feed / units::mm * units::minute);
  }
  if (near_rate(time_s, wanted_time_s, rate_tolerance)) return {};
  return fmt::format("it takes {:.9g} s instead of {:.9g}", time_s, wanted_time_s);
}

std::string count_difference(std::size_t wanted, std::size_t got) {
  return fmt::format("it makes {} blocks instead of {}", got, wanted);
}

double distance_m(const Vector3d& point_m, const Vector3d& from_m, const Vector3d& to_m) {
  const Vector3d way = to_m - from_m;
  const double square = way.squaredNorm();
  const double share = square > 0.0 ? std::clamp((point_m - from_m).dot(way) / square, 0.0, 1.0) : 0.0;
  return (point_m - from_m - share * way).norm();
}

/// Whether each block ends on the way of others.
bool ends_on(std::span<const Block> blocks, std::span<const Block> way, const Pose& way_begin) {
  return std::ranges::all_of(blocks, [&](const Block& block) {
    double nearest_m = std::numeric_limits<double>::infinity();
    Vector3d from_m = way_begin.tip_m;
    for (const Block& part : way) {
      nearest_m = std::min(nearest_m, distance_m(block.end.tip_m, from_m, part.end.tip_m));
      from_m = part.end.tip_m;
    }
    return nearest_m <= tip_tolerance_m;
  });
}

std::string rapid_difference(std::span<const Block> wanted, const Pose& wanted_begin, std::span<const Block> got,
                             const Pose& got_begin) {
  for (const Block& block : got) {
    std::string problem = state_difference(wanted.back(), block);
    if (problem.empty()) problem = speed_difference(wanted.back(), block);
    if (!problem.empty()) return problem;
  }
  if (std::string problem = pose_difference(wanted.back().end, got.back().end); !problem.empty()) return problem;
  if (ends_on(got, wanted, wanted_begin) && ends_on(wanted, got, got_begin)) return {};
  return "the tip goes another way";
}

/// Of one wanted move at feed that has come in several parts.
std::string parts_difference(const Block& wanted, const Pose& wanted_begin, std::span<const Block> got,
                             const Pose& got_begin, double axis_tolerance_rad) {
  double way_m = 0.0;
  double time_s = 0.0;
  Vector3d from_m = got_begin.tip_m;
  for (const Block& part : got) {
    way_m += (part.end.tip_m - from_m).norm();
    time_s += part.duration_s;
    from_m = part.end.tip_m;
  }
  const double wanted_way_m = (wanted.end.tip_m - wanted_begin.tip_m).norm();
  const double turn_rad = angle_between(wanted_begin.axis, wanted.end.axis);
  const double slack_rad = wanted_way_m > 0.0 ? turn_rad * std::min(tip_tolerance_m / wanted_way_m, 1.0) : 0.0;
  double elapsed_s = 0.0;
  for (const Block& part : got) {
    std::string problem = state_difference(wanted, part);
    if (problem.empty()) problem = speed_difference(wanted, part);
    elapsed_s += part.duration_s;
    const Pose at = between(wanted_begin, wanted.end, elapsed_s / time_s);
    if (problem.empty()) problem = tip_difference(at.tip_m, part.end.tip_m);
    if (!problem.empty()) return problem;
    const double off_rad = angle_between(at.axis, part.end.axis);
    if (off_rad <= axis_tolerance_rad + turned_tolerance + slack_rad) continue;
    return fmt::format("the axis leaves its way by {:.3g} deg", off_rad / units::deg);
  }
  if (std::string problem = pose_difference(wanted.end, got.back().end); !problem.empty()) return problem;
  return feed_difference(wanted_way_m, wanted.duration_s, way_m, time_s);
}

/// How many of the blocks make the wanted one.
std::size_t count_parts(const Block& wanted, const Pose& wanted_begin, std::span<const Block> got) {
  if (wanted.kind != Block::Kind::feed || same_axis(wanted_begin.axis, wanted.end.axis)) return 1;
  for (std::size_t i = 0; i < got.size() && got[i].kind == Block::Kind::feed; ++i) {
    if (pose_difference(wanted.end, got[i].end).empty()) return i + 1;
  }
  return 1;
}

std::string moves_difference(std::span<const Block> wanted, Pose wanted_begin, std::span<const Block> got,
                             Pose got_begin, double axis_tolerance_rad) {
  std::string counts = count_difference(wanted.size(), got.size());
  const auto rapids = [](std::span<const Block> blocks) {
    const auto end = std::ranges::find_if(blocks, [](const Block& b) { return b.kind != Block::Kind::rapid; });
    return static_cast<std::size_t>(end - blocks.begin());
  };
  while (!wanted.empty()) {
    if (got.empty()) return counts;
    const bool rapid = wanted.front().kind == Block::Kind::rapid;
    const std::size_t moves = rapid ? rapids(wanted) : 1;
    const std::size_t parts = rapid ? rapids(got) : count_parts(wanted.front(), wanted_begin, got);
    if (parts == 0) return counts;
    std::string problem;
    if (rapid) {
      problem = rapid_difference(wanted.first(moves), wanted_begin, got.first(parts), got_begin);
    } else if (parts == 1) {
      problem = block_difference(wanted.front(), wanted_begin, got.front(), got_begin);
    } else {
      problem = parts_difference(wanted.front(), wanted_begin, got.first(parts), got_begin, axis_tolerance_rad);
    }
    if (!problem.empty()) return problem;
    wanted_begin = wanted[moves - 1].end;
    got_begin = got[parts - 1].end;
    wanted = wanted.subspan(moves);
    got = got.subspan(parts);
  }
  return got.empty() ? std::string() : counts;
}

}  // namespace

bool near_rate(double a, double b, double tolerance) {
  return std::abs(a - b) <= tolerance * std::max(std::abs(a), std::abs(b));
}

bool same_axis(const Vector3d& a, const Vector3d& b) {
  constexpr double tolerance = 2e-8;
  return (a - b).norm() <= tolerance;
}

std::string pose_difference(const Pose& wanted, const Pose& got) {
  if (std::string problem = tip_difference(wanted.tip_m, got.tip_m); !problem.empty()) return problem;
  return (got.axis - wanted.axis).norm() <= turned_tolerance ? "" : "the axis is another";
}

std::string block_difference(const Block& wanted, const Pose& wanted_begin, const Block& got, const Pose& got_begin) {
  std::string problem = state_difference(wanted, got);
  if (problem.empty()) problem = pose_difference(wanted.end, got.end);
  if (problem.empty()) problem = speed_difference(wanted, got);
  if (!problem.empty()) return problem;
  switch (wanted.kind) {
    case Block::Kind::rapid:
      return {};
    case Block::Kind::dwell:
      return got.duration_s == wanted.duration_s ? "" : "the dwell takes another time";
    case Block::Kind::feed:
      break;
  }
  return feed_difference((wanted.end.tip_m - wanted_begin.tip_m).norm(), wanted.duration_s,
                         (got.end.tip_m - got_begin.tip_m).norm(), got.duration_s);
}

std::string blocks_difference(std::span<const Block> wanted, const Pose& wanted_begin, std::span<const Block> got,
                              const Pose& got_begin, double axis_tolerance_rad) {
  std::string problem;
  if (wanted.size() != got.size()) problem = count_difference(wanted.size(), got.size());
  Pose from = wanted_begin;
  Pose at = got_begin;
  for (std::size_t i = 0; i < wanted.size() && problem.empty(); ++i) {
    problem = block_difference(wanted[i], from, got[i], at);
    from = wanted[i].end;
    at = got[i].end;
  }
  if (problem.empty()) return {};
  from = wanted_begin;
  const bool in_other_parts = std::ranges::any_of(wanted, [&](const Block& block) {
    return !same_axis(std::exchange(from, block.end).axis, block.end.axis) || block.kind == Block::Kind::rapid;
  });
  if (!in_other_parts) return problem;
  const std::string in_parts = moves_difference(wanted, wanted_begin, got, got_begin, axis_tolerance_rad);
  if (in_parts.empty()) return {};
  return wanted.size() == got.size() ? problem : in_parts;
}

}  // namespace robomill::program
