#include "robomill/stability/time_steps/piece_plan.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <mutex>

#include "robomill/stability/gauss.hpp"

namespace robomill::stability::detail {
namespace {

using Complex = std::complex<double>;

/// Lagrange values that depend on the numbers of nodes and quadrature points alone. The last end is that of the piece.
struct Table {
  const GaussRule* nodes = nullptr;
  const GaussRule* quadrature = nullptr;
  std::vector<double> end;    ///< [i]: node i, then 1
  std::vector<double> value;  ///< [(i * points + q) * p + l]: ℓ_l at end_i * quadrature node q
};

Table make_table(int p, int points) {
  Table table;
  table.nodes = &gauss_rule(p);
  table.quadrature = &gauss_rule(points);
  table.end = table.nodes->node;
  table.end.push_back(1.0);
  for (const double end : table.end) {
    for (const double x : table.quadrature->node) {
      for (std::size_t l = 0; l < table.nodes->node.size(); ++l) {
        table.value.push_back(lagrange(table.nodes->node, l, end * x));
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

/// e^(pole t) at the quadrature points of one end: points that lie as far on either side of the middle share what
/// they turn and fade by.
void decays(Complex pole, const std::array<double, most_gauss_points>& before_s, std::size_t points, bool mirrored,
            std::array<Complex, most_gauss_points>& out) {
  if (!mirrored) {
    for (std::size_t q = 0; q < points; ++q) out[q] = std::exp(pole * before_s[q]);
    return;
  }
  const double middle_s = 0.5 * (before_s[0] + before_s[points - 1]);
  const Complex middle = std::exp(pole * middle_s);
  for (std::size_t q = 0; q < points / 2; ++q) {
    const Complex away = std::exp(pole * (before_s[q] - middle_s));
    out[q] = middle * away;
    out[points - 1 - q] = middle * (std::conj(away) / std::norm(away));
  }
  if (points % 2 == 1) out[points / 2] = middle;
}

}  // namespace

template <int D>
void plan_piece(const TipDynamicsIn<D>& tip, const Rotation& rotation, double from_rad, double length_rad, int nodes,
                bool velocities, PiecePlan& out) {
  using Vector = Eigen::Matrix<Complex, D, 1>;
  const double radians = tip.pole.cwiseAbs().maxCoeff() * length_rad / rotation.slowest_rad_per_s();
  const Table& t = table(nodes, radians);
  const std::size_t p = static_cast<std::size_t>(nodes);
  const std::size_t points = t.quadrature->node.size();
  const Eigen::Index n = tip.pole.size();
  const double start = rotation.time_s(from_rad);
  std::array<double, most_nodes + 1> end_s = {};
  std::array<std::array<double, most_gauss_points>, most_nodes + 1> before_s = {},
                                                                    weight_s = {};  // of quadrature, to each end
  for (std::size_t i = 0; i <= p; ++i) {
    end_s[i] = rotation.time_s(from_rad + t.end[i] * length_rad) - start;
    for (std::size_t q = 0; q < points; ++q) {
      const double angle = from_rad + t.end[i] * t.quadrature->node[q] * length_rad;
      before_s[i][q] =
          rotation.even() ? end_s[i] * (1.0 - t.quadrature->node[q]) : end_s[i] - (rotation.time_s(angle) - start);
      weight_s[i][q] = t.quadrature->weight[q] * t.end[i] * length_rad / rotation.speed_rad_per_s(angle);
    }
  }
  out.duration_s = end_s[p];
  out.time_s.assign(end_s.begin(), end_s.begin() + nodes);
  out.weight_s.resize(p);
  for (std::size_t i = 0; i < p; ++i) {
    out.weight_s[i] = t.nodes->weight[i] * length_rad / rotation.speed_rad_per_s(from_rad + t.end[i] * length_rad);
  }
  out.factor.resize(n);
  out.at_nodes.resize(D * nodes, 2 * n);
  out.response.setZero(D * nodes, D * nodes);
  out.influence.resize(2 * n, D * nodes);
  out.velocity_at_nodes.resize(velocities ? D * nodes : 0, 2 * n);
  out.velocity_response.setZero(velocities ? D * nodes : 0, D * nodes);
  std::array<Complex, most_gauss_points> decay;
  for (Eigen::Index k = 0; k < n; ++k) {
    const Complex pole = tip.pole(k);
    const Vector right = tip.right.col(k);
    const Vector left = tip.left.col(k);
    const Eigen::Matrix<Complex, D, D> residue = right * left.transpose();
    for (std::size_t i = 0; i <= p; ++i) {
      const Eigen::Index row = D * static_cast<Eigen::Index>(i);
      const Complex decay_to_end = std::exp(pole * end_s[i]);
      std::array<double, most_nodes> real = {}, imaginary = {};  // ∫ exp(pole (end - s)) ℓ_l(s) ds
      decays(pole, before_s[i], points, rotation.even(), decay);
      for (std::size_t q = 0; q < points; ++q) {
        const double re = decay[q].real() * weight_s[i][q];
        const double im = decay[q].imag() * weight_s[i][q];
        const double* value = t.value.data() + (i * points + q) * p;
        for (std::size_t l = 0; l < p; ++l) {
          real[l] += re * value[l];
          imaginary[l] += im * value[l];
        }
      }
      if (i == p) {
        out.factor(k) = decay_to_end;
        for (std::size_t l = 0; l < p; ++l) {
          const Complex w(real[l], imaginary[l]);
          const Eigen::Index column = D * static_cast<Eigen::Index>(l);
          out.influence.template block<1, D>(2 * k, column) = (w * left.transpose()).real();
          out.influence.template block<1, D>(2 * k + 1, column) = (w * left.transpose()).imag();
        }
        continue;
      }
      out.at_nodes.template block<D, 1>(row, 2 * k) = 2.0 * (right * decay_to_end).real();
      out.at_nodes.template block<D, 1>(row, 2 * k + 1) = -2.0 * (right * decay_to_end).imag();
      for (std::size_t l = 0; l < p; ++l) {
        out.response.template block<D, D>(row, D * static_cast<Eigen::Index>(l)) +=
            2.0 * (real[l] * residue.real() - imaginary[l] * residue.imag());
      }
      if (!velocities) continue;
      const Complex slope = pole * decay_to_end;
      out.velocity_at_nodes.template block<D, 1>(row, 2 * k) = 2.0 * (right * slope).real();
      out.velocity_at_nodes.template block<D, 1>(row, 2 * k + 1) = -2.0 * (right * slope).imag();
      for (std::size_t l = 0; l < p; ++l) {
        const Complex w = pole * Complex(real[l], imaginary[l]) + (l == i ? 1.0 : 0.0);
        out.velocity_response.template block<D, D>(row, D * static_cast<Eigen::Index>(l)) += 2.0 * (residue * w).real();
      }
    }
  }
}
template void plan_piece<2>(const TipDynamicsIn<2>&, const Rotation&, double, double, int, bool, PiecePlan&);
template void plan_piece<3>(const TipDynamicsIn<3>&, const Rotation&, double, double, int, bool, PiecePlan&);

}  // namespace robomill::stability::detail
