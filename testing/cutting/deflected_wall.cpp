#include "testing/cutting/deflected_wall.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace robomill::cutting::testing {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

double constant(const std::vector<double>& polynomial) {
  return polynomial.empty() ? 0.0 : polynomial.back();
}

/// A swing in time: exact under a force that is held over a step.
class Oscillator {
 public:
  Oscillator(const Swing& swing, double step_s) : swing_(swing) {
    const double omega = 2.0 * pi * swing.frequency_hz;
    const double decay = swing.damping_ratio * omega;
    const double turn = omega * std::sqrt(1.0 - swing.damping_ratio * swing.damping_ratio);
    const double fade = std::exp(-decay * step_s);
    const double c = std::cos(turn * step_s);
    const double s = std::sin(turn * step_s);
    xx_ = fade * (c + decay / turn * s);
    xv_ = fade * s / turn;
    vx_ = -fade * omega * omega / turn * s;
    vv_ = fade * (c - decay / turn * s);
  }
  void step(const Vector3d& force_n) {
    const double half = 0.5 * swing_.backlash_m;
    const double rest = swing_.direction.dot(force_n) / swing_.stiffness_n_per_m + std::clamp(x_, -half, half);
    const double off = x_ - rest;
    const double v = v_;
    x_ = rest + xx_ * off + xv_ * v;
    v_ = vx_ * off + vv_ * v;
  }
  [[nodiscard]] Vector3d displacement_m() const { return x_ * swing_.direction; }

 private:
  const Swing& swing_;
  double xx_, xv_, vx_, vv_;
  double x_ = 0.0, v_ = 0.0;
};

/// One tooth's edge in one slice, where it stood last.
struct EdgePoint {
  double x = 0.0, u = 0.0;
  bool known = false;
};

class WallCutter {
 public:
  WallCutter(const WallCut& cut, const Eigen::Vector2d& window)
      : cut_(cut),
        mill_(cut.cutter.mill),
        window_(window),
        rays_(static_cast<std::size_t>((cut.to_x_m - cut.from_x_m) / cut.ray_m)),
        slice_m_((cut.top_m - cut.bottom_m) / cut.slices),
        surface_m_(static_cast<std::size_t>(cut.slices), std::vector<double>(rays_, cut.side * cut.stock_y_m)),
        last_(static_cast<std::size_t>(cut.slices * mill_.teeth)),
        step_s_(2.0 * pi / (cut.spindle_speed_rad_per_s * cut.steps_per_revolution)) {
    for (const Swing& swing : cut.structure) structure_.emplace_back(swing, step_s_);
  }

  void run(const program::Block& block, const program::Pose& from) {
    const double begun_s = time_s_;
    while (time_s_ < begun_s + block.duration_s) {
      const Vector3d tip = program::between(from, block.end, (time_s_ - begun_s) / block.duration_s).tip_m;
      const Vector3d force = step(tip);
      for (Oscillator& swing : structure_) swing.step(force);
      if (tip.x() > window_(0) && tip.x() < window_(1)) {
        sum_ += force;
        ++steps_;
      }
      time_s_ += step_s_;
    }
  }

  [[nodiscard]] Wall wall() const {
    Wall out;
    const auto per_bin = static_cast<std::size_t>(std::ceil(cut_.bin_m / cut_.ray_m));
    const std::size_t bins = rays_ / per_bin;
    out.x_m.resize(static_cast<Eigen::Index>(bins));
    out.z_m.resize(cut_.slices);
    out.error_m.resize(cut_.slices, static_cast<Eigen::Index>(bins));
    for (int k = 0; k < cut_.slices; ++k) {
      out.z_m(k) = height_m(k);
      for (std::size_t b = 0; b < bins; ++b) {
        const auto first = surface_m_[static_cast<std::size_t>(k)].begin() + static_cast<std::ptrdiff_t>(b * per_bin);
        const double deepest = *std::max_element(first, first + static_cast<std::ptrdiff_t>(per_bin));
        const auto column = static_cast<Eigen::Index>(b);
        out.x_m(column) = cut_.from_x_m + (static_cast<double>(b) + 0.5) * static_cast<double>(per_bin) * cut_.ray_m;
        out.error_m(k, column) = cut_.side * cut_.wall_y_m - deepest;
      }
    }
    if (steps_ > 0) out.mean_force_n = sum_ / static_cast<double>(steps_);
    return out;
  }

 private:
  [[nodiscard]] double height_m(int slice) const { return cut_.bottom_m + (slice + 0.5) * slice_m_; }

  /// Moves all edges to where they stand now; the mean force of the step.
  Vector3d step(const Vector3d& tip) {
    Vector3d at = tip;
    for (const Oscillator& swing : structure_) at += swing.displacement_m();
    const double rotation = cut_.spindle_speed_rad_per_s * time_s_;
    Vector3d force = Vector3d::Zero();
    for (int tooth = 0; tooth < mill_.teeth; ++tooth) {
      for (int k = 0; k < cut_.slices; ++k) {
        const double above = height_m(k) - tip.z();
        if (above < 0.0) continue;
        const double phi = rotation + mill_.standing_angle(tooth) - mill_.lag_rad_per_m(tooth) * above;
        EdgePoint& last = last_[static_cast<std::size_t>(k * mill_.teeth + tooth)];
        const double cosine = cut_.side * std::cos(phi);
        if (cosine < 0.0) {  // on the side away from the wall
          last.known = false;
          continue;
        }
        const double sine = std::sin(phi);
        const double radius = 0.5 * mill_.diameter_m + mill_.radius_deviation_m(tooth, above);
        const EdgePoint now = {.x = at.x() + radius * sine, .u = cut_.side * at.y() + radius * cosine, .known = true};
        if (last.known) force += pass(k, last, now, sine, cut_.side * cosine);
        last = now;
      }
    }
    return force;
  }

  /// An edge passes the rays between two places of its slice; the force on the tool.
  Vector3d pass(int slice, const EdgePoint& from, const EdgePoint& to, double sine, double cosine) {
    if (std::max(from.u, to.u) <= cut_.side * cut_.stock_y_m) return Vector3d::Zero();
    const double way_x = to.x - from.x;
    const auto ray_of = [&](double x) {
      return static_cast<std::ptrdiff_t>(std::floor((x - cut_.from_x_m) / cut_.ray_m));
    };
    const std::ptrdiff_t low = std::max<std::ptrdiff_t>(ray_of(std::min(from.x, to.x)) + 1, 0);
    const std::ptrdiff_t high =
        std::min<std::ptrdiff_t>(ray_of(std::max(from.x, to.x)), static_cast<std::ptrdiff_t>(rays_) - 1);
    double area = 0.0;
    double cutting_x = 0.0;
    std::vector<double>& surface = surface_m_[static_cast<std::size_t>(slice)];
    for (std::ptrdiff_t i = low; i <= high; ++i) {
      const double share = (cut_.from_x_m + static_cast<double>(i) * cut_.ray_m - from.x) / way_x;
      const double u = from.u + share * (to.u - from.u);
      double& end = surface[static_cast<std::size_t>(i)];
      if (u <= end) continue;
      area += (u - end) * cut_.ray_m;
      cutting_x += cut_.ray_m;
      end = u;
    }
    if (area == 0.0) return Vector3d::Zero();
    const double chip = area / std::hypot(way_x, to.u - from.u);
    const double edge = cutting_x / std::abs(way_x);
    const MillingCoefficients& c = cut_.coefficients;
    const double tangential = constant(c.tangential_n_per_m2) * chip + constant(c.tangential_edge_n_per_m) * edge;
    const double radial = constant(c.radial_n_per_m2) * chip + constant(c.radial_edge_n_per_m) * edge;
    const double axial = constant(c.axial_n_per_m2) * chip + constant(c.axial_edge_n_per_m) * edge;
    return slice_m_ * (tangential * Vector3d(-cosine, sine, 0.0) - radial * Vector3d(sine, cosine, 0.0) +
                       axial * Vector3d::UnitZ());
  }

  const WallCut& cut_;
  const FlatEndMill& mill_;
  Eigen::Vector2d window_;
  std::size_t rays_;
  double slice_m_;
  std::vector<std::vector<double>> surface_m_;  ///< of each slice and ray, along the wall's normal
  std::vector<EdgePoint> last_;
  double step_s_, time_s_ = 0.0;
  std::vector<Oscillator> structure_ = {};
  Vector3d sum_ = Vector3d::Zero();
  long steps_ = 0;
};

}  // namespace

Wall::Summary Wall::between(double from_x_m, double to_x_m) const {
  Summary out;
  long count = 0;
  for (Eigen::Index column = 0; column < x_m.size(); ++column) {
    if (x_m(column) < from_x_m || x_m(column) > to_x_m) continue;
    for (Eigen::Index row = 0; row < z_m.size(); ++row) {
      const double error = error_m(row, column);
      out.mean_m += error;
      out.rms_m += error * error;
      if (std::abs(error) > std::abs(out.worst_m)) out.worst_m = error;
      ++count;
    }
  }
  if (count == 0) return out;
  out.mean_m /= static_cast<double>(count);
  out.rms_m = std::sqrt(out.rms_m / static_cast<double>(count));
  return out;
}

Wall cut_wall(const program::Program& program, const WallCut& cut, const Eigen::Vector2d& window_x_m) {
  WallCutter cutter(cut, window_x_m);
  for (std::size_t i = 0; i < program.blocks.size(); ++i) {
    const program::Block& block = program.blocks[i];
    if (block.kind == program::Block::Kind::feed) cutter.run(block, program.begin_of(i));
  }
  return cutter.wall();
}

}  // namespace robomill::cutting::testing
