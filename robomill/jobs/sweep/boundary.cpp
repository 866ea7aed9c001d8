#include "robomill/jobs/sweep/boundary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "robomill/base/error.hpp"

namespace robomill::jobs {
namespace {

constexpr std::size_t most_axes = 8;
constexpr int most_halvings = 20;
/// An edge has a number of its own: that of its point, and its axis.
constexpr double most_grid_points = 9.0e18 / most_axes;

enum class Sign { none, below, above };

Sign sign_of(double value) {
  if (std::isnan(value)) return Sign::none;
  return value < 0.0 ? Sign::below : Sign::above;
}

void sort_once(std::vector<std::uint64_t>& numbers) {
  std::ranges::sort(numbers);
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
}

/// Numbers are well spread already, but for those of corners, which differ by strides.
struct SpreadBits {
  std::size_t operator()(std::uint64_t number) const noexcept {
    number *= 0x9E3779B97F4A7C15U;
    return static_cast<std::size_t>(number ^ (number >> 32U));
  }
};

class BoundaryTracer {
 public:
  BoundaryTracer(const BoundaryOptions& options, const BoundaryValues& values)
      : options_(options),
        ask_(values),
        grid_(options),
        step_(std::uint64_t{1} << static_cast<unsigned>(options.halvings)) {
    set_corners();
  }

  Boundary run() {
    begin();
    for (int i = 0; i < options_.halvings && out_.complete; ++i) {
      const Numbers whole = cubes_;
      if (halve()) continue;
      out_.complete = false;
      cubes_ = whole;
      step_ = std::uint64_t{1} << static_cast<unsigned>(options_.halvings - i);
      set_corners();
    }
    out_.step = step_;
    out_.evaluations = known_.size();
    out_.grid_points = grid_.points_of(step_);
    find_points();
    out_.cubes = std::move(cubes_);
    return std::move(out_);
  }

 private:
  using Numbers = std::vector<std::uint64_t>;

  /// The corners of a cube, from its lowest: corner i is one step on along axis a where i has bit a.
  void set_corners() {
    corners_.assign(std::size_t{1} << grid_.axes(), 0);
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      for (std::size_t axis = 0; axis < grid_.axes(); ++axis) {
        if (on(i, axis)) corners_[i] += step_ * grid_.stride(axis);
      }
    }
  }

  [[nodiscard]] static bool on(std::size_t corner, std::size_t axis) { return (corner >> axis & 1U) != 0; }

  /// Evaluates what is not known of cubes that lie at these offsets. False: that is too much, and nothing is evaluated.
  bool evaluate(const Numbers& from, const Numbers& offsets) {
    Numbers asked;
    for (const std::uint64_t first : from) {
      for (const std::uint64_t offset : offsets) {
        if (known_.try_emplace(first + offset, 0.0).second) asked.push_back(first + offset);
      }
      if (known_.size() <= options_.most_points) continue;
      for (const std::uint64_t point : asked) known_.erase(point);
      return false;
    }
    if (asked.empty()) return true;
    std::ranges::sort(asked);
    const std::vector<double> values = ask_(asked);
    if (values.size() != asked.size()) {
      throw InvalidInput("values", fmt::format("are {} of {} points", values.size(), asked.size()));
    }
    for (std::size_t i = 0; i < asked.size(); ++i) {
      known_[asked[i]] = values[i];
      out_.unknown += std::isnan(values[i]) ? 1 : 0;
    }
    return true;
  }

  /// Two corners of a cube have different signs; of the corners of one of its faces where an axis is given.
  [[nodiscard]] bool changes(std::uint64_t cube, std::size_t axis = most_axes, bool side = false) const {
    bool below = false, above = false;
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      if (axis < most_axes && on(i, axis) != side) continue;
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
    evaluate(all, corners_);  // validate() has compared their number
    std::ranges::copy_if(all, std::back_inserter(cubes_), [this](std::uint64_t cube) { return changes(cube); });
    std::ranges::sort(cubes_);
  }

  /// False: it takes too many points.
  bool halve() {
    const Numbers whole = std::exchange(cubes_, {}), edges = crossed_edges(whole);
    step_ /= 2;
    Numbers middles;
    for (const std::uint64_t edge : edges) middles.push_back(start_of(edge) + step_ * grid_.stride(axis_of(edge)));
    if (!evaluate(middles, {0})) return false;
    set_corners();
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
    if (!evaluate(parts, corners_)) return false;
    std::erase_if(parts, [this](std::uint64_t cube) { return !changes(cube); });
    if (!follow(std::move(parts))) return false;
    for (const std::uint64_t cube : hidden) out_.lost_cubes += has_part(cube) ? 0 : 1;
    cubes_.assign(kept_.begin(), kept_.end());
    std::ranges::sort(cubes_);
    return true;
  }

  /// Keeps cubes that the boundary crosses, the neighbours across their faces that it crosses, theirs, ...
  bool follow(Numbers cubes) {
    while (!cubes.empty()) {
      sort_once(cubes);
      if (!evaluate(cubes, corners_)) return false;
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
  std::uint64_t step_;  ///< edge of the cubes, in steps of the finest grid
  Numbers corners_ = {}, cubes_ = {};
  std::unordered_set<std::uint64_t, SpreadBits> kept_ = {};  ///< cubes of the present halving
  std::unordered_map<std::uint64_t, double, SpreadBits> known_ = {};
  Boundary out_ = {};
};

}  // namespace

void BoundaryOptions::validate() const {
  if (axes.empty() || axes.size() > most_axes) {
    throw InvalidInput("axes", static_cast<double>(axes.size()), "", fmt::format("must be 1 to {}", most_axes));
  }
  if (halvings < 0 || halvings > most_halvings) {
    throw InvalidInput("halvings", halvings, "", fmt::format("must lie between 0 and {}", most_halvings));
  }
  double coarse = 1.0, finest = 1.0;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const std::string member = fmt::format("axes[{}]", i);
    const BoundaryAxis& axis = axes[i];
    if (!std::isfinite(axis.low) || !std::isfinite(axis.high) || !(axis.low < axis.high)) {
      throw InvalidInput(member, "must have a range that rises");
    }
    if (axis.count < 2) throw InvalidInput(member + ".count", axis.count, "", "must be >= 2");
    coarse *= axis.count;
    finest *= std::ldexp(axis.count - 1.0, halvings) + 1.0;
  }
  if (coarse > static_cast<double>(most_points)) {
    throw InvalidInput("most_points", static_cast<double>(most_points), "points",
                       fmt::format("must be at least the {} of the coarse grid", coarse));
  }
  if (finest > most_grid_points) {
    throw InvalidInput("halvings", halvings, "",
                       fmt::format("must leave the finest grid below {:.0e} points", most_grid_points));
  }
}

BoundaryGrid::BoundaryGrid(const BoundaryOptions& options) : axes_(options.axes) {
  options.validate();
  for (const BoundaryAxis& axis : axes_) {
    counts_.push_back((static_cast<std::uint64_t>(axis.count - 1) << static_cast<unsigned>(options.halvings)) + 1);
  }
  strides_.assign(axes_.size(), 1);
  for (std::size_t i = axes_.size() - 1; i > 0; --i) strides_[i - 1] = strides_[i] * counts_[i];
}

double BoundaryGrid::at(std::size_t axis, double place) const {
  const BoundaryAxis& one = axes_[axis];
  const double share = place / static_cast<double>(counts_[axis] - 1);
  return share >= 1.0 ? one.high : one.low + (one.high - one.low) * share;
}

double BoundaryGrid::points_of(std::uint64_t step) const {
  double out = 1.0;
  for (const std::uint64_t count : counts_) out *= static_cast<double>((count - 1) / step + 1);
  return out;
}

Boundary trace_boundary(const BoundaryOptions& options, const BoundaryValues& values) {
  return BoundaryTracer(options, values).run();
}

}  // namespace robomill::jobs
