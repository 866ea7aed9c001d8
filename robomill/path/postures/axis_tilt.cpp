#include "robomill/path/postures/axis_tilt.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "robomill/base/units.hpp"

namespace robomill::path {
namespace {

/// The tilt is whole where the wrist is nearer to its singularity than so many tilts, and 0 from so many on: joint 4
/// has done 9 of 10 parts of its half turn between the first, 19 of 20 between the others.
constexpr double whole_within = 3.0, none_beyond = 12.0;
/// Farther from the singularity a walk ended for another reason.
constexpr double considered_rad = 2.0 * units::deg;
/// Directions of the tilt that are looked at, and those of them that are walked; crossings of one program.
constexpr int directions = 16, walked_directions = 6, most_tilts = 8;
/// Looks along the program to each side of a crossing; each is so many parts of a walk's step.
constexpr int most_looks = 20'000, looks_a_step = 64;

double tilt_at(const AxisTilt& tilt, double t) {
  if (t <= tilt.from || t >= tilt.to) return 0.0;
  if (t < tilt.full_from) return tilt.angle_rad * (t - tilt.from) / (tilt.full_from - tilt.from);
  if (t > tilt.full_to) return tilt.angle_rad * (tilt.to - t) / (tilt.to - tilt.full_to);
  return tilt.angle_rad;
}

program::Pose tilted(std::span<const AxisTilt> tilts, double t, program::Pose pose) {
  for (const AxisTilt& tilt : tilts) {
    const double angle = tilt_at(tilt, t);
    if (angle == 0.0) continue;
    const Eigen::Vector3d across = (tilt.toward - tilt.toward.dot(pose.axis) * pose.axis).normalized();
    pose.axis = (std::cos(angle) * pose.axis + std::sin(angle) * across).normalized();
  }
  return pose;
}

/// A head with its tilts, and where each of its poses stands in the program.
struct TiltedHead {
  Head head = {};
  std::vector<double> place = {};
  [[nodiscard]] double place_of(double t) const {
    const std::size_t below = std::min(static_cast<std::size_t>(t), place.size() - 2);
    return place[below] + (t - static_cast<double>(below)) * (place[below + 1] - place[below]);
  }
};

TiltedHead with_tilts(const Head& head, std::span<const AxisTilt> tilts) {
  TiltedHead out;
  out.head.whole = head.whole;
  out.head.pose.push_back(head.pose.front());
  out.place.push_back(0.0);
  for (std::size_t block = 0; block < head.line.size(); ++block) {
    for (const TiltedPart& part : tilted_parts(tilts, block, head.pose[block], head.pose[block + 1])) {
      out.head.pose.push_back(part.end);
      out.head.line.push_back(head.line[block]);
      out.place.push_back(static_cast<double>(block) + part.share);
    }
  }
  return out;
}

/// One way along a program, near a singularity of its wrist.
class Crossing {
 public:
  Crossing(const robot::Kinematics& machine, const Head& head, double gamma_rad, const robot::Position6& near,
           const PostureOptions& options)
      : machine_(machine), head_(head), gamma_rad_(gamma_rad), near_(near), options_(options) {}

  /// Where the tilt must act, without its direction, for a walk that ended at t; none: it does not end beside a
  /// singularity of the wrist, or the program begins or ends there.
  [[nodiscard]] std::optional<AxisTilt> place(double t) const {
    double nearest = t, least = wrist(t);
    for (int look = 0; look < most_looks && t < end(); ++look) {
      t = std::min(t + step(t), end());
      const double here = wrist(t);
      if (here < least) {
        least = here;
        nearest = t;
      }
      if (here > 2.0 * least + 0.1 * considered_rad) break;
    }
    if (!(least < considered_rad)) return std::nullopt;
    AxisTilt out{.angle_rad = options_.max_axis_tilt_rad};
    const auto away = [&](double from, double sign, double angle) {
      double at = from;
      for (int look = 0; look < most_looks && at > 0.0 && at < end() && wrist(at) < angle; ++look) {
        at = std::clamp(at + sign * step(at), 0.0, end());
      }
      return at;
    };
    out.full_from = away(nearest, -1.0, whole_within * out.angle_rad);
    out.full_to = away(nearest, 1.0, whole_within * out.angle_rad);
    if (out.full_from <= 0.0 || out.full_to >= end()) return std::nullopt;
    out.from = away(out.full_from, -1.0, none_beyond * out.angle_rad);
    out.to = away(out.full_to, 1.0, none_beyond * out.angle_rad);
    return out;
  }

  /// The tilt in each direction across the axis, those that keep the wrist farthest from its singularity first.
  [[nodiscard]] std::vector<AxisTilt> in_directions(const AxisTilt& tilt) const {
    const Eigen::Vector3d axis = head_.at(0.5 * (tilt.full_from + tilt.full_to)).axis;
    const Eigen::Vector3d first = axis.unitOrthogonal(), second = axis.cross(first);
    std::vector<std::pair<double, AxisTilt>> all;
    for (int k = 0; k < directions; ++k) {
      const double angle = 2.0 * std::numbers::pi * k / directions;
      AxisTilt one = tilt;
      one.toward = std::cos(angle) * first + std::sin(angle) * second;
      double least = HUGE_VAL;
      for (int look = 0; look <= looks_a_step; ++look) {
        const double t = tilt.full_from + look * (tilt.full_to - tilt.full_from) / looks_a_step;
        least = std::min(least, wrist_of(tilted(std::span(&one, 1), t, head_.at(t))));
      }
      all.emplace_back(least, one);
    }
    std::ranges::stable_sort(all, [](const auto& a, const auto& b) { return a.first > b.first; });
    std::vector<AxisTilt> out;
    out.reserve(walked_directions);
    for (int k = 0; k < walked_directions; ++k) out.push_back(all[static_cast<std::size_t>(k)].second);
    return out;
  }

 private:
  [[nodiscard]] double end() const { return static_cast<double>(head_.line.size()); }
  [[nodiscard]] double step(double t) const {
    const std::size_t block = std::min(static_cast<std::size_t>(t), head_.line.size() - 1);
    return 1.0 / (looks_a_step * std::max(steps_of(head_, block, options_), 1.0 / looks_a_step));
  }
  /// From the wrist's singularity [rad]; infinite where the pose is out of reach or its configuration not known.
  [[nodiscard]] double wrist_of(const program::Pose& pose) const {
    robot::Position6 position;
    const robot::Reach reach = machine_.follow(
        robot::ToolPose{.tip_m = pose.tip_m, .axis = pose.axis, .gamma_rad = gamma_rad_}, near_, position);
    if (reach.status == robot::Reach::Status::out_of_reach) return HUGE_VAL;
    const robot::Configuration configuration = machine_.configuration(position);
    return configuration.known ? configuration.wrist_rad : HUGE_VAL;
  }
  [[nodiscard]] double wrist(double t) const { return wrist_of(head_.at(t)); }

  const robot::Kinematics& machine_;
  const Head& head_;
  double gamma_rad_;
  const robot::Position6& near_;
  const PostureOptions& options_;
};

/// Walks a way with its tilts; t and the margin's block are the program's.
Walk walk_tilted(const Head& head, const Posture& posture, const PostureOptions& options) {
  const TiltedHead there = with_tilts(head, posture.tilts);
  Walk out = walk(*options.beside, there.head, stations(there.head, options), posture.gamma_rad, posture.start, {});
  out.t = there.place_of(out.t);
  const std::size_t part = std::min(out.margin.block, there.head.line.size() - 1);
  out.margin.block = std::min(static_cast<std::size_t>(there.place[part]), head.line.size() - 1);
  return out;
}

/// Adds the tilt that leads past the place where the way ends.
/// @return whether one does
bool pass(const Head& head, TiltedWay& way, const PostureOptions& options) {
  const Crossing crossing(*options.beside, head, way.posture.gamma_rad.front(), way.walk.last, options);
  std::optional<AxisTilt> tilt = crossing.place(way.walk.t);
  if (!tilt) return false;
  std::vector<AxisTilt>& tilts = way.posture.tilts;
  if (!tilts.empty()) tilt->from = std::max(tilt->from, tilts.back().to);
  if (tilt->full_from < tilt->from) return false;
  for (const AxisTilt& one : crossing.in_directions(*tilt)) {
    tilts.push_back(one);
    const Walk further = walk_tilted(head, way.posture, options);
    if (found(further) || further.t > one.to) {
      way.walk = further;
      return true;
    }
    tilts.pop_back();
  }
  return false;
}

}  // namespace

std::vector<TiltedPart> tilted_parts(std::span<const AxisTilt> tilts, std::size_t block, const program::Pose& from,
                                     const program::Pose& to) {
  const double begin = static_cast<double>(block);
  std::vector<double> cuts;
  for (const AxisTilt& tilt : tilts) {
    for (const double t : {tilt.from, tilt.full_from, tilt.full_to, tilt.to}) {
      if (t > begin && t < begin + 1.0) cuts.push_back(t - begin);
    }
  }
  std::ranges::sort(cuts);
  cuts.erase(std::unique(cuts.begin(), cuts.end()), cuts.end());
  cuts.push_back(1.0);
  std::vector<TiltedPart> out;
  out.reserve(cuts.size());
  for (const double share : cuts) {
    const program::Pose pose = share < 1.0 ? program::between(from, to, share) : to;
    out.push_back({.share = share, .end = tilted(tilts, begin + share, pose)});
  }
  return out;
}

double tilt_within(std::span<const AxisTilt> tilts, std::size_t block) {
  const double begin = static_cast<double>(block);
  double out = 0.0;
  for (const AxisTilt& tilt : tilts) {
    if (tilt.to > begin && tilt.from < begin + 1.0) out = std::max(out, tilt.angle_rad);
  }
  return out;
}

TiltedWay tilted_way(const Head& head, std::span<const TiltedWay> farthest, const PostureOptions& options) {
  for (TiltedWay way : farthest) {
    way.posture.beside_singularity = true;
    way.walk = walk_tilted(head, way.posture, options);
    for (int k = 0; k < most_tilts && !found(way.walk) && pass(head, way, options); ++k) {
    }
    if (found(way.walk)) return way;
  }
  return {};
}

}  // namespace robomill::path
