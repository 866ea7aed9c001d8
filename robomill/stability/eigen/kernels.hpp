#pragma once
#include <cstddef>

#include "robomill/base/lanes.hpp"

/// The inner loops: plain arrays of Lanes, nothing allocated. Matrices are row by row.
namespace robomill::stability::detail {

/// z' = E z + W f over one step that cuts, with forces f_j = K q_j - c at p Gauss points and q = V z + G f:
/// finds the block [P, Γ] of z' = P z - Γ c. Twice the block for each halving: P <- P P, Γ <- P Γ + Γ.
struct BlockArguments {
  std::size_t modal = 0;  ///< 2n
  std::size_t nodes = 0;  ///< 2p
  int halvings = 0;
  const Lanes* substep = nullptr;    ///< E: real and imaginary part for each mode
  const Lanes* at_nodes = nullptr;   ///< V, 2p x 2n
  const Lanes* response = nullptr;   ///< G, 2p x 2p
  const Lanes* influence = nullptr;  ///< W, 2n x 2p
  const Lanes* stiffness = nullptr;  ///< K, 2 x 2
  Lanes* work = nullptr;             ///< block_work(modal, nodes)
  Lanes* block = nullptr;            ///< block_size(modal): [row / 4][column of 2n + 2][row % 4]
};
[[nodiscard]] constexpr std::size_t block_size(std::size_t modal) {
  return (modal + 3) / 4 * 4 * (modal + 2);
}
[[nodiscard]] constexpr std::size_t block_work(std::size_t modal, std::size_t nodes) {
  return nodes * nodes + nodes * (modal + 2) + 2 * modal * (modal + 2);
}
void build_block(BlockArguments& a);

/// Displacement one delay ago: matrix times what memory holds in entry.
struct Reference {
  std::size_t entry = 0;
  std::size_t delay = 0;
  double weight = 0.0;
  Lanes matrix[4] = {};  ///< weight (I - K S)^-1 K_g [N/m]
};

/// One step that cuts, or several that do not.
struct Step {
  int number = 0;         ///< of its first time step
  int coast = 0;          ///< how many time steps without contact; 0: one that cuts
  std::size_t index = 0;  ///< among the cuts, or among the lengths of coasts
  int record = -1;        ///< entry of memory that takes its displacement, or -1
  std::size_t first_reference = 0, last_reference = 0;
};

/// What a step that cuts does beside its block.
struct StepContact {
  Lanes stiffness[4] = {};   ///< K (I - S K)^-1 [N/m]
  Lanes compliance[4] = {};  ///< I + S K (I - S K)^-1
  Lanes force[2] = {};       ///< out: mean force over the step [N]
};

/// One period of all steps.
struct PeriodArguments {
  std::size_t modal = 0;  ///< 2n
  const Step* steps = nullptr;
  std::size_t step_count = 0;
  const Reference* references = nullptr;
  const Lanes* blocks = nullptr;  ///< one after the other
  StepContact* contacts = nullptr;
  const Lanes* coasts = nullptr;         ///< 2n for each length of coast: factor of each mode
  const double* displacement = nullptr;  ///< V, 2 x 2n: 2 Re right, -2 Im right
  const Lanes* compliance = nullptr;     ///< S, 2 x 2, or nullptr where it is zero
  std::size_t inputs = 0;                ///< entries of memory that come from the period before
  const std::size_t* outputs = nullptr;  ///< length inputs: entries that go to the next
  Lanes* memory = nullptr;               ///< two for each entry
  Lanes* state = nullptr;                ///< 2 (2n + 2)
  const Lanes* in = nullptr;             ///< 2n + 2 inputs
  Lanes* out = nullptr;
};
void run_period(PeriodArguments& a);

/// Takes out of w = basis_{column+1} what lies along basis_0 … basis_column and norms it; twice in the lanes where
/// little is left of it. A lane whose rest is nothing gets a zero vector.
struct OrthogonalArguments {
  std::size_t size = 0;
  std::size_t column = 0;
  Lanes* basis = nullptr;         ///< [column][size]
  Lanes* coefficients = nullptr;  ///< out: column + 2
};
void orthogonalise(OrthogonalArguments& a);

/// to = from / ‖from‖; a lane whose norm is zero or not finite keeps what is in `to`.
struct NormaliseArguments {
  std::size_t size = 0;
  const Lanes* from = nullptr;
  Lanes* to = nullptr;
};
void normalise(NormaliseArguments& a);

}  // namespace robomill::stability::detail
