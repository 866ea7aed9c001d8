#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <utility>

#include "robomill/base/parallel.hpp"
#include "robomill/stability/chart/chart.hpp"

namespace robomill::stability::detail {
namespace {

/// One speed's radii, looked at from the lowest depth up to the first that is unstable: every fourth depth, and those
/// between two of them where stability changes, or where ln |μ| changes as much from one to the other as it is away
/// from 0, so that an island could hide. The others stay NaN.
class Climb {
 public:
  Climb(PointEvaluator& evaluator, const Axes& axes, std::size_t speed, const Progress& progress)
      : evaluator_(evaluator),
        axes_(axes),
        speed_(speed),
        progress_(progress),
        radii_(axes.axial_depth_m.size(), std::numeric_limits<double>::quiet_NaN()) {}

  std::vector<double> run() {
    // As many marks as are evaluated at once, but none further apart than the corners of a coarse cell.
    const std::size_t steps = radii_.size() - 1;
    const std::size_t stride = std::clamp<std::size_t>((steps + lane_count - 2) / (lane_count - 1), 1, widest);
    std::vector<std::size_t> marks;
    for (std::size_t d = 0; d < steps; d += stride) marks.push_back(d);
    marks.push_back(steps);
    for (std::size_t first = 0; first < marks.size(); first += evaluator_.at_a_time()) {
      const std::size_t size = std::min(evaluator_.at_a_time(), marks.size() - first);
      look(std::span(marks).subspan(first, size));
      for (std::size_t i = std::max<std::size_t>(first, 1); i < first + size; ++i) {
        if (between(marks[i - 1], marks[i])) return radii_;
      }
    }
    return radii_;
  }

 private:
  static constexpr std::size_t widest = 4;
  static_assert(widest - 1 <= lane_count);

  void look(std::span<const std::size_t> depths) {
    progress_.check();
    std::array<OperatingPoint, lane_count> points;
    std::array<Outcome, lane_count> outcomes;
    for (std::size_t i = 0; i < depths.size(); ++i) points[i] = axes_.at(speed_, depths[i]);
    evaluator_.evaluate(std::span(points).first(depths.size()), {}, std::span(outcomes).first(depths.size()));
    for (std::size_t i = 0; i < depths.size(); ++i) radii_[depths[i]] = outcomes[i].spectral_radius;
  }

  /// Whether an unstable depth was found from `low` to `high`.
  bool between(std::size_t low, std::size_t high) {
    if (radii_[low] >= 1.0) return true;
    const double a = std::log(radii_[low]);
    const double b = std::log(radii_[high]);
    const bool unstable = radii_[high] >= 1.0;
    if (!unstable && std::min(std::abs(a), std::abs(b)) > 2.0 * std::abs(a - b)) return false;
    std::array<std::size_t, widest> depths{};
    std::size_t size = 0;
    for (std::size_t d = low + 1; d < high; ++d) depths[size++] = d;
    if (size > 0) look(std::span<const std::size_t>(depths).first(size));
    return unstable || std::any_of(depths.begin(), depths.begin() + static_cast<std::ptrdiff_t>(size),
                                   [&](std::size_t d) { return radii_[d] >= 1.0; });
  }

  PointEvaluator& evaluator_;
  const Axes& axes_;
  std::size_t speed_;
  const Progress& progress_;
  std::vector<double> radii_;
};

/// A radius may be 0 to the last bit: nothing is left of a motion after one period.
double ln(double radius) {
  return std::log(std::max(radius, 1e-300));
}

/// One speed's search on fine axes, a depth at a time: every fourth depth that counts up to the first that is unstable,
/// those between two of them from the lowest up as Climb does, then a bracket down to two neighbouring depths.
class FineColumn {
 public:
  FineColumn(const Axes& axes, std::size_t speed)
      : speed_(speed), fine_(axes.fine), steps_((axes.axial_depth_m.size() - 1) / axes.fine) {}

  [[nodiscard]] bool closed() const { return phase_ == Phase::closed; }
  [[nodiscard]] bool found() const { return closed() && high_ > 0; }
  [[nodiscard]] std::size_t speed() const { return speed_; }
  /// Of one that found a limit the unstable depth above it, else the depth that came nearest to being unstable; and ln
  /// of its radius.
  [[nodiscard]] std::size_t top() const { return found() ? high_ : peak_; }
  [[nodiscard]] double value_at_top() const { return found() ? value_high_ : value_peak_; }
  /// From one depth to the next in the bracket.
  [[nodiscard]] double rise() const { return value_high_ - value_low_; }

  /// What to look at next.
  [[nodiscard]] std::size_t next() const {
    if (phase_ == Phase::marks) return mark_ * fine_;
    if (phase_ == Phase::inside) return inside_ * fine_;
    // By the secant, or in the middle where that did not halve the bracket.
    const std::size_t width = high_ - low_;
    if (before_ > 0 && 2 * width > before_) return low_ + width / 2;
    const double secant = std::round(-value_low_ / rise() * static_cast<double>(width));
    return low_ + static_cast<std::size_t>(std::clamp(secant, 1.0, static_cast<double>(width - 1)));
  }

  /// ln of the radius there.
  void take(double value) {
    const std::size_t at = next();
    if (value > value_peak_) {
      peak_ = at;
      value_peak_ = value;
    }
    if (phase_ == Phase::marks) return take_mark(value);
    if (phase_ == Phase::inside) {
      if (value >= 0.0) return open(inside_ - 1, value_inside_, inside_, value);
      value_inside_ = value;
      if (++inside_ == mark_) leave_mark();
      return;
    }
    before_ = high_ - low_;
    (value < 0.0 ? low_ : high_) = at;
    (value < 0.0 ? value_low_ : value_high_) = value;
    if (high_ - low_ <= 1) phase_ = Phase::closed;
  }

 private:
  enum class Phase { marks, inside, bracket, closed } phase_ = Phase::marks;
  static constexpr std::size_t stride = 4;

  void take_mark(double value) {
    value_mark_ = value;
    if (mark_ == 0) {
      if (value >= 0.0) phase_ = Phase::closed;  // unstable from the start: the peak says so
      if (value < 0.0) leave_mark();
      return;
    }
    const double nearest = std::min(std::abs(value_last_), std::abs(value));
    const bool could_hide = value >= 0.0 || nearest <= 2.0 * std::abs(value - value_last_);
    inside_ = last_ + 1;
    value_inside_ = value_last_;
    if (inside_ == mark_ || !could_hide) return leave_mark();
    phase_ = Phase::inside;
  }

  /// Nothing below the mark is unstable.
  void leave_mark() {
    if (value_mark_ >= 0.0) return open(mark_ - 1, value_inside_, mark_, value_mark_);
    last_ = mark_;
    value_last_ = value_mark_;
    phase_ = mark_ == steps_ ? Phase::closed : Phase::marks;
    mark_ = std::min(mark_ + stride, steps_);
  }

  void open(std::size_t low, double value_low, std::size_t high, double value_high) {
    low_ = low * fine_;
    high_ = high * fine_;
    value_low_ = value_low;
    value_high_ = value_high;
    phase_ = Phase::bracket;
  }

  std::size_t speed_, fine_, steps_;
  std::size_t mark_ = 0, last_ = 0;                                  ///< of depths that count
  std::size_t inside_ = 0;                                           ///< the same, between these two
  double value_mark_ = 0.0, value_last_ = 0.0, value_inside_ = 0.0;  ///< the last: of the depth below `inside_`
  std::size_t low_ = 0, high_ = 0, before_ = 0;  ///< the bracket, of all depths, and how wide it was
  double value_low_ = 0.0, value_high_ = 0.0;
  std::size_t peak_ = 0;
  double value_peak_ = -std::numeric_limits<double>::infinity();
};

/// Up to eight speeds of a chart on fine axes, a lane each.
class FineColumns {
 public:
  FineColumns(PointEvaluator& evaluator, const Axes& axes, const Progress& progress)
      : evaluator_(evaluator), axes_(axes), progress_(progress) {}

  /// Of the speeds from `first` on: roughly, and once more where the limit then is another one.
  void find(std::size_t first, std::span<Limit> limits) {
    std::vector<std::size_t> speeds(limits.size());
    std::iota(speeds.begin(), speeds.end(), first);
    for (const bool rough : {true, false}) {
      search(speeds, rough);
      speeds = finish(first, limits, rough);
      if (speeds.empty()) return;
    }
  }

 private:
  void search(const std::vector<std::size_t>& speeds, bool rough) {
    columns_.clear();
    for (const std::size_t speed : speeds) columns_.emplace_back(axes_, speed);
    for (;;) {
      progress_.check();
      std::array<FineColumn*, lane_count> open = {};
      std::size_t count = 0;
      for (FineColumn& column : columns_) {
        if (column.closed()) continue;
        points_[count] = axes_.at(column.speed(), column.next());
        open[count++] = &column;
      }
      if (count == 0) return;
      evaluator_.evaluate(std::span(points_).first(count), {.rough = rough}, std::span(outcomes_).first(count));
      for (std::size_t i = 0; i < count; ++i) open[i]->take(ln(outcomes_[i].spectral_radius));
    }
  }

  /// The limits with their motion. Of a rough search, the speeds whose limit is another one.
  std::vector<std::size_t> finish(std::size_t first, std::span<Limit> limits, bool rough) {
    std::vector<std::size_t> again;
    const std::size_t count = columns_.size();
    for (std::size_t i = 0; i < count; ++i) points_[i] = axes_.at(columns_[i].speed(), columns_[i].top());
    evaluator_.evaluate(std::span(points_).first(count), {.motion = true}, std::span(outcomes_).first(count));
    for (std::size_t i = 0; i < count; ++i) {
      const FineColumn& column = columns_[i];
      const double value = ln(outcomes_[i].spectral_radius);
      if (rough && !confirms(column, value)) {
        again.push_back(column.speed());
        continue;
      }
      Limit& limit = limits[column.speed() - first];
      limit.spindle_speed_rad_per_s = axes_.spindle_speed_rad_per_s[column.speed()];
      if (!column.found() && value < 0.0) continue;
      if (column.found()) points_[i].axial_depth_m = depth_of(column, value);
      limit = limit_at(boundary_point(points_[i], outcomes_[i]));
    }
    return again;
  }

  /// Whether ln |μ| at the top, looked at once more, leaves the limit where it is to one depth.
  static bool confirms(const FineColumn& column, double value) {
    const double moved = std::abs(value - column.value_at_top());
    if (!column.found()) return moved <= 0.25 * std::abs(column.value_at_top());
    return value >= 0.0 && moved <= column.rise();
  }

  /// Where ln |μ| is 0 on the straight line of the bracket's slope through what was found above it.
  [[nodiscard]] double depth_of(const FineColumn& column, double value_above) const {
    const double above_m = axes_.axial_depth_m[column.top()];
    const double step_m = above_m - axes_.axial_depth_m[column.top() - 1];
    return std::max(above_m - value_above / column.rise() * step_m, axes_.axial_depth_m.front());
  }

  PointEvaluator& evaluator_;
  const Axes& axes_;
  const Progress& progress_;
  std::vector<FineColumn> columns_;
  std::array<OperatingPoint, lane_count> points_ = {};
  std::array<Outcome, lane_count> outcomes_ = {};
};

}  // namespace

Limit limit_at(const BoundaryPoint& b) {
  Limit limit;
  limit.spindle_speed_rad_per_s = b.spindle_speed_rad_per_s;
  limit.status = Limit::Status::found;
  limit.axial_depth_m = b.axial_depth_m;
  limit.chatter_frequency_hz = b.chatter_frequency_hz;
  limit.kind = b.kind;
  limit.mode = b.mode;
  limit.error_estimate = b.error_estimate;
  return limit;
}

Limit limit_at_start(PointEvaluator& evaluator, const OperatingPoint& point) {
  Outcome outcome;
  evaluator.evaluate({&point, 1}, {.estimate = true, .motion = true}, {&outcome, 1});
  return limit_at(boundary_point(point, outcome));
}

Axes column_axes(const LobesOptions& options, std::vector<double> spindle_speed_rad_per_s) {
  const int steps = options.grid[1] - 1;
  const double step_m = (options.axial_depth_m[1] - options.axial_depth_m[0]) / steps;
  const int fine =
      options.limit_step_m > 0.0 ? std::max(2, static_cast<int>(std::ceil(step_m / options.limit_step_m))) : 1;
  return {std::move(spindle_speed_rad_per_s), even(options.axial_depth_m, steps * fine + 1),
          static_cast<std::size_t>(fine)};
}

std::vector<Limit> limits_between(PointEvaluator& evaluator, const Axes& axes, std::size_t first, std::size_t last,
                                  double tolerance, const Progress& progress) {
  std::vector<Limit> limits(last - first);
  if (axes.fine > 1) {
    FineColumns columns(evaluator, axes, progress);
    for (std::size_t s = 0; s < limits.size(); s += lane_count) {
      columns.find(first + s, std::span(limits).subspan(s, std::min(lane_count, limits.size() - s)));
    }
    return limits;
  }
  std::vector<Edge> edges;
  std::vector<std::size_t> owner;
  for (std::size_t s = first; s < last; ++s) {
    const std::vector<double> radii = Climb(evaluator, axes, s, progress).run();
    limits[s - first].spindle_speed_rad_per_s = axes.spindle_speed_rad_per_s[s];
    const auto unstable = std::ranges::find_if(radii, [](double radius) { return radius >= 1.0; });
    if (unstable == radii.begin()) {
      limits[s - first] = limit_at_start(evaluator, axes.at(s, 0));
    } else if (unstable != radii.end()) {
      const std::size_t d = static_cast<std::size_t>(unstable - radii.begin());
      edges.push_back({axes.at(s, d - 1), axes.at(s, d), radii[d - 1], radii[d]});
      owner.push_back(s - first);
    }
  }
  const std::vector<BoundaryPoint> found = refine(evaluator, edges, tolerance, progress);
  for (std::size_t i = 0; i < found.size(); ++i) limits[owner[i]] = limit_at(found[i]);
  return limits;
}

std::vector<Limit> column_limits(const Scheme& scheme, const Axes& axes, double tolerance, Count& count,
                                 Progress& progress) {
  const std::size_t speeds = axes.spindle_speed_rad_per_s.size();
  std::vector<Limit> limits(speeds);
  std::vector<Count> counts(speeds);
  progress.start("stability limits", speeds);
  parallel_for(speeds, lane_count, [&](std::size_t begin, std::size_t end) {
    const std::unique_ptr<PointEvaluator> evaluator = scheme.evaluator();
    const std::vector<Limit> found = limits_between(*evaluator, axes, begin, end, tolerance, progress);
    std::ranges::copy(found, limits.begin() + static_cast<std::ptrdiff_t>(begin));
    counts[begin].add(*evaluator);
    progress.advance(end - begin);
  });
  for (const Count& c : counts) count.add(c);
  return limits;
}

}  // namespace robomill::stability::detail
