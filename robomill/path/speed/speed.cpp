#include "robomill/path/speed/speed.hpp"

#include <algorithm>
#include <cmath>

#include "robomill/path/speed/speed_kernels.hpp"

namespace robomill::path {
namespace {

/// Of a safe terminal speed's b, the least that is looked at.
constexpr double floor_share = 0.1;
/// Of the time that a step promises, for the barrier; found by trying: 0.3 to 4 need about as many iterations.
constexpr double promise_weight = 2.0;

/// Bézier (begin, middle, end) to (b, b', b'') at a share of the length.
void bezier(double share, double length_m, double (&out)[3][3]) {
  const double t = share, s = 1.0 - share;
  const double first = 2.0 / length_m, second = 2.0 / (length_m * length_m);
  const double rows[3][3] = {
      {s * s, 2.0 * s * t, t * t}, {-first * s, first * (s - t), first * t}, {second, -2.0 * second, second}};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) out[i][j] = rows[i][j];
  }
}

/// Where the time of a segment is summed.
constexpr std::array<double, 2> gauss_share = {0.21132486540518711775, 0.78867513459481288225};

double cube(double x) {
  return x * x * x;
}

/// Largest b at a resting segment's moving end.
double rest_limit(const SpeedSegment& segment, const ChannelLimits& limits) {
  const double sign = segment.kind == Segment::Kind::from_rest ? 1.0 : -1.0, x = segment.length_m;
  double out = 1e300;
  for (std::size_t p = 0; p < point_count; ++p) {
    const PathPoint& point = segment.point[p];
    const double own = segment.kind == Segment::Kind::from_rest ? segment.share[p] : 1.0 - segment.share[p];
    for (const double share : {own, own > 0.5 ? 1.0 : 0.0}) {
      out = std::min(out, point.max_b / std::max(std::pow(share, 4.0 / 3.0), 1e-6));
      for (std::size_t k = 0; k < channel_count; ++k) {
        const double a = std::abs(point.c2[k] * std::pow(share, 4.0 / 3.0) +
                                  sign * (2.0 / 3.0) * point.c1[k] * std::cbrt(share) / x);
        out = std::min(out, limits.acceleration[k] * point.speed * point.speed / std::max(a, 1e-30));
        const double j = std::abs(point.c3[k] * share * share + sign * 2.0 * point.c2[k] * share / x +
                                  (2.0 / 9.0) * point.c1[k] / (x * x));
        const double most = limits.jerk[k] * cube(point.speed) / std::max(j, 1e-30);
        out = std::min(out, std::cbrt(most * most));
      }
    }
  }
  return out;
}

}  // namespace

/// What the solver keeps for a segment.
struct SpeedSolver::Work {
  std::array<Duals, point_count> z = {}, dz = {};
  std::array<double, point_count> z_speed = {}, dz_speed = {};
  double z_cap = 0.0, dz_cap = 0.0, z_floor = 0.0, dz_floor = 0.0;
  double local[point_count][3][3] = {};  // (b, b', b'') at the points by (c_{i−1}, c_i, c_{i+1})
  double gauss[2][3] = {};               // b where the time is summed
  double cap = 1e300;                    // of c_i
  double floor = 0.0;                    // of c_i, far below a safe terminal speed: b stays positive
  double rest_time = 0.0;                // rest_time / √c_i is those segments' time
  double diagonal = 0.0, next = 0.0, after = 0.0, right = 0.0, change = 0.0;
  double best = 0.0;
};

SpeedSolver::SpeedSolver(const ChannelLimits& limits, std::size_t capacity)
    : limits_(limits), work_(std::make_unique<Work[]>(capacity)) {}
SpeedSolver::~SpeedSolver() = default;

SegmentEnds ends_of(const SpeedSegment* segments, std::size_t size, std::size_t i) noexcept {
  const SpeedSegment& segment = segments[i];
  const auto met = [&](const SpeedSegment& other) {
    if (other.kind != Segment::Kind::cruise) return segment.b / (1.0 + 2.0 * segment.length_m / (3.0 * other.length_m));
    return (segment.length_m * other.b + other.length_m * segment.b) / (segment.length_m + other.length_m);
  };
  return {i > 0 ? met(segments[i - 1]) : segment.b, i + 1 < size ? met(segments[i + 1]) : segment.b};
}

double SpeedSolver::own_safe_b(const SpeedSegment& segment) const noexcept {
  if (segment.kind != Segment::Kind::cruise) return 0.5 * rest_limit(segment, limits_);
  const double d = segment.length_m;
  double out = 1e300;
  for (const PathPoint& point : segment.point) {
    out = std::min(out, 0.9 * point.max_b);
    for (std::size_t k = 0; k < channel_count; ++k) {
      // Any b within [0, safe_b] at the three coefficients: |b'| <= 2 safe_b / d and |b''| <= 4 safe_b / d².
      const double c1 = std::abs(point.c1[k]), c2 = std::abs(point.c2[k]), c3 = std::abs(point.c3[k]);
      const double a = 0.5 * limits_.acceleration[k] * point.speed * point.speed / std::max(c2 + c1 / d, 1e-30);
      const double j =
          0.5 * limits_.jerk[k] * cube(point.speed) / std::max(c3 + 3.0 * c2 / d + 2.0 * c1 / (d * d), 1e-30);
      out = std::min({out, a, std::cbrt(j * j)});
    }
  }
  return out;
}

namespace {

/// What one iteration knows of a row of segments.
struct SpeedRow {
  SpeedSegment* segments = nullptr;
  std::size_t size = 0, first = 0, last = 0;
  const ChannelLimits& limits;
  const SpeedOptions& options;
};

}  // namespace

struct SpeedSolver::Direction {
  Direction(const SpeedRow& of, Work* with) : row(of), work(with) {}

  SpeedRow row;
  Work* work;
  double mu = 0.0, dual_step = 0.0;

  [[nodiscard]] Local local(std::size_t i, std::size_t p, double before, double here, double after) const {
    const auto& m = work[i].local[p];
    return {m[0][0] * before + m[0][1] * here + m[0][2] * after, m[1][0] * before + m[1][1] * here + m[1][2] * after,
            m[2][0] * before + m[2][1] * here + m[2][2] * after};
  }
  [[nodiscard]] Local at(std::size_t i, std::size_t p) const {
    return local(i, p, i > 0 ? row.segments[i - 1].b : 0.0, row.segments[i].b,
                 i + 1 < row.size ? row.segments[i + 1].b : 0.0);
  }
  [[nodiscard]] Local change(std::size_t i, std::size_t p) const {
    return local(i, p, i > 0 ? work[i - 1].change : 0.0, work[i].change, i + 1 < row.size ? work[i + 1].change : 0.0);
  }
  [[nodiscard]] double time_b(std::size_t i, std::size_t p) const {
    const auto& g = work[i].gauss[p];
    return (i > 0 ? g[0] * row.segments[i - 1].b : 0.0) + g[1] * row.segments[i].b +
           (i + 1 < row.size ? g[2] * row.segments[i + 1].b : 0.0);
  }
  [[nodiscard]] bool moves(std::size_t i) const { return i >= row.first && i < row.last; }
  /// Segments whose points feel a free coefficient.
  [[nodiscard]] std::size_t from() const { return row.first > 0 ? row.first - 1 : 0; }
  [[nodiscard]] std::size_t to() const { return std::min(row.last + 1, row.size); }

  void prepare(std::size_t i);
  [[nodiscard]] double time() const;
  /// False where a limit is broken.
  [[nodiscard]] bool start_duals();
  void assemble_segment(std::size_t i, double& gap);
  void solve();
  void find_step(double& primal, double& dual);
  [[nodiscard]] double promised_s() const;
};

void SpeedSolver::Direction::prepare(std::size_t i) {
  Work& w = work[i];
  const SpeedSegment& segment = row.segments[i];
  w.cap = 1e300;
  w.floor = floor_share * std::min(segment.b, segment.safe_b);
  w.rest_time = 0.0;
  if (segment.kind != Segment::Kind::cruise) return;
  // Where the limit is even the control points keep the spline below it everywhere.
  w.cap = std::max({segment.point[0].max_b, segment.point[1].max_b, segment.point[2].max_b});
  // (begin, middle, end) by (c_{i−1}, c_i, c_{i+1}).
  double joint[3][3] = {{0.0, 1.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 1.0, 0.0}};
  const auto meet = [&](const SpeedSegment& other, double& own, double& others) {
    if (other.kind != Segment::Kind::cruise) {
      own = 1.0 / (1.0 + 2.0 * segment.length_m / (3.0 * other.length_m));
      w.cap = std::min(w.cap, rest_limit(other, row.limits) / own);
      w.rest_time += 3.0 * other.length_m / std::sqrt(own);
    } else {
      own = other.length_m / (segment.length_m + other.length_m);
      others = segment.length_m / (segment.length_m + other.length_m);
    }
  };
  if (i > 0) meet(row.segments[i - 1], joint[0][1], joint[0][0]);
  if (i + 1 < row.size) meet(row.segments[i + 1], joint[2][1], joint[2][2]);
  for (std::size_t p = 0; p < point_count; ++p) {
    double weight[3][3];
    bezier(segment.share[p], segment.length_m, weight);
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) {
        w.local[p][r][c] = weight[r][0] * joint[0][c] + weight[r][1] * joint[1][c] + weight[r][2] * joint[2][c];
      }
    }
  }
  for (std::size_t p = 0; p < 2; ++p) {
    double weight[3][3];
    bezier(gauss_share[p], segment.length_m, weight);
    for (int c = 0; c < 3; ++c) {
      w.gauss[p][c] = weight[0][0] * joint[0][c] + weight[0][1] * joint[1][c] + weight[0][2] * joint[2][c];
    }
  }
}

double SpeedSolver::Direction::time() const {
  double sum = 0.0;
  for (std::size_t i = from(); i < to(); ++i) {
    if (row.segments[i].kind != Segment::Kind::cruise) continue;
    for (std::size_t p = 0; p < 2; ++p) sum += 0.5 * row.segments[i].length_m / std::sqrt(time_b(i, p));
    if (work[i].rest_time > 0.0) sum += work[i].rest_time / std::sqrt(row.segments[i].b);
  }
  return sum;
}

bool SpeedSolver::Direction::start_duals() {
  bool within = true;
  for (std::size_t i = from(); i < to(); ++i) {
    const SpeedSegment& segment = row.segments[i];
    Work& w = work[i];
    if (segment.kind != Segment::Kind::cruise) continue;
    for (std::size_t p = 0; p < point_count; ++p) {
      const Local s = at(i, p);
      const PathPoint& point = segment.point[p];
      const double root = 1.0 / std::sqrt(s.b);
      for (std::size_t k = 0; k < channel_count; ++k) {
        const double a = point.c2[k] * s.b + 0.5 * point.c1[k] * s.first;
        const double limit = row.limits.acceleration[k] * point.speed * point.speed;
        const double j = point.c3[k] * s.b + 1.5 * point.c2[k] * s.first + 0.5 * point.c1[k] * s.second;
        const double r = row.limits.jerk[k] * cube(point.speed) * root;
        within = within && std::abs(a) < limit && std::abs(j) < r;
        w.z[p][0][k] = mu / (limit - a);
        w.z[p][1][k] = mu / (limit + a);
        w.z[p][2][k] = mu / (r - j);
        w.z[p][3][k] = mu / (r + j);
      }
      w.dz[p] = {};
      w.z_speed[p] = mu / (point.max_b - s.b);
      w.dz_speed[p] = 0.0;
      within = within && s.b > 0.0 && s.b < point.max_b;
    }
    w.z_cap = mu / (w.cap - segment.b);
    w.dz_cap = 0.0;
    w.z_floor = mu / (segment.b - w.floor);
    w.dz_floor = 0.0;
    within = within && segment.b < w.cap && segment.b > w.floor;
  }
  return within;
}

void SpeedSolver::Direction::assemble_segment(std::size_t i, double& gap) {
  const SpeedSegment& segment = row.segments[i];
  Work& w = work[i];
  if (segment.kind != Segment::Kind::cruise) return;
  double matrix[3][3] = {}, right[3] = {};
  alignas(8 * lane_count) double lanes[10][lane_count];
  for (std::size_t p = 0; p < point_count; ++p) {
    const PathPoint& point = segment.point[p];
    const Local s = at(i, p);
    const double root = 1.0 / std::sqrt(s.b);
    Assembly a{.c1 = point.c1.data(),
               .c2 = point.c2.data(),
               .c3 = point.c3.data(),
               .acceleration = row.limits.acceleration.data(),
               .jerk = row.limits.jerk.data(),
               .z = &w.z[p],
               .dz = &w.dz[p],
               .acceleration_scale = point.speed * point.speed,
               .root_b_inverse_scale = cube(point.speed) * root,
               .at = s,
               .dual_step = dual_step,
               .mu = mu,
               .sum = lanes};
    assemble(a);
    double sum[10];
    add_lanes(lanes, sum);
    // Speed: g = max_b − b.
    w.z_speed[p] += dual_step * w.dz_speed[p];
    const double slack = point.max_b - s.b;
    sum[0] += w.z_speed[p] / slack;
    sum[6] -= mu / slack;
    gap += sum[9] + w.z_speed[p] * slack;
    const double h[3][3] = {{sum[0], sum[1], sum[2]}, {sum[1], sum[3], sum[4]}, {sum[2], sum[4], sum[5]}};
    const auto& m = w.local[p];
    for (int c = 0; c < 3; ++c) {
      double column[3];
      for (int r = 0; r < 3; ++r) column[r] = h[r][0] * m[0][c] + h[r][1] * m[1][c] + h[r][2] * m[2][c];
      for (int r = 0; r <= c; ++r) matrix[r][c] += m[0][r] * column[0] + m[1][r] * column[1] + m[2][r] * column[2];
      right[c] += m[0][c] * sum[6] + m[1][c] * sum[7] + m[2][c] * sum[8];
    }
  }
  // The time: d / (2 √b).
  for (std::size_t p = 0; p < 2; ++p) {
    const auto& g = w.gauss[p];
    const double b = time_b(i, p), slope = 0.25 * segment.length_m / (b * std::sqrt(b)), bend = 1.5 * slope / b;
    for (int c = 0; c < 3; ++c) {
      for (int r = 0; r <= c; ++r) matrix[r][c] += g[r] * bend * g[c];
      right[c] += slope * g[c];
    }
  }
  w.z_floor += dual_step * w.dz_floor;
  const double above = segment.b - w.floor;
  matrix[1][1] += w.z_floor / above;
  right[1] += mu / above;
  gap += w.z_floor * above;
  w.z_cap += dual_step * w.dz_cap;
  const double below = w.cap - segment.b;
  matrix[1][1] += w.z_cap / below;
  right[1] -= mu / below;
  gap += w.z_cap * below;
  if (w.rest_time > 0.0) {
    const double root = 1.0 / std::sqrt(segment.b);
    matrix[1][1] += 0.75 * w.rest_time * root / (segment.b * segment.b);
    right[1] += 0.5 * w.rest_time * root / segment.b;
  }
  w.diagonal += matrix[1][1];
  w.right += right[1];
  w.next += matrix[1][2];
  if (i > 0) {
    Work& before = work[i - 1];
    before.diagonal += matrix[0][0];
    before.next += matrix[0][1];
    before.after += matrix[0][2];
    before.right += right[0];
  }
  if (i + 1 < row.size) {
    work[i + 1].diagonal += matrix[2][2];
    work[i + 1].right += right[2];
  }
}

/// L D Lᵀ of the five diagonals, over the free coefficients alone; the others' change is 0.
void SpeedSolver::Direction::solve() {
  Work* const w = work;
  for (std::size_t i = row.first; i < row.last; ++i) {
    double& d = w[i].diagonal;
    if (row.segments[i].kind != Segment::Kind::cruise) {
      d = 1.0;
      w[i].next = w[i].after = w[i].right = 0.0;
      continue;
    }
    if (i + 1 >= row.last) w[i].next = 0.0;
    if (i + 2 >= row.last) w[i].after = 0.0;
    const double next = w[i].next / d, after = w[i].after / d;
    if (i + 1 < row.last) {
      w[i + 1].diagonal -= next * w[i].next;
      w[i + 1].next -= next * w[i].after;
      w[i + 1].right -= next * w[i].right;
    }
    if (i + 2 < row.last) {
      w[i + 2].diagonal -= after * w[i].after;
      w[i + 2].right -= after * w[i].right;
    }
    w[i].next = next;
    w[i].after = after;
  }
  for (std::size_t i = row.last; i-- > row.first;) {
    double x = w[i].right / w[i].diagonal;
    if (i + 1 < row.last) x -= w[i].next * w[i + 1].change;
    if (i + 2 < row.last) x -= w[i].after * w[i + 2].change;
    w[i].change = x;
  }
}

void SpeedSolver::Direction::find_step(double& primal, double& dual) {
  alignas(8 * lane_count) double primal_lanes[lane_count] = {}, dual_lanes[lane_count] = {};
  for (std::size_t i = from(); i < to(); ++i) {
    const SpeedSegment& segment = row.segments[i];
    Work& w = work[i];
    if (segment.kind != Segment::Kind::cruise) continue;
    for (std::size_t p = 0; p < point_count; ++p) {
      const PathPoint& point = segment.point[p];
      const Local s = at(i, p), ds = change(i, p);
      Stepping a{.c1 = point.c1.data(),
                 .c2 = point.c2.data(),
                 .c3 = point.c3.data(),
                 .acceleration = row.limits.acceleration.data(),
                 .jerk = row.limits.jerk.data(),
                 .z = &w.z[p],
                 .dz = &w.dz[p],
                 .acceleration_scale = point.speed * point.speed,
                 .root_b_inverse_scale = cube(point.speed) / std::sqrt(s.b),
                 .at = s,
                 .change = ds,
                 .mu = mu,
                 .primal = primal_lanes,
                 .dual = dual_lanes};
      step(a);
      const double slack = point.max_b - s.b;
      w.dz_speed[p] = (mu + w.z_speed[p] * ds.b) / slack - w.z_speed[p];
      primal = std::max(primal, ds.b / slack);
      dual = std::max(dual, -w.dz_speed[p] / w.z_speed[p]);
    }
    const double above = segment.b - w.floor;
    w.dz_floor = (mu - w.z_floor * w.change) / above - w.z_floor;
    primal = std::max(primal, -w.change / above);
    dual = std::max(dual, -w.dz_floor / w.z_floor);
    const double below = w.cap - segment.b;
    w.dz_cap = (mu + w.z_cap * w.change) / below - w.z_cap;
    primal = std::max(primal, w.change / below);
    dual = std::max(dual, -w.dz_cap / w.z_cap);
  }
  for (std::size_t k = 0; k < lane_count; ++k) {
    primal = std::max(primal, primal_lanes[k]);
    dual = std::max(dual, dual_lanes[k]);
  }
}

/// What the time falls by in the whole step, by its slope.
double SpeedSolver::Direction::promised_s() const {
  double sum = 0.0;
  for (std::size_t i = from(); i < to(); ++i) {
    if (row.segments[i].kind != Segment::Kind::cruise) continue;
    const double before = i > 0 ? work[i - 1].change : 0.0, after = i + 1 < row.size ? work[i + 1].change : 0.0;
    for (std::size_t p = 0; p < 2; ++p) {
      const auto& g = work[i].gauss[p];
      const double b = time_b(i, p), change = g[0] * before + g[1] * work[i].change + g[2] * after;
      sum += 0.25 * row.segments[i].length_m * change / (b * std::sqrt(b));
    }
    if (work[i].rest_time > 0.0) {
      sum += 0.5 * work[i].rest_time * work[i].change / (row.segments[i].b * std::sqrt(row.segments[i].b));
    }
  }
  return sum;
}

SpeedResult SpeedSolver::solve(SpeedSegment* segments, std::size_t size, std::size_t first, std::size_t last,
                               const SpeedOptions& options) noexcept {
  Direction direction({segments, size, first, last, limits_, options}, work_.get());
  Work* const work = work_.get();
  SpeedResult out;
  const std::size_t from = direction.from(), to = direction.to();
  for (std::size_t i = from; i < to; ++i) {
    direction.prepare(i);
    work[i].change = 0.0;
    work[i].best = segments[i].b;
  }
  if (first >= last) return out;
  const double rows =
      static_cast<double>(last - first) * static_cast<double>(point_count * (channel_count * sides + 1) + 2);
  out.duration_s = direction.time();
  double best_s = out.duration_s;
  direction.mu = out.duration_s / rows;
  out.feasible = direction.start_duals();
  if (!out.feasible) return out;
  for (out.iterations = 0; out.iterations < options.max_iterations; ++out.iterations) {
    for (std::size_t i = from; i < to; ++i) work[i].diagonal = work[i].next = work[i].after = work[i].right = 0.0;
    double gap = 0.0;
    for (std::size_t i = from; i < to; ++i) direction.assemble_segment(i, gap);
    direction.solve();
    double primal = 0.0, dual = 0.0;
    direction.find_step(primal, dual);
    const double take = std::min(1.0, 0.98 / std::max(primal, 1e-300));
    direction.dual_step = std::min(1.0, 0.98 / std::max(dual, 1e-300));
    const double promised_s = direction.promised_s();
    for (std::size_t i = first; i < last; ++i) segments[i].b += take * work[i].change;
    const double time_s = direction.time(), gained_s = best_s - time_s;
    if (time_s < best_s) {
      best_s = time_s;
      for (std::size_t i = first; i < last; ++i) work[i].best = segments[i].b;
    }
    if (gap < options.relative_gap * best_s && std::abs(gained_s) < options.relative_gap * best_s && take > 0.5) {
      out.converged = true;
      break;
    }
    const double least = std::min(take, direction.dual_step);
    const double centring = least > 0.9 ? 0.1 : least > 0.5 ? 0.25 : 0.6;
    // The gap says nothing while duals are not feasible: as long as the step promises more than it, a smaller mu would
    // only drive the row against its limits, where steps are short.
    direction.mu = std::max({centring * gap, promise_weight * promised_s, 1e-3 * options.relative_gap * best_s}) / rows;
  }
  for (std::size_t i = first; i < last; ++i) segments[i].b = work[i].best;
  out.duration_s = best_s;
  return out;
}

}  // namespace robomill::path
