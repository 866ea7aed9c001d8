#include "robomill/stability/surface_error.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <vector>

#include "robomill/base/cost.hpp"
#include "robomill/base/error.hpp"
#include "robomill/base/linear_algebra.hpp"
#include "robomill/base/parallel.hpp"
#include "robomill/base/units.hpp"
#include "robomill/cutting/cut_limits.hpp"
#include "robomill/stability/chart/chart.hpp"
#include "robomill/stability/chart/cost.hpp"
#include "robomill/stability/collocation/collocation.hpp"
#include "robomill/stability/collocation/milling_model.hpp"
#include "robomill/stability/gauss.hpp"
#include "robomill/stability/vibration/surface_error_spatial.hpp"

namespace robomill::stability {
namespace {

using namespace detail;
constexpr double missing = std::numeric_limits<double>::quiet_NaN();

/// Force per depth that a contact makes without any vibration: chip of the feed and of runout, and the edge.
Eigen::Vector2d steady_force(const cutting::Milling& milling, const Contact& contact, double rotation_rad,
                             double depth_m) {
  const cutting::ForceCoefficients& k = milling.coefficients;
  const double lag = milling.tool.lag_rad_per_m(contact.tooth);
  const HeightsInCut in = heights_in_cut(contact, lag, rotation_rad + milling.tool.standing_angle(contact.tooth));
  const double feed_m = milling.tool.teeth * milling.feed_per_tooth_m / units::revolution;  // a radian
  constexpr int heights = 12;
  const GaussRule& rule = gauss_rule(heights);
  Eigen::Vector2d force = Eigen::Vector2d::Zero();
  for (std::size_t h = 0; h < rule.node.size(); ++h) {
    const double height = in.low_m + in.length_m * rule.node[h];
    const double angle = in.turned_rad - lag * height;
    const double sine = std::sin(angle);
    const double cosine = std::cos(angle);
    const double chip_m = contact.step_m + feed_m * (contact.delay_rad + contact.delay_rad_per_m * height) * sine;
    const double tangential = k.tangential_n_per_m2 * chip_m + k.tangential_edge_n_per_m;
    const double radial = k.radial_n_per_m2 * chip_m + k.radial_edge_n_per_m;
    force -= Eigen::Vector2d(tangential * cosine + radial * sine, radial * cosine - tangential * sine) *
             (in.length_m * rule.weight[h] / depth_m);
  }
  return force;
}

/// The same at every node of a case, in order.
std::vector<Eigen::Vector2d> steady_forces(const MillingModel& model, const CollocationCase& at) {
  const double depth_m = model.contacts.depends_on_depth() ? at.axial_depth_m : 1.0;
  const bool sliced = model.contacts.depends_on_depth() && model.milling.tool.runout_m > 0.0;
  const CutterContacts cutter = sliced ? CutterContacts(model.milling, at.level.slices) : model.contacts;
  std::vector<Contact> contacts;
  cutter.at_depth(depth_m, contacts);
  const GaussRule& rule = gauss_rule(at.level.nodes);
  std::vector<Eigen::Vector2d> forces;
  for (std::size_t e = 0; e < at.mesh.pieces.size(); ++e) {
    if (!at.mesh.topology.pieces[e].records) continue;
    const CutMesh::Piece& piece = at.mesh.pieces[e];
    for (const double node : rule.node) {
      Eigen::Vector2d sum = Eigen::Vector2d::Zero();
      for (const Contact& contact : contacts) {
        sum += steady_force(cutter.milling(), contact, piece.from_rad + node * piece.length_rad, depth_m);
      }
      forces.push_back(sum);
    }
  }
  return forces;
}

/// The tip a time after the start of a piece without force.
Eigen::Vector2d coasting(const MillingModel& model, const Eigen::VectorXcd& start, double time_s) {
  Eigen::Vector2d tip = Eigen::Vector2d::Zero();
  for (Eigen::Index k = 0; k < model.tip.pole.size(); ++k) {
    const std::complex<double> here(start(2 * k).real(), start(2 * k + 1).real());
    tip += 2.0 * (model.tip.right.col(k) * (here * std::exp(model.tip.pole(k) * time_s))).real();
  }
  return tip;
}

/// Greatest distance from rest: at the nodes of the cut, and between cuts sixteen times in the fastest mode's period.
double peak_deflection(const MillingModel& model, const CollocationCase& at, const NodeForces<2>& orbit) {
  double peak = 0.0;
  for (const Eigen::Vector2cd& q : orbit.displacement_m) peak = std::max(peak, q.real().norm());
  const Rotation turning(at.spindle_speed_rad_per_s, model.variation);
  const double samples_per_s = 16.0 * model.tip.pole.cwiseAbs().maxCoeff() / units::revolution;
  for (std::size_t e = 0; e < at.mesh.pieces.size(); ++e) {
    if (at.mesh.topology.pieces[e].records) continue;
    const CutMesh::Piece& piece = at.mesh.pieces[e];
    const double length_s = turning.time_s(piece.from_rad + piece.length_rad) - turning.time_s(piece.from_rad);
    const int samples = static_cast<int>(std::min(length_s * samples_per_s, 10000.0)) + 1;
    for (int i = 0; i <= samples; ++i) {
      peak = std::max(peak, coasting(model, orbit.starts[e], length_s * i / samples).norm());
    }
  }
  return peak;
}

/// Tip in y as the first tooth's tip stands at an angle, from the modes at the start of the piece before.
double y_at(const MillingModel& model, const CollocationCase& at, const NodeForces<2>& orbit, double angle_rad) {
  const double wanted =
      at.mesh.pieces.front().from_rad + wrap(angle_rad - at.mesh.pieces.front().from_rad, at.mesh.period_rad);
  for (std::size_t e = 0; e < at.mesh.pieces.size(); ++e) {
    const CutMesh::Piece& piece = at.mesh.pieces[e];
    if (wanted > piece.from_rad + piece.length_rad - 1e-9) continue;
    const Rotation turning(at.spindle_speed_rad_per_s, model.variation);
    const double time_s = turning.time_s(wanted) - turning.time_s(piece.from_rad);
    return coasting(model, orbit.starts[e], time_s).y();
  }
  return missing;
}

/// Of the walls the error that is greatest in magnitude; none where no tooth finishes a wall. At each the tooth that
/// reaches farthest counts, a stiff tool's reaching as far as its radius.
SurfacePlace wall_error(const MillingModel& model, const CollocationCase& at, const NodeForces<2>& orbit) {
  const cutting::FlatEndMill& mill = model.milling.tool;
  SurfacePlace worst;
  const auto look = [&](double wall_rad, double outwards) {
    SurfacePlace wall = {.normal_rad = outwards * 0.5 * std::numbers::pi,
                         .position_rad = 0.5 * std::numbers::pi,
                         .angle_rad = wall_rad,
                         .height_m = 0.0,
                         .radius_m = 0.5 * mill.diameter_m};
    double stiff_m = -std::numeric_limits<double>::infinity();
    double reach_m = stiff_m;
    for (int tooth = 0; tooth < mill.teeth; ++tooth) {
      const double longer = mill.radius_deviation_m(tooth, 0.0);
      const double reach = longer + outwards * y_at(model, at, orbit, wall_rad - mill.standing_angle(tooth));
      stiff_m = std::max(stiff_m, longer);
      if (reach <= reach_m) continue;
      reach_m = reach;
      wall.tooth = tooth;
    }
    wall.error_m = stiff_m - reach_m;
    if (!(std::abs(wall.error_m) <= std::abs(worst.error_m))) worst = wall;
  };
  // A tooth at φ = 0 stands at the wall on the left, at φ = π at that on the right.
  if (model.milling.immersion.entry_rad <= 1e-9) look(0.0, 1.0);
  if (model.milling.immersion.exit_rad >= std::numbers::pi - 1e-9) look(std::numbers::pi, -1.0);
  return worst;
}

SurfacePoint orbit_at(const MillingModel& model, const OperatingPoint& point, int level) {
  CollocationCase at;
  model.prepare(point, mesh_level(level), at);
  const std::vector<Eigen::Vector2d> forces = steady_forces(model, at);
  const NodeLayout layout(at.mesh.topology, static_cast<std::size_t>(model.tip.pole.size()));
  const Eigen::Index size = static_cast<Eigen::Index>(layout.size());
  // One real run carries two entries of the state, one in each part.
  const Eigen::VectorXcd rest = Eigen::VectorXcd::Zero(size);
  Eigen::MatrixXd matrix(size, size);
  for (Eigen::Index j = 0; j < size; j += 2) {
    Eigen::VectorXcd unit = Eigen::VectorXcd::Zero(size);
    unit(j) = 1.0;
    if (j + 1 < size) unit(j + 1) = std::complex<double>(0.0, 1.0);
    const Eigen::VectorXcd end = trace<2>(at, point.axial_depth_m, unit).end;
    matrix.col(j) = end.real();
    if (j + 1 < size) matrix.col(j + 1) = end.imag();
  }
  const Eigen::VectorXd pushed = trace<2>(at, point.axial_depth_m, rest, forces).end.real();
  const Eigen::VectorXd start =
      linear_algebra::solve(Eigen::MatrixXd(Eigen::MatrixXd::Identity(size, size) - matrix), pushed);
  const NodeForces<2> orbit = trace<2>(at, point.axial_depth_m, start.cast<std::complex<double>>(), forces);

  SurfacePoint result;
  result.stable = true;
  Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector2d high = -low;
  for (const Eigen::Vector2cd& q : orbit.displacement_m) {
    low = low.cwiseMin(q.real());
    high = high.cwiseMax(q.real());
  }
  result.peak_to_peak_x_m = high(0) - low(0);
  result.peak_to_peak_y_m = high(1) - low(1);
  result.peak_deflection_m = peak_deflection(model, at, orbit);
  result.peak_to_peak_z_m = 0.0;
  result.place = wall_error(model, at, orbit);
  result.surface_location_error_m = result.place.error_m;
  return result;
}

void require_surface(const LobesProblem& problem) {
  if (problem.drilling) throw InvalidInput("drilling", "must not be there: a drill leaves no surface that is known");
  if (problem.has_measured()) {
    throw InvalidInput("dynamics.frf", "does not go with a surface, which needs modes",
                       "Fit them first: robomill modes");
  }
  const double feed_m = problem.spatial ? problem.spatial->feed_per_tooth_m : problem.milling.feed_per_tooth_m;
  if (!(feed_m > 0.0)) throw InvalidInput("feed_per_tooth_m", feed_m, "m", "must be > 0 for a surface");
}

void check(const LobesProblem& problem, const OperatingPoint& point) {
  problem.validate();
  require_surface(problem);
  require_positive("axial_depth_m", point.axial_depth_m, "m");
  cutting::require_spindle_speed("spindle_speed_rad_per_s", point.spindle_speed_rad_per_s);
  require_affordable(cost_of_looks(problem, {}, std::array{point.spindle_speed_rad_per_s}, {.a_speed = 10.0}));
}

void require_space(const LobesProblem& problem, const OperatingPoint& point) {
  check(problem, point);
  if (!problem.spatial) throw InvalidInput("spatial", "must be there: a wall in the plane has no profile");
}

/// Surfaces of stable cuts; shared by threads.
class Surfaces {
 public:
  explicit Surfaces(const LobesProblem& problem) {
    if (problem.spatial) {
      spatial_.emplace(problem);
    } else {
      plane_.emplace(problem, MeshTopology::Form::several);
    }
  }
  /// @param finer  levels of the plane beyond that of the tolerance
  [[nodiscard]] SurfacePoint at(const OperatingPoint& point, double tolerance, int finer) const {
    if (spatial_) return spatial_->at(point, spatial_->model().first_level(point, tolerance));
    return orbit_at(*plane_, point, plane_->first_level(point, tolerance) + finer);
  }

 private:
  std::optional<SpatialSurface> spatial_;
  std::optional<MillingModel> plane_;
};

}  // namespace

SurfacePoint surface_of_stable_cut(const LobesProblem& problem, const OperatingPoint& point, double tolerance) {
  check(problem, point);
  return Surfaces(problem).at(point, tolerance, 1);
}

SurfacePoint surface_point(const LobesProblem& problem, const OperatingPoint& point, double tolerance) {
  check(problem, point);
  const std::unique_ptr<CollocationModel> model = collocation_model(problem);
  CollocationEvaluator evaluator(*model, tolerance);
  Outcome outcome;
  evaluator.evaluate({&point, 1}, {.estimate = true}, {&outcome, 1});
  if (outcome.spectral_radius >= 1.0) return {};
  return Surfaces(problem).at(point, tolerance, 1);
}

std::vector<SurfacePlace> surface_profile(const LobesProblem& problem, const OperatingPoint& point, double tolerance) {
  require_space(problem, point);
  const SpatialSurface surface(problem);
  return surface.profile(point, surface.model().first_level(point, tolerance));
}

SteadyCut steady_cut(const LobesProblem& problem, const OperatingPoint& point, double tolerance) {
  require_space(problem, point);
  const SpatialSurface surface(problem);
  return surface.steady(point, surface.model().first_level(point, tolerance));
}

SurfaceMap surface_map(const LobesProblem& problem, const LobesOptions& options, const std::array<int, 2>& grid,
                       Progress& progress) {
  problem.validate();
  options.validate();
  require_surface(problem);
  for (const int points : grid) {
    if (points < 2 || points > 2000) throw InvalidInput("grid", points, "", "must lie between 2 and 2000");
  }
  std::vector<double> depths = even(options.axial_depth_m, grid[1] + 1);
  depths.erase(depths.begin());
  const Axes axes = {even(options.spindle_speed_rad_per_s, grid[0]), depths};
  constexpr double usual_nodes = 3600.0, looks_a_surface = 4.0;
  const double nodes = static_cast<double>(grid[0]) * grid[1];
  LobesOptions collocated = options;
  collocated.method = Method::collocation;
  const ThreadLimit threads(
      require_affordable(cost_of_looks(problem, collocated, axes.spindle_speed_rad_per_s,
                                       {.a_speed = looks_a_surface * grid[1],
                                        .bytes = 120.0 * nodes,
                                        .counted = {.field = "grid",
                                                    .value = static_cast<double>(std::max(grid[0], grid[1])),
                                                    .times_usual = nodes / usual_nodes}})));
  const std::unique_ptr<Scheme> scheme = collocation(problem, options.tolerance);
  const Surfaces surfaces(problem);
  Count count;
  const GridRadii radii = evaluate_grid(*scheme, axes, options.tolerance, count, progress);
  SurfaceMap map;
  const Eigen::Index n = grid[0];
  const Eigen::Index m = grid[1];
  map.spindle_speed_rad_per_s = Eigen::Map<const Eigen::VectorXd>(axes.spindle_speed_rad_per_s.data(), n);
  map.axial_depth_m = Eigen::Map<const Eigen::VectorXd>(depths.data(), m);
  map.surface_location_error_m = Eigen::MatrixXd::Constant(m, n, missing);
  map.peak_to_peak_m = map.surface_location_error_m;
  progress.start("surface error", static_cast<std::size_t>(n));
  parallel_for(static_cast<std::size_t>(n), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      for (std::size_t d = 0; d < depths.size(); ++d) {
        progress.check();
        const Eigen::Index row = static_cast<Eigen::Index>(d);
        const Eigen::Index column = static_cast<Eigen::Index>(s);
        if (radii.unstable(row, column)) continue;
        const SurfacePoint point = surfaces.at(axes.at(s, d), options.tolerance, 0);
        map.surface_location_error_m(row, column) = point.surface_location_error_m;
        map.peak_to_peak_m(row, column) =
            std::max({point.peak_to_peak_x_m, point.peak_to_peak_y_m, point.peak_to_peak_z_m});
      }
      progress.advance();
    }
  });
  return map;
}

}  // namespace robomill::stability
