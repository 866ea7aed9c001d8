#include "robomill/stability/collocation/eigen_motion.hpp"

#include <Eigen/LU>
#include <algorithm>

#include "robomill/base/linear_algebra.hpp"

namespace robomill::stability::detail {
namespace {

using Complex = std::complex<double>;
using Form = MeshTopology::Form;

/// E of a piece.
Eigen::MatrixXd free_motion(const PiecePlan& plan) {
  const Eigen::Index n = plan.factor.size();
  Eigen::MatrixXd e = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const Complex turn = plan.factor(k);
    e.block<2, 2>(2 * k, 2 * k) << turn.real(), -turn.imag(), turn.imag(), turn.real();
  }
  return e;
}

/// f of u: the force per factor at each node.
Eigen::VectorXcd force_of_seen(const CollocationCase& at, std::size_t e, const Eigen::VectorXcd& u) {
  const MeshTopology& topology = at.mesh.topology;
  const CutMesh::Piece& mesh = at.mesh.pieces[e];
  if (topology.directions == 3) return at.pieces[e].stiffness * u;
  Eigen::VectorXcd force(2 * topology.nodes);
  for (Eigen::Index i = 0; i < topology.nodes; ++i) {
    const std::size_t node = static_cast<std::size_t>(i);
    if (topology.form == Form::chip) {
      force.segment<2>(2 * i) = mesh.push[node] * u(i);
    } else {
      force.segment<2>(2 * i) = mesh.stiffness[node] * u.segment<2>(2 * i);
    }
  }
  return force;
}

/// A row over u as one over the displacements q that u is made of.
Eigen::VectorXcd over_displacements(const CollocationCase& at, std::size_t e, const Eigen::VectorXcd& row) {
  if (at.mesh.topology.form != Form::chip) return row;
  Eigen::VectorXcd out(2 * row.size());
  for (Eigen::Index i = 0; i < row.size(); ++i) {
    out.segment<2>(2 * i) = at.mesh.pieces[e].chip[static_cast<std::size_t>(i)] * row(i);
  }
  return out;
}

/// What one piece does to the modes, and the solver of its nodes.
struct PieceMap {
  Eigen::MatrixXcd whole;  ///< P, 2n x 2n
  Eigen::PartialPivLU<Eigen::MatrixXcd> nodes;
};

std::vector<PieceMap> piece_maps(const CollocationCase& at, Complex strength) {
  std::vector<PieceMap> maps(at.pieces.size());
  for (std::size_t e = 0; e < at.pieces.size(); ++e) {
    const CollocationCase::Piece& piece = at.pieces[e];
    maps[e].whole = free_motion(at.plans[piece.plan]).cast<Complex>();
    if (!at.mesh.topology.pieces[e].records) continue;
    const Eigen::Index m = piece.coupling.rows();
    maps[e].nodes.compute(Eigen::MatrixXcd::Identity(m, m) - strength * piece.coupling);
    maps[e].whole += strength * (piece.influence * maps[e].nodes.solve(piece.observation.cast<Complex>()).eval());
  }
  return maps;
}

/// Null vector of a matrix that is all but singular, from a start that is no accident.
Eigen::VectorXcd null_vector(const Eigen::MatrixXcd& matrix) {
  const Eigen::PartialPivLU<Eigen::MatrixXcd> solver(matrix);
  Eigen::VectorXcd x(matrix.cols());
  for (Eigen::Index i = 0; i < x.size(); ++i) x(i) = Complex(1.0 + 0.37 * static_cast<double>(i % 3), 0.21);
  for (int i = 0; i < 3; ++i) x = solver.solve(x.normalized()).eval();
  return x.normalized();
}

}  // namespace

bool looks_back_a_period(const MeshTopology& topology) {
  if (topology.form != Form::chip && topology.form != Form::whole) return false;
  for (std::size_t e = 0; e < topology.pieces.size(); ++e) {
    if (topology.pieces[e].groups > 1) return false;
    for (const Source& source : topology.pieces[e].sources) {
      if (!source.before || !source.exact || source.piece != static_cast<int>(e)) return false;
    }
  }
  return true;
}

double radius_without_delay(const CollocationCase& at, double factor) {
  const Eigen::Index size = 2 * at.plans.front().factor.size();
  Eigen::MatrixXd whole = Eigen::MatrixXd::Identity(size, size);
  for (std::size_t e = 0; e < at.pieces.size(); ++e) {
    const CollocationCase::Piece& piece = at.pieces[e];
    Eigen::MatrixXd map = free_motion(at.plans[piece.plan]);
    if (at.mesh.topology.pieces[e].records) {
      const Eigen::Index m = piece.coupling.rows();
      const Eigen::MatrixXd nodes = Eigen::MatrixXd::Identity(m, m) - factor * piece.coupling;
      map += factor * (piece.influence * linear_algebra::solve(nodes, piece.observation));
    }
    whole = (map * whole).eval();
  }
  if (!whole.allFinite()) return 1e100;
  return std::min(1e100, linear_algebra::eigenvalues(whole).cwiseAbs().maxCoeff());
}

EigenMotion eigen_motion(const CollocationCase& at, double factor, Complex multiplier) {
  EigenMotion out;
  out.multiplier = multiplier;
  out.factor = factor;
  out.nu = 1.0 - 1.0 / multiplier;
  const Complex strength = factor * out.nu;
  const std::vector<PieceMap> maps = piece_maps(at, strength);
  const Eigen::Index size = 2 * at.plans.front().factor.size();
  Eigen::MatrixXcd whole = Eigen::MatrixXcd::Identity(size, size);
  for (const PieceMap& map : maps) whole = (map.whole * whole).eval();
  const Eigen::MatrixXcd singular = whole - multiplier * Eigen::MatrixXcd::Identity(size, size);
  Eigen::VectorXcd z = null_vector(singular);
  const Eigen::VectorXcd y_end = null_vector(singular.transpose());
  const Complex overlap = (y_end.transpose() * z).value();
  Eigen::VectorXcd y = y_end;
  out.pieces.resize(maps.size());
  for (std::size_t e = maps.size(); e-- > 0;) {
    out.pieces[e].costate = y;
    y = (maps[e].whole.transpose() * y).eval();
  }
  for (std::size_t e = 0; e < maps.size(); ++e) {
    EigenMotion::Piece& piece = out.pieces[e];
    piece.start = z;
    z = (maps[e].whole * z).eval();
    if (!at.mesh.topology.pieces[e].records) continue;
    const CollocationCase::Piece& matrices = at.pieces[e];
    const Eigen::VectorXcd u = maps[e].nodes.solve(matrices.observation * piece.start);
    const Eigen::VectorXcd row = maps[e].nodes.transpose().solve(matrices.influence.transpose() * piece.costate);
    piece.force = force_of_seen(at, e, u);
    piece.seen = over_displacements(at, e, row);
    // yᵀ W (I + a ν X R) u = yᵀ W X u.
    out.by_factor += (row.transpose() * u).value();
  }
  out.scale = overlap - factor * out.by_factor / (multiplier * multiplier);
  return out;
}

}  // namespace robomill::stability::detail
