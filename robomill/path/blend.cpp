#include "robomill/path/blend.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

namespace robomill::path {
namespace {

using Point = Blend::Point;

/// A chord this long leaves the even run along its arc by less than 1e-5 rad.
constexpr double max_chord_rad = 0.1;
/// Of a tolerance, for what is found at nodes and middles alone.
constexpr double share_of_tolerance = 0.93;
/// How far tip and axis may run ahead of each other along the programmed path, in tolerances.
constexpr double lag_tolerances = 5.0;
/// Of the tolerances, where a block leaves more of its curve than they allow: the check says so.
constexpr double least_share = 0.05;

/// The filtered ramp less the ramp, h − |x| = y in [0, h]: two filters of width h, or three of width 2 h / 3.
double ramp_error(double y, double h, int filters) {
  if (filters == 2) return y * y * y / (6.0 * h * h);
  const double d = 2.0 * h / 3.0, z = std::max(0.0, y - d);
  return (y * y * y * y - 3.0 * z * z * z * z) / (24.0 * d * d * d);
}

}  // namespace

Blend::Blend(const SmoothingOptions& options, std::size_t capacity) : options_(options), capacity_(capacity) {
  per_angle_m_ = options.max_velocity_m_per_s / options.max_angular_velocity_rad_per_s;
  max_half_width_m_ = options.max_velocity_m_per_s * (options.max_velocity_m_per_s / options.max_acceleration_m_per_s2 +
                                                      options.max_acceleration_m_per_s2 / options.max_jerk_m_per_s3);
  nodes_.reserve(capacity);
}

void Blend::begin(const program::Pose& pose, double gamma_rad) noexcept {
  nodes_.clear();
  first_ = final_widths_ = ready_ = last_stop_ = 0;
  Node node;
  node.at << pose.tip_m, pose.axis, gamma_rad, 0.0;
  node.stop = true;
  nodes_.push_back(node);
}

Blend::Added Blend::add(const program::Block& block, std::size_t index, double gamma_rad, double tolerance) noexcept {
  const Point from = nodes_.back().at;
  const Eigen::Vector3d axis = from.segment<3>(3), tip_m = from.head<3>();
  const double angle = program::angle_between(axis, block.end.axis);
  if (angle > 3.14159) return Added::antipodal;
  const double way_m = (block.end.tip_m - tip_m).norm();
  double length_m = std::max(way_m, per_angle_m_ * angle);
  if (length_m < 1e-9) length_m = per_angle_m_ * std::abs(gamma_rad - from[6]);
  if (length_m < 1e-9) return Added::nothing;
  // What the block leaves of the curve that it stands for comes off the tolerances.
  const double left = 1.0 - std::max(block.tip_deviation_m / options_.tip_tolerance_m,
                                     block.axis_deviation_rad / options_.axis_tolerance_rad);
  tolerance *= std::max(left, least_share);
  const auto pieces = static_cast<std::size_t>(std::ceil(angle / max_chord_rad + 1e-12));
  const std::size_t count = std::max<std::size_t>(pieces, 1);
  if (nodes_.size() + count > capacity_) return Added::full;
  for (std::size_t i = 1; i <= count; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(count);
    Node& begin = nodes_.back();
    Node end;
    const Eigen::Vector3d turned = i == count ? block.end.axis : program::between({tip_m, axis}, block.end, share).axis;
    end.at << tip_m + share * (block.end.tip_m - tip_m), turned, from[6] + share * (gamma_rad - from[6]), 0.0;
    const double step_m = length_m / static_cast<double>(count);
    end.u_m = begin.u_m + step_m;
    begin.rate = (end.at - begin.at) / step_m;
    begin.block = index;
    begin.line = block.line;
    begin.tolerance = std::min(begin.tolerance, tolerance);
    if (block.duration_s > 0.0) {
      begin.max_rate_m_per_s = length_m / block.duration_s;
      // Beside a corner the tip may run faster in u than in its own block.
      if (way_m > 1e-9) begin.max_tip_m_per_s = way_m / block.duration_s;
    }
    if (!begin.stop) begin.step = begin.rate - nodes_[nodes_.size() - 2].rate;
    end.tolerance = tolerance;
    end.block = index;
    end.line = block.line;
    nodes_.push_back(end);
  }
  return Added::moved;
}

void Blend::stop(double dwell_s) noexcept {
  nodes_.back().stop = true;
  nodes_.back().dwell_s += dwell_s;
  last_stop_ = end() - 1;
}

Point Blend::error(double u_m, std::size_t near, double common_half_width_m) const noexcept {
  Point sum = Point::Zero();
  const auto take = [&](const Node& corner) {
    const double h = common_half_width_m > 0.0 ? common_half_width_m : corner.half_width_m;
    const double y = h - std::abs(u_m - corner.u_m);
    if (y > 0.0) sum += corner.step * ramp_error(y, h, options_.filters);
  };
  for (std::size_t k = near; k > first_ && near - k <= max_reach;) {
    if (node(--k).stop) break;
    take(node(k));
  }
  for (std::size_t k = near; k < end() && k <= near + max_reach && !node(k).stop; ++k) take(node(k));
  return sum;
}

double Blend::excess_in_piece(std::size_t piece, double u_m) const noexcept {
  const Node& here = node(piece);
  const Point off = error(u_m, piece + 1, 0.0);
  const Point at_u = here.at + here.rate * (u_m - here.u_m) + off;
  const Eigen::Vector3d axis = here.at.segment<3>(3).normalized();
  const auto plain = [](const auto& v) -> Eigen::Vector3d { return v; };
  const auto across_axis = [&](const auto& v) -> Eigen::Vector3d { return v - axis * axis.dot(v); };
  // The nearest of the piece and its neighbours.
  const auto distance = [&](Eigen::Index first, const auto& flat) {
    double least = 1e300;
    for (std::size_t k = piece > first_ ? piece - 1 : piece; k <= piece + 1 && k + 1 < end(); ++k) {
      const Eigen::Vector3d from = flat((at_u - node(k).at).segment<3>(first));
      const Eigen::Vector3d way = flat((node(k + 1).at - node(k).at).segment<3>(first));
      const double square = way.squaredNorm();
      const double share = square > 0.0 ? std::clamp(from.dot(way) / square, 0.0, 1.0) : 0.0;
      least = std::min(least, (from - share * way).norm());
    }
    return least;
  };
  const double tolerance = share_of_tolerance * std::min(here.tolerance, node(piece + 1).tolerance);
  const double tip_m = tolerance * options_.tip_tolerance_m, axis_rad = tolerance * options_.axis_tolerance_rad;
  return std::max({distance(0, plain) / tip_m, off.head<3>().norm() / (lag_tolerances * tip_m),
                   distance(3, across_axis) / axis_rad,
                   across_axis(off.segment<3>(3)).norm() / (lag_tolerances * axis_rad)});
}

double Blend::excess_at_node(std::size_t index, double common_half_width_m) const noexcept {
  const Node& here = node(index);
  const Point in = node(index - 1).rate, out = here.rate;
  const Point at_corner = error(here.u_m, index, common_half_width_m);
  const Eigen::Vector3d axis = here.at.segment<3>(3).normalized();
  // The corner is missed by no more than any point of the path is away: the one beside it, and the one that the
  // tangent there says is nearest.
  const auto miss = [&](Eigen::Index first, const auto& flat) {
    const Eigen::Vector3d off = flat(at_corner.segment<3>(first));
    const Eigen::Vector3d tangent = 0.5 * (in + out).segment<3>(first);
    const double along = off.dot(tangent), square = tangent.squaredNorm();
    if (!(std::abs(along) > 1e-6 * off.norm() * std::sqrt(square))) return off.norm();
    const double shift_m = std::clamp(-along / square, node(index - 1).u_m - here.u_m, node(index + 1).u_m - here.u_m);
    const Point there = error(here.u_m + shift_m, shift_m < 0.0 ? index : index + 1, common_half_width_m) +
                        shift_m * (shift_m < 0.0 ? in : out);
    return std::min(off.norm(), flat(there.segment<3>(first)).norm());
  };
  const auto plain = [](const auto& v) -> Eigen::Vector3d { return v; };
  const auto across_axis = [&](const auto& v) -> Eigen::Vector3d { return v - axis * axis.dot(v); };
  const double tolerance = share_of_tolerance * here.tolerance;
  const double tip_m = tolerance * options_.tip_tolerance_m, axis_rad = tolerance * options_.axis_tolerance_rad;
  return std::max({miss(0, plain) / tip_m, at_corner.head<3>().norm() / (lag_tolerances * tip_m),
                   miss(3, across_axis) / axis_rad,
                   across_axis(at_corner.segment<3>(3)).norm() / (lag_tolerances * axis_rad)});
}

void Blend::begin_width(std::size_t index) noexcept {
  Node& here = at(index);
  if (here.stop) return;
  std::size_t low = index, high = index;
  while (low > first_ && index - low < max_reach && !node(low).stop) --low;
  while (high + 1 < end() && high - index < max_reach && !node(high).stop) ++high;
  double h = std::min({max_half_width_m_, here.u_m - node(low).u_m, node(high).u_m - here.u_m});
  const auto ratio_of = [&](double half_width_m) { return excess_at_node(index, half_width_m); };
  double ratio = ratio_of(h), too_wide_m = h;
  for (int i = 0; i < 40 && ratio > 1.0; ++i) {
    too_wide_m = h;
    h *= 0.8;
    ratio = ratio_of(h);
  }
  // An isolated corner's error grows with its width.
  for (int i = 0; i < 3 && ratio < 0.99 && too_wide_m > h; ++i) {
    const double wider_m =
        std::min(0.999 * h / std::max(ratio, 0.5), 0.5 * (h + too_wide_m) + 0.5 * (too_wide_m - h) * (i == 0));
    const double at_wider = ratio_of(wider_m);
    if (at_wider <= 1.0) {
      h = wider_m;
      ratio = at_wider;
    } else {
      too_wide_m = wider_m;
    }
  }
  here.half_width_m = h;
}

bool Blend::narrow(double u_m, double ratio) noexcept {
  // By the share that an isolated corner needs; where several meet, in a few rounds.
  const double factor = std::clamp(0.98 / ratio, 0.6, 0.98);
  bool done = false;
  const auto above =
      std::upper_bound(nodes_.begin(), nodes_.end(), u_m, [](double u, const Node& node) { return u < node.u_m; });
  const auto near = static_cast<std::size_t>(above - nodes_.begin()) + first_;
  const std::size_t from = std::max(final_widths_, near > first_ + max_reach ? near - max_reach : first_);
  for (std::size_t k = from; k < end() && k <= near + max_reach; ++k) {
    Node& corner = at(k);
    if (std::abs(u_m - corner.u_m) < corner.half_width_m && corner.step.squaredNorm() > 1e-20) {
      corner.half_width_m *= factor;
      done = true;
    }
  }
  return done;
}

bool Blend::narrow_all(std::size_t from, std::size_t to) noexcept {
  bool changed = false;
  for (std::size_t i = from; i < to; ++i) {
    const Node& here = node(i);
    if (!here.stop) {
      const double ratio = excess_at_node(i, 0.0);
      if (ratio > 1.0) changed = narrow(here.u_m, ratio) || changed;
    }
    for (const double share : {0.1, 0.25, 0.5, 0.75, 0.9}) {
      const double u_m = here.u_m + share * (node(i + 1).u_m - here.u_m);
      const double ratio = excess_in_piece(i, u_m);
      if (ratio > 1.0) changed = narrow(u_m, ratio) || changed;
    }
  }
  return changed;
}

void Blend::find_reach(std::size_t piece) noexcept {
  Node& here = at(piece);
  const double begin_m = here.u_m, end_m = node(piece + 1).u_m;
  here.reach_first = here.reach_last = piece + 1;
  for (std::size_t k = piece + 1; k > first_ && piece + 1 - k <= max_reach;) {
    if (node(--k).stop) break;
    if (node(k).u_m + node(k).half_width_m > begin_m) here.reach_first = k;
  }
  for (std::size_t k = piece + 1; k < end() && k <= piece + 1 + max_reach && !node(k).stop; ++k) {
    if (node(k).u_m - node(k).half_width_m < end_m) here.reach_last = k + 1;
  }
}

void Blend::find_widths() noexcept {
  const bool closed = node(end() - 1).stop;
  // Corners beyond this one may still meet blocks to come.
  const std::size_t known = closed ? end() - 1 : (end() > max_reach + 1 ? end() - 1 - max_reach : 0);
  // A stop makes its row final even where no corner lies between it and the one before.
  if (known <= final_widths_ && (!closed || ready_ >= known)) return;
  for (std::size_t i = final_widths_; i < known; ++i) begin_width(i);
  const std::size_t from = final_widths_ > first_ + max_reach ? final_widths_ - max_reach : first_;
  for (int round = 0; round < 24 && narrow_all(from, known); ++round) {
  }
  const std::size_t last = std::max(last_stop_, known > 2 * max_reach ? known - 2 * max_reach : 0);
  final_widths_ = std::max(final_widths_, closed ? end() - 1 : last);
  const std::size_t ready = std::max(last_stop_, final_widths_ > max_reach + 1 ? final_widths_ - max_reach - 1 : 0);
  for (std::size_t i = std::max(ready_, first_); i < ready; ++i) find_reach(i);
  ready_ = std::max(ready_, ready);
}

void Blend::forget(std::size_t before) noexcept {
  const std::size_t keep = before > 2 * max_reach + 2 ? before - 2 * max_reach - 2 : 0;
  if (keep <= first_) return;
  nodes_.erase(nodes_.begin(), nodes_.begin() + static_cast<std::ptrdiff_t>(keep - first_));
  first_ = keep;
}

void Blend::expand(std::size_t piece, double middle_m, Polynomial& out) const noexcept {
  // Powers of u − begin; each corner's filtered ramp has one form on the whole stretch, found at its middle.
  const Node& here = node(piece);
  out.coefficients.setZero();
  out.coefficients.col(0) = here.at + here.rate * (out.begin_m - here.u_m);
  out.coefficients.col(1) = here.rate;
  for (std::size_t k = here.reach_first; k < here.reach_last; ++k) {
    const Node& corner = node(k);
    const double h = corner.half_width_m;
    if (!(std::abs(middle_m - corner.u_m) < h)) continue;
    const double side = middle_m < corner.u_m ? 1.0 : -1.0;
    const double y = h + side * (out.begin_m - corner.u_m);
    // y grows (or falls) with u: value(y + side x) by powers of x.
    double c[5] = {};
    if (options_.filters == 2) {
      const double w = 1.0 / (h * h);
      c[0] = y * y * y * w / 6.0;
      c[1] = side * y * y * w / 2.0;
      c[2] = y * w / 2.0;
      c[3] = side * w / 6.0;
    } else {
      const double d = 2.0 * h / 3.0, w = 1.0 / (24.0 * d * d * d);
      const auto add = [&](double z, double factor) {
        c[0] += factor * z * z * z * z;
        c[1] += factor * side * 4.0 * z * z * z;
        c[2] += factor * 6.0 * z * z;
        c[3] += factor * side * 4.0 * z;
        c[4] += factor;
      };
      add(y, w);
      if (h - std::abs(middle_m - corner.u_m) > d) add(y - d, -3.0 * w);
    }
    for (int i = 0; i < 5; ++i) out.coefficients.col(i) += corner.step * c[i];
  }
}

std::size_t Blend::polynomials(std::size_t piece, Polynomial* out) const noexcept {
  const Node& here = node(piece);
  const double begin_m = here.u_m, end_m = node(piece + 1).u_m;
  std::array<double, max_polynomials + 1> knot = {};
  std::size_t knots = 0;
  knot[knots++] = begin_m;
  const double least_m = 1e-9 * (end_m - begin_m);
  const auto take = [&](double u_m) {
    if (u_m > begin_m + least_m && u_m < end_m - least_m && knots + 1 < knot.size()) knot[knots++] = u_m;
  };
  for (std::size_t k = here.reach_first; k < here.reach_last; ++k) {
    const double h = node(k).half_width_m, u_m = node(k).u_m;
    take(u_m - h);
    take(u_m + h);
    if (options_.filters == 3) {
      take(u_m - h / 3.0);
      take(u_m + h / 3.0);
    }
  }
  std::sort(knot.begin(), knot.begin() + static_cast<std::ptrdiff_t>(knots));
  knot[knots] = end_m;
  std::size_t count = 0;
  for (std::size_t i = 0; i < knots; ++i) {
    if (i > 0 && knot[i] - out[count - 1].begin_m <= least_m) continue;
    Polynomial& p = out[count++];
    p.begin_m = knot[i];
    p.max_rate_m_per_s = here.max_rate_m_per_s;
    p.max_tip_m_per_s = here.max_tip_m_per_s;
    p.block = here.block;
    p.line = here.line;
    p.stop = false;
    p.dwell_s = 0.0;
  }
  for (std::size_t i = 0; i < count; ++i) {
    const double to_m = i + 1 < count ? out[i + 1].begin_m : end_m;
    out[i].length_m = to_m - out[i].begin_m;
    expand(piece, 0.5 * (out[i].begin_m + to_m), out[i]);
  }
  out[count - 1].stop = node(piece + 1).stop;
  out[count - 1].dwell_s = node(piece + 1).dwell_s;
  return count;
}

robot::ToolPose Polynomial::pose(double x_m) const noexcept {
  const Point value =
      (((coefficients.col(4) * x_m + coefficients.col(3)) * x_m + coefficients.col(2)) * x_m + coefficients.col(1)) *
          x_m +
      coefficients.col(0);
  return {.tip_m = value.head<3>(), .axis = value.segment<3>(3).normalized(), .gamma_rad = value[6]};
}

robot::ToolJet Polynomial::jet(double x_m) const noexcept {
  const auto c = [&](int i) { return coefficients.col(i); };
  const Point value = (((c(4) * x_m + c(3)) * x_m + c(2)) * x_m + c(1)) * x_m + c(0);
  const Point first = ((4.0 * c(4) * x_m + 3.0 * c(3)) * x_m + 2.0 * c(2)) * x_m + c(1);
  const Point second = (12.0 * c(4) * x_m + 6.0 * c(3)) * x_m + 2.0 * c(2);
  const Point third = 24.0 * c(4) * x_m + 6.0 * c(3);
  robot::ToolJet out;
  out.tip_m << value.head<3>(), first.head<3>(), second.head<3>(), third.head<3>();
  out.gamma_rad << value[6], first[6], second[6], third[6];
  // a = n r with r = (n·n)^(-1/2): s = n·n, s', s'', s''' and r by differentiating r² s = 1.
  const Eigen::Vector3d n0 = value.segment<3>(3), n1 = first.segment<3>(3), n2 = second.segment<3>(3),
                        n3 = third.segment<3>(3);
  const double s0 = n0.dot(n0), s1 = 2.0 * n0.dot(n1), s2 = 2.0 * (n1.dot(n1) + n0.dot(n2)),
               s3 = 2.0 * (3.0 * n1.dot(n2) + n0.dot(n3));
  const double r0 = 1.0 / std::sqrt(s0), w = 1.0 / s0;
  const double r1 = -0.5 * r0 * s1 * w;
  const double r2 = r0 * w * (0.75 * s1 * s1 * w - 0.5 * s2);
  const double r3 = r0 * w * (-1.875 * s1 * s1 * s1 * w * w + 2.25 * s1 * s2 * w - 0.5 * s3);
  out.axis << n0 * r0, n1 * r0 + n0 * r1, n2 * r0 + 2.0 * n1 * r1 + n0 * r2,
      n3 * r0 + 3.0 * n2 * r1 + 3.0 * n1 * r2 + n0 * r3;
  return out;
}

}  // namespace robomill::path
