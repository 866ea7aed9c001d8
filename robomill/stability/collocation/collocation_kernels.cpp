#include "robomill/stability/collocation/collocation_kernels.hpp"

#include "robomill/stability/eigen/kernel_parts.hpp"

namespace robomill::stability::detail {
namespace {

CORE void build_node_block_core(NodeBlockArguments& a, std::size_t lane) {
  const std::size_t m = a.nodes;
  const std::size_t columns = a.modal + m;
  Lanes* matrix = a.work;
  Lanes* g = matrix + m * m;
  const V depth = L(*a.depth);
  for (std::size_t r = 0; r < m; ++r) {
    for (std::size_t c = 0; c < m; ++c) {
      L(matrix[r * m + c]) = -(depth * L(a.coupling[r * m + c]));
      L(g[r * columns + a.modal + c]) = V{};
    }
    L(matrix[r * m + r]) += 1.0;
    for (std::size_t c = 0; c < a.modal; ++c) L(g[r * columns + c]) = L(a.observation[r * a.modal + c]);
    L(g[r * columns + a.modal + r]) -= 1.0;
  }
  eliminate<V>(m, columns, matrix, g, lane);

  const std::size_t rows = (a.modal + m + 3) / 4 * 4;
  for (std::size_t r = 0; r < rows; ++r) {
    Lanes* to = a.block + in_block(r, 0, columns);
    const bool mode = r < a.modal;
    const bool node = !mode && r < a.modal + m;
    const std::size_t i = mode ? r : r - a.modal;
    for (std::size_t c = 0; c < columns; ++c) {
      V sum = {};
      if (mode) {
        for (std::size_t l = 0; l < m; ++l) sum += L(a.influence[i * m + l]) * L(g[l * columns + c]);
        sum *= depth;
      } else if (node && a.displacement == nullptr) {
        sum = L(g[i * columns + c]);
      } else if (node) {
        for (std::size_t l = 0; l < m; ++l) sum += L(a.node_response[i * m + l]) * L(g[l * columns + c]);
        sum *= depth;
        if (c < a.modal) sum += L(a.displacement[i * a.modal + c]);
      }
      L(to[4 * c]) = sum;
    }
    if (mode) {
      const std::size_t k = r / 2 * 2;
      if (r == k) {
        L(to[4 * k]) += L(a.factor[k]);
        L(to[4 * (k + 1)]) -= L(a.factor[k + 1]);
      } else {
        L(to[4 * k]) += L(a.factor[k + 1]);
        L(to[4 * (k + 1)]) += L(a.factor[k]);
      }
    } else if (node && a.displacement == nullptr) {
      L(to[4 * (a.modal + i)]) += 1.0;
    }
  }
}

/// One channel of what a node looks back to.
CORE void see(const PeriodOfNodes& a, const NodeLook& look, std::size_t channel, V& sum, std::size_t lane) {
  const Lanes* from = a.memory + look.from + channel;
  if (look.exact) {
    sum = L(*from);
    return;
  }
  const Lanes* weight = a.weights + look.weights;
  sum = V{};
  for (std::size_t l = 0; l < a.nodes / a.channels; ++l) sum += L(weight[l]) * L(from[l * a.channels]);
}

/// All that one piece looks back to in another.
CORE void see_block(const PeriodOfNodes& a, const NodeLook& look, Lanes* c, std::size_t lane) {
  const Lanes* from = a.memory + look.from;
  const Lanes* row = a.matrices + look.matrix;
  for (std::size_t i = 0; i < a.nodes; ++i, row += a.nodes) {
    V sum = L(c[i]);
    for (std::size_t l = 0; l < a.nodes; ++l) sum += L(row[l]) * L(from[l]);
    L(c[i]) = sum;
  }
}

CORE void gather(const PeriodOfNodes& a, const NodePiece& piece, Lanes* c, std::size_t lane) {
  using Through = NodeLook::Through;
  for (std::size_t i = 0; i < a.nodes; ++i) L(c[i]) = V{};
  for (std::size_t i = piece.first_look; i < piece.last_look; ++i) {
    const NodeLook& look = a.looks[i];
    if (look.through == Through::block) {
      see_block<V>(a, look, c, lane);
      continue;
    }
    if (look.through == Through::as_is) {
      for (std::size_t channel = 0; channel < a.channels; ++channel) {
        V x;
        see<V>(a, look, channel, x, lane);
        L(c[look.to + channel]) += x;
      }
      continue;
    }
    V x;
    V y;
    see<V>(a, look, 0, x, lane);
    see<V>(a, look, 1, y, lane);
    const Lanes* k = a.matrices + look.matrix;
    L(c[look.to]) += L(k[0]) * x + L(k[1]) * y;
    L(c[look.to + 1]) += L(k[2]) * x + L(k[3]) * y;
  }
}

CORE void run_period_of_nodes_core(PeriodOfNodes& a, std::size_t lane) {
  const std::size_t columns = a.modal + a.nodes;
  Lanes* z = a.state;
  Lanes* next = a.state + (columns + 3) / 4 * 4;
  for (std::size_t k = 0; k < a.modal; ++k) L(z[k]) = L(a.in[k]);
  for (std::size_t e = 0; e < a.carried; ++e) L(a.memory[e]) = L(a.in[a.modal + e]);
  for (std::size_t i = 0; i < a.piece_count; ++i) {
    const NodePiece& piece = a.pieces[i];
    if (piece.coasts) {
      coast<V>(a.modal, a.factors + piece.factor, z, lane);
      continue;
    }
    gather<V>(a, piece, z + a.modal, lane);
    multiply<V>(columns, columns, a.blocks + piece.block, z, next, lane);
    for (std::size_t c = 0; c < a.nodes; ++c) L(a.memory[piece.record + c]) = L(next[a.modal + c]);
    Lanes* swap = z;
    z = next;
    next = swap;
  }
  for (std::size_t k = 0; k < a.modal; ++k) L(a.out[k]) = L(z[k]);
  for (std::size_t e = 0; e < a.carried; ++e) L(a.out[a.modal + e]) = L(a.memory[a.handed[e]]);
}

}  // namespace

ROBOMILL_KERNEL(build_node_block, NodeBlockArguments)
ROBOMILL_KERNEL(run_period_of_nodes, PeriodOfNodes)

}  // namespace robomill::stability::detail
