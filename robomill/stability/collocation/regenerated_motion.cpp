#include "robomill/stability/collocation/regenerated_motion.hpp"

#include <algorithm>
#include <complex>
#include <limits>

#include "robomill/stability/collocation/collocation_map.hpp"
#include "robomill/stability/collocation/mesh/contacts.hpp"
#include "robomill/stability/gauss.hpp"

namespace robomill::stability::detail {
namespace {

constexpr double solved = 1e-9;      // of ‖p‖: where the iteration ends
constexpr double acceptable = 1e-6;  // and what it must at least reach

/// The force per node that the steady motion makes by regeneration: K (q_s - q_s(t - τ)), projected as all forces are.
std::vector<Eigen::Vector3d> pushes(const CollocationCase& at, const std::function<Eigen::Vector3d(double)>& steady) {
  const MeshTopology& topology = at.mesh.topology;
  const GaussRule& rule = gauss_rule(topology.nodes);
  std::vector<Eigen::VectorXd> seen(at.pieces.size());
  for (std::size_t e = 0; e < at.pieces.size(); ++e) {
    if (!topology.pieces[e].records) continue;
    seen[e].resize(3 * topology.nodes);
    for (Eigen::Index i = 0; i < topology.nodes; ++i) {
      const CutMesh::Piece& piece = at.mesh.pieces[e];
      seen[e].segment<3>(3 * i) = steady(piece.from_rad + rule.node[static_cast<std::size_t>(i)] * piece.length_rad);
    }
  }
  std::vector<Eigen::Vector3d> forces;
  for (std::size_t e = 0; e < at.pieces.size(); ++e) {
    if (!topology.pieces[e].records) continue;
    Eigen::VectorXd force = at.pieces[e].stiffness * seen[e];
    for (std::size_t s = 0; s < topology.pieces[e].sources.size(); ++s) {
      force -= at.pieces[e].delayed[s] * seen[static_cast<std::size_t>(topology.pieces[e].sources[s].piece)];
    }
    for (Eigen::Index i = 0; i < topology.nodes; ++i) forces.emplace_back(force.segment<3>(3 * i));
  }
  return forces;
}

/// x = Φ x + p by directions whose images are orthogonal: each makes the residual least. Φ fades all but a few motions
/// within a period, so that few directions do.
class Orbit {
 public:
  Orbit(const CollocationCase& at, std::size_t modes) {
    const CollocationMap::Point point{&at, 1.0};
    map_.prepare(modes, {&point, 1});
    in_.resize(map_.size());
    out_.resize(map_.size());
  }

  Eigen::VectorXd solve(const Eigen::VectorXd& p, double& residual) {
    const double size = p.norm();
    Eigen::VectorXd x = Eigen::VectorXd::Zero(p.size());
    Eigen::VectorXd left = p;
    residual = 0.0;
    if (!(size > 0.0)) return x;
    std::vector<Eigen::VectorXd> ways;
    std::vector<Eigen::VectorXd> images;
    while (static_cast<Eigen::Index>(ways.size()) < p.size() && left.norm() > solved * size) {
      Eigen::VectorXd way = left;
      Eigen::VectorXd image = way - period(way);
      for (int pass = 0; pass < 2; ++pass) {
        for (std::size_t k = 0; k < ways.size(); ++k) {
          const double share = images[k].dot(image);
          image -= share * images[k];
          way -= share * ways[k];
        }
      }
      const double length = image.norm();
      if (!(length > 1e-300)) break;
      images.emplace_back(image / length);
      ways.emplace_back(way / length);
      const double step = images.back().dot(left);
      x += step * ways.back();
      left -= step * images.back();
      if (!left.allFinite()) break;
    }
    residual = (p - x + period(x)).norm() / size;
    return x;
  }

 private:
  Eigen::VectorXd period(const Eigen::VectorXd& x) {
    for (std::size_t i = 0; i < in_.size(); ++i) std::ranges::fill(in_[i].v, x(static_cast<Eigen::Index>(i)));
    map_.apply(in_.data(), out_.data());
    Eigen::VectorXd y(x.size());
    for (std::size_t i = 0; i < out_.size(); ++i) y(static_cast<Eigen::Index>(i)) = out_[i].v[0];
    return y;
  }

  CollocationMap map_;
  std::vector<Lanes> in_, out_;
};

}  // namespace

RegeneratedMotion::RegeneratedMotion(const CollocationCase& at, const TipDynamicsIn<3>& tip,
                                     const std::function<Eigen::Vector3d(double)>& steady)
    : case_(at), tip_(tip) {
  const std::vector<Eigen::Vector3d> forces = pushes(at, steady);
  const std::size_t modes = static_cast<std::size_t>(tip.pole.size());
  Orbit orbit(at, modes);
  const NodeLayout layout(at.mesh.topology, modes);
  const Eigen::VectorXcd rest = Eigen::VectorXcd::Zero(static_cast<Eigen::Index>(layout.size()));
  const Eigen::VectorXd start = orbit.solve(trace<3>(at, 1.0, rest, forces).end.real(), residual_);
  const NodeForces<3> run = trace<3>(at, 1.0, start.cast<std::complex<double>>(), forces);
  const std::vector<double>& nodes = gauss_rule(at.mesh.topology.nodes).node;
  places_ = nodes;
  places_.insert(places_.begin(), 0.0);
  places_.push_back(1.0);
  starts_ = run.starts;
  starts_.emplace_back(run.end.head(2 * tip.pole.size()));
  recorded_.resize(at.pieces.size());
  std::size_t first = 0;
  for (std::size_t e = 0; e < at.pieces.size(); ++e) {
    if (!at.mesh.topology.pieces[e].records) continue;
    const Eigen::Index last = static_cast<Eigen::Index>(nodes.size()) + 1;
    recorded_[e].resize(3, last + 1);
    recorded_[e].col(0) = of_modes(starts_[e], 0.0);
    recorded_[e].col(last) = of_modes(starts_[e + 1], 0.0);
    for (std::size_t i = 0; i < nodes.size(); ++i, ++first) {
      recorded_[e].col(static_cast<Eigen::Index>(i) + 1) = run.displacement_m[first].real();
      const Eigen::Vector3d pushed = tip.compliance * run.force_n[first].real();
      recorded_[e].col(0) += lagrange(nodes, i, 0.0) * pushed;
      recorded_[e].col(last) += lagrange(nodes, i, 1.0) * pushed;
    }
  }
}

Eigen::Vector3d RegeneratedMotion::of_modes(const Eigen::VectorXcd& state, double time_s) const {
  Eigen::Vector3d r = Eigen::Vector3d::Zero();
  for (Eigen::Index k = 0; k < tip_.pole.size(); ++k) {
    const std::complex<double> here(state(2 * k).real(), state(2 * k + 1).real());
    r += 2.0 * (tip_.right.col(k) * (here * std::exp(tip_.pole(k) * time_s))).real();
  }
  return r;
}

Eigen::Vector3d RegeneratedMotion::at(double rotation_rad) const {
  const std::vector<CutMesh::Piece>& pieces = case_.mesh.pieces;
  if (!(residual_ <= acceptable)) return Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  const double start = pieces.front().from_rad;
  const double angle = start + wrap(rotation_rad - start, case_.mesh.period_rad);
  const auto after =
      std::ranges::upper_bound(pieces, angle, {}, [](const CutMesh::Piece& piece) { return piece.from_rad; });
  const std::size_t e = after == pieces.begin() ? 0 : static_cast<std::size_t>(after - pieces.begin()) - 1;
  if (recorded_[e].size() == 0)
    return of_modes(starts_[e], (angle - pieces[e].from_rad) / case_.spindle_speed_rad_per_s);
  const double share = (angle - pieces[e].from_rad) / pieces[e].length_rad;
  Eigen::Vector3d r = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < places_.size(); ++i) {
    r += lagrange(places_, i, share) * recorded_[e].col(static_cast<Eigen::Index>(i));
  }
  return r;
}

}  // namespace robomill::stability::detail
