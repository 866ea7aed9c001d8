#include "robomill/stability/speed_plan.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

namespace robomill::stability::detail {
namespace {

using Complex = std::complex<double>;
constexpr int most_nodes = 6;
constexpr int quadrature_points = 12;

struct Rule {
  std::vector<double> node, weight;  ///< on [0, 1]
};

/// Gauss-Legendre by Newton's method on the three-term recurrence.
Rule gauss(int points) {
  Rule rule;
  for (int i = 0; i < points; ++i) {
    double x = -std::cos(std::numbers::pi * (i + 0.75) / (points + 0.5));
    double slope = 1.0;
    for (int iteration = 0; iteration < 100; ++iteration) {
      double before = 1.0;
      double here = x;
      for (int k = 2; k <= points; ++k) {
        const double next = ((2 * k - 1) * x * here - (k - 1) * before) / k;
        before = here;
        here = next;
      }
      slope = points * (x * here - before) / (x * x - 1.0);
      const double change = here / slope;
      x -= change;
      if (std::abs(change) < 1e-16) break;
    }
    rule.node.push_back(0.5 * (x + 1.0));
    rule.weight.push_back(1.0 / ((1.0 - x * x) * slope * slope));
  }
  return rule;
}

double lagrange(const std::vector<double>& node, std::size_t l, double x) {
  double product = 1.0;
  for (std::size_t j = 0; j < node.size(); ++j) {
    if (j != l) product *= (x - node[j]) / (node[l] - node[j]);
  }
  return product;
}

/// Rules and Lagrange values that depend on the number of nodes alone. Row p of value is the end of the substep.
struct Table {
  Rule nodes;
  std::vector<double> end;                              ///< [i]: node i, then 1
  std::vector<std::vector<std::vector<double>>> value;  ///< [i][q][l]: ℓ_l at end_i * quadrature node q
};

Table make_table(int p, const Rule& quadrature) {
  Table table;
  table.nodes = gauss(p);
  table.end = table.nodes.node;
  table.end.push_back(1.0);
  for (const double end : table.end) {
    auto& rows = table.value.emplace_back();
    for (const double x : quadrature.node) {
      auto& row = rows.emplace_back();
      for (std::size_t l = 0; l < table.nodes.node.size(); ++l) row.push_back(lagrange(table.nodes.node, l, end * x));
    }
  }
  return table;
}

const Rule& quadrature() {
  static const Rule rule = gauss(quadrature_points);
  return rule;
}

const Table& table(int p) {
  static const std::array<Table, most_nodes + 1> tables = [] {
    std::array<Table, most_nodes + 1> all;
    for (int i = 1; i <= most_nodes; ++i) all[static_cast<std::size_t>(i)] = make_table(i, quadrature());
    return all;
  }();
  return tables[static_cast<std::size_t>(p)];
}

}  // namespace

Resolution resolution(const TipDynamics& tip, double step_s, double largest_n_per_m) {
  double square = 0.0;
  double shift = 0.0;
  Eigen::Matrix2d jump = Eigen::Matrix2d::Zero();
  for (Eigen::Index k = 0; k < tip.pole.size(); ++k) {
    square = std::max(square, std::norm(tip.pole(k)));
    shift += std::abs(tip.pole(k)) * 2.0 * tip.right.col(k).norm() * tip.left.col(k).norm();
    jump += 2.0 * (tip.right.col(k) * tip.left.col(k).transpose()).real();
  }
  // How fast the structure moves while the cut holds it: its poles, stiffened by the cut.
  const double rate = std::sqrt(square + shift * largest_n_per_m) + jump.norm() * largest_n_per_m;
  // Gauss collocation: error x^(2p+1) (p!)^4 / ((2p+1) (2p)!^3) <= 1e-13 for x up to:
  constexpr std::array<double, 4> reach = {0.10, 0.38, 0.90, 1.6};  // p = 3, 4, 5, 6
  Resolution r;
  double x = rate * step_s;
  while (x > reach.back() && r.halvings < 30) {
    x *= 0.5;
    ++r.halvings;
  }
  while (r.nodes < most_nodes && x > reach[static_cast<std::size_t>(r.nodes - 3)]) ++r.nodes;
  return r;
}

void plan_speed(const TipDynamics& tip, double step_s, const Resolution& resolution, SpeedPlan& out) {
  const int p = resolution.nodes;
  const Eigen::Index n = tip.pole.size();
  const double h = std::ldexp(step_s, -resolution.halvings);
  const Table& t = table(p);
  const Rule& rule = quadrature();
  out.step_s = step_s;
  out.resolution = resolution;
  out.substep.resize(n);
  out.step.resize(n);
  out.at_nodes.resize(2 * p, 2 * n);
  out.response.setZero(2 * p, 2 * p);
  out.influence.resize(2 * n, 2 * p);
  for (Eigen::Index k = 0; k < n; ++k) {
    const Complex pole = tip.pole(k);
    out.substep(k) = std::exp(pole * h);
    out.step(k) = std::exp(pole * step_s);
    const Eigen::Vector2cd right = tip.right.col(k);
    const Eigen::Vector2cd left = tip.left.col(k);
    for (int i = 0; i <= p; ++i) {
      const std::size_t row = static_cast<std::size_t>(i);
      const double length = t.end[row] * h;
      if (i < p) {
        const Complex decay = std::exp(pole * length);
        out.at_nodes.block<2, 1>(2 * i, 2 * k) = 2.0 * (right * decay).real();
        out.at_nodes.block<2, 1>(2 * i, 2 * k + 1) = -2.0 * (right * decay).imag();
      }
      std::array<Complex, most_nodes> weight = {};  // ∫ exp(pole (length - s)) ℓ_l(s) ds
      for (std::size_t q = 0; q < rule.node.size(); ++q) {
        const Complex decay = std::exp(pole * (length * (1.0 - rule.node[q]))) * (length * rule.weight[q]);
        for (std::size_t l = 0; l < static_cast<std::size_t>(p); ++l) weight[l] += decay * t.value[row][q][l];
      }
      for (int l = 0; l < p; ++l) {
        const Complex w = weight[static_cast<std::size_t>(l)];
        if (i < p) {
          out.response.block<2, 2>(2 * i, 2 * l) += 2.0 * (right * w * left.transpose()).real();
        } else {
          out.influence.block<1, 2>(2 * k, 2 * l) = (w * left.transpose()).real();
          out.influence.block<1, 2>(2 * k + 1, 2 * l) = (w * left.transpose()).imag();
        }
      }
    }
  }
}

}  // namespace robomill::stability::detail
