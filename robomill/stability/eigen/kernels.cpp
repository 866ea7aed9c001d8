#include "robomill/stability/eigen/kernels.hpp"

#include <cmath>

#include "robomill/stability/eigen/kernel_parts.hpp"

namespace robomill::stability::detail {
namespace {

/// Solves (I - G K) X = [V, G 1] in place of the right-hand side. G K is small by the choice of the substep: no pivots.
CORE void solve_nodes(const BlockArguments& a, Lanes* matrix, Lanes* right, std::size_t lane) {
  const std::size_t m = a.nodes;
  const std::size_t columns = a.modal + 2;
  for (std::size_t r = 0; r < m; ++r) {
    V sum0 = {};
    V sum1 = {};
    for (std::size_t l = 0; l < m; l += 2) {
      const V g0 = L(a.response[r * m + l]);
      const V g1 = L(a.response[r * m + l + 1]);
      L(matrix[r * m + l]) = -(g0 * L(a.stiffness[0]) + g1 * L(a.stiffness[2]));
      L(matrix[r * m + l + 1]) = -(g0 * L(a.stiffness[1]) + g1 * L(a.stiffness[3]));
      sum0 += g0;
      sum1 += g1;
    }
    L(matrix[r * m + r]) += 1.0;
    for (std::size_t c = 0; c < a.modal; ++c) L(right[r * columns + c]) = L(a.at_nodes[r * a.modal + c]);
    L(right[r * columns + a.modal]) = sum0;
    L(right[r * columns + a.modal + 1]) = sum1;
  }
  eliminate<V>(m, columns, matrix, right, lane);
}

/// Displacements at the nodes become forces there: f = K q - c.
CORE void forces_at_nodes(const BlockArguments& a, Lanes* right, std::size_t lane) {
  const std::size_t columns = a.modal + 2;
  for (std::size_t l = 0; l < a.nodes; l += 2) {
    Lanes* x = right + l * columns;
    Lanes* y = x + columns;
    for (std::size_t c = 0; c < columns; ++c) {
      const V qx = L(x[c]);
      const V qy = L(y[c]);
      L(x[c]) = L(a.stiffness[0]) * qx + L(a.stiffness[1]) * qy;
      L(y[c]) = L(a.stiffness[2]) * qx + L(a.stiffness[3]) * qy;
    }
    L(x[a.modal]) += 1.0;
    L(y[a.modal + 1]) += 1.0;
  }
}

/// [P, Γ] = [E, 0] + W T.
CORE void substep_block(const BlockArguments& a, const Lanes* forces, Lanes* block, std::size_t lane) {
  const std::size_t columns = a.modal + 2;
  for (std::size_t r = 0; r < a.modal; ++r) {
    for (std::size_t c = 0; c < columns; ++c) {
      V sum = {};
      for (std::size_t l = 0; l < a.nodes; ++l) sum += L(a.influence[r * a.nodes + l]) * L(forces[l * columns + c]);
      L(block[r * columns + c]) = sum;
    }
    const std::size_t k = r / 2 * 2;
    if (r == k) {
      L(block[r * columns + k]) += L(a.substep[k]);
      L(block[r * columns + k + 1]) -= L(a.substep[k + 1]);
    } else {
      L(block[r * columns + k]) += L(a.substep[k + 1]);
      L(block[r * columns + k + 1]) += L(a.substep[k]);
    }
  }
}

/// P P and P Γ + Γ.
CORE void double_block(std::size_t modal, const Lanes* block, Lanes* twice, std::size_t lane) {
  const std::size_t columns = modal + 2;
  for (std::size_t r = 0; r < modal; ++r) {
    for (std::size_t c = 0; c < columns; ++c) {
      V sum = {};
      if (c >= modal) sum = L(block[r * columns + c]);
      for (std::size_t l = 0; l < modal; ++l) sum += L(block[r * columns + l]) * L(block[l * columns + c]);
      L(twice[r * columns + c]) = sum;
    }
  }
}

CORE void build_block_core(BlockArguments& a, std::size_t lane) {
  const std::size_t columns = a.modal + 2;
  Lanes* matrix = a.work;
  Lanes* right = matrix + a.nodes * a.nodes;
  Lanes* here = right + a.nodes * columns;
  Lanes* there = here + a.modal * columns;
  solve_nodes<V>(a, matrix, right, lane);
  forces_at_nodes<V>(a, right, lane);
  substep_block<V>(a, right, here, lane);
  for (int i = 0; i < a.halvings; ++i) {
    double_block<V>(a.modal, here, there, lane);
    Lanes* swap = here;
    here = there;
    there = swap;
  }
  for (std::size_t r = 0; r < (a.modal + 3) / 4 * 4; ++r) {
    Lanes* to = a.block + r / 4 * 4 * columns + r % 4;
    for (std::size_t c = 0; c < columns; ++c) {
      if (r < a.modal) {
        L(to[4 * c]) = L(here[r * columns + c]);
      } else {
        L(to[4 * c]) = V{};
      }
    }
  }
}

CORE void displacement_of(const PeriodArguments& a, const Lanes* z, Lanes* q, std::size_t lane) {
  const double* row_x = a.displacement;
  const double* row_y = row_x + a.modal;
  V x0 = {}, x1 = {}, y0 = {}, y1 = {};
  for (std::size_t k = 0; k < a.modal; k += 2) {
    x0 += row_x[k] * L(z[k]);
    x1 += row_x[k + 1] * L(z[k + 1]);
    y0 += row_y[k] * L(z[k]);
    y1 += row_y[k + 1] * L(z[k + 1]);
  }
  L(q[0]) = x0 + x1;
  L(q[1]) = y0 + y1;
}

/// The two delayed forces c of a step.
CORE void delayed_force(const PeriodArguments& a, const Step& step, Lanes* c, std::size_t lane) {
  V x = {}, y = {};
  for (std::size_t i = step.first_reference; i < step.last_reference; ++i) {
    const Reference& reference = a.references[i];
    const Lanes* d = a.memory + 2 * reference.entry;
    x += L(reference.matrix[0]) * L(d[0]) + L(reference.matrix[1]) * L(d[1]);
    y += L(reference.matrix[2]) * L(d[0]) + L(reference.matrix[3]) * L(d[1]);
  }
  L(c[0]) = x;
  L(c[1]) = y;
}

/// One step that cuts: z has room for the two entries behind it; q is its displacement, before and after.
CORE void cut(const PeriodArguments& a, const Step& step, Lanes* z, Lanes* next, Lanes* q, std::size_t lane) {
  StepContact& contact = a.contacts[step.index];
  Lanes c[2];
  delayed_force<V>(a, step, c, lane);
  L(z[a.modal]) = -L(c[0]);
  L(z[a.modal + 1]) = -L(c[1]);
  multiply<V>(a.modal, a.modal + 2, a.blocks + step.index * block_size(a.modal), z, next, lane);
  const V before_x = L(q[0]);
  const V before_y = L(q[1]);
  displacement_of<V>(a, next, q, lane);
  const V x = 0.5 * (before_x + L(q[0]));
  const V y = 0.5 * (before_y + L(q[1]));
  L(contact.force[0]) = L(contact.stiffness[0]) * x + L(contact.stiffness[1]) * y - L(c[0]);
  L(contact.force[1]) = L(contact.stiffness[2]) * x + L(contact.stiffness[3]) * y - L(c[1]);
  if (step.record < 0) return;
  Lanes* d = a.memory + 2 * static_cast<std::size_t>(step.record);
  if (a.compliance == nullptr) {
    L(d[0]) = x;
    L(d[1]) = y;
  } else {
    const Lanes* n = contact.compliance;
    const Lanes* s = a.compliance;
    L(d[0]) = L(n[0]) * x + L(n[1]) * y - (L(s[0]) * L(c[0]) + L(s[1]) * L(c[1]));
    L(d[1]) = L(n[2]) * x + L(n[3]) * y - (L(s[2]) * L(c[0]) + L(s[3]) * L(c[1]));
  }
}

CORE void run_period_core(PeriodArguments& a, std::size_t lane) {
  Lanes* z = a.state;
  Lanes* next = a.state + (a.modal + 3) / 4 * 4 + 2;
  Lanes q[2];
  for (std::size_t k = 0; k < a.modal; ++k) L(z[k]) = L(a.in[k]);
  for (std::size_t e = 0; e < 2 * a.inputs; ++e) L(a.memory[e]) = L(a.in[a.modal + e]);
  displacement_of<V>(a, z, q, lane);
  for (std::size_t i = 0; i < a.step_count; ++i) {
    const Step& step = a.steps[i];
    if (step.coast == 0) {
      cut<V>(a, step, z, next, q, lane);
      Lanes* swap = z;
      z = next;
      next = swap;
      continue;
    }
    const V before_x = L(q[0]);
    const V before_y = L(q[1]);
    coast<V>(a.modal, a.coasts + step.index * a.modal, z, lane);
    displacement_of<V>(a, z, q, lane);
    if (step.record < 0) continue;
    Lanes* d = a.memory + 2 * static_cast<std::size_t>(step.record);
    L(d[0]) = 0.5 * (before_x + L(q[0]));
    L(d[1]) = 0.5 * (before_y + L(q[1]));
  }
  for (std::size_t k = 0; k < a.modal; ++k) L(a.out[k]) = L(z[k]);
  for (std::size_t e = 0; e < a.inputs; ++e) {
    L(a.out[a.modal + 2 * e]) = L(a.memory[2 * a.outputs[e]]);
    L(a.out[a.modal + 2 * e + 1]) = L(a.memory[2 * a.outputs[e] + 1]);
  }
}

/// w <- w - h v, and sum <- w · u of what comes out.
CORE void subtract_and_dot(std::size_t size, const V& h, const Lanes* v, const Lanes* u, Lanes* w, V& sum,
                           std::size_t lane) {
  V even = {}, odd = {};
  std::size_t i = 0;
  for (; i + 2 <= size; i += 2) {
    const V first = L(w[i]) - h * L(v[i]);
    const V second = L(w[i + 1]) - h * L(v[i + 1]);
    L(w[i]) = first;
    L(w[i + 1]) = second;
    even += first * L(u[i]);
    odd += second * L(u[i + 1]);
  }
  if (i < size) {
    const V last = L(w[i]) - h * L(v[i]);
    L(w[i]) = last;
    even += last * L(u[i]);
  }
  sum = even + odd;
}

/// Modified Gram-Schmidt. The product with the next vector is taken on the way; the last one, `left`, with w itself.
/// `takes` is 0 in the lanes that are to stay as they are, else 1.
CORE void take_out(OrthogonalArguments& a, Lanes* w, const V& takes, V& left, std::size_t lane) {
  V h = {};
  subtract_and_dot<V>(a.size, h, a.basis, a.basis, w, h, lane);
  for (std::size_t j = 0; j <= a.column; ++j) {
    const Lanes* v = a.basis + j * a.size;
    const V along = h * takes;
    L(a.coefficients[j]) += along;
    subtract_and_dot<V>(a.size, along, v, j < a.column ? v + a.size : w, w, h, lane);
  }
  left = h;
}

CORE void orthogonalise_core(OrthogonalArguments& a, std::size_t lane) {
  constexpr double much = 0.01;  // of the square that must be left: else rounding leaves something of the basis
  Lanes* w = a.basis + (a.column + 1) * a.size;
  const V nothing = {};
  const V one = nothing + 1.0;
  for (std::size_t j = 0; j <= a.column; ++j) L(a.coefficients[j]) = nothing;
  V before, left;
  subtract_and_dot<V>(a.size, nothing, w, w, w, before, lane);
  take_out<V>(a, w, one, left, lane);
  const V again = left > much * before ? nothing : one;
  bool any = false;
  for (std::size_t i = 0; i < sizeof(V) / sizeof(double); ++i) any = any || again[i] != 0.0;
  if (any) take_out<V>(a, w, again, left, lane);
  V inverse = {};
  for (std::size_t i = 0; i < sizeof(V) / sizeof(double); ++i) {
    const double length = std::sqrt(left[i]);
    left[i] = length;
    inverse[i] = length > 1e-150 ? 1.0 / length : 0.0;
  }
  L(a.coefficients[a.column + 1]) = left;
  for (std::size_t i = 0; i < a.size; ++i) L(w[i]) *= inverse;
}

CORE void normalise_core(NormaliseArguments& a, std::size_t lane) {
  V even = {}, odd = {};
  std::size_t i = 0;
  for (; i + 2 <= a.size; i += 2) {
    even += L(a.from[i]) * L(a.from[i]);
    odd += L(a.from[i + 1]) * L(a.from[i + 1]);
  }
  if (i < a.size) even += L(a.from[i]) * L(a.from[i]);
  const V square = even + odd;
  V scale = {};
  for (std::size_t k = 0; k < sizeof(V) / sizeof(double); ++k) {
    if (std::isfinite(square[k]) && square[k] > 0.0) scale[k] = 1.0 / std::sqrt(square[k]);
  }
  const V nothing = {};
  for (i = 0; i < a.size; ++i) L(a.to[i]) = scale > nothing ? L(a.from[i]) * scale : L(a.to[i]);
}

}  // namespace

ROBOMILL_KERNEL(build_block, BlockArguments)
ROBOMILL_KERNEL(run_period, PeriodArguments)
ROBOMILL_KERNEL(orthogonalise, OrthogonalArguments)
ROBOMILL_KERNEL(normalise, NormaliseArguments)

}  // namespace robomill::stability::detail
