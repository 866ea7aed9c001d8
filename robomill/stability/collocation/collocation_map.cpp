#include "robomill/stability/collocation/collocation_map.hpp"

#include <algorithm>

#include "robomill/stability/gauss.hpp"

namespace robomill::stability::detail {
namespace {

using Form = MeshTopology::Form;

void set(Lanes& entry, LaneRange lanes, double value) {
  for (std::size_t lane = lanes.first; lane < lanes.end; ++lane) entry.v[lane] = value;
}
void set(double& entry, LaneRange, double value) {
  entry = value;
}

/// Row by row, from entry `from` on.
template <class Entry>
void put(std::vector<Entry>& to, std::size_t from, LaneRange lanes, const Eigen::MatrixXd& matrix) {
  for (Eigen::Index r = 0; r < matrix.rows(); ++r) {
    for (Eigen::Index c = 0; c < matrix.cols(); ++c) set(to[from++], lanes, matrix(r, c));
  }
}

void put_columns(std::vector<Lanes>& to, std::size_t from, LaneRange lanes, const Eigen::MatrixXd& matrix) {
  for (Eigen::Index i = 0; i < matrix.size(); ++i) set(to[from++], lanes, matrix.data()[i]);
}

}  // namespace

template <class Entry>
void CollocationMap::Matrices<Entry>::resize(std::size_t contacts, std::size_t m, std::size_t modal,
                                             bool remembers_motion) {
  observation.resize(contacts * m * modal);
  influence.resize(contacts * m * modal);
  displacement.resize(remembers_motion ? contacts * m * modal : 0);
  node_response.resize(remembers_motion ? contacts * m * m : 0);
  blocks.resize(contacts);
}

template <class Entry>
void CollocationMap::Matrices<Entry>::fill(std::size_t contact, LaneRange lanes, std::size_t m,
                                           const CollocationCase::Piece& piece) {
  const std::size_t size = static_cast<std::size_t>(piece.observation.size());
  put(observation, contact * size, lanes, piece.observation);
  put(influence, contact * size, lanes, piece.influence);
  if (displacement.empty()) return;
  put(displacement, contact * size, lanes, piece.displacement);
  put(node_response, contact * m * m, lanes, piece.node_response);
}

template <class Entry>
void CollocationMap::Matrices<Entry>::set_blocks(const Lanes* factored, std::size_t m, std::size_t modal) {
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    blocks[i] = {.factored = factored + i * m * m,
                 .observation = observation.data() + i * m * modal,
                 .influence = influence.data() + i * m * modal};
    if (displacement.empty()) continue;
    blocks[i].displacement = displacement.data() + i * m * modal;
    blocks[i].node_response = node_response.data() + i * m * m;
  }
}

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
  pieces_.clear();
  looks_.clear();
  contacts_ = 0;
  std::size_t weights = 0;
  std::size_t matrices = 0;
  for (std::size_t e = 0; e < topology.pieces.size(); ++e) {
    NodePiece piece;
    piece.coasts = !topology.pieces[e].records;
    piece.factor = e * modal;
    piece.first_look = looks_.size();
    if (!piece.coasts) {
      piece.block = contacts_++;
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
  coupling_.resize(contacts_ * m * m);
  factors_.resize(topology.pieces.size() * modal);
  weights_.resize(weights);
  matrices_.resize(matrices);
  factored_.resize(contacts_ * m * m);
  memory_.resize(layout_.memory);
  state_.resize(2 * modal + 2 * m);
}

void CollocationMap::fill_looks(const CollocationCase& at, std::size_t e, LaneRange lanes) {
  const std::size_t p = static_cast<std::size_t>(topology_.nodes);
  const CutMesh::Piece& mesh = at.mesh.pieces[e];
  for (std::size_t i = pieces_[e].first_look; i < pieces_[e].last_look; ++i) {
    const std::size_t s = i - pieces_[e].first_look;
    const NodeLook& look = looks_[i];
    if (look.through == NodeLook::Through::block) {
      put(matrices_, look.matrix, lanes, at.pieces[e].delayed[s]);
      continue;
    }
    for (std::size_t l = 0; l < p && !look.exact; ++l) set(weights_[look.weights + l], lanes, mesh.weights[s * p + l]);
    if (look.through == NodeLook::Through::stiffness) put(matrices_, look.matrix, lanes, mesh.delayed_stiffness[s]);
  }
}

void CollocationMap::fill(std::span<const Point> points) {
  shared_ = std::ranges::all_of(points, [&](const Point& point) { return point.at == points.front().at; });
  if (shared_) {
    common_.resize(contacts_, layout_.nodes, layout_.modal, remembers_motion());
  } else {
    own_.resize(contacts_, layout_.nodes, layout_.modal, remembers_motion());
  }
  for (std::size_t lane = 0; lane < points.size(); ++lane) {
    const LaneRange lanes = {lane, lane + 1 == points.size() ? lane_count : lane + 1};
    set(factor_, lanes, points[lane].factor);
    fill(points[lane], lanes);
  }
}

void CollocationMap::fill(const Point& point, LaneRange lanes) {
  const std::size_t m = layout_.nodes;
  for (std::size_t e = 0; e < pieces_.size(); ++e) {
    const CollocationCase::Piece& piece = point.at->pieces[e];
    const PiecePlan& plan = point.at->plans[piece.plan];
    for (std::size_t k = 0; k < layout_.modal / 2; ++k) {
      set(factors_[pieces_[e].factor + 2 * k], lanes, plan.factor(static_cast<Eigen::Index>(k)).real());
      set(factors_[pieces_[e].factor + 2 * k + 1], lanes, plan.factor(static_cast<Eigen::Index>(k)).imag());
    }
    if (pieces_[e].coasts) continue;
    const std::size_t contact = pieces_[e].block;
    put_columns(coupling_, contact * m * m, lanes, piece.coupling);
    fill_looks(*point.at, e, lanes);
    if (!shared_) {
      own_.fill(contact, lanes, m, piece);
    } else if (lanes.first == 0) {
      common_.fill(contact, lanes, m, piece);
    }
  }
}

void CollocationMap::factor() {
  const std::size_t m = layout_.nodes;
  for (std::size_t i = 0; i < contacts_; ++i) {
    FactorArguments a;
    a.nodes = m;
    a.factor = &factor_;
    a.coupling = coupling_.data() + i * m * m;
    a.factored = factored_.data() + i * m * m;
    factor_node_block(a);
  }
  if (shared_) {
    common_.set_blocks(factored_.data(), m, layout_.modal);
  } else {
    own_.set_blocks(factored_.data(), m, layout_.modal);
  }
}

double CollocationMap::work() const {
  const double m = static_cast<double>(layout_.nodes);
  const double modal = static_cast<double>(layout_.modal);
  const double remembered = remembers_motion() ? m * (m + modal) : 0.0;
  double sum = 2.0 * modal * static_cast<double>(pieces_.size());
  sum += static_cast<double>(contacts_) * (m * m + 2.0 * m * modal + remembered);
  if (topology_.form == Form::blocks) sum += m * m * static_cast<double>(looks_.size());
  return sum;
}

void CollocationMap::take_over(const Eigen::VectorXd& coarse, int nodes, std::size_t lane, std::span<Lanes> out) const {
  const std::size_t modal = layout_.modal;
  const std::size_t channels = static_cast<std::size_t>(topology_.channels());
  const std::size_t p = static_cast<std::size_t>(topology_.nodes);
  const std::size_t before = static_cast<std::size_t>(nodes);  // nodes there
  const std::size_t blocks = (layout_.size() - modal) / layout_.nodes;
  const std::size_t known = (static_cast<std::size_t>(coarse.size()) - modal) / (before * channels);
  const auto at = [&](std::size_t i) { return coarse(static_cast<Eigen::Index>(i)); };
  for (std::size_t k = 0; k < modal; ++k) out[k].v[lane] = at(k);
  const bool fits = known > 0 && blocks % known == 0;
  for (std::size_t i = modal; i < layout_.size() && !fits; ++i) out[i].v[lane] = 0.0;
  if (!fits) return;
  const std::size_t parts = blocks / known;
  const std::vector<double>& there = gauss_rule(nodes).node;
  const std::vector<double>& here = gauss_rule(topology_.nodes).node;
  for (std::size_t b = 0; b < blocks; ++b) {
    for (std::size_t i = 0; i < p; ++i) {
      const double x = (static_cast<double>(b % parts) + here[i]) / static_cast<double>(parts);
      Lanes* to = out.data() + modal + (b * p + i) * channels;
      for (std::size_t c = 0; c < channels; ++c) to[c].v[lane] = 0.0;
      for (std::size_t l = 0; l < before; ++l) {
        const double weight = lagrange(there, l, x);
        const std::size_t from = modal + (b / parts * before + l) * channels;
        for (std::size_t c = 0; c < channels; ++c) to[c].v[lane] += weight * at(from + c);
      }
    }
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
  if (shared_) {
    a.shared_blocks = common_.blocks.data();
  } else {
    a.blocks = own_.blocks.data();
  }
  a.memory = memory_.data();
  a.carried = layout_.handed.size();
  a.handed = layout_.handed.data();
  a.state = state_.data();
  a.in = in;
  a.out = out;
  run_period_of_nodes(a);
}

}  // namespace robomill::stability::detail
