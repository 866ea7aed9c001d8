#include "robomill/path/speed/speed.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "robomill/base/lanes.hpp"
#include "robomill/base/random.hpp"
#include "testing/support.hpp"

namespace robomill::path {
namespace speed_test {

using robomill::test::seeds;
using Kind = Segment::Kind;

/// Derivatives of all channels by u.
struct Derivatives {
  Channels c1 = {}, c2 = {}, c3 = {};
};
using Curve = std::function<Derivatives(double u_m)>;

ChannelLimits limits(double velocity, double acceleration, double jerk) {
  ChannelLimits out;
  out.velocity.fill(velocity);
  out.acceleration.fill(acceleration);
  out.jerk.fill(jerk);
  return out;
}

/// A row from rest to rest, segments growing from `rest_m` at both ends to `segment_m`, at safe terminal speeds.
struct Row {
  std::vector<SpeedSegment> segments;
  std::vector<double> begin_m;

  Row(const SpeedSolver& solver, const Curve& curve, double length_m, double rest_m, double segment_m,
      double growth = 1.5) {
    std::vector<double> half;
    double sum = 0.0;
    for (double step = rest_m; sum + step < 0.5 * length_m; step = std::min(segment_m, growth * step)) {
      half.push_back(step);
      sum += step;
    }
    for (double& step : half) step *= 0.5 * length_m / sum;
    std::vector<double> all = half;
    all.insert(all.end(), half.rbegin(), half.rend());
    double u_m = 0.0;
    for (std::size_t i = 0; i < all.size(); ++i) {
      SpeedSegment segment;
      segment.kind = i == 0 ? Kind::from_rest : i + 1 == all.size() ? Kind::to_rest : Kind::cruise;
      segment.length_m = all[i];
      for (std::size_t p = 0; p < point_count; ++p) {
        const Derivatives d = curve(u_m + segment.share[p] * all[i]);
        PathPoint& point = segment.point[p];
        point.c1 = d.c1;
        point.c2 = d.c2;
        point.c3 = d.c3;
        point.max_b = 1e300;
        for (std::size_t k = 0; k < channel_count; ++k) {
          point.max_b =
              std::min(point.max_b, std::pow(solver.limits().velocity[k] / std::max(std::abs(d.c1[k]), 1e-9), 2));
        }
      }
      segment.safe_b = solver.own_safe_b(segment);
      segments.push_back(segment);
      begin_m.push_back(u_m);
      u_m += all[i];
    }
    for (std::size_t i = 0; i < segments.size(); ++i) {
      segments[i].b = segments[i].safe_b;
      if (i > 0) segments[i].b = std::min(segments[i].b, segments[i - 1].safe_b);
      if (i + 1 < segments.size()) segments[i].b = std::min(segments[i].b, segments[i + 1].safe_b);
      segments[i].b *= 0.9;
    }
  }

  /// What is driven.
  [[nodiscard]] std::vector<Segment> motion() const {
    std::vector<Segment> out;
    for (std::size_t i = 0; i < segments.size(); ++i) {
      Segment segment{.kind = segments[i].kind, .begin_m = begin_m[i], .length_m = segments[i].length_m};
      if (segment.kind == Kind::from_rest) {
        segment.end_b = ends_of(segments.data(), segments.size(), i + 1).begin_b;
      } else if (segment.kind == Kind::to_rest) {
        segment.begin_b = ends_of(segments.data(), segments.size(), i - 1).end_b;
      } else {
        const SegmentEnds ends = ends_of(segments.data(), segments.size(), i);
        segment.begin_b = ends.begin_b;
        segment.middle_b = segments[i].b;
        segment.end_b = ends.end_b;
      }
      out.push_back(segment);
    }
    return out;
  }
  [[nodiscard]] double time_s() const {
    double sum = 0.0;
    for (const Segment& segment : motion()) sum += duration_s(segment);
    return sum;
  }
};

/// b, b', b'' of a segment at a share of it, in its own words.
struct Rates {
  double b, first, second;
};
Rates rates(const Segment& segment, double s) {
  const double d = segment.length_m, r = 1.0 - s;
  if (segment.kind == Kind::from_rest) {
    return {segment.end_b * std::pow(s, 4.0 / 3.0), 4.0 / 3.0 * segment.end_b * std::cbrt(s) / d,
            4.0 / 9.0 * segment.end_b * std::pow(s, -2.0 / 3.0) / (d * d)};
  }
  if (segment.kind == Kind::to_rest) {
    return {segment.begin_b * std::pow(r, 4.0 / 3.0), -4.0 / 3.0 * segment.begin_b * std::cbrt(r) / d,
            4.0 / 9.0 * segment.begin_b * std::pow(r, -2.0 / 3.0) / (d * d)};
  }
  return {r * r * segment.begin_b + 2.0 * r * s * segment.middle_b + s * s * segment.end_b,
          2.0 / d * (r * (segment.middle_b - segment.begin_b) + s * (segment.end_b - segment.middle_b)),
          2.0 / (d * d) * (segment.begin_b - 2.0 * segment.middle_b + segment.end_b)};
}

/// The largest share of any limit that is used at the points.
double used(const Row& row, const ChannelLimits& limits, bool jerk = true) {
  double out = 0.0;
  const std::vector<Segment> motion = row.motion();
  for (std::size_t i = 0; i < motion.size(); ++i) {
    for (std::size_t p = 0; p < point_count; ++p) {
      const PathPoint& point = row.segments[i].point[p];
      const Rates at = rates(motion[i], row.segments[i].share[p]);
      const double f = point.speed;
      out = std::max(out, at.b / point.max_b);
      for (std::size_t k = 0; k < channel_count; ++k) {
        const double a = point.c2[k] * at.b + 0.5 * point.c1[k] * at.first;
        const double j =
            std::sqrt(at.b) * (point.c3[k] * at.b + 1.5 * point.c2[k] * at.first + 0.5 * point.c1[k] * at.second);
        out = std::max(out, std::abs(a) / (limits.acceleration[k] * f * f));
        if (jerk) out = std::max(out, std::abs(j) / (limits.jerk[k] * f * f * f));
      }
    }
  }
  return out;
}

/// Rest to rest over a length with limits of speed, acceleration and jerk: the seven phases.
double seven_phases_s(double length, double v, double a, double j) {
  // Time and way to reach a speed.
  const auto time = [&](double to) { return to * j > a * a ? to / a + a / j : 2.0 * std::sqrt(to / j); };
  const auto way = [&](double to) { return 0.5 * to * time(to); };
  if (2.0 * way(v) <= length) return 2.0 * time(v) + (length - 2.0 * way(v)) / v;
  double low = 0.0, high = v;
  for (int i = 0; i < 200; ++i) (2.0 * way(0.5 * (low + high)) < length ? low : high) = 0.5 * (low + high);
  return 2.0 * time(low);
}

Derivatives straight(double /*u_m*/) {
  Derivatives out;
  out.c1.fill(1e-3);
  out.c1[6] = 1.0;
  return out;
}

// The closed form is the optimum over all motions, so that none is faster.
TEST(Speed, ReachesTheSevenPhaseProfileOnALine) {
  struct Case {
    double length, v, a, j;
  };
  for (const Case& c : {Case{0.1, 0.05, 0.5, 10.0}, Case{0.004, 0.05, 0.5, 10.0}, Case{0.001, 0.05, 0.5, 10.0},
                        Case{0.05, 0.3, 1.0, 20.0}, Case{0.5, 0.3, 1.0, 5.0}}) {
    ChannelLimits most = limits(c.v, c.a, c.j);
    SpeedSolver solver(most, 4000);
    const double fall_m = c.a * c.a * c.a / (6.0 * c.j * c.j);
    // A resting segment runs at constant jerk: nearly all of the first phase.
    Row row(solver, straight, c.length, 0.9 * std::min(fall_m, c.length / 12.0),
            std::min(0.02 * c.v * c.v / c.a, 0.004 * c.length), 1.1);
    const SpeedResult result = solver.solve(row.segments.data(), row.segments.size(), 0, row.segments.size(),
                                            {.relative_gap = 1e-4, .max_iterations = 200});
    EXPECT_TRUE(result.converged);
    const double best_s = seven_phases_s(c.length, c.v, c.a, c.j), time_s = row.time_s();
    EXPECT_LT(time_s, 1.003 * best_s) << c.length << " m: " << time_s / best_s << " with " << row.segments.size();
    EXPECT_GT(time_s, best_s * (1.0 - 1e-5)) << c.length << " m: " << time_s / best_s;
    EXPECT_NEAR(result.duration_s, time_s, 2e-3 * time_s);
    EXPECT_LT(used(row, most), 1.0 + 1e-9);
  }
}

/// Channels that swing along the way, c2 and c3 true derivatives of c1.
Curve swinging(std::uint64_t seed, double shortest_m) {
  Random random(seed);
  std::array<std::array<double, 4>, channel_count> wave{};
  for (auto& w : wave)
    w = {random.uniform(-1.0, 1.0), random.uniform(0.2, 1.0), random.uniform(0.0, 6.0),
         6.283 / (shortest_m * random.uniform(1.0, 3.0))};
  return [wave](double u) {
    Derivatives out;
    for (std::size_t k = 0; k < channel_count; ++k) {
      const auto& [mean, size, phase, rate] = wave[k];
      out.c1[k] = mean + size * std::sin(rate * u + phase);
      out.c2[k] = size * rate * std::cos(rate * u + phase);
      out.c3[k] = -size * rate * rate * std::sin(rate * u + phase);
    }
    return out;
  };
}

/// The fastest with velocity and acceleration limits on a fine grid, by controllable sets backwards and the largest
/// acceleration forwards. Constraints at a grid point, x = b, a = b'/2: |c2 x + c1 a| <= A, x <= max.
double reachable_time_s(const Curve& curve, const ChannelLimits& most, double length_m, int steps) {
  const double d = length_m / steps;
  std::vector<Derivatives> at(static_cast<std::size_t>(steps) + 1);
  for (std::size_t i = 0; i < at.size(); ++i) at[i] = curve(d * static_cast<double>(i));
  const auto range = [&](std::size_t i, double x, double top) {  // of a, so that the next x is in [0, top]
    double low = -x / (2.0 * d), high = (top - x) / (2.0 * d);
    for (std::size_t k = 0; k < channel_count; ++k) {
      const double c1 = at[i].c1[k], bias = at[i].c2[k] * x;
      if (std::abs(c1) < 1e-12) continue;
      const double one = (-most.acceleration[k] - bias) / c1, two = (most.acceleration[k] - bias) / c1;
      low = std::max(low, std::min(one, two));
      high = std::min(high, std::max(one, two));
    }
    return std::pair{low, high};
  };
  std::vector<double> top(at.size(), 0.0);
  for (std::size_t i = at.size() - 1; i-- > 0;) {
    double max = 1e300;
    for (std::size_t k = 0; k < channel_count; ++k) {
      max = std::min(max, std::pow(most.velocity[k] / std::max(1e-12, std::abs(at[i].c1[k])), 2));
    }
    double low = 0.0, high = max;
    for (int turn = 0; turn < 60; ++turn) {
      const double x = turn == 0 ? high : 0.5 * (low + high);
      const auto [from, to] = range(i, x, top[i + 1]);
      (from <= to ? low : high) = x;
      if (turn == 0 && from <= to) break;
    }
    top[i] = low;
  }
  double x = 0.0, time_s = 0.0;
  for (std::size_t i = 0; i + 1 < at.size(); ++i) {
    const double next = std::clamp(x + 2.0 * d * range(i, x, top[i + 1]).second, 0.0, top[i + 1]);
    time_s += 2.0 * d / (std::sqrt(x) + std::sqrt(next));
    x = next;
  }
  return time_s;
}

TEST(Speed, AgreesWithReachabilityAnalysisWithoutJerk) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const ChannelLimits most = limits(0.2, 1.0, 1e9);
    const Curve curve = swinging(seed, 0.02);
    SpeedSolver solver(most, 4000);
    Row row(solver, curve, 0.1, 2e-6, 5e-5, 1.15);
    const SpeedResult result = solver.solve(row.segments.data(), row.segments.size(), 0, row.segments.size(),
                                            {.relative_gap = 1e-4, .max_iterations = 200});
    EXPECT_TRUE(result.converged);
    const double best_s = reachable_time_s(curve, most, 0.1, 20000);
    EXPECT_NEAR(row.time_s(), best_s, 0.005 * best_s) << seed << ": " << row.time_s() / best_s;
    EXPECT_LT(used(row, most, false), 1.0 + 1e-9);
  }
}

/// Coefficients drawn anew at each place, of all sizes, some of them 0.
Curve wild(std::uint64_t seed) {
  return [seed](double u) {
    Random random(seed, static_cast<std::uint64_t>(u * 1e12));
    Derivatives out;
    for (std::size_t k = 0; k < channel_count; ++k) {
      if (random.uniform() < 0.1) continue;
      out.c1[k] = random.normal() * std::pow(10.0, random.uniform(-3.0, 0.0));
      out.c2[k] = random.normal() * std::pow(10.0, random.uniform(-1.0, 3.0));
      out.c3[k] = random.normal() * std::pow(10.0, random.uniform(1.0, 6.0));
    }
    return out;
  };
}

// Wherever it stops, every limit holds at every point.
TEST(Speed, EveryIterateIsWithinLimits) {
  int converged = 0, all = 0;
  for (int seed = 0; seed < seeds(300); ++seed) {
    const ChannelLimits most = limits(0.2, 1.0, 30.0);
    SpeedSolver solver(most, 1000);
    const Curve curve =
        seed % 2 == 0 ? wild(static_cast<std::uint64_t>(seed)) : swinging(static_cast<std::uint64_t>(seed), 0.005);
    const Row start(solver, curve, 0.05, 1e-4, seed % 3 == 0 ? 1e-3 : 3e-4);
    double before_s = start.time_s();
    ASSERT_LT(used(start, most), 1.0) << seed;
    for (const int iterations : {1, 3, 10, 80}) {
      Row row = start;
      const SpeedResult result = solver.solve(row.segments.data(), row.segments.size(), 0, row.segments.size(),
                                              {.max_iterations = iterations});
      EXPECT_LE(used(row, most), 1.0 + 1e-9) << seed << ' ' << iterations;
      EXPECT_LE(row.time_s(), before_s * 1.001) << seed << ' ' << iterations;
      for (const SpeedSegment& segment : row.segments) ASSERT_TRUE(std::isfinite(segment.b) && segment.b > 0.0) << seed;
      before_s = row.time_s();
      if (iterations == 80) converged += result.converged ? 1 : 0;
    }
    ++all;
  }
  EXPECT_GE(converged, (9 * all) / 10) << "of " << all;
}

// Segments taken over keep their speed, and those after them go on within limits.
TEST(Speed, KeepsWhatIsTakenOver) {
  const ChannelLimits most = limits(0.2, 1.0, 30.0);
  SpeedSolver solver(most, 2000);
  const Curve curve = swinging(3, 0.02);
  Row row(solver, curve, 0.1, 1e-4, 5e-4);
  const std::size_t size = row.segments.size(), window = size / 2;
  solver.solve(row.segments.data(), window, 0, window - 2, {});
  const std::vector<SpeedSegment> first = row.segments;
  solver.solve(row.segments.data(), size, window / 2, size, {});
  for (std::size_t i = 0; i < window / 2; ++i) ASSERT_EQ(row.segments[i].b, first[i].b);
  EXPECT_LT(used(row, most), 1.0 + 1e-9);
  Row whole(solver, curve, 0.1, 1e-4, 5e-4);
  solver.solve(whole.segments.data(), size, 0, size, {});
  EXPECT_LT(row.time_s(), 1.02 * whole.time_s());
}

TEST(Speed, IsTheSameOnAllKernels) {
  const ChannelLimits most = limits(0.2, 1.0, 30.0);
  SpeedSolver solver(most, 1000);
  const Kernels best = best_kernels();
  std::vector<double> first;
  for (const Kernels variant : {Kernels::baseline, Kernels::avx2, Kernels::avx512}) {
    if (variant > best) continue;
    kernels() = variant;
    Row row(solver, swinging(5, 0.01), 0.05, 1e-4, 5e-4);
    solver.solve(row.segments.data(), row.segments.size(), 0, row.segments.size(), {});
    kernels() = best;
    std::vector<double> b;
    for (const SpeedSegment& segment : row.segments) b.push_back(segment.b);
    if (first.empty()) first = b;
    EXPECT_EQ(b, first) << static_cast<int>(variant);
  }
}

TEST(Speed, HardlyGainsFromHalvingTheSegments) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const ChannelLimits most = limits(0.2, 1.0, 30.0);
    SpeedSolver solver(most, 4000);
    const Curve curve = swinging(seed, 0.02);
    double time_s[2];
    for (int fine = 0; fine < 2; ++fine) {
      Row row(solver, curve, 0.1, fine == 0 ? 1e-4 : 5e-5, fine == 0 ? 5e-4 : 2.5e-4);
      solver.solve(row.segments.data(), row.segments.size(), 0, row.segments.size(),
                   {.relative_gap = 1e-4, .max_iterations = 200});
      time_s[fine] = row.time_s();
    }
    EXPECT_NEAR(time_s[1], time_s[0], 0.01 * time_s[0]) << seed;
    // And never without the jerk faster than the acceleration allows.
    EXPECT_GT(time_s[1], reachable_time_s(curve, most, 0.1, 10000)) << seed;
  }
}

// A limit scaled by s at all places takes 1 / s of the time: speed s, acceleration s², jerk s³.
TEST(Speed, ScalesWithTime) {
  const ChannelLimits most = limits(0.2, 1.0, 30.0);
  SpeedSolver solver(most, 2000);
  const Curve curve = swinging(7, 0.02);
  Row plain(solver, curve, 0.1, 1e-4, 5e-4), slow = plain;
  for (SpeedSegment& segment : slow.segments) {
    segment.b *= 0.25;
    segment.safe_b *= 0.25;
    for (PathPoint& point : segment.point) {
      point.speed = 0.5;
      point.max_b *= 0.25;
    }
  }
  solver.solve(plain.segments.data(), plain.segments.size(), 0, plain.segments.size(),
               {.relative_gap = 1e-5, .max_iterations = 200});
  solver.solve(slow.segments.data(), slow.segments.size(), 0, slow.segments.size(),
               {.relative_gap = 1e-5, .max_iterations = 200});
  EXPECT_NEAR(slow.time_s(), 2.0 * plain.time_s(), 1e-4 * slow.time_s());
}

}  // namespace speed_test
}  // namespace robomill::path
