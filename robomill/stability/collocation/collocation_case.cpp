#include "robomill/stability/collocation/collocation_case.hpp"

#include <Eigen/LU>

namespace robomill::stability::detail {
namespace {

using Form = MeshTopology::Form;

/// c of one piece: what it looks back to.
Eigen::VectorXcd looked_back(const CollocationCase& point, const NodeLayout& layout, std::size_t e,
                             const Eigen::VectorXcd& memory) {
  const MeshTopology& topology = point.mesh.topology;
  const CutMesh::Piece& mesh = point.mesh.pieces[e];
  const Eigen::Index m = static_cast<Eigen::Index>(layout.nodes);
  const Eigen::Index channels = topology.channels();
  Eigen::VectorXcd c = Eigen::VectorXcd::Zero(m);
  for (std::size_t s = 0; s < topology.pieces[e].sources.size(); ++s) {
    const Source& source = topology.pieces[e].sources[s];
    const std::size_t from = (source.before ? layout.before : layout.record)[static_cast<std::size_t>(source.piece)];
    if (topology.form == Form::blocks) {
      c += point.pieces[e].delayed[s] * memory.segment(static_cast<Eigen::Index>(from), m);
      continue;
    }
    const Eigen::Index node = static_cast<Eigen::Index>(s) % topology.nodes;
    Eigen::VectorXcd seen = Eigen::VectorXcd::Zero(channels);
    for (Eigen::Index l = 0; l < topology.nodes; ++l) {
      const bool exact = mesh.weights.empty();
      const double weight =
          exact ? (l == node ? 1.0 : 0.0)
                : mesh.weights[s * static_cast<std::size_t>(topology.nodes) + static_cast<std::size_t>(l)];
      seen += weight * memory.segment(static_cast<Eigen::Index>(from) + l * channels, channels);
    }
    if (topology.form == Form::several) seen = (mesh.delayed_stiffness[s] * seen).eval();
    c.segment(node * channels, channels) += seen;
  }
  return c;
}

/// The force of one piece per factor, at each node, from g.
template <int D>
Eigen::VectorXcd force_of(const CollocationCase& point, std::size_t e, const Eigen::VectorXcd& g) {
  const MeshTopology& topology = point.mesh.topology;
  const CutMesh::Piece& mesh = point.mesh.pieces[e];
  if (topology.form == Form::several || topology.form == Form::blocks) return g;
  if (D == 3) return point.pieces[e].stiffness * g;
  Eigen::VectorXcd force(D * topology.nodes);
  for (Eigen::Index i = 0; i < topology.nodes; ++i) {
    const std::size_t node = static_cast<std::size_t>(i);
    if (topology.form == Form::chip) {
      force.segment(2 * i, 2) = mesh.push[node] * g(i);
    } else {
      force.segment(2 * i, 2) = mesh.stiffness[node] * g.segment(2 * i, 2);
    }
  }
  return force;
}

}  // namespace

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

template <int D>
NodeForces<D> trace(const CollocationCase& point, double factor, const Eigen::VectorXcd& state,
                    std::span<const Eigen::Matrix<double, D, 1>> forcing_n_per_m) {
  const MeshTopology& topology = point.mesh.topology;
  const NodeLayout layout(topology, static_cast<std::size_t>(point.plans.front().factor.size()));
  const Eigen::Index modal = static_cast<Eigen::Index>(layout.modal);
  const Eigen::Index m = static_cast<Eigen::Index>(layout.nodes);
  const bool remembers_motion = topology.form == Form::several || topology.form == Form::blocks;
  Eigen::VectorXcd z = state.head(modal);
  Eigen::VectorXcd memory = Eigen::VectorXcd::Zero(static_cast<Eigen::Index>(layout.memory));
  memory.head(state.size() - modal) = state.tail(state.size() - modal);
  NodeForces<D> out;
  double start_s = 0.0;
  for (std::size_t e = 0; e < point.pieces.size(); ++e) {
    const CollocationCase::Piece& piece = point.pieces[e];
    const PiecePlan& plan = point.plans[piece.plan];
    out.starts.push_back(z);
    Eigen::VectorXcd end(modal);  // the modes alone
    for (Eigen::Index k = 0; k < modal; k += 2) {
      const std::complex<double> turn = plan.factor(k / 2);
      end(k) = turn.real() * z(k) - turn.imag() * z(k + 1);
      end(k + 1) = turn.imag() * z(k) + turn.real() * z(k + 1);
    }
    if (topology.pieces[e].records) {
      Eigen::VectorXcd c = looked_back(point, layout, e, memory);
      for (Eigen::Index i = 0; i < topology.nodes && !forcing_n_per_m.empty(); ++i) {
        c.template segment<D>(D * i) -= forcing_n_per_m[out.force_n.size() + static_cast<std::size_t>(i)];
      }
      const Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(m, m) - factor * piece.coupling;
      const Eigen::PartialPivLU<Eigen::MatrixXd> solver(matrix);
      const Eigen::VectorXcd right = piece.observation * z - c;
      Eigen::VectorXcd g(m);
      g.real() = solver.solve(right.real());
      g.imag() = solver.solve(right.imag());
      end += factor * (piece.influence * g);
      Eigen::VectorXcd left = g + c;
      if (remembers_motion) left = piece.displacement * z + factor * (piece.node_response * g);
      memory.segment(static_cast<Eigen::Index>(layout.record[e]), m) = left;
      const Eigen::VectorXcd force = force_of<D>(point, e, g);
      for (Eigen::Index i = 0; i < topology.nodes; ++i) {
        const std::size_t node = static_cast<std::size_t>(i);
        out.force_n.emplace_back(factor * force.template segment<D>(D * i));
        if (remembers_motion) out.displacement_m.emplace_back(left.template segment<D>(D * i));
        out.time_s.push_back(start_s + plan.time_s[node]);
        out.weight_s.push_back(plan.weight_s[node]);
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
template NodeForces<2> trace<2>(const CollocationCase&, double, const Eigen::VectorXcd&,
                                std::span<const Eigen::Vector2d>);
template NodeForces<3> trace<3>(const CollocationCase&, double, const Eigen::VectorXcd&,
                                std::span<const Eigen::Vector3d>);

template <int D>
typename NodeForces<D>::Vector fourier_coefficient(const NodeForces<D>& forces, double period_s,
                                                   std::complex<double> s) {
  typename NodeForces<D>::Vector sum = NodeForces<D>::Vector::Zero();
  for (std::size_t i = 0; i < forces.time_s.size(); ++i) {
    sum += forces.force_n[i] * (std::exp(-s * forces.time_s[i]) * (forces.weight_s[i] / period_s));
  }
  return sum;
}
template NodeForces<2>::Vector fourier_coefficient<2>(const NodeForces<2>&, double, std::complex<double>);
template NodeForces<3>::Vector fourier_coefficient<3>(const NodeForces<3>&, double, std::complex<double>);

}  // namespace robomill::stability::detail
