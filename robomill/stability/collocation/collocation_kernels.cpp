#include "robomill/stability/collocation/collocation_kernels.hpp"

#include "robomill/stability/eigen/kernel_parts.hpp"

namespace robomill::stability::detail {
namespace {

CORE void factor_node_block_core(FactorArguments& a, std::size_t lane) {
  const std::size_t m = a.nodes;
  const V factor = L(*a.factor);
  Lanes* matrix = a.factored;
  for (std::size_t c = 0; c < m; ++c) {
    for (std::size_t r = 0; r < m; ++r) L(matrix[c * m + r]) = -(factor * L(a.coupling[c * m + r]));
    L(matrix[c * m + c]) += 1.0;
  }
  for (std::size_t k = 0; k < m; ++k) {
    Lanes* pivot = matrix + k * m;
    const V inverse = 1.0 / L(pivot[k]);
    L(pivot[k]) = inverse;
    for (std::size_t r = k + 1; r < m; ++r) L(pivot[r]) *= inverse;
    for (std::size_t c = k + 1; c < m; ++c) {
      Lanes* column = matrix + c * m;
      const V top = L(column[k]);
      for (std::size_t r = k + 1; r < m; ++r) L(column[r]) -= L(pivot[r]) * top;
    }
  }
}

/// x <- what the factors' matrix makes of it, column by column.
CORE void solve(std::size_t m, const Lanes* factored, Lanes* x, std::size_t lane) {
  for (std::size_t k = 0; k < m; ++k) {
    const Lanes* column = factored + k * m;
    const V top = L(x[k]);
    for (std::size_t r = k + 1; r < m; ++r) L(x[r]) -= L(column[r]) * top;
  }
  for (std::size_t k = m; k-- > 0;) {
    const Lanes* column = factored + k * m;
    const V value = L(x[k]) * L(column[k]);
    L(x[k]) = value;
    for (std::size_t r = 0; r < k; ++r) L(x[r]) -= L(column[r]) * value;
  }
}

/// What a matrix has for the lanes at hand.
CORE const V& entry(const Lanes& of, std::size_t lane) {
  return L(of);
}
CORE double entry(const double& of, std::size_t) {
  return of;
}
#define E(operand) entry<V>(operand, lane)

/// out = matrix in, row by row, four rows at a time.
template <class V, class Entry>
__attribute__((always_inline)) inline void multiply_rows(std::size_t rows, std::size_t columns, const Entry* matrix,
                                                         const Lanes* in, Lanes* out, std::size_t lane) {
  std::size_t r = 0;
  for (; r + 4 <= rows; r += 4, matrix += 4 * columns) {
    V sum0 = {}, sum1 = {}, sum2 = {}, sum3 = {};
    for (std::size_t c = 0; c < columns; ++c) {
      const V x = L(in[c]);
      sum0 += E(matrix[c]) * x;
      sum1 += E(matrix[columns + c]) * x;
      sum2 += E(matrix[2 * columns + c]) * x;
      sum3 += E(matrix[3 * columns + c]) * x;
    }
    L(out[r]) = sum0;
    L(out[r + 1]) = sum1;
    L(out[r + 2]) = sum2;
    L(out[r + 3]) = sum3;
  }
  for (; r < rows; ++r, matrix += columns) {
    V sum = {};
    for (std::size_t c = 0; c < columns; ++c) sum += E(matrix[c]) * L(in[c]);
    L(out[r]) = sum;
  }
}

/// z and, in the place of c, u.
template <class V, class Entry>
__attribute__((always_inline)) inline void pass_block(const PeriodOfNodes& a, const NodePiece& piece,
                                                      const NodeBlock<Entry>& block, Lanes* z, Lanes* c,
                                                      std::size_t lane) {
  const std::size_t m = a.nodes;
  const V factor = L(*a.factor);
  Lanes* g = c + m;
  Lanes* moved = g + m;
  multiply_rows<V, Entry>(m, a.modal, block.observation, z, g, lane);
  for (std::size_t i = 0; i < m; ++i) L(g[i]) -= L(c[i]);
  solve<V>(m, block.factored, g, lane);
  if (block.displacement == nullptr) {
    for (std::size_t i = 0; i < m; ++i) L(c[i]) += L(g[i]);
  } else {
    multiply_rows<V, Entry>(m, m, block.node_response, g, c, lane);
    for (std::size_t i = 0; i < m; ++i) {
      V sum = L(c[i]) * factor;
      const Entry* row = block.displacement + i * a.modal;
      for (std::size_t k = 0; k < a.modal; ++k) sum += E(row[k]) * L(z[k]);
      L(c[i]) = sum;
    }
  }
  multiply_rows<V, Entry>(a.modal, m, block.influence, g, moved, lane);
  coast<V>(a.modal, a.factors + piece.factor, z, lane);
  for (std::size_t k = 0; k < a.modal; ++k) L(z[k]) += factor * L(moved[k]);
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
  Lanes* z = a.state;
  Lanes* c = a.state + a.modal;
  for (std::size_t k = 0; k < a.modal; ++k) L(z[k]) = L(a.in[k]);
  for (std::size_t e = 0; e < a.carried; ++e) L(a.memory[e]) = L(a.in[a.modal + e]);
  for (std::size_t i = 0; i < a.piece_count; ++i) {
    const NodePiece& piece = a.pieces[i];
    if (piece.coasts) {
      coast<V>(a.modal, a.factors + piece.factor, z, lane);
      continue;
    }
    gather<V>(a, piece, c, lane);
    if (a.shared_blocks != nullptr) {
      pass_block<V>(a, piece, a.shared_blocks[piece.block], z, c, lane);
    } else {
      pass_block<V>(a, piece, a.blocks[piece.block], z, c, lane);
    }
    for (std::size_t n = 0; n < a.nodes; ++n) L(a.memory[piece.record + n]) = L(c[n]);
  }
  for (std::size_t k = 0; k < a.modal; ++k) L(a.out[k]) = L(z[k]);
  for (std::size_t e = 0; e < a.carried; ++e) L(a.out[a.modal + e]) = L(a.memory[a.handed[e]]);
}

}  // namespace

ROBOMILL_KERNEL(factor_node_block, FactorArguments)
ROBOMILL_KERNEL(run_period_of_nodes, PeriodOfNodes)

}  // namespace robomill::stability::detail
