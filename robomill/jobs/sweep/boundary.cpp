#include "robomill/jobs/sweep/boundary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/jobs/sweep/grid_values.hpp"

namespace robomill::jobs {
namespace {

constexpr std::size_t all_axes = static_cast<std::size_t>(-1);

enum class Sign { none, below, above };

Sign sign_of(double value) {
  if (std::isnan(value)) return Sign::none;
  return value < 0.0 ? Sign::below : Sign::above;
}

void sort_once(std::vector<std::uint64_t>& numbers) {
  std::ranges::sort(numbers);
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
}

class BoundaryTracer {
 public:
  BoundaryTracer(const BoundaryOptions& options, const BoundaryValues& values)
      : options_(options), ask_(values), grid_(options), known_(grid_) {
    set_step(coarse_step());
  }

  Boundary run() {
    begin();
    for (int i = 0; i < options_.halvings && out_.complete; ++i) {
      const Numbers whole = cubes_;
      if (halve()) continue;
      out_.complete = false;
      cubes_ = whole;
      set_step(coarse_step() >> static_cast<unsigned>(i));
    }
    out_.step = step_;
    out_.grid_points = grid_.points_of(step_);
    find_points();
    out_.cubes = std::move(cubes_);
    return std::move(out_);
  }

 private:
  using Numbers = std::vector<std::uint64_t>;

  /// Sets the corners of a cube, too, from its lowest: corner i is one step on along axis a where i has bit a.
  void set_step(std::uint64_t step) {
    step_ = step;
    corners_.assign(std::size_t{1} << grid_.axes(), 0);
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      for (std::size_t axis = 0; axis < grid_.axes(); ++axis) {
        if (on(i, axis)) corners_[i] += step_ * grid_.stride(axis);
      }
    }
  }

  [[nodiscard]] static bool on(std::size_t corner, std::size_t axis) { return (corner >> axis & 1U) != 0; }

  /// Finds the values of cubes' points at these offsets. False: there would be too many points, and nothing is done.
  bool find_values(const Numbers& cubes, const Numbers& offsets) {
    Numbers wanted;
    const auto are_too_many = [&] {
      sort_once(wanted);
      return known_.size() + wanted.size() > options_.most_points;
    };
    for (const std::uint64_t cube : cubes) {
      for (const std::uint64_t offset : offsets) {
        if (!known_.has(cube + offset)) wanted.push_back(cube + offset);
      }
      if (wanted.size() > 2 * options_.most_points && are_too_many()) return false;  // cubes share their corners
    }
    if (are_too_many()) return false;
    std::vector<Numbers> by_axes_between(grid_.axes() + 1);
    for (const std::uint64_t point : wanted) {
      by_axes_between[may_interpolate() ? known_.axes_between(point, step_) : 0].push_back(point);
    }
    for (const Numbers& points : by_axes_between) find_values_at(points);
    return true;
  }

  /// Of points that do not depend on each other.
  void find_values_at(const Numbers& points) {
    Numbers asked;
    std::vector<std::optional<GridValue>> expected;
    std::vector<std::pair<std::uint64_t, GridValue>> found;
    for (const std::uint64_t point : points) {
      const bool has_coarser = options_.interpolate && step_ < coarse_step();
      const std::optional<GridValue> between = has_coarser ? known_.interpolated(point, step_) : std::nullopt;
      if (between && may_interpolate() && std::abs(between->value) > between->error) {
        found.emplace_back(point, *between);
      } else {
        asked.push_back(point);
        expected.push_back(between);
      }
    }
    out_.interpolated += found.size();
    for (const auto& [point, value] : found) known_.set(point, value);
    if (!asked.empty()) evaluate(asked, expected);
  }

  void evaluate(const Numbers& points, const std::vector<std::optional<GridValue>>& expected) {
    const std::vector<double> values = ask_(points);
    if (values.size() != points.size()) {
      throw InvalidInput("values", fmt::format("are {} of {} points", values.size(), points.size()));
    }
    out_.evaluations += points.size();
    for (std::size_t i = 0; i < points.size(); ++i) {
      known_.set(points[i], {.value = values[i]});
      if (std::isnan(values[i])) {
        ++out_.unknown;
        errors_[points[i]] = std::numeric_limits<double>::infinity();
      }
      if (!expected[i]) continue;
      ++out_.compared;
      const double error = std::abs(values[i] - expected[i]->value);
      if (error <= expected[i]->error) continue;
      ++out_.beyond_error;
      if (!std::isnan(error)) errors_[points[i]] = error;
    }
  }

  [[nodiscard]] bool may_interpolate() const { return options_.interpolate && step_ < coarse_step() / 2; }
  [[nodiscard]] std::uint64_t coarse_step() const {
    return std::uint64_t{1} << static_cast<unsigned>(options_.halvings);
  }

  /// Two corners of a cube have different signs; of the corners of one of its faces where an axis is given.
  [[nodiscard]] bool changes(std::uint64_t cube, std::size_t axis = all_axes, bool side = false) const {
    bool below = false, above = false;
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      if (axis != all_axes && on(i, axis) != side) continue;
      const Sign sign = sign_of(known_.at(cube + corners_[i]));
      below |= sign == Sign::below;
      above |= sign == Sign::above;
      if (below && above) return true;
    }
    return false;
  }

  /// Every cube of the coarse grid.
  void begin() {
    Numbers all = {0};
    for (std::size_t axis = 0; axis < grid_.axes(); ++axis) {
      Numbers more;
      for (const std::uint64_t cube : all) {
        for (std::uint64_t place = 0; place + step_ < grid_.count(axis); place += step_) {
          more.push_back(cube + place * grid_.stride(axis));
        }
      }
      all = std::move(more);
    }
    find_values(all, corners_);  // validate() has compared their number
    std::ranges::copy_if(all, std::back_inserter(cubes_), [this](std::uint64_t cube) { return changes(cube); });
    std::ranges::sort(cubes_);
  }

  /// False: it takes too many points.
  bool halve() {
    const Numbers whole = std::exchange(cubes_, {}), edges = crossed_edges(whole);
    set_step(step_ / 2);
    Numbers middles;
    for (const std::uint64_t edge : edges) middles.push_back(start_of(edge) + step_ * grid_.stride(axis_of(edge)));
    if (!find_values(middles, {0})) return false;
    kept_.clear();
    if (!follow(around_crossed_halves(edges))) return false;
    const auto has_part = [this](std::uint64_t cube) {
      return std::ranges::any_of(corners_, [&](std::uint64_t corner) { return kept_.contains(cube + corner); });
    };
    // A point of NaN, since a path along edges between two signs has an edge that changes sign.
    Numbers hidden, parts;
    std::ranges::copy_if(whole, std::back_inserter(hidden), [&](std::uint64_t cube) { return !has_part(cube); });
    for (const std::uint64_t cube : hidden) {
      for (const std::uint64_t corner : corners_) parts.push_back(cube + corner);
    }
    if (!find_values(parts, corners_)) return false;
    std::erase_if(parts, [this](std::uint64_t cube) { return !changes(cube); });
    if (!follow(std::move(parts)) || !evaluate_doubtful()) return false;
    for (const std::uint64_t cube : hidden) out_.lost_cubes += has_part(cube) ? 0 : 1;
    cubes_.assign(kept_.begin(), kept_.end());
    std::ranges::sort(cubes_);
    return true;
  }

  /// Where a value differs by more than the error of its interpolation, or is NaN, the interpolated corners of the kept
  /// cubes around it that so great an error could have on the wrong side are evaluated; until there are none.
  bool evaluate_doubtful() {
    while (!errors_.empty()) {
      Numbers cubes(kept_.begin(), kept_.end()), doubtful;
      for (const std::uint64_t cube : cubes) {
        double error = 0.0;
        for (const std::uint64_t corner : corners_) {
          const auto found = errors_.find(cube + corner);
          if (found != errors_.end()) error = std::max(error, found->second);
        }
        for (const std::uint64_t corner : corners_) {
          const GridValue& value = known_.value(cube + corner);
          if (value.error > 0.0 && std::abs(value.value) <= error) doubtful.push_back(cube + corner);
        }
      }
      errors_.clear();
      if (doubtful.empty()) return true;
      sort_once(doubtful);
      std::vector<std::optional<GridValue>> expected;
      for (const std::uint64_t point : doubtful) expected.emplace_back(known_.value(point));
      out_.interpolated -= doubtful.size();
      evaluate(doubtful, expected);
      std::erase_if(cubes, [this](std::uint64_t cube) { return !changes(cube); });
      kept_.clear();
      if (!follow(std::move(cubes))) return false;
    }
    return true;
  }

  /// Keeps cubes that the boundary crosses, the neighbours across their faces that it crosses, theirs, ...
  bool follow(Numbers cubes) {
    while (!cubes.empty()) {
      sort_once(cubes);
      if (!find_values(cubes, corners_)) return false;
      kept_.insert(cubes.begin(), cubes.end());
      Numbers next;
      for (const std::uint64_t cube : cubes) add_crossed_neighbours(cube, next);
      cubes = std::move(next);
    }
    return true;
  }

  void add_crossed_neighbours(std::uint64_t cube, Numbers& to) const {
    for (std::size_t axis = 0; axis < grid_.axes(); ++axis) {
      const std::uint64_t place = grid_.place(cube, axis), across = step_ * grid_.stride(axis);
      for (const bool side : {false, true}) {
        if (side ? place + 2 * step_ >= grid_.count(axis) : place == 0) continue;
        const std::uint64_t neighbour = side ? cube + across : cube - across;
        if (!kept_.contains(neighbour) && changes(cube, axis, side)) to.push_back(neighbour);
      }
    }
  }

  // An edge is one number: its start and its axis.
  [[nodiscard]] std::uint64_t edge_at(std::uint64_t start, std::size_t axis) const {
    return start * grid_.axes() + axis;
  }
  [[nodiscard]] std::uint64_t start_of(std::uint64_t edge) const { return edge / grid_.axes(); }
  [[nodiscard]] std::size_t axis_of(std::uint64_t edge) const { return edge % grid_.axes(); }
  [[nodiscard]] bool crosses(std::uint64_t start, std::size_t axis) const {
    const Sign from = sign_of(known_.at(start)), to = sign_of(known_.at(start + step_ * grid_.stride(axis)));
    return from != Sign::none && to != Sign::none && from != to;
  }

  /// Of cubes, each once; they rise.
  [[nodiscard]] Numbers crossed_edges(const Numbers& cubes) const {
    Numbers out;
    for (const std::uint64_t cube : cubes) {
      for (std::size_t i = 0; i < corners_.size(); ++i) {
        for (std::size_t axis = 0; axis < grid_.axes(); ++axis) {
          if (!on(i, axis) && crosses(cube + corners_[i], axis)) out.push_back(edge_at(cube + corners_[i], axis));
        }
      }
    }
    sort_once(out);
    return out;
  }

  /// Cubes that have a half of these edges which is crossed.
  [[nodiscard]] Numbers around_crossed_halves(const Numbers& edges) const {
    Numbers out;
    for (const std::uint64_t edge : edges) {
      const std::size_t along = axis_of(edge);
      for (const std::uint64_t half : {start_of(edge), start_of(edge) + step_ * grid_.stride(along)}) {
        if (crosses(half, along)) add_cubes_around(half, along, out);
      }
    }
    sort_once(out);
    return out;
  }

  void add_cubes_around(std::uint64_t start, std::size_t along, Numbers& to) const {
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      if (on(i, along)) continue;
      bool inside = true;
      for (std::size_t axis = 0; axis < grid_.axes() && inside; ++axis) {
        const std::uint64_t place = grid_.place(start, axis);
        inside = on(i, axis) ? place >= step_ : place + step_ < grid_.count(axis);
      }
      if (inside) to.push_back(start - corners_[i]);
    }
  }

  void find_points() {
    const Numbers edges = crossed_edges(cubes_);
    out_.points.resize(static_cast<Eigen::Index>(edges.size()), static_cast<Eigen::Index>(grid_.axes()));
    for (std::size_t i = 0; i < edges.size(); ++i) {
      set_point(static_cast<Eigen::Index>(i), start_of(edges[i]), axis_of(edges[i]));
    }
  }

  void set_point(Eigen::Index row, std::uint64_t from, std::size_t along) {
    const double first = known_.at(from), second = known_.at(from + step_ * grid_.stride(along));
    const bool finite = std::isfinite(first) && std::isfinite(second);
    out_.middle_points += finite ? 0 : 1;
    const double share = finite ? first / (first - second) : 0.5;
    for (std::size_t axis = 0; axis < grid_.axes(); ++axis) {
      const auto place = static_cast<double>(grid_.place(from, axis));
      const double on = axis == along ? share * static_cast<double>(step_) : 0.0;
      out_.points(row, static_cast<Eigen::Index>(axis)) = grid_.at(axis, place + on);
    }
  }

  const BoundaryOptions& options_;
  const BoundaryValues& ask_;
  BoundaryGrid grid_;
  std::uint64_t step_ = 1;  ///< edge of the cubes, in steps of the finest grid
  Numbers corners_ = {}, cubes_ = {};
  std::unordered_set<std::uint64_t, GridPointHash> kept_ = {};  ///< cubes of the present halving
  GridValues known_;
  /// Of interpolation, where they are beyond the estimate; infinite where a value is NaN.
  std::unordered_map<std::uint64_t, double, GridPointHash> errors_ = {};
  Boundary out_ = {};
};

}  // namespace

Boundary trace_boundary(const BoundaryOptions& options, const BoundaryValues& values) {
  return BoundaryTracer(options, values).run();
}

}  // namespace robomill::jobs
