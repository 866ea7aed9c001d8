#include "robomill/modal/fitting/lscf.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "robomill/base/linear_algebra.hpp"
#include "robomill/base/statistics.hpp"

namespace robomill::modal::detail {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::VectorXcd;

// One output of the matrix fraction: H_o, references wide, and its weight.
struct Output {
  MatrixXcd h;             // n x references
  Eigen::VectorXd weight;  // n
};

std::vector<Output> outputs(const FitData& data) {
  std::vector<Output> rows;
  const Index n = data.omega.size();
  if (static_cast<Index>(data.entries.size()) != data.responses * data.excitations) {
    for (const FitEntry& entry : data.entries) rows.push_back({entry.receptance, entry.weight});
    return rows;
  }
  for (Index i = 0; i < data.responses; ++i) {
    Output row{.h = MatrixXcd(n, data.excitations), .weight = {}};
    Eigen::ArrayXd variance = Eigen::ArrayXd::Zero(n);
    for (const FitEntry& entry : data.entries) {
      if (entry.response != i) continue;
      row.h.col(entry.excitation) = entry.receptance;
      variance += entry.weight.array().square().inverse();
    }
    row.weight = (variance / static_cast<double>(data.excitations)).sqrt().inverse();
    rows.push_back(row);
  }
  return rows;
}

// The sums Σ weight² z^d, Σ weight² z^d H and Σ weight² z^d Hᴴ H over the lines for d = 0 … order.
struct PowerSums {
  std::vector<Complex> one;
  std::vector<Eigen::RowVectorXcd> first;
  std::vector<Eigen::RowVectorXcd> first_back;  // of z^-d
  std::vector<MatrixXcd> second;
};

PowerSums power_sums(const Output& output, const VectorXcd& z, int order) {
  PowerSums sums;
  VectorXcd power = output.weight.cwiseAbs2();
  for (int d = 0; d <= order; ++d) {
    const MatrixXcd weighted = power.asDiagonal() * output.h;
    sums.one.push_back(power.sum());
    sums.first.emplace_back(weighted.colwise().sum());
    sums.first_back.emplace_back(power.adjoint() * output.h);
    sums.second.emplace_back(output.h.adjoint() * weighted);
    power = power.cwiseProduct(z);
  }
  return sums;
}

// Toeplitz matrices of one output at one order: R (q x q), S (q x q·references), T (q·references square), q = order
// + 1.
struct Normal {
  MatrixXcd r, s, t;
};

Normal normal_blocks(const PowerSums& sums, int order) {
  const Index q = order + 1;
  const Index refs = sums.first.front().size();
  Normal normal{MatrixXcd(q, q), MatrixXcd(q, q * refs), MatrixXcd(q * refs, q * refs)};
  for (Index a = 0; a < q; ++a) {
    for (Index b = 0; b < q; ++b) {
      const auto d = static_cast<std::size_t>(std::abs(b - a));
      const bool forward = b >= a;
      normal.r(a, b) = forward ? sums.one[d] : std::conj(sums.one[d]);
      normal.s.block(a, b * refs, 1, refs) = forward ? -sums.first[d] : -sums.first_back[d];
      normal.t.block(a * refs, b * refs, refs, refs) = sums.second[d];
      if (!forward) normal.t.block(a * refs, b * refs, refs, refs) = sums.second[d].adjoint().eval();
    }
  }
  return normal;
}

// The fraction at one order: coefficients α (blocks refs x refs, α_0 = 1) and, for each output, β (rows of length
// refs).
struct Fraction {
  std::vector<MatrixXcd> alpha;
  std::vector<MatrixXcd> beta;
};

Fraction solve_fraction(const std::vector<PowerSums>& sums, int order) {
  const Index refs = sums.front().first.front().size();
  const Index q = order + 1;
  MatrixXcd reduced = MatrixXcd::Zero(q * refs, q * refs);
  std::vector<MatrixXcd> back;  // R⁻¹ S of each output
  for (const PowerSums& output : sums) {
    const Normal normal = normal_blocks(output, order);
    back.push_back(linear_algebra::solve_hermitian(normal.r, normal.s));
    reduced += normal.t - normal.s.adjoint() * back.back();
  }
  const Index rest = order * refs;
  const MatrixXcd alpha =
      -linear_algebra::solve_hermitian(reduced.bottomRightCorner(rest, rest), reduced.bottomLeftCorner(rest, refs));
  MatrixXcd all(q * refs, refs);
  all << MatrixXcd::Identity(refs, refs), alpha;
  Fraction fraction;
  for (Index a = 0; a < q; ++a) fraction.alpha.emplace_back(all.middleRows(a * refs, refs));
  for (const MatrixXcd& b : back) fraction.beta.emplace_back(-b * all);
  return fraction;
}

// Roots y = 1/z of det A = 0: A is monic in y.
VectorXcd inverse_roots(const Fraction& fraction) {
  const auto order = static_cast<Index>(fraction.alpha.size()) - 1;
  const Index refs = fraction.alpha.front().rows();
  MatrixXcd companion = MatrixXcd::Zero(order * refs, order * refs);
  for (Index a = 0; a < order; ++a) {
    companion.block(0, a * refs, refs, refs) = -fraction.alpha[static_cast<std::size_t>(a + 1)];
  }
  companion.bottomLeftCorner((order - 1) * refs, (order - 1) * refs).setIdentity();
  return linear_algebra::eigenvalues(companion);
}

// R_o = B_o(z) v and L = u with A(z) v = 0, uᵀ A(z) = 0.
void set_vectors(LscfPole& pole, const Fraction& fraction, Complex z) {
  const Index refs = fraction.alpha.front().rows();
  MatrixXcd a = MatrixXcd::Zero(refs, refs);
  for (std::size_t r = fraction.alpha.size(); r > 0; --r) a = (a * z + fraction.alpha[r - 1]).eval();
  const linear_algebra::ComplexThinSvd svd = linear_algebra::thin_svd(a);
  const VectorXcd v = svd.v.col(refs - 1);
  pole.left = svd.u.col(refs - 1).conjugate();
  pole.right.resize(static_cast<Index>(fraction.beta.size()));
  for (std::size_t o = 0; o < fraction.beta.size(); ++o) {
    Complex value = 0.0;
    for (Index r = fraction.beta[o].rows() - 1; r >= 0; --r) value = value * z + (fraction.beta[o].row(r) * v)(0);
    pole.right(static_cast<Index>(o)) = value;
  }
}

double shape_mac(const VectorXcd& a, const VectorXcd& b) {
  const double size = a.squaredNorm() * b.squaredNorm();
  return size > 0.0 ? std::norm(a.dot(b)) / size : 0.0;
}

// Between two poles in the s plane, as a share of the second one's distance from the origin.
double distance(const LscfPole& a, const LscfPole& b) {
  return std::hypot(a.omega - b.omega, a.omega * a.zeta - b.omega * b.zeta) / b.omega;
}

// The poles of neighbouring orders that are one and the same, by rising order.
using Chain = std::vector<LscfPole>;

std::vector<Chain> chains_of(const std::vector<LscfPole>& diagram, const LscfOptions& options) {
  std::vector<Chain> chains;
  std::vector<int> orders;
  for (const LscfPole& pole : diagram) {
    if (orders.empty() || orders.back() != pole.order) orders.push_back(pole.order);
    const int last_but_two = orders.size() > 3 ? orders[orders.size() - 4] : 0;  // a gap of two orders is bridged
    Chain* nearest = nullptr;
    for (Chain& chain : chains) {
      const LscfPole& top = chain.back();
      if (top.order == pole.order || top.order < last_but_two) continue;
      if (nearest == nullptr || distance(top, pole) < distance(nearest->back(), pole)) nearest = &chain;
    }
    if (nearest != nullptr && distance(nearest->back(), pole) < 2.0 * options.stable_frequency) {
      nearest->push_back(pole);
    } else {
      chains.push_back({pole});
    }
  }
  return chains;
}

void mark_stable(LscfPole& pole, const std::vector<LscfPole>& below, const LscfOptions& options) {
  const LscfPole* nearest = nullptr;
  for (const LscfPole& other : below) {
    if (nearest == nullptr || distance(other, pole) < distance(*nearest, pole)) nearest = &other;
  }
  if (nearest == nullptr) return;
  pole.frequency_stable = std::abs(nearest->omega - pole.omega) < options.stable_frequency * pole.omega;
  pole.damping_stable =
      pole.frequency_stable && std::abs(nearest->zeta - pole.zeta) < options.stable_damping * pole.zeta;
  pole.vector_stable = pole.frequency_stable &&
                       shape_mac(nearest->left, pole.left) * shape_mac(nearest->right, pole.right) > options.stable_mac;
}

}  // namespace

std::vector<LscfPole> lscf_poles(const FitData& data, const LscfOptions& options, Progress& progress) {
  const std::vector<Output> rows = outputs(data);
  const bool complete = rows.front().h.cols() == data.excitations;
  const double low = data.omega(0);
  const double width = data.omega(data.omega.size() - 1) - low;
  // The band covers so much of the unit circle: with all of it the two ends of the band would have to meet.
  const double period = 2.0 * std::numbers::pi * 0.75 / width;
  const VectorXcd z = ((data.omega.array() - low) * Complex(0.0, period)).exp();
  std::vector<PowerSums> sums;
  sums.reserve(rows.size());
  for (const Output& row : rows) sums.push_back(power_sums(row, z, options.max_order));
  constexpr int most_orders = 20;  // of the diagram, evenly spaced
  const int step = std::max(1, options.max_order / most_orders);
  std::vector<LscfPole> diagram;
  std::vector<LscfPole> below;
  for (int order = 1 + (options.max_order - 1) % step; order <= options.max_order; order += step) {
    progress.check();
    const Fraction fraction = solve_fraction(sums, order);
    std::vector<LscfPole> here;
    for (const Complex y : inverse_roots(fraction)) {
      const Complex root = 1.0 / y;
      // The band begins at the angle 0 and ends at 3π/2: the gap is halved between its ends.
      const double turn = std::arg(root) < -0.25 * std::numbers::pi ? 2.0 * std::numbers::pi : 0.0;
      const Complex lambda = (std::log(root) + Complex(0.0, turn)) / period + Complex(0.0, low);
      LscfPole pole{.order = order,
                    .omega = std::abs(lambda),
                    .zeta = -lambda.real() / std::abs(lambda),
                    .left = {},
                    .right = {}};
      if (!std::isfinite(pole.omega) || lambda.imag() <= 0.0 || pole.zeta <= 0.0 || pole.zeta >= options.zeta_high ||
          pole.omega < low || pole.omega > low + width) {
        continue;
      }
      set_vectors(pole, fraction, root);
      if (!complete) pole.left = VectorXcd::Ones(data.excitations);
      mark_stable(pole, below, options);
      here.push_back(pole);
    }
    std::sort(here.begin(), here.end(), [](const LscfPole& a, const LscfPole& b) { return a.omega < b.omega; });
    diagram.insert(diagram.end(), here.begin(), here.end());
    below = here;
  }
  return diagram;
}

std::vector<LscfPole> physical_poles(const std::vector<LscfPole>& diagram, const LscfOptions& options) {
  std::vector<LscfPole> physical;
  std::set<int> orders;
  for (const LscfPole& pole : diagram) orders.insert(pole.order);
  for (Chain& chain : chains_of(diagram, options)) {
    const auto stable = std::count_if(chain.begin(), chain.end(),
                                      [](const LscfPole& p) { return p.frequency_stable && p.vector_stable; });
    if (static_cast<std::size_t>(stable) < std::max<std::size_t>(3, orders.size() / 5)) continue;
    // The upper half of the chain, where the poles of the noise have room beside it.
    chain.erase(chain.begin(), chain.begin() + static_cast<std::ptrdiff_t>(chain.size() / 2));
    std::vector<double> omega;
    std::vector<double> zeta;
    for (const LscfPole& pole : chain) {
      omega.push_back(pole.omega);
      zeta.push_back(pole.zeta);
    }
    LscfPole pole = chain.back();
    pole.omega = median(omega);
    pole.zeta = median(zeta);
    physical.push_back(pole);
  }
  return physical;
}

}  // namespace robomill::modal::detail
