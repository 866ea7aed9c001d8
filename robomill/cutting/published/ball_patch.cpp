#include "robomill/cutting/published/ball_patch.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace robomill::cutting::detail {
namespace {

using std::numbers::pi;

constexpr double same_cosine = 1e-14;

}  // namespace

BallPatch::BallPatch(double radius_m, const Cut& cut, const Eigen::Matrix3d& feed_from_tool)
    : rotation_(feed_from_tool),
      axis_(feed_from_tool.col(2)),
      height_(1.0 - cut.axial_depth_m / radius_m),
      width_(std::sqrt(std::max(1.0 - height_ * height_, 0.0))),
      pitch_(cut.direction == MillingDirection::slot ? std::numeric_limits<double>::infinity()
                                                     : cut.radial_depth_m / radius_m),
      side_(cut.direction == MillingDirection::down ? 1.0 : -1.0) {
  // Angles along the curves are counted so that the neighbour lies at their start (up) or their end (down).
  double surface_from = -0.5 * pi;
  double feed_from = -std::acos(height_);
  const bool bounded = pitch_ < 2.0 * width_;
  if (bounded) {
    surface_from = std::asin(std::clamp(1.0 - pitch_ / width_, -1.0, 1.0));
    feed_from = -std::asin(0.5 * pitch_);
    add_curve(Bound::neighbour, 0.0, width_ * std::cos(surface_from));
  }
  add_curve(Bound::surface, surface_from, 0.5 * pi);
  add_curve(Bound::feed, feed_from, std::acos(height_));
  for (const Branch& branch : branches_) {
    for (const double cosine : {branch.cosine_from, branch.cosine_to}) {
      borders_.push_back(std::acos(std::clamp(cosine, -1.0, 1.0)));
    }
  }
  if (contains(-axis_)) borders_.push_back(0.0);
  std::ranges::sort(borders_);
  const auto twin = [](double x, double y) { return y - x < 1e-12; };
  borders_.erase(std::unique(borders_.begin(), borders_.end(), twin), borders_.end());
  // A border that passes the pole at a small distance is met at angles that turn as quickly as κ grows from there.
  constexpr double steepest = 3.0;
  std::vector<double> between;
  for (std::size_t i = 1; i < borders_.size(); ++i) {
    if (borders_[i - 1] <= 0.0) continue;
    const double ratio = borders_[i] / borders_[i - 1];
    const int parts = static_cast<int>(std::ceil(std::log(ratio) / std::log(steepest)));
    for (int k = 1; k < parts; ++k)
      between.push_back(borders_[i - 1] * std::pow(ratio, static_cast<double>(k) / parts));
  }
  borders_.insert(borders_.end(), between.begin(), between.end());
  std::ranges::sort(borders_);
}

/// surface: (w cos t, -s w sin t, -c); feed: (0, -s sin t, -cos t); neighbour: u_x = t.
Eigen::Vector3d BallPatch::at(Bound bound, double t) const {
  switch (bound) {
    case Bound::surface:
      return {width_ * std::cos(t), -side_ * width_ * std::sin(t), -height_};
    case Bound::feed:
      return {0.0, -side_ * std::sin(t), -std::cos(t)};
    default: {
      const double y = side_ * (pitch_ * pitch_ - t * t) / (2.0 * pitch_);
      return {t, y, -std::sqrt(std::max(1.0 - t * t - y * y, 0.0))};
    }
  }
}

bool BallPatch::contains(const Eigen::Vector3d& normal) const {
  if (!(normal.z() < -height_ && normal.x() > 0.0)) return false;
  if (!(pitch_ < 2.0 * width_)) return true;
  return pitch_ * pitch_ - 2.0 * side_ * pitch_ * normal.y() - normal.x() * normal.x() > 0.0;
}

void BallPatch::add_curve(Bound bound, double from, double to) {
  std::vector<double> ends = {from};
  if (bound == Bound::neighbour) {
    // Where cos κ turns along the curve: by looking, then by golden sections.
    constexpr int looks = 24;
    const auto value = [&](double t) { return cosine(bound, t); };
    for (int i = 1; i < looks; ++i) {
      const double step = (to - from) / looks;
      const double middle = from + i * step;
      const double rise = value(middle) - value(middle - step);
      const double fall = value(middle + step) - value(middle);
      if (rise * fall >= 0.0) continue;
      const double sign = rise > 0.0 ? 1.0 : -1.0;
      ends.push_back(highest_between([&](double t) { return sign * value(t); }, middle - step, middle + step));
    }
  } else {
    const double turns =
        bound == Bound::surface ? std::atan2(-side_ * axis_.y(), axis_.x()) : std::atan2(side_ * axis_.y(), axis_.z());
    for (const double t : {turns - pi, turns, turns + pi}) {
      if (t > from && t < to) ends.push_back(t);
    }
  }
  ends.push_back(to);
  for (std::size_t i = 1; i < ends.size(); ++i) {
    if (!(ends[i] > ends[i - 1])) continue;
    branches_.push_back({bound, ends[i - 1], ends[i], cosine(bound, ends[i - 1]), cosine(bound, ends[i])});
  }
}

double BallPatch::crossing(const Branch& branch, double cosine_wanted) const {
  if (branch.bound == Bound::neighbour) {
    const auto miss = [&](double t) { return cosine(branch.bound, t) - cosine_wanted; };
    return root_between(miss, branch.from, branch.to, branch.cosine_from - cosine_wanted,
                        branch.cosine_to - cosine_wanted);
  }
  // A cos(t - turns) = what is left of -cos κ.
  const bool surface = branch.bound == Bound::surface;
  const double across = surface ? width_ * std::hypot(axis_.x(), axis_.y()) : std::hypot(axis_.y(), axis_.z());
  const double turns = surface ? std::atan2(-side_ * axis_.y(), axis_.x()) : std::atan2(side_ * axis_.y(), axis_.z());
  const double left = surface ? height_ * axis_.z() - cosine_wanted : cosine_wanted;
  const double away = std::acos(std::clamp(left / across, -1.0, 1.0));
  const double middle = 0.5 * (branch.from + branch.to);
  double best = turns + away;
  for (const double t : {turns + away, turns - away, turns + away - 2.0 * pi, turns - away + 2.0 * pi}) {
    if (std::abs(t - middle) < std::abs(best - middle)) best = t;
  }
  return std::clamp(best, branch.from, branch.to);
}

ArcList BallPatch::arcs(double position_rad) const {
  struct Crossing {
    double angle = 0.0;
    Bound bound = Bound::none;
  };
  std::array<Crossing, ArcList::most> crossings;
  std::size_t count = 0;
  const double cosine_wanted = std::cos(position_rad);
  for (const Branch& branch : branches_) {
    const double before = branch.cosine_from - cosine_wanted;
    const double after = branch.cosine_to - cosine_wanted;
    if ((before > 0.0) == (after > 0.0) || std::abs(before - after) < same_cosine || count == crossings.size())
      continue;
    const Eigen::Vector3d normal = at(branch.bound, crossing(branch, cosine_wanted));
    double angle = std::atan2(normal.dot(rotation_.col(0)), normal.dot(rotation_.col(1)));
    if (angle < 0.0) angle += full_turn;
    crossings[count++] = {angle, branch.bound};
  }
  const double sine = std::sin(position_rad);
  const auto inside = [&](double angle) {
    return contains(rotation_ * Eigen::Vector3d(sine * std::sin(angle), sine * std::cos(angle), -cosine_wanted));
  };
  if (count == 0) return inside(0.0) ? ArcList::whole() : ArcList();
  const auto begin = crossings.begin();
  std::sort(begin, begin + static_cast<std::ptrdiff_t>(count),
            [](const Crossing& a, const Crossing& b) { return a.angle < b.angle; });
  ArcList found;
  for (std::size_t i = 0; i < count; ++i) {
    const Crossing& here = crossings[i];
    Crossing next = crossings[(i + 1) % count];
    if (i + 1 == count) next.angle += full_turn;
    if (!inside(0.5 * (here.angle + next.angle))) continue;
    found.add({.entry = here.angle, .exit = next.angle, .at_entry = here.bound, .at_exit = next.bound});
  }
  return found;
}

}  // namespace robomill::cutting::detail
