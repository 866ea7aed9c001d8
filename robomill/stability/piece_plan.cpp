#include "robomill/stability/piece_plan.hpp"

#include <array>
#include <complex>

#include "robomill/stability/gauss.hpp"

namespace robomill::stability::detail {
namespace {

using Complex = std::complex<double>;

/// Lagrange values that depend on the number of nodes alone. The last of `end` is the end of the piece.
struct Table {
  const GaussRule* nodes = nullptr;
  const GaussRule* quadrature = nullptr;
  std::vector<double> end;                              ///< [i]: node i, then 1
  std::vector<std::vector<std::vector<double>>> value;  ///< [i][q][l]: ℓ_l at end_i * quadrature node q
};

Table make_table(int p) {
  Table table;
  table.nodes = &gauss_rule(p);
  // Twelve points more than the polynomial needs carry an exponential of 8 rad to rounding.
  table.quadrature = &gauss_rule(p / 2 + 12);
  table.end = table.nodes->node;
  table.end.push_back(1.0);
  for (const double end : table.end) {
    auto& rows = table.value.emplace_back();
    for (const double x : table.quadrature->node) {
      auto& row = rows.emplace_back();
      for (std::size_t l = 0; l < table.nodes->node.size(); ++l) {
        row.push_back(lagrange(table.nodes->node, l, end * x));
      }
    }
  }
  return table;
}

const Table& table(int p) {
  static const std::array<Table, most_nodes + 1> tables = [] {
    std::array<Table, most_nodes + 1> all;
    for (int i = 1; i <= most_nodes; ++i) all[static_cast<std::size_t>(i)] = make_table(i);
    return all;
  }();
  return tables[static_cast<std::size_t>(p)];
}

struct Residues {
  Eigen::Matrix2cd displacement, velocity;
};

}  // namespace

void plan_piece(const TipDynamics& tip, const Rotation& rotation, double from_rad, double length_rad, int nodes,
                bool velocities, PiecePlan& out) {
  const Table& t = table(nodes);
  const std::size_t p = static_cast<std::size_t>(nodes);
  const std::size_t points = t.quadrature->node.size();
  const Eigen::Index n = tip.pole.size();
  const double start = rotation.time_s(from_rad);
  std::array<double, most_nodes + 1> end_s;
  std::array<std::array<double, most_gauss_points>, most_nodes + 1> before_s, weight_s;  // of quadrature, to each end
  for (std::size_t i = 0; i <= p; ++i) {
    end_s[i] = rotation.time_s(from_rad + t.end[i] * length_rad) - start;
    for (std::size_t q = 0; q < points; ++q) {
      const double angle = from_rad + t.end[i] * t.quadrature->node[q] * length_rad;
      before_s[i][q] = rotation.even() ? end_s[i] * (1.0 - t.quadrature->node[q])
                                       : end_s[i] - (rotation.time_s(angle) - start);
      weight_s[i][q] = t.quadrature->weight[q] * t.end[i] * length_rad / rotation.speed_rad_per_s(angle);
    }
  }
  out.duration_s = end_s[p];
  out.time_s.assign(end_s.begin(), end_s.begin() + nodes);
  out.factor.resize(n);
  out.at_nodes.resize(2 * nodes, 2 * n);
  out.response.setZero(2 * nodes, 2 * nodes);
  out.influence.resize(2 * n, 2 * nodes);
  out.velocity_at_nodes.resize(velocities ? 2 * nodes : 0, 2 * n);
  out.velocity_response.setZero(velocities ? 2 * nodes : 0, 2 * nodes);
  for (Eigen::Index k = 0; k < n; ++k) {
    const Complex pole = tip.pole(k);
    const Eigen::Vector2cd right = tip.right.col(k);
    const Eigen::Vector2cd left = tip.left.col(k);
    const Eigen::Matrix2cd residue = right * left.transpose();
    for (std::size_t i = 0; i <= p; ++i) {
      const Eigen::Index row = 2 * static_cast<Eigen::Index>(i);
      const Complex decay_to_end = std::exp(pole * end_s[i]);
      std::array<double, most_nodes> real = {}, imaginary = {};  // ∫ exp(pole (end - s)) ℓ_l(s) ds
      for (std::size_t q = 0; q < points; ++q) {
        const Complex decay = std::exp(pole * before_s[i][q]) * weight_s[i][q];
        const std::vector<double>& value = t.value[i][q];
        for (std::size_t l = 0; l < p; ++l) {
          real[l] += decay.real() * value[l];
          imaginary[l] += decay.imag() * value[l];
        }
      }
      if (i == p) {
        out.factor(k) = decay_to_end;
        for (std::size_t l = 0; l < p; ++l) {
          const Complex w(real[l], imaginary[l]);
          const Eigen::Index column = 2 * static_cast<Eigen::Index>(l);
          out.influence.block<1, 2>(2 * k, column) = (w * left.transpose()).real();
          out.influence.block<1, 2>(2 * k + 1, column) = (w * left.transpose()).imag();
        }
        continue;
      }
      out.at_nodes.block<2, 1>(row, 2 * k) = 2.0 * (right * decay_to_end).real();
      out.at_nodes.block<2, 1>(row, 2 * k + 1) = -2.0 * (right * decay_to_end).imag();
      for (std::size_t l = 0; l < p; ++l) {
        out.response.block<2, 2>(row, 2 * static_cast<Eigen::Index>(l)) +=
            2.0 * (real[l] * residue.real() - imaginary[l] * residue.imag());
      }
      if (!velocities) continue;
      const Complex slope = pole * decay_to_end;
      out.velocity_at_nodes.block<2, 1>(row, 2 * k) = 2.0 * (right * slope).real();
      out.velocity_at_nodes.block<2, 1>(row, 2 * k + 1) = -2.0 * (right * slope).imag();
      for (std::size_t l = 0; l < p; ++l) {
        const Complex w = pole * Complex(real[l], imaginary[l]) + (l == i ? 1.0 : 0.0);
        out.velocity_response.block<2, 2>(row, 2 * static_cast<Eigen::Index>(l)) += 2.0 * (residue * w).real();
      }
    }
  }
}

}  // namespace robomill::stability::detail
