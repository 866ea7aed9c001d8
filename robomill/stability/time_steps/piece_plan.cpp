#include "robomill/stability/time_steps/piece_plan.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <mutex>

#include "robomill/stability/eigen/kernel_parts.hpp"
#include "robomill/stability/gauss.hpp"

namespace robomill::stability::detail {
namespace {

using Complex = std::complex<double>;

constexpr std::size_t most_groups = most_nodes / lane_count;  // of eight nodes
constexpr std::size_t most_ends = most_nodes + 1;
constexpr std::size_t most_integrals = most_ends * most_groups;

/// Lagrange values that depend on the numbers of nodes and quadrature points alone. The last end is that of the piece.
struct Table {
  const GaussRule* nodes = nullptr;
  const GaussRule* quadrature = nullptr;
  std::size_t groups = 1;    ///< of eight nodes
  std::vector<double> end;   ///< [i]: node i, then 1
  std::vector<Lanes> value;  ///< [(i * points + q) * groups + l / 8]: ℓ_l at end_i * quadrature node q, in lane l % 8
};

Table make_table(int p, int points) {
  Table table;
  table.nodes = &gauss_rule(p);
  table.quadrature = &gauss_rule(points);
  table.end = table.nodes->node;
  table.end.push_back(1.0);
  const std::size_t nodes = table.nodes->node.size();
  table.groups = (nodes + lane_count - 1) / lane_count;
  for (const double end : table.end) {
    for (const double x : table.quadrature->node) {
      Lanes* const values = &*table.value.insert(table.value.end(), table.groups, Lanes{});
      for (std::size_t l = 0; l < nodes; ++l) {
        values[l / lane_count].v[l % lane_count] = lagrange(table.nodes->node, l, end * x);
      }
    }
  }
  return table;
}

constexpr int least_more = 4;  // quadrature points beyond half the nodes
constexpr int most_more = 12;

/// Gauss's rule is exact where the force's polynomial and 2 more - 1 powers of the exponential's series end together:
/// for `more` of 4 plus the radians in the piece the remainder of the series is below rounding.
const Table& table(int p, double radians) {
  const int more = std::clamp(static_cast<int>(std::ceil(radians)) + least_more, least_more, most_more);
  struct Slot {
    std::once_flag made;
    Table table;
  };
  static std::array<std::array<Slot, most_more - least_more + 1>, most_nodes + 1> slots;
  Slot& slot = slots[static_cast<std::size_t>(p)][static_cast<std::size_t>(more - least_more)];
  std::call_once(slot.made, [&] { slot.table = make_table(p, p / 2 + more); });
  return slot.table;
}

using Decays = std::array<Complex, most_gauss_points>;

/// e^z; std::exp looks for what is not finite besides.
Complex exponential(Complex z) {
  return std::polar(std::exp(z.real()), z.imag());
}

/// e^(pole t) at the quadrature points of one end: points that lie as far on either side of the middle share what
/// they turn and fade by.
void decays(Complex pole, const std::array<double, most_gauss_points>& before_s, std::size_t points, bool mirrored,
            Decays& out) {
  if (!mirrored) {
    for (std::size_t q = 0; q < points; ++q) out[q] = exponential(pole * before_s[q]);
    return;
  }
  const double middle_s = 0.5 * (before_s[0] + before_s[points - 1]);
  const Complex middle = exponential(pole * middle_s);
  for (std::size_t q = 0; q < points / 2; ++q) {
    const Complex away = exponential(pole * (before_s[q] - middle_s));
    out[q] = middle * away;
    out[points - 1 - q] = middle * (std::conj(away) / std::norm(away));
  }
  if (points % 2 == 1) out[points / 2] = middle;
}

/// What one mode does at the ends, eight nodes at a time.
struct ModeArguments {
  std::size_t ends = 0, points = 0, groups = 0, entries = 0;
  const Lanes* value = nullptr;                                        ///< of the table
  const std::array<Decays, most_ends>* decay = nullptr;                ///< times the weights of quadrature
  const double *residue_real = nullptr, *residue_imaginary = nullptr;  ///< length entries: D D
  Lanes *real = nullptr, *imaginary = nullptr;  ///< [end * groups + group]: ∫ exp(pole (end - s)) ℓ_l(s) ds
  Lanes* response = nullptr;                    ///< [(node * entries + entry) * groups + group], which it adds to
};

CORE void add_mode_core(ModeArguments& a, std::size_t lane) {
  for (std::size_t end = 0; end < a.ends; ++end) {
    const Decays& decay = (*a.decay)[end];
    for (std::size_t group = 0; group < a.groups; ++group) {
      const Lanes* value = a.value + end * a.points * a.groups + group;
      V real = {}, imaginary = {};
      for (std::size_t q = 0; q < a.points; ++q, value += a.groups) {
        real += decay[q].real() * L(*value);
        imaginary += decay[q].imag() * L(*value);
      }
      L(a.real[end * a.groups + group]) = real;
      L(a.imaginary[end * a.groups + group]) = imaginary;
      if (end + 1 == a.ends) continue;
      for (std::size_t e = 0; e < a.entries; ++e) {
        L(a.response[(end * a.entries + e) * a.groups + group]) +=
            2.0 * (real * a.residue_real[e] - imaginary * a.residue_imaginary[e]);
      }
    }
  }
}
ROBOMILL_KERNEL(add_mode, ModeArguments)

/// The quadrature of a piece, to each of its ends.
struct Quadrature {
  using Points = std::array<double, most_gauss_points>;
  std::size_t points = 0;
  std::array<double, most_ends> end_s = {};
  std::array<Points, most_ends> before_s = {}, weight_s = {};
};

void quadrature_of(const Table& t, const Rotation& rotation, double from_rad, double length_rad, Quadrature& out) {
  const double start = rotation.time_s(from_rad);
  out.points = t.quadrature->node.size();
  for (std::size_t i = 0; i < t.end.size(); ++i) {
    out.end_s[i] = rotation.time_s(from_rad + t.end[i] * length_rad) - start;
    for (std::size_t q = 0; q < out.points; ++q) {
      const double angle = from_rad + t.end[i] * t.quadrature->node[q] * length_rad;
      out.before_s[i][q] = rotation.even() ? out.end_s[i] * (1.0 - t.quadrature->node[q])
                                           : out.end_s[i] - (rotation.time_s(angle) - start);
      out.weight_s[i][q] = t.quadrature->weight[q] * t.end[i] * length_rad / rotation.speed_rad_per_s(angle);
    }
  }
}

/// What add_mode fills.
struct Integrals {
  std::size_t groups = 1;
  std::array<Lanes, most_integrals> real = {}, imaginary = {};
  /// To end i of what acts at node l.
  [[nodiscard]] Complex operator()(std::size_t i, std::size_t l) const {
    const std::size_t at = i * groups + l / lane_count;
    return {real[at].v[l % lane_count], imaginary[at].v[l % lane_count]};
  }
};

/// Mode k in a plan, but for its response.
template <int D>
void put_mode(const TipDynamicsIn<D>& tip, Eigen::Index k, const Integrals& integral,
              const std::array<double, most_ends>& end_s, bool velocities, PiecePlan& out) {
  using Vector = Eigen::Matrix<Complex, D, 1>;
  const std::size_t p = static_cast<std::size_t>(out.nodes());
  const Complex pole = tip.pole(k);
  const Vector right = tip.right.col(k);
  const Vector left = tip.left.col(k);
  out.factor(k) = exponential(pole * end_s[p]);
  for (std::size_t l = 0; l < p; ++l) {
    const Eigen::Index column = D * static_cast<Eigen::Index>(l);
    const Eigen::Matrix<Complex, 1, D> driven = integral(p, l) * left.transpose();
    out.influence.template block<1, D>(2 * k, column) = driven.real();
    out.influence.template block<1, D>(2 * k + 1, column) = driven.imag();
  }
  for (std::size_t i = 0; i < p; ++i) {
    const Eigen::Index row = D * static_cast<Eigen::Index>(i);
    const Complex decay_to_end = exponential(pole * end_s[i]);
    const Vector moved = right * decay_to_end;
    out.at_nodes.template block<D, 1>(row, 2 * k) = 2.0 * moved.real();
    out.at_nodes.template block<D, 1>(row, 2 * k + 1) = -2.0 * moved.imag();
    if (!velocities) continue;
    const Vector moving = right * (pole * decay_to_end);
    out.velocity_at_nodes.template block<D, 1>(row, 2 * k) = 2.0 * moving.real();
    out.velocity_at_nodes.template block<D, 1>(row, 2 * k + 1) = -2.0 * moving.imag();
    const Eigen::Matrix<Complex, D, D> residue = right * left.transpose();
    for (std::size_t l = 0; l < p; ++l) {
      const Complex w = pole * integral(i, l) + (l == i ? 1.0 : 0.0);
      out.velocity_response.template block<D, D>(row, D * static_cast<Eigen::Index>(l)) += 2.0 * (residue * w).real();
    }
  }
}

}  // namespace

template <int D>
void plan_piece(const TipDynamicsIn<D>& tip, const Rotation& rotation, double from_rad, double length_rad, int nodes,
                bool velocities, PiecePlan& out) {
  const double radians = tip.pole.cwiseAbs().maxCoeff() * length_rad / rotation.slowest_rad_per_s();
  const Table& t = table(nodes, radians);
  const std::size_t p = static_cast<std::size_t>(nodes);
  const Eigen::Index n = tip.pole.size();
  Quadrature quadrature;
  quadrature_of(t, rotation, from_rad, length_rad, quadrature);
  const std::array<double, most_ends>& end_s = quadrature.end_s;
  out.length_rad = length_rad;
  out.duration_s = end_s[p];
  out.time_s.assign(end_s.begin(), end_s.begin() + nodes);
  out.weight_s.resize(p);
  for (std::size_t i = 0; i < p; ++i) {
    out.weight_s[i] = t.nodes->weight[i] * length_rad / rotation.speed_rad_per_s(from_rad + t.end[i] * length_rad);
  }
  out.factor.resize(n);
  out.at_nodes.resize(D * nodes, 2 * n);
  out.response.resize(D * nodes, D * nodes);
  out.influence.resize(2 * n, D * nodes);
  out.velocity_at_nodes.resize(velocities ? D * nodes : 0, 2 * n);
  out.velocity_response.setZero(velocities ? D * nodes : 0, D * nodes);
  std::array<Decays, most_ends> decay = {};
  Integrals integral;
  integral.groups = t.groups;
  std::array<Lanes, most_nodes* D* D* most_groups> response = {};
  ModeArguments arguments = {.ends = p + 1, .points = quadrature.points, .groups = t.groups, .entries = D * D};
  arguments.value = t.value.data();
  arguments.decay = &decay;
  arguments.real = integral.real.data();
  arguments.imaginary = integral.imaginary.data();
  arguments.response = response.data();
  for (Eigen::Index k = 0; k < n; ++k) {
    const Eigen::Matrix<Complex, D, D> residue = tip.right.col(k) * tip.left.col(k).transpose();
    const Eigen::Matrix<double, D, D> residue_real = residue.real(), residue_imaginary = residue.imag();
    for (std::size_t i = 0; i <= p; ++i) {
      decays(tip.pole(k), quadrature.before_s[i], quadrature.points, rotation.even(), decay[i]);
      for (std::size_t q = 0; q < quadrature.points; ++q) decay[i][q] *= quadrature.weight_s[i][q];
    }
    arguments.residue_real = residue_real.data();
    arguments.residue_imaginary = residue_imaginary.data();
    add_mode(arguments);
    put_mode(tip, k, integral, end_s, velocities, out);
  }
  for (std::size_t i = 0; i < p; ++i) {
    for (std::size_t l = 0; l < p; ++l) {
      for (std::size_t e = 0; e < D * D; ++e) {
        out.response(static_cast<Eigen::Index>(D * i + e % D), static_cast<Eigen::Index>(D * l + e / D)) =
            response[(i * D * D + e) * t.groups + l / lane_count].v[l % lane_count];
      }
    }
  }
}
template void plan_piece<2>(const TipDynamicsIn<2>&, const Rotation&, double, double, int, bool, PiecePlan&);
template void plan_piece<3>(const TipDynamicsIn<3>&, const Rotation&, double, double, int, bool, PiecePlan&);

}  // namespace robomill::stability::detail
