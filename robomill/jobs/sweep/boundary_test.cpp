#include "robomill/jobs/sweep/boundary.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/random.hpp"
#include "testing/support.hpp"

namespace robomill::jobs {
namespace boundary_test {

using test::rejection;
using Point = std::vector<double>;
using Function = std::function<double(const Point&)>;

constexpr double inf = std::numeric_limits<double>::infinity();

BoundaryOptions cube_of(std::size_t axes, double low, double high, int count, int halvings) {
  return {.axes = std::vector<BoundaryAxis>(axes, {.low = low, .high = high, .count = count}),
          .halvings = halvings,
          .most_points = 5'000'000,
          .interpolate = false};
}

Point point_of(const BoundaryGrid& grid, std::uint64_t number) {
  Point out;
  for (std::size_t axis = 0; axis < grid.axes(); ++axis) out.push_back(grid.coordinate(number, axis));
  return out;
}

/// Checks what the caller is promised of each batch, too.
Boundary trace(const BoundaryOptions& options, const Function& f) {
  const BoundaryGrid grid(options);
  std::set<std::uint64_t> asked;
  return trace_boundary(options, [&](std::span<const std::uint64_t> points) {
    EXPECT_TRUE(std::ranges::is_sorted(points));
    std::vector<double> out;
    for (const std::uint64_t point : points) {
      EXPECT_TRUE(asked.insert(point).second) << "a point is evaluated once";
      out.push_back(f(point_of(grid, point)));
    }
    return out;
  });
}

Point row(const Boundary& boundary, Eigen::Index i) {
  Point out;
  for (Eigen::Index k = 0; k < boundary.points.cols(); ++k) out.push_back(boundary.points(i, k));
  return out;
}

double length_of(const Point& x) {
  double squares = 0.0;
  for (const double value : x) squares += value * value;
  return std::sqrt(squares);
}

// Along an edge of length h f = |x|^2 - r^2 is a parabola of second derivative 2: where its chord is zero |f| <= h^2/4,
// and so ||x| - r| = |f| / (|x| + r) <= h^2 / (4 (|x| + r)).
TEST(Boundary, OfSpheresLiesWithinTheBoundOfTheStep) {
  constexpr std::array<std::pair<int, int>, 5> grids = {{{5, 5}, {5, 4}, {5, 2}, {4, 2}, {3, 2}}};
  for (std::size_t n = 2; n <= 6; ++n) {
    const auto [count, halvings] = grids[n - 2];
    BoundaryOptions options = cube_of(n, -1.5, 1.5, count, halvings);
    const double r = 1.2, h = 3.0 / ((count - 1) << halvings);
    const Function sphere = [&](const Point& x) { return length_of(x) * length_of(x) - r * r; };
    const Boundary found = trace(options, sphere);
    EXPECT_TRUE(found.complete);
    EXPECT_EQ(found.step, 1U);
    ASSERT_GT(found.points.rows(), 0);
    // Along each axis f is a parabola, which interpolation has exactly.
    options.interpolate = true;
    const Boundary interpolated = trace(options, sphere);
    EXPECT_EQ(interpolated.cubes, found.cubes);
    EXPECT_LT((interpolated.points - found.points).cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_LT(interpolated.evaluations, found.evaluations);
    EXPECT_EQ(interpolated.beyond_error, 0U);
    Point lowest(n, inf), highest(n, -inf);
    for (Eigen::Index i = 0; i < found.points.rows(); ++i) {
      const Point x = row(found, i);
      ASSERT_LE(std::abs(length_of(x) - r), h * h / (4.0 * (length_of(x) + r)) * (1.0 + 1e-9)) << n;
      for (std::size_t k = 0; k < n; ++k) {
        lowest[k] = std::min(lowest[k], x[k]);
        highest[k] = std::max(highest[k], x[k]);
      }
    }
    for (std::size_t k = 0; k < n; ++k) {
      EXPECT_NEAR(highest[k], r, h) << "it is whole";
      EXPECT_NEAR(lowest[k], -r, h);
    }
  }
}

TEST(Boundary, OfPlanesIsExact) {
  Random random(3);
  for (std::size_t n = 1; n <= 6; ++n) {
    Point normal;
    for (std::size_t k = 0; k < n; ++k) normal.push_back(random.uniform(0.2, 1.0) * (k % 2 == 0 ? 1.0 : -1.0));
    const auto f = [&](const Point& x) {
      double out = -0.1;
      for (std::size_t k = 0; k < n; ++k) out += normal[k] * x[k];
      return out;
    };
    const Boundary found = trace(cube_of(n, -1.0, 1.0, 3, n < 5 ? 3 : 1), f);
    ASSERT_GT(found.points.rows(), 0);
    for (Eigen::Index i = 0; i < found.points.rows(); ++i) ASSERT_NEAR(f(row(found, i)), 0.0, 1e-14) << n;
  }
}

/// Cubes of the finest grid with a change of sign, by all its points.
std::set<std::uint64_t> crossed_cubes(const BoundaryGrid& grid, const Function& f) {
  const auto total = static_cast<std::uint64_t>(grid.points_of(1));
  std::vector<double> values;
  for (std::uint64_t i = 0; i < total; ++i) values.push_back(f(point_of(grid, i)));
  std::set<std::uint64_t> out;
  for (std::uint64_t i = 0; i < total; ++i) {
    bool inside = true, below = false, above = false;
    for (std::size_t axis = 0; axis < 3; ++axis) inside = inside && grid.place(i, axis) + 1 < grid.count(axis);
    if (!inside) continue;
    for (unsigned corner = 0; corner < 8; ++corner) {
      std::uint64_t at = i;
      for (std::size_t axis = 0; axis < 3; ++axis) at += (corner >> axis & 1U) * grid.stride(axis);
      below |= values[at] < 0.0;
      above |= values[at] >= 0.0;
    }
    if (below && above) out.insert(i);
  }
  return out;
}

// A wave with a ridge that the coarse grid steps over, connected to what it sees.
TEST(Boundary, HasAllCubesThatAreConnectedToFoundOnes) {
  const BoundaryOptions options = cube_of(3, 0.0, 1.0, 4, 4);
  const BoundaryGrid grid(options);
  const auto wave = [](const Point& x) {
    return x[2] - 0.4 - 0.2 * std::sin(19.0 * x[0]) * std::cos(7.0 * x[1]) -
           0.5 * std::exp(-900.0 * std::pow(x[0] - 0.49, 2));
  };
  const Boundary found = trace(options, wave);
  EXPECT_TRUE(found.complete);
  EXPECT_EQ(std::set<std::uint64_t>(found.cubes.begin(), found.cubes.end()), crossed_cubes(grid, wave));
  EXPECT_EQ(found.grid_points, 49.0 * 49.0 * 49.0);
  EXPECT_LT(static_cast<double>(found.evaluations), 0.5 * found.grid_points);
  const BoundaryOptions coarse = cube_of(3, 0.0, 1.0, 4, 0);
  std::set<std::uint64_t> seen;
  const BoundaryGrid coarse_grid(coarse);
  for (const std::uint64_t cube : trace(coarse, wave).cubes) seen.insert(cube);
  std::size_t missed = 0;
  for (const std::uint64_t cube : found.cubes) {
    std::uint64_t parent = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) parent += grid.place(cube, axis) / 16 * coarse_grid.stride(axis);
    missed += seen.contains(parent) ? 0 : 1;
  }
  EXPECT_GT(missed, 100U) << "the ridge lies in cubes whose corners have one sign";
  // The ridge is narrower than the steps at which interpolation begins: evaluations that differ mend it.
  BoundaryOptions fewer = options;
  fewer.interpolate = true;
  const Boundary interpolated = trace(fewer, wave);
  EXPECT_LT(2 * interpolated.evaluations, found.evaluations);
  EXPECT_GT(interpolated.beyond_error, 10U);
  EXPECT_TRUE(std::ranges::includes(interpolated.cubes, found.cubes));
  EXPECT_LT(interpolated.cubes.size(), found.cubes.size() * 1005 / 1000);
}

TEST(Boundary, DoesNotSeeABallWithinACoarseCube) {
  const BoundaryOptions options = cube_of(3, 0.0, 1.0, 4, 4);
  const auto ball = [](const Point& x) { return length_of({x[0] - 0.5, x[1] - 0.5, x[2] - 0.5}) - 0.1; };
  EXPECT_FALSE(crossed_cubes(BoundaryGrid(options), ball).empty());
  EXPECT_TRUE(trace(options, ball).cubes.empty());
}

/// One mode, orthogonal cut: limit of the depth over k / K_s at a speed in turns a period, by the lobes
/// b = -1 / (2 K_s Re G(i w)), w tau = 2 arg G + 3 pi + 2 pi j. [Tlusty1963]
double turning_limit(double speed, double damping_ratio) {
  const auto phase = [&](double r) {  // of w tau, in turns
    const double arg = std::atan2(-2.0 * damping_ratio * r, 1.0 - r * r);
    return (2.0 * arg + 3.0 * std::numbers::pi) / (2.0 * std::numbers::pi);
  };
  double least = inf;
  const int first = std::max(0, static_cast<int>(std::ceil(1.0 / speed - 1.0)));
  for (int j = first; j < first + 3; ++j) {
    double low = 1.0, high = 50.0;
    for (int i = 0; i < 60; ++i) {
      const double r = 0.5 * (low + high);
      (r / (j + phase(r)) < speed ? low : high) = r;
    }
    const double a = low * low - 1.0, c = 2.0 * damping_ratio * low;
    least = std::min(least, (a * a + c * c) / (2.0 * a));
  }
  return least;
}

// A waved surface in four parameters: all signs that are interpolated are right.
TEST(Boundary, IsTheSameByInterpolationWhereTheFunctionIsSmooth) {
  BoundaryOptions options = cube_of(4, 0.0, 1.0, 5, 3);
  const auto wave = [](const Point& x) {
    return x[3] - 0.5 - 0.15 * std::sin(5.0 * x[0]) * std::cos(4.0 * x[1]) - 0.1 * std::exp(x[2]) * x[0];
  };
  const Boundary whole = trace(options, wave);
  options.interpolate = true;
  const Boundary found = trace(options, wave);
  EXPECT_EQ(found.cubes, whole.cubes);
  EXPECT_EQ(found.step, 1U);
  const double ratio = found.grid_points / static_cast<double>(found.evaluations);
  RecordProperty("grid_over_evaluations", std::to_string(ratio));
  EXPECT_GT(ratio, 30.0);
  EXPECT_EQ(found.evaluations + found.interpolated, whole.evaluations);
  EXPECT_GT(found.compared, 100U);
  EXPECT_EQ(found.beyond_error, 0U);
  ASSERT_EQ(found.points.rows(), whole.points.rows());
  EXPECT_LT((found.points - whole.points).cwiseAbs().maxCoeff(), 0.3 / 32.0) << "on the same edges";
}

// Creased along a plane, and with a step at another.
TEST(Boundary, IsTheSameByInterpolationAcrossACreaseAndAStep) {
  BoundaryOptions options = cube_of(4, 0.0, 1.0, 5, 3);
  const auto creased = [](const Point& x) {
    const double floor = 0.3 + 0.4 * std::abs(x[0] + 0.5 * x[1] - 0.61) + 0.1 * x[2];
    return x[3] - (x[2] + 0.3 * x[0] > 0.9 ? floor + 0.2 : floor);
  };
  const Boundary whole = trace(options, creased);
  options.interpolate = true;
  const Boundary found = trace(options, creased);
  EXPECT_GT(whole.evaluations, 2 * found.evaluations);
  EXPECT_EQ(found.cubes, whole.cubes);
  EXPECT_LT(found.beyond_error, found.compared / 1000);
}

/// Distances of points from where the closed form's depth is theirs, in steps of the grid, to first order.
double largest_deviation_steps(const BoundaryGrid& grid, const Boundary& found, const Function& height) {
  double most = 0.0;
  for (Eigen::Index i = 0; i < found.points.rows(); i += 97) {
    const Point x = row(found, i);
    double squares = 0.0;
    for (std::size_t axis = 0; axis < grid.axes(); ++axis) {
      const double step = grid.at(axis, 1.0) - grid.at(axis, 0.0);
      Point more = x, less = x;
      more[axis] += 0.5 * step;
      less[axis] -= 0.5 * step;
      squares += std::pow(height(more) - height(less), 2);
    }
    most = std::max(most, std::abs(height(x)) / std::sqrt(squares));
  }
  return most;
}

// The stability of a turned part over speed, depth, damping and stiffness, the last two as uncertain as they are.
TEST(Boundary, OfAStabilityLimitInFourParametersNeedsFewPointsOfTheGrid) {
  BoundaryOptions options = {.axes = {{.low = 0.6, .high = 1.2, .count = 33},
                                      {.low = 0.0, .high = 4.0, .count = 17},
                                      {.low = 0.027, .high = 0.033, .count = 3},
                                      {.low = 9.0, .high = 11.0, .count = 3}},
                             .halvings = 3,
                             .most_points = 5'000'000};
  const BoundaryGrid grid(options);
  std::vector<double> limits(grid.count(0) * grid.count(2), 0.0);
  const BoundaryValues heights = [&](std::span<const std::uint64_t> points) {
    std::vector<double> out;
    for (const std::uint64_t point : points) {
      double& limit = limits[grid.place(point, 0) * grid.count(2) + grid.place(point, 2)];
      if (limit == 0.0) limit = turning_limit(grid.coordinate(point, 0), grid.coordinate(point, 2));
      out.push_back(limit * grid.coordinate(point, 3) - grid.coordinate(point, 1));
    }
    return out;
  };
  for (const bool interpolate : {false, true}) {
    options.interpolate = interpolate;
    const Boundary found = trace_boundary(options, heights);
    EXPECT_TRUE(found.complete);
    const double ratio = found.grid_points / static_cast<double>(found.evaluations);
    RecordProperty(interpolate ? "grid_over_evaluations_interpolated" : "grid_over_evaluations", std::to_string(ratio));
    EXPECT_GT(ratio, interpolate ? 75.0 : 20.0);
    EXPECT_GT(found.points.rows(), 100'000);
    EXPECT_LT(
        largest_deviation_steps(grid, found, [](const Point& x) { return turning_limit(x[0], x[2]) * x[3] - x[1]; }),
        0.05);
  }
}

// It ends where the function has no values.
TEST(Boundary, StopsWhereTheFunctionHasNoValue) {
  BoundaryOptions options = cube_of(2, -1.5, 1.5, 8, 4);
  for (const bool interpolate : {false, true}) {
    options.interpolate = interpolate;
    const Boundary found =
        trace(options, [](const Point& x) { return x[0] > 0.3 ? std::nan("") : length_of(x) - 1.0; });
    EXPECT_GT(found.unknown, 0U);
    EXPECT_EQ(found.lost_cubes, 0U);
    ASSERT_GT(found.points.rows(), 0);
    EXPECT_LE(found.points.col(0).maxCoeff(), 0.3);
    EXPECT_GT(found.points.col(0).maxCoeff(), 0.3 - 2.0 * 3.0 / 112.0);
    EXPECT_EQ(found.cubes.size(), 178U);
  }
}

TEST(Boundary, BeginsAgainBehindASlitWithoutValues) {
  BoundaryOptions options = cube_of(2, 0.0, 1.0, 9, 4);
  const auto slit = [](const Point& x) {
    return std::abs(x[0] - 0.53) < 0.02 ? std::nan("") : x[1] - 0.52 - 0.1 * x[0] * x[0];
  };
  const Boundary whole = trace(options, slit);
  options.interpolate = true;
  const Boundary found = trace(options, slit);
  EXPECT_EQ(found.cubes, whole.cubes);
  EXPECT_GT(found.unknown, 0U);
  EXPECT_LT(2 * found.evaluations, whole.evaluations);
}

TEST(Boundary, SaysWhereNanHidesIt) {
  const BoundaryOptions line = cube_of(1, 0.0, 1.0, 4, 5);
  const Boundary gone =
      trace(line, [](const Point& x) { return std::abs(x[0] - 0.5) < 1e-3 ? std::nan("") : x[0] - 0.5; });
  EXPECT_EQ(gone.lost_cubes, 1U);
  EXPECT_TRUE(gone.cubes.empty());
  // The middles of a square's crossed sides are NaN, its centre is not.
  const Boundary through = trace(cube_of(2, 0.0, 1.0, 2, 1),
                                 [](const Point& x) { return x[1] == 0.5 && x[0] != 0.5 ? std::nan("") : x[1] - 0.4; });
  EXPECT_EQ(through.lost_cubes, 0U);
  ASSERT_EQ(through.points.rows(), 1);
  EXPECT_EQ(through.points(0, 0), 0.5);
  EXPECT_NEAR(through.points(0, 1), 0.4, 1e-15);
}

TEST(Boundary, LiesInTheMiddleOfAnEdgeToInfinity) {
  BoundaryOptions options = cube_of(1, 0.0, 1.0, 2, 3);
  for (const bool interpolate : {false, true}) {
    options.interpolate = interpolate;
    const Boundary found = trace(options, [](const Point& x) { return x[0] < 0.3 ? -1.0 : inf; });
    ASSERT_EQ(found.points.rows(), 1);
    EXPECT_EQ(found.middle_points, 1U);
    EXPECT_EQ(found.points(0, 0), (0.25 + 0.375) / 2.0);
  }
}

// At the limit it is, to the bit, what fewer halvings give.
TEST(Boundary, HasAtTheLimitTheLastWholeHalving) {
  const auto ball = [](const Point& x) { return length_of(x) - 1.0; };
  BoundaryOptions options = cube_of(3, -1.5, 1.5, 4, 5);
  options.interpolate = true;
  const Boundary whole = trace(options, ball);
  const std::uint64_t all = whole.evaluations + whole.interpolated;
  for (const std::uint64_t most : {std::uint64_t{64}, std::uint64_t{1000}, all - 1}) {
    options.most_points = most;
    const Boundary cut_off = trace(options, ball);
    EXPECT_FALSE(cut_off.complete);
    EXPECT_LE(cut_off.evaluations + cut_off.interpolated, most);
    ASSERT_GT(cut_off.step, 1U);
    int halvings = 5;
    for (std::uint64_t step = cut_off.step; step > 1; step /= 2) --halvings;
    BoundaryOptions coarser = cube_of(3, -1.5, 1.5, 4, halvings);
    coarser.interpolate = true;
    const Boundary fewer = trace(coarser, ball);
    EXPECT_EQ(cut_off.points, fewer.points);
    EXPECT_EQ(cut_off.cubes.size(), fewer.cubes.size());
    EXPECT_EQ(cut_off.grid_points, fewer.grid_points);
  }
  options.most_points = all;
  EXPECT_TRUE(trace(options, ball).complete);
}

TEST(Boundary, RejectsWhatIsNoGrid) {
  const auto says = [](BoundaryOptions options) { return rejection([&] { options.validate(); }); };
  EXPECT_EQ(says({}), "axes = 0; must be 1 to 8");
  EXPECT_EQ(says(cube_of(2, 1.0, 1.0, 3, 2)), "axes[0]: must have a range that rises");
  EXPECT_EQ(says(cube_of(2, 0.0, 1.0, 1, 2)), "axes[0].count = 1; must be >= 2");
  EXPECT_EQ(says(cube_of(2, 0.0, 1.0, 2, 21)), "halvings = 21; must lie between 0 and 20");
  EXPECT_NE(says(cube_of(8, 0.0, 1.0, 2, 20)).find("must leave the finest grid below"), std::string::npos);
  BoundaryOptions few = cube_of(3, 0.0, 1.0, 5, 2);
  few.most_points = 100;
  EXPECT_EQ(says(few), "most_points = 100 points; must be at least the 125 of the coarse grid");
  EXPECT_THROW(
      static_cast<void>(trace_boundary(cube_of(1, 0.0, 1.0, 2, 1), [](auto) { return std::vector<double>(); })),
      InvalidInput);
}

}  // namespace boundary_test
}  // namespace robomill::jobs
