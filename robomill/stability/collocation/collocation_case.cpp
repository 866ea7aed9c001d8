#include "robomill/stability/collocation/collocation_case.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/stability/gauss.hpp"

namespace robomill::stability::detail {
namespace {

using Form = MeshTopology::Form;

/// How many periods of the cutter make a whole number of swings.
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

void reduce_plane(const CutMesh::Piece& mesh, const PiecePlan& plan, const Eigen::MatrixXd& response,
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

CollocationModel::CollocationModel(const LobesProblem& problem, MeshTopology::Form least_form)
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

double CollocationModel::reported_rad() const {
  return contacts.period() == Period::tooth && !variation.active() ? contacts.period_rad() : units::revolution;
}

void prepare_case(const CollocationModel& model, double spindle_speed_rad_per_s, double axial_depth_m,
                  const MeshLevel& level, CollocationCase& out) {
  constexpr double least_depth_m = 1e-6;  // below it the mesh is that of a thin slice, whose ends do not fall together
  out.spindle_speed_rad_per_s = spindle_speed_rad_per_s;
  out.axial_depth_m = axial_depth_m;
  out.level = level;
  const Rotation turning(spindle_speed_rad_per_s, model.variation);
  const double depth_m = model.contacts.depends_on_depth() ? std::max(axial_depth_m, least_depth_m) : 1.0;
  const bool sliced = model.contacts.depends_on_depth() && model.milling.tool.runout_m > 0.0;
  const CutterContacts contacts = sliced ? CutterContacts(model.milling, level.slices) : model.contacts;
  build_mesh(contacts, model.repeats, model.fastest_rad_per_s, turning, depth_m, level, model.least, out.mesh);

  const bool velocities = model.milling.process_damping.active();
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
      plan_piece(model.tip, turning, mesh.from_rad, mesh.length_rad,
                 out.mesh.topology.pieces[e].records ? level.nodes : 1, velocities, out.plans.emplace_back());
    }
    if (!out.mesh.topology.pieces[e].records) continue;
    const PiecePlan& plan = out.plans[piece.plan];
    const Eigen::MatrixXd response = whole_response(plan, model.tip.compliance);
    switch (out.mesh.topology.form) {
      case Form::chip:
        reduce_chip(mesh, plan, response, piece);
        break;
      case Form::plane:
        reduce_plane(mesh, plan, response, piece);
        break;
      case Form::several:
        reduce_several(mesh, plan, response, piece);
        break;
    }
  }
}

NodeLayout::NodeLayout(const MeshTopology& topology, std::size_t modes)
    : modal(2 * modes), nodes(static_cast<std::size_t>(topology.nodes * topology.channels())) {
  before.assign(topology.pieces.size(), nowhere);
  record.assign(topology.pieces.size(), nowhere);
  for (const MeshTopology::Piece& piece : topology.pieces) {
    for (const Source& source : piece.sources) {
      if (source.before) before[static_cast<std::size_t>(source.piece)] = 0;
    }
  }
  for (std::size_t& entry : before) {
    if (entry == nowhere) continue;
    entry = memory;
    memory += nodes;
  }
  for (std::size_t e = 0; e < record.size(); ++e) {
    if (!topology.pieces[e].records) continue;
    record[e] = memory;
    memory += nodes;
  }
  for (std::size_t e = 0; e < record.size(); ++e) {
    for (std::size_t i = 0; before[e] != nowhere && i < nodes; ++i) handed.push_back(record[e] + i);
  }
}

NodeForces trace(const CollocationModel& model, const CollocationCase& point, double axial_depth_m,
                 const Eigen::VectorXcd& state, std::span<const Eigen::Vector2d> forcing_n_per_m) {
  const MeshTopology& topology = point.mesh.topology;
  const NodeLayout layout(topology, static_cast<std::size_t>(model.tip.pole.size()));
  const Eigen::Index modal = static_cast<Eigen::Index>(layout.modal);
  const Eigen::Index m = static_cast<Eigen::Index>(layout.nodes);
  const Eigen::Index channels = topology.channels();
  const GaussRule& rule = gauss_rule(topology.nodes);
  Eigen::VectorXcd z = state.head(modal);
  Eigen::VectorXcd memory = Eigen::VectorXcd::Zero(static_cast<Eigen::Index>(layout.memory));
  memory.head(state.size() - modal) = state.tail(state.size() - modal);
  NodeForces out;
  double start_s = 0.0;
  for (std::size_t e = 0; e < point.pieces.size(); ++e) {
    const CollocationCase::Piece& piece = point.pieces[e];
    const CutMesh::Piece& mesh = point.mesh.pieces[e];
    const PiecePlan& plan = point.plans[piece.plan];
    out.starts.push_back(z);
    Eigen::VectorXcd end(modal);  // the modes alone
    for (Eigen::Index k = 0; k < modal; k += 2) {
      const std::complex<double> factor = plan.factor(k / 2);
      end(k) = factor.real() * z(k) - factor.imag() * z(k + 1);
      end(k + 1) = factor.imag() * z(k) + factor.real() * z(k + 1);
    }
    if (topology.pieces[e].records) {
      Eigen::VectorXcd c = Eigen::VectorXcd::Zero(m);
      for (std::size_t s = 0; s < topology.pieces[e].sources.size(); ++s) {
        const Source& source = topology.pieces[e].sources[s];
        const std::size_t from =
            (source.before ? layout.before : layout.record)[static_cast<std::size_t>(source.piece)];
        Eigen::Vector2cd seen = Eigen::Vector2cd::Zero();
        for (Eigen::Index l = 0; l < topology.nodes; ++l) {
          const double weight =
              mesh.weights[s * static_cast<std::size_t>(topology.nodes) + static_cast<std::size_t>(l)];
          for (Eigen::Index k = 0; k < channels; ++k) {
            seen(k) += weight * memory(static_cast<Eigen::Index>(from) + l * channels + k);
          }
        }
        const Eigen::Index node = static_cast<Eigen::Index>(s) % topology.nodes;
        if (topology.form == Form::several) seen = (mesh.delayed_stiffness[s] * seen).eval();
        for (Eigen::Index k = 0; k < channels; ++k) c(node * channels + k) += seen(k);
      }
      for (Eigen::Index i = 0; i < topology.nodes && !forcing_n_per_m.empty(); ++i) {
        const Eigen::Vector2d& forcing = forcing_n_per_m[out.force_n.size() + static_cast<std::size_t>(i)];
        c(2 * i) -= forcing(0);
        c(2 * i + 1) -= forcing(1);
      }
      const Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(m, m) - axial_depth_m * piece.coupling;
      const Eigen::PartialPivLU<Eigen::MatrixXd> solver(matrix);
      const Eigen::VectorXcd right = piece.observation * z - c;
      Eigen::VectorXcd g(m);
      g.real() = solver.solve(right.real());
      g.imag() = solver.solve(right.imag());
      end += axial_depth_m * (piece.influence * g);
      Eigen::VectorXcd left = g + c;
      if (topology.form == Form::several) left = piece.displacement * z + axial_depth_m * (piece.node_response * g);
      memory.segment(static_cast<Eigen::Index>(layout.record[e]), m) = left;
      for (Eigen::Index i = 0; i < topology.nodes; ++i) {
        const std::size_t node = static_cast<std::size_t>(i);
        Eigen::Vector2cd force;
        if (topology.form == Form::chip) {
          force = mesh.push[node] * g(i);
        } else {
          force << g(2 * i), g(2 * i + 1);
          if (topology.form == Form::plane) force = (mesh.stiffness[node] * force).eval();
        }
        out.force_n.emplace_back(axial_depth_m * force);
        if (topology.form == Form::several) out.displacement_m.emplace_back(left(2 * i), left(2 * i + 1));
        out.time_s.push_back(start_s + plan.time_s[node]);
        const Rotation turning(point.spindle_speed_rad_per_s, model.variation);
        const double speed = turning.speed_rad_per_s(mesh.from_rad + rule.node[node] * mesh.length_rad);
        out.weight_s.push_back(rule.weight[node] * mesh.length_rad / speed);
      }
    }
    z = end;
    start_s += plan.duration_s;
  }
  out.end.resize(state.size());
  out.end.head(modal) = z;
  for (std::size_t i = 0; i < layout.handed.size(); ++i) {
    out.end(modal + static_cast<Eigen::Index>(i)) = memory(static_cast<Eigen::Index>(layout.handed[i]));
  }
  return out;
}

}  // namespace robomill::stability::detail
