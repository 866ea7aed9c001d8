#pragma once
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "robomill/simulation/engine.hpp"
#include "robomill/simulation/posture.hpp"
#include "robomill/simulation/posture_model.hpp"
#include "testing/simulation/cuts.hpp"

/// Cuts in any posture that this stage's tests and benchmarks share.
namespace robomill::simulation::testing {

inline constexpr double revolution = 2.0 * std::numbers::pi;

/// Every ring's angles for which inside(point, normal), both in F with the origin at a ball's centre, found by looking.
template <class Inside>
cutting::Engagement looked_at(const cutting::Cutter& cutter, const Eigen::Matrix3d& feed_from_tool, int rings,
                              const Inside& inside) {
  constexpr int looks = 720;
  const double radius = 0.5 * cutter.mill.diameter_m;
  cutting::Engagement e = {.feed_from_tool = feed_from_tool};
  e.first_arc.push_back(0);
  for (int i = 0; i < rings; ++i) {
    const double kappa = 0.5 * std::numbers::pi * (i + 0.5) / rings;
    const double lag = std::pow(std::sin(kappa), 2) * std::tan(cutter.mill.helix_rad);
    const auto at = [&](double angle) {
      const Eigen::Vector3d n(std::sin(kappa) * std::sin(angle), std::sin(kappa) * std::cos(angle), -std::cos(kappa));
      const Eigen::Vector3d in_feed_frame = feed_from_tool * n;
      return inside(Eigen::Vector3d(radius * in_feed_frame), in_feed_frame);
    };
    const auto border = [&](double out, double in) {
      for (int k = 0; k < 50; ++k) (at(0.5 * (out + in)) ? in : out) = 0.5 * (out + in);
      return 0.5 * (out + in);
    };
    std::vector<double> entries, exits;
    for (int k = 0; k < looks; ++k) {
      const double a = revolution * k / looks, b = revolution * (k + 1) / looks;
      if (!at(a) && at(b)) entries.push_back(border(a, b));
      if (at(a) && !at(b)) exits.push_back(border(b, a));
    }
    if (entries.empty() && at(0.0)) e.arcs.push_back({0.0, revolution});
    for (const double entry : entries) {
      double exit = exits.front() + revolution;
      for (const double x : exits) {
        if (x > entry) exit = std::min(exit, x);
      }
      e.arcs.push_back({entry, exit});
    }
    if (e.arcs.size() == e.first_arc.back()) continue;
    e.slices.push_back({.radius_m = radius * std::sin(kappa),
                        .height_m = radius * (1.0 - std::cos(kappa)),
                        .position_rad = kappa,
                        .width_m = radius * 0.5 * std::numbers::pi / rings,
                        .edge_length_per_width = std::hypot(1.0, lag)});
    e.first_arc.push_back(e.arcs.size());
  }
  return e;
}

/// A ball end of 6 mm, two teeth, 18,000 rpm; the pass beside it lies at -y.
inline PostureCut ball_cut(double lead_rad = 0.0, double tilt_rad = 0.0, int rings = 30) {
  PostureCut cut;
  cut.cutter.kind = cutting::CutterKind::ball_end;
  cut.cutter.mill.teeth = 2;
  cut.cutter.mill.diameter_m = 6e-3;
  cut.cutter.mill.helix_rad = 0.5;
  const double radius = 3e-3, depth = 1e-3, stepover = 5e-4;
  cut.engagement =
      looked_at(cut.cutter, cutting::feed_from_tool(lead_rad, tilt_rad), rings,
                [=](const Eigen::Vector3d& p, const Eigen::Vector3d& n) {
                  return n.x() > 0.0 && p.z() <= depth - radius && std::hypot(p.y() + stepover, p.z()) >= radius;
                });
  cut.coefficients = {.tangential_n_per_m2 = {3.254e8, 4.358e8, -6.525e7, 1.772e9},
                      .radial_n_per_m2 = {2e8, 7e8},
                      .axial_n_per_m2 = {-3e8, 1e8},
                      .tangential_edge_n_per_m = {1.3e4},
                      .radial_edge_n_per_m = {1.5e4},
                      .axial_edge_n_per_m = {-1.1e4}};
  cut.motion = {.feed_per_tooth_m = 1e-6, .spindle_speed_rad_per_s = 18000.0 * rpm};
  cut.structure = no_modes();
  return cut;
}

/// Slow modes in all directions, as an arm has them, and the spindle's and tool's own.
inline modal::TipModes arm_modes() {
  modal::TipModes modes = one_mode(0, 18.0, 0.03, 160.0);
  const auto also = [&](Eigen::Index axis, double frequency_hz, double mass_kg) {
    modes = modal::joined(modes, one_mode(axis, frequency_hz, 0.03, mass_kg));
  };
  also(1, 14.0, 190.0);
  also(2, 23.0, 120.0);
  also(0, 850.0, 0.6);
  also(1, 910.0, 0.6);
  also(2, 1400.0, 1.5);
  return modes;
}

inline double polynomial(const std::vector<double>& coefficients, double x) {
  double sum = 0.0;
  for (const double c : coefficients) sum = sum * x + c;
  return sum;
}

inline Eigen::Vector3d normal(double kappa, double angle) {
  return {std::sin(kappa) * std::sin(angle), std::sin(kappa) * std::cos(angle), -std::cos(kappa)};
}

/// Of one ring's edge at φ, in T: what chip thickness adds to the force, and what is there without it.
struct EdgeForce {
  Eigen::Vector3d per_chip_n_per_m, edge_n;
};
inline EdgeForce edge_force(const PostureCut& cut, const cutting::EdgeSlice& slice, double angle) {
  const double kappa = slice.position_rad;
  const Eigen::Vector3d t(std::cos(angle), -std::sin(angle), 0.0), n = normal(kappa, angle);
  const Eigen::Vector3d m(std::cos(kappa) * std::sin(angle), std::cos(kappa) * std::cos(angle), std::sin(kappa));
  const cutting::MillingCoefficients& k = cut.coefficients;
  const auto sum = [&](const auto& tangential, const auto& radial, const auto& axial) -> Eigen::Vector3d {
    return -polynomial(tangential, kappa) * t - polynomial(radial, kappa) * n + polynomial(axial, kappa) * m;
  };
  return {slice.width_m * sum(k.tangential_n_per_m2, k.radial_n_per_m2, k.axial_n_per_m2),
          slice.width_m * slice.edge_length_per_width *
              sum(k.tangential_edge_n_per_m, k.radial_edge_n_per_m, k.axial_edge_n_per_m)};
}

/// Calls what(slice, tooth, φ) for every edge that cuts at this rotation.
template <class What>
void for_edges(const PostureCut& cut, double rotation, const What& what) {
  const cutting::FlatEndMill& mill = cut.cutter.mill;
  for (std::size_t i = 0; i < cut.engagement.slices.size(); ++i) {
    const cutting::EdgeSlice& slice = cut.engagement.slices[i];
    for (int j = 0; j < mill.teeth; ++j) {
      const double angle = rotation + mill.standing_angle(j) - mill.lag_rad_per_m(j) * slice.height_m;
      for (const cutting::Arc& arc : cut.engagement.of(i)) {
        const double in = angle - arc.entry_rad;
        if (in - revolution * std::floor(in / revolution) < arc.exit_rad - arc.entry_rad) what(slice, j, angle);
      }
    }
  }
}

/// Force on the tool in F of a cutter that cannot vibrate; every earlier tooth's surface counts.
inline Eigen::Vector3d rigid_force(const PostureCut& cut, double rotation) {
  const cutting::FlatEndMill& mill = cut.cutter.mill;
  const Eigen::Vector3d feed = cut.engagement.feed_from_tool.row(0).transpose();
  const double feed_per_rad = cut.motion.feed_per_tooth_m * mill.teeth / revolution;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for_edges(cut, rotation, [&](const cutting::EdgeSlice& slice, int tooth, double angle) {
    const double kappa = slice.position_rad;
    double chip = 1.0, ahead = 0.0;
    for (int m = 1; m <= mill.teeth; ++m) {
      const int before = (tooth + m) % mill.teeth;
      ahead += mill.pitch((tooth + m - 1) % mill.teeth);
      const double longer =
          mill.radius_deviation_m(tooth, slice.height_m) - mill.radius_deviation_m(before, slice.height_m);
      chip = std::min(chip, feed_per_rad * ahead * normal(kappa, angle).dot(feed) + longer * std::sin(kappa));
    }
    if (chip <= 0.0) return;
    const EdgeForce force = edge_force(cut, slice, angle);
    sum += force.per_chip_n_per_m * chip + force.edge_n;
  });
  return cut.engagement.feed_from_tool * sum;
}

/// A cut step by step, in F.
struct Process {
  Process(const PostureCut& cut, int steps, detail::Physics physics)
      : model(detail::posture_model(cut, steps)),
        engine(model, modal::turned(cut.structure, cut.engagement.feed_from_tool.transpose()), physics),
        feed_from_tool(cut.engagement.feed_from_tool) {}
  [[nodiscard]] Eigen::Vector3d force() const { return feed_from_tool * engine.mean_force(); }
  [[nodiscard]] Eigen::Vector3d displacement() const { return feed_from_tool * engine.displacement(); }
  detail::CutModel model;
  detail::Engine<3> engine;
  Eigen::Matrix3d feed_from_tool;
};

}  // namespace robomill::simulation::testing
