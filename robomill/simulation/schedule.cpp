#include "robomill/simulation/schedule.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "robomill/base/error.hpp"

namespace robomill::simulation {
namespace {

void require_line(const char* member, const std::vector<Schedule::Point>& points, double least) {
  double before_s = 0.0;
  for (const Schedule::Point& point : points) {
    if (!(point.time_s >= before_s && std::isfinite(point.time_s))) {
      throw InvalidInput(member, point.time_s, "s", "must have times that do not fall, from 0");
    }
    if (!(point.share >= least && point.share <= 1.0)) {
      throw InvalidInput(member, point.share, "", "must be a share of the given value, at most 1",
                         "Give the cut its greatest depth and speed");
    }
    before_s = point.time_s;
  }
}

bool line_constant_after(const std::vector<Schedule::Point>& points, double time_s) {
  const double last = detail::Profile(points).at(time_s);
  return std::ranges::all_of(points, [&](const Schedule::Point& p) { return p.time_s <= time_s || p.share == last; });
}

}  // namespace

bool Schedule::constant_after(double time_s) const {
  return line_constant_after(depth, time_s) && line_constant_after(speed, time_s);
}

void Schedule::validate() const {
  require_line("schedule.depth", depth, 0.0);
  require_line("schedule.speed", speed, 0.01);
}

namespace detail {

Profile::Profile(const std::vector<Schedule::Point>& points) : points_(points) {
  integral_.reserve(points_.size());
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Schedule::Point& point = points_[i];
    if (i == 0) {
      integral_.push_back(point.share * point.time_s);
    } else {
      const Schedule::Point& last = points_[i - 1];
      integral_.push_back(integral_.back() + 0.5 * (last.share + point.share) * (point.time_s - last.time_s));
    }
  }
}

double Profile::at(double time_s) const {
  if (points_.empty()) return 1.0;
  const auto after = std::ranges::upper_bound(points_, time_s, {}, &Schedule::Point::time_s);
  if (after == points_.begin()) return points_.front().share;
  const Schedule::Point& last = *std::prev(after);
  if (after == points_.end()) return last.share;
  return last.share + (after->share - last.share) * (time_s - last.time_s) / (after->time_s - last.time_s);
}

double Profile::before(double time_s) const {
  if (points_.empty()) return time_s;
  const auto after = std::ranges::upper_bound(points_, time_s, {}, &Schedule::Point::time_s);
  if (after == points_.begin()) return points_.front().share * time_s;
  const Schedule::Point& last = *std::prev(after);
  const double so_far = integral_[static_cast<std::size_t>(std::distance(points_.begin(), after)) - 1];
  return so_far + 0.5 * (last.share + at(time_s)) * (time_s - last.time_s);
}

}  // namespace detail
}  // namespace robomill::simulation
