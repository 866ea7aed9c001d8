#include "robomill/stability/collocation/milling_model.hpp"

#include <algorithm>
#include <cmath>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/stability/gauss.hpp"

namespace robomill::stability::detail {
namespace {

using Form = MeshTopology::Form;

/// Compliance added at each node.
Eigen::MatrixXd whole_response(const PiecePlan& plan, const Eigen::Matrix2d& compliance) {
  Eigen::MatrixXd response = plan.response;
  for (Eigen::Index i = 0; i < response.rows(); i += 2) response.block<2, 2>(i, i) += compliance;
  return response;
}

void reduce_chip(const CutMesh::Piece& mesh, const PiecePlan& plan, const Eigen::MatrixXd& response,
                 CollocationCase::Piece& out) {
  const Eigen::Index p = static_cast<Eigen::Index>(mesh.chip.size());
  out.coupling.resize(p, p);
  out.observation.resize(p, plan.at_nodes.cols());
  out.influence.resize(plan.influence.rows(), p);
  for (Eigen::Index i = 0; i < p; ++i) {
    const Eigen::Vector2d& chip = mesh.chip[static_cast<std::size_t>(i)];
    const Eigen::Vector2d& push = mesh.push[static_cast<std::size_t>(i)];
    out.observation.row(i) = chip.transpose() * plan.at_nodes.middleRows<2>(2 * i);
    out.influence.col(i) = plan.influence.middleCols<2>(2 * i) * push;
    for (Eigen::Index l = 0; l < p; ++l) {
      out.coupling(i, l) = chip.dot(response.block<2, 2>(2 * i, 2 * l) * mesh.push[static_cast<std::size_t>(l)]);
    }
  }
}

void reduce_whole(const CutMesh::Piece& mesh, const PiecePlan& plan, const Eigen::MatrixXd& response,
                  CollocationCase::Piece& out) {
  const Eigen::Index m = response.rows();
  out.coupling.resize(m, m);
  out.observation = plan.at_nodes;
  out.influence.resize(plan.influence.rows(), m);
  for (Eigen::Index l = 0; l < m; l += 2) {
    const Eigen::Matrix2d& k = mesh.stiffness[static_cast<std::size_t>(l / 2)];
    out.coupling.middleCols<2>(l).noalias() = response.middleCols<2>(l) * k;
    out.influence.middleCols<2>(l).noalias() = plan.influence.middleCols<2>(l) * k;
  }
}

void reduce_several(const CutMesh::Piece& mesh, const PiecePlan& plan, const Eigen::MatrixXd& response,
                    CollocationCase::Piece& out) {
  const Eigen::Index m = response.rows();
  out.coupling.resize(m, m);
  out.observation.resize(m, plan.at_nodes.cols());
  out.influence = plan.influence;
  out.displacement = plan.at_nodes;
  out.node_response = response;
  for (Eigen::Index i = 0; i < m; i += 2) {
    const Eigen::Matrix2d& k = mesh.stiffness[static_cast<std::size_t>(i / 2)];
    out.coupling.middleRows<2>(i).noalias() = k * response.middleRows<2>(i);
    out.observation.middleRows<2>(i).noalias() = k * plan.at_nodes.middleRows<2>(i);
    if (mesh.damping.empty()) continue;
    const Eigen::Matrix2d& c = mesh.damping[static_cast<std::size_t>(i / 2)];
    out.coupling.middleRows<2>(i).noalias() += c * plan.velocity_response.middleRows<2>(i);
    out.observation.middleRows<2>(i).noalias() += c * plan.velocity_at_nodes.middleRows<2>(i);
  }
}

}  // namespace

int common_repeats(const cutting::SpeedVariation& variation, double period_rad) {
  if (!variation.active()) return 1;
  constexpr int most = 256;
  const double swings = variation.frequency_ratio * period_rad / units::revolution;  // in a period of the cutter
  for (int repeats = 1; repeats <= most; ++repeats) {
    const double count = swings * repeats;
    if (std::round(count) >= 1.0 && std::abs(count - std::round(count)) < 1e-9 * count) return repeats;
  }
  throw InvalidInput("frequency_ratio", variation.frequency_ratio, "",
                     "does not fit the rotation: no whole number of swings in 256 periods of the cut",
                     "Take a simple ratio, such as 0.1, 0.25 or 0.5");
}

MillingModel::MillingModel(const LobesProblem& problem, MeshTopology::Form least_form)
    : tip(tip_dynamics(problem)),
      variation(problem.milling.speed_variation),
      contacts(problem.milling, MeshLevel{}.slices),
      milling(problem.milling),
      repeats(common_repeats(variation, contacts.period_rad())),
      fastest_rad_per_s(tip.pole.cwiseAbs().maxCoeff()),
      least(least_form) {
  for (Eigen::Index k = 0; k < tip.pole.size(); ++k) {
    quickening += std::abs(tip.pole(k)) * 2.0 * tip.right.col(k).norm() * tip.left.col(k).norm();
  }
  const cutting::ForceCoefficients& c = milling.coefficients;
  const double teeth_in_cut =
      std::ceil((milling.immersion.exit_rad - milling.immersion.entry_rad) * milling.tool.teeth / units::revolution);
  quickening *= std::hypot(c.tangential_n_per_m2, c.radial_n_per_m2) * teeth_in_cut;
}

double MillingModel::reported_rad() const {
  return contacts.period() == Period::tooth && !variation.active() ? contacts.period_rad() : units::revolution;
}

int MillingModel::first_level(const OperatingPoint& point, double tolerance) const {
  // A piece is cut to the structure's own radians; the cut makes it quicker.
  const double stretch = std::min(milling.immersion.exit_rad - milling.immersion.entry_rad, contacts.period_rad()) *
                         fastest_rad_per_s / point.spindle_speed_rad_per_s;
  const double quicker = std::sqrt(1.0 + quickening * factor(point) / (fastest_rad_per_s * fastest_rad_per_s));
  return level_for(stretch, quicker, tolerance);
}

void MillingModel::make(const OperatingPoint& point, const MeshLevel& level, const CollocationCase*,
                        CollocationCase& out) const {
  constexpr double least_depth_m = 1e-6;  // below it the mesh is that of a thin slice, whose ends do not fall together
  out.spindle_speed_rad_per_s = point.spindle_speed_rad_per_s;
  out.axial_depth_m = point.axial_depth_m;
  out.level = level;
  const Rotation turning(point.spindle_speed_rad_per_s, variation);
  const double depth_m = contacts.depends_on_depth() ? std::max(point.axial_depth_m, least_depth_m) : 1.0;
  const bool sliced = contacts.depends_on_depth() && milling.tool.runout_m > 0.0;
  const CutterContacts cutter = sliced ? CutterContacts(milling, level.slices) : contacts;
  build_mesh(cutter, repeats, fastest_rad_per_s, turning, depth_m, level, least, out.mesh);

  const bool velocities = milling.process_damping.active();
  out.plans.clear();
  out.pieces.assign(out.mesh.pieces.size(), {});
  for (std::size_t e = 0; e < out.pieces.size(); ++e) {
    const CutMesh::Piece& mesh = out.mesh.pieces[e];
    CollocationCase::Piece& piece = out.pieces[e];
    const auto alike = [&](std::size_t other) {
      return turning.even() && out.mesh.topology.pieces[other].records == out.mesh.topology.pieces[e].records &&
             std::abs(out.mesh.pieces[other].length_rad - mesh.length_rad) < 1e-14 * mesh.length_rad;
    };
    std::size_t known = 0;
    while (known < e && !alike(known)) ++known;
    if (known < e) {
      piece.plan = out.pieces[known].plan;
    } else {
      piece.plan = out.plans.size();
      plan_piece(tip, turning, mesh.from_rad, mesh.length_rad, out.mesh.topology.pieces[e].records ? level.nodes : 1,
                 velocities, out.plans.emplace_back());
    }
    if (!out.mesh.topology.pieces[e].records) continue;
    const PiecePlan& plan = out.plans[piece.plan];
    const Eigen::MatrixXd response = whole_response(plan, tip.compliance);
    switch (out.mesh.topology.form) {
      case Form::chip:
        reduce_chip(mesh, plan, response, piece);
        break;
      case Form::whole:
        reduce_whole(mesh, plan, response, piece);
        break;
      default:
        reduce_several(mesh, plan, response, piece);
        break;
    }
  }
}

Motion MillingModel::motion(const CollocationCase& at, double factor, std::complex<double> multiplier,
                            const Eigen::VectorXcd& vector) const {
  const NodeForces<2> forces = trace<2>(at, factor, vector);
  const Rotation turning(at.spindle_speed_rad_per_s, variation);
  const double start = at.mesh.pieces.front().from_rad;
  const double period_s = turning.time_s(start + whole_rad()) - turning.time_s(start);
  return find_motion(tip, multiplier, period_s, vector,
                     [&](std::complex<double> s) { return fourier_coefficient(forces, period_s, s); });
}

}  // namespace robomill::stability::detail
