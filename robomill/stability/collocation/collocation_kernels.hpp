#pragma once
#include <cstddef>

#include "robomill/base/lanes.hpp"

/// The inner loops of collocation: plain arrays of Lanes, nothing allocated. Matrices are row by row, m is the number
/// of nodes times that of channels, modal is 2n.
namespace robomill::stability::detail {

/// One piece with contact maps the modes z at its start and what it looks back to, c, to the modes at its end and to
/// what is remembered of its nodes, u:
///   (1 - a R) g = O z - c,  z' = E z + a W g,  u = g + c, or u = D z + a C g where `displacement` is given.
/// Entry: Lanes, or double where all lanes have the same matrices.
template <class Entry>
struct NodeBlock {
  const Lanes* factored = nullptr;       ///< 1 - a R in its triangular factors, m x m, column by column
  const Entry* observation = nullptr;    ///< O, m x 2n
  const Entry* influence = nullptr;      ///< W, 2n x m
  const Entry* displacement = nullptr;   ///< D, m x 2n, or nullptr
  const Entry* node_response = nullptr;  ///< C, m x m
};

struct FactorArguments {
  std::size_t nodes = 0;            ///< m
  const Lanes* factor = nullptr;    ///< a
  const Lanes* coupling = nullptr;  ///< R, m x m, column by column
  Lanes* factored = nullptr;        ///< out: m x m
};
/// Triangular factors of 1 - a R without pivots, for pieces so short that it is near enough to 1; the upper one's
/// diagonal is stored inverted.
void factor_node_block(FactorArguments& a);

/// What a node takes of one earlier surface: from memory, matrix times weights times what a piece remembers.
struct NodeLook {
  /// as_is: what is remembered itself; stiffness: a 2 x 2 matrix times that; block: all nodes of a piece at once, by an
  /// m x m matrix.
  enum class Through { as_is, stiffness, block };
  std::size_t from = 0;     ///< entry of memory: of the node where `exact`, else of the piece's first
  bool exact = true;        ///< else weights are
  std::size_t weights = 0;  ///< entry of PeriodOfNodes::weights, one a node of the piece
  Through through = Through::as_is;
  std::size_t matrix = 0;  ///< entry of PeriodOfNodes::matrices
  std::size_t to = 0;      ///< entry of c
};

struct NodePiece {
  bool coasts = false;
  std::size_t factor = 0;  ///< of a coast: entry of factors, 2n
  std::size_t block = 0;   ///< entry of blocks, where it cuts
  std::size_t record = 0;  ///< entry of memory that u goes to, m
  std::size_t first_look = 0, last_look = 0;
};

struct PeriodOfNodes {
  std::size_t modal = 0, nodes = 0, channels = 0;  ///< 2n, m, m / p
  const NodePiece* pieces = nullptr;
  std::size_t piece_count = 0;
  const NodeLook* looks = nullptr;
  const Lanes* weights = nullptr;
  const Lanes* matrices = nullptr;
  const Lanes* factors = nullptr;
  const Lanes* factor = nullptr;                     ///< a
  const NodeBlock<Lanes>* blocks = nullptr;          ///< or nullptr where
  const NodeBlock<double>* shared_blocks = nullptr;  ///< are given
  Lanes* memory = nullptr;
  std::size_t carried = 0;              ///< first entries of memory: what comes from the period before
  const std::size_t* handed = nullptr;  ///< length carried: entries of memory that go to the next
  Lanes* state = nullptr;               ///< 4n + 2m
  const Lanes* in = nullptr;            ///< 2n + carried
  Lanes* out = nullptr;
};
void run_period_of_nodes(PeriodOfNodes& a);

}  // namespace robomill::stability::detail
