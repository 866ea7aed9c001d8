#include "robomill/stability/collocation/collocation_map.hpp"

#include <algorithm>

namespace robomill::stability::detail {
namespace {

using Form = MeshTopology::Form;

/// Row by row into one lane, from entry `from` on.
void put(std::vector<Lanes>& to, std::size_t from, std::size_t lane, const Eigen::MatrixXd& matrix) {
  for (Eigen::Index r = 0; r < matrix.rows(); ++r) {
    for (Eigen::Index c = 0; c < matrix.cols(); ++c) to[from++].v[lane] = matrix(r, c);
  }
}

void put_columns(std::vector<Lanes>& to, std::size_t from, std::size_t lane, const Eigen::MatrixXd& matrix) {
  for (Eigen::Index i = 0; i < matrix.size(); ++i) to[from++].v[lane] = matrix.data()[i];
}

}  // namespace

void CollocationMap::prepare(std::size_t modes, std::span<const Point> points) {
  const MeshTopology& topology = points.front().at->mesh.topology;
  if (pieces_.empty() || !(topology == topology_)) {
    topology_ = topology;
    layout_ = NodeLayout(topology, modes);
    lay_out(topology);
  }
  fill(points);
  factor();
}

void CollocationMap::lay_out(const MeshTopology& topology) {
  const std::size_t m = layout_.nodes;
  const std::size_t modal = layout_.modal;
  const std::size_t p = static_cast<std::size_t>(topology.nodes);
  const std::size_t channels = static_cast<std::size_t>(topology.channels());
  const bool several = topology.form == Form::several;
  const bool blocks = topology.form == Form::blocks;
  const bool remembers_motion = several || blocks;
  pieces_.clear();
  looks_.clear();
  std::size_t contacts = 0;
  std::size_t weights = 0;
  std::size_t matrices = 0;
  for (std::size_t e = 0; e < topology.pieces.size(); ++e) {
    NodePiece piece;
    piece.coasts = !topology.pieces[e].records;
    piece.factor = e * modal;
    piece.first_look = looks_.size();
    if (!piece.coasts) {
      piece.block = contacts++;
      piece.record = layout_.record[e];
    }
    for (std::size_t s = 0; s < topology.pieces[e].sources.size(); ++s) {
      const Source& source = topology.pieces[e].sources[s];
      const std::size_t node = s % p;
      NodeLook look;
      look.from = (source.before ? layout_.before : layout_.record)[static_cast<std::size_t>(source.piece)];
      look.exact = source.exact;
      if (blocks) {
        look.through = NodeLook::Through::block;
      } else if (source.exact) {
        look.from += node * channels;
      } else {
        look.weights = weights;
        weights += p;
      }
      if (several) look.through = NodeLook::Through::stiffness;
      look.matrix = matrices;
      matrices += blocks ? m * m : several ? 4 : 0;
      look.to = node * channels;
      looks_.push_back(look);
    }
    piece.last_look = looks_.size();
    pieces_.push_back(piece);
  }
  coupling_.resize(contacts * m * m);
  observation_.resize(contacts * m * modal);
  influence_.resize(contacts * m * modal);
  displacement_.resize(remembers_motion ? contacts * m * modal : 0);
  node_response_.resize(remembers_motion ? contacts * m * m : 0);
  factors_.resize(topology.pieces.size() * modal);
  weights_.resize(weights);
  matrices_.resize(matrices);
  factored_.resize(contacts * m * m);
  blocks_.resize(contacts);
  memory_.resize(layout_.memory);
  state_.resize(2 * modal + 2 * m);
}

void CollocationMap::fill_looks(const CollocationCase& at, std::size_t e, std::size_t lane) {
  const std::size_t p = static_cast<std::size_t>(topology_.nodes);
  const CutMesh::Piece& mesh = at.mesh.pieces[e];
  for (std::size_t i = pieces_[e].first_look; i < pieces_[e].last_look; ++i) {
    const std::size_t s = i - pieces_[e].first_look;
    const NodeLook& look = looks_[i];
    if (look.through == NodeLook::Through::block) {
      put(matrices_, look.matrix, lane, at.pieces[e].delayed[s]);
      continue;
    }
    for (std::size_t l = 0; l < p && !look.exact; ++l) weights_[look.weights + l].v[lane] = mesh.weights[s * p + l];
    if (look.through == NodeLook::Through::stiffness) put(matrices_, look.matrix, lane, mesh.delayed_stiffness[s]);
  }
}

void CollocationMap::fill(std::span<const Point> points) {
  const std::size_t m = layout_.nodes;
  const std::size_t modal = layout_.modal;
  for (std::size_t lane = 0; lane < lane_count; ++lane) {
    const Point& point = points[std::min(lane, points.size() - 1)];
    factor_.v[lane] = point.factor;
    std::size_t contact = 0;
    for (std::size_t e = 0; e < pieces_.size(); ++e) {
      const CollocationCase::Piece& piece = point.at->pieces[e];
      const PiecePlan& plan = point.at->plans[piece.plan];
      for (std::size_t k = 0; k < modal / 2; ++k) {
        factors_[pieces_[e].factor + 2 * k].v[lane] = plan.factor(static_cast<Eigen::Index>(k)).real();
        factors_[pieces_[e].factor + 2 * k + 1].v[lane] = plan.factor(static_cast<Eigen::Index>(k)).imag();
      }
      if (pieces_[e].coasts) continue;
      put_columns(coupling_, contact * m * m, lane, piece.coupling);
      put(observation_, contact * m * modal, lane, piece.observation);
      put(influence_, contact * m * modal, lane, piece.influence);
      if (!displacement_.empty()) {
        put(displacement_, contact * m * modal, lane, piece.displacement);
        put(node_response_, contact * m * m, lane, piece.node_response);
      }
      ++contact;
      fill_looks(*point.at, e, lane);
    }
  }
}

void CollocationMap::factor() {
  const std::size_t m = layout_.nodes;
  const std::size_t modal = layout_.modal;
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    FactorArguments a;
    a.nodes = m;
    a.factor = &factor_;
    a.coupling = coupling_.data() + i * m * m;
    a.factored = factored_.data() + i * m * m;
    factor_node_block(a);
    blocks_[i] = {.factored = a.factored,
                  .observation = observation_.data() + i * m * modal,
                  .influence = influence_.data() + i * m * modal};
    if (displacement_.empty()) continue;
    blocks_[i].displacement = displacement_.data() + i * m * modal;
    blocks_[i].node_response = node_response_.data() + i * m * m;
  }
}

void CollocationMap::apply(const Lanes* in, Lanes* out) {
  PeriodOfNodes a;
  a.modal = layout_.modal;
  a.nodes = layout_.nodes;
  a.channels = static_cast<std::size_t>(topology_.channels());
  a.pieces = pieces_.data();
  a.piece_count = pieces_.size();
  a.looks = looks_.data();
  a.weights = weights_.data();
  a.matrices = matrices_.data();
  a.factors = factors_.data();
  a.factor = &factor_;
  a.blocks = blocks_.data();
  a.memory = memory_.data();
  a.carried = layout_.handed.size();
  a.handed = layout_.handed.data();
  a.state = state_.data();
  a.in = in;
  a.out = out;
  run_period_of_nodes(a);
}

}  // namespace robomill::stability::detail
