#include "robomill/modal/posture/receptance_lines.hpp"

#include <algorithm>

// Every function with vectors in its signature is inlined always, so that no call ever passes one.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace robomill::modal::detail {

/// Matrices column by column, complex lanes as pairs of Lanes.
struct FlexibleArm::ReceptanceLines::Work {
  const System& system;
  const std::vector<Term>& terms;
  const std::array<double, 6>& compliance;
  std::size_t bracket_row;
  bool derivatives;
  const Lanes &re, &im;  // of s
  Lanes *lower, *solution, *bodies, *tools;
  SymmetricLanes& value;
  SymmetricLanes* derivative;
};

namespace {

using Kind = ArmParameter::Kind;

#define CORE ROBOMILL_KERNEL_CORE

template <class V>
struct ComplexLane {
  V re, im;
};
#define C ComplexLane<V>

CORE V& at(Lanes& operand, std::size_t lane) {
  return *reinterpret_cast<V*>(operand.v + lane);
}
CORE const V& at(const Lanes& operand, std::size_t lane) {
  return *reinterpret_cast<const V*>(operand.v + lane);
}
CORE C load(const Lanes* pair, std::size_t lane) {
  return {at<V>(pair[0], lane), at<V>(pair[1], lane)};
}
CORE void store(Lanes* pair, std::size_t lane, const C& value) {
  at<V>(pair[0], lane) = value.re;
  at<V>(pair[1], lane) = value.im;
}
CORE C product(const C& a, const C& b) {
  return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}
CORE C inverse(const C& a) {
  const V over = 1.0 / (a.re * a.re + a.im * a.im);
  return {a.re * over, -a.im * over};
}
CORE void add(C& to, double factor, const C& value) {
  to.re += factor * value.re;
  to.im += factor * value.im;
}

/// A 3 x 3 matrix.
template <class V>
struct ComplexLane3 {
  ComplexLane<V> v[3][3];
};
#define C3 ComplexLane3<V>

/// Where a symmetric matrix's entry is in SymmetricLanes.
constexpr std::size_t rows[6] = {0, 1, 2, 1, 2, 2}, columns[6] = {0, 0, 0, 1, 1, 2};

/// a − Σ_k u_k l_k
CORE C less_products(const C& a, std::size_t count, const Lanes* u, const Lanes* l, std::size_t step,
                     std::size_t lane) {
  V re_re = {}, im_im = {}, re_im = {}, im_re = {};
  for (std::size_t k = 0; k < count; ++k) {
    const C one = load<V>(u + 2 * k, lane), other = load<V>(l + step * k, lane);
    re_re += one.re * other.re;
    im_im += one.im * other.im;
    re_im += one.re * other.im;
    im_re += one.im * other.re;
  }
  return {a.re - (re_re - im_im), a.im - (re_im + im_re)};
}

constexpr std::size_t row_of(std::size_t i) {
  return i * (i + 1);  // in Lanes, a pair an entry
}

/// L below the diagonal, 1 / D on it. @param u  room for a row
CORE void factorise(const FlexibleArm::System& system, const C& s, Lanes* lower, Lanes* u, std::size_t lane) {
  const C s2 = product<V>(s, s);
  const auto n = static_cast<std::size_t>(system.mass.rows());
  const double *mass = system.mass.data(), *damping = system.damping.data(), *stiffness = system.stiffness.data();
  for (std::size_t i = 0; i < n; ++i) {
    Lanes* const row = lower + row_of(i);
    for (std::size_t j = 0; j <= i; ++j) {
      const std::size_t entry = i * n + j;
      C a = {stiffness[entry] + s2.re * mass[entry] + s.re * damping[entry],
             s2.im * mass[entry] + s.im * damping[entry]};
      if (j < i) {
        a = less_products<V>(a, j, u, lower + row_of(j), 2, lane);
        store<V>(u + 2 * j, lane, a);
        store<V>(row + 2 * j, lane, product<V>(a, load<V>(lower + row_of(j) + 2 * j, lane)));
      } else {
        a = less_products<V>(a, i, u, row, 2, lane);
        store<V>(row + 2 * i, lane, inverse<V>(a));
      }
    }
  }
}

/// g of L D Lᵀ g = B, n x 3 row by row.
CORE void solve(const FlexibleArm::System& system, const Lanes* lower, Lanes* g, std::size_t lane) {
  const auto n = static_cast<std::size_t>(system.input.rows());
  const double* input = system.input.data();
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      const C b = {V{} + input[c * n + i], V{}};
      store<V>(g + 6 * i + 2 * c, lane, less_products<V>(b, i, lower + row_of(i), g + 2 * c, 6, lane));
    }
  }
  for (std::size_t i = 0; i < n; ++i) {
    const C over = load<V>(lower + row_of(i) + 2 * i, lane);
    for (std::size_t c = 0; c < 3; ++c) {
      Lanes* const entry = g + 6 * i + 2 * c;
      store<V>(entry, lane, product<V>(load<V>(entry, lane), over));
    }
  }
  for (std::size_t i = n; i-- > 0;) {
    for (std::size_t j = 0; j < i; ++j) {
      const C l = load<V>(lower + row_of(i) + 2 * j, lane);
      for (std::size_t c = 0; c < 3; ++c) {
        const C less = product<V>(l, load<V>(g + 6 * i + 2 * c, lane));
        at<V>(g[6 * j + 2 * c], lane) -= less.re;
        at<V>(g[6 * j + 2 * c + 1], lane) -= less.im;
      }
    }
  }
}

/// A g of a real A, 3 x n with its entries `row_step` and `column_step` apart.
CORE C3 times(const double* a, std::size_t row_step, std::size_t column_step, std::size_t n, const Lanes* g,
              std::size_t lane) {
  C3 out = {};
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t r = 0; r < 3; ++r) {
      const double factor = a[r * row_step + i * column_step];
      for (std::size_t c = 0; c < 3; ++c) add<V>(out.v[r][c], factor, load<V>(g + 6 * i + 2 * c, lane));
    }
  }
  return out;
}
/// A X of a real A, row by row.
CORE C3 times(const std::array<double, 9>& a, const C3& x) {
  C3 out = {};
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t c = 0; c < 3; ++c) add<V>(out.v[r][c], a[3 * r + k], x.v[k][c]);
    }
  }
  return out;
}
CORE C3 load3(const Lanes* matrix, std::size_t lane) {
  C3 out = {};
  for (std::size_t e = 0; e < 9; ++e) out.v[e / 3][e % 3] = load<V>(matrix + 2 * e, lane);
  return out;
}
CORE void store3(Lanes* matrix, std::size_t lane, const C3& value) {
  for (std::size_t e = 0; e < 9; ++e) store<V>(matrix + 2 * e, lane, value.v[e / 3][e % 3]);
}
/// factor (Xᵀ Y)_ab added to, of an entry a, b.
CORE void add_product(C& to, double factor, const C3& x, const C3& y, std::size_t a, std::size_t b) {
  for (std::size_t k = 0; k < 3; ++k) add<V>(to, factor, product<V>(x.v[k][a], y.v[k][b]));
}
CORE void put(SymmetricLanes& out, std::size_t entry, std::size_t lane, const C& value) {
  at<V>(out.re[entry], lane) = value.re;
  at<V>(out.im[entry], lane) = value.im;
}

/// Motions of the bodies' centres, their turnings, and what the tip's forces do to the tool's masses: 3 x 3 each.
CORE void move_bodies(FlexibleArm::ReceptanceLines::Work& w, std::size_t n, std::size_t lane) {
  Lanes* to = w.bodies;
  for (const FlexibleArm::BodyMotion& body : w.system.bodies) {
    store3<V>(to, lane, times<V>(body.linear.data(), 1, 3, n, w.solution, lane));
    store3<V>(to + 18, lane, times<V>(body.turning.data(), 1, 3, n, w.solution, lane));
    to += 36;
  }
  to = w.tools;
  for (const FlexibleArm::ToolMotion& tool : w.system.tools) {
    store3<V>(to, lane, times<V>(tool.input.data(), n, 1, n, w.solution, lane));
    to += 18;
  }
}

/// Bᵀ ∂M B of what hangs on the bracket as its pivot moves: the masses times their motions.
CORE C3 carried(const FlexibleArm::ReceptanceLines::Work& w, std::size_t lane) {
  C3 out = {};
  const auto add_motion = [&](double mass_kg, const Lanes* motion) __attribute__((always_inline)) {
    const C3 moved = load3<V>(motion, lane);
    for (std::size_t r = 0; r < 3; ++r) {
      for (std::size_t c = 0; c < 3; ++c) add<V>(out.v[r][c], mass_kg, moved.v[r][c]);
    }
  };
  for (std::size_t b = 0; b < w.system.bodies.size(); ++b) {
    if (w.system.bodies[b].on_bracket) add_motion(w.system.bodies[b].mass_kg, w.bodies + 36 * b);
  }
  for (std::size_t t = 0; t < w.system.tools.size(); ++t) add_motion(w.system.tools[t].mass_kg, w.tools + 18 * t);
  return out;
}

using Term = FlexibleArm::ReceptanceLines::Term;
using Change = FlexibleArm::ReceptanceLines::Change;

/// ∂H = −gᵀ (∂K + s ∂C) g.
CORE void spring(const Term& term, const C& s, const Lanes* g, SymmetricLanes& out, std::size_t lane) {
  for (std::size_t e = 0; e < 6; ++e) {
    C sum = {};
    for (std::size_t i = 0; i < term.count; ++i) {
      C pulled = {}, damped = {};
      for (std::size_t k = 0; k < term.count; ++k) {
        const C moved = load<V>(g + 6 * (term.first + k) + 2 * columns[e], lane);
        add<V>(pulled, term.one[3 * i + k], moved);
        add<V>(damped, term.other[3 * i + k], moved);
      }
      add<V>(pulled, 1.0, product<V>(s, damped));
      add<V>(sum, -1.0, product<V>(load<V>(g + 6 * (term.first + i) + 2 * rows[e], lane), pulled));
    }
    put<V>(out, e, lane, sum);
  }
}

/// gᵀ ∂M g of a parameter of mass; of one of the bracket's pivot, with B's own change, ∂H.
CORE void mass(const FlexibleArm::ReceptanceLines::Work& w, const Term& term, const C& s2, SymmetricLanes& out,
               std::size_t lane) {
  C3 left = {}, right = {}, more = {};
  bool both = false;
  double factor = 1.0, more_factor = 0.0;
  if (term.change == Change::tool_mass) {
    left = right = load3<V>(w.tools + 18 * term.index, lane);
    factor = w.system.tools[term.index].mass_kg;
  } else if (term.change == Change::pivot) {
    C3 bracket = load3<V>(w.solution + 6 * w.bracket_row, lane);
    left = times<V>(term.one, bracket);
    right = carried<V>(w, lane);
    both = true;
  } else {
    const FlexibleArm::BodyMotion& body = w.system.bodies[term.index];
    const C3 moved = load3<V>(w.bodies + 36 * term.index, lane),
             turned = load3<V>(w.bodies + 36 * term.index + 18, lane);
    const C3 other = times<V>(term.one, turned);
    if (term.change == Change::body_center) {
      left = other;
      right = moved;
      factor = body.mass_kg;
      both = true;
    } else {
      left = turned;
      right = other;
      more = moved;
      if (term.change == Change::body_mass) more_factor = body.mass_kg;
    }
  }
  for (std::size_t e = 0; e < 6; ++e) {
    C sum = {};
    add_product<V>(sum, factor, left, right, rows[e], columns[e]);
    if (both) add_product<V>(sum, factor, left, right, columns[e], rows[e]);
    if (more_factor > 0.0) add_product<V>(sum, more_factor, more, more, rows[e], columns[e]);
    C change = product<V>(s2, sum);
    change = {-change.re, -change.im};
    if (term.change == Change::pivot) {
      add<V>(change, 1.0, left.v[rows[e]][columns[e]]);
      add<V>(change, 1.0, left.v[columns[e]][rows[e]]);
    }
    put<V>(out, e, lane, change);
  }
}

CORE void differentiate(FlexibleArm::ReceptanceLines::Work& w, const C& s, std::size_t n, std::size_t lane) {
  move_bodies<V>(w, n, lane);
  const C s2 = product<V>(s, s);
  for (std::size_t p = 0; p < w.terms.size(); ++p) {
    const Term& term = w.terms[p];
    SymmetricLanes& out = w.derivative[p];
    if (term.change == Change::spring) {
      spring<V>(term, s, w.solution, out, lane);
    } else if (term.change == Change::compliance) {
      for (std::size_t e = 0; e < 6; ++e) put<V>(out, e, lane, {V{} + term.one[e], V{}});
    } else if (term.change == Change::rotor) {
      const Lanes* const g = w.solution + 6 * term.first;
      for (std::size_t e = 0; e < 6; ++e) {
        const C square = product<V>(load<V>(g + 2 * rows[e], lane), load<V>(g + 2 * columns[e], lane));
        C change = {};
        add<V>(change, -term.factor, product<V>(s2, square));
        put<V>(out, e, lane, change);
      }
    } else {
      mass<V>(w, term, s2, out, lane);
    }
  }
}

CORE void run_lines_core(FlexibleArm::ReceptanceLines::Work& w, std::size_t lane) {
  const C s = {at<V>(w.re, lane), at<V>(w.im, lane)};
  const auto n = static_cast<std::size_t>(w.system.input.rows());
  factorise<V>(w.system, s, w.lower, w.lower + row_of(n), lane);
  solve<V>(w.system, w.lower, w.solution, lane);
  const C3 tip = times<V>(w.system.input.data(), n, 1, n, w.solution, lane);
  for (std::size_t e = 0; e < 6; ++e) {
    C value = tip.v[rows[e]][columns[e]];
    value.re += w.compliance[e];
    put<V>(w.value, e, lane, value);
  }
  if (w.derivatives) differentiate<V>(w, s, n, lane);
}

ROBOMILL_KERNEL(run_lines, FlexibleArm::ReceptanceLines::Work)

#undef C3
#undef C
#undef CORE

/// By rows.
std::array<double, 9> in_rows(const Eigen::Matrix3d& matrix) {
  std::array<double, 9> out = {};
  Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(out.data()) = matrix;
  return out;
}

std::array<double, 6> lower_of(const Eigen::Matrix3d& matrix) {
  std::array<double, 6> out = {};
  for (std::size_t e = 0; e < out.size(); ++e) {
    out[e] = matrix(static_cast<Eigen::Index>(rows[e]), static_cast<Eigen::Index>(columns[e]));
  }
  return out;
}

}  // namespace

FlexibleArm::ReceptanceLines::ReceptanceLines(const FlexibleArm& arm, const System& system, bool derivatives)
    : system_(system), bracket_row_(static_cast<std::size_t>(arm.bracket_row_)) {
  const auto n = static_cast<std::size_t>(system.input.rows());
  compliance_ = lower_of(system.flange_axes * system.compliance.asDiagonal() * system.flange_axes.transpose());
  lower_.resize(row_of(n) + 2 * n);
  solution_.resize(6 * n);
  if (!derivatives) return;
  bodies_.resize(36 * system.bodies.size());
  tools_.resize(18 * system.tools.size());
  for (std::size_t p = 0; p < arm.parameters_.size(); ++p) terms_.push_back(term_of(arm, p));
  derivative_.resize(terms_.size());
  farther_derivative_.resize(terms_.size());
}

FlexibleArm::ReceptanceLines::Term FlexibleArm::ReceptanceLines::term_of(const FlexibleArm& arm, std::size_t p) const {
  const ArmParameter& parameter = arm.parameters_[p];
  const SpringChange& spring = system_.springs[p];
  const auto axis = static_cast<Eigen::Index>(parameter.index);
  Term out{.index = parameter.index};
  switch (parameter.kind) {
    case Kind::compliance:
      out.change = Change::compliance;
      std::ranges::copy(
          lower_of(compliance_unit_m_per_n * system_.flange_axes.col(axis) * system_.flange_axes.col(axis).transpose()),
          out.one.begin());
      break;
    case Kind::rotor_inertia:
      out.change = Change::rotor;
      out.first = static_cast<std::size_t>(arm.joint_row(parameter.index));
      out.factor = system_.rotor(static_cast<Eigen::Index>(out.first));
      break;
    case Kind::bracket_pivot:
      out.change = Change::pivot;
      out.one = in_rows(system_.flange_axes * cross_matrix(Eigen::Vector3d::Unit(axis)));
      break;
    case Kind::tool_mass:
      out.change = Change::tool_mass;
      break;
    case Kind::body_center: {
      const Eigen::Matrix3d& axes = system_.bodies[parameter.index].axes;
      out.change = Change::body_center;
      out.one = in_rows(-cross_matrix(axes.col(static_cast<Eigen::Index>(parameter.axis))));
      break;
    }
    case Kind::body_inertia:
    case Kind::body_mass:
      out.change = parameter.kind == Kind::body_mass ? Change::body_mass : Change::body_inertia;
      out.one = in_rows(system_.bodies[parameter.index].inertia);
      break;
    default:
      out.first = static_cast<std::size_t>(spring.first);
      out.count = static_cast<std::size_t>(spring.count);
      out.one = in_rows(spring.stiffness);
      out.other = in_rows(spring.damping);
  }
  return out;
}

void FlexibleArm::ReceptanceLines::evaluate(const Lanes& re, const Lanes& im, SymmetricLanes& value,
                                            std::vector<SymmetricLanes>& derivative) {
  Work work{.system = system_,
            .terms = terms_,
            .compliance = compliance_,
            .bracket_row = bracket_row_,
            .derivatives = !terms_.empty(),
            .re = re,
            .im = im,
            .lower = lower_.data(),
            .solution = solution_.data(),
            .bodies = bodies_.data(),
            .tools = tools_.data(),
            .value = value,
            .derivative = derivative.data()};
  run_lines(work);
}

void FlexibleArm::ReceptanceLines::evaluate(std::span<const std::complex<double>> s) {
  Lanes re = {}, im = {}, farther = {}, weight = {}, less = {};
  bool smoothed = false;
  for (std::size_t lane = 0; lane < lane_count; ++lane) {
    const std::complex<double> at = s[std::min(lane, s.size() - 1)];
    const bool right = at.real() > 0.0;
    re.v[lane] = at.real();
    im.v[lane] = at.imag();
    farther.v[lane] = 2.0 * at.real();
    weight.v[lane] = right ? 2.0 : 1.0;
    less.v[lane] = right ? 1.0 : 0.0;
    smoothed = smoothed || right;
  }
  evaluate(re, im, value_, derivative_);
  if (!smoothed) return;
  evaluate(farther, im, farther_, farther_derivative_);
  const auto combine = [&](SymmetricLanes& near, const SymmetricLanes& far) {
    for (std::size_t e = 0; e < near.re.size(); ++e) {
      for (std::size_t lane = 0; lane < lane_count; ++lane) {
        near.re[e].v[lane] = weight.v[lane] * near.re[e].v[lane] - less.v[lane] * far.re[e].v[lane];
        near.im[e].v[lane] = weight.v[lane] * near.im[e].v[lane] - less.v[lane] * far.im[e].v[lane];
      }
    }
  };
  combine(value_, farther_);
  for (std::size_t p = 0; p < derivative_.size(); ++p) combine(derivative_[p], farther_derivative_[p]);
}

}  // namespace robomill::modal::detail
